"""Traces of the cross-section for a force in newtons.

The full model follows three histories. The finger is pressed without voltage. It is pressed lightly, charged and
pressed on. It is pressed lightly, charged, slid to full slip and pressed on while it slides. Where full slip does not
depend on the path, one simulation has all of them (``fingerpad.runs.newtons``). Elsewhere they are ordinary scenes,
and every accepted step at full slip is a point of the trace. A model without a path has points at fixed forces
(:mod:`fingerpad.slices.grid`), so that a sum over them does not depend on the way to it. A trace that ends before the
force is reached is made again to a larger one.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fingerpad.results.quantities import PENALTY, STABILITY, Output
from fingerpad.results.result import Cost, Result
from fingerpad.results.states import WORDS
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.scene.parameters import LINE, POINT, POWER
from fingerpad.slices import errors
from fingerpad.slices.finger import WholeFinger, in_order
from fingerpad.slices.grid import LIGHT as LIGHT
from fingerpad.slices.grid import PER_OCTAVE, of_points
from fingerpad.slices.total import BeyondTrace, Total, at_force, profile, under_one_force
from fingerpad.slices.trace import Trace, TraceError, trace
from geometry.units import computed
from variational.state import ContactState, Errors

if TYPE_CHECKING:
    from fingerpad.reduced.model import Model

Solve = Callable[[Scene, str], Result]
"""Returns the result of a scene; takes a name for the folder of its files."""
NO_NEWTONS = "no newtons of the whole finger"
"""Beginning of a note that says why."""
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
    result: Result | None = None
    """That ends at its largest force; None of a model without a path."""
    total: Total | None = None
    """The finger under the force, once it was found on the trace."""
    end: ContactState | None = None
    """The section at its largest force, where it is no run's."""
    carried: Mapping[str, dict[str, float]] = {}
    """Relative errors of the sum by part and quantity, where they are not those of a run's section."""


def whole(scene: Scene, model: "Model", solve: Solve, outputs: Sequence[Output] = ()) -> Result:
    """Return the result of a force on the whole finger; collective.

    Args:
        scene: with a force.
        model: that solves.
        solve: solves a scene without a force on the whole finger by it.
        outputs: of one's own, that are summed.

    Returns:
        The whole finger, and the section at its centre as named states. A trace that was interrupted is returned as it
        is, without either.

    Raises:
        SceneError: a profile that does not fit, or a force that no trace reached.
    """
    make = partial(_made, scene, model, solve, outputs)
    shared = Reach(
        scene, make
    )  # a trace of runs is made to the force of the one before; the others do not depend on each other
    try:
        found = {name: (shared if model.path else Reach(scene, make)).follow(name) for name in states(scene)}
    except _Stopped as stopped:
        return stopped.result
    finger = summed(scene, model.traces, found)
    if model.path:
        return _of_path(scene, finger, found)
    centre = list(found.values())[-1].total.centre / profile(scene.slices).centre_scale  # type: ignore[union-attr]
    if centre < SMALLEST:
        raise SceneError(
            f"force is {scene.force:.4g} N, under which the centre of the finger bears {centre:.2g} N/m, and it must "
            f"bear at least {SMALLEST:g} N/m; give a larger force or a shorter finger"
        )
    return model.of_finger(scene, solve(scene.replace(f_ext=centre), ""), finger)


def with_sum(result: Result, model: "Model", solve: Solve, outputs: Sequence[Output] = ()) -> Result:
    """Return the result of a section by a model without a path, with its whole finger, or with a note why it has none.

    The centre of the finger bears the section's force in one of the named states, and less in the others.

    Args:
        result: of a scene without a force on the whole finger.
        model: that solved it.
        solve: solves a scene by it.
        outputs: of one's own, that are summed.
    """
    scene = result.scene
    try:
        f_ext = scene.f_ext
        found = {name: Traced(*of_points(scene, model, solve, name, f_ext, f_ext, outputs)) for name in states(scene)}
        traces = {name: each.trace for name, each in found.items()}
        totals = under_one_force(profile(scene.slices), traces, scene.slices.count, f_ext)
        found = {name: each._replace(total=totals[name]) for name, each in found.items()}
        return model.of_finger(scene, result, summed(scene, model.traces, found))
    except SceneError as error:
        return replace(result, notes=(*result.notes, f"{NO_NEWTONS}: {error}"))


def history(scene: Scene, name: str, top: float, part: float = LIGHT) -> Scene:
    """Return the scene of a trace of the full model.

    Args:
        scene: press, charge and slide.
        name: ``uncharged``, ``charged`` or ``full_slip``.
        top: largest force (N/m).
        part: light force over that.
    """
    light, far = top * part, scene.slide_length
    loads: list[dict[str, float | str | bool]] = [{"name": "press", "f_ext": top if name == "uncharged" else light}]
    if name != "uncharged" and scene.volts:
        loads += [{"name": "charge", "voltage": scene.volts}]
    if name == "charged":
        loads += [{"name": "raise", "f_ext": top}]
    if name == "full_slip":
        loads += [
            {"name": "slide", "bone_x": far / 4, "until_full_slip": True},
            {"name": "raise", "f_ext": top, "bone_x": far},
            {"name": "hold", "bone_x": 2 * far, "until_full_slip": True},
        ]
    with computed():
        return scene.replace(history=loads)


def points(result: Result, name: str) -> list[ContactState]:
    """Return the states of a run of :func:`history` that are points of its trace."""
    if name == "full_slip":
        return [state for state in result.steps if state.all_slip and state.f_t > 0]
    if name == "uncharged":
        return [state for state in result.steps if state.load == "press"]
    voltage = result.scene.loads()[1].voltage
    return [state for state in result.steps if state.load in ("charge", "raise") and state.voltage == voltage]


def states(scene: Scene) -> list[str]:
    """Return the names of the states whose traces a scene needs, in the order of its loads."""
    charged, slips = bool(scene.volts), scene.friction_law() is not None
    return ["uncharged", *["charged"] * charged, *["full_slip"] * slips]


def summed(scene: Scene, words: str, found: Mapping[str, Traced]) -> WholeFinger:
    """Return the finger on its traces.

    Args:
        scene: of all.
        words: what the traces are of.
        found: the traces by state.
    """
    totals = {name: each.total for name, each in found.items() if each.total is not None}
    wavelength = scene.geometry.ridge_wavelength
    known = {name: _carried(each, name, wavelength) for name, each in found.items()}
    of = {name: each.trace for name, each in found.items()}
    tops = (f"{each.trace.end[1]:.4g} N/m ({name.replace('_', ' ')})" for name, each in found.items())
    if not scene.volts:  # normal contact is one state then, with two names
        for values in (totals, known, of):
            values["charged"] = values["uncharged"]  # type: ignore[assignment]
    return WholeFinger(in_order(totals), f"{words} to {', '.join(tops)}", known, of, scene.slices)


def _of_path(scene: Scene, finger: WholeFinger, found: dict[str, Traced]) -> Result:
    """Return the result of traces that are runs."""
    runs = [each.result for each in found.values() if each.result is not None]
    return replace(
        runs[-1],
        scene=scene,
        record={key: value for key, value in runs[-1].record.items() if key != "steps"},
        **sections(scene, found),
        steps=(),
        loads=(),
        outputs=(),
        drawing=None,
        folder=None,
        cost=_together(run.cost for run in runs),
        failure="",
        notes=tuple(dict.fromkeys(note for run in runs for note in run.notes)),
        cautions=tuple(dict.fromkeys(caution for run in runs for caution in run.cautions)),
        finger=finger,
    )


def sections(scene: Scene, found: Mapping[str, Traced]) -> dict[str, Any]:
    """Return the section at the centre of the finger by state; None in states without a trace."""
    scale, wavelength = profile(scene.slices).centre_scale, scene.geometry.ridge_wavelength
    named = {
        name: _section(each, name, each.total.delta / scale, wavelength)
        for name, each in found.items()
        if each.total is not None
    }
    if not scene.volts:
        named["charged"] = named["uncharged"]
    return {name: named.get(name) for name in WORDS}


def _carried(traced: Traced, name: str, wavelength: float) -> dict[str, dict[str, float]]:
    """Return the errors that a sum takes over: those that its trace has, else those of its end."""
    return dict(traced.carried) or errors.of_section(_end(traced, name), wavelength, traced.trace.own)


def _section(traced: Traced, name: str, depth: float, wavelength: float) -> ContactState:
    """Return the section at the centre of the finger, interpolated between the points of its trace.

    Args:
        traced: the trace.
        name: of the state.
        depth: indentation of the section (m).
        wavelength: of a ridge (m).
    """
    at: dict[str, Any] = {key: float(values[0]) for key, values in traced.trace.at(np.array([depth])).items()}
    near = min(traced.states, key=lambda state: abs(state.bone_height + depth))
    mu_app = at["f_t"] / at["f_ext"]
    end, own = _end(traced, name), {each.name: at.pop(each.name) for each in traced.trace.own}
    del at["gross_width"]
    state = ContactState(
        **at,
        mu_app=mu_app,
        voltage=near.voltage,
        f_contact=at["f_ext"] + at["f_electrostatic"],
        bone_height=-depth,
        ridges_in_contact=near.ridges_in_contact,
        mesh_contact=near.mesh_contact if end is None else end.mesh_contact,
        **({} if end is None else {key: getattr(end, key) for key in STABILITY}),
        all_slip=name == "full_slip",
        slip_held=name == "full_slip",
        own=own,
    )
    carried = _carried(traced, name, wavelength)
    mesh, penalty = (errors.on_section(state, carried.get(part, {})) for part in (errors.MESH, PENALTY))
    return replace(state, error=Errors.of(errors.add(mesh, penalty)), penalty=Errors.of(penalty))


def _end(traced: Traced, name: str) -> ContactState | None:
    """Return the state at the largest force of a trace, None of a model without discretisation errors."""
    if traced.end is not None:
        return traced.end
    named = {} if traced.result is None else traced.result.named
    return named.get("charged" if name == "uncharged" else name)


def _together(costs: Iterable[Cost]) -> Cost:
    """Return what runs one after the other cost together: sums, and the largest memory and system."""
    values, most = [*costs], ("unknowns", "memory_mb", "ranks")
    every = {field.name: [getattr(cost, field.name) for cost in values] for field in fields(Cost)}
    return Cost(**{name: max(each) if name in most else sum(each) for name, each in every.items()})


class _Stopped(Exception):  # noqa: N818
    """A trace was interrupted; its attribute ``result`` says so."""

    def __init__(self, result: Result, name: str) -> None:
        super().__init__(name)
        stopped = result.failure.partition(";")[0]
        failure = f"{stopped} of the trace of {WORDS[name]}; the same command goes on with it"
        self.result = replace(result, failure=failure)


class Reach:
    """Has traces made to forces that are large enough."""

    def __init__(self, scene: Scene, make: Callable[[str, float, int], Traced]) -> None:
        """Expect the force of the default finger at the centre.

        Args:
            scene: with a force.
            make: makes the trace of a state to a largest force (N/m); takes how often it was made before, too.
        """
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
        """Return the trace of a state, long enough for the force.

        Raises:
            SceneError: it could not be made so long.
        """
        for tries in range(_TRIES):
            top = self.top
            made = self._make(name, top, tries)
            try:
                total = at_force(self._finger, made.trace, self._force, self._count)
            except BeyondTrace as error:
                failure = "" if made.result is None else made.result.failure
                if failure or tries == _TRIES - 1 or top == _LARGEST:
                    why = f": {failure}" if failure else ""
                    raise SceneError(f"{error}{why}") from None
                self._top *= _MORE
                continue
            self._top = total.centre / self._scale * MARGIN  # of the next trace
            return made._replace(total=total)
        raise AssertionError("every try returns or raises")


def _made(
    scene: Scene, model: "Model", solve: Solve, outputs: Sequence[Output], name: str, top: float, tries: int
) -> Traced:
    """Return a trace as ordinary scenes have it, each try in a folder of its own; see :class:`Reach`, :func:`whole`."""
    here = scene.replace(force=None)
    if not model.path:
        return Traced(*of_points(here, model, solve, name, scene.centre_force, top, outputs))
    result = solve(history(here, name, top), f"{name}_{tries + 1}" if tries else name)
    if result.interrupted:
        raise _Stopped(result, name)
    found = points(result, name)
    try:
        return Traced(trace(found, scene.geometry.ridge_wavelength, outputs=outputs), found, result)
    except TraceError as error:
        why = f": {result.failure}" if result.failure else ""
        raise SceneError(f"the force on the finger is {scene.force:.4g} N; {error}{why}") from None
