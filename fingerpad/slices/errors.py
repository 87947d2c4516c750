"""Relative errors of a sum of slices: of the section's mesh, the trace's points, a run's estimate, and the sum itself.

The error of the sum itself is known beside fingers in three dimensions, at equal force. Three comparisons are known,
all of one finger, a half ellipsoid of 20 × 14 × 28 mm:

* ``ONCE``: layers of the default finger, the law of a ridge on the skin; pressed, charged at 200 V, at full slip. The
  computation was made once, outside of this repository. Friction has the span over its meshes too.
* ``EARLIER``: smooth, frictionless and uncharged; made once, outside of this repository, as well.
* ``SMOOTH``: smooth, frictionless and uncharged, by ``benchmarks/solid.py``; its areas of small forces are coarse.

At a force each quantity has the span of all comparisons there, between whose forces both neighbours count.
``docs/newtons.md`` describes them.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import groupby

import numpy as np

from fingerpad.results.quantities import FINGER, PENALTY, Output
from fingerpad.slices.total import Array, Profile, Total, at_indentation
from fingerpad.slices.trace import LEAST, Trace, gross_width
from variational.state import ContactState

_OF_SECTION = {name: each.error for name, each in FINGER.items() if each.error}
"""Quantities of the section whose relative errors they have; the external force is prescribed."""
_AREAS = {"contact_length": "contact_area"}  # of a section and of a sum
_FINER = 40  # times as many slices, so that there are some between any two points of a trace
_SMALLEST_VALUE = 1e-300
_RELATIVE_STEP = 1e-3  # of the largest indentation: its change for the slope over the force
MESH, ESTIMATED, POINTS = "mesh of the cross-section", "estimate beside the centre", "points of the traces"
COARSE = "coarser mesh of the traces"
"""Parts of an error, as they are printed; of others the names are in :mod:`fingerpad.results.quantities`."""
ESTIMATE = {
    "charged": {"f_electrostatic": 0.054, "contact_area": 0.050, "gross_area": 0.086, "indentation": 0.005},
    "full_slip": {"f_electrostatic": 0.032, "contact_area": 0.030, "gross_area": 0.075, "indentation": 0.014},
}
"""Largest errors of what a run estimates (:mod:`fingerpad.slices.estimate`) beside traces of the full model.

Of the default finger at 25 to 120 N/m and 0 to 200 V; ``benchmarks/newtons.py`` keeps them in ``docs/newtons.json``.
Those of the indentation are twice as large as there, because they grow the most under smaller forces.
"""


def of_section(state: ContactState, wavelength: float, own: Iterable[Output] = ()) -> dict[str, dict[str, float]]:
    """Return the relative errors that a sum takes over from its cross-section, by part and quantity.

    The gross width ends with half of a ridge's length on either side, and has the error of that length.

    Args:
        state: of the cross-section, with estimated errors.
        wavelength: of a ridge (m).
        own: outputs that are summed.
    """
    mesh, penalty = dict[str, float](), dict[str, float]()
    for name, of in (_OF_SECTION | {each.name: each.name for each in own}).items():
        value, error, springs = (getattr(each, of, math.nan) for each in (state, state.error, state.penalty))
        if value and not math.isnan(error):
            springs = 0.0 if math.isnan(springs) else abs(springs)
            mesh[name], penalty[name] = (error - springs) / abs(value), springs / abs(value)
    for part in (mesh, penalty):
        if "contact_area" in part:
            ridge = part["contact_area"] * state.contact_length / state.ridges_in_contact
            part["gross_area"] = ridge / gross_width(state, wavelength)
    return {MESH: mesh} | ({PENALTY: penalty} if any(penalty.values()) else {})


def on_section(state: ContactState, shares: Mapping[str, float]) -> dict[str, float]:
    """Return the errors of a section, in their units, from the relative ones of a sum (:func:`of_section`)."""
    of = _OF_SECTION | {name: name for name in state.own}
    return {of[key]: share * abs(getattr(state, of[key])) for key, share in shares.items() if key in of}


def estimate(name: str, total: Total) -> dict[str, float]:
    """Return the relative errors of a run's estimate in a named state; none of its own press without voltage."""
    return _with_friction(ESTIMATE[name], total) if name in ESTIMATE else {}


def of_model(known: dict[str, float], total: Total) -> dict[str, float]:
    """Return the relative errors of a sum by a cheaper model, of known ones but for friction; empty without any."""
    return _with_friction({_AREAS.get(name, name): error for name, error in known.items()}, total) if known else {}


def _with_friction(known: dict[str, float], total: Total) -> dict[str, float]:
    """Return errors with that of friction, which follows the contact force: the part of the attraction in that."""
    borne = total.totals["f_ext"] + total.totals["f_electrostatic"]
    friction = known["f_electrostatic"] * total.totals["f_electrostatic"] / borne
    return known | {"f_t": friction, "mu_app": friction}


def interpolation(finger: Profile, trace: Trace, total: Total, count: int) -> dict[str, float]:
    r"""Return the relative errors of sums by the interpolation of a trace between its points, and below the first.

    The slices are compared with those of coarser traces. Changes Δq of a quantity and Δf of the external force are
    taken to equal force, by the slope dQ/dF of the whole finger, and add up without regard to their signs, with the
    thickness t of the slices:

    .. math:: e = \frac{1}{Q} \sum_z t(z) \left| \Delta q(z) - \frac{dQ}{dF} \Delta f(z) \right|

    Ridges come and go one by one, so that the interpolation is of first order in the distance of points. On half of the
    points its error is 2 e, and the change is the error itself: the larger one of the even and the odd points. A trace
    from twice the first indentation has at least twice the error of the slices below that, and its change is added.

    Of a trace that is smooth between points with the same ridges, a slice between others may be at either point: its
    changes are half of the difference of the two. Elsewhere they are those by linear interpolation of the logarithms.

    Args:
        finger: along its axis.
        trace: of a slice on the scale 1.
        total: the sum over the trace.
        count: slices in each stretch of contact.

    Returns:
        Of all sums, indentation and effective width; empty for a trace of two points.
    """
    if len(trace.depth) < LEAST:
        return {}
    values = total.values
    less = at_indentation(finger, trace, total.delta - _RELATIVE_STEP * float(total.depth.max()), count).values
    slope = {name: (values[name] - less[name]) / (values["f_ext"] - less["f_ext"]) for name in values}

    def change(coarse: Trace) -> dict[str, float]:
        other = at_indentation(finger, coarse, total.delta, count)
        moved = {name: other.columns[column] - total.columns[column] for name, column in total.summed.items()}
        return _at_equal_force(total, moved, slope, values)

    one, other, below = (change(coarse) for coarse in (*trace.halves(), trace.later()))
    between = {name: max(one[name], other[name]) for name in below}
    if trace.ridges is not None:
        between |= _between(finger, trace, total, count, slope)
    found = {name: between[name] + below[name] for name in below}
    return found | {"mu_app": found["f_t"]}


def _at_equal_force(
    total: Total, moved: Mapping[str, Array], slope: Mapping[str, float], values: Mapping[str, float]
) -> dict[str, float]:
    """Return the relative changes of sums at equal force from those of the slices at equal indentation.

    The effective width has that of the force at equal force of the centre, and that of the centre. ``moved`` has the
    changes of the slices by the names of sums, shape (slices,), and ``slope`` that of each quantity over the force.
    """
    force = moved["f_ext"]
    sums = {name: total.thickness @ abs(each - slope[name] * force) for name, each in moved.items() if name != "f_ext"}
    sums["indentation"] = slope["indentation"] * total.thickness @ abs(force)
    found = {name: float(each / abs(values[name])) if values[name] else 0.0 for name, each in sums.items()}
    deepest = int(total.depth.argmax())
    centre = abs(force[deepest]) / total.columns["f_ext"][deepest]
    return found | {"effective_width": float(total.thickness @ abs(force) / values["f_ext"] + centre)}


def _between(finger: Profile, trace: Trace, total: Total, count: int, slope: Mapping[str, float]) -> dict[str, float]:
    """Return the relative errors of sums between the points of a trace whose ridges are known."""
    assert trace.ridges is not None
    fine = at_indentation(finger, trace, total.delta, _FINER * count)
    depth = np.divide(fine.depth, finger.width(fine.z))
    k = np.clip(np.searchsorted(trace.depth, depth, side="right") - 1, 0, len(trace.depth) - 2)
    jumps, above = trace.ridges[k] != trace.ridges[k + 1], depth >= trace.depth[0]
    at, points = np.log(np.maximum(depth, trace.depth[0])), np.log(trace.depth)
    moved, power = dict[str, Array](), {each.name: each.power for each in trace.own}
    for name, column in fine.summed.items():
        values, width = trace.columns[column], np.asarray(finger.width(fine.z)) ** power.get(column, 1)
        logs = np.interp(at, points, np.log(np.maximum(abs(values), _SMALLEST_VALUE)))
        half, linear = (values[k + 1] - values[k]) / 2 * width, np.exp(logs) * width * np.sign(values.sum())
        moved[name] = np.where(above, np.where(jumps, half, linear - fine.columns[column]), 0.0)
    found = _at_equal_force(fine, moved, slope, total.values)
    return {name: share for name, share in found.items() if name != "indentation"}


def add(*parts: dict[str, float]) -> dict[str, float]:
    """Return the sums of errors by name."""
    return {name: sum(part.get(name, 0.0) for part in parts) for part in parts for name in part}


Ends = tuple[float, float]
"""Least and largest error: the sum of slices over the finger in three dimensions, less 1."""
COMPARED = {
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
    0.1, 1.0, f_t=(-0.007, 0.002), f_electrostatic=(-0.003, 0.035), gross_area=(0.001, 0.053),
    contact_area=(-0.002, 0.04), indentation=(-0.06, -0.05),
)  # fmt: skip
EARLIER = _span(0.3, 1.0, gross_area=(0.05, 0.07))
SMOOTH: Mapping[str, Sequence[tuple[float, Ends]]] = {
    "gross_area": (
        (0.01294, (0.561, 0.562)), (0.04779, (0.300, 0.301)), (0.1096, (0.130, 0.131)), (0.2008, (0.120, 0.121)),
        (0.3255, (0.057, 0.058)), (0.4830, (0.016, 0.017)), (0.6784, (0.003, 0.004)), (0.9108, (0.011, 0.012)),
        (1.185, (0.001, 0.002)), (1.502, (0.001, 0.002)),
    )
}  # fmt: skip
_SAME_FORCE = 1e-9


def known_at(force: float) -> dict[str, Ends]:
    """Return the least and largest error of each quantity whose error is known at a force (N)."""
    found: dict[str, Ends] = {}
    for name in COMPARED:
        spans = [each for comparison in (ONCE, EARLIER, SMOOTH) for each in _around(comparison.get(name, ()), force)]
        if spans:
            found[name] = min(low for low, _ in spans), max(high for _, high in spans)
    return found


def _around(points: Sequence[tuple[float, Ends]], force: float) -> list[Ends]:
    """Return the errors at the forces that are next to a force on either side; none where it is beyond all."""
    below = [each for each in points if each[0] <= force * (1 + _SAME_FORCE)]
    above = [each for each in points if each[0] >= force * (1 - _SAME_FORCE)]
    return [below[-1][1], above[0][1]] if below and above else []


def remarks(forces: Iterable[float], names: Collection[str] = tuple(COMPARED)) -> list[str]:
    """Return what is known of the error of quantities at forces (N), a sentence for neighbours that share it."""
    compared = {name: text for name, text in COMPARED.items() if name in names}
    found = []
    rounded = sorted({float(f"{force:.4g}") for force in forces} if compared else ())  # by different sums of one force
    for words, same in groupby(rounded, lambda force: _remark(force, compared)):
        numbers = [f"{force:g}" for force in same]
        at = ", ".join(numbers) if len(numbers) < 3 else f"{numbers[0]} to {numbers[-1]}"
        beside = "beside a finger of 20 × 14 × 28 mm in three dimensions"
        found.append(f"Error of the sum of slices at {at} N, {beside}: {words}.")
    return found


def _remark(force: float, compared: Mapping[str, str]) -> str:
    found = known_at(force)
    ends = {name: [f"{100 * end:+.3g}".replace("-", "−") for end in found[name]] for name in compared if name in found}
    words = [f"{compared[name]} {low} to {high} %" for name, (low, high) in ends.items()]
    missing = ", ".join(text for name, text in compared.items() if name not in found)
    return "; ".join([", ".join(words)] * bool(words) + [f"{missing} not known"] * bool(missing))
