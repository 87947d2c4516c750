/* The same answer without the page: a command of fingerpad. */
const commands = (function () {
  function of(values, texts) {
    const first = state.read(state.start()).values;
    const set = data.fields.filter(({ key }) => !state.unread(texts, key) && (values[key] !== first[key] || key === "force" || key === "f_ext"));
    const words = set.map(({ key }) => (key === "force" || key === "f_ext" ? `--${key.replace("_", "-")} ${values[key]}` : `--set ${key}=${values[key]}`));
    return ["fingerpad estimate", ...words].join(" ");
  }

  return { of };
})();
