/* Where the error of the closed form is known, and how large it is: cylinder_errors.py. data.known.regions has ranges by
 * key, the narrowest region first. values has SI values by key of a scene; with values.newtons the force is on the whole
 * finger. */
const modelErrors = (() => {
  const ROUNDOFF = 1e-12; // relative, of a value at an end
  const regions = data.known.regions;

  const within = (value, [low, high]) =>
    Math.abs(value) >= low * (1 - ROUNDOFF) && Math.abs(value) <= high * (1 + ROUNDOFF);

  /** Return the keys of values that are outside of a region, with its ranges: [{key, low, high}]. */
  function beyond(region, values) {
    const load = values.newtons ? "force" : "f_ext", other = values.newtons ? "f_ext" : "force", found = [];
    if (!region.ranges[load]) found.push({ key: load, low: NaN, high: NaN });
    for (const [key, ends] of Object.entries(region.ranges))
      if (key !== other && !within(values[key], ends)) found.push({ key, low: ends[0], high: ends[1] });
    return found;
  }

  /** Return the narrowest region of values, null where the error is not known. */
  const find = (values) => regions.find((region) => beyond(region, values).length === 0) || null;

  /** Return the relative errors of an answer at full slip by quantity, null where they are not known. */
  function of(values, answer) {
    const region = find(values);
    return region && { ...region.errors.full_slip, f_t: region.errors.full_slip.mu_app };
  }

  /** Return the keys for which the error is not known, with the ranges in which it is; empty where it is known. */
  const outside = (values) => (find(values) ? [] : beyond(regions[regions.length - 1], values));

  return { of, outside };
})();
