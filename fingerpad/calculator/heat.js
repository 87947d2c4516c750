/* A map over two keys as inline SVG: colours for a quantity, hatched where its error is not known, grey where there is no
 * answer, and the target's line. The colours are viridis, which every colour vision reads in order. */
const heat = (function () {
  const COUNT = 21; // of places along each axis, both ends among them
  const VIRIDIS = ["440154", "482475", "414487", "355f8d", "2a788e", "21918c", "22a884", "44bf70", "7ad151", "bddf26", "fde725"]
    .map((hex) => [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16)));

  function viridis(part) {
    const at = Math.min(Math.max(part, 0), 1) * (VIRIDIS.length - 1), k = Math.min(Math.floor(at), VIRIDIS.length - 2);
    return VIRIDIS[k].map((low, j) => Math.round(low + (at - k) * (VIRIDIS[k + 1][j] - low)));
  }

  const places = ({ low, high, log }) => Array.from({ length: COUNT }, (_, k) => {
    const part = k / (COUNT - 1), value = k === COUNT - 1 ? high : log ? low * (high / low) ** part : low + (high - low) * part;
    return Number(value.toPrecision(12));
  });

  /** Return a map: xs, ys, and rows of cells {value, known, goal}, value null without an answer; of a function of x and y. */
  function compute(x_axis, y_axis, cell) {
    const xs = places(x_axis), ys = places(y_axis);
    return { xs, ys, cells: ys.map((y) => xs.map((x) => cell(x, y))) };
  }

  /** Return pieces of the line at which a quantity is its goal: [[x, y], [x, y]] in places of the grid. */
  function contour({ cells }) {
    const found = [], above = (j, k) => cells[j][k].value - cells[j][k].goal;
    for (let j = 0; j + 1 < cells.length; j++)
      for (let k = 0; k + 1 < cells[j].length; k++) {
        const corners = [[j, k], [j, k + 1], [j + 1, k + 1], [j + 1, k]];
        if (corners.some(([a, b]) => cells[a][b].value === null)) continue;
        const crossed = [];
        corners.forEach(([a, b], n) => {
          const [c, d] = corners[(n + 1) % 4], one = above(a, b), other = above(c, d);
          if (one < 0 !== other < 0) crossed.push([b + ((d - b) * one) / (one - other), a + ((c - a) * one) / (one - other)]);
        });
        for (let n = 0; n + 1 < crossed.length; n += 2) found.push([crossed[n], crossed[n + 1]]);
      }
    return found;
  }

  /** Return the picture of the cells, a pixel each, as an address of data. */
  function image(cells, part) {
    const canvas = Object.assign(document.createElement("canvas"), { width: COUNT, height: COUNT }), context = canvas.getContext("2d");
    const pixels = context.createImageData(COUNT, COUNT);
    cells.forEach((row, j) => row.forEach(({ value }, k) => {
      const at = 4 * ((COUNT - 1 - j) * COUNT + k), rgb = value === null ? [128, 128, 128] : viridis(part(value));
      pixels.data.set([...rgb, 255], at);
    }));
    context.putImageData(pixels, 0, 0);
    return canvas.toDataURL();
  }

  /* made: of compute; words: of the quantity; mark: [x, y] or null; read(x, y): text under the pointer; pick(x, y). */
  function draw(box, made, { x_axis, y_axis, words, title, mark, read, pick, has_goal }) {
    const { element, colour } = plot, of = plot.frame(box, x_axis, y_axis, title, 78), { svg, left, right, top, bottom } = of;
    const values = made.cells.flat().map((cell) => cell.value).filter((v) => v !== null);
    const least = Math.min(...values), most = Math.max(...values), log = least > 0 && most > 8 * least, span = log ? Math.log(most / least) : most - least;
    const part = (v) => (span ? (log ? Math.log(v / least) : v - least) / span : 0);
    const dx = (right - left) / (COUNT - 1), dy = (bottom - top) / (COUNT - 1);
    const clip = element("clipPath", { id: "map_frame" }, element("rect", { x: left, y: top, width: right - left, height: bottom - top }));
    const hatch = element("pattern", { id: "map_hatch", width: 9, height: 9, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
      element("line", { x1: 0, x2: 0, y1: 0, y2: 9, stroke: "#fff", "stroke-width": 1.4, "stroke-opacity": 0.75 }));
    const inside = element("g", { "clip-path": "url(#map_frame)" });
    svg.append(element("defs", {}, clip, hatch), inside);
    inside.append(element("image", { href: image(made.cells, part), x: left - dx / 2, y: top - dy / 2, preserveAspectRatio: "none",
      width: right - left + dx, height: bottom - top + dy }));
    made.cells.forEach((row, j) => { // hatched runs of cells
      for (let k = 0, first = 0; k <= COUNT; k++)
        if (k === COUNT || row[k].known) {
          if (k > first) inside.append(element("rect", { x: left + (first - 0.5) * dx, y: bottom - (j + 0.5) * dy, width: (k - first) * dx, height: dy, fill: "url(#map_hatch)", class: "unknown" }));
          first = k + 1;
        }
    });
    const pieces = has_goal ? contour(made).map((piece) => piece.map(([k, j]) => `${(left + k * dx).toFixed(1)} ${(bottom - j * dy).toFixed(1)}`).join(" L")) : [];
    for (const [stroke, width] of [["#000", 5], ["#ff8f3a", 2.6]])
      if (pieces.length) inside.append(element("path", { d: "M" + pieces.join(" M"), stroke, "stroke-width": width, "stroke-linecap": "round", fill: "none", class: "goal" }));
    if (mark) inside.append(element("circle", { cx: of.x.at(mark[0]), cy: of.y.at(mark[1]), r: 6, fill: "none", stroke: "#000", "stroke-width": 5 }),
      element("circle", { cx: of.x.at(mark[0]), cy: of.y.at(mark[1]), r: 6, fill: "none", stroke: "#fff", "stroke-width": 2.2, class: "mark" }));
    bar(of, { least, most, log, words });
    plot.hover(of, (px, py) => {
      const x = of.x.back(px), y = of.y.back(py);
      return { x, y, text: read(x, y) };
    }, pick);
    return pieces.length > 0;
  }

  /** Draw the scale of the colours on the right. */
  function bar({ svg, right, top, bottom, width }, { least, most, log, words }) {
    const { element, colour, ticks } = plot, left = right + 14, axis = { low: least, high: most, log };
    const stops = VIRIDIS.map((rgb, k) => element("stop", { offset: k / (VIRIDIS.length - 1), "stop-color": `rgb(${rgb})` }));
    svg.append(element("linearGradient", { id: "map_colours", x1: 0, x2: 0, y1: 1, y2: 0 }, ...stops),
      element("rect", { x: left, y: top, width: 12, height: bottom - top, fill: "url(#map_colours)" }));
    const at = (v) => bottom - ((log ? Math.log(v / least) / Math.log(most / least) : (v - least) / (most - least || 1)) * (bottom - top));
    for (const v of most > least ? ticks(axis, 6) : [least])
      svg.append(element("line", { x1: left + 12, x2: left + 16, y1: at(v), y2: at(v), stroke: colour("ink") }),
        element("text", { x: left + 18, y: at(v) + 4 }, numerics.show(v)));
    svg.append(element("text", { x: width - 4, y: bottom + 19, "text-anchor": "end" }, words));
  }

  return { compute, draw, contour, COUNT };
})();
