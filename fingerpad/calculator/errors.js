/* Where the error of the closed form is known, and how large it is: cylinder_errors.py. data.known.regions has ranges by
 * key, the narrowest region first. values has SI values by key of a scene; with values.newtons the force is on the whole
 * finger. An answer is one of closedForm, at full slip. */
const modelErrors = (() => {
  const ROUNDOFF = 1e-12; // relative, of a value at an end
  const regions = data.known.regions;

  const within = (value, [low, high]) =>
    Math.abs(value) >= low * (1 - ROUNDOFF) && Math.abs(value) <= high * (1 + ROUNDOFF);

  /** Return the attraction of an answer over the external force. */
  const pull_of = (values, answer) => answer.f_electrostatic / (values.newtons ? values.force : values.f_ext);

  /** Return the logarithm of the ratio of a value and the nearest end of a range; 0 where one of them is 0. */
  function ratio(value, [low, high]) {
    const end = Math.min(Math.max(value, low), high);
    return value > 0 && end > 0 ? Math.abs(Math.log(value / end)) : 0;
  }

  /** Return the keys of values that are outside of a region, with its ranges: [{key, low, high, far}]. */
  function beyond(region, values, answer) {
    const load = values.newtons ? "force" : "f_ext", other = values.newtons ? "f_ext" : "force", found = [];
    const given = { ...values, "attraction over force": answer ? pull_of(values, answer) : 0 };
    if (!region.ranges[load]) found.push({ key: load, low: NaN, high: NaN, far: 0 });
    for (const [key, ends] of Object.entries(region.ranges))
      if (key !== other && !within(given[key], ends))
        found.push({ key, low: ends[0], high: ends[1], far: ratio(Math.abs(given[key]), ends) });
    return found;
  }

  /** Return the narrowest region of values, null where the error is not known. */
  const find = (values, answer) => regions.find((region) => beyond(region, values, answer).length === 0) || null;

  /** Return the whole relative errors of an answer by quantity, null where they are not known: of the model and, of a
   * whole finger, of the points of its trace. */
  function of(values, answer) {
    const region = find(values, answer);
    if (!region) return null;
    const known = region.errors[values.newtons ? "finger" : "full_slip"], pull = pull_of(values, answer);
    const friction = (known.f_electrostatic * pull) / (1 + pull);
    const found = { ...known, mu_app: friction, f_t: friction }, points = values.newtons && answer.points || {};
    return Object.fromEntries(Object.entries(found).map(([key, error]) => [key, error + (points[key] || 0)]));
  }

  const distance = (keys) => keys.reduce((sum, each) => sum + each.far, 0);

  /** Return the keys for which the error is not known, as the function of this name in cylinder_errors.py. */
  const outside = (values, answer) => regions.map((region) => beyond(region, values, answer)).reduce((least, keys) => {
    const more = keys.length - least.length || distance(keys) - distance(least);
    return more <= 0 ? keys : least;
  });

  return { of, outside };
})();
