r"""The model "cylinders": every ridge in contact the same charged cylinder, an answer in a fraction of a second.

n ridges bear :math:`f = f_{ext} / n` each; :mod:`variational.attraction.cylinder` gives contact force, attraction and
air gap of a ridge. Friction at full slip is the limit of the friction law at the mean pressure, over the length in
contact; Coulomb's is :math:`f_T = \mu_0 (f_{ext} + f_{el})`. The number of ridges in
contact and the length of their contact depend on the finger. They come from a :class:`Footprint` of normal contact and
full slip:

- :func:`fitted`: of the default finger *without* voltage, or of one similar to it
  (:mod:`fingerpad.reduced.similarity`), interpolated between full runs. The modulus E* of the
  cylinders is then the one with which Hertz's law gives that length, which includes finite strain, layers and
  shear. The length under voltage follows from Maugis's equations.
- :func:`given`: the length *at* the scene's voltage, from a user or a run. E* is the stratum corneum's,
  :math:`2 G_0 / (1 - \nu)`, and acts on the attraction beyond the contact's ends alone.

The model leaves out that ridges in the middle bear more than those at the edge, and that ridges come and go with the
voltage. ``docs/models.md`` has its errors.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fingerpad.model import breakdown
from fingerpad.model.adhesion import sticking
from fingerpad.model.cautions import on_states
from fingerpad.reduced import cylinder_errors
from fingerpad.reduced.footprint import Footprint
from fingerpad.reduced.footprint import from_run as from_run
from fingerpad.reduced.footprint import given as given
from fingerpad.reduced.model import STATES, Model, reduced_state, refuse_others
from fingerpad.reduced.similarity import Similar, similar
from fingerpad.results.answer import Cost
from fingerpad.results.result import Result
from fingerpad.results.states import WORDS
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.remarks import leakage, remarks, skin_modulus, used
from geometry.parameters import Fingertip
from geometry.profiles import Profiles
from variational.attraction.cylinder import Cylinder, NoEquilibriumError, RidgeState, hertz_modulus
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.runs.context import RunContext

Array = NDArray[np.float64]
# The default finger's full runs without voltage, contact size 10 um: f_ext (N/m), then contact length (m), ridges in
# contact and indentation in each state. benchmarks/models.py keeps the same numbers in docs/models.json.
FORCES = (5.0, 10.0, 25.0, 50.0, 75.0, 100.0, 120.0, 150.0)
LENGTHS = {
    "charged": (0.2314e-3, 0.3575e-3, 0.6513e-3, 1.0123e-3, 1.3027e-3, 1.4999e-3, 1.7015e-3, 1.8907e-3),
    "full_slip": (0.2374e-3, 0.3497e-3, 0.6539e-3, 0.9847e-3, 1.2376e-3, 1.4616e-3, 1.6059e-3, 1.7898e-3),
}
RIDGES = {"charged": (7, 9, 11, 15, 17, 17, 19, 19), "full_slip": (7, 9, 12, 14, 16, 17, 18, 18)}
INDENTATIONS = {  # m, how far the bone is lowered
    "charged": (0.1457e-3, 0.2244e-3, 0.3895e-3, 0.5848e-3, 0.7383e-3, 0.8670e-3, 0.9568e-3, 1.0751e-3),
    "full_slip": (0.1452e-3, 0.2239e-3, 0.3893e-3, 0.5842e-3, 0.7345e-3, 0.8569e-3, 0.9417e-3, 1.0510e-3),
}
_ELSE = "use the model 'full', or the command compare with --contact-length and --ridges, or with the --run of a folder"


def fitted(scene: Scene) -> Footprint:
    """Return the default finger's contact without voltage, by interpolation of logarithms between full runs.

    Raises:
        SceneError: the scene's finger is another one.
    """
    default, scaled = _default(), _scaled(scene)
    source = "uncharged contact length interpolated between full runs of the default finger"
    f_ext = scene.f_ext / scaled.force
    if not FORCES[0] <= f_ext <= FORCES[-1]:
        source = f"uncharged contact length extrapolated from full runs at {FORCES[0]:g} to {FORCES[-1]:g} N/m"
    source += f", {scaled.words}" if scaled.words else ""
    if scene.friction != default.friction:
        source += f"; that of full slip with a friction coefficient of {default.friction:g}"
    length = {state: scaled.length * float(_lengths(f_ext, state)) for state in STATES}
    return Footprint(length, {state: int(_ridges(f_ext, state)) for state in STATES}, False, source)


_default = cache(Scene)


def _scaled(scene: Scene) -> Similar:
    """Return how the finger is scaled; refuse one that is not similar to the default finger."""
    found = similar(scene)
    if isinstance(found, str):
        raise SceneError(
            f"{found} is not that of the default finger or of one similar to it, whose contact length is known; {_ELSE}"
        )
    return found


def _lengths(f_ext: ArrayLike, state: str) -> Array:
    """Return the default finger's contact length (m) without voltage under external forces (N/m)."""
    return _interpolate(f_ext, LENGTHS[state])


def _ridges(f_ext: ArrayLike, state: str) -> NDArray[np.int_]:
    """Return the default finger's ridges in contact without voltage under external forces (N/m)."""
    return np.maximum(np.rint(_interpolate(f_ext, RIDGES[state])).astype(int), 1)


def _interpolate(f_ext: ArrayLike, values: tuple[float, ...] | tuple[int, ...]) -> Array:
    """Return power laws through the two neighbours, at the ends through the last two; shape of the forces."""
    x, y, at = np.log(FORCES), np.log(values), np.log(f_ext)
    k = np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2)
    return np.exp(y[k] + (y[k + 1] - y[k]) * (at - x[k]) / (x[k + 1] - x[k]))


def indentation(f_ext: float, state: str, scaled: Similar | None = None) -> float:
    """Return how far a finger's bone is lowered (m), without voltage; the model itself has no bone.

    Args:
        f_ext: external force (N/m).
        state: ``charged`` or ``full_slip``. A voltage of 200 V moves the bone at full slip by up to 6 %.
        scaled: a finger similar to the default one, which it is by default.
    """
    scaled = scaled or Similar()
    return scaled.length * float(_interpolate(f_ext / scaled.force, INDENTATIONS[state]))


class Cylinders(Model):
    """Every ridge in contact the same charged cylinder, over a footprint; without one it is the default finger's."""

    name, words = "cylinders", "A closed form of charged cylinders"
    traces = "traces of charged cylinders, indentations without voltage"

    def __init__(self, footprint: Footprint | None = None) -> None:
        """Take the footprint, which is known at one force alone where it is given."""
        self._footprint = footprint
        self.sums = footprint is None

    def solve(self, scene: Scene, context: "RunContext") -> Result:
        """Return the answer of :func:`solve`."""
        return solve(scene, self._footprint)

    def over_forces(
        self, scene: Scene, f_ext: Sequence[float], state: str, solve: Callable[[Scene], Result]
    ) -> list[ContactState]:
        """Return the states computed together, with the indentations of the default finger without voltage."""
        states, scaled = over_forces(scene, f_ext, state), _scaled(scene)
        return [replace(each, bone_height=-indentation(each.f_ext, state, scaled)) for each in states]


def solve(scene: Scene, footprint: Footprint | None = None) -> Result:
    """Return the answer of the cylinders; without a footprint it is the default finger's.

    Raises:
        SceneError: a scene with a history, another finger than the footprint's, or ridges that do not stay.
    """
    start = time.process_time()
    refuse_others(scene, Cylinders.name)
    footprint = footprint or fitted(scene)
    found: dict[str, ContactState] = {}
    exact = "a closed form, without a mesh: no discretisation error but that of the contact length it is given"
    errors = {} if footprint.charged else cylinder_errors.errors(scene)
    notes = (
        footprint.source,
        exact,
        cylinder_errors.in_words(errors),
        "the bone's height is not in this model",
        *leakage(scene),
    )
    cautions, states = [*remarks(scene), *([] if footprint.charged else cylinder_errors.cautions(scene))], {}
    for state in STATES:
        n, length = np.array([footprint.ridges[state]]), np.array([footprint.length[state]])
        ((found[state], states[state]),) = _solved(scene, [scene.f_ext], length, n, state, footprint.charged)
        cautions += _others(state, states[state])
    cautions += on_states(found.values(), scene.closure())
    cautions += breakdown.of_gaps(scene, [(WORDS[state], ridge.d_eq, scene.volts) for state, ridge in states.items()])
    more: dict[str, Any] = {
        f"{state}_{name}": getattr(ridge, name) for state, ridge in states.items() for name in ("p_c", "d_eq")
    }
    more |= {"laws": used(scene), "model_error": errors}
    cost = Cost(processor_seconds=time.process_time() - start)
    return Result(
        scene, Cylinders.name, None, found["charged"], found["full_slip"],
        cost=cost, notes=notes, cautions=tuple(cautions), record=more,
    )  # fmt: skip


def over_forces(
    scene: Scene, f_ext: Sequence[float], state: str, press: Sequence[ContactState] = (), tips: float = 1.0
) -> list[ContactState]:
    """Return a state of a scene under each of several external forces, computed together.

    Args:
        scene: with the voltage of all.
        f_ext: external forces (N/m).
        state: ``charged`` or ``full_slip``.
        press: states without voltage under these forces, whose contact it is; by default the default finger's.
        tips: radius of the ridges' tips over that of the scene; Hertz's length grows with its root.

    Raises:
        SceneError: as :func:`solve`, but for what is wrong with the other state alone.
    """
    refuse_others(scene, Cylinders.name)
    if press:
        length = np.array([each.contact_length for each in press])
        ridges = np.array([each.ridges_in_contact for each in press])
    else:
        scaled = _scaled(scene)
        of_default = np.array(f_ext) / scaled.force
        length, ridges = scaled.length * _lengths(of_default, state), _ridges(of_default, state)
    return [found for found, _ in _solved(scene, f_ext, tips**0.5 * length, ridges, state, tips=tips)]


def _solved(
    scene: Scene,
    f_ext: Sequence[float],
    length: Array,
    ridges: NDArray[np.int_],
    state: str,
    charged: bool = False,
    tips: float = 1.0,
) -> list[tuple[ContactState, RidgeState]]:
    """Return a state of a scene under external forces (N/m), and that of its ridges.

    Args:
        scene: with the voltage of all.
        f_ext: external forces (N/m).
        length: contact length (m) under each.
        ridges: in contact under each.
        state: ``charged`` or ``full_slip``.
        charged: whether the lengths are those at the voltage.
        tips: radius of the ridges' tips over that of the scene.
    """
    radius, closure = tips * tip_radius(scene.geometry), scene.closure()
    forces, length = np.array(f_ext) / ridges, length / ridges
    voltage = scene.volts if scene.supply is None else scene.supply.effective
    try:
        if charged:
            cylinder = Cylinder(radius, skin_modulus(scene), scene.h_0, closure)
            found = [cylinder.over_length(*each, voltage) for each in zip(length, forces, strict=True)]
        else:
            moduli = hertz_modulus(radius, forces, length)
            found = Cylinder(radius, moduli, scene.h_0, closure).under_loads(forces, voltage)
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


def _others(state: str, ridge: RidgeState) -> list[str]:
    """Return a remark on other equilibria."""
    if not ridge.others:
        return []
    pressures = ", ".join(f"{p:.4g}" for p in ridge.others)
    return [f"{WORDS[state]}: further equilibria at a mean pressure of {pressures} Pa, of ridges not on the screen yet"]


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
