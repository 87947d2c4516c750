"""Both models side by side: attraction of a section and of a whole finger, and the error that covers it."""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from benchmarks.loads.scenes import AXES, COUNT, Data, section
from fingerpad.reduced.cylinder_errors import PULL, WHOLE
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.runs.context import RunContext
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.parameters import Slices
from fingerpad.slices.total import at_force, at_indentation, deepest, profile
from fingerpad.slices.trace import TraceError
from fingerpad.slices.trace import trace as trace_of
from variational.state import ContactState

BANDS = (0.1, 0.35, 0.65, 1.0)
"""Friction coefficients, between which an error is found: it grows with the shear of the finger."""
LEAST, MARGIN = 8, 1.5
"""Least number of states that make an error, and that test it; factor on what covers those that make it."""
PULLED = (4.0, 8.0, math.inf)
"""Attraction over force, up to which a level has its states: under a stronger attraction errors are larger."""
BLOCK = 2  # scenes of the sequence that make the error, or test it, in turn
PART = 0.95  # of the states that the error is to cover
WITHOUT = 0.1  # of the states inside a region, at most, that the full model did not reach
_ROUNDOFF = 1e-9  # of the largest force of a trace
Array = NDArray[np.float64]


class Compared(NamedTuple):
    """A section, or a whole finger, by both models."""

    scene: int
    """Place in the sequence."""
    force: float
    """N/m, or N."""
    attraction: float
    """By the closed form, of the unit of the force."""
    error: float
    """The full model's attraction over that, less 1."""
    values: Data
    """Of the scene by key."""
    whole: bool = False
    """Whether it is a finger."""
    length: float = math.nan
    """The full model's contact length over that of the closed form, less 1; of a finger its ridge contact area."""

    @property
    def share(self) -> float:
        """Of the attraction in the contact force."""
        return self.attraction / (self.force + self.attraction)

    @property
    def of_friction(self) -> float:
        """The full model's friction over that of the closed form, less 1."""
        return self.share * self.error


def sections(kept: Iterable[Data]) -> list[Compared]:
    """Return every state of kept scenes beside the closed form, those that the closed form refuses left out.

    The error of a state that the full model did not reach is NaN.
    """
    found = []
    for each in kept:
        for state in each["states"]:
            own = _closed(each["values"], [state["f_ext"]])
            if own:
                f_el = own[0].f_electrostatic
                error = state.get("f_electrostatic", math.nan) / f_el - 1
                length = state.get("contact_length", math.nan) / own[0].contact_length - 1
                found.append(Compared(each["scene"], state["f_ext"], f_el, error, each["values"], length=length))
    return found


def both(compared: Iterable[Compared]) -> list[Compared]:
    """Return the states that both models have."""
    return [each for each in compared if not math.isnan(each.error)]


def _closed(data: Data, under: Sequence[float]) -> list[ContactState]:
    """Return full slip of the closed form under forces (N/m), with indentations; empty where it is refused."""
    model = Cylinders()
    try:
        return model.over_forces(
            section(data, under[0]), under, "full_slip", lambda each: model.solve(each, RunContext())
        )
    except SceneError:
        return []


def fingers(kept: Iterable[Data]) -> list[Compared]:
    """Return the whole finger of kept scenes, by sums over traces of both models at the same forces.

    The force is that of the scene, or the largest that both traces reach.
    """
    finger, count, found = profile(Slices()), Slices().count, []
    for each in kept:
        data, states = each["values"], [_state(state) for state in each["states"] if "f_electrostatic" in state]
        own = _closed(data, [state.f_ext for state in states]) if states else []
        try:
            traces = [trace_of(some, Scene().geometry.ridge_wavelength) for some in (own, states)]
        except TraceError:
            continue
        most = [at_indentation(finger, made, deepest(finger, made), count).totals["f_ext"] for made in traces]
        force = min(data["force"], *(each * (1 - _ROUNDOFF) for each in most))
        one, full = (at_force(finger, made, force, count).totals for made in traces)
        error, area = (full[key] / one[key] - 1 for key in ("f_electrostatic", "contact_area"))
        found.append(Compared(each["scene"], force, one["f_electrostatic"], error, data, True, area))
    return found


def _state(values: Mapping[str, Any]) -> ContactState:
    own = {key: value for key, value in values.items() if key not in ("factorisations", "failure")}
    own["f_contact"] = values["f_ext"] + values["f_electrostatic"]
    return ContactState(**own, voltage=math.nan)


class Band(NamedTuple):
    """Scenes of a range of the friction coefficient, inside the limits of force, voltage and attraction over force."""

    some: list[Compared]
    """Sections."""
    whole: list[Compared]
    """Fingers."""
    without: list[Compared]
    """Sections without a result of the full model, at most :data:`WITHOUT` of all."""

    @property
    def made(self) -> list[Compared]:
        """Sections that make the error."""
        return [each for each in self.some if fits(each)]

    @property
    def tests(self) -> list[Compared]:
        """Sections that test it."""
        return [each for each in self.some if not fits(each)]


def bands(sections: Sequence[Compared], fingers: Sequence[Compared], pull: float = math.inf) -> list[Band]:
    """Return the scenes of each band of :data:`BANDS` in the limits that hold most sections, few without result.

    Args:
        sections: of which the full model may have no result.
        fingers: of them.
        pull: largest attraction over force.
    """
    found = []
    for k in range(len(BANDS) - 1):
        parts = (_in_band((each for each in some if each.attraction <= pull * each.force), k)
                 for some in (sections, fingers))  # fmt: skip
        every, whole = parts
        some, without = both(every), [each for each in every if math.isnan(each.error)]
        limits = _limits(some, without)
        inside = ([each for each in part if np.all(_place(each) <= limits)] for part in (some, whole, without))
        found.append(Band(*inside))
    return found


def _in_band(compared: Iterable[Compared], k: int) -> list[Compared]:
    return [each for each in compared if BANDS[k] <= each.values["friction"] <= BANDS[k + 1]]


def _place(one: Compared) -> Array:
    """Return the force (N/m) of the section or at the centre of the finger, the voltage and attraction over force."""
    force = Scene(force=one.force).centre_force if one.whole else one.force
    return np.array([force, one.values["voltage"], one.attraction / one.force])


def _limits(some: Sequence[Compared], without: Sequence[Compared]) -> Array:
    """Return upper ends of places in which most sections are, at most :data:`WITHOUT` of them without result."""
    found, lost = (np.array([_place(each) for each in every]).reshape(-1, 3) for every in (some, without))
    most, best = 0, np.zeros(3)
    for force, voltage in itertools.product(np.unique(found[:, 0]), np.unique(found[:, 1])):
        pulls, others = (np.sort(each[np.all(each[:, :2] <= (force, voltage), axis=1), 2]) for each in (found, lost))
        count, beside = np.arange(1, len(pulls) + 1), np.searchsorted(others, pulls, "right")
        few = np.flatnonzero(beside <= WITHOUT * (count + beside))
        if len(few) and count[few[-1]] > most:
            most, best = count[few[-1]], np.array([force, voltage, pulls[few[-1]]])
    return best


class Level(NamedTuple):
    """Bands of the friction coefficient up to an attraction over force."""

    pull: float
    bands: list[Band]
    regions: list[dict[str, Any] | None]
    """By band; None where no error is known, or where a level before reaches as far."""


def levels(sections: Sequence[Compared], fingers: Sequence[Compared]) -> list[Level]:
    """Return the bands up to each attraction over force of :data:`PULLED`."""
    found: list[Level] = []
    farthest = [0.0] * (len(BANDS) - 1)
    for pull in PULLED:
        some = bands(sections, fingers, pull)
        known = by_band(some)
        ends = [region["ranges"][PULL][1] if region else 0.0 for region in known]
        own = [region if end > far else None for region, end, far in zip(known, ends, farthest, strict=True)]
        farthest = [max(both_ends) for both_ends in zip(ends, farthest, strict=True)]
        found.append(Level(pull, some, own))
    return found


def regions(every: Iterable[Level]) -> list[dict[str, Any]]:
    """Return the regions in which the error is known, as the program reads them."""
    return [region for level in every for region in level.regions if region is not None]


def by_band(every: Iterable[Band]) -> list[dict[str, Any] | None]:
    """Return the region of each band in which the error is known; None where it has too few states.

    One begins at the friction coefficient at which the one before ends, and its errors are no smaller.
    """
    found = [region_of(band) for band in every]
    for last, region in itertools.pairwise(each for each in found if each is not None):
        region["ranges"]["friction"] = last["ranges"]["friction"][1], region["ranges"]["friction"][1]
        for state, errors in region["errors"].items():
            errors |= {key: max(error, last["errors"][state][key]) for key, error in errors.items()}
    return found


def region_of(band: Band) -> dict[str, Any] | None:
    """Return the region of a band; None with fewer than :data:`LEAST` states to make the error or to test it."""
    if min(len(band.made), len(band.tests)) < LEAST:
        return None
    errors = dict[str, dict[str, float]]()
    for state, length, every in (
        ("full_slip", "contact_length", band.some),
        (WHOLE, "contact_area", band.whole + band.some),
    ):
        some = [each for each in every if fits(each)]
        lengths = [each.length for each in some if not math.isnan(each.length)]
        errors[state] = {"f_electrostatic": bound(each.error for each in some)}
        errors[state] |= {length: bound(lengths)} if lengths else {}
    return {"runs": len(band.some), "ranges": hull(band.some, band.whole), "errors": errors}


def hull(some: Sequence[Compared], whole: Sequence[Compared]) -> dict[str, tuple[float, float]]:
    """Return the range by key of sections and fingers in which the error is known; without voltage it is nothing.

    A range ends with its states, or where the sequence's does if that is no farther than its scenes are apart in the
    mean. Without fingers it has no force, and the program then claims an error of sections alone.
    """
    found = {"force": [each.force for each in whole], "f_ext": [each.force for each in some]}
    found |= {key: [each.values[key] for each in some] for key in some[0].values if key != "force"}
    found |= {PULL: [each.attraction / each.force for each in (*some, *whole)]}
    least = {key: 0.0 if key in ("voltage", PULL) else min(values, default=0.0) for key, values in found.items()}
    return {key: _ends(key, least[key], max(values)) for key, values in found.items() if values}


def _ends(key: str, low: float, high: float) -> tuple[float, float]:
    """Return the ends of the range of a key between its least and its largest value, three digits each."""
    first, last, even = AXES.get(key, (low, high, False))
    size = (math.log(last / first) if even else last - first) / COUNT
    gaps = (math.log(low / first), math.log(last / high)) if even else (low - first, last - high)
    low, high = first if gaps[0] <= size else low, last if gaps[1] <= size else high
    return float(f"{low:.3g}"), float(f"{high:.3g}")


class OfScene(Protocol):
    """What is of a scene of the sequence."""

    @property
    def scene(self) -> int:
        """Place in the sequence."""


def fits(one: OfScene) -> bool:
    """Return whether a scene is one that the error is made of; the others test it. :data:`BLOCK` scenes take turns."""
    return one.scene // BLOCK % 2 == 0


def bound(errors: Iterable[float]) -> float:
    """Return the relative error that covers :data:`PART` of some, with the margin, rounded up to 0.1 %."""
    return float(np.ceil(1e3 * MARGIN * np.quantile(np.abs([*errors]), PART) - 1e-9) / 1e3)


def covered(compared: Sequence[Compared], error: float) -> int:
    """Return how many attractions are within a relative error; their friction is then within its own."""
    return sum(abs(each.error) <= error for each in compared)
