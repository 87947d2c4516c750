/* The closed form of the calculator page, a copy of the Python one with its names and equation numbers:
 *   BearingArea             variational/roughness/bam.py
 *   Cylinder, RidgeState    variational/attraction/cylinder.py
 *   fitted, solve           fingerpad/reduced/cylinders.py
 *   refuse                  fingerpad/scene/materials.py
 * The numbers of the default finger come from Python (fingerpad/calculator/page.py). tests/test_calculator.py compares
 * the answers of both. Equations are those of Forsbach et al. 2023. SI units, forces per metre of finger. */
const closedForm = (function () {
  const { geomspace, root, erfc, show } = numerics;
  class NoEquilibriumError extends Error {}

  // -- roughness: bam.py ---------------------------------------------------------------------------------
  class BearingArea {
    constructor(h_0, roughness) {
      Object.assign(this, roughness, { h_0, gaps: [] });
      this.full_pressure = ((this.beta * 4) / 3) * this.young * ((2 * Math.PI) / this.wavelength) * this.h_rms;
    }
    /** Return d_eq at a pressure of PRESSURES, each computed once. */
    gap(k) {
      if (this.gaps[k] === undefined) this.gaps[k] = this.d_eq(PRESSURES[k]);
      return this.gaps[k];
    }
    separation(p_c) { // Eq. 9, inverse of its first term
      return -this.gamma * this.h_rms * Math.log(p_c / this.full_pressure);
    }
    contact_pressure(u_bar) { // Eq. 9
      return this.full_pressure * Math.exp(-u_bar / (this.gamma * this.h_rms));
    }
    twice_area(u_bar) { // Eq. 11
      const width = Math.SQRT2 * this.h_rms;
      return erfc((u_bar - this.h_0) / width) - erfc(u_bar / width);
    }
    d_eq(p_c) { // Eq. 13, held below p_floor and above full_pressure
      const held = Math.min(Math.max(p_c, this.p_floor), this.full_pressure);
      return this.h_0 * (Math.sqrt(2 / this.twice_area(this.separation(held))) - 1);
    }
    state(p_c, voltage) {
      if (p_c < this.p_floor) return "below p_floor";
      if (p_c > this.full_pressure) return "beyond zero separation";
      const fold = this.pull_off_fold(voltage);
      if (fold !== null && p_c < this.contact_pressure(fold)) return "past the fold";
      const widens = this.separation(p_c) < this.h_0 / 2;
      return widens ? "where d_eq rises with pressure, since the insulators are thick for this roughness" : "";
    }
    /** Return the logarithm of the repulsion's slope over the attraction's beyond h_0 / 2, and its slope (1/m). */
    steeper(u_bar, voltage) {
      const width = Math.SQRT2 * this.h_rms, decay = this.gamma * this.h_rms;
      const near = (u_bar - this.h_0) / width, beyond = ((2 * u_bar - this.h_0) * this.h_0) / width ** 2;
      const pull = (data.eps_0 * voltage ** 2) / (2 * Math.sqrt(Math.PI) * this.h_0 ** 2 * width);
      const part = -Math.expm1(-beyond);
      return [
        Math.log(this.full_pressure / decay / pull / part) - u_bar / decay + near ** 2,
        -1 / decay + (2 * near) / width - (((2 * this.h_0) / width ** 2) * Math.exp(-beyond)) / part,
      ];
    }
    pull_off_fold(voltage) {
      if (voltage === 0) return null;
      const first = (this.h_0 / 2) * (1 + 1e-9), last = this.h_0 + (1 + 1 / this.gamma) * this.h_rms;
      const least = root((u) => this.steeper(u, voltage)[1], first, last);
      if (this.steeper(least, voltage)[0] >= 0) return null;
      if (this.steeper(first, voltage)[0] <= 0) return first;
      return root((u) => this.steeper(u, voltage)[0], first, least);
    }
  }

  // -- one ridge: cylinder.py ----------------------------------------------------------------------------
  const PRESSURES = geomspace(10, 1e7, 181);
  const [LEAST, LARGEST] = [1e-9, 1e6], [LOG_LEAST, LOG_LARGEST] = [Math.log(LEAST), Math.log(LARGEST)]; // of m - 1
  const [EXACT, ROUGH] = [1e-9, 1e-3]; // last steps of ln(m - 1)

  class Cylinder {
    /** stiffening: what the modulus gains at a pressure. */
    constructor(radius, unsheared, h_0, closure, stiffening = () => 0) {
      Object.assign(this, { radius, unsheared, modulus: unsheared, h_0, closure, stiffening, near: 0 });
    }
    under_load(f, voltage) {
      const half_width = (beyond, sigma) => { // the root of the force's equation, quadratic in a; and its slope over m
        const stiffness = (Math.PI * this.modulus) / (2 * this.radius);
        const width = Math.sqrt(beyond * (2 + beyond)), pull = 2 * sigma * width;
        const both = Math.sqrt(pull * pull + 2 * stiffness * f);
        this.slope = ((2 * sigma * (1 + beyond)) / width) * ((1 + pull / both) / stiffness);
        return (pull + both) / stiffness;
      };
      return this.branch((sigma, d_eq, tolerance) => {
        const beyond = this.edge(half_width, sigma, d_eq, tolerance);
        if (!(beyond > LEAST && beyond < LARGEST))
          throw new NoEquilibriumError(
            `no contact bears ${show(f)} N/m under an attraction of ${show(sigma, 3)} Pa; try a smaller voltage ` +
              "or another force");
        this.half = half_width(beyond, sigma);
        return beyond;
      }, f, voltage);
    }
    /** Return m - 1 where the gap at c, which grows with m, is the reach of the attraction; an end beyond all. */
    edge(half_width, sigma, d_eq, tolerance) {
      const reach = this.h_0 + 2 * d_eq, { radius } = this, pull = (4 * sigma) / (Math.PI * this.modulus);
      let slope = 0;
      const opening = (y) => { // the logarithm of the gap over the reach, and its slope over y = ln(m - 1)
        const beyond = Math.exp(y), m = 1 + beyond, width = Math.sqrt(beyond * (2 + beyond));
        const angle = Math.asinh(width), log = Math.log1p(beyond), a = half_width(beyond, sigma);
        const round = m * width - angle, pulled = width * angle - m * log;
        const gap = ((a * a) / (2 * radius)) * round + pull * a * pulled;
        const grows = this.slope * ((a / radius) * round + pull * pulled) + ((a * a) / radius) * width + pull * a * ((m / width) * angle - log);
        slope = (beyond * grows) / gap;
        return Math.log(gap / reach);
      };
      let low = LOG_LEAST, high = LOG_LARGEST, y = this.near;
      for (let k = 0; k < 100; k++) { // Newton's method between bounds, from the edge before
        const value = opening(y), next = y - value / slope;
        if (value < 0) low = y;
        else high = y;
        const small = Math.abs(next - y) <= tolerance + 1e-15 * Math.exp(-y);
        y = small || (next > low && next < high) ? next : (low + high) / 2;
        if (small) break;
      }
      if (!(y > LOG_LEAST + 1e-6) && opening(LOG_LEAST) > 0) return LEAST;
      if (!(y < LOG_LARGEST - 1e-6) && opening(LOG_LARGEST) < 0) return LARGEST;
      this.near = y;
      return Math.exp(y);
    }
    /** Return the branch in contact: the root of highest pressure. Its search has edges that are good for a sign. */
    branch(shape, f, voltage) {
      const strength = (data.eps_0 * voltage ** 2) / 2; // over the square of the distance, Eq. 3
      const borne = (p_c, d_eq, tolerance) => {
        this.modulus = this.unsheared + this.stiffening(p_c);
        const sigma = strength / (this.h_0 + d_eq) ** 2, beyond = shape(sigma, d_eq, tolerance);
        return 2 * this.half * (p_c - sigma * (1 + beyond)) - f;
      };
      const excess = (p_c) => borne(p_c, this.closure.d_eq(p_c), EXACT);
      const count = PRESSURES.length, values = new Float64Array(count).fill(NaN);
      const value = (k, tolerance) => {
        if (Number.isNaN(values[k]) || tolerance === EXACT) values[k] = borne(PRESSURES[k], this.closure.gap(k), tolerance);
        return values[k];
      };
      const changes = (k, tolerance) => Math.sign(value(k, tolerance)) !== Math.sign(value(k + 1, tolerance));
      const next_root = (k) => { // the next one of lower pressure, from below PRESSURES[k]
        while (k-- > 0)
          if (changes(k, ROUGH) && changes(k, EXACT)) return [k, root(excess, PRESSURES[k], PRESSURES[k + 1])];
        return null;
      };
      value(0, EXACT); // where a contact that is too short for its attraction is found
      const first = value(count - 1, EXACT) > 0 ? next_root(count - 1) : null;
      if (!first)
        throw new NoEquilibriumError(
          `no contact pressure from ${show(PRESSURES[0])} to 1e+07 Pa bears ${show(f)} N/m on a ridge at ` +
            `${show(voltage)} V; try another force or length`);
      const [place, p_c] = first, d_eq = this.closure.d_eq(p_c), sigma = strength / (this.h_0 + d_eq) ** 2;
      this.modulus = this.unsheared + this.stiffening(p_c);
      const beyond = shape(sigma, d_eq, EXACT), length = 2 * this.half, f_attraction = sigma * length * (1 + beyond);
      const others = () => { // pressures of further equilibria, the lowest first
        const found = [];
        for (let k = place, next; (next = next_root(k)); [k] = next) found.unshift(next[1]);
        return found;
      };
      return { length, p_c, d_eq, f_contact: f + f_attraction, f_attraction, others };
    }
  }

  function hertz_modulus(radius, f, length) {
    return (4 * radius * f) / (Math.PI * (length / 2) ** 2);
  }

  // -- the finger: cylinders.py --------------------------------------------------------------------------
  const STATES = Object.keys(data.words); // normal contact, then full slip

  function interpolate(f_ext, values) {
    const x = data.forces.map(Math.log), y = values.map(Math.log), at = Math.log(f_ext);
    const k = Math.min(Math.max(x.findIndex((v) => v >= at) - 1, at > x[x.length - 1] ? x.length - 2 : 0), x.length - 2);
    return Math.exp(y[k] + ((y[k + 1] - y[k]) * (at - x[k])) / (x[k + 1] - x[k]));
  }

  /** Return the default finger's contact without voltage: length (m) and ridges, by state. */
  function fitted(f_ext) {
    const length = {}, ridges = {};
    for (const state of STATES) {
      length[state] = interpolate(f_ext, data.lengths[state]);
      ridges[state] = Math.max(1, Math.round(interpolate(f_ext, data.ridges[state])));
    }
    return { length, ridges };
  }

  /** Return what two keys contradict each other in, empty where they do not. */
  function refuse(p) {
    const closure = closure_of(p);
    if (p["roughness.p_floor"] >= closure.full_pressure)
      return `it must be below the pressure at zero separation, ${show(closure.full_pressure, 4)} Pa`;
    if (!(closure.d_eq(closure.p_floor) < data.largest_gap))
      return `the air gap would be held there at more than ${show(data.largest_gap)} m: take a larger p_floor, ` +
        "or a smaller gamma or h_rms";
    return "";
  }

  function closure_of(p) {
    const h_0 = data.sc_thickness / p["electric.eps_sc"] + p["electric.d_i"] / p["electric.eps_i"];
    const names = ["h_rms", "wavelength", "young", "gamma", "beta", "p_floor"];
    return new BearingArea(h_0, Object.fromEntries(names.map((name) => [name, p["roughness." + name]])));
  }

  /** Return full slip, which needs normal contact before; p has the values of a scene by dotted key, in SI units. */
  function solve(p) {
    const known = fitted(p.f_ext);
    const closure = closure_of(p);
    let ridge = null;
    for (const state of STATES) {
      try {
        ridge = ridge_of(p, known, state, closure);
      } catch (error) {
        if (error instanceof NoEquilibriumError) error.message = `${data.words[state]}: ${error.message}`;
        throw error;
      }
    }
    const n = known.ridges.full_slip, f_contact = n * ridge.f_contact, f_t = p.friction * f_contact; // Coulomb's law
    return {
      mu_app: f_t / p.f_ext, f_ext: p.f_ext, f_t, f_contact, f_electrostatic: n * ridge.f_attraction,
      contact_length: n * ridge.length, ridges_in_contact: n, p_c: ridge.p_c, d_eq: ridge.d_eq,
      others: ridge.others(), closure,
    };
  }

  /** Return a ridge in a state. */
  function ridge_of(p, known, state, closure) {
    const n = known.ridges[state], length = known.length[state], f = p.f_ext / n, radius = data.tip_radius, { h_0 } = closure;
    const stiffening = state === "full_slip" ? (p_c) => data.shear * Math.max(p.friction - data.friction, 0) * p_c : undefined;
    return new Cylinder(radius, hertz_modulus(radius, f, length / n), h_0, closure, stiffening).under_load(f, p.voltage);
  }

  return { NoEquilibriumError, solve, refuse, interpolate, fitted, closure_of, ridge_of };
})();
