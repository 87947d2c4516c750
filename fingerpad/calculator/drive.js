/* Friction over the period of a drive, a copy of the Python one with its names:
 *   conductivity            variational/attraction/dielectric.py
 *   gain                    variational/attraction/circuit.py
 *   across, instants        fingerpad/scene/supply.py
 *   over_period             fingerpad/runs/drive.py
 * with fewer samples and gaps. tests/test_calculator.py compares the answers of both. SI units. */
"use strict";

const drive = (function () {
  const SAMPLES = 1024, POINTS = 11, GAPS = 41, ITERATIONS = 30;
  const TURN = Array.from({ length: SAMPLES }, (_, k) => (2 * Math.PI * k) / SAMPLES).map((a) => [Math.cos(a), Math.sin(a)]);
  const multiply = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
  const divide = ([a, b], [c, d]) => multiply([a, b], [c, -d]).map((v) => v / (c * c + d * d));

  /** Return the complex conductivity (S/m) of a tissue at a frequency (Hz) above 0. */
  function conductivity(tissue, f) {
    const omega = 2 * Math.PI * f;
    let eps = [tissue.eps_inf, 0];
    for (const [delta, tau, alpha] of tissue.terms) {
      const size = (omega * tau) ** (1 - alpha), angle = ((1 - alpha) * Math.PI) / 2;
      const term = divide([delta, 0], [1 + size * Math.cos(angle), size * Math.sin(angle)]);
      eps = [eps[0] + term[0], eps[1] + term[1]];
    }
    return [tissue.sigma - omega * data.eps_0 * eps[1], omega * data.eps_0 * eps[0]];
  }

  /** Return E g / U at a frequency (Hz) and a gap (m); circuit: tissue and leak (ohm m²), Infinity without one. */
  function gain(f, g, p, circuit) {
    const { tissue, leak } = circuit, d_i = p["electric.d_i"], eps_i = p["electric.eps_i"];
    if (f === 0) {
      if (leak < Infinity) return [0, 0];
      return [g / (g + d_i / eps_i + (tissue.sigma ? 0 : data.sc_thickness / tissue.eps_inf)), 0];
    }
    const s = [0, 2 * Math.PI * f], skin = divide([0, s[1] * data.sc_thickness], conductivity(tissue, f));
    const behind = [d_i / (data.eps_0 * eps_i) + skin[0], skin[1]];
    const [a, b] = multiply(behind, [data.eps_0 / g, -1 / (leak * s[1])]);
    return divide([1, 0], [1 + a, b]);
  }

  /** Return a period of a drive of a frequency (Hz): sine, square or triangle of an amplitude about an offset (V). */
  function period({ waveform, offset }, amplitude) {
    return Array.from({ length: SAMPLES }, (_, k) => {
      const phase = k / SAMPLES;
      const shape = waveform === "sine" ? Math.sin(2 * Math.PI * phase)
        : waveform === "triangle" ? 1 - Math.abs(((4 * phase + 1) % 4) - 2)
          : phase < 0.5 ? 1 : -1; // at a jump the value behind it
      return offset + amplitude * shape;
    });
  }

  /** Return the sums over k of values[k] exp(sign 2 pi i j k / n) for all j, of complex values, by halves. */
  function transform(values, sign) {
    const n = values.length;
    if (n === 1) return values;
    const [even, odd] = [0, 1].map((rest) => transform(values.filter((_, k) => k % 2 === rest), sign));
    const turned = odd.map((v, k) => multiply(v, [TURN[(k * SAMPLES) / n][0], sign * TURN[(k * SAMPLES) / n][1]]));
    return [1, -1].flatMap((half) => even.map(([re, im], k) => [re + half * turned[k][0], im + half * turned[k][1]]));
  }

  /** Return the Fourier series of samples: complex amplitudes at the multiples from 0 on. */
  function series(values) {
    return transform(values.map((v) => [v, 0]), -1).slice(0, SAMPLES / 2 + 1)
      .map((c, k) => c.map((v) => (v * (k && k < SAMPLES / 2 ? 2 : 1)) / SAMPLES));
  }

  function samples(amplitudes) {
    const all = Array.from({ length: SAMPLES }, (_, k) => amplitudes[k] || [0, 0]);
    return transform(all, 1).map(([re]) => re);
  }

  /** Return friction over a period: time, voltage, sigma_el, f_t and the amplitudes of f_t; answer: of a voltage alone. */
  function over_period(p, asked, circuit, answer) {
    const u = period(asked, p.voltage), spectrum = series(u);
    const h_0 = data.sc_thickness / p["electric.eps_sc"] + p["electric.d_i"] / p["electric.eps_i"];
    const solve = (voltage) => {
      const found = answer({ ...p, voltage });
      if (typeof found === "string") throw new closedForm.NoEquilibriumError(found);
      return { f_t: found.f_t, d_eq: (found.section || found).d_eq };
    };
    const still = solve(0), gaps = Array.from({ length: GAPS }, (_, k) => 0.5 * still.d_eq * 2.4 ** (k / (GAPS - 1)));
    const own = circuit || { tissue: { eps_inf: p["electric.eps_sc"], terms: [], sigma: 0 }, leak: Infinity };
    const table = gaps.map((g) => samples(spectrum.map((c, k) => multiply(c, gain(k * asked.frequency, g, p, own))))
      .map((v) => (v * (h_0 + g)) / g));
    const most = Math.max(...table.filter((_, k) => gaps[k] >= 0.7 * still.d_eq && gaps[k] <= still.d_eq).flat().map(Math.abs), 1e-9);
    const squares = Array.from({ length: POINTS }, (_, k) => (most ** 2 * k) / (POINTS - 1));
    const known = squares.map((square, k) => (k ? solve(Math.sqrt(square)) : still));
    const friction = numerics.pchip(squares, known.map((v) => v.f_t)), gap = numerics.pchip(squares, known.map((v) => v.d_eq));
    const sigma_el = [], f_t = [];
    for (let j = 0; j < SAMPLES; j++) {
      let g = still.d_eq, volts = 0;
      for (let k = 0; k < ITERATIONS; k++) {
        const place = Math.min(Math.max((Math.log(g / gaps[0]) / Math.log(2.4)) * (GAPS - 1), 0), GAPS - 1.000001), low = Math.floor(place);
        volts = Math.min(Math.abs((low + 1 - place) * table[low][j] + (place - low) * table[low + 1][j]), most);
        const next = gap(volts ** 2);
        if (Math.abs(next - g) < 1e-10 * g) break;
        g = next;
      }
      f_t.push(friction(volts ** 2));
      sigma_el.push((data.eps_0 / 2) * (volts / (h_0 + g)) ** 2);
    }
    const time = u.map((_, k) => k / SAMPLES / asked.frequency), mean = (list) => list.reduce((a, b) => a + b, 0) / list.length;
    const amplitudes = series(f_t).map(([re, im]) => Math.hypot(re, im));
    const rms = Math.sqrt(mean(u.map((v) => v * v))), sigma_mean = mean(sigma_el);
    return { time, u, sigma_el, f_t, amplitudes, mean: mean(f_t), low: Math.min(...f_t), high: Math.max(...f_t), rms, sigma_mean };
  }

  return { over_period, gain, period };
})();
