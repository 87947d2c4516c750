"""Traces of the cross-section for a force in newtons, by any model, as ordinary scenes.

The full model follows three histories. The finger is pressed without voltage. It is pressed lightly, charged and
pressed on. It is pressed lightly, charged, slid to full slip and pressed on while it slides; every accepted step at
full slip is then a point of the trace. A model without a path has :data:`FORCES` points. A trace that ends before the
force is reached is made again to a larger one.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fingerpad.io.files import below
from fingerpad.io.result import Result
from fingerpad.io.states import WORDS
from fingerpad.reduced.model import Model
from fingerpad.scene import Scene, SceneError
from fingerpad.slices import errors
from fingerpad.slices.finger import WholeFinger, in_order
from fingerpad.slices.profile import Profile, profile
from fingerpad.slices.total import BeyondTrace, Total, at_force
from fingerpad.slices.trace import Trace, TraceError, trace
from geometry.bounds import computed
from variational.state import ContactState

if TYPE_CHECKING:
    from collections.abc import Callable

    Solve = Callable[[Scene, str], Result]

FORCES = 8
"""Points of a trace of a model without a path."""
LIGHT = 1 / 30
"""Force under which a finger is charged, and slid to full slip, over the largest of its trace."""
_SMALLEST, _LARGEST = 1e-3, 5e3  # N/m, of a scene
_SHORTEST = 1.01 * _SMALLEST / LIGHT  # N/m, largest force of a trace whose light one a scene can have
_TRIES = 4  # of a trace, each time to a larger force
_MORE, _MARGIN = 1.8, 1.1  # factors on the largest force: of the next try, and beyond the expected one
# A finger of the default's width bears some 0.53 N where its centre bears 75 N/m; forces grow as F^0.77.
_LINE, _POINT, _POWER, _WIDTH = 75.0, 0.53, 0.77, 20e-3


class Traced(NamedTuple):
    """A trace, the result that ends at its largest force, and the finger under the force on it."""

    trace: Trace
    result: Result | None
    """None of a model without a path."""
    total: Total | None = None


def whole(scene: Scene, force: float, model: Model, solve: "Solve") -> Result:
    """Return the result at the end of the last trace, with the whole finger under a force; collective.

    Args:
        scene: press, charge and slide; ``force`` takes the place of its ``f_ext``.
        force: on the whole finger (N).
        model: that solves.
        solve: solves a scene; takes a name for the folder of its files too, empty for the result's own.

    Raises:
        SceneError: a scene with a history, a profile that does not fit, or a force that no trace reached.

    A trace that was interrupted is returned as the result, without the whole finger.
    """
    refuse(scene)
    finger = profile(scene.slices)
    scale = finger.centre_scale  # refuses a finger that is lowest at its end
    reach = _Reach(scene, finger, force, model, solve)
    try:
        found = {name: reach.follow(name) for name in _wanted(scene)}
    except _Stopped as stopped:
        return stopped.result
    totals = {name: each.total for name, each in found.items() if each.total is not None}
    known = {name: {errors.MESH: errors.discretisation(_end(each, name))} for name, each in found.items()}
    source = f"{model.traces} to "
    source += ", ".join(f"{each.trace.end[1]:.4g} N/m ({name.replace('_', ' ')})" for name, each in found.items())
    last = list(found.values())[-1].result
    if last is None:
        f_ext = list(totals.values())[-1].centre / scale
        if f_ext < _SMALLEST:
            raise SceneError(
                f"force is {force:.4g} N, under which the centre of the finger bears {f_ext:.2g} N/m, and the model "
                f"{model.name!r} must have at least {_SMALLEST:g} N/m; give a larger force or a shorter finger"
            )
        last = solve(scene.model_copy(update={"f_ext": f_ext}), "")
    states = {name: each.trace for name, each in found.items()}
    if not scene.voltage:  # normal contact is one state then, with two names
        totals["charged"], known["charged"] = totals["uncharged"], known["uncharged"]
        states["charged"] = states["uncharged"]
    return replace(last, finger=WholeFinger(in_order(totals), source, known, states, scene.slices))


def _end(traced: Traced, name: str) -> ContactState | None:
    """Return the state at the largest force of a trace, None of a model without discretisation errors."""
    named = {} if traced.result is None else traced.result.named
    return named.get("charged" if name == "uncharged" else name)


def _wanted(scene: Scene) -> Iterator[str]:
    """Yield the names of the traces, the last one that of the result."""
    yield "uncharged"
    if scene.voltage:
        yield "charged"
    if scene.friction_law() is not None:
        yield "full_slip"


def refuse(scene: Scene) -> None:
    """Refuse a scene that has no traces.

    Raises:
        SceneError: a history, or a mesh of its own.
    """
    if scene.history is not None:
        raise SceneError(
            "history is given; a force in N is that of press, charge and slide alone, so give voltage instead"
        )
    if scene.laws.mesh is not None:
        raise SceneError("mesh is given; a force in N is that of fingers of the scene's own geometry alone")


class _Stopped(Exception):  # noqa: N818
    """A trace was interrupted; its attribute ``result`` says so."""

    def __init__(self, result: Result, name: str) -> None:
        super().__init__(name)
        stopped = result.failure.partition(";")[0]
        failure = f"{stopped} of the trace of {WORDS[name]}; the same command starts the traces again"
        self.result = replace(result, failure=failure)


class _Reach:
    """Follows traces to forces that are large enough."""

    def __init__(self, scene: Scene, finger: Profile, force: float, model: Model, solve: "Solve") -> None:
        self._scene, self._finger, self._force, self._model, self._solve = scene, finger, force, model, solve
        scale = scene.geometry.width / _WIDTH
        self._top = _LINE * scale * (force / (_POINT * scale**2)) ** _POWER * _MARGIN

    def follow(self, name: str) -> Traced:
        """Return the trace of a state, long enough for the force.

        Raises:
            SceneError: it could not be made so long.
        """
        for tries in range(_TRIES):
            top = min(max(self._top, _SHORTEST), _LARGEST)
            made = self._made(name, top)
            try:
                total = at_force(self._finger, made.trace, self._force, self._scene.slices.count)
            except BeyondTrace as error:
                failure = "" if made.result is None else made.result.failure
                if failure or tries == _TRIES - 1 or top == _LARGEST:
                    why = f": {failure}" if failure else ""
                    raise SceneError(f"{error}{why}") from None
                self._top *= _MORE
                continue
            self._top = total.centre / self._finger.centre_scale * _MARGIN  # of the next trace
            return made._replace(total=total)
        raise AssertionError("every try returns or raises")

    def _made(self, name: str, top: float) -> Traced:
        scene = self._scene
        if not self._model.path:
            return Traced(self._points(name, top), None)
        folder = "" if name == list(_wanted(scene))[-1] else name
        result = self._solve(history(scene, name, top), folder)
        if result.interrupted:
            raise _Stopped(result, name)
        try:
            return Traced(trace(points(result, name), scene.geometry.ridge_wavelength), result)
        except TraceError as error:
            why = f": {result.failure}" if result.failure else ""
            raise SceneError(f"the force on the finger is {self._force:.4g} N; {error}{why}") from None

    def _points(self, name: str, top: float) -> Trace:
        """Return a trace of a model without a path."""
        scene = self._scene.model_copy(update={"voltage": 0.0}) if name == "uncharged" else self._scene
        forces = [float(each) for each in np.geomspace(top * LIGHT, top, FORCES)]
        kind = "full_slip" if name == "full_slip" else "charged"
        states = self._model.over_forces(scene, forces, kind, lambda each: self._solve(each, name))
        return trace(states, scene.geometry.ridge_wavelength)


def history(scene: Scene, name: str, top: float) -> Scene:
    """Return the scene of a trace of the full model.

    Args:
        scene: press, charge and slide.
        name: ``uncharged``, ``charged`` or ``full_slip``.
        top: largest force (N/m).
    """
    light, far = top * LIGHT, scene.slide_length
    loads: list[dict[str, float | str | bool]] = [{"name": "press", "f_ext": top if name == "uncharged" else light}]
    if name != "uncharged" and scene.voltage:
        loads += [{"name": "charge", "voltage": scene.voltage}]
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


def folder_of(out: Path | None, name: str) -> Path | None:
    """Return the folder of a trace's files."""
    return None if out is None else below(out, name) if name else out
