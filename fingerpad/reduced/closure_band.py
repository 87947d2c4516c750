"""The bands that a scene's assumptions put on friction, by charged cylinders: over closures, and over all of them.

**Closures.** A result has one model of roughness. The other ones of the package, on the same rms height, wavelength and
modulus, give other attractions, and which one is a finger's is open (docs/microscale.md). Their µ_app at full slip is
that of the result, times the ratio of the charged cylinders' with the two closures. The contact is that of the result
without voltage where it has one, else the default finger's.

**All assumptions.** The ± of a result is what mesh and penalty leave unsolved. Its assumptions move µ_app by more
(docs/assumptions.md). Each part changes one of them, by the same ratio:

- closure: to the other models of roughness;
- tips: ridge tips half as curved, and one and a half times. The length of a contact follows the root of the radius;
- roughness: h_rms 20 % smaller and larger, of the result's closure;
- coating: the effective thickness h_0 of coating and skin 20 % smaller and larger;
- slices: the sum of slices beside a finger in three dimensions, by its known error; of a whole finger alone.

The band is that of the result's headline: of the whole finger wherever slices are summed over it. Ratios of the middle
section are taken for it.

The changes are conventions, those of docs/assumptions.md. The parts are taken as independent: the band is the root of
the sum of their squares, in the logarithm of µ_app and to either side. A closure without an equilibrium is not in it.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.reduced.cylinders import over_forces
from fingerpad.results.closures import KNOWN, RECORD
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.slices.errors import known_at
from variational.roughness.bam import BearingArea
from variational.roughness.boundary_elements import BoundaryElements
from variational.roughness.closure import Closure
from variational.roughness.persson import Persson
from variational.roughness.tabulated import TabulatedClosure
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.results.result import Result

CHANGE, TIPS = (0.8, 1.2), (2.0, 1 / 1.5)
"""Factors of a value, and of the radius of a tip."""
Part = tuple[str, list[float]]
"""Name of an assumption, and µ_app over that of the result with it changed."""
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


def band(result: "Result") -> dict[str, Any]:
    """Return µ_app at full slip by each closure, ready for JSON; empty without voltage, friction or full slip.

    A closure without an equilibrium at this load is None: its ridges adhere, or the cylinders have no such contact.
    """
    scene, slip = result.scene, result.full_slip
    if slip is None or not slip.voltage or not slip.mu_app > 0 or scene.history is not None:
        return {}
    try:
        laws, own = closures(scene.closure()), scene.closure()
        here = friction(scene, slip, own, result.uncharged)
    except SceneError:
        return {}
    if not laws or here is None:
        return {}
    found = {}
    for words, law in laws.items():
        there = friction(scene, slip, law, result.uncharged)
        found[words] = None if there is None else slip.mu_app * there / here
    return {"mu_app": found, "model": "cylinders"}


def friction(
    scene: Scene, slip: ContactState, law: Closure, press: ContactState | None, tips: float = 1.0
) -> float | None:
    """Return µ_app of the charged cylinders by a closure at the load of a state, None without an equilibrium.

    Args:
        scene: of the state.
        slip: full slip.
        law: closure.
        press: the same without voltage, whose contact it is; by default the default finger's.
        tips: radius of the ridges' tips over that of the scene.
    """
    given = {"roughness": law, "f_ext": slip.f_ext, "voltage": slip.voltage, "force": None}
    known = [replace(press, f_ext=slip.f_ext)] if press is not None and press.contact_length > 0 else []
    try:
        (found,) = over_forces(scene.model_copy(update=given), [slip.f_ext], "full_slip", known, tips)
    except SceneError:
        return None
    return found.mu_app


# -- all assumptions ---------------------------------------------------------------------------------------
def with_band(result: "Result") -> "Result":
    """Return a result with its bands in its record, where it has some: over closures, and over all assumptions."""
    found = band(result)
    all_parts = known(result, found.get("mu_app", {}))
    more = ({RECORD: found} if found else {}) | ({KNOWN: all_parts} if all_parts else {})
    return replace(result, record=result.record | more) if more else result


def known(result: "Result", closures: dict[str, float | None]) -> dict[str, Any]:
    """Return the band of µ_app at full slip and its parts, the largest first, ready for JSON; empty without a band.

    Args:
        result: with full slip under a voltage.
        closures: µ_app of its section by each model of roughness; empty where there is none.
    """
    slip = result.full_slip
    if slip is None or not slip.voltage or not slip.mu_app > 0 or result.scene.history is not None:
        return {}
    finger = result.finger if result.finger is not None and "full_slip" in result.finger.states else None
    mu = slip.mu_app if finger is None else finger.states["full_slip"].mu_app
    try:
        parts = [*_parts(result, closures)]
    except SceneError:
        return {}
    ends = [(name, min(1.0, *ratios), max(1.0, *ratios)) for name, ratios in parts if ratios]
    if not ends:
        return {}
    ends.sort(key=lambda each: -np.log(each[2] / each[1]))
    below, above = (float(np.sqrt(sum(np.log(each[k]) ** 2 for each in ends))) for k in (1, 2))
    return {
        "mu_app": mu, "low": mu * float(np.exp(-below)), "high": mu * float(np.exp(above)), "whole": finger is not None,
        "parts": [{"name": name, "low": mu * low, "high": mu * high} for name, low, high in ends],
        "left_out": [words for words, value in closures.items() if value is None],
        "not_known": ["slices"] if finger is not None and "f_t" not in known_at(finger.f_ext) else [],
    }  # fmt: skip


def _parts(result: "Result", closures: dict[str, float | None]) -> Iterator[Part]:
    scene, slip, press = result.scene, result.full_slip, result.uncharged
    assert slip is not None
    own = scene.closure()
    found = [value / slip.mu_app for value in closures.values() if value is not None]
    yield "closure", found
    here = friction(scene, slip, own, press)
    if here is None:
        return

    def ratios(changed: Iterator[tuple[Scene, Closure, float]]) -> list[float]:
        values = (friction(each, slip, law, press, tips) for each, law, tips in changed)
        return [value / here for value in values if value is not None]

    yield "tips", ratios((scene, own, tips) for tips in TIPS)
    if isinstance(own, BearingArea | TabulatedClosure):
        yield "roughness", ratios((scene, replace(own, h_rms=factor * own.h_rms), 1.0) for factor in CHANGE)
        yield "coating", ratios((*_coated(scene, own, factor), 1.0) for factor in CHANGE)
    if result.finger is not None and "f_t" in (ends := known_at(result.finger.f_ext)):
        yield "slices", [1 / (1 + end) for end in ends["f_t"]]


def _coated(scene: Scene, own: BearingArea | TabulatedClosure, factor: float) -> tuple[Scene, Closure]:
    """Return a scene and its closure with a multiple of the effective insulator thickness."""
    electric = scene.electric
    changed = electric.model_copy(update={"d_i": factor * electric.d_i, "eps_sc": electric.eps_sc / factor})
    other = scene.model_copy(update={"electric": changed})
    return other, replace(own, h_0=other.h_0)
