/* The closed form of the calculator page, a copy of the Python one with its names and equation numbers:
 *   BearingArea             variational/roughness/bam.py
 *   Cylinder, RidgeState    variational/attraction/cylinder.py
 *   fitted, given, solve    fingerpad/reduced/cylinders.py
 *   refuse                  fingerpad/scene/materials.py and contradictions.py
 * The numbers of the default finger come from Python (fingerpad/calculator/fields.py). tests/test_calculator.py compares
 * the answers of both. Equations are those of Forsbach et al. 2023. SI units, forces per metre of finger. */
"use strict";

const closedForm = (function () {
  class NoEquilibriumError extends Error {}

  // -- what NumPy and SciPy are in Python ---------------------------------------------------------------
  function geomspace(first, last, count) {
    const step = Math.log(last / first) / (count - 1);
    const values = Array.from({ length: count }, (_, k) => first * Math.exp(k * step));
    values[count - 1] = last;
    return values;
  }

  /** Return the root of f between a and b, where f changes its sign: false position (Illinois), every third step halves. */
  function root(f, a, b) {
    let f_a = f(a), f_b = f(b), side = 0;
    for (let k = 1; k < 400 && b - a > 1e-15 * Math.abs(b); k++) {
      let c = k % 3 ? (f_a * b - f_b * a) / (f_a - f_b) : NaN;
      if (!(c > a && c < b)) c = a + (b - a) / 2;
      if (c === a || c === b) break;
      const value = f(c);
      if (value === 0) return c;
      if (value < 0 === f_b < 0) {
        [b, f_b] = [c, value];
        if (side < 0) f_a /= 2;
        side = -1;
      } else {
        [a, f_a] = [c, value];
        if (side > 0) f_b /= 2;
        side = 1;
      }
    }
    return a + (b - a) / 2;
  }

  /** Return the complementary error function: its series below 2, its continued fraction (by Lentz) from there. */
  function erfc(x) {
    if (x < 0) return 2 - erfc(-x);
    if (x < 2) {
      let term = x, sum = x;
      for (let n = 1; term > 1e-18 * sum; n++) {
        term *= (2 * x * x) / (2 * n + 1);
        sum += term;
      }
      return 1 - (2 / Math.sqrt(Math.PI)) * Math.exp(-x * x) * sum;
    }
    let c = x, d = 0, fraction = x;
    for (let n = 1; n < 500; n++) {
      d = 1 / (x + (n / 2) * d);
      c = x + n / 2 / c;
      fraction *= c * d;
      if (Math.abs(c * d - 1) < 1e-16) break;
    }
    return Math.exp(-x * x) / (Math.sqrt(Math.PI) * fraction);
  }

  /** Return a number as Python's format with so many digits ("g") has it, but for zeros in exponents. */
  function show(value, digits) {
    const text = Number(value).toPrecision(digits || 6);
    const [number, power] = text.split("e");
    const short = number.includes(".") ? number.replace(/\.?0+$/, "") : number;
    return power === undefined ? String(Number(text)) : short + "e" + power;
  }

  // -- roughness: bam.py ---------------------------------------------------------------------------------
  class BearingArea {
    constructor(h_0, roughness) {
      Object.assign(this, roughness, { h_0 });
      this.full_pressure = ((this.beta * 4) / 3) * this.young * ((2 * Math.PI) / this.wavelength) * this.h_rms;
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
  const BEYOND = geomspace(1e-9, 1e6, 451);

  /** Return the root of m^2 - 1 and the factors of a^2 / 2R and 4 sigma a / pi E*, for m - 1 given. */
  function shapes(beyond) {
    const m = 1 + beyond, width = Math.sqrt(beyond * (2 + beyond)), angle = Math.asinh(width);
    return [width, m * width - angle, width * angle - m * Math.log1p(beyond)];
  }
  const SHAPES = BEYOND.map(shapes);

  class Cylinder {
    constructor(radius, modulus, h_0, closure) {
      Object.assign(this, { radius, modulus, h_0, closure });
    }
    under_load(f, voltage) {
      return this.branch((sigma, d_eq) => this.from_load(f, sigma, d_eq), f, voltage);
    }
    over_length(length, f, voltage) {
      const a = length / 2;
      return this.branch((sigma, d_eq) => [a, this.from_half_width(a, sigma, d_eq)], f, voltage);
    }
    opening(a, shape, sigma) {
      return (a ** 2 / (2 * this.radius)) * shape[1] + ((4 * sigma * a) / (Math.PI * this.modulus)) * shape[2];
    }
    from_half_width(a, sigma, d_eq) {
      const reach = this.h_0 + 2 * d_eq, last = BEYOND.length - 1;
      if (this.opening(a, SHAPES[last], sigma) < reach)
        throw new NoEquilibriumError(
          `a contact of ${show(2 * a, 3)} m is too short for an attraction that reaches ${show(reach, 3)} m; ` +
            "try a longer one");
      return root((b) => this.opening(a, shapes(b), sigma) - reach, 0, BEYOND[last]);
    }
    from_load(f, sigma, d_eq) {
      const reach = this.h_0 + 2 * d_eq;
      const pull = (4 * sigma) / (Math.PI * this.modulus), rim = (2 / this.radius) * reach;
      const stiffness = (Math.PI * this.modulus) / (4 * this.radius);
      const half_width = (shape) => { // the positive root of the gap's equation, quadratic in a
        const b = pull * shape[2];
        return (2 * reach) / (b + Math.sqrt(b * b + rim * shape[1]));
      };
      const force = (shape) => {
        const a = half_width(shape);
        return stiffness * a * a - 2 * sigma * a * shape[0];
      };
      let before = force(SHAPES[0]), k = 0;
      for (; k < BEYOND.length - 1; k++) {
        const next = force(SHAPES[k + 1]);
        if (before >= f && next < f) break;
        before = next;
      }
      if (k === BEYOND.length - 1)
        throw new NoEquilibriumError(
          `no contact bears ${show(f)} N/m under an attraction of ${show(sigma, 3)} Pa; try a smaller voltage ` +
            "or another force");
      const beyond = root((b) => force(shapes(b)) - f, BEYOND[k], BEYOND[k + 1]);
      return [half_width(shapes(beyond)), beyond];
    }
    /** Return the branch in contact: the root of highest pressure. */
    branch(shape, f, voltage) {
      const at = (p_c) => {
        const d_eq = this.closure.d_eq(p_c);
        const sigma = (data.eps_0 * voltage ** 2) / 2 / (this.h_0 + d_eq) ** 2; // Eq. 3
        return [...shape(sigma, d_eq), sigma, d_eq];
      };
      const excess = (p_c) => {
        const [a, beyond, sigma] = at(p_c);
        return 2 * a * (p_c - sigma * (1 + beyond)) - f;
      };
      const values = PRESSURES.map(excess), found = [];
      for (let k = 0; k + 1 < values.length; k++)
        if (Math.sign(values[k]) !== Math.sign(values[k + 1]))
          found.push(root(excess, PRESSURES[k], PRESSURES[k + 1]));
      if (!found.length || values[values.length - 1] <= 0)
        throw new NoEquilibriumError(
          `no contact pressure from ${show(PRESSURES[0])} to 1e+07 Pa bears ${show(f)} N/m on a ridge at ` +
            `${show(voltage)} V; try another force or length`);
      const p_c = found[found.length - 1], [a, beyond, sigma, d_eq] = at(p_c);
      const f_attraction = 2 * sigma * a * (1 + beyond);
      return { length: 2 * a, p_c, d_eq, f_contact: f + f_attraction, f_attraction, others: found.slice(0, -1) };
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
    return { length, ridges, charged: false };
  }

  /** Return a contact length (m) at the voltage, the same in both states. */
  function given(length, ridges) {
    const both = (value) => Object.fromEntries(STATES.map((state) => [state, value]));
    return { length: both(length), ridges: both(ridges), charged: true };
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
  function solve(p, footprint) {
    const known = footprint || fitted(p.f_ext);
    let ridge = null;
    for (const state of STATES) {
      try {
        ridge = ridge_of(p, known, state);
      } catch (error) {
        if (error instanceof NoEquilibriumError) error.message = `${data.words[state]}: ${error.message}`;
        throw error;
      }
    }
    const n = known.ridges.full_slip, f_contact = n * ridge.f_contact, f_t = p.friction * f_contact; // Coulomb's law
    return {
      mu_app: f_t / p.f_ext, f_t, f_contact, f_electrostatic: n * ridge.f_attraction,
      contact_length: n * ridge.length, ridges_in_contact: n, p_c: ridge.p_c, d_eq: ridge.d_eq,
      others: ridge.others, closure: closure_of(p),
    };
  }

  function ridge_of(p, footprint, state) {
    const n = footprint.ridges[state], length = footprint.length[state], f = p.f_ext / n;
    const closure = closure_of(p), radius = data.tip_radius, h_0 = closure.h_0;
    if (footprint.charged)
      return new Cylinder(radius, data.skin_modulus, h_0, closure).over_length(length / n, f, p.voltage);
    return new Cylinder(radius, hertz_modulus(radius, f, length / n), h_0, closure).under_load(f, p.voltage);
  }

  return { NoEquilibriumError, solve, given, refuse, show, erfc };
})();
