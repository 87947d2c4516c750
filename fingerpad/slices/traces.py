"""Traces of the cross-section for a force in newtons.

The full model follows all traces in one simulation (``fingerpad.runs.newtons``). A model without a path has points at
fixed forces (:mod:`fingerpad.reduced.model`), so that a sum over them does not depend on the way to it. A trace that
ends before the force is reached is made again to a larger one.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fingerpad.results.quantities import PENALTY, STABILITY
from fingerpad.results.states import WORDS
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.scene.parameters import LINE, POINT, POWER
from fingerpad.slices import errors
from fingerpad.slices.finger import WholeFinger, in_order
from fingerpad.slices.total import BeyondTrace, Total, at_force, profile
from fingerpad.slices.trace import Trace, borne
from variational.state import ContactState, Errors

if TYPE_CHECKING:
    pass

NO_NEWTONS = "no newtons of the whole finger"
"""Beginning of a note that says why."""
LIGHT = 1 / 30
"""Force under which a finger is charged, and slid to full slip, over the largest of its trace."""
PER_OCTAVE = 2
"""Points of a trace of a model without a path in each doubling of the force."""
SMALLEST, _LARGEST = 1e-3, 5e3
"""Forces (N/m) of a scene."""
_SHORTEST = 1.01 * SMALLEST / LIGHT  # N/m, largest force of a trace whose light one a scene can have
_TRIES = 4  # of a trace, each time to a larger force
_MORE = 1.8  # factor on the largest force of the next try
MARGIN = 1.1
"""Largest force of a trace over the one expected at the centre."""
CONSTANTS = {
    "light": LIGHT, "per_octave": PER_OCTAVE, "margin": MARGIN, "more": _MORE, "tries": _TRIES,
    "shortest": _SHORTEST, "smallest": SMALLEST, "largest": _LARGEST,
    "start": {"line": LINE, "point": POINT, "power": POWER},
}  # fmt: skip
"""All of these, for the copy of the calculator, of a finger of the default's width."""


class Traced(NamedTuple):
    """A trace, with what it was made of."""

    trace: Trace
    states: list[ContactState]
    """Its points, and those that it leaves out."""
    total: Total | None = None
    """The finger under the force, once it was found on the trace."""
    end: ContactState | None = None
    """The section at its largest force; None of a model without discretisation errors."""
    carried: Mapping[str, dict[str, float]] = {}
    """Relative errors of the sum by part and quantity; empty of a model without discretisation errors."""


def grid(expected: float, top: float) -> list[float]:
    """Return the forces (N/m) of a trace: powers of two and between them, from a light one to the second beyond a top.

    A monotone cubic takes its slopes from its neighbours, so that more points do not change it up to the top. The force
    expected at the centre is :data:`LIGHT` times that at the start.
    """
    first = round(math.log2(expected * LIGHT)) * PER_OCTAVE
    last = max(math.ceil(math.log2(top) * PER_OCTAVE) + 1, first + 3)
    return [2.0 ** (k / PER_OCTAVE) for k in range(first, last + 1)]


def states(scene: Scene) -> list[str]:
    """Return the names of the states whose traces a scene needs, in the order of its loads."""
    charged, slips = bool(scene.volts), scene.friction_law() is not None
    return ["uncharged", *["charged"] * charged, *["full_slip"] * slips]


def summed(scene: Scene, words: str, found: Mapping[str, Traced]) -> WholeFinger:
    """Return the finger on its traces by state; ``words`` say what these are of."""
    totals = {name: each.total for name, each in found.items() if each.total is not None}
    known = {name: dict(each.carried) or {errors.MESH: {}} for name, each in found.items()}
    of = {name: each.trace for name, each in found.items()}
    tops = (f"{each.trace.end[1]:.4g} N/m ({name.replace('_', ' ')})" for name, each in found.items())
    if not scene.volts:  # normal contact is one state then, with two names
        for values in (totals, known, of):
            values["charged"] = values["uncharged"]  # type: ignore[assignment]
    return WholeFinger(in_order(totals), f"{words} to {', '.join(tops)}", known, of, scene.slices)


def sections(scene: Scene, found: Mapping[str, Traced]) -> dict[str, Any]:
    """Return the section at the centre of the finger of a model with errors, by state; None without a trace."""
    scale, wavelength = profile(scene.slices).centre_scale, scene.geometry.ridge_wavelength
    named = {
        name: _section(each, name, each.total.delta / scale, wavelength)
        for name, each in found.items()
        if each.total is not None
    }
    if not scene.volts:
        named["charged"] = named["uncharged"]
    return {name: named.get(name) for name in WORDS}


def _section(traced: Traced, name: str, depth: float, wavelength: float) -> ContactState:
    """Return the section at the centre of the finger at a depth (m), interpolated between the points of its trace."""
    at: dict[str, Any] = {key: float(values[0]) for key, values in traced.trace.at(np.array([depth])).items()}
    near = min(traced.states, key=lambda state: abs(state.bone_height + depth))
    mu_app = at["f_t"] / at["f_ext"]
    end, own = traced.end, {each.name: at.pop(each.name) for each in traced.trace.own}
    assert end is not None
    del at["gross_width"]
    state = ContactState(
        **at,
        mu_app=mu_app,
        voltage=near.voltage,
        f_contact=float(borne(at)),
        bone_height=-depth,
        ridges_in_contact=near.ridges_in_contact,
        mesh_contact=end.mesh_contact,
        **{key: getattr(end, key) for key in STABILITY},
        all_slip=name == "full_slip",
        slip_held=name == "full_slip",
        own=own,
    )
    mesh, penalty = (errors.on_section(state, traced.carried.get(part, {})) for part in (errors.MESH, PENALTY))
    return replace(state, error=Errors.of(errors.add(mesh, penalty)), penalty=Errors.of(penalty))


class Reach:
    """Has traces made to forces that are large enough."""

    def __init__(self, scene: Scene, make: Callable[[str, float], Traced]) -> None:
        """Expect the force of the default finger at the centre; ``make`` makes a trace to a largest force (N/m)."""
        assert scene.force is not None
        self._force, self._count, self._make = scene.force, scene.slices.count, make
        self._finger = profile(scene.slices)
        self._scale = self._finger.centre_scale  # refuses a finger that is lowest at its end
        self._top = scene.centre_force * MARGIN

    @property
    def top(self) -> float:
        """Largest force (N/m) of the next trace."""
        return min(max(self._top, _SHORTEST), _LARGEST)

    def follow(self, name: str) -> Traced:
        """Return the trace of a state, long enough for the force; refuse one that cannot be."""
        for tries in range(_TRIES):
            top = self.top
            made = self._make(name, top)
            try:
                total = at_force(self._finger, made.trace, self._force, self._count)
            except BeyondTrace as error:
                if tries == _TRIES - 1 or top == _LARGEST:
                    raise SceneError(str(error)) from None
                self._top *= _MORE
                continue
            self._top = total.centre / self._scale * MARGIN  # of the next trace
            return made._replace(total=total)
        raise AssertionError("every try returns or raises")
