/* How far friction is known, by all assumptions: a copy of fingerpad/reduced/closure_band.py with its names.
 *   TabulatedClosure        variational/roughness/tabulated.py, over pressure and insulator, from page.py */
const knownBand = (function () {
  const { pchip } = numerics, { closure_of, fitted, ridge_of, NoEquilibriumError } = closedForm;
  const { ratios, laws, change, tips, slices } = data.band;

  /** The air gap of another model of roughness, with gaps in units of h_rms and pressures of E* q_0 h_rms. */
  class TabulatedClosure extends closedForm.Closure {
    constructor(own, { pressures, gaps }) {
      super();
      const ratio = Math.log(own.h_0 / own.h_rms), x = ratios.map(Math.log), unit = own.full_pressure / own.beta;
      this.there = ratio >= x[0] && ratio <= x[x.length - 1];
      this.h_0 = own.h_0;
      [this.low, this.high] = [Math.max(own.p_floor, pressures[0] * unit), pressures[pressures.length - 1] * unit];
      this.curve = pchip(pressures.map((p) => Math.log(p * unit)), gaps.map((row) => pchip(x, row)(ratio) + Math.log(own.h_rms)));
    }
    d_eq(p_c) { return Math.exp(this.curve(Math.log(Math.min(Math.max(p_c, this.low), this.high)))); }
  }

  /** Return µ_app of the section at full slip, null without an equilibrium. */
  function friction(p, closure, radius) {
    const known = fitted(p.f_ext), n = known.ridges.full_slip;
    try {
      return (p.friction * n * ridge_of(p, known, "full_slip", closure, radius).f_contact) / p.f_ext;
    } catch (error) {
      if (error instanceof NoEquilibriumError) return null;
      throw error;
    }
  }

  /** Return the known errors of friction by the sum of slices at a force (N): of its neighbours on either side. */
  function known_at(force) {
    const below = slices.filter(([f]) => f <= force * (1 + 1e-9)), above = slices.filter(([f]) => f >= force * (1 - 1e-9));
    return below.length && above.length ? [...below[below.length - 1][1], ...above[0][1]] : [];
  }

  /** Return the band of an answer of the default finger and its parts, the largest first; null without a voltage.
   * parts: [{name, low, high}]; left_out: models of roughness without an equilibrium. */
  function of(values, found) {
    if (!values.voltage || !values.friction) return null;
    const p = { ...values, f_ext: (found.section || found).f_ext }, own = closure_of(p), here = friction(p, own);
    if (here === null) return null;
    const left_out = [], models = laws.map((law) => {
      const closure = new TabulatedClosure(own, law), value = closure.there ? friction(p, closure) : null;
      if (value === null) left_out.push(law.words);
      return value;
    });
    const changed = (factor, ...keys) => ({ ...p, ...Object.fromEntries(keys.map(([key, power]) => [key, p[key] * factor ** power])) });
    const other = (factor, ...keys) => friction(p, closure_of(changed(factor, ...keys)));
    const all = {
      closure: [...models, here],
      tips: tips.map((radius) => friction(p, own, radius)),
      roughness: change.map((factor) => other(factor, ["roughness.h_rms", 1])),
      coating: change.map((factor) => other(factor, ["electric.d_i", 1], ["electric.eps_sc", -1])),
      slices: values.newtons ? known_at(values.force).map((error) => here / (1 + error)) : [],
    };
    const parts = Object.entries(all).map(([name, every]) => [name, every.filter((v) => v !== null).map((v) => v / here)])
      .filter(([, each]) => each.length).map(([name, each]) => ({ name, low: Math.min(1, ...each), high: Math.max(1, ...each) }));
    parts.sort((a, b) => Math.log(b.high / b.low) - Math.log(a.high / a.low));
    const end = (key) => Math.sqrt(parts.reduce((sum, part) => sum + Math.log(part[key]) ** 2, 0)), mu = found.mu_app;
    return { mu_app: mu, low: mu * Math.exp(-end("low")), high: mu * Math.exp(end("high")), left_out,
      parts: parts.map(({ name, low, high }) => ({ name, low: mu * low, high: mu * high })) };
  }

  return { of };
})();
