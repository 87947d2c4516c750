"use strict";
// Charts of a report by Plotly, from the data in the page. Curves differ in dash and marker as well as in colour.
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const get = (id) => document.getElementById(id);
  const BLUE = "#0072B2", ORANGE = "#B36B00", GREEN = "#009E73", BLACK = "#000000", GREY = "#666666";
  const COLOURS = [BLUE, "#D55E00", GREEN, "#CC79A7", "#56B4E9", "#E69F00", BLACK];
  const DASHES = ["solid", "dash", "dot", "dashdot", "longdash", "longdashdot"];
  const MARKERS = ["circle", "square", "triangle-up", "diamond", "triangle-down", "cross", "x"];
  const narrow = () => document.documentElement.clientWidth < 600;
  document.documentElement.classList.add("js");

  function axis(title, more) {
    return Object.assign({ title: { text: title }, zeroline: false, showline: true, ticks: "outside",
      automargin: true, gridcolor: "#e5e5e5" }, more || {});
  }
  function layout(height, more) {
    return Object.assign({ height, autosize: true, margin: { l: 56, r: 12, t: 28, b: 44 }, hovermode: "closest",
      font: { family: "system-ui, DejaVu Sans, sans-serif", size: narrow() ? 11 : 13, color: "#1a1a1a" },
      legend: { orientation: "h", x: 0, xanchor: "left", y: 1.02, yanchor: "bottom" } }, more);
  }
  const config = () => ({ responsive: true, displaylogo: false, displayModeBar: false, scrollZoom: false });
  function draw(id, traces, how) {
    if (get(id)) Plotly.react(get(id), traces, how, config());
  }
  const bars = (error, colour) => error.some((e) => e !== null)
    ? { type: "data", array: error.map((e) => e || 0), color: colour, thickness: 1.5, width: 5 } : undefined;

  // -- friction and contact length over sliding -------------------------------------------------------
  function sliding() {
    const s = data.steps, first = s.first[0], cut = (name) => s[name].slice(first);
    const x = cut("bone_x"), jump = cut("jump"), steps = cut("step");
    const at = (name) => x.map((_, k) => `step ${steps[k]}: ${name}`);
    const line = (name, y, yaxis, dash, marker, colour) => ({ x, y: cut(y), name, yaxis, text: at(name),
      mode: "lines+markers", line: { color: colour, dash }, marker: { symbol: marker, size: 6 },
      hovertemplate: "%{text}<br>x %{x:.4g} mm<br>%{y:.4g}<extra></extra>" });
    const traces = [line("friction µ<sub>app</sub>", "mu_app", "y", "solid", "circle", BLACK),
      line("contact length L<sub>R</sub>", "contact_length", "y2", "dash", "square", BLUE)];
    for (const [y, yaxis] of [["mu_app", "y"], ["contact_length", "y2"]]) {
      const values = cut(y), hit = jump.map((j, k) => (j ? k : -1)).filter((k) => k >= 0);
      if (hit.length) traces.push({ x: hit.map((k) => x[k]), y: hit.map((k) => values[k]), yaxis, name: "jump", mode: "markers",
        showlegend: yaxis === "y", marker: { symbol: "x-thin", size: 12, color: "#D55E00", line: { width: 2.5, color: "#D55E00" } },
        hovertemplate: "jump at %{x:.4g} mm<extra></extra>" });
      const known = data.errors.filter((e) => e[y] !== null && e[y + "_error"] !== null && e.bone_x !== null);
      if (known.length) traces.push({ x: known.map((e) => e.bone_x), y: known.map((e) => e[y]), yaxis, mode: "markers",
        name: "± discretisation error", showlegend: yaxis === "y", text: known.map((e) => e.name),
        error_y: bars(known.map((e) => e[y + "_error"]), GREY), marker: { symbol: "diamond-open", size: 10, color: GREY },
        hovertemplate: "%{text}: %{y:.4g}<extra></extra>" });
    }
    const shapes = x.filter((_, k) => jump[k]).map((at) => ({ type: "line", x0: at, x1: at, y0: 0, y1: 1, yref: "paper",
      line: { color: GREY, width: 1, dash: "dot" }, layer: "below" }));
    draw("friction", traces, layout(520, { shapes, margin: { l: 60, r: 12, t: 60, b: 44 },
      yaxis: axis("µ<sub>app</sub> (–)", { domain: [0.54, 1] }), yaxis2: axis("L<sub>R</sub> (mm)", { domain: [0, 0.46], title: { text: "L<sub>R</sub> (mm)", standoff: 8 } }),
      xaxis: axis("sideways displacement of the bone (mm)", { anchor: "y2" }) }));
  }

  function work() {
    const s = data.steps, text = s.step.map((n, k) => s.load[k]);
    const bar = (name, key, colour, shape) => ({ type: "bar", x: s.step, y: s[key], name, text, textposition: "none",
      marker: { color: colour, line: { color: colour, width: 1 },
        pattern: { shape, fillmode: "replace", fgcolor: colour, bgcolor: "#fff", size: 5 } },
      hovertemplate: `step %{x} (%{text}): %{y} ${name}<extra></extra>` });
    const traces = [bar("Newton iterations", "newton_iterations", BLUE, ""), bar("factorisations", "factorisations", "#D55E00", "/")];
    const cut = s.step.map((n, k) => k).filter((k) => s.cutbacks[k]);
    if (cut.length) traces.push({ x: cut.map((k) => s.step[k]), y: cut.map(() => 0), mode: "markers", name: "cut step",
      text: cut.map((k) => `cut ${s.cutbacks[k]} times`), marker: { symbol: "triangle-up", size: 11, color: BLACK },
      hovertemplate: "step %{x}: %{text}<extra></extra>" });
    draw("work", traces, layout(320, { barmode: "group", xaxis: axis("step"), yaxis: axis("number (–)") }));
  }

  // -- the finger ---------------------------------------------------------------------------------------
  const view = data.finger && data.finger.view, frames = (data.finger && data.finger.frames) || [];
  const highest = Math.max(...frames.map((f) => (f.finger ? f.finger.highest : -9)));
  let now = frames.length - 1, ridge = null;

  function image(finger) {
    if (finger.z) return finger.z;
    const bytes = Uint8Array.from(atob(finger.image), (c) => c.charCodeAt(0));
    const numbers = new DataView(bytes.buffer), [rows, columns] = finger.shape;
    finger.z = []; finger.kpa = [];
    for (let r = 0; r < rows; r++) {
      const z = [], kpa = [];
      for (let c = 0; c < columns; c++) {
        const level = numbers.getInt16(2 * (r * columns + c), true);
        z.push(level === 32767 ? null : level / 100);
        kpa.push(level === 32767 ? null : Math.pow(10, level / 100));
      }
      finger.z.push(z); finger.kpa.push(kpa);
    }
    return finger.z;
  }
  function ticks() {
    const found = [];
    for (let k = Math.ceil(highest - 3); k <= highest; k++) found.push(k);
    return found;
  }
  function body() {
    const finger = frames[now].finger, traces = [], annotations = [], range = along();
    const wide = (get("body").clientWidth || 700) - 78;
    const high = Math.max(90, wide * (view[3] - view[2]) / (range[1] - range[0]));
    if (finger) {
      traces.push({ type: "heatmap", z: image(finger), customdata: finger.kpa, x0: finger.x[0], dx: finger.x[1],
        y0: finger.y[0], dy: finger.y[1], zmin: highest - 3, zmax: highest, colorscale: "Viridis",
        hovertemplate: "x %{x:.3f} mm, y %{y:.3f} mm<br>energy density %{customdata:.3g} kPa<extra></extra>",
        colorbar: { orientation: "h", y: -22 / high, yanchor: "top", thickness: 10, len: 0.9, tickvals: ticks(),
          ticktext: ticks().map((k) => String(Number(Math.pow(10, k).toPrecision(1)))),
          title: { text: "strain energy density (kPa)", side: "bottom" } } });
      const x = [], y = [];
      for (const [a, b, c, d] of finger.lines) { x.push(a / 1e4, c / 1e4, null); y.push(b / 1e4, d / 1e4, null); }
      traces.push({ x, y, mode: "lines", line: { color: "#000", width: 0.8 }, hoverinfo: "skip" });
    } else {
      traces.push({ x: [], y: [] });
      annotations.push({ text: "no image of this state was saved", x: 0.5, y: 0.5, xref: "paper", yref: "paper", showarrow: false });
    }
    const mine = current();
    if (mine) {
      annotations.push({ x: middle(mine), y: 0, text: `▲ ${mine.ridge}`, showarrow: false, yanchor: "top", font: { size: 13 } });
    }
    draw("body", traces, layout(Math.round(high + 90), { showlegend: false, annotations, margin: { l: 66, r: 12, t: 4, b: 86 },
      shapes: [{ type: "line", x0: view[0], x1: view[1], y0: 0, y1: 0, line: { width: 3, color: "#000" } }],
      xaxis: axis("", { range, fixedrange: narrow() }),
      yaxis: axis("y (mm)", { range: [view[2], view[3]], fixedrange: narrow() }) }));
  }
  const middle = (r) => {
    const known = r.x.filter((v) => v !== null);
    return (Math.min(...known) + Math.max(...known)) / 2;
  };
  // On a phone the ridge that was chosen and its neighbours, within the image; elsewhere all that touch.
  function along() {
    const mine = current(), half = Math.min(1.2, (view[1] - view[0]) / 2);
    if (!narrow() || !mine) return [view[0], view[1]];
    const at = Math.min(Math.max(middle(mine), view[0] + half), view[1] - half);
    return [at - half, at + half];
  }
  const current = () => frames[now].skin.find((r) => r.ridge === ridge);
  function joined(key) {
    const found = [];
    for (const r of frames[now].skin) found.push(...r[key], null);
    return found;
  }
  const largest = Math.max(1e-9, ...frames.flatMap((f) => f.skin.flatMap((r) => [...r.p, ...r.p_el].filter((v) => v !== null))));
  const lowest = Math.min(0, ...frames.flatMap((f) => f.skin.flatMap((r) => r.t.filter((v) => v !== null))));
  const STRESS = [["p", "contact pressure", "solid", BLACK], ["p_el", "attraction", "dash", BLUE],
    ["t", "shear traction", "dot", ORANGE]];
  function skin() {
    const x = joined("x");
    const traces = STRESS.map(([key, name, dash, color]) => ({ x, y: joined(key), name, mode: "lines",
      line: { color, dash, width: 1.6 }, hovertemplate: `${name} %{y:.3g} kPa<extra></extra>` }));
    const mine = current(), shapes = [];
    if (mine) {
      const known = mine.x.filter((v) => v !== null);
      shapes.push({ type: "rect", x0: Math.min(...known), x1: Math.max(...known), y0: 0, y1: 1, yref: "paper",
        fillcolor: "#000", opacity: 0.08, line: { width: 1, dash: "dot", color: "#000" } });
    }
    draw("skin", traces, layout(narrow() ? 230 : 280, { shapes, margin: { l: 66, r: 12, t: narrow() ? 52 : 36, b: 44 },
      xaxis: axis("x on the screen (mm)", { range: along(), fixedrange: narrow() }),
      yaxis: axis("stress (kPa)", { range: [1.05 * lowest, 1.08 * largest], fixedrange: narrow() }) }));
  }
  function one() {
    const mine = current();
    if (!mine) { get("under").textContent = ""; draw("one", [], layout(260, {})); return; }
    const traces = STRESS.map(([key, name, dash, color]) => ({ x: mine.x, y: mine[key], name, mode: "lines",
      line: { color, dash, width: 2 }, hovertemplate: `${name} %{y:.3g} kPa<extra></extra>` }));
    traces.push({ x: mine.x, y: mine.y, yaxis: "y2", name: "height of the skin (µm)", mode: "lines",
      line: { color: GREY, width: 1.5, dash: "longdash" }, hovertemplate: "height %{y:.3g} µm<extra></extra>" });
    if (mine.gap !== null) traces.push({ x: mine.x.map((v) => v), y: mine.x.map((v) => (v === null ? null : mine.gap)), yaxis: "y2",
      name: "equivalent air gap d<sub>eq</sub> (µm)", mode: "lines", line: { color: GREEN, width: 3 }, hovertemplate: "air gap %{y:.3g} µm<extra></extra>" });
    draw("one", traces, layout(narrow() ? 430 : 400, { margin: { l: 56, r: 12, t: narrow() ? 110 : 60, b: 44 },
      yaxis: axis("stress (kPa)", { domain: [0.45, 1] }), yaxis2: axis("gap (µm)", { domain: [0, 0.36], range: [-0.5, 8] }),
      xaxis: axis(`x along ridge ${mine.ridge} (mm)`, { anchor: "y2" }) }));
    const top = (key) => Math.max(0, ...mine[key].filter((v) => v !== null));
    get("under").textContent = mine.length > 0
      ? `contact length ${mine.length.toFixed(3)} mm · pressure ${mine.mean.toFixed(1)} kPa mean, ${top("p").toFixed(1)} kPa highest · ` +
        `attraction up to ${top("p_el").toFixed(1)} kPa · air gap ${mine.gap === null ? "–" : mine.gap.toFixed(2) + " µm"}`
      : `not in contact · attraction up to ${top("p_el").toFixed(1)} kPa`;
  }
  function choose(number) {
    if (number === ridge) return;
    ridge = number;
    get("ridge").value = String(number);
    body(); skin(); one();
  }
  function nearest(x) {
    let best = null, least = Infinity;
    for (const r of frames[now].skin) {
      const away = Math.abs(middle(r) - x);
      if (away < least) { least = away; best = r.ridge; }
    }
    if (best !== null) choose(best);
  }
  function step(k) {
    now = Math.min(Math.max(k, 0), frames.length - 1);
    const frame = frames[now];
    get("state").value = String(now);
    get("state").setAttribute("aria-valuetext", frame.label);
    get("states").value = String(now);
    get("about").innerHTML = `${now + 1} of ${frames.length}: ${frame.about}`;
    const numbers = frame.skin.map((r) => r.ridge);
    get("ridge").replaceChildren(...numbers.map((n) => new Option(`${n}`, `${n}`)));
    if (!numbers.includes(ridge)) ridge = numbers.length ? numbers.reduce((a, b) => (Math.abs(b) < Math.abs(a) ? b : a)) : null;
    get("ridge").value = String(ridge);
    body(); skin(); one();
  }
  function finger() {
    get("state").addEventListener("input", (event) => step(Number(event.target.value)));
    get("states").addEventListener("change", (event) => step(Number(event.target.value)));
    get("ridge").addEventListener("change", (event) => choose(Number(event.target.value)));
    get("back").addEventListener("click", () => step(now - 1));
    get("forth").addEventListener("click", () => step(now + 1));
    step(now);
    for (const id of ["body", "skin"]) get(id).on("plotly_hover", (event) => {
      if (event.xvals && event.xvals.length) nearest(event.xvals[0]);
      else if (event.points.length) nearest(Number(event.points[0].x));
    });
    for (const id of ["body", "skin"]) get(id).on("plotly_click", (event) => nearest(Number(event.points[0].x)));
  }

  // -- what is felt -----------------------------------------------------------------------------------
  function felt() {
    const f = data.felt, states = f.states, slider = get("moment"), end = states[states.length - 1].t;
    const top = Math.max(1, ...states.flatMap((s) => [...s.p, ...s.merkel])), low = Math.min(0, ...states.flatMap((s) => s.merkel));
    const parts = f.units.map((u) => (u.law === "PC" ? 0.3 : 1)), sum = parts.reduce((a, b) => a + b, 0);
    let above = 1;
    const domains = parts.map((part) => { const high = above, size = part / sum; above -= size; return [above + 0.06 * size, high - 0.06 * size]; });
    function raster(t) {
      const traces = f.units.map((u, k) => ({ x: u.t, y: u.ridge, yaxis: k ? `y${k + 1}` : "y", mode: "markers", name: u.law,
        marker: { symbol: "line-ns-open", size: narrow() ? 5 : 7, color: [BLUE, "#D55E00", BLACK][k % 3], line: { width: 1.5 } },
        hovertemplate: `${u.law}, ridge %{y:.0f}<br>%{x:.2f} ms<extra></extra>` }));
      const line = (x, color, dash) => ({ type: "line", x0: x, x1: x, y0: 0, y1: 1, yref: "paper", line: { color, width: 1, dash } });
      const axes = {};
      f.units.forEach((u, k) => { axes[k ? `yaxis${k + 1}` : "yaxis"] = axis(u.law, { domain: domains[k], fixedrange: true,
        range: u.law === "PC" ? [-1, 1] : [f.ridges[0] - 1, f.ridges[f.ridges.length - 1] + 1], showticklabels: u.law !== "PC" }); });
      const named = f.loads.filter(([, a, b]) => b - a > (narrow() ? 0.15 : 0.06) * end);
      draw("raster", traces, layout(narrow() ? 380 : 440, Object.assign(axes, { showlegend: false,
        margin: { l: 60, r: 12, t: 28, b: 44 }, shapes: [line(t, BLACK, "solid"), ...f.loads.map(([, a]) => line(a, GREY, "dot"))],
        annotations: named.map(([name, a, b]) => ({ text: name, x: (a + b) / 2, y: 1, yref: "paper", yanchor: "bottom", showarrow: false })),
        xaxis: axis("time (ms)", { range: [0, end], anchor: f.units.length > 1 ? `y${f.units.length}` : "y" }) })));
    }
    function show() {
      const s = states[Number(slider.value)];
      get("then").textContent = `${s.t.toFixed(1)} ms: ${s.about}`;
      draw("touch", [{ type: "bar", x: f.ridges, y: s.p, name: "mean contact pressure", marker: { color: GREY },
        hovertemplate: "ridge %{x}: %{y:.3g} kPa<extra></extra>" },
      { x: f.ridges, y: s.merkel, name: "compressive stress at the Merkel site", mode: "markers", marker: { symbol: "diamond", size: 8, color: BLUE },
        hovertemplate: "ridge %{x}: %{y:.3g} kPa<extra></extra>" }], layout(260, { margin: { l: 60, r: 12, t: narrow() ? 70 : 40, b: 44 },
        xaxis: axis("ridge"), yaxis: axis("stress (kPa)", { range: [1.05 * low, 1.05 * top], fixedrange: true }) }));
      raster(s.t);
    }
    slider.addEventListener("input", show);
    show();
  }

  // -- a sweep ------------------------------------------------------------------------------------------
  function sweep() {
    for (const [key, title] of Object.entries(data.sweep.charts)) {
      const traces = data.sweep.curves.map((curve, k) => ({ x: curve.x, y: curve[key], name: curve.name || title,
        mode: "lines+markers", line: { color: COLOURS[k % COLOURS.length], dash: DASHES[k % DASHES.length] },
        marker: { symbol: MARKERS[k % MARKERS.length], size: 9 }, error_y: bars(curve[key + "_error"], COLOURS[k % COLOURS.length]),
        hovertemplate: `${curve.name}<br>%{x:.4g}: %{y:.4g}<extra></extra>` }));
      draw(key, traces, layout(320, { showlegend: data.sweep.curves.length > 1, margin: { l: 60, r: 12, t: 60, b: 44 },
        xaxis: axis(data.sweep.along), yaxis: axis(title, { rangemode: "tozero" }) }));
    }
  }

  if (frames.length) finger();
  if (get("friction")) sliding();
  if (get("work")) work();
  if (data.felt) felt();
  if (data.sweep) sweep();
})();
