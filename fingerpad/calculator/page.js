/* The page: fields of a scene's keys, refused where a scene would refuse them, and the answer of the closed form. */
(function () {
  const { show } = numerics;
  const find = (id) => document.getElementById(id);
  const POINTS = 41, POINTS_OF_FINGERS = 13; // of a curve
  const fields = data.fields, by_key = Object.fromEntries(fields.map((field) => [field.key, field]));
  const defaults = values_of((field) => field.value);
  const FOOTPRINT = ["length", "ridges"];

  function create(name, attributes, ...content) {
    const found = document.createElement(name);
    Object.assign(found, attributes);
    found.append(...content);
    return found;
  }

  // -- fields --------------------------------------------------------------------------------------------
  function add_fields() {
    const groups = new Map();
    const add = (group, ...content) => {
      if (!groups.has(group)) {
        const folded = group === "More of the model";
        const box = create("fieldset", {}, folded ? create("summary", {}, group) : create("legend", {}, group));
        groups.set(group, box);
        if (folded) {
          const details = create("details", { id: "more" }, box.firstChild);
          box.append(details);
          groups.set(group, details);
        }
        find("fields").append(box);
      }
      groups.get(group).append(...content);
    };
    for (const field of fields) {
      if (field.key === "length") add(field.group, choice("finger", "default", "the default finger, its contact from full runs", true),
        choice("finger", "given", "a contact as measured, at this force and voltage", false));
      if (field.key === "f_ext") add(field.group, choice("load", "metre", "force per metre of finger, at its centre", true),
        choice("load", "whole", "force on the whole finger, in newtons", false));
      add(field.group, field_box(field));
    }
    const reset = create("button", { type: "button", id: "defaults" }, "Back to the defaults");
    reset.onclick = () => { find("fields").reset(); for (const id of ["finger_default", "load_metre"]) find(id).checked = true; fields.forEach(slide); update(); };
    find("fields").append(reset);
  }

  function choice(group, name, words, checked) {
    const input = create("input", { type: "radio", name: group, id: `${group}_${name}`, defaultChecked: checked });
    return create("label", { className: "choice" }, input, " " + words);
  }

  function field_box(field) {
    const words = create("label", { htmlFor: field.key }, field.words);
    const slider = create("input", { type: "range", min: 0, max: 1000, step: 1, id: field.key + "_slider" });
    slider.setAttribute("aria-label", field.words + ", slider");
    const number = create("input", { type: "number", step: "any", id: field.key, defaultValue: field.value });
    number.setAttribute("aria-describedby", field.key + "_refused");
    const refused = create("p", { id: field.key + "_refused" });
    refused.setAttribute("role", "alert");
    slider.oninput = () => { number.value = from_slider(field, slider.value / 1000); later(); };
    number.oninput = () => { slide(field); later(); };
    number.onchange = () => { slide(field); update(); };
    return create("div", { className: "field" }, words, slider, number, create("span", {}, field.unit), refused);
  }

  // Sliders over a factor of ten or more go by equal ratios.
  const by_ratio = (field) => field.slider[0] > 0 && field.slider[1] / field.slider[0] >= 10;
  function from_slider(field, part) {
    const [low, high] = field.slider;
    const value = by_ratio(field) ? low * (high / low) ** part : low + (high - low) * part;
    return field.whole ? Math.round(value) : Number(value.toPrecision(3));
  }
  function slide(field) {
    const [low, high] = field.slider, value = Math.min(Math.max(Number(find(field.key).value), low), high);
    const part = by_ratio(field) ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    find(field.key + "_slider").value = 1000 * part;
  }

  /** Return why a value in a field's unit is refused, empty where it is not; the bounds are a scene's. */
  function refused(field, text) {
    const name = field.key.split(".").pop(), unit = field.unit && " " + field.unit, value = Number(text);
    const allowed = `it must be ${field.zero ? "0 or " : ""}from ${show(field.low)} to ${show(field.high)}${unit}`;
    if (text.trim() === "" || !Number.isFinite(value)) return `${name} is no number; ${allowed}.`;
    if (field.whole && !Number.isInteger(value)) return `${name} is ${show(value, 12)}; it must be a whole number.`;
    const inside = (value >= field.low && value <= field.high) || (field.zero && value === 0);
    return inside ? "" : `${name} is ${show(value, 12)}${unit}; ${allowed}.`;
  }

  /** Return SI values by key. */
  function values_of(value) {
    return Object.fromEntries(fields.map((field) => [field.key, field.per < 1
      ? value(field) * Math.round(1 / field.per) : value(field) / field.per]));
  }

  /** Return the values in the fields, null where one is refused, which is said beside it. */
  function read() {
    const given = find("finger_given").checked, newtons = find("load_whole").checked && !given;
    find("load_whole").disabled = given; // one contact is no finger
    let whole = true;
    const say = (key, text) => {
      find(key + "_refused").textContent = text;
      find(key).setAttribute("aria-invalid", text !== "");
      if (text && by_key[key].group === "More of the model") find("more").open = true;
      if (text) whole = false;
    };
    for (const field of fields) {
      const unread = (FOOTPRINT.includes(field.key) && !given) || field.key === (newtons ? "f_ext" : "force");
      for (const id of [field.key, field.key + "_slider"]) find(id).disabled = unread;
      say(field.key, unread ? "" : refused(field, find(field.key).value));
    }
    if (!whole) return null;
    const values = values_of((field) => Number(find(field.key).value)), said = closedForm.refuse(values);
    if (said) say("roughness.p_floor", `p_floor is ${show(values["roughness.p_floor"], 12)} Pa; ${said}.`);
    return whole ? { values: { ...values, newtons }, given } : null;
  }

  // -- answers -------------------------------------------------------------------------------------------
  const footprint = (values, given) => (given ? closedForm.given(values.length, values.ridges) : undefined);

  function answer(values, given) {
    try {
      return values.newtons ? closedForm.whole(values) : closedForm.solve(values, footprint(values, given));
    } catch (error) {
      if (error instanceof closedForm.NoEquilibriumError) return error.message;
      throw error;
    }
  }

  const inside = (values) => within(values.f_ext, data.known.forces) && within(values.voltage, data.known.voltages);
  const within = (value, [low, high]) => value >= low && value <= high;
  const changed = (values) => [...new Set(fields.map((field) => field.key)
    .filter((key) => !FOOTPRINT.includes(key) && !["f_ext", "force", "voltage"].includes(key) && values[key] !== defaults[key])
    .map((key) => key.split(".")[0]))];
  /** Return whether the error of an answer is known: at the loads of the full runs, with all else as they have it. */
  const known_at = (values, given) => !given && !values.newtons && inside(values) && changed(values).length === 0;

  function curve(values, given, key, highest, lowest) {
    const most = (values.newtons ? POINTS_OF_FINGERS : POINTS) - 1;
    const even = Array.from({ length: most + 1 }, (_, k) => lowest + ((highest - lowest) * k) / most);
    const ends = { voltage: data.known.voltages, f_ext: data.known.forces }[key] || []; // where the line ceases to be solid
    const places = new Set([...even, ...ends.filter((x) => x > lowest && x < highest)]);
    return [...places].sort((a, b) => a - b).map((x) => {
      const here = { ...values, [key]: x }, found = answer(here, given);
      return { x, y: typeof found === "string" ? null : found.mu_app, known: known_at(here, given) };
    });
  }

  const ROWS = [
    ["mu_app", "friction coefficient µ_app", "", 1, 3, "mu_app"],
    ["f_t", "friction force", "N/m", 1, 2, "mu_app"],
    ["f_electrostatic", "attraction", "N/m", 1, 2, "f_electrostatic"],
    ["contact_length", "contact length", "mm", 1e3, 3, "contact_length"],
    ["ridges_in_contact", "ridges in contact", "", 1, 0],
    ["p_c", "mean contact pressure", "kPa", 1e-3, 2],
    ["d_eq", "equivalent air gap", "µm", 1e6, 3],
  ];

  const ROWS_OF_FINGERS = [
    ["mu_app", "friction coefficient µ_app of the whole finger", "", 1, 3],
    ["f_t", "friction force", "N", 1, 3],
    ["f_electrostatic", "attraction", "N", 1, 3],
    ["contact_area", "contact area of the ridges", "mm²", 1e6, 2],
    ["gross_area", "gross area of contact", "mm²", 1e6, 1],
    ["indentation", "indentation", "mm", 1e3, 3],
  ];

  function show_point(found, values, given) {
    const sure = known_at(values, given), body = find("point").tBodies[0];
    const head = values.newtons ? "Whole finger, as a sum of slices" : "Section at the centre of the finger";
    find("point").caption.textContent = head + (sure ? "" : ": error not known");
    body.replaceChildren(...(values.newtons ? ROWS_OF_FINGERS : ROWS).map(([key, words, unit, per, digits, error]) => {
      const value = found[key] * per, band = error && sure ? ` ± ${(value * data.known.error[error]).toFixed(digits)}` : "";
      const cell = create("td", { id: "value_" + key }, `${value.toFixed(digits)}${band} ${unit}`.trim());
      cell.dataset.value = String(found[key]);
      return create("tr", {}, create("th", { scope: "row" }, words), cell);
    }));
  }

  function remarks(found, values, given) {
    const percent = (value) => `${(100 * value).toFixed(1)} %`, { error, runs, forces, voltages } = data.known;
    const where = `${forces.map(Number).join(" to ")} N/m and ${voltages.map(Number).join(" to ")} V`, said = [];
    if (values.newtons) {
      const section = found.section.mu_app.toFixed(3);
      said.push(`Section at the centre of the finger, second: ${show(found.centre, 3)} N/m, where µ_app is ${section}.`);
      found = found.section;
      values = { ...values, f_ext: found.f_ext };
    }
    if (given) said.push("The contact is as given along both curves; the error of this answer is not known.");
    else {
      said.push(`Known error of ${values.newtons ? "the section" : "these numbers"}: µ_app and friction within ${percent(error.mu_app)}, attraction within ` +
        `${percent(error.f_electrostatic)}, contact length within ${percent(error.contact_length)} of ${runs} full runs at ${where}.`);
      if (!inside(values)) said.push("This point is outside of that; its error is not known.");
      const keys = changed(values);
      if (keys.length) said.push(`Those runs have the default ${keys.join(", ")}; here the error is not known.`);
    }
    const state = found.closure.state(found.p_c, values.voltage);
    if (state) said.push(`The mean pressure of ${show(found.p_c, 4)} Pa is ${state}.`);
    if (found.others.length) said.push(`Further equilibria at a mean pressure of ` +
      `${found.others.map((p) => show(p, 4)).join(", ")} Pa, of ridges not on the screen yet.`);
    find("notes").textContent = said.join(" ");
    find("notes").dataset.state = state;
  }

  function draw(values, given, found) {
    const by = values.newtons ? "force" : "f_ext", unit = by_key[by].unit, force = values[by];
    const ends = values.newtons ? by_key.force.slider : data.known.forces;
    const most_u = Math.max(data.known.voltages[1], values.voltage), most_f = Math.max(ends[1], force);
    const least_f = Math.min(ends[0], force), mu = `µ_app of the ${values.newtons ? "whole finger" : "section"}`;
    const axes = [
      ["over_voltage", "voltage", most_u, 0, "voltage U (V)", `force of ${show(force)} ${unit}`],
      ["over_force", by, most_f, least_f, values.newtons ? "force on the finger F_ext (N)" : "normal force f_ext (N/m)", `voltage of ${show(values.voltage)} V`],
    ];
    const same = !given && changed(values).length === 0, rows = [];
    for (const [id, key, highest, lowest, x, at] of axes) {
      const points = curve(values, given, key, highest, lowest);
      const other = same ? [] : curve({ ...defaults, [by]: force, newtons: values.newtons, voltage: values.voltage }, false, key, highest, lowest);
      const mark = found && { x: values[key], y: found.mu_app };
      const title = `${mu} over ${x} at a ${at}`;
      plot.draw(find(id), { x, y: mu, points, other: other.filter((p) => p.y !== null), mark, error: data.known.error.mu_app, title });
      const missing = points.filter((p) => p.y === null).length;
      find("caption_" + (key === "voltage" ? "voltage" : "force")).textContent = `Over ${x} at a ${at}. ` +
        (points.some((p) => p.known) ? "Shaded: known error; dashed: error not known." : "The curve is dashed, since its error is not known.") +
        (same ? "" : " Dotted: the default friction, coating, roughness and finger.") +
        (missing ? ` ${missing} of ${points.length} points have no equilibrium and are left out.` : "");
      rows.push(...points.map((p) => [key === "voltage" ? force : p.x, key === "voltage" ? p.x : values.voltage, p.y]));
    }
    const head = [values.newtons ? "F_ext (N)" : "f_ext (N/m)", "U (V)", "µ_app"].map((text) => create("th", { scope: "col" }, text));
    find("curves").replaceChildren(create("table", {}, create("thead", {}, create("tr", {}, ...head)), create("tbody", {},
      ...rows.map((row) => create("tr", {}, ...row.map((v, k) =>
        create("td", {}, v === null ? "none" : k < 2 ? show(v, 5) : v.toFixed(4))))))));
  }

  function command(values, given) {
    const set = fields.filter(({ key }) => key === "force" ? values.newtons
      : !FOOTPRINT.includes(key) && values[key] !== defaults[key] && !(values.newtons && key === "f_ext"));
    if (!given)
      return ["fingerpad estimate", ...set.map((field) => `--set ${field.key}=${values[field.key]}`)].join(" ");
    const tables = {};
    for (const { key } of set) {
      const [table, name] = key.includes(".") ? key.split(".") : ["", key];
      (tables[table] = tables[table] || []).push([name, values[key]]);
    }
    const words = Object.entries(tables).flatMap(([table, entries]) => table
      ? [`${table}={${entries.map(([name, value]) => `"${name}": ${value}`).join(", ")}}`]
      : entries.map(([name, value]) => `${name}=${value}`));
    return "import fingerpad as fp\nfrom fingerpad.reduced import cylinders\n" +
      `print(cylinders.solve(fp.Scene(${words.join(", ")}), cylinders.given(${values.length}, ${values.ridges})))`;
  }

  function update() {
    const asked = read(), answers = find("answers");
    answers.classList.toggle("stale", asked === null);
    find("refusal").textContent = asked === null ? "A field is refused; the numbers below are those before." : "";
    if (asked === null) {
      find("always").textContent = "A field is refused.";
      return;
    }
    const { values, given } = asked, found = answer(values, given), text = typeof found === "string";
    find("refusal").textContent = text ? `No answer at this point: ${found}.` : "";
    if (text) find("point").tBodies[0].replaceChildren();
    else show_point(found, values, given);
    if (text) find("notes").textContent = "";
    else remarks(found, values, given);
    const sure = known_at(values, given) ? "" : ", error not known";
    const of = values.newtons ? "Whole finger: " : "";
    find("always").textContent = text ? "No answer at this point." : `${of}µ_app ${find("value_mu_app").textContent}${sure}`;
    find("command").textContent = command(values, given);
    draw(values, given, text ? null : found);
    drivePage.update(values, given, (here) => answer(here, given));
  }

  let waiting = 0;
  function later() { // once a frame at most
    cancelAnimationFrame(waiting);
    waiting = requestAnimationFrame(update);
  }

  document.documentElement.className = "js";
  add_fields();
  find("fields").onsubmit = (event) => event.preventDefault();
  for (const id of ["finger_default", "finger_given", "load_metre", "load_whole"]) find(id).onchange = update;
  for (const id of ["fields", "answers", "always"]) find(id).hidden = false;
  fields.forEach(slide);
  drivePage.begin(later);
  update();
  addEventListener("resize", later);
})();
