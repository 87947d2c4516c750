/* What NumPy, SciPy and Python's format are to the Python programs: numerics.
 * tests/test_calculator.py compares the answers of the parts that use them with Python's. */
"use strict";

const numerics = (function () {
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

  /** Return a value with its error to two digits; without one that reaches the digits after the point. */
  function plus_minus(value, error, digits) {
    if (!(error >= 0.5 * 10 ** -digits)) return value.toFixed(digits);
    const after = Math.max(0, 1 - Math.floor(Math.log10(error)));
    return `${value.toFixed(after)} ± ${error.toFixed(after)}`;
  }

  return { geomspace, root, erfc, show, pchip, plus_minus };
})();
