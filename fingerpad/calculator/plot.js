/* One curve with its band of known error, as inline SVG. Dashed where the error is not known; a curve to compare with is
 * dotted. Curves differ by their strokes and have their names beside them, so that no colour is needed. */
const plot = (function () {
  const MARGIN = { left: 52, right: 14, top: 12, bottom: 44 };

  function element(name, attributes, text) {
    const found = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) found.setAttribute(key, value);
    if (text !== undefined) found.textContent = text;
    return found;
  }

  /** Return round numbers from 0 or below to a highest value, at most so many. */
  function ticks(highest, most) {
    const rough = highest / most, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough * (1 - 1e-9));
    return Array.from({ length: Math.floor(highest / step + 1e-9) + 1 }, (_, k) => k * step);
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

  /* box: an HTML element; x, y: names of the axes; points: {x, y, known}, in order, y null where there is no answer;
   * other: points of the dotted curve; mark: {x, y}; error: relative half width of the band; title: for readers of it. */
  function draw(box, { x, y, points, other, mark, error, title }) {
    const width = Math.max(box.clientWidth, 260), height = Math.min(340, Math.max(230, 0.62 * width));
    const answered = points.filter((p) => p.y !== null), all = [...answered, ...other, ...(mark ? [mark] : [])];
    const most_x = Math.max(...points.map((p) => p.x)), most_y = Math.max(1e-9, ...all.map((p) => p.y)) * 1.1;
    const left = MARGIN.left, right = width - MARGIN.right, bottom = height - MARGIN.bottom;
    const at_x = (v) => left + (v / most_x) * (right - left);
    const at_y = (v) => bottom - (v / most_y) * (bottom - MARGIN.top);
    const svg = element("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title });
    const line = (list, attributes) =>
      list.length > 1 &&
      svg.append(element("polyline", {
        points: list.map((p) => `${at_x(p.x).toFixed(2)},${at_y(p.y).toFixed(2)}`).join(" "), fill: "none", ...attributes,
      }));
    for (const v of ticks(most_x, width < 420 ? 4 : 8)) {
      svg.append(element("line", { x1: at_x(v), x2: at_x(v), y1: bottom, y2: bottom + 5, stroke: "#111" }));
      const anchor = at_x(v) > right - 8 ? "end" : "middle";
      svg.append(element("text", { x: at_x(v), y: bottom + 19, "text-anchor": anchor }, numerics.show(v)));
    }
    for (const v of ticks(most_y, 6)) {
      svg.append(element("line", { x1: left, x2: right, y1: at_y(v), y2: at_y(v), stroke: v ? "#ddd" : "#111" }));
      svg.append(element("text", { x: left - 6, y: at_y(v) + 4, "text-anchor": "end" }, numerics.show(v)));
    }
    svg.append(element("text", { x: (left + right) / 2, y: height - 8, "text-anchor": "middle" }, x));
    const up = { x: 0, y: 0, transform: `translate(14 ${(MARGIN.top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" };
    svg.append(element("text", up, y));
    for (const list of runs(points, (p) => p.y !== null && p.known)) {
      const edge = [...list.map((p) => [p.x, p.y * (1 + error)]), ...list.reverse().map((p) => [p.x, p.y * (1 - error)])];
      const path = edge.map(([a, b]) => `${at_x(a).toFixed(2)},${at_y(b).toFixed(2)}`).join(" ");
      svg.append(element("polygon", { points: path, fill: "#56b4e9", "fill-opacity": 0.45, class: "band" }));
    }
    line(other, { stroke: "#555", "stroke-width": 1.5, "stroke-dasharray": "1 4", "stroke-linecap": "round" });
    for (const list of runs(points, (p) => p.y !== null))
      line(list, { stroke: "#0072b2", "stroke-width": 1.6, "stroke-dasharray": "7 4" });
    for (const list of runs(points, (p) => p.y !== null && p.known)) line(list, { stroke: "#0072b2", "stroke-width": 2.4 });
    if (mark) {
      svg.append(element("circle", { cx: at_x(mark.x), cy: at_y(mark.y), r: 5.5, fill: "#111", class: "mark" }));
      const end = at_x(mark.x) > (left + right) / 2, y_text = Math.max(at_y(mark.y) - 10, MARGIN.top + 12);
      const place = { x: at_x(mark.x) + (end ? -9 : 9), y: y_text, "text-anchor": end ? "end" : "start" };
      svg.append(element("text", { ...place, "font-weight": 600 }, mark.y.toFixed(3)));
    }
    box.replaceChildren(svg);
  }

  return { draw };
})();
