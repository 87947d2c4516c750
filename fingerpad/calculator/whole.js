/* The whole finger as a sum of slices, a copy of the Python one with its names:
 *   trace, sum, whole       fingerpad/slices/trace.py, total.py and traces.py
 * It adds whole(p, brief) to closedForm. */
(function () {
  const { geomspace, root, show, pchip } = numerics;
  const { NoEquilibriumError, interpolate, fitted, closure_of, ridge_of } = closedForm;

  /** Return the trace of a state up to a force per metre: its last indentation, and its columns at an indentation. */
  function trace(p, state, top, closure) {
    const kind = state === "full_slip" ? state : "charged", voltage = state === "uncharged" ? 0 : p.voltage;
    const forces = geomspace(top * data.traces.light, top, data.traces.forces), columns = {};
    const add = (name, value) => (columns[name] = columns[name] || []).push(value);
    for (const f_ext of forces) {
      const known = fitted(f_ext), n = known.ridges[kind];
      const ridge = ridge_of({ f_ext, voltage, friction: p.friction }, known, kind, closure);
      add("depth", interpolate(f_ext, data.indentations[kind]));
      add("f_ext", f_ext);
      add("f_electrostatic", n * ridge.f_attraction);
      add("contact_length", n * ridge.length);
      add("gross_width", (n - 1) * data.wavelength + ridge.length);
    }
    const { depth } = columns, x = depth.map(Math.log), slopes = {}, cubics = {};
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
      deepest: depth[depth.length - 1],
      at(name, indentation) {
        if (!cubics[name] || indentation <= 0) return 0;
        const v = Math.min(Math.log(indentation), last);
        return Math.exp(cubics[name](Math.max(v, x[0])) + slopes[name] * Math.min(v - x[0], 0));
      },
    };
  }

  /** Return the sum of a column over the slices of a finger (m) lowered by delta, a Gauss rule over its contact. */
  function sum(made, name, delta) {
    const half = Math.sqrt(2 * data.slices.radius * delta), { nodes, weights } = data.slices;
    return nodes.reduce((found, node, k) => {
      const phi = (Math.PI / 2) * node, z = half * Math.sin(phi);
      const thickness = ((half * Math.PI) / 2) * Math.cos(phi) * weights[k];
      return found + thickness * made.at(name, delta - z ** 2 / (2 * data.slices.radius));
    }, 0);
  }

  /** Return the whole finger under p.force (N) in its last state, full slip with friction; and the section at its centre.
   * brief: of that state alone, without the section, as a search over keys has it (runs/closed_form.py): its trace then
   * has other points, and the answer may differ by some 0.1 %. */
  function whole(p, brief) {
    const { start, margin, more, tries, shortest, largest } = data.traces;
    const all = ["uncharged", ...(p.voltage ? ["charged"] : []), ...(p.friction ? ["full_slip"] : [])];
    const closure = closure_of(p), states = brief ? ["full_slip"] : all;
    let top = start.line * (p.force / start.point) ** start.power * margin, made, delta, centre;
    for (const state of states) {
      for (let k = 0; ; k++) {
        const asked = Math.min(Math.max(top, shortest), largest);
        try {
          made = trace(p, state, asked, closure);
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
      top = centre * margin;
    }
    if (centre < data.traces.smallest) throw new NoEquilibriumError(`the centre of the finger bears ${show(centre, 2)} N/m alone`);
    const total = Object.fromEntries([["f_electrostatic", "f_electrostatic"], ["contact_area", "contact_length"],
      ["gross_area", "gross_width"]].map(([name, column]) => [name, sum(made, column, delta)]));
    const f_t = p.friction * (p.force + total.f_electrostatic); // Coulomb's law
    return { mu_app: f_t / p.force, f_t, ...total, indentation: delta, centre, section: brief ? null : closedForm.solve({ ...p, f_ext: centre }) };
  }

  closedForm.whole = whole;
})();
