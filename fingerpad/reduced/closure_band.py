"""Friction by the other models of roughness, and with another law of friction, by charged cylinders.

A result has one model of roughness. The other ones of the package, on the same rms height, wavelength and modulus, give
other attractions (docs/microscale.md); on the roughness of a fitted finger each has the rms height of the finger's air
gap instead. Their µ_app at full slip is that of the result, times the ratio of the charged cylinders' with the two
closures. The contact is that of the result without voltage where it has one, else the default finger's.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fingerpad.model.cautions import sticking
from fingerpad.reduced.cylinders import over_forces
from fingerpad.results.quantities import BAND
from fingerpad.scene import Scene
from fingerpad.scene.fingers import AIR_GAP, FINGERS, PAPER, on_roughness
from fingerpad.scene.messages import SceneError
from variational.contact.friction import Derjaguin, Friction
from variational.roughness.bam import BearingArea
from variational.roughness.boundary_elements import BoundaryElements
from variational.roughness.closure import BALANCED, Closure
from variational.roughness.persson import Persson
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.results.result import Result

_SHEAR_STRESS = Derjaguin(mu_f=0.0, tau_0=1.0)
"""A constant shear stress on ridges in contact (Pa)."""
OWN = "the result's own closure"
_OUTSIDE = "no field in contact"


def closures(own: Closure, finger: str = PAPER) -> dict[str, Closure]:
    """Return the closures of the package on the roughness of one of them, by words; empty for a law of one's own.

    They have its rms height, or, on the roughness of a fitted finger, each the one of the finger's air gap. Boundary
    elements are left out where the package has no table of the ratio of waves or the Hurst exponent.
    """
    if not own.shared:
        return {}
    surface: dict[str, Any] = {name: getattr(own, name) for name in own.shared}
    surface = {"shortest_wave": surface["wavelength"] / 16, "hurst": 0.75} | surface

    fitted = FINGERS[finger].values_with(on_roughness(type(own).__name__, getattr(own, "field_in_contact", True)))
    of_one_gap = fitted.get("roughness.h_rms") == surface["h_rms"]

    def like(law: type[Closure], **more: Any) -> Closure:
        own_height = {"h_rms": AIR_GAP[on_roughness(law.__name__, **more)]} if of_one_gap else {}
        return law(**{name: value for name, value in (surface | own_height).items() if name in law.shared}, **more)

    found = {"bearing area": like(BearingArea)}
    for law, words in ((BoundaryElements, "boundary elements"), (Persson, "Persson's theory")):
        for touching, more in ((True, ""), (False, f", {_OUTSIDE}")):
            found[words + more] = like(law, field_in_contact=touching)
    return {words: law for words, law in found.items() if _is_there(law)}


def _is_there(law: Closure) -> bool:
    try:
        law(1e4)
    except ValueError:
        return False
    return True


class Slip(NamedTuple):
    """Full slip of the charged cylinders."""

    mu_app: float
    """µ_app; infinite where it has no number."""
    why: str = ""
    """Reason why it has none, else empty."""
    balanced: float = 0.0
    """Part of the pressure in contact that attraction balances, where µ_app is an upper bound by it; else 0."""


def friction(scene: Scene, slip: ContactState, law: Closure, press: ContactState | None) -> Slip:
    """Return full slip of the charged cylinders by a closure at the load of a state.

    This is where a closure has a number or none. It has none without an equilibrium, and beyond its table of gaps:
    there nearly all of a ridge touches, and the table's last air gap says nothing of it. The voltage of a drive is what
    its circuit leaves across the air gap of that closure.

    Args:
        scene: of the state.
        slip: full slip.
        law: closure.
        press: the same without voltage, whose contact it is; by default the default finger's.
    """
    try:
        return _solved(scene, slip, law, press)
    except SceneError:
        return Slip(np.inf, _adhere(scene, law, slip.voltage) or "there is no equilibrium")


def _solved(scene: Scene, slip: ContactState, law: Closure, press: ContactState | None) -> Slip:
    """Return :func:`friction`; raise SceneError without an equilibrium, and for a finger that is none of cylinders."""
    found = _cylinders(scene, slip, law, press, slip.voltage)
    p_c = found.f_contact / found.contact_length
    voltage = slip.voltage if scene.drive is None else float(scene.drive.effective(law(p_c).d_eq))
    if p_c > law.pressures[1] and not law.extrapolates:
        return Slip(np.inf, _adhere(scene, law, voltage) or "the ridges' pressure is beyond the table")
    balanced = float(law.balanced(p_c, voltage))
    return Slip(found.mu_app, balanced=balanced if balanced >= BALANCED else 0.0)


def _cylinders(
    scene: Scene, slip: ContactState, law: Closure, press: ContactState | None, voltage: float
) -> ContactState:
    """Return full slip of the charged cylinders at a voltage, or under a drive; raise SceneError as :func:`_solved`."""
    load = {"f_ext": slip.f_ext, "force": None} | ({"voltage": voltage} if scene.drive is None or not voltage else {})
    known = [replace(press, f_ext=slip.f_ext)] if press is not None and press.contact_length > 0 else []
    return over_forces(scene.model_copy(update={"roughness": law, **load}), [slip.f_ext], "full_slip", known)[0]


def _adhere(scene: Scene, law: Closure, voltage: float) -> str:
    """Return that ridges adhere, empty where they do not; the voltage that a circuit leaves is another by closure."""
    under = f"at {voltage:.4g} V" if scene.drive is None else "under the drive"
    return f"ridges adhere {under}" if sticking(law, voltage) else ""


# -- the results --------------------------------------------------------------------------------------------
def with_band(result: "Result") -> "Result":
    """Return a result with its µ_app by closure in its record, or a note why it has none.

    It has none, and no note, where no voltage changes friction. In the record, ready for JSON, it has ``mu_app`` of
    the middle section by closure, None where one has no number: ``no_number`` then has the reason, and ``upper_bounds``
    the part of the pressure that a closure balances whose attraction is an upper bound. ``mu_app`` is empty where the
    result's own closure has no number. A law of one's own has no others.
    """
    slip, scene = result.full_slip, result.scene
    if slip is None or not slip.voltage or not slip.mu_app > 0 or scene.friction_law() is None:
        return result
    try:
        here = _solved(scene, slip, scene.closure(), result.uncharged)
        laws = {} if here.why else closures(scene.closure(), scene.finger)
        found = {words: friction(scene, slip, law, result.uncharged) for words, law in laws.items()}
    except SceneError as error:
        why, _, _ = str(error).partition(";")
        return replace(result, notes=(*result.notes, f"No µ_app by other models of roughness is computed: {why}."))
    reasons = {words: each.why for words, each in found.items() if each.why} or ({OWN: here.why} if here.why else {})
    band = {
        "mu_app": {words: _finite(slip.mu_app * each.mu_app / here.mu_app) for words, each in found.items()},
        "no_number": reasons,
        "upper_bounds": {words: each.balanced for words, each in found.items() if each.balanced},
        "model": "cylinders",
    }
    return replace(result, record=result.record | {BAND: band}) if found or here.why else result


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def laws_beside(scene: Scene, slip: ContactState, press: ContactState | None = None) -> tuple[float, Derjaguin]:
    """Return :func:`laws_like` of a scene's law, at the pressure of its full slip without voltage.

    ``press`` is as in :func:`friction`.
    """
    still = _cylinders(scene, slip, scene.closure(), press, 0.0)
    return laws_like(scene.friction_law(), still.f_contact / still.contact_length)


def laws_like(own: Friction | None, p_c: float) -> tuple[float, Derjaguin]:
    """Return a friction coefficient, and a shear stress, with the friction of a law at a mean contact pressure (Pa).

    On the ridge that they have in common the pressure is the same too: what friction shears is its own.
    """
    stress = 0.0 if own is None else float(own.limit(p_c))
    return stress / p_c, replace(_SHEAR_STRESS, tau_0=stress / float(_SHEAR_STRESS.limit(p_c)))
