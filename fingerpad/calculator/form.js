/* The fields of the page: texts with sliders, choices and presets. It calls a function at every change of a text. */
const form = (function () {
  const fields = data.fields;
  const find = (id) => document.getElementById(id);
  const FOLDED = "More of the model";

  function create(name, attributes, ...content) {
    const found = Object.assign(document.createElement(name), attributes);
    found.append(...content);
    return found;
  }

  // Sliders over a factor of ten or more go by equal ratios, and say so.
  const by_ratio = (field) => field.slider[0] > 0 && field.slider[1] / field.slider[0] >= 10;
  const place = (field, value) => {
    const [low, high] = field.slider;
    return by_ratio(field) ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  };
  function at_place(field, part) {
    const [low, high] = field.slider, value = by_ratio(field) ? low * (high / low) ** part : low + (high - low) * part;
    return Number(value.toPrecision(3));
  }

  /** Make the fields for texts, which they change in place; changed(soon) is called after that. */
  function make(texts, changed) {
    const groups = new Map();
    const group = (name) => {
      if (!groups.has(name)) {
        const folded = name === FOLDED, box = folded ? create("details", { id: "more" }, create("summary", {}, name)) : create("fieldset", {}, create("legend", {}, name));
        groups.set(name, box);
        find("fields").append(box);
      }
      return groups.get(name);
    };
    const set = (key, text, soon) => { texts[key] = text; changed(soon); };
    group("Start from").append(...presets(texts, changed));
    for (const field of fields) {
      if (field.key === "force") group(field.group).append(...choice("load", { whole: "force on the whole finger, in newtons", metre: "force per metre of finger, at its centre" }, set));
      group(field.group).append(field_box(field, set));
    }
    find("target").oninput = () => set("target", find("target").value, true);
    for (const key of ["quantity", "x", "y"]) find(key).onchange = () => set(key, find(key).value, false);
  }

  function choice(name, words, set) {
    return Object.entries(words).map(([value, text]) => {
      const input = create("input", { type: "radio", name, id: `${name}_${value}`, value });
      input.onchange = () => set(name, value, false);
      return create("label", { className: "choice" }, input, " " + text);
    });
  }

  function presets(texts, changed) {
    const said = create("p", { id: "preset_said", className: "small" });
    return [...new Set(data.presets.map((each) => each.group))].map((group) => {
      const select = create("select", { id: `preset_${group}` }, create("option", { value: "" }, "choose"));
      data.presets.forEach((each, k) => each.group === group && select.append(create("option", { value: String(k) }, each.name)));
      select.onchange = () => {
        if (select.value === "") return;
        const { values, source } = data.presets[Number(select.value)];
        for (const [key, value] of Object.entries(values)) texts[key] = String(value);
        said.textContent = source;
        select.value = "";
        changed(false);
      };
      return create("label", { className: "preset" }, `${group} `, select);
    }).concat([said]);
  }

  function field_box(field, set) {
    const label = create("label", { htmlFor: field.key }, field.words);
    if (by_ratio(field)) label.append(create("span", { className: "small" }, " (logarithmic)"));
    const slider = create("input", { type: "range", min: 0, max: 1000, step: 1, id: field.key + "_slider" });
    slider.setAttribute("aria-label", field.words + (by_ratio(field) ? ", logarithmic slider" : ", slider"));
    const number = create("input", { type: "text", inputMode: "decimal", autocomplete: "off", id: field.key, className: "number" });
    number.setAttribute("aria-describedby", field.key + "_refused");
    const refused = create("p", { id: field.key + "_refused" });
    refused.setAttribute("role", "alert");
    slider.oninput = () => set(field.key, String(at_place(field, slider.value / 1000)), true);
    number.oninput = () => set(field.key, number.value, true);
    number.onchange = () => set(field.key, number.value, false);
    return create("div", { className: "field" }, label, slider, number, create("span", {}, field.unit), refused);
  }

  /** Show texts in the fields, and beside each why it is refused. */
  function show(texts, said) {
    const put = (element, text) => { if (element.value !== text) element.value = text; };
    for (const field of fields) {
      const unread = state.unread(texts, field.key), slider = find(field.key + "_slider");
      put(find(field.key), texts[field.key]);
      const part = place(field, Number(texts[field.key]) || field.slider[0]);
      slider.value = 1000 * Math.min(Math.max(part, 0), 1);
      for (const each of [find(field.key), slider]) each.disabled = unread;
      tell(field.key, unread ? "" : said[field.key]);
      if (said[field.key] && field.group === FOLDED) find("more").open = true;
    }
    find(`load_${texts.load}`).checked = true;
    for (const key of ["target", "quantity", "x", "y"]) put(find(key), texts[key]);
    tell("target", said.target);
    find("map_refused").textContent = said.x || "";
  }

  function tell(key, text) {
    find(key + "_refused").textContent = text || "";
    find(key).setAttribute("aria-invalid", Boolean(text));
  }

  /** Fill the choices of selects. */
  function options(id, words) {
    find(id).append(...Object.entries(words).map(([value, text]) => create("option", { value }, text)));
  }

  return { make, show, options, create, by_ratio, place, at_place };
})();
