"""The band that the open choice of a closure puts on friction, from the charged cylinders.

A result has one model of roughness. The other ones of the package, on the same rms height, wavelength and modulus,
give other attractions, and which one is a finger's is open (docs/microscale.md). Their µ_app at full slip is that of
the result, times the ratio of the charged cylinders' with the two closures. The contact is that of the result without
voltage where it has one, else the default finger's.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fingerpad.reduced.cylinders import over_forces
from fingerpad.results.closures import RECORD
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from variational.roughness.bam import BearingArea
from variational.roughness.boundary_elements import BoundaryElements
from variational.roughness.closure import Closure
from variational.roughness.persson import Persson
from variational.roughness.tabulated import TabulatedClosure
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.results.result import Result

OUTSIDE = "no field in contact"
_SHARED = ("h_0", "h_rms", "wavelength", "young", "p_floor")


def closures(own: Closure) -> dict[str, Closure]:
    """Return the closures of the package on the roughness of one of them, by words; empty for a law of one's own.

    Boundary elements are left out where the package has no table of the ratio of waves or the Hurst exponent.
    """
    if not isinstance(own, BearingArea | TabulatedClosure):
        return {}
    shared = {name: getattr(own, name) for name in _SHARED}
    waves: dict[str, Any] = {"shortest_wave": own.wavelength / 16, "hurst": 0.75}
    waves |= {name: getattr(own, name) for name in waves if hasattr(own, name)}
    found: dict[str, Closure] = {"bearing area": BearingArea(**shared)}
    for law, words in ((BoundaryElements, "boundary elements"), (Persson, "Persson's theory")):
        measured: dict[str, Any] = {}
        if law is BoundaryElements and isinstance(own, BoundaryElements):
            measured["surface"] = own.surface
        for touching, more in ((True, ""), (False, f", {OUTSIDE}")):
            found[words + more] = law(**shared, **waves, **measured, field_in_contact=touching)
    return {words: law for words, law in found.items() if _is_there(law)}


def _is_there(law: Closure) -> bool:
    try:
        law(1e4)
    except ValueError:
        return False
    return True


def with_band(result: "Result") -> "Result":
    """Return a result with the band in its record, where it has one."""
    found = band(result)
    return replace(result, record=result.record | {RECORD: found}) if found else result


def band(result: "Result") -> dict[str, Any]:
    """Return µ_app at full slip by each closure, ready for JSON; empty without voltage, friction or full slip.

    A closure without an equilibrium at this load is None: its ridges adhere, or the cylinders have no such contact.
    """
    scene, slip = result.scene, result.full_slip
    if slip is None or not slip.voltage or not slip.mu_app > 0 or scene.history is not None:
        return {}
    try:
        laws, own = closures(scene.closure()), scene.closure()
        here = _friction(scene, slip, own, result.uncharged)
    except SceneError:
        return {}
    if not laws or here is None:
        return {}
    found = {}
    for words, law in laws.items():
        there = _friction(scene, slip, law, result.uncharged)
        found[words] = None if there is None else slip.mu_app * there / here
    return {"mu_app": found, "model": "cylinders"}


def _friction(scene: Scene, slip: ContactState, law: Closure, press: ContactState | None) -> float | None:
    """Return µ_app of the charged cylinders by a closure at the load of a state, None without an equilibrium."""
    given = {"roughness": law, "f_ext": slip.f_ext, "voltage": slip.voltage, "force": None}
    known = [replace(press, f_ext=slip.f_ext)] if press is not None and press.contact_length > 0 else []
    try:
        (found,) = over_forces(scene.model_copy(update=given), [slip.f_ext], "full_slip", known)
    except SceneError:
        return None
    return found.mu_app
