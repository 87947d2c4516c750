r"""The model "cylinders": every ridge in contact the same charged cylinder, an answer in a fraction of a second.

n ridges bear :math:`f = f_{ext} / n` each; :mod:`variational.attraction.cylinder` gives contact force, attraction and
air gap of a ridge. Friction at full slip is the limit of the friction law at the mean pressure, over the length in
contact; Coulomb's is :math:`f_T = \mu_0 (f_{ext} + f_{el})`. The number of ridges in contact and the length of their
contact are those of one press of the finger *without* voltage (:mod:`fingerpad.reduced.press`), interpolated between
its forces. The modulus E* of the ridges is then the one with which their tips have that length, which includes finite
strain, layers and shear. The length under voltage follows from Maugis's equations. More shear stress stiffens the
ridges, see below.

**Tips.** Sinusoidal ridges are cylinders of the radius of their crests. Of any other profile the contact reaches where
the tip is no circle any more: it is the power law about its length without voltage (:mod:`variational.attraction.tip`).

**Shear.** The contact at full slip is that with a friction coefficient of 0.25. Stronger friction leans the finger and
its ridges further; their trailing sides lift, and the contact is shorter, about in proportion to the shear stress
(Forsbach et al. 2023, Fig. 8). It shortens as if the ridges were stiffer, by the shear stress beyond that at the same
contact pressure:

.. math:: E^*(p_c) = E^*_{0.25} + \kappa \max(t_{max}(p_c) - 0.25\,p_c,\, 0), \qquad \kappa = 10 .

The one number :math:`\kappa` (:data:`SHEAR`) is fitted to the attraction of states of the full model of the default
finger, of seeded scenes over coatings, forces, voltages and friction coefficients. Other states test it, and so do all
contact lengths (``docs/closed_form.md``). The number of ridges stays that of the press. A press without full slip has
the ridges and the length that friction leaves of its contact (:mod:`fingerpad.reduced.press`), and the same κ.

The model leaves out that ridges in the middle bear more than those at the edge, and that ridges come with the voltage.
``docs/closed_form.md`` has its errors.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.launcher import needed_by
from fingerpad.model.cautions import examine, on_scene, sticking
from fingerpad.reduced import cylinder_errors, press
from fingerpad.reduced.model import STATES, Model, check_supported, reduced_state
from fingerpad.reduced.press import Press
from fingerpad.results.data import MODEL_ERROR, Cost
from fingerpad.results.quantities import MODEL
from fingerpad.results.result import Result
from fingerpad.results.states import WORDS
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.remarks import used
from fingerpad.slices import errors
from geometry.parameters import Fingertip
from geometry.profiles import Profiles
from variational.attraction.cylinder import Cylinder, NoEquilibriumError, RidgeState
from variational.attraction.tip import Power, Round, Tip, kernel
from variational.caution import Caution
from variational.state import ContactState, Errors

if TYPE_CHECKING:
    from fingerpad.runs.context import RunContext
    from fingerpad.slices.finger import WholeFinger

Array = NDArray[np.float64]
SHEAR = 10.0
"""What the modulus of a ridge gains, over the shear stress beyond that of the default friction coefficient."""
_FLAT = 0.01
"""Of a ridge's height: how far its middle may be below its crests."""


def _source(scene: Scene) -> str:
    """Return in words where the contact length is from."""
    own = press.of(scene)
    low, high = own.forces[0], own.forces[-1]
    source = "uncharged contact length interpolated between forces of one press of this finger"
    if not low <= scene.f_ext <= high:
        source = f"uncharged contact length extrapolated from a press of this finger at {low:g} to {high:g} N/m"
    if not own.slid:
        source += "; that of full slip less what friction rolls off"
    elif scene.friction != press.KNOWN:
        source += f"; that of full slip with a friction coefficient of {press.KNOWN:g}, and shorter by more shear"
    return source


class Cylinders(Model):
    """Every ridge in contact the same charged cylinder."""

    name, words = "cylinders", "A closed form of charged cylinders"
    traces = "traces of charged cylinders, indentations without voltage"
    sums = True

    def check(self, scene: Scene) -> None:
        """Refuse a scene that it does not answer for; have its finger pressed where that has not been done."""
        super().check(scene)
        if press.known(scene) is None:
            with needed_by("the press of a finger"):
                from fingerpad.runs import press as runs  # finite elements
            runs.press(scene)

    def solve(self, scene: Scene, context: "RunContext") -> Result:
        """Return the answer of :func:`solve`."""
        return solve(scene)

    def over_forces(
        self, scene: Scene, f_ext: Sequence[float], state: str, solve: Callable[[Scene], Result]
    ) -> list[ContactState]:
        """Return the states computed together, with the indentations without voltage."""
        return press.of(scene).lowered(over_forces(scene, f_ext, state), state)

    def of_finger(self, scene: Scene, section: Result, finger: "WholeFinger") -> Result:
        """Return the result with the known error of the whole finger, or a caution that it is not known."""
        known, cautions, carried = dict(section.record[MODEL_ERROR]), [*section.cautions], dict(finger.carried)
        force = finger.f_ext
        under = scene.replace(force=force) if scene.force is None else scene
        if "full_slip" in finger.states:
            attraction = finger.states["full_slip"].totals["f_electrostatic"]
            known[cylinder_errors.WHOLE] = cylinder_errors.at_full_slip(under, attraction)
            if scene.force is not None and section.full_slip is not None:
                own = cylinder_errors.cautions(section.scene, _pull(section.full_slip))
                cautions = [each for each in cautions if each not in own]
                cautions += cylinder_errors.cautions(under, attraction / force)
        for name, total in finger.states.items():
            found = known.get(cylinder_errors.WHOLE if name == "full_slip" else name, {})
            carried[name] = carried[name] | {MODEL: errors.of_model(found, total)}
        record = {**section.record, MODEL_ERROR: {name: each for name, each in known.items() if each}}
        finger = replace(finger, carried=carried)
        return replace(section, scene=scene, finger=finger, record=record, cautions=tuple(cautions))


def solve(scene: Scene) -> Result:
    """Return the answer of the cylinders.

    Raises:
        SceneError: a scene with a history, a finger without a press, or ridges that do not stay.
    """
    start = time.process_time()
    check_supported(scene, Cylinders.name)
    source, ridges = _source(scene), dict[str, RidgeState]()
    exact = "a closed form, without a mesh: no discretisation error but that of the contact length it is given"
    cautions, found = list[Caution](), dict[str, ContactState]()
    for state in STATES:
        ((found[state], ridges[state]),) = _over_forces(scene, [scene.f_ext], state, (), SHEAR)
        cautions += _others(state, ridges[state])
    known = cylinder_errors.errors(scene.model_copy(update={"force": None}), found)
    cautions += cylinder_errors.cautions(scene, _pull(found["full_slip"]))
    words = (source, exact, cylinder_errors.in_words(known), "the bone's height is not in this model")
    notes = (*words, *map(str, examine("note", scene)))
    gaps = [(WORDS[state], ridge.d_eq, scene.volts) for state, ridge in ridges.items()]
    cautions += on_scene(scene, found.values(), gaps)
    more: dict[str, Any] = {
        f"{state}_{name}": getattr(ridge, name) for state, ridge in ridges.items() for name in ("p_c", "d_eq")
    }
    more |= {"laws": used(scene), MODEL_ERROR: known}
    found = {name: replace(each, error=_errors(each, known.get(name, {}))) for name, each in found.items()}
    cost = Cost(processor_seconds=time.process_time() - start)
    return Result(
        scene, Cylinders.name, None, found["charged"], found["full_slip"],
        cost=cost, notes=notes, cautions=tuple(cautions), record=more,
    )  # fmt: skip


def over_forces(
    scene: Scene,
    f_ext: Sequence[float],
    state: str,
    pressed: Sequence[ContactState] | Press = (),
    shear: float = SHEAR,
    voltage: Sequence[float] | None = None,
) -> list[ContactState]:
    """Return a state of a scene under each of several external forces, computed together.

    Args:
        scene: with the voltage of all.
        f_ext: external forces (N/m).
        state: ``charged`` or ``full_slip``.
        pressed: states without voltage under these forces, or a press, whose contact it is; by default the finger's
            press.
        shear: in place of :data:`SHEAR`.
        voltage: of each force (V), in place of the scene's.

    Raises:
        SceneError: as :func:`solve`, but for what is wrong with the other state alone.
    """
    check_supported(scene, Cylinders.name)
    return [found for found, _ in _over_forces(scene, f_ext, state, pressed, shear, voltage)]


def _over_forces(
    scene: Scene,
    f_ext: Sequence[float],
    state: str,
    pressed: Sequence[ContactState] | Press,
    shear: float,
    voltage: Sequence[float] | None = None,
) -> list[tuple[ContactState, RidgeState]]:
    """Return the states of :func:`over_forces`, and those of a ridge."""
    own, force, law = pressed or press.of(scene), np.array(f_ext), scene.friction_law()
    if not isinstance(own, Press):
        length, given = np.array([(each.contact_length, each.ridges_in_contact) for each in own]).T

    def solved(left: Any = 1.0) -> tuple[NDArray[Any], list[RidgeState]]:
        """Return how many ridges are in contact, and their states, with a part of the press's contact left."""
        ridges = own.ridge_count(f_ext, state, left) if isinstance(own, Press) else given
        return ridges, _ridges(scene, state, force / ridges, left * length / ridges, shear, voltage)

    left: Any = 1.0
    if isinstance(own, Press):
        length = own.length(f_ext, state)
        if state == "full_slip" and law is not None and not own.slid:
            left = own.left(law.limit, force, 0.0, length)
            ridges, found = solved(left)
            pulled, touching = np.array([(ridge.f_attraction, ridge.length) for ridge in found]).T * ridges / left
            left = own.left(law.limit, force, pulled, touching)
    ridges, found = solved(left)
    states = []
    volts = [scene.voltage] * len(found) if voltage is None else voltage
    for each, count, ridge, own_volts in zip(f_ext, ridges, found, volts, strict=True):
        sums = {"f_contact": ridge.f_contact, "f_electrostatic": ridge.f_attraction, "contact_length": ridge.length}
        contact = {name: int(count) * value for name, value in sums.items()} | {"ridges_in_contact": int(count)}
        under = scene.model_copy(update={"f_ext": float(each), "voltage": own_volts})
        states.append((reduced_state(under, contact, state == "full_slip"), ridge))
    return states


def _ridges(
    scene: Scene, state: str, forces: Array, lengths: Array, shear: float, volts: Sequence[float] | None
) -> list[RidgeState]:
    """Return the states of ridges under external forces (N/m), with lengths in contact (m) without voltage."""
    tip, closure = tip_of(scene.geometry, lengths), scene.closure()
    moduli = tip.modulus(forces, lengths)
    voltage: Any = volts or (scene.volts if scene.drive is None else scene.drive.effective)
    try:
        ridge = Cylinder(tip, moduli, scene.h_0, closure, _stiffening(scene, state, shear))
        return ridge.under_loads(forces, voltage)
    except NoEquilibriumError as error:
        why = "; ".join(filter(None, (str(error), sticking(closure, scene.volts))))
        raise SceneError(f"{WORDS[state]} of the model 'cylinders': {why}") from None


def _stiffening(scene: Scene, state: str, shear: float) -> Callable[[Array], Array] | None:
    """Return what the modulus of a ridge gains (Pa) at contact pressures (Pa); None where nothing shears it further."""
    law = scene.friction_law()
    if state != "full_slip" or law is None or scene.friction == press.KNOWN:
        return None
    return lambda p_c: shear * np.maximum(np.asarray(law.limit(p_c), dtype=float) - press.KNOWN * p_c, 0.0)


def _errors(state: ContactState, known: Mapping[str, float]) -> Errors:
    """Return the errors of a state by its known relative ones."""
    found = {key: share * abs(getattr(state, key)) for key, share in known.items()}
    return Errors.of(found | ({"f_contact": found["f_electrostatic"]} if "f_electrostatic" in found else {}))


def _pull(slip: ContactState) -> float:
    """Return the attraction over the external force."""
    return slip.f_electrostatic / slip.f_ext


def _others(state: str, ridge: RidgeState) -> list[Caution]:
    """Return a caution on other equilibria."""
    if not ridge.others:
        return []
    pressures = ", ".join(f"{p:.4g}" for p in ridge.others)
    text = f"{WORDS[state]}: further equilibria at a mean pressure of {pressures} Pa, of ridges not on the screen yet"
    return [Caution("other_states", text, ridge.others[0])]


_profiles = lru_cache(maxsize=64)(Profiles)


def tip_of(finger: Fingertip, lengths: Array) -> Tip:
    """Return the tips of ridges about the lengths (m) of their contact without voltage.

    Args:
        finger: whose ridges they are.
        lengths: shape (loads,).

    Raises:
        SceneError: a ridge has several crests, or one beside its middle.
    """
    profiles = _profiles(finger)
    lower = float(profiles.skin(0.0)) / finger.ridge_amplitude
    if lower > _FLAT:
        raise SceneError(
            f"geometry.ridge_profile gives a ridge crests beside its middle, which is {100 * lower:.3g} % of the ridge "
            f"lower, and it may be {100 * _FLAT:g} %; the model 'cylinders' takes ridges for single tips, so use the "
            "model 'full'"
        )
    if len(finger.ridge_profile) == 1:
        return Round(tip_radius(finger))
    depth, power = kernel(profiles.harmonics, finger.ridge_wavelength, lengths / 2)
    return Power(power, depth, lengths / 2)


def tip_radius(finger: Fingertip) -> float:
    """Return the radius of curvature of a sinusoidal ridge's tip (m)."""
    step, profiles = 1e-3 * finger.ridge_wavelength, _profiles(finger)
    low, high = (float(profiles.skin(s)) for s in (0.0, step))
    return step**2 / (2 * (high - low))
