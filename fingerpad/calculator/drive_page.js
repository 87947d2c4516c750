/* The part of the page on an alternating voltage: its fields, friction over a period, and three curves over time. */
const drivePage = (function () {
  const { show } = numerics;
  const find = (id) => document.getElementById("drive_" + id);
  const WAVEFORMS = ["sine", "square", "triangle"];
  const BOUNDS = { frequency: [1e-3, 1e6, "Hz"], offset: [-500, 500, "V"] };

  function element(name, attributes, text) {
    const found = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) found.setAttribute(key, value);
    if (text !== undefined) found.textContent = text;
    return found;
  }

  /** Draw values over a period into a box, between round numbers at either side. */
  function curve(box, time, values, label, per, lowest) {
    const width = Math.max(box.clientWidth, 260), height = 150, left = 62, right = width - 14, top = 10, bottom = height - 34;
    const shown = values.map((v) => v * per), low = Math.min(...shown, lowest), high = Math.max(...shown), span = high - low || 1;
    const end = time[time.length - 1] + time[1], x = (t) => left + (t / end) * (right - left), y = (v) => bottom - ((v - low) / span) * (bottom - top);
    const svg = element("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${label} over a period` });
    for (const v of [low, (low + high) / 2, high]) {
      svg.append(element("line", { x1: left, x2: right, y1: y(v), y2: y(v), stroke: "#ddd" }));
      svg.append(element("text", { x: left - 6, y: y(v) + 4, "text-anchor": "end" }, show(v, 3)));
    }
    for (const [t, anchor] of [[0, "start"], [end / 2, "middle"], [end, "end"]])
      svg.append(element("text", { x: x(t), y: bottom + 17, "text-anchor": anchor }, `${show(1e3 * t, 3)} ms`));
    const points = time.map((t, k) => `${x(t).toFixed(2)},${y(shown[k]).toFixed(2)}`).join(" ");
    svg.append(element("polyline", { points, fill: "none", stroke: "#0072b2", "stroke-width": 2 }));
    const up = { x: 0, y: 0, transform: `translate(12 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" };
    svg.append(element("text", up, label));
    box.replaceChildren(svg);
  }

  /** Return the drive of the fields, null where one is refused, which is said. */
  function read() {
    const asked = { waveform: find("waveform").value, circuit: find("circuit").value };
    for (const [key, [low, high, unit]] of Object.entries(BOUNDS)) {
      const text = find(key).value, value = Number(text), inside = text.trim() !== "" && value >= low && value <= high;
      find(key).setAttribute("aria-invalid", !inside);
      if (!inside) {
        find("said").textContent = `${key} is ${text.trim() || "no number"}; it must be from ${show(low)} to ${show(high)} ${unit}.`;
        return null;
      }
      asked[key] = value;
    }
    return asked;
  }

  /** Show the friction of a drive whose amplitude is the voltage of the page; answer: full slip of values, or why not. */
  function update(values, given, answer) {
    const asked = read(), boxes = ["u", "sigma", "friction"].map(find);
    if (!asked) return boxes.forEach((box) => box.replaceChildren());
    const circuit = data.circuits[asked.circuit], unit = values.newtons ? "N" : "N/m";
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
    find("said").textContent = `Friction: mean ${show(found.mean, 4)} ${unit}, from ${show(found.low, 4)} to ${show(found.high, 4)} ${unit}; ` +
      `amplitudes ${at(1)}, ${at(2)}. U: amplitude ${show(values.voltage, 4)} V, peak to peak ${show(2 * values.voltage, 4)} V, ` +
      `rms ${show(found.rms, 4)} V. Mean attraction ${show(found.sigma_mean / 1e3, 3)} kPa. ${circuit.words}`;
    find("said").dataset.values = JSON.stringify({ mean: found.mean, low: found.low, high: found.high, f: found.amplitudes[1], f2: found.amplitudes[2] });
    curve(boxes[0], found.time, found.u, "U (V)", 1, 0);
    curve(boxes[1], found.time, found.sigma_el, "σ_el (kPa)", 1e-3, 0);
    curve(boxes[2], found.time, found.f_t, `F_T (${unit})`, 1, Infinity);
    boxes.forEach((box) => { box.hidden = false; });
  }

  /** Fill the choices, and call a function at every change of a field. */
  function begin(changed) {
    const add = (select, value, words) => select.append(Object.assign(document.createElement("option"), { value, textContent: words }));
    WAVEFORMS.forEach((name) => add(find("waveform"), name, name));
    for (const name of Object.keys(data.circuits)) add(find("circuit"), name, name === "lossless" ? name : `skin, ${name}`);
    for (const id of ["waveform", "circuit", "frequency", "offset"]) find(id).oninput = changed;
  }

  return { begin, update };
})();
