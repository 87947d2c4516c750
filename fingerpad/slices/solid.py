"""Error of the sum of slices itself: the sum beside fingers in three dimensions, at equal force.

Three comparisons are known, all of one finger, a half ellipsoid of 20 × 14 × 28 mm:

* ``ONCE``: layers of the default finger, the law of a ridge on the skin; pressed, charged at 200 V, at full slip. The
  computation was made once, outside of this repository. Friction has the span over its meshes too.
* ``EARLIER``: smooth, frictionless and uncharged; made once, outside of this repository, as well.
* ``SMOOTH``: smooth, frictionless and uncharged, by ``benchmarks/solid.py``; its areas of small forces are coarse.

At a force each quantity has the span of all comparisons there, between whose forces both neighbours count.
``docs/newtons.md`` describes them.
"""

from collections.abc import Iterable, Mapping, Sequence

Ends = tuple[float, float]
"""Least and largest error: the sum of slices over the finger in three dimensions, less 1."""
WORDS = {
    "f_t": "friction",
    "f_electrostatic": "attraction",
    "gross_area": "gross area",
    "contact_area": "ridge area",
    "indentation": "indentation",
}
"""The quantities that are compared, as they are printed."""


def _span(low: float, high: float, **ends: Ends) -> dict[str, Sequence[tuple[float, Ends]]]:
    """Return a comparison that has the same error at all of its forces (N)."""
    return {name: ((low, each), (high, each)) for name, each in ends.items()}


ONCE = _span(
    0.1,
    1.0,
    f_t=(-0.007, 0.002),
    f_electrostatic=(-0.003, 0.035),
    gross_area=(0.001, 0.053),
    contact_area=(-0.002, 0.04),
    indentation=(-0.06, -0.05),
)
EARLIER = _span(0.3, 1.0, gross_area=(0.05, 0.07))
SMOOTH: Mapping[str, Sequence[tuple[float, Ends]]] = {
    "gross_area": (
        (0.01294, (0.561, 0.562)),
        (0.04779, (0.300, 0.301)),
        (0.1096, (0.130, 0.131)),
        (0.2008, (0.120, 0.121)),
        (0.3255, (0.057, 0.058)),
        (0.4830, (0.016, 0.017)),
        (0.6784, (0.003, 0.004)),
        (0.9108, (0.011, 0.012)),
        (1.185, (0.001, 0.002)),
        (1.502, (0.001, 0.002)),
    )
}
COMPARISONS = ONCE, EARLIER, SMOOTH
_ROUNDOFF = 1e-9


def known(force: float) -> dict[str, Ends]:
    """Return the least and largest error of each quantity whose error is known at a force (N)."""
    found: dict[str, Ends] = {}
    for name in WORDS:
        spans = [each for comparison in COMPARISONS for each in _around(comparison.get(name, ()), force)]
        if spans:
            found[name] = min(low for low, _ in spans), max(high for _, high in spans)
    return found


def _around(points: Sequence[tuple[float, Ends]], force: float) -> list[Ends]:
    """Return the errors at the forces that are next to a force on either side; none where it is beyond all."""
    below = [each for each in points if each[0] <= force * (1 + _ROUNDOFF)]
    above = [each for each in points if each[0] >= force * (1 - _ROUNDOFF)]
    return [below[-1][1], above[0][1]] if below and above else []


def remarks(forces: Iterable[float]) -> list[str]:
    """Return what is known of the error at forces (N), a sentence for those that share it."""
    shared: dict[str, list[str]] = {}
    for force in forces:
        found = known(force)
        words = [f"{WORDS[name]} {percent(ends)}" for name, ends in found.items()]
        missing = ", ".join(text for name, text in WORDS.items() if name not in found)
        words = [", ".join(words)] * bool(words) + [f"{missing} not known"] * bool(missing)
        shared.setdefault("; ".join(words), []).append(f"{force:.4g}")
    start, beside = "Error of the sum of slices at", "beside a finger of 20 × 14 × 28 mm in three dimensions"
    return [f"{start} {', '.join(same)} N, {beside}: {words}." for words, same in shared.items()]


def percent(ends: Ends) -> str:
    """Return a least and a largest error in per cent, as they are printed."""
    low, high = (f"{100 * end:+.3g}".replace("-", "−") for end in ends)
    return f"{low} to {high} %"
