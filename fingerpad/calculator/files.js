/* What leaves the page: texts on the clipboard, tables and pictures as files. Nothing is sent. */
const files = (function () {
  /** Put a text on the clipboard; say is called with what became of it. */
  async function copy(text, say, what) {
    try {
      await navigator.clipboard.writeText(text);
    } catch (error) { // no clipboard in this place: by a selection
      const area = Object.assign(document.createElement("textarea"), { value: text });
      document.body.append(area);
      area.select();
      const done = document.execCommand("copy");
      area.remove();
      if (!done) return say(`The browser does not allow to copy ${what}.`);
    }
    return say(`Copied: ${what}.`);
  }

  function save(name, content, type) {
    const address = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
    const link = Object.assign(document.createElement("a"), { href: address, download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 1e4);
  }

  /** Return the rows of a table of the page, as texts. */
  const rows = (table) => [...table.rows].map((row) => [...row.cells].map((cell) => cell.textContent.trim()));
  const quoted = (cell) => (/[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell);
  const tsv = (list) => list.map((row) => row.join("\t")).join("\n");
  const csv = (list) => list.map((row) => row.map((cell) => quoted(String(cell))).join(",")).join("\n") + "\n";

  /** Return a drawing as the text of an SVG file, with its background and font. */
  function svg_text(svg) {
    const whole = svg.cloneNode(true), style = getComputedStyle(svg);
    whole.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    whole.setAttribute("style", `background: ${getComputedStyle(document.body).backgroundColor}; font: ${style.font}`);
    return new XMLSerializer().serializeToString(whole);
  }

  /** Save a drawing as PNG, of two pixels a point. */
  function save_png(svg, name) {
    const width = Number(svg.getAttribute("width")), height = Number(svg.getAttribute("height")), image = new Image();
    image.onload = () => {
      const canvas = Object.assign(document.createElement("canvas"), { width: 2 * width, height: 2 * height });
      const context = canvas.getContext("2d");
      context.fillStyle = getComputedStyle(document.body).backgroundColor;
      context.fillRect(0, 0, canvas.width, canvas.height);
      context.drawImage(image, 0, 0, canvas.width, canvas.height);
      canvas.toBlob((blob) => save(name, blob));
    };
    image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(svg_text(svg));
  }

  return { copy, save, save_png, rows, tsv, csv, svg_text };
})();
