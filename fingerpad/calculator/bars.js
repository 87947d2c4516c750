/* Bars of how far friction is solved and known, below the answer; those of a report (fingerpad/report/known.py). */
const bars = (function () {
  const { element, colour, ticks, scale } = plot;
  const LEFT = 84, RIGHT = 112, ROW = 22, LEAST = 3; // px; the shortest bar

  /** Draw the bars of a band, see knownBand.of; error: relative, of the closed form beside full runs, null if not known. */
  function draw(box, band, error, of) {
    if (!band) return box.replaceChildren();
    const { mu_app: mu, low, high, parts } = band, rows = [["solved to", mu, mu, "line"]];
    if (error !== null) rows.push(["full model", mu * (1 - error), mu * (1 + error), "line"]);
    rows.push(["known to", low, high, "goal"], ...parts.map((part) => [part.name, part.low, part.high, "other"]));
    const least = Math.log(Math.min(...rows.map((row) => row[1]))), most = Math.log(Math.max(...rows.map((row) => row[2])));
    const margin = 0.05 * (most - least) || 0.05, axis = { low: Math.exp(least - margin), high: Math.exp(most + margin), log: true };
    const width = Math.min(Math.max(box.clientWidth, 300), 640), end = ROW * rows.length + 4, right = width - RIGHT, { at } = scale(axis, LEFT, right);
    const svg = element("svg", { width, height: end + 40, viewBox: `0 0 ${width} ${end + 40}`, role: "img", fill: colour("ink"),
      "aria-label": `µ_app of the ${of}: solved exactly, known to about ${low.toFixed(2)} to ${high.toFixed(2)}` });
    const text = (x, y, anchor, words) => svg.append(element("text", { x, y, "text-anchor": anchor }, words));
    const rule = (x, name) => svg.append(element("line", { x1: x, x2: x, y1: 0, y2: end, stroke: colour(name) }));
    const marks = ticks({ ...axis }, 6);
    for (const v of marks.length > 1 ? marks : ticks({ ...axis, log: false }, 5)) {
      rule(at(v), "grid");
      text(at(v), end + 15, "middle", numerics.show(v, 3));
    }
    rule(at(mu), "ink");
    rows.forEach(([name, from, to, fill], k) => {
      const y = ROW * k + 4, size = Math.max(at(to) - at(from), LEAST), x = at(from) - (to > from ? 0 : LEAST / 2);
      text(LEFT - 8, y + 12, "end", name);
      svg.append(element("rect", { x, y, width: size, height: ROW - 8, fill: colour(fill), class: name.replace(" ", "_") }));
      text(right + 8, y + 12, "start", to > from ? `${from.toFixed(2)} to ${to.toFixed(2)}` : "exact, no mesh");
    });
    text((LEFT + right) / 2, end + 33, "middle", `µ_app of the ${of}`);
    box.replaceChildren(svg);
  }

  /** Return the bars in words, for their caption. */
  const words = ({ low, high, left_out }, error) => `µ_app is solved exactly, since a closed form has no mesh. It is known to about ${low.toFixed(2)} to ` +
    `${high.toFixed(2)}: each grey bar has one assumption changed, and the band takes these parts as independent.` +
    (error === null ? " Its error beside the full model is not known here." : " The bar “full model” is its known error beside full runs.") +
    (left_out.length ? ` Without an equilibrium, and not in it: ${left_out.join("; ")}.` : "");

  return { draw, words };
})();
