/* The same answer without the page: a command of fingerpad, or Python for a contact as given. */
const commands = (function () {
  function of(values, given, texts) {
    const first = state.read(state.start()).values, unread = (key) => state.unread(texts, key);
    const set = data.fields.filter(({ key }) => !["length", "ridges"].includes(key) && !unread(key) &&
      (values[key] !== first[key] || key === "force" || (key === "f_ext" && !given)));
    if (!given) {
      const words = set.map(({ key }) => (key === "force" || key === "f_ext" ? `--${key.replace("_", "-")} ${values[key]}` : `--set ${key}=${values[key]}`));
      return ["fingerpad estimate", ...words].join(" ");
    }
    const tables = {};
    for (const { key } of set) {
      const [table, name] = key.includes(".") ? key.split(".") : ["", key];
      (tables[table] = tables[table] || []).push([name, values[key]]);
    }
    const words = Object.entries(tables).flatMap(([table, entries]) => table
      ? [`${table}={${entries.map(([name, value]) => `"${name}": ${value}`).join(", ")}}`]
      : entries.map(([name, value]) => `${name}=${value}`));
    return "import fingerpad as fp\nfrom fingerpad.reduced import cylinders\n" +
      `print(cylinders.solve(fp.Scene(${words.join(", ")}), cylinders.given(${values.length}, ${values.ridges})))`;
  }

  return { of };
})();
