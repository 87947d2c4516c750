/* The page: it reads the state from the address, answers by the closed form, and draws and writes what is answered. */
(function () {
  const { show } = numerics;
  const { create } = form;
  const find = (id) => document.getElementById(id);
  const POINTS = 33; // of a curve
  const fields = data.fields;
  const WORDS = { mu_app: ["µ_app", ""], f_t: ["friction force", "N"] };
  const ROWS = [ // key, words, unit, unit over SI, digits, quantity of whose error it has
    ["mu_app", "friction coefficient µ_app", "", 1, 3, "mu_app"],
    ["f_t", "friction force", "N/m", 1, 2, "f_t"],
    ["f_electrostatic", "attraction", "N/m", 1, 2, "f_electrostatic"],
    ["contact_length", "contact length", "mm", 1e3, 3, "contact_length"],
    ["ridges_in_contact", "ridges in contact", "", 1, 0],
    ["p_c", "mean contact pressure", "kPa", 1e-3, 2],
    ["d_eq", "equivalent air gap", "µm", 1e6, 3],
  ];
  const ROWS_OF_FINGERS = [
    ["mu_app", "friction coefficient µ_app of the whole finger", "", 1, 3, "mu_app"],
    ["f_t", "friction force", "N", 1, 3, "f_t"],
    ["f_electrostatic", "attraction", "N", 1, 3, "f_electrostatic"],
    ["contact_area", "contact area of the ridges", "mm²", 1e6, 2, "contact_area"],
    ["gross_area", "gross area of contact", "mm²", 1e6, 1, "gross_area"],
    ["indentation", "indentation", "mm", 1e3, 3],
  ];
  let { texts, kept, said } = state.from_fragment(location.hash);

  // -- answers -------------------------------------------------------------------------------------------
  /** Return the answer at values, why there is none as a text; brief: of full slip alone, for curves and maps. */
  function answer(values, brief) {
    try {
      if (values.newtons) return closedForm.whole(values, brief);
      return closedForm.solve(values);
    } catch (error) {
      if (error instanceof closedForm.NoEquilibriumError) return error.message;
      throw error;
    }
  }

  const error_of = (values, found) => modelErrors.of(values, found);
  const goal_of = (goal, values, quantity) => goal && (goal.times
    ? goal.value * values.friction * (quantity === "f_t" ? (values.newtons ? values.force : values.f_ext) : 1) : goal.value);
  const unit_of = (quantity, values) => (quantity === "mu_app" ? "" : values.newtons ? " N" : " N/m");

  // -- the point -----------------------------------------------------------------------------------------
  function cell(found, row, error, before) {
    const [key, , unit, per, digits, quantity] = row, value = found[key] * per;
    const known = error && quantity && error[quantity] ? value * error[quantity] : 0;
    const td = create("td", before ? {} : { id: "value_" + key }, `${numerics.plus_minus(value, known, digits)} ${unit}`.trim());
    if (!before) td.dataset.value = found[key];
    return td;
  }

  function show_point(found, { values }, other) {
    const rows = values.newtons ? ROWS_OF_FINGERS : ROWS, error = error_of(values, found), body = find("point").tBodies[0];
    const head = values.newtons ? "Whole finger, as a sum of slices" : "Middle section of the finger";
    find("point").caption.textContent = head + (error ? "" : ": error not known");
    const beside = other && typeof other.found !== "string" && other.values.newtons === values.newtons;
    const line = (row) => {
      const cells = [create("th", { scope: "row" }, row[1]), cell(found, row, error)];
      if (!beside) return cells;
      const ratio = found[row[0]] / other.found[row[0]];
      return [...cells, cell(other.found, row, error_of(other.values, other.found), true),
        create("td", {}, Number.isFinite(ratio) ? `${ratio >= 1 ? "+" : "−"}${Math.abs(100 * (ratio - 1)).toFixed(1)} %` : "–")];
    };
    body.replaceChildren(...(beside ? [create("tr", {}, ...["", "this screen", "kept screen", "this over kept"].map((text) => create("th", { scope: "col" }, text)))] : []),
      ...rows.map((row) => create("tr", {}, ...line(row))));
  }

  const span = ({ key, low, high }) => {
    const field = state.by_key[key], unit = field && field.unit ? ` ${field.unit}` : "", name = field ? key.split(".").pop() : key;
    const ends = [low, high].map((v) => show(field ? v * field.per : v));
    return `${name} ${ends[0] === ends[1] ? ends[0] : ends.join(" to ")}${unit}`;
  };

  function remarks(found, { values }) {
    const parts = [], percent = (v) => `${(100 * v).toFixed(1)} %`;
    const error = error_of(values, found);
    if (values.newtons) {
      const section = { ...values, newtons: false, f_ext: found.section.f_ext }, known = error_of(section, found.section);
      const shown = numerics.plus_minus(found.section.mu_app, known ? found.section.mu_app * known.mu_app : 0, 3);
      parts.push(`Middle section, second: ${show(found.centre, 3)} N/m, where µ_app is ${shown}.`);
    }
    if (error) parts.push(`Error, by closed form${values.newtons ? " and points of the traces" : ""}: µ_app and friction within ${percent(error.mu_app)}, attraction within ${percent(error.f_electrostatic)}.`);
    else {
      const beyond = modelErrors.outside(values, found).filter(({ low }) => !Number.isNaN(low)).map(span).join(", ");
      parts.push(`The error is not known here${beyond && `; it is known for ${beyond}`}.`);
    }
    const point = found.section || found, at = closedForm.closure_of(values).state(point.p_c, values.voltage);
    if (at) parts.push(`The mean pressure of ${show(point.p_c, 4)} Pa is ${at}.`);
    if (point.others.length) parts.push("Further equilibria at a mean pressure of " +
      `${point.others.map((p) => show(p, 4)).join(", ")} Pa, of ridges not on the screen yet.`);
    find("notes").textContent = parts.join(" ");
    find("notes").dataset.state = at;
  }

  // -- curves --------------------------------------------------------------------------------------------
  function axis_of(key, values) {
    const field = state.by_key[key], value = values[key] * field.per, log = form.by_ratio(field);
    const low = field.slider[0], words = `${field.words}${field.unit && ` (${field.unit})`}`;
    return { key, low: log ? Math.min(low, value) : Math.min(low, value, 0), high: Math.max(field.slider[1], value), log, words, field };
  }

  function points_of(axis, asked, quantity, at) {
    const places = Array.from({ length: POINTS }, (_, k) => axis.log ? axis.low * (axis.high / axis.low) ** (k / (POINTS - 1)) : axis.low + ((axis.high - axis.low) * k) / (POINTS - 1));
    const ends = data.known.regions.flatMap(({ ranges }) => ranges[axis.key] || []).map((v) => v * axis.field.per); // where a line ceases to be solid
    const every = [...new Set([...places, ...ends.filter((x) => x > axis.low && x < axis.high)])].sort((a, b) => a - b);
    return every.map((x) => at(x));
  }

  function draw_curves(asked, found, other) {
    const { values, goal } = asked, quantity = texts.quantity, load = values.newtons ? "force" : "f_ext";
    const name = `${WORDS[quantity][0]} of the ${values.newtons ? "whole finger" : "section"}`, rows = [];
    const others = other || (changed(values) ? { values: { ...data_defaults(values), [load]: values[load], voltage: values.voltage } } : null);
    for (const [id, key] of [["voltage", "voltage"], ["force", load]]) {
      const axis = axis_of(key, values), unit = axis.field.unit;
      const at = (from) => (x) => {
        const here = { ...from.values, newtons: values.newtons, [key]: state.in_si(axis.field, x) }, result = answer(here, true), none = typeof result === "string";
        const error = none ? null : error_of(here, result);
        return { x, y: none ? null : result[quantity], error: error && error[quantity] !== undefined ? error[quantity] : null, goal: goal_of(goal, here, quantity) };
      };
      const points = points_of(axis, asked, quantity, at(asked));
      const beside = others ? points_of(axis, asked, quantity, at(others)).filter((p) => p.y !== null) : [];
      const fixed = key === "voltage" ? `a force of ${show(values[load])} ${state.by_key[load].unit}` : `a voltage of ${show(values.voltage)} V`;
      const crossings = goal ? crossed(points, (x) => at(asked)(x)) : [];
      const words = `${name}${unit_of(quantity, values) && ` (${unit_of(quantity, values).trim()})`}`;
      plot.draw(find("over_" + id), {
        axis, words, points, other: beside, title: `${name} over ${axis.words} at ${fixed}`,
        goal: goal ? points.map((p) => ({ x: p.x, y: p.goal })) : [], mark: found && { x: values[key] * axis.field.per, y: found[quantity] },
        read: (x) => { const { y } = at(asked)(x); return y === null ? null : [y, `${show(x, 3)} ${unit}: ${show(y, 3)}${unit_of(quantity, values)}`]; },
        pick: (x) => set({ [key]: String(Number(x.toPrecision(3))) }),
      });
      const missing = points.filter((p) => p.y === null).length;
      find("caption_" + id).textContent = `Over ${axis.words} at ${fixed}. ` +
        (points.some((p) => p.error !== null) ? "Shaded: known error; dashed: error not known." : "The curve is dashed, since its error is not known.") +
        (others ? (other ? " Dotted: the kept screen." : " Dotted: the default friction, coating, roughness and finger.") : "") +
        (goal ? (crossings.length ? ` The target is reached at ${crossings.map((x) => `${show(x, 4)} ${unit}`).join(" and ")}.` : " The target is not reached.") : "") +
        (missing ? ` ${missing} of ${points.length} points have no equilibrium and are left out.` : "");
      rows.push(...points.map((p) => [key === "voltage" ? values[load] : p.x, key === "voltage" ? p.x : values.voltage, p.y]));
    }
    const head = [`${load} (${state.by_key[load].unit})`, "voltage (V)", name];
    find("curves").replaceChildren(table(head, rows.map((row) => row.map((v, k) => (v === null ? "none" : k < 2 ? show(v, 5) : v.toFixed(4))))));
  }

  const table = (head, rows) => create("table", {}, create("thead", {}, create("tr", {}, ...head.map((text) => create("th", { scope: "col" }, text)))),
    create("tbody", {}, ...rows.map((row) => create("tr", {}, ...row.map((text) => create("td", {}, text))))));

  function crossed(points, at) {
    const found = [], off = (x) => { const p = at(x); return p.y - p.goal; };
    points.slice(1).forEach((p, k) => {
      const q = points[k];
      if (p.y !== null && q.y !== null && (p.y < p.goal) !== (q.y < q.goal)) found.push(numerics.root(off, q.x, p.x));
    });
    return found;
  }

  const data_defaults = (values) => ({ ...state.read(state.start()).values, newtons: values.newtons });
  const LOADS = ["f_ext", "force", "voltage"];
  const changed = (values) => fields.some(({ key }) => !LOADS.includes(key) && values[key] !== data_defaults(values)[key]);

  // -- the map -------------------------------------------------------------------------------------------
  let map = { key: "" };
  function draw_map(asked) {
    const { values, goal } = asked, quantity = texts.quantity, axes = [texts.x, texts.y].map((key) => axis_of(key, values));
    const [x_axis, y_axis] = axes, name = `${WORDS[quantity][0]}${unit_of(quantity, values) && ` (${unit_of(quantity, values).trim()})`}`;
    const idle = axes.find(({ key }) => state.unread(texts, key));
    find("map_refused").textContent = idle ? `${idle.key.split(".").pop()} has no part in this answer; choose another axis.` : "";
    if (idle) return find("map").replaceChildren();
    const here = (x, y) => ({ ...values, [x_axis.key]: state.in_si(x_axis.field, x), [y_axis.key]: state.in_si(y_axis.field, y) });
    const at = (x, y) => {
      const point = here(x, y), found = closedForm.refuse(point) || answer(point, true), none = typeof found === "string", error = none ? null : error_of(point, found);
      return { value: none ? null : found[quantity], known: Boolean(error && error[quantity] !== undefined), goal: goal_of(goal, point, quantity) };
    };
    const rest = Object.entries(values).filter(([key]) => key !== x_axis.key && key !== y_axis.key);
    const key = JSON.stringify([rest, quantity, goal, axes.map(({ key, low, high }) => [key, low, high])]);
    if (map.key !== key) map = { key, made: heat.compute(x_axis, y_axis, at) };
    if (!map.made.cells.flat().some(({ value }) => value !== null)) {
      find("map_refused").textContent = "No place of this map has an answer; change another field.";
      return find("map").replaceChildren();
    }
    const units = axes.map(({ field }) => field.unit && ` ${field.unit}`);
    const reached = heat.draw(find("map"), map.made, {
      x_axis, y_axis, words: name, title: `${name} over ${x_axis.words} and ${y_axis.words}`, has_goal: Boolean(goal),
      mark: [values[x_axis.key] * x_axis.field.per, values[y_axis.key] * y_axis.field.per],
      read: (x, y) => { const { value } = at(x, y); return `${show(x, 3)}${units[0]}, ${show(y, 3)}${units[1]}: ${value === null ? "no answer" : show(value, 3) + unit_of(quantity, values)}`; },
      pick: (x, y) => set({ [x_axis.key]: picked(x_axis, x), [y_axis.key]: picked(y_axis, y) }),
    });
    find("caption_map").textContent = "Ring: the values of the fields; a click moves it, and so do arrow keys. Hatched: error not known. Grey: no answer." +
      (goal ? (reached ? " Line: the target." : " The target is not reached on this map.") : "");
  }

  const picked = ({ field }, v) => String(Number(v.toPrecision(3)));

  // -- all of it -----------------------------------------------------------------------------------------
  function update() {
    const asked = state.read(texts), refused = asked.refused || {}, answers = find("answers"), missing = Object.keys(refused);
    form.show(texts, refused);
    answers.classList.toggle("stale", missing.length > 0);
    find("refusal").textContent = missing.length ? "A field is refused; the numbers below are those before." : "";
    if (missing.length) {
      find("always").textContent = "A field is refused.";
      return;
    }
    const other = kept && state.read(kept), beside = other && !other.refused ? { ...other, found: answer({ ...other.values, newtons: other.values.newtons }) } : null;
    const { values } = asked, found = answer(values), none = typeof found === "string";
    find("refusal").textContent = none ? `No answer at this point: ${found}.` : "";
    if (none) for (const box of [find("point").tBodies[0], find("notes")]) box.replaceChildren();
    else {
      show_point(found, asked, beside);
      remarks(found, asked);
    }
    const sure = !none && error_of(values, found) ? "" : ", error not known", of = values.newtons ? "Whole finger: " : "Section: ";
    find("always").textContent = none ? "No answer at this point." : `${of}µ_app ${find("value_mu_app").textContent}${sure}`;
    find("command").textContent = commands.of(values, texts);
    draw_curves(asked, none ? null : found, beside);
    clearTimeout(waiting_rest);
    if (drawn) waiting_rest = setTimeout(() => rest(asked), 120);
    else rest(asked);
    find("drop").hidden = !kept;
    find("keep").textContent = kept ? "Keep this screen instead" : "Keep this screen to compare";
    const fragment = state.to_fragment(texts, kept);
    if (fragment !== location.hash.replace(/^#/, ""))
      try {
        history.replaceState(null, "", "#" + fragment);
      } catch (error) { /* a page without an address of its own */ }
  }

  /** Draw what takes longer than a frame. */
  function rest(asked) {
    draw_map(asked);
    drawn = true;
  }

  let waiting = 0, waiting_rest = 0, drawn = false;
  function later() { // once a frame at most
    cancelAnimationFrame(waiting);
    waiting = requestAnimationFrame(update);
  }
  function set(changes) {
    Object.assign(texts, changes);
    update();
  }

  function begin() {
    document.documentElement.className = "js";
    form.options("quantity", { mu_app: "friction coefficient µ_app", f_t: "friction force" });
    for (const id of ["x", "y"]) form.options(id, Object.fromEntries(fields.map(({ key, words }) => [key, words])));
    form.make(texts, (soon) => (soon ? later() : update()));
    find("fields").onsubmit = (event) => event.preventDefault();
    const tell = (text) => { find("done").textContent = text; };
    const reset = () => { Object.assign(texts, state.start()); kept = null; find("address_said").textContent = ""; update(); };
    const buttons = {
      defaults: reset,
      keep: () => { kept = { ...texts }; update(); },
      drop: () => { kept = null; update(); },
      share: () => files.copy(location.href, tell, "the address with all values"),
      copy_table: () => files.copy(files.tsv(files.rows(find("point"))), tell, "the table"),
      save_table: () => files.save("curves.csv", files.csv(files.rows(find("curves").querySelector("table"))), "text/csv"),
      save_map: () => files.save("map.csv", files.csv(map_rows()), "text/csv"),
      picture_voltage: () => files.save_png(find("over_voltage").querySelector("svg"), "over_voltage.png"),
      picture_force: () => files.save_png(find("over_force").querySelector("svg"), "over_force.png"),
      picture_map: () => files.save_png(find("map").querySelector("svg"), "map.png"),
      theme: () => {
        const dark = getComputedStyle(document.documentElement).colorScheme === "dark";
        document.documentElement.dataset.theme = dark ? "light" : "dark";
        update();
      },
    };
    for (const [id, action] of Object.entries(buttons)) find(id).onclick = action;
    find("map").onkeydown = (event) => {
      const step = { ArrowLeft: ["x", -1], ArrowRight: ["x", 1], ArrowDown: ["y", -1], ArrowUp: ["y", 1] }[event.key], asked = state.read(texts);
      if (!step || asked.refused) return;
      event.preventDefault();
      const { field } = axis_of(texts[step[0]], asked.values), part = form.place(field, Number(texts[field.key]) || field.slider[0]) + step[1] / (heat.COUNT - 1);
      set({ [field.key]: String(form.at_place(field, Math.min(Math.max(part, 0), 1))) });
    };
    for (const id of ["fields", "answers", "always", "tools"]) find(id).hidden = false;
    find("address_said").textContent = said.join(" ");
    addEventListener("resize", later);
    addEventListener("hashchange", () => {
      if (location.hash.replace(/^#/, "") === state.to_fragment(texts, kept)) return;
      const read = state.from_fragment(location.hash);
      Object.assign(texts, read.texts);
      kept = read.kept;
      find("address_said").textContent = read.said.join(" ");
      update();
    });
    update();
  }

  function map_rows() {
    const { made } = map, axes = [texts.x, texts.y].map((key) => state.by_key[key]);
    const head = [...axes.map(({ key, unit }) => (unit ? `${key} (${unit})` : key)), texts.quantity, "error_known"];
    return [head, ...made.ys.flatMap((y, j) => made.xs.map((x, k) => [x, y, made.cells[j][k].value === null ? "" : made.cells[j][k].value, Number(made.cells[j][k].known)]))];
  }

  begin();
})();
