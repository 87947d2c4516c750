/* The part of the page on an alternating voltage: friction over a period, and three curves over time. */
const drivePage = (function () {
  const { show } = numerics;
  const find = (id) => document.getElementById("drive_" + id);

  /** Draw values over a period into a box, between round numbers at either side. */
  function curve(box, time, values, words, per, zero) {
    const shown = values.map((v) => v * per), low = Math.min(...shown, zero ? 0 : Infinity), high = Math.max(...shown, zero ? 0 : -Infinity);
    const end = 1e3 * (time[time.length - 1] + time[1]), margin = high > low ? 0 : Math.abs(high) || 1;
    const of = plot.frame(box, { low: 0, high: end, log: false, words: "time (ms)" }, { low: low - margin, high: high + margin, log: false, words }, `${words} over a period`, 0, 180);
    const points = time.map((t, k) => `${of.x.at(1e3 * t).toFixed(2)},${of.y.at(shown[k]).toFixed(2)}`).join(" ");
    of.svg.append(plot.element("polyline", { points, fill: "none", stroke: plot.colour("line"), "stroke-width": 2 }));
  }

  /** Show the friction of a drive whose amplitude is the voltage of the page; answer: full slip of values, or why not. */
  function update(values, given, texts, answer) {
    const boxes = ["u", "sigma", "friction"].map(find), circuit = data.circuits[texts.circuit], unit = values.newtons ? "N" : "N/m";
    const asked = { waveform: texts.waveform, frequency: values.frequency, offset: values.offset };
    let found;
    try {
      if (given) throw new closedForm.NoEquilibriumError("a contact as given is that of one voltage");
      found = drive.over_period(values, asked, circuit.tissue && { tissue: circuit.tissue, leak: circuit.leak || Infinity }, answer);
    } catch (error) {
      if (!(error instanceof closedForm.NoEquilibriumError)) throw error;
      find("said").textContent = `No answer for this drive: ${error.message}.`;
      return boxes.forEach((box) => box.replaceChildren());
    }
    const at = (k) => `${show(found.amplitudes[k] > 1e-6 * found.mean ? found.amplitudes[k] : 0, 3)} ${unit} at ${show(k * asked.frequency)} Hz`;
    find("said").textContent = `Friction${values.newtons ? " of the whole finger" : " of the section"}: mean ${show(found.mean, 4)} ${unit}, from ${show(found.low, 4)} to ${show(found.high, 4)} ${unit}; ` +
      `amplitudes ${at(1)}, ${at(2)}. U: amplitude ${show(values.voltage, 4)} V, peak to peak ${show(2 * values.voltage, 4)} V, ` +
      `rms ${show(found.rms, 4)} V. Mean attraction ${show(found.sigma_mean / 1e3, 3)} kPa. ${circuit.words}`;
    find("said").dataset.values = JSON.stringify({ mean: found.mean, low: found.low, high: found.high, f: found.amplitudes[1], f2: found.amplitudes[2] });
    curve(boxes[0], found.time, found.u, "U (V)", 1, true);
    curve(boxes[1], found.time, found.sigma_el, "σ_el (kPa)", 1e-3, true);
    return curve(boxes[2], found.time, found.f_t, `${values.newtons ? "F_T" : "f_T"} (${unit})`, 1, false);
  }

  /** Fill the choices. */
  function options() {
    form.options("waveform", Object.fromEntries(state.CHOICES.waveform.map((name) => [name, name])));
    form.options("circuit", Object.fromEntries(Object.keys(data.circuits).map((name) => [name, name === "lossless" ? name : `skin, ${name}`])));
  }

  return { options, update };
})();
