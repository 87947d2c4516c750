// The slider over the states of a run, and the values below a pointer in a chart. Charts are drawn without this script.
"use strict";
document.documentElement.classList.add("js");
const get = (id) => document.getElementById(id);

/** Return the numbers of a text between blanks. */
const numbers = (text) => text.split(" ").map(Number);

/** Return a function from px to values of a scale, and back. */
function scale(low, high, begin, end) {
  return { value: (at) => low + ((at - begin) / (end - begin)) * (high - low), at: (value) => begin + ((value - low) / (high - low)) * (end - begin) };
}

/** Return the strokes of a path of M and L, each a list of points (px). */
function strokes(path) {
  return path.split("M").slice(1).map((part) => part.split("L").map(numbers));
}

/** Return the point of a series nearest to a place along x, as {x, y, label}; null where there is none within 12 px. */
function nearest(series, x) {
  const line = series.querySelector("path.line, path.both");
  if (!series.dataset.marks) {
    for (const stroke of line ? strokes(line.getAttribute("d")) : []) {
      const k = stroke.findIndex(([at]) => at >= x);
      if (k > 0) {
        const [[x0, y0], [x1, y1]] = stroke.slice(k - 1, k + 1);
        return { x, y: y0 + ((y1 - y0) * (x - x0)) / (x1 - x0 || 1) };
      }
    }
    return null;
  }
  const labels = series.dataset.labels ? JSON.parse(series.dataset.labels) : [];
  const marks = series.dataset.marks.split(" ").map((pair, k) => ({ x: Number(pair.split(",")[0]), y: Number(pair.split(",")[1]), label: labels[k] }));
  const best = marks.reduce((a, b) => (Math.abs(b.x - x) < Math.abs(a.x - x) ? b : a));
  return Math.abs(best.x - x) <= 12 ? best : null;
}

/** Return lines of words on what a chart shows at a place (px). */
function values(svg, x) {
  const [left, right] = [Number(svg.dataset.left), Number(svg.dataset.right)];
  const along = scale(...numbers(svg.dataset.scale), left, right), found = [];
  for (const panel of svg.querySelectorAll(".panel")) {
    const top = Number(panel.dataset.top), bottom = top + Number(panel.dataset.height);
    const up = scale(...numbers(panel.dataset.scale), bottom, top), every = [...panel.querySelectorAll(".series")];
    const shown = every.map((series) => [series, nearest(series, x)]).filter(([, point]) => point);
    for (const [series, point] of shown.slice(0, 8)) {
      const value = Number(up.value(point.y).toPrecision(3));
      found.push(`${[series.dataset.name, point.label].filter(Boolean).join(", ")}: ${value}`);
    }
  }
  const at = along.value(x), spans = svg.dataset.spans ? JSON.parse(svg.dataset.spans) : [];
  const inside = spans.filter(([begin, end]) => begin <= at && at <= end).map(([, , words]) => words);
  return [`at ${Number(at.toPrecision(4))}`, ...inside, ...found];
}

/** Show the values below a pointer in a chart. */
function follow(figure) {
  const svg = figure.querySelector("svg"), tip = document.createElement("div"), line = document.createElementNS(svg.namespaceURI, "path");
  tip.className = "tip";
  line.setAttribute("class", "pointer");
  figure.append(tip);
  svg.append(line);
  const hide = () => { tip.hidden = true; line.setAttribute("d", ""); };
  hide();
  svg.addEventListener("pointermove", (event) => {
    const box = svg.getBoundingClientRect(), wide = svg.viewBox.baseVal.width, x = ((event.clientX - box.left) / box.width) * wide;
    if (x < Number(svg.dataset.left) || x > Number(svg.dataset.right)) return hide();
    line.setAttribute("d", `M${x} 0V${svg.dataset.foot}`);
    tip.replaceChildren(...values(svg, x).map((words) => Object.assign(document.createElement("p"), { textContent: words })));
    tip.hidden = false;
    const right = event.clientX - box.left > box.width / 2;
    tip.style.left = right ? "auto" : `${event.clientX - box.left + 14}px`;
    tip.style.right = right ? `${figure.clientWidth - (event.clientX - box.left) + 14}px` : "auto";
    tip.style.top = `${event.clientY - figure.getBoundingClientRect().top + 14}px`;
    return undefined;
  });
  svg.addEventListener("pointerleave", hide);
}

/** Let the slider, the buttons and the names step through the states. */
function slider() {
  const frames = [...document.querySelectorAll(".frame")], state = get("state"), names = get("states");
  function step(k) {
    const now = Math.min(Math.max(k, 0), frames.length - 1);
    frames.forEach((frame, j) => { frame.hidden = j !== now; });
    [state.value, names.value] = [String(now), String(now)];
    state.setAttribute("aria-valuetext", names.options[now].text);
  }
  state.addEventListener("input", () => step(Number(state.value)));
  names.addEventListener("change", () => step(Number(names.value)));
  get("back").addEventListener("click", () => step(Number(state.value) - 1));
  get("forth").addEventListener("click", () => step(Number(state.value) + 1));
  step(frames.length - 1);
}

document.querySelectorAll(".chart").forEach(follow);
if (get("state")) slider();
