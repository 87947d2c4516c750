/* Curves and their axes as inline SVG. A curve is solid with a band where its error is known, and dashed elsewhere; one to
 * compare with is dotted. Curves differ by their strokes, so that no colour is needed. Colours are those of the page. */
const plot = (function () {
  const MARGIN = { left: 58, right: 16, top: 14, bottom: 46 };
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

  function element(name, attributes, ...content) {
    const found = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) found.setAttribute(key, value);
    found.append(...content);
    return found;
  }

  /** Return round numbers within an axis, at most so many; of a logarithmic one 1, 2 and 5 times powers of ten. */
  function ticks({ low, high, log }, most) {
    if (log) {
      const found = [];
      for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++)
        found.push(...[1, 2, 5].map((k) => Number((k * 10 ** power).toPrecision(1))));
      const inside = found.filter((v) => v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9));
      return inside.length > most ? inside.filter((v) => String(v).replace(/[.0]/g, "") === "1") : inside;
    }
    const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough * (1 - 1e-9)), first = Math.ceil(low / step - 1e-9);
    return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(12)));
  }

  /** Return the map of an axis {low, high, log} onto pixels, and back. */
  function scale(axis, from, to) {
    const f = axis.log ? Math.log : (v) => v, g = axis.log ? Math.exp : (v) => v, a = f(axis.low), b = f(axis.high);
    return { at: (v) => from + ((f(v) - a) / (b - a)) * (to - from), back: (px) => g(a + ((px - from) / (to - from)) * (b - a)) };
  }

  /** Return an empty drawing in a box with two axes: its svg, places of the frame, and both scales. */
  function frame(box, x_axis, y_axis, title, right_margin, highest) {
    const width = Math.max(box.clientWidth, 260), height = Math.min(highest || 360, Math.max(240, Math.round(0.62 * width)));
    const left = MARGIN.left, right = width - (right_margin || MARGIN.right), top = MARGIN.top, bottom = height - MARGIN.bottom;
    const svg = element("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title, fill: colour("ink") });
    const x = scale(x_axis, left, right), y = scale(y_axis, bottom, top);
    for (const v of ticks(x_axis, width < 420 ? 5 : 9)) {
      svg.append(element("line", { x1: x.at(v), x2: x.at(v), y1: bottom, y2: bottom + 5, stroke: colour("ink") }));
      svg.append(element("text", { x: x.at(v), y: bottom + 19, "text-anchor": x.at(v) > right - 8 ? "end" : "middle" }, numerics.show(v)));
    }
    for (const v of ticks(y_axis, 6)) {
      svg.append(element("line", { x1: left, x2: right, y1: y.at(v), y2: y.at(v), stroke: colour("grid") }));
      svg.append(element("text", { x: left - 6, y: y.at(v) + 4, "text-anchor": "end" }, numerics.show(v)));
    }
    svg.append(element("line", { x1: left, x2: right, y1: bottom, y2: bottom, stroke: colour("ink") }));
    svg.append(element("text", { x: (left + right) / 2, y: height - 8, "text-anchor": "middle" }, x_axis.words));
    svg.append(element("text", { transform: `translate(13 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, y_axis.words));
    box.replaceChildren(svg);
    return { svg, x, y, left, right, top, bottom, width, height };
  }

  /** Return runs of neighbours that a test holds of, for a line that ends where it does not. */
  function runs(points, test) {
    const found = [];
    let open = null;
    for (const point of points) {
      if (!test(point)) { open = null; continue; }
      if (!open) found.push((open = []));
      open.push(point);
    }
    return found;
  }

  const path = (of, list) => list.map(([a, b]) => `${of.x.at(a).toFixed(2)},${of.y.at(b).toFixed(2)}`).join(" ");

  /* axis: {low, high, log, words} along x; points: {x, y, error}, in order, y null without an answer, error null where it is
   * not known; other: points of the dotted curve; goal: points of the target's line; mark: {x, y}; title: for readers;
   * read(x): [y, text] under the pointer; pick(x): what a click does. */
  function draw(box, { axis, words, points, other, goal, mark, title, read, pick }) {
    const answered = points.filter((p) => p.y !== null), all = [...answered, ...other, ...(mark ? [mark] : [])];
    const most = Math.max(1e-9, ...all.map((p) => p.y)) * 1.1, shown_goal = goal.filter((p) => p.y <= most);
    const of = frame(box, axis, { low: 0, high: most, log: false, words }, title), { svg } = of;
    const line = (list, attributes) => list.length > 1 && svg.append(element("polyline",
      { points: path(of, list.map((p) => [p.x, p.y])), fill: "none", ...attributes }));
    for (const list of runs(points, (p) => p.y !== null && p.error !== null)) {
      const edge = [...list.map((p) => [p.x, p.y * (1 + p.error)]), ...list.slice().reverse().map((p) => [p.x, p.y * (1 - p.error)])];
      svg.append(element("polygon", { points: path(of, edge), fill: colour("band"), "fill-opacity": 0.45, class: "band" }));
    }
    line(other, { stroke: colour("other"), "stroke-width": 2, "stroke-dasharray": "1 5", "stroke-linecap": "round", class: "other" });
    line(shown_goal, { stroke: colour("goal"), "stroke-width": 1.8, "stroke-dasharray": "10 3 2 3", class: "goal" });
    for (const list of runs(points, (p) => p.y !== null))
      line(list, { stroke: colour("line"), "stroke-width": 1.6, "stroke-dasharray": "7 4" });
    for (const list of runs(points, (p) => p.y !== null && p.error !== null)) line(list, { stroke: colour("line"), "stroke-width": 2.6, class: "solid" });
    if (mark) label(of, mark.x, mark.y, numerics.show(mark.y, 3), { r: 5.5, fill: colour("ink"), class: "mark" });
    hover(of, (px) => {
      const x = of.x.back(px), found = read(x);
      return found && { x, y: found[0], text: found[1] };
    }, pick);
  }

  function label(of, x, y, text, attributes) {
    const end = of.x.at(x) > (of.left + of.right) / 2, high = Math.max(of.y.at(y) - 10, of.top + 12);
    of.svg.append(element("circle", { cx: of.x.at(x), cy: of.y.at(y), ...attributes }),
      element("text", { x: of.x.at(x) + (end ? -9 : 9), y: high, "text-anchor": end ? "end" : "start", "font-weight": 600 }, text));
  }

  /** Show what is under the pointer, of a function of pixels, and let a click choose it. */
  function hover(of, under, pick) {
    const { svg } = of, shown = element("g", { "pointer-events": "none", class: "hover" });
    svg.append(shown);
    const place = (event) => {
      const rect = svg.getBoundingClientRect(), k = of.width / rect.width;
      const px = (event.clientX - rect.left) * k, py = (event.clientY - rect.top) * k;
      return px < of.left - 2 || px > of.right + 2 || py < of.top - 2 || py > of.bottom + 2 ? null
        : under(Math.min(Math.max(px, of.left), of.right), Math.min(Math.max(py, of.top), of.bottom));
    };
    svg.onpointermove = (event) => {
      const found = place(event);
      shown.replaceChildren();
      if (!found) return;
      const x = of.x.at(found.x), y = of.y.at(found.y), width = 7.2 * found.text.length + 10, left = Math.min(Math.max(x - width / 2, 0), of.width - width);
      shown.append(element("line", { x1: x, x2: x, y1: of.top, y2: of.bottom, stroke: colour("ink"), "stroke-dasharray": "2 3" }),
        element("circle", { cx: x, cy: y, r: 4, fill: "none", stroke: colour("ink"), "stroke-width": 2 }),
        element("rect", { x: left, y: 0, width, height: 20, fill: colour("paper"), stroke: colour("ink"), rx: 3 }),
        element("text", { x: left + width / 2, y: 14, "text-anchor": "middle" }, found.text));
    };
    svg.onpointerleave = () => shown.replaceChildren();
    svg.onclick = (event) => { const found = place(event); if (found) pick(found.x, found.y); };
    svg.style.cursor = "crosshair";
  }

  return { draw, frame, element, colour, hover, ticks, scale };
})();
