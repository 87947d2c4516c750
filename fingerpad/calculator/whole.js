/* The whole finger as a sum of slices, a copy of the Python one with its names:
 *   trace, sum, whole       fingerpad/slices/trace.py, total.py and traces.py
 * It adds whole(p, brief) to closedForm. */
(function () {
  const { root, show, pchip } = numerics;
  const { NoEquilibriumError, interpolate, fitted, closure_of, ridge_of } = closedForm;
  const SUMS = [["f_electrostatic", "f_electrostatic"], ["contact_area", "contact_length"], ["gross_area", "gross_width"]];

  /** Return the forces (N/m) of a trace: slices/grid.py. */
  function grid(expected, top) {
    const { light, per_octave } = data.traces, first = Math.round(Math.log2(expected * light)) * per_octave;
    const last = Math.max(Math.ceil(Math.log2(top) * per_octave) + 1, first + 3);
    return Array.from({ length: last - first + 1 }, (_, k) => 2 ** ((first + k) / per_octave));
  }

  /** Return the trace of a state up to a force per metre. */
  function trace(p, state, expected, top, closure) {
    const kind = state === "full_slip" ? state : "charged", voltage = state === "uncharged" ? 0 : p.voltage, columns = {};
    const add = (name, value) => (columns[name] = columns[name] || []).push(value);
    for (const f_ext of grid(expected, top)) {
      const known = fitted(f_ext), n = known.ridges[kind];
      const ridge = ridge_of({ f_ext, voltage, friction: p.friction }, known, kind, closure);
      add("depth", interpolate(f_ext, data.indentations[kind]));
      add("f_ext", f_ext);
      add("f_electrostatic", n * ridge.f_attraction);
      add("contact_length", n * ridge.length);
      add("gross_width", (n - 1) * data.wavelength + ridge.length);
    }
    return on(columns, () => true);
  }

  /** Return the trace on some of its points: its columns, its last indentation, and its columns at an indentation. */
  function on(every, keep) {
    const columns = Object.fromEntries(Object.entries(every).map(([name, values]) => [name, values.filter((_, k) => keep(k))]));
    const { depth } = columns, x = depth.map(Math.log), slopes = {}, cubics = {}, top = Math.max(...columns.f_ext);
    for (const name of ["f_ext", "f_electrostatic", "contact_length", "gross_width"]) {
      const [a, b] = columns[name];
      slopes[name] = a > 0 && b > 0 ? Math.max(Math.log(b / a) / (x[1] - x[0]), 0) : 0;
      if (columns[name].some((v) => v > 1e-12 * top)) cubics[name] = pchip(x, columns[name].map(Math.log));
    }
    const pulls = cubics.f_electrostatic ? [slopes.f_electrostatic] : [];
    slopes.contact_length = Math.min(slopes.contact_length, slopes.f_ext, ...pulls);
    slopes.gross_width = Math.min(slopes.gross_width, slopes.contact_length);
    const last = x[x.length - 1];
    return {
      columns,
      deepest: depth[depth.length - 1],
      at(name, indentation) {
        if (!cubics[name] || indentation <= 0) return 0;
        const v = Math.min(Math.log(indentation), last);
        return Math.exp(cubics[name](Math.max(v, x[0])) + slopes[name] * Math.min(v - x[0], 0));
      },
    };
  }

  /** Return thickness and indentation of the slices of a finger (m) lowered by delta, a Gauss rule over its contact. */
  function slices(delta) {
    const half = Math.sqrt(2 * data.slices.radius * delta), { nodes, weights } = data.slices;
    return nodes.map((node, k) => {
      const phi = (Math.PI / 2) * node, z = half * Math.sin(phi);
      return [((half * Math.PI) / 2) * Math.cos(phi) * weights[k], delta - z ** 2 / (2 * data.slices.radius)];
    });
  }

  /** Return the sum of a column over the slices. */
  const sum = (made, name, delta) => slices(delta).reduce((found, [thickness, depth]) => found + thickness * made.at(name, depth), 0);

  /** Return the relative errors of the sums by the points of the trace: errors.interpolation. */
  function of_points(made, delta) {
    const every = slices(delta), step = 1e-3 * Math.max(...every.map(([, depth]) => depth)), last = made.columns.depth.length - 1;
    const values = (d) => Object.fromEntries(["f_ext", ...SUMS.map(([, column]) => column)].map((column) => [column, sum(made, column, d)]));
    const now = values(delta), less = values(delta - step), first = made.columns.depth[0];
    now.borne = now.f_ext + now.f_electrostatic, less.borne = less.f_ext + less.f_electrostatic;
    const at = (trace, column, depth) => column === "borne" ? trace.at("f_ext", depth) + trace.at("f_electrostatic", depth) : trace.at(column, depth);
    const change = (keep) => {
      const coarse = on(made.columns, keep), moved = (column, depth) => at(coarse, column, depth) - at(made, column, depth);
      return ([, column]) => {
        const slope = (now[column] - less[column]) / (now.f_ext - less.f_ext);
        const off = every.reduce((found, [thickness, depth]) => found + thickness * Math.abs(moved(column, depth) - slope * moved("f_ext", depth)), 0);
        return now[column] ? off / now[column] : 0;
      };
    };
    const [one, other, below] = [(k) => k === 0 || k === last || k % 2 === 0, (k) => k === 0 || k === last || k % 2 === 1,
      (k) => made.columns.depth[k] >= 2 * first || k >= last - 1].map(change);
    const found = Object.fromEntries([...SUMS, ["f_t", "borne"]].map((each) => [each[0], Math.max(one(each), other(each)) + below(each)]));
    return { ...found, mu_app: found.f_t };
  }

  /** Return the whole finger under p.force (N) in its last state, full slip with friction; and the section at its centre.
   * brief: of that state alone, without the section, as a search over keys has it (runs/closed_form.py). */
  function whole(p, brief) {
    const { start, margin, more, tries, shortest, largest } = data.traces;
    const all = ["uncharged", ...(p.voltage ? ["charged"] : []), ...(p.friction ? ["full_slip"] : [])];
    const closure = closure_of(p), states = brief ? ["full_slip"] : all;
    const expected = start.line * (p.force / start.point) ** start.power;
    let made, delta, centre;
    for (const state of states) {
      for (let k = 0, top = expected * margin; ; k++) {
        const asked = Math.min(Math.max(top, shortest), largest);
        try {
          made = trace(p, state, expected, asked, closure);
        } catch (error) {
          if (error instanceof NoEquilibriumError) error.message = `${data.words[state] || state}: ${error.message}`;
          throw error;
        }
        const end = data.slices.length ** 2 / (8 * data.slices.radius), high = Math.min(made.deepest, end);
        const excess = (d) => sum(made, "f_ext", d) - p.force;
        if (excess(high) >= 0) {
          delta = root(excess, 0, high);
          break;
        }
        if (high === end)
          throw new NoEquilibriumError(`the finger is ${show(1e3 * data.slices.length)} mm long, and its contact would be longer`);
        if (k === tries - 1 || asked === largest)
          throw new NoEquilibriumError(`no trace of the cross-section reaches ${show(p.force)} N`);
        top *= more;
      }
      centre = made.at("f_ext", delta);
    }
    if (centre < data.traces.smallest) throw new NoEquilibriumError(`the centre of the finger bears ${show(centre, 2)} N/m alone`);
    const total = Object.fromEntries(SUMS.map(([name, column]) => [name, sum(made, column, delta)]));
    const f_t = p.friction * (p.force + total.f_electrostatic); // Coulomb's law
    return { mu_app: f_t / p.force, f_t, ...total, indentation: delta, centre, points: of_points(made, delta), section: brief ? null : closedForm.solve({ ...p, f_ext: centre }) };
  }

  closedForm.whole = whole;
})();
