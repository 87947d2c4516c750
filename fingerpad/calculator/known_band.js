/* How far friction is known, by all assumptions: a copy of fingerpad/reduced/closure_band.py with its names.
 *   TabulatedClosure        variational/roughness/tabulated.py, over pressure and insulator, from page.py */
const knownBand = (function () {
  const { pchip, geomspace, show } = numerics, { closure_of, fitted, ridge_of, NoEquilibriumError } = closedForm;
  const { ratios, laws, change, tips, slices, share, powers, p_reg } = data.band, { eps_0 } = data;

  /** The air gap of another model of roughness, with gaps in units of h_rms and pressures of E* q_0 h_rms. */
  class TabulatedClosure extends closedForm.Closure {
    constructor(own, { pressures, gaps, areas }) {
      super();
      const ratio = Math.log(own.h_0 / own.h_rms), x = ratios.map(Math.log), unit = own.full_pressure / own.beta;
      const nodes = pressures.map((p) => Math.log(p * unit));
      this.there = ratio >= x[0] && ratio <= x[x.length - 1];
      this.h_0 = own.h_0;
      [this.low, this.high] = [Math.max(own.p_floor, pressures[0] * unit), pressures[pressures.length - 1] * unit];
      this.curve = pchip(nodes, gaps.map((row) => pchip(x, row)(ratio) + Math.log(own.h_rms)));
      this.area = areas && pchip(nodes, areas);
    }
    d_eq(p_c) { return Math.exp(this.curve(Math.log(Math.min(Math.max(p_c, this.low), this.high)))); }
    /** Return the part of the pressure in contact that attraction balances; the pressure is within the table. */
    balanced(p_c, voltage) {
      const held = Math.max(p_c, this.low);
      return this.area ? (((eps_0 * voltage ** 2) / 2 / this.h_0 ** 2) * Math.exp(this.area(Math.log(held)))) / held : 0;
    }
    /** Return whether a flat ridge adheres without a load, by a pull-off stress of 1 kPa at one of many pressures. */
    sticks(voltage) {
      const strength = (eps_0 * voltage ** 2) / 2;
      return geomspace(this.low, this.high, 200).some((p) => strength / (this.h_0 + this.d_eq(p)) ** 2 >= p + 1e3);
    }
  }

  /** Return full slip of the section: µ_app, infinite with a reason where it has no number, and what is balanced.
   * radius: of tips over the default's; limit: of friction (Pa) at a pressure, by default Coulomb's. */
  function friction(p, closure, radius = 1, limit = (p_c) => p.friction * p_c) {
    const known = fitted(p.f_ext), n = known.ridges.full_slip;
    const none = (why) => ({ mu_app: Infinity, why: closure.sticks && closure.sticks(p.voltage) ? `ridges adhere at ${show(p.voltage, 4)} V` : why, balanced: 0 });
    try {
      const { p_c, length } = ridge_of(p, known, "full_slip", closure, radius, limit);
      if (p_c > closure.high) return none("the ridges' pressure is beyond the table");
      const balanced = closure.balanced ? closure.balanced(p_c, p.voltage) : 0;
      return { mu_app: (n * length * limit(p_c)) / p.f_ext, why: "", balanced: balanced >= share ? balanced : 0 };
    } catch (error) {
      if (error instanceof NoEquilibriumError) return none("there is no equilibrium");
      throw error;
    }
  }

  /** Return the known errors of friction by the sum of slices at a force (N): of its neighbours on either side. */
  function known_at(force) {
    const below = slices.filter(([f]) => f <= force * (1 + 1e-9)), above = slices.filter(([f]) => f >= force * (1 - 1e-9));
    return below.length && above.length ? [...below[below.length - 1][1], ...above[0][1]] : [];
  }

  /** Return the shear stress (Pa) at a pressure that has the friction of Coulomb's law without voltage. */
  function stress(p, closure) {
    const { p_c } = ridge_of({ ...p, voltage: 0 }, fitted(p.f_ext), "full_slip", closure), part = (q) => q / Math.hypot(q, p_reg);
    return (q) => (p.friction * p_c * part(q)) / part(p_c);
  }

  /** Return a part of states by words, over that of the answer: its ends, and what has no number or is an upper bound. */
  function part_of(name, here, changed) {
    const of_full = powers[name] || [], states = changed.map(([words, each], k) => [words, { ...each, mu_app: here * (each.mu_app / here) ** (of_full[k] || 1) }]);
    const numbers = states.filter(([, { why }]) => !why), top = numbers.reduce((a, b) => (b[1].mu_app > a[1].mu_app ? b : a), ["", { mu_app: here }]);
    const every = [1, ...numbers.map(([, { mu_app }]) => mu_app / here)], no_number = states.filter(([, { why }]) => why).map(([words, { why }]) => [words, why]);
    const at_least = Math.max(...every), upper_bounds = top[1].balanced ? [[top[0], top[1].balanced]] : [];
    return { name, low: Math.min(...every), high: no_number.length ? Infinity : at_least, at_least, no_number, upper_bounds };
  }

  /** Return the band of an answer of the default finger and its parts, the largest first; null without a voltage.
   * An open end is Infinity, and at_least the end by the parts that have one. parts: see part_of; left_out: models of roughness that the page has no table of here. */
  function of(values, found) {
    if (!values.voltage || !values.friction) return null;
    const p = { ...values, f_ext: (found.section || found).f_ext }, own = closure_of(p), { mu_app: here, why } = friction(p, own);
    if (why) return null;
    const models = laws.map((law) => [law.words, new TabulatedClosure(own, law)]), left_out = models.filter(([, { there }]) => !there);
    const changed = (factor, ...keys) => ({ ...p, ...Object.fromEntries(keys.map(([key, power]) => [key, p[key] * factor ** power])) });
    const other = (name, ...keys) => change.map((factor) => changed(factor, ...keys)).map((each) => [`changed ${name}`, friction(each, closure_of(each))]);
    const all = {
      "friction law": [["changed friction law", friction(p, own, 1, stress(p, own))]],
      "rough contact": [...models.filter(([, { there }]) => there).map(([words, law]) => [words, friction(p, law)]), ["bearing area", { mu_app: here, why }]],
      tips: tips.map((radius) => ["changed tips", friction(p, own, radius)]),
      roughness: other("roughness", ["roughness.h_rms", 1]),
      coating: other("coating", ["electric.d_i", 1], ["electric.eps_sc", -1]),
      slices: values.newtons ? known_at(values.force).map((error) => ["slices", { mu_app: here / (1 + error) }]) : [],
    };
    const parts = Object.entries(all).filter(([, states]) => states.length).map(([name, states]) => part_of(name, here, states));
    parts.sort((a, b) => Math.log(b.high / b.low) - Math.log(a.high / a.low));
    const end = (key) => Math.exp(Math.sqrt(parts.reduce((sum, part) => sum + (part[key] < Infinity ? Math.log(part[key]) ** 2 : 0), 0))), mu = found.mu_app;
    const at_least = mu * end("high"), high = parts.some((part) => part.high === Infinity) ? Infinity : at_least;
    return { mu_app: mu, low: mu / end("low"), high, at_least, left_out: left_out.map(([words]) => words),
      parts: parts.map((part) => ({ ...part, low: mu * part.low, high: mu * part.high, at_least: mu * part.at_least })) };
  }

  return { of };
})();
