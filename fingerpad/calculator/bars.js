/* Bars of how far friction is solved, and of its likely range, below the answer; those of a report (fingerpad/report/known.py). */
const bars = (function () {
  const { element, colour, ticks, scale } = plot;
  const LEFT = 96, RIGHT = 100, ROW = 22, LEAST = 3, TIP = 10; // px; the shortest bar, the arrow of an open one

  /** Draw the bars of a band, see knownBand.of; error: relative, of the closed form beside full runs, null if not known. */
  function draw(box, band, error, of) {
    if (!band) return box.replaceChildren();
    const { mu_app: mu, low, high, parts } = band, rows = [["solved to", mu, mu, "line"]];
    if (error !== null) rows.push(["full model", mu * (1 - error), mu * (1 + error), "line"]);
    rows.push(["likely range", low, high, "goal"], ...parts.map((part) => [part.name, part.low, part.high, "other"]));
    const every = [...rows.flatMap((row) => row.slice(1, 3)), ...[band, ...parts].map((part) => part.at_least)].filter(Number.isFinite);
    const least = Math.log(Math.min(...every)), most = Math.log(Math.max(...every));
    const margin = 0.05 * (most - least) || 0.05, axis = { low: Math.exp(least - margin), high: Math.exp(most + margin), log: true };
    const width = Math.min(Math.max(box.clientWidth, 300), 640), end = ROW * rows.length + 4, right = width - RIGHT, { at } = scale(axis, LEFT, right);
    const svg = element("svg", { width, height: end + 40, viewBox: `0 0 ${width} ${end + 40}`, role: "img", fill: colour("ink"),
      "aria-label": `µ_app of the ${of}: solved exactly, likely range ${span(band)}` });
    const text = (x, y, anchor, words) => svg.append(element("text", { x, y, "text-anchor": anchor }, words));
    const rule = (x, name) => svg.append(element("line", { x1: x, x2: x, y1: 0, y2: end, stroke: colour(name) }));
    const marks = ticks({ ...axis }, 6);
    for (const v of marks.length > 1 ? marks : ticks({ ...axis, log: false }, 5)) {
      rule(at(v), "grid");
      text(at(v), end + 15, "middle", numerics.show(v, 3));
    }
    rule(at(mu), "ink");
    const ends = { "likely range": band, ...Object.fromEntries(parts.map((part) => [part.name, part])) };
    rows.forEach(([name, from, to, fill], k) => {
      const y = ROW * k + 4, open = to === Infinity, end_x = open ? right : at(to), size = Math.max(end_x - at(from), LEAST), x = at(from) - (to > from ? 0 : LEAST / 2);
      const shape = { x, y, width: open ? Math.max(size - TIP, 0) : size, height: ROW - 8, fill: colour(fill), class: name.replace(" ", "_") };
      text(LEFT - 8, y + 12, "end", name);
      svg.append(element("rect", shape));
      if (open) svg.append(element("path", { d: `M ${right - TIP} ${y - 3} L ${right} ${y + ROW / 2 - 4} L ${right - TIP} ${y + ROW - 5} Z`, fill: colour(fill), class: "open" }));
      text(right + 8, y + 12, "start", to > from ? span(ends[name] || { low: from, at_least: to }) : "exact, no mesh");
    });
    text((LEFT + right) / 2, end + 33, "middle", `µ_app of the ${of}`);
    box.replaceChildren(svg);
  }

  /** Return the ends of a band or of a part; of an open one the end that has a number. */
  const span = ({ low, at_least }) => `${low.toFixed(2)} to ${at_least.toFixed(2)}`;

  /** Return which changes of a part have no number, and which number is an upper bound: fingerpad/results/closures.py. */
  function notes({ no_number, upper_bounds }) {
    const reasons = new Map();
    for (const [words, why] of no_number) reasons.set(why, [...new Set([...(reasons.get(why) || []), words])]);
    return [...[...reasons].map(([why, those]) => `No number by ${those.join(" and ")}: ${why}.`),
      ...upper_bounds.map(([words, share]) => `The largest number, by ${words}, is an upper bound: attraction balances ${(100 * Math.min(share, 1)).toFixed(0)} % of the pressure in contact.`)];
  }

  /** Return of which changes of a part there is no upper end, in words: fingerpad/results/closures.py. */
  function opened({ name, no_number }) {
    const every = [...new Set(no_number.map(([words]) => words.split(", ")[0]))], why = [...new Set(no_number.map((each) => each[1]))].join(" and ");
    return name === "rough contact" ? `; no upper end by ${["none", "one", "two", "three"][every.length]} of three models of rough contact, in which ${why}`
      : `; no upper end with ${every.join(" and ")}, where ${why}`;
  }

  /** Return the bars in words, for their caption. */
  const words = (band, error) => `µ_app is solved exactly, since a closed form has no mesh. Likely range ${span(band)}${band.parts.filter(({ high }) => high === Infinity).map(opened).join("")}. ` +
    "Each grey bar has one assumption changed. The range takes these parts as independent." + (band.high === Infinity ? " An arrow is an open end." : "") +
    band.parts.flatMap(notes).map((each) => ` ${each}`).join("") +
    (error === null ? " Its error beside the full model is not known here." : " The bar “full model” is its known error beside full runs.") +
    (band.left_out.length ? ` Not in it, for want of a table of such an insulator: ${band.left_out.join("; ")}.` : "");

  return { draw, span, words };
})();
