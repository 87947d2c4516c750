"""Slopes of a state's results by every number of its scene: what moves the answer, see :mod:`variational.sensitivity`.

A number of the scene acts through the numbers of the model that follow from it: the thickness of the coating through
that of the insulators, and through the closure. Each of these models is made, and the laws and loads of the state are
given their numbers. Layers and ridges of another size move the nodes of the mesh (:mod:`geometry.morph`).
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.model.finger import Finger, both_sides
from fingerpad.model.options import FingerModel
from fingerpad.model.simulation import Simulation
from fingerpad.results.slopes import SLOPES
from fingerpad.scene import Scene
from fingerpad.scene.controls import number_of
from fingerpad.scene.keys import by_name
from geometry.morph import Morph
from variational.contact.formulation import SurfaceState
from variational.numbers import Numbers, impose
from variational.resultants import RidgeLoads
from variational.sensitivity import STEP, Linearised
from variational.solvers.outcome import NotConverged
from variational.solvers.target import Control

Array = NDArray[np.float64]
_SAME = 1e-9  # relative, of a load that is that of the state


@dataclass(frozen=True)
class StateSlopes:
    """Slopes of one state, or why it has none."""

    why: str = ""
    values: Mapping[str, float] | None = None
    """Of the scene, by dotted key; SI."""
    slopes: Mapping[str, Mapping[str, float]] | None = None
    """Derivative of each quantity by each number, by quantity and key; SI."""
    stairs: Mapping[str, Mapping[str, float]] | None = None
    """The same at fixed points in contact: exact until the next one comes or goes (:mod:`variational.sensitivity`)."""
    ends: Mapping[str, tuple[float, float]] | None = None
    """How far each number can fall and rise (SI) until a ridge comes or goes, by straight extrapolation."""
    left_out: Mapping[str, str] | None = None
    """Numbers without a slope, and why."""

    def to_dict(self) -> dict[str, Any]:
        """Return all of it, ready for JSON."""
        ends = {key: [end if end < math.inf else None for end in both] for key, both in (self.ends or {}).items()}
        return {name: value for name, value in vars(self).items() if value} | ({"ends": ends} if ends else {})


def of_run(model: FingerModel, simulation: Simulation, states: Mapping[str, Any]) -> dict[str, Any]:
    """Return the slopes of a run's named states for its record, by state, ready for JSON; collective.

    Args:
        model: of the run; nothing is returned where it wants none.
        simulation: its path, whose last state has the slopes where no state was solved for again.
        states: :class:`fingerpad.accuracy.states.State` by name, as they were solved for again.
    """
    if not model.given:
        return {}
    found = {name: state.slopes for name, state in states.items() if state.slopes is not None}
    if not found and simulation.states and not model.options.errors:
        last = simulation.states[-1]
        name = "full_slip" if last.slip_held else "charged"
        found[name] = state_slopes(model, simulation.finger, last.load_number)
    return {SLOPES: {name: each.to_dict() for name, each in found.items()}}


def follower(finger: Finger) -> Callable[[FingerModel], Array]:
    """Return what moves the nodes of a finger's mesh: places on this rank (m), shape (nodes, 3), by a model.

    The function raises a ValueError where the mesh cannot follow the model's geometry.
    """
    here = finger.problem.mesh.geometry.x.copy()
    morph = cache(lambda: Morph(finger.profiles.finger, here[:, :2]))

    def places(model: FingerModel) -> Array:
        if model.geometry == finger.profiles.finger or model.mesh_file is not None:  # a mesh of one's own stays
            return here
        return np.column_stack([morph().to(model.geometry), here[:, 2]])

    return places


def numbers_of(model: FingerModel, finger: Finger, load_number: int, places: Callable[[FingerModel], Array]) -> Numbers:
    """Return the numbers of a model at the end of one of its loads, from 1, for a finger that stands where it is.

    Args:
        model: the model.
        finger: the finger.
        load_number: of the load.
        places: moves the mesh (:func:`follower`).

    Raises:
        ValueError: the load is one over time, or the mesh cannot follow.
    """
    given = model.loads[:load_number]
    pressed = [(load.f_ext, load.bone_height) for load in given if (load.f_ext, load.bone_height) != (None, None)]
    level = [0.0, *(load.level for load in given if load.voltage is not None)][-1]
    force, height = map(number_of, pressed[-1])
    if (force is None and height is None) or level is None:
        raise ValueError("the state is one of a load over time, by whose numbers there are no slopes")
    interface = replace(
        finger.problem.interface, formulation=model.contact, friction=model.friction, h_0=model.h_0, share=model.share,
        adhesion=model.adhesion,
    )  # fmt: skip
    control = Control(finger.solver.control.x, height, force or 0.0)
    return Numbers(model.solids, interface, model.closure, control, float(level), places(model))


def quantities_of(finger: Finger, skin: SurfaceState, loads: RidgeLoads, bone: Array) -> dict[str, float]:
    """Return the quantities that have slopes; collective.

    Args:
        finger: whose skin it is.
        skin: values at its points.
        loads: resultants of its ridges.
        bone: translation of the bone (m), shape (2,).
    """
    peaks = finger.observer.highest_pressures(skin)
    if not finger.options.both_halves:
        loads, peaks = loads.whole(), both_sides(peaks)
    f_t, pull = -float(loads.f_friction.sum()), float(loads.f_attraction.sum())
    f_ext = float(loads.f_contact.sum()) - pull - float(loads.f_adhesion.sum())
    found = {"mu_app": f_t / f_ext, "f_t": f_t, "f_electrostatic": pull}
    found |= {"contact_length": float(loads.length.sum()), "p_max": float(peaks.max())}
    return found | ({"bone_height": float(bone[1])} if finger.solver.control.y is None else {"f_ext": f_ext})


def state_slopes(model: FingerModel, finger: Finger, load_number: int) -> StateSlopes:
    """Return the slopes of the present state of a finger, which stays as it is; collective.

    Args:
        model: whose numbers are varied.
        finger: in a state of equilibrium.
        load_number: of the load that the state is of, from 1.
    """
    coupling, control, places = finger.coupling, finger.solver.control, follower(finger)

    def numbers(of: FingerModel) -> Numbers:
        return numbers_of(of, finger, load_number, places)

    try:
        now = numbers(model)
        held = (control.force, now.control.force) if control.y is None else (control.y, now.control.y)
        for mine, other in (held, (finger.voltage, now.voltage)):
            if not (other is not None and math.isclose(mine, other, rel_tol=_SAME)):
                raise ValueError("the state is not one of the scene's last loads, by whose numbers there are no slopes")
        linear = Linearised(coupling, partial(quantities_of, finger))
    except (ValueError, NotConverged) as error:  # a run keeps its states where slopes are lost
        return StateSlopes(str(error))
    scales, varied, left_out = dict[str, float](), {}, dict[str, str]()
    for key, value in model.given.items():
        scales[key] = scale = abs(value) or _least(key)

        def changed(part: float, key: str = key, value: float = value, scale: float = scale) -> Numbers:
            return numbers(model.with_number(key, value + part * scale)) if part else now

        try:
            impose(coupling, changed(STEP))
            varied[key] = cache(changed)
        except ValueError as error:
            left_out[key] = str(error)
    impose(coupling, now)
    try:
        found = linear.slopes(varied)
    except ValueError as error:
        impose(coupling, now)
        return StateSlopes(str(error))
    names = next(iter(found.values())).by_step
    return StateSlopes(
        values={key: model.given[key] for key in found},
        slopes={name: {key: each.by_step[name] / scales[key] for key, each in found.items()} for name in names},
        stairs={name: {key: each.stair[name] / scales[key] for key, each in found.items()} for name in names},
        ends={key: (each.down * scales[key], each.up * scales[key]) for key, each in found.items()},
        left_out=left_out,
    )


def _least(key: str) -> float:
    """Return the least amount that a number may have, the step of one that is zero."""
    limits = by_name(Scene)[key].limits
    return 1.0 if limits is None else limits.low
