r"""The model "cylinders": every ridge in contact the same charged cylinder, an answer in a fraction of a second.

n ridges bear :math:`f = f_{ext} / n` each; :mod:`variational.attraction.cylinder` gives contact force, attraction and
air gap of a ridge. Friction at full slip is the limit of the friction law at the mean pressure, over the length in
contact; Coulomb's is :math:`f_T = \mu_0 (f_{ext} + f_{el})`. The number of ridges in contact and the length of their
contact are those of the default finger *without* voltage, or of one similar to it
(:mod:`fingerpad.reduced.default_finger`), interpolated between full runs. The modulus E* of the cylinders is then the
one with which Hertz's law gives that length, which includes finite strain, layers and shear. The length under voltage
follows from Maugis's equations. More shear stress stiffens the ridges, see below.

**Shear.** The table's finger has a friction coefficient of 0.25. Stronger friction leans the finger and its ridges
further; their trailing sides lift, and the contact is shorter, about in proportion to the shear stress (Forsbach et al.
2023, Fig. 8). It shortens as if the ridges were stiffer, by the shear stress beyond that of the table at the same
contact pressure:

.. math:: E^*(p_c) = E^*_{0.25} + \kappa \max(t_{max}(p_c) - 0.25\,p_c,\, 0), \qquad \kappa = 10 .

The one number :math:`\kappa` (:data:`SHEAR`) is fitted to the attraction of states of the full model, of seeded scenes
over coatings, forces, voltages and friction coefficients. Other states test it, and so do all contact lengths
(``docs/closed_form.md``). The number of ridges stays that of the table.

The model leaves out that ridges in the middle bear more than those at the edge, and that ridges come and go with the
voltage. ``docs/closed_form.md`` has its errors.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.model.cautions import examine, on_scene, sticking
from fingerpad.reduced import cylinder_errors, default_finger
from fingerpad.reduced.default_finger import Similar, similar
from fingerpad.reduced.model import STATES, Model, check_supported, reduced_state
from fingerpad.results.data import MODEL_ERROR, Cost
from fingerpad.results.quantities import MODEL
from fingerpad.results.result import Result
from fingerpad.results.states import WORDS
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.fingers import PAPER
from fingerpad.scene.messages import show
from fingerpad.scene.remarks import coefficient, used
from fingerpad.slices import errors
from geometry.parameters import Fingertip
from geometry.profiles import Profiles
from variational.attraction.cylinder import Cylinder, NoEquilibriumError, RidgeState, hertz_modulus
from variational.caution import Caution
from variational.state import ContactState, Errors

if TYPE_CHECKING:
    from fingerpad.runs.context import RunContext
    from fingerpad.slices.finger import WholeFinger

Array = NDArray[np.float64]
SHEAR = 10.0
"""What the modulus of a ridge gains, over the shear stress beyond that of the default friction coefficient."""
_default = cache(Scene)


def _scaled(scene: Scene) -> Similar:
    """Return how the finger is scaled; refuse one that is not similar to the default finger."""
    found = similar(scene)
    if isinstance(found, str):
        whose = "" if scene.finger == PAPER else f" of finger {show(scene.finger)}"
        raise SceneError(
            f"{found}{whose} is not that of the default finger or of one similar to it, whose contact length is known; "
            "take the model 'full', fingerpad run, a minute or two"
        )
    return found


def _source(scene: Scene, scaled: Similar) -> str:
    """Return in words where the contact length is from."""
    default, f_ext = _default(), scene.f_ext / scaled.force
    source = "uncharged contact length interpolated between full runs of the default finger"
    low, high = default_finger.FORCES[0], default_finger.FORCES[-1]
    if not low <= f_ext <= high:
        source = f"uncharged contact length extrapolated from full runs at {low:g} to {high:g} N/m"
    source += f", {scaled.words}" if scaled.words else ""
    if scene.friction != default.friction:
        source += f"; that of full slip with a friction coefficient of {default.friction:g}, and shorter by more shear"
    return source


def indentation(f_ext: float, state: str, scaled: Similar | None = None) -> float:
    """Return how far a finger's bone is lowered (m), without voltage; the model itself has no bone.

    Args:
        f_ext: external force (N/m).
        state: ``charged`` or ``full_slip``. A voltage of 200 V moves the bone at full slip by up to 6 %.
        scaled: a finger similar to the default one, which it is by default.
    """
    scaled = scaled or Similar()
    return scaled.length * default_finger.indentation(f_ext / scaled.force, state)


class Cylinders(Model):
    """Every ridge in contact the same charged cylinder."""

    name, words = "cylinders", "A closed form of charged cylinders"
    traces = "traces of charged cylinders, indentations without voltage"
    sums = True

    def solve(self, scene: Scene, context: "RunContext") -> Result:
        """Return the answer of :func:`solve`."""
        return solve(scene)

    def over_forces(
        self, scene: Scene, f_ext: Sequence[float], state: str, solve: Callable[[Scene], Result]
    ) -> list[ContactState]:
        """Return the states computed together, with the indentations of the default finger without voltage."""
        states, scaled = over_forces(scene, f_ext, state), _scaled(scene)
        return [replace(each, bone_height=-indentation(each.f_ext, state, scaled)) for each in states]

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
        SceneError: a scene with a history, a finger that is not similar to the default one, or ridges that do not stay.
    """
    start = time.process_time()
    check_supported(scene, Cylinders.name)
    source, ridges = _source(scene, _scaled(scene)), dict[str, RidgeState]()
    exact = "a closed form, without a mesh: no discretisation error but that of the contact length it is given"
    cautions, found = list[Caution](), dict[str, ContactState]()
    for state in STATES:
        ((found[state], ridges[state]),) = _over_forces(scene, [scene.f_ext], state)
        cautions += _others(state, ridges[state])
    known = cylinder_errors.errors(scene.model_copy(update={"force": None}), found)
    cautions += cylinder_errors.cautions(scene, _pull(found["full_slip"]))
    notes = (
        source,
        exact,
        cylinder_errors.in_words(known),
        "the bone's height is not in this model",
        *map(str, examine("note", scene)),
    )
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
    press: Sequence[ContactState] = (),
    tips: float = 1.0,
    shear: float = SHEAR,
) -> list[ContactState]:
    """Return a state of a scene under each of several external forces, computed together.

    Args:
        scene: with the voltage of all.
        f_ext: external forces (N/m).
        state: ``charged`` or ``full_slip``.
        press: states without voltage under these forces, whose contact it is; by default the default finger's.
        tips: radius of the ridges' tips over that of the scene; Hertz's length grows with its root.
        shear: in place of :data:`SHEAR`.

    Raises:
        SceneError: as :func:`solve`, but for what is wrong with the other state alone.
    """
    check_supported(scene, Cylinders.name)
    return [found for found, _ in _over_forces(scene, f_ext, state, press, tips, shear)]


def _over_forces(
    scene: Scene,
    f_ext: Sequence[float],
    state: str,
    press: Sequence[ContactState] = (),
    tips: float = 1.0,
    shear: float = SHEAR,
) -> list[tuple[ContactState, RidgeState]]:
    """Return the states of :func:`over_forces`, and those of a ridge."""
    if press:
        length = np.array([each.contact_length for each in press])
        ridges = np.array([each.ridges_in_contact for each in press])
    else:
        scaled = _scaled(scene)
        of_default = np.array(f_ext) / scaled.force
        length, ridges = (
            scaled.length * default_finger.lengths(of_default, state),
            default_finger.ridges(of_default, state),
        )
    radius, closure = tips * tip_radius(scene.geometry), scene.closure()
    forces, lengths = np.array(f_ext) / ridges, tips**0.5 * length / ridges
    moduli, stiffening = hertz_modulus(radius, forces, lengths), _stiffening(scene, state, shear)
    voltage = scene.volts if scene.drive is None else scene.drive.effective
    try:
        found = Cylinder(radius, moduli, scene.h_0, closure, stiffening).under_loads(forces, voltage)
    except NoEquilibriumError as error:
        why = "; ".join(filter(None, (str(error), sticking(closure, scene.volts))))
        raise SceneError(f"{WORDS[state]} of the model 'cylinders': {why}") from None
    states = []
    for each, count, ridge in zip(f_ext, ridges, found, strict=True):
        n = int(count)
        contact = {
            "f_contact": n * ridge.f_contact,
            "f_electrostatic": n * ridge.f_attraction,
            "contact_length": n * ridge.length,
            "ridges_in_contact": n,
        }
        under = scene.model_copy(update={"f_ext": float(each)})
        states.append((reduced_state(under, contact, state == "full_slip"), ridge))
    return states


def _stiffening(scene: Scene, state: str, shear: float) -> Callable[[Array], Array] | None:
    """Return what the modulus of a ridge gains (Pa) at contact pressures (Pa); None where nothing shears it further."""
    law, known = scene.friction_law(), coefficient(_default())
    if state != "full_slip" or law is None or known is None or coefficient(scene) == known:
        return None
    return lambda p_c: shear * np.maximum(np.asarray(law.limit(p_c), dtype=float) - known * p_c, 0.0)


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


def tip_radius(finger: Fingertip) -> float:
    """Return the radius of curvature of a ridge's tip (m).

    Raises:
        SceneError: a ridge has several crests, or a flat one.
    """
    step, profiles = 1e-3 * finger.ridge_wavelength, Profiles(finger)
    crest = profiles.crests[-1]
    low, high = (float(profiles.skin(s)) for s in (crest, crest + step))
    places = {round(s / step) % 1000 for s in profiles.crests}  # one in either groove is the same one
    if len(places) > 1 or high <= low:
        what = f"{len(places)} crests" if len(places) > 1 else "a flat tip"
        raise SceneError(
            f"geometry.ridge_profile gives a ridge {what}; the model 'cylinders' takes ridges for cylinders, so use "
            "the model 'full'"
        )
    return step**2 / (2 * (high - low))
