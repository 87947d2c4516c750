/* The closed form of the calculator page, a copy of the Python one with its names and equation numbers:
 *   BearingArea             variational/roughness/bam.py
 *   Cylinder, RidgeState    variational/attraction/cylinder.py
 *   fitted, given, solve    fingerpad/reduced/cylinders.py
 *   refuse                  fingerpad/scene/materials.py
 *   pchip, trace, whole     fingerpad/slices/trace.py, total.py and traces.py
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
  const [LEAST, LARGEST] = [1e-9, 1e6]; // of m - 1


  class Cylinder {
    constructor(radius, modulus, h_0, closure) {
      Object.assign(this, { radius, modulus, h_0, closure });
    }
    under_load(f, voltage) {
      const stiffness = (Math.PI * this.modulus) / (2 * this.radius);
      const half_width = (beyond, sigma) => { // the root of the force's equation, quadratic in a; and its slope over m
        const width = Math.sqrt(beyond * (2 + beyond)), pull = 2 * sigma * width;
        const both = Math.sqrt(pull * pull + 2 * stiffness * f);
        return [(pull + both) / stiffness, ((2 * sigma * (1 + beyond)) / width) * ((1 + pull / both) / stiffness)];
      };
      return this.branch((sigma, d_eq) => {
        const beyond = this.edge(half_width, sigma, d_eq);
        if (!(beyond > LEAST && beyond < LARGEST))
          throw new NoEquilibriumError(
            `no contact bears ${show(f)} N/m under an attraction of ${show(sigma, 3)} Pa; try a smaller voltage ` +
              "or another force");
        return [half_width(beyond, sigma)[0], beyond];
      }, f, voltage);
    }
    over_length(length, f, voltage) {
      const half = [length / 2, 0];
      return this.branch((sigma, d_eq) => {
        const beyond = this.edge(() => half, sigma, d_eq);
        if (beyond >= LARGEST)
          throw new NoEquilibriumError(
            `a contact of ${show(length, 3)} m is too short for an attraction that reaches ` +
              `${show(this.h_0 + 2 * d_eq, 3)} m; try a longer one`);
        return [half[0], beyond];
      }, f, voltage);
    }
    /** Return m - 1 where the gap at c, which grows with m, is the reach of the attraction; an end beyond all. */
    edge(half_width, sigma, d_eq) {
      const reach = this.h_0 + 2 * d_eq, { radius } = this, pull = (4 * sigma) / (Math.PI * this.modulus);
      const opening = (y) => { // the logarithm of the gap over the reach, and its slope over y = ln(m - 1)
        const beyond = Math.exp(y), m = 1 + beyond, width = Math.sqrt(beyond * (2 + beyond));
        const angle = Math.asinh(width), log = Math.log1p(beyond);
        const round = m * width - angle, pulled = width * angle - m * log, [a, slope] = half_width(beyond, sigma);
        const gap = ((a * a) / (2 * radius)) * round + pull * a * pulled;
        const grows = slope * ((a / radius) * round + pull * pulled) + ((a * a) / radius) * width + pull * a * ((m / width) * angle - log);
        return [Math.log(gap / reach), (beyond * grows) / gap];
      };
      let low = Math.log(LEAST), high = Math.log(LARGEST), y = 0;
      if (opening(high)[0] < 0) return LARGEST;
      if (opening(low)[0] > 0) return LEAST;
      for (let k = 0; k < 100; k++) { // Newton's method between bounds
        const [value, slope] = opening(y), next = y - value / slope;
        if (value < 0) low = y;
        else high = y;
        const small = Math.abs(next - y) <= 1e-9 + 1e-15 * Math.exp(-y);
        y = small || (next > low && next < high) ? next : (low + high) / 2;
        if (small) break;
      }
      return Math.exp(y);
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
      mu_app: f_t / p.f_ext, f_ext: p.f_ext, f_t, f_contact, f_electrostatic: n * ridge.f_attraction,
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

  // -- the whole finger: slices/ ---------------------------------------------------------------------------
  /** Return monotone cubics through points, as SciPy's PchipInterpolator. */
  function pchip(x, y) {
    const n = x.length, h = x.slice(1).map((v, k) => v - x[k]), m = h.map((v, k) => (y[k + 1] - y[k]) / v);
    const end = (h_0, h_1, m_0, m_1) => {
      const d = ((2 * h_0 + h_1) * m_0 - h_0 * m_1) / (h_0 + h_1);
      if (Math.sign(d) !== Math.sign(m_0)) return 0;
      return Math.sign(m_0) !== Math.sign(m_1) && Math.abs(d) > 3 * Math.abs(m_0) ? 3 * m_0 : d;
    };
    const d = x.map((_, k) => {
      if (k === 0) return end(h[0], h[1], m[0], m[1]);
      if (k === n - 1) return end(h[n - 2], h[n - 3], m[n - 2], m[n - 3]);
      if (m[k - 1] * m[k] <= 0) return 0;
      const a = 2 * h[k] + h[k - 1], b = h[k] + 2 * h[k - 1];
      return (a + b) / (a / m[k - 1] + b / m[k]);
    });
    return (v) => {
      let k = 0;
      while (k < n - 2 && v >= x[k + 1]) k++;
      const t = (v - x[k]) / h[k], c = (3 * m[k] - 2 * d[k] - d[k + 1]) * h[k], b = (d[k] + d[k + 1] - 2 * m[k]) * h[k];
      return y[k] + t * (d[k] * h[k] + t * (c + t * b));
    };
  }

  /** Return the trace of a state up to a force per metre: its last indentation, and its columns at an indentation. */
  function trace(p, state, top) {
    const kind = state === "full_slip" ? state : "charged", voltage = state === "uncharged" ? 0 : p.voltage;
    const forces = geomspace(top * data.traces.light, top, data.traces.forces), columns = {};
    const add = (name, value) => (columns[name] = columns[name] || []).push(value);
    for (const f_ext of forces) {
      const known = fitted(f_ext), n = known.ridges[kind], ridge = ridge_of({ ...p, f_ext, voltage }, known, kind);
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

  /** Return the whole finger under p.force (N) in its last state, full slip with friction; and the section at its centre. */
  function whole(p) {
    const { start, margin, more, tries, shortest, largest } = data.traces;
    const states = ["uncharged", ...(p.voltage ? ["charged"] : []), ...(p.friction ? ["full_slip"] : [])];
    let top = start.line * (p.force / start.point) ** start.power * margin, made, delta, centre;
    for (const state of states) {
      for (let k = 0; ; k++) {
        const asked = Math.min(Math.max(top, shortest), largest);
        try {
          made = trace(p, state, asked);
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
    return { mu_app: f_t / p.force, f_t, ...total, indentation: delta, centre, section: solve({ ...p, f_ext: centre }) };
  }

  return { NoEquilibriumError, solve, given, whole, refuse, show, erfc, pchip };
})();
