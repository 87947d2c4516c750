/* What the page shows, as values: read from texts of fields, written into an address and read from one.
 * A state has texts by key of the fields and of choices; values are in SI units by key of a scene. */
const state = (function () {
  const { show } = numerics;
  const fields = data.fields, by_key = Object.fromEntries(fields.map((field) => [field.key, field]));
  const NUMBER = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d{1,3})?$/i;
  const CHOICES = { // by name in the address: what may be chosen, the first by default
    load: ["whole", "metre"],
    quantity: ["mu_app", "f_t"],
    x: ["electric.d_i", ...fields.map(({ key }) => key)],
    y: ["voltage", ...fields.map(({ key }) => key)],
  };
  const clip = (text) => (text.length > 24 ? text.slice(0, 23) + "…" : text);

  /** Return the texts and choices at the start. */
  function start() {
    const found = { target: "" };
    for (const { key, value } of fields) found[key] = String(value);
    for (const [name, [first]] of Object.entries(CHOICES)) found[name] = first;
    return found;
  }

  /** Return why a text in a field's unit is refused, empty where it is not; the bounds are a scene's. */
  function refused(field, text) {
    const name = field.key.split(".").pop(), unit = field.unit && " " + field.unit, given = text.trim(), value = Number(given);
    const allowed = `it must be ${field.zero ? "0 or " : ""}from ${show(field.low)} to ${show(field.high)}${unit}`;
    if (/^[-+]?\d*,\d+$/.test(given)) return `${name} is ${clip(given)}; write it with a point, as ${clip(given).replace(",", ".")}.`;
    if (given === "") return `${name} is no number; ${allowed}.`;
    if (!NUMBER.test(given) || !Number.isFinite(value)) return `${name} is ${clip(given)}, which is no number; ${allowed}.`;
    const inside = (value >= field.low && value <= field.high) || (field.zero && value === 0);
    return inside ? "" : `${name} is ${show(value, 12)}${unit}; ${allowed}.`;
  }

  /** Return a number in a field's unit as an SI value, without the last digits of a conversion. */
  const in_si = (field, number) => (field.per < 1 ? number * Math.round(1 / field.per) : number / field.per);

  /** Return the target of a text, null without one: {value, times} in SI, or why it is refused. */
  function target(text, quantity) {
    const given = text.trim(), times = /^(.*\S)\s*[x×]$/i.exec(given), number = times ? times[1] : given;
    if (given === "") return null;
    const unit = quantity === "f_t" ? "0.3 in newtons" : "0.5";
    const value = Number(number);
    if (/^[-+]?\d*,\d+$/.test(number)) return `target is ${clip(given)}; write it with a point, as ${clip(given).replace(",", ".")}.`;
    if (!NUMBER.test(number)) return `target is ${clip(given)}; write a number such as ${unit}, or 2x for twice the value without voltage.`;
    return value > 0 && Number.isFinite(value) ? { value, times: Boolean(times) } : `target is ${clip(given)}; it must be greater than 0.`;
  }

  /** Return whether a field has no part in the answer. */
  const unread = (texts, key) => key === (texts.load === "whole" ? "f_ext" : "force");

  /** Return the values of texts: {values, goal}; or {refused: sentence by key}. */
  function read(texts) {
    const newtons = texts.load === "whole", said = {}, values = { newtons };
    for (const field of fields) {
      const text = unread(texts, field.key) ? "" : refused(field, texts[field.key]);
      if (text) said[field.key] = text;
      values[field.key] = in_si(field, unread(texts, field.key) ? field.value : Number(texts[field.key]));
    }
    const goal = target(texts.target, texts.quantity);
    if (typeof goal === "string") said.target = goal;
    else if (texts.x === texts.y) said.x = "both axes of the map have one key; choose two different ones.";
    if (!Object.keys(said).length) {
      const why = closedForm.refuse(values), key = "roughness.p_floor";
      if (why) said[key] = `p_floor is ${show(values[key], 12)} Pa; ${why}.`;
    }
    return Object.keys(said).length ? { refused: said } : { values, goal };
  }

  // -- the address ---------------------------------------------------------------------------------------
  /** Return what a fragment of an address has: what differs from the start, and of a kept screen after "kept.". */
  function to_fragment(texts, kept) {
    const first = start(), pairs = [];
    for (const [before, each] of [["", texts], ["kept.", kept]])
      for (const [key, text] of Object.entries(each || {}))
        if (text !== first[key] && !(key in by_key && unread(each, key))) pairs.push([before + key, text]);
    if (kept && !pairs.some(([key]) => key.startsWith("kept."))) pairs.push(["kept.voltage", kept.voltage]);
    return pairs.map(([key, text]) => `${encodeURIComponent(key)}=${encodeURIComponent(text)}`).join("&");
  }

  /** Return {texts, kept, said}: what a fragment asks for, and a sentence for each part that is refused. */
  function from_fragment(fragment) {
    const texts = start(), said = [];
    let kept = null;
    for (const pair of fragment.replace(/^#/, "").split("&").filter(Boolean)) {
      const cut = pair.indexOf("="), [name, text] = [pair.slice(0, cut < 0 ? pair.length : cut), cut < 0 ? "" : pair.slice(cut + 1)].map(decoded);
      const key = name.replace(/^kept\./, ""), why = cut < 0 ? `${clip(name)} has no value` : wrong(key, text);
      if (why) said.push(`In the address ${why.replace(/\.$/, "")}; it is left out.`);
      else if (key !== name) (kept = kept || start())[key] = text;
      else texts[key] = text;
    }
    return { texts, kept, said };
  }

  function decoded(text) {
    try {
      return decodeURIComponent(text);
    } catch (error) {
      return text; // a lone %
    }
  }

  function wrong(key, text) {
    if (Object.hasOwn(by_key, key)) return refused(by_key[key], text);
    if (Object.hasOwn(CHOICES, key)) return CHOICES[key].includes(text) ? "" : `${key} is ${clip(text) || "empty"}, which is no choice`;
    if (key === "target") return typeof target(text, "mu_app") === "string" ? target(text, "mu_app") : "";
    return `${clip(key)} is no field of this page`;
  }

  return { start, refused, in_si, target, unread, read, to_fragment, from_fragment, CHOICES, by_key };
})();
