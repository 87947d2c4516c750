"""Newtons of a run at no cost: one press, one full slip, and charged cylinders in between.

A run of press, charge and slide has the cross-section's whole press without voltage, and one charged state and one full
slip, at the scene's force. The press is on the path's mesh, whose elements are larger, and is scaled to its end on the
final mesh. The slices away from the centre bear less. Their attraction and contact length are those
of the model "cylinders" (:mod:`fingerpad.reduced.cylinders`) over the contact lengths of this press, scaled to
the run's own state at the centre; their indentation is that of the press, scaled to its own. Full slip alone, as in a
sweep of it, has no press; then it is the closed form's, where the finger has one.
``docs/newtons.md`` has the error of this estimate beside traces of the full model. A scene with a ``force`` computes
the traces.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fingerpad.reduced import cylinders
from fingerpad.results.quantities import Output
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.scene.remarks import coefficient
from fingerpad.slices import errors
from fingerpad.slices.finger import WholeFinger, in_order
from fingerpad.slices.total import Profile, profile, under_one_force
from fingerpad.slices.trace import ADHESION, LEAST, NAMES, Trace, TraceError, columns, trace
from fingerpad.slices.traces import LIGHT, NO_NEWTONS
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.results.result import Result

OF_SLIP = "estimated from full slip at its centre by charged cylinders; a force in newtons computes traces"
SOURCE = "estimated from the run's press and its centre by charged cylinders; a force in newtons computes traces"
_MAX_POINTS = 12  # of the trace
_ACCIDENT = 0.25  # of a facet of the path's mesh, in the length of a ridge


def with_newtons(result: "Result") -> "Result":
    """Return the result of a scene without a history with its whole finger, or a note why there is none."""
    if result.scene.history is not None or result.scene.geometry.file is not None or not result.named:
        return result
    try:
        states = [state for state in result.steps if state.load == "press"]
        finger = estimate(result.scene, states or _closed_form(result.scene), result.named, result.outputs)
        return replace(result, finger=finger if states else replace(finger, source=OF_SLIP))
    except (SceneError, TraceError) as error:
        return replace(result, notes=(*result.notes, f"{NO_NEWTONS}: {error}"))


def estimate(
    scene: Scene, press: Sequence[ContactState], named: Mapping[str, ContactState], outputs: Sequence[Output] = ()
) -> WholeFinger:
    """Return the finger whose centre bears the scene's force in one of its named states, and less in the others.

    Args:
        scene: press, charge and slide.
        press: states of the press without voltage, at growing forces up to the scene's.
        named: states at the scene's force, by name.
        outputs: of one's own, that are summed; but for the press from the forces and the contact length, since ridges
            away from the centre are not known.

    Raises:
        SceneError: the profile does not fit, or the cylinders have no equilibrium.
        TraceError: the press has too few states.
    """
    finger, count, wavelength = profile(scene.slices), scene.slices.count, scene.geometry.ridge_wavelength
    presses = _on_final_mesh(_thinned(press), named.get("uncharged"))
    sums = [outputs, *[[*map(_of_sums, outputs)]] * (len(presses) - 1)]
    still = {"uncharged", "charged"} <= set(named) and named["charged"].voltage == 0  # normal contact is one state
    traces, *others = (
        {name: _scaled(scene, press, name, state, wavelength, own) for name, state in named.items()}
        for press, own in zip(presses, sums, strict=True)
    )
    if still:
        named = {**named, "uncharged": named["charged"]}
        for each in (traces, *others):
            each["uncharged"] = each["charged"]
    found = under_one_force(finger, traces, count)
    away = _away(finger, [traces, *others], count)
    carried = {}
    for name, total in found.items():
        estimated = name != "uncharged" and traces[name] is not traces.get("uncharged")
        between = errors.interpolation(finger, traces[name], total, count).get("effective_width", 0.0)
        own = errors.of_section(named[name], wavelength, traces[name].own)
        carried[name] = own | {errors.COARSE: away[name]}
        carried[name] |= {errors.ESTIMATED: errors.estimate(name, total)} if estimated else {}
        carried[name] |= {errors.POINTS: {"f_ext": between}}
    return WholeFinger(in_order(found), SOURCE, carried, traces, scene.slices)


def _on_final_mesh(press: Sequence[ContactState], end: ContactState | None) -> list[Sequence[ContactState]]:
    """Return a press as on the final mesh, and twice more, as its mesh leaves it open under less than the whole force.

    Lengths and indentations are scaled to the end on the final mesh (None without a mesh). First, the facets may take
    the same length off each ridge instead, and not the same part. Second, where contact ends between two facets is an
    accident: the length of a ridge may be off by :data:`_ACCIDENT` of a facet, those of several by its root of squares.
    """
    if end is None or math.isnan(press[-1].mesh_contact):
        return [press]
    now = press[-1]
    length, lower = (_ratio(getattr(end, key), getattr(now, key)) for key in ("contact_length", "bone_height"))
    facet, ridge = now.mesh_contact, now.contact_length / now.ridges_in_contact

    def scaled(state: ContactState, part: float, more: float, deeper: float) -> ContactState:
        """Return a state with a part of the change at the end, a length (m) besides, and indented by more."""
        changed = state.contact_length * (1 + part * (length - 1)) + more
        return replace(state, contact_length=changed, bone_height=state.bone_height * lower * (1 + deeper))

    alike, accident = [], []
    for state in press[:-1]:
        part = ridge / (state.contact_length / state.ridges_in_contact)
        alike.append(scaled(state, part, 0.0, (part - 1) * (lower - 1)))
        accident.append(scaled(state, 1.0, _ACCIDENT * facet * state.ridges_in_contact**0.5, part * (lower - 1)))
    last = scaled(now, 1.0, 0.0, 0.0)
    return [[scaled(state, 1.0, 0.0, 0.0) for state in press], [*alike, last], [*accident, last]]


def _away(finger: Profile, traces: Sequence[Mapping[str, Trace]], count: int) -> dict[str, dict[str, float]]:
    """Return the relative changes of sums by other traces than the first ones, added up, by state and quantity.

    The force changes as much as its ratio to that of the centre.
    """
    every = {f"{name} {k}": trace for k, each in enumerate(traces) for name, trace in each.items()}
    found = {key: total.values for key, total in under_one_force(finger, every, count).items()}
    away = dict[str, dict[str, float]]()
    for name in traces[0]:
        own, *others = (found[f"{name} {k}"] for k in range(len(traces)))
        there = [key for key, value in own.items() if value and all(key in each for each in others)]
        away[name] = {key: sum(abs(each[key] / own[key] - 1) for each in others) for key in there}
        away[name]["f_ext"] = away[name]["effective_width"]
    return away


def _closed_form(scene: Scene) -> list[ContactState]:
    """Return a press without voltage by the closed form, where its contact is known."""
    still = scene.model_copy(update={"voltage": 0.0})
    forces = [float(each) for each in np.geomspace(scene.f_ext * LIGHT, scene.f_ext, _MAX_POINTS)]
    try:
        return cylinders.Cylinders().over_forces(still, forces, "charged", cylinders.solve)
    except SceneError:
        raise TraceError(
            "full slip alone has no press, and the closed form has none of this finger; states='all' or fp.press has it"
        ) from None


def _thinned(press: Sequence[ContactState]) -> list[ContactState]:
    """Return some states, the last one among them, about evenly in the logarithm of the force."""
    states = [state for state in press if state.f_ext > 0 and state.contact_length > 0]
    if len(states) < LEAST:
        raise TraceError(f"the press has {len(states)} states with a force; a trace must have {LEAST} at least")
    forces = np.log([state.f_ext for state in states])
    wanted = np.linspace(forces[0], forces[-1], _MAX_POINTS)
    return [states[k] for k in sorted({int(np.abs(forces - each).argmin()) for each in wanted})]


def _of_sums(output: Output) -> Output:
    """Return an output as it follows from what slices are summed in, without the values by ridge."""
    return replace(output, compute=lambda state: output.of(replace(state, ridges=None, sites=None)))


def _scaled(
    scene: Scene,
    press: Sequence[ContactState],
    name: str,
    end: ContactState,
    wavelength: float,
    outputs: Sequence[Output],
) -> Trace:
    """Return the trace of a named state: the press changed as the cylinders are, and scaled to the state itself."""
    states = _charged(scene, press, name, end.voltage)
    law, now = scene.friction_law(), states[-1]
    keys = ("f_electrostatic", "f_adhesion", "contact_length", "bone_height")
    shape = {key: _ratio(getattr(end, key), getattr(now, key)) for key in keys}
    found = [replace(state, **{key: factor * getattr(state, key) for key, factor in shape.items()}) for state in states]
    slips = name == "full_slip" and law is not None
    borne = [(state.f_ext + state.f_attraction, state.contact_length) for state in found]
    friction = [law.resultant(*each) if slips and law else 0.0 for each in borne]
    # Coulomb's law does not ask how a force is spread; any other one is scaled to the run's own state.
    factor = 1.0 if coefficient(scene) is not None else _ratio(abs(end.f_t), friction[-1])
    found = [
        replace(state, f_t=factor * f_t, mu_app=factor * f_t / state.f_ext, f_contact=borne, voltage=end.voltage)
        for state, f_t, (borne, _) in zip(found, friction, borne, strict=True)
    ]
    pressed = name == "uncharged" or (name == "charged" and end.voltage == 0)
    made = trace(found, wavelength, outputs=outputs if pressed else map(_of_sums, outputs))
    ends = columns([end], wavelength, outputs)
    own = [each for each in made.own if each.name in ends and (made.columns[each.name][-1] or not ends[each.name][0])]
    scaled = {key: made.columns[key] for key in ("gross_width", *(each.name for each in own))}
    scaled = {key: _ratio(ends[key][0], values[-1]) * values for key, values in scaled.items()}
    kept = {key: values for key, values in made.columns.items() if key in (*NAMES, ADHESION)}
    return Trace(made.depth, kept | scaled, own=tuple(own))


def _charged(scene: Scene, press: Sequence[ContactState], name: str, voltage: float) -> list[ContactState]:
    """Return the states of the press as the cylinders charge them to a voltage (V)."""
    if voltage == 0:
        return list(press)
    here = scene.model_copy(update={"voltage": voltage})
    found = cylinders.over_forces(here, [state.f_ext for state in press], name, press)
    return [
        replace(state, f_electrostatic=charged.f_electrostatic, contact_length=charged.contact_length)
        for state, charged in zip(press, found, strict=True)
    ]


def _ratio(value: float, of: float) -> float:
    return value / of if of else 1.0
