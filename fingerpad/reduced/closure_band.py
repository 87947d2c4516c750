"""The bands that a scene's assumptions put on friction, by charged cylinders: over closures, and over all of them.

**Closures.** A result has one model of roughness. The other ones of the package, on the same rms height, wavelength and
modulus, give other attractions (docs/microscale.md); on the roughness of a fitted finger each has the rms height of the
finger's air gap instead. Their µ_app at full slip is that of the result, times the ratio of the charged cylinders' with
the two closures. The contact is that of the result without voltage where it has one, else the default finger's.

**All assumptions.** The ± of a result is what mesh and penalty leave unsolved; its assumptions move µ_app by more. Each
part changes one of them, by the same ratio. The changes are conventions (docs/assumptions.md):

- friction law: to Coulomb's law, and to a constant shear stress on the ridges in contact (:class:`.Derjaguin` without a
  friction coefficient), with the friction of the result's own law without voltage, at the same force;
- rough contact: to the other models of roughness;
- tips: ridge tips half as curved, and one and a half times. The length of a contact follows the root of the radius;
- roughness: h_rms 20 % smaller and larger, of the result's closure;
- coating: the effective thickness h_0 of coating and skin 20 % smaller and larger;
- slices: the sum of slices beside a finger in three dimensions, by its known error; of a whole finger alone.

Full runs of these changes are known at one load (``full_changes.json`` by ``python3 -m benchmarks.assumptions``); the
ratio of the cylinders is taken to the power that gives the full model's there (:func:`powers`). Ratios of the middle
section stand for the whole finger. Parts are independent: the band is the root of the sum of their squares, in the
logarithm of µ_app and to either side. A closure whose ridges adhere, beyond its table of gaps, has no number: the upper
end of its part and of the band is then open.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fingerpad.model.cautions import sticking
from fingerpad.reduced.cylinders import over_forces
from fingerpad.results.quantities import BAND, KNOWN
from fingerpad.scene import Scene
from fingerpad.scene.fingers import AIR_GAP, FINGERS, PAPER, on_roughness
from fingerpad.scene.messages import SceneError
from fingerpad.scene.remarks import coefficient
from fingerpad.slices.errors import known_at
from variational.contact.friction import Derjaguin, Friction
from variational.roughness.bam import BearingArea
from variational.roughness.boundary_elements import BoundaryElements
from variational.roughness.closure import BALANCED, Closure
from variational.roughness.persson import Persson
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.results.result import Result

_CHANGE, TIPS = (0.8, 1.2), (2.0, 1 / 1.5)
"""Factors of a value, and of the radius of a tip."""
LAW = "friction law"
_SHEAR_STRESS = Derjaguin(mu_f=0.0, tau_0=1.0)
"""A constant shear stress on ridges in contact (Pa)."""
_OUTSIDE, _OWN = "no field in contact", "the result's own closure"


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


def friction(scene: Scene, slip: ContactState, law: Closure, press: ContactState | None, tips: float = 1.0) -> Slip:
    """Return full slip of the charged cylinders by a closure at the load of a state.

    This is where a closure has a number or none. It has none without an equilibrium, and beyond its table of gaps:
    there nearly all of a ridge touches, and the table's last air gap says nothing of it. The voltage of a drive is what
    its circuit leaves across the air gap of that closure.

    Args:
        scene: of the state.
        slip: full slip.
        law: closure.
        press: the same without voltage, whose contact it is; by default the default finger's.
        tips: radius of the ridges' tips over that of the scene.
    """
    try:
        return _solved(scene, slip, law, press, tips)
    except SceneError:
        return Slip(np.inf, _adhere(scene, law, slip.voltage) or "there is no equilibrium")


def _solved(scene: Scene, slip: ContactState, law: Closure, press: ContactState | None, tips: float = 1.0) -> Slip:
    """Return :func:`friction`; raise SceneError without an equilibrium, and for a finger that is none of cylinders."""
    found = _cylinders(scene, slip, law, press, slip.voltage, tips)
    p_c = found.f_contact / found.contact_length
    voltage = slip.voltage if scene.drive is None else float(scene.drive.effective(law(p_c).d_eq))
    if p_c > law.pressures[1] and not law.extrapolates:
        return Slip(np.inf, _adhere(scene, law, voltage) or "the ridges' pressure is beyond the table")
    balanced = float(law.balanced(p_c, voltage))
    return Slip(found.mu_app, balanced=balanced if balanced >= BALANCED else 0.0)


def _cylinders(
    scene: Scene, slip: ContactState, law: Closure, press: ContactState | None, voltage: float, tips: float = 1.0
) -> ContactState:
    """Return full slip of the charged cylinders at a voltage, or under a drive; raise SceneError as :func:`_solved`."""
    load = {"f_ext": slip.f_ext, "force": None} | ({"voltage": voltage} if scene.drive is None or not voltage else {})
    known = [replace(press, f_ext=slip.f_ext)] if press is not None and press.contact_length > 0 else []
    return over_forces(scene.model_copy(update={"roughness": law, **load}), [slip.f_ext], "full_slip", known, tips)[0]


def _adhere(scene: Scene, law: Closure, voltage: float) -> str:
    """Return that ridges adhere, empty where they do not; the voltage that a circuit leaves is another by closure."""
    under = f"at {voltage:.4g} V" if scene.drive is None else "under the drive"
    return f"ridges adhere {under}" if sticking(law, voltage) else ""


# -- the bands ---------------------------------------------------------------------------------------------
def with_band(result: "Result") -> "Result":
    """Return a result with its bands in its record, over closures and over all assumptions, or a note why it has none.

    It has none, and no note, where no voltage changes friction. In the record, ready for JSON, both have ``mu_app``.
    The band over closures has it by closure, None where one has no number: ``no_number`` then has the reason, and
    ``upper_bounds`` the part of the pressure that a closure balances whose attraction is an upper bound. It is not
    there where the result's own closure has no number. The other one has ``low`` and ``high``, ``whole``, and its
    ``parts``, the largest first. An upper end that is open is None: that of a part with a change that has no number,
    and then that of the band. ``at_least`` is then the end by the changes that have one, and ``no_number`` has the
    reasons. Both ends of the band are None where the result's own closure has no number.
    """
    slip, scene = result.full_slip, result.scene
    if slip is None or not slip.voltage or not slip.mu_app > 0 or scene.friction_law() is None:
        return result
    try:
        here = _solved(scene, slip, scene.closure(), result.uncharged)
        laws = {} if here.why else closures(scene.closure(), scene.finger)
        found = {words: friction(scene, slip, law, result.uncharged) for words, law in laws.items()}
        known = _known(result, slip, here, found)
    except SceneError as error:
        why, _, _ = str(error).partition(";")
        return replace(result, notes=(*result.notes, f"No likely range of µ_app is computed: {why}."))
    values = {words: _finite(slip.mu_app * each.mu_app / here.mu_app) for words, each in found.items()}
    bounds = {words: each.balanced for words, each in found.items() if each.balanced}
    band = {"mu_app": values, "no_number": _reasons(found), "upper_bounds": bounds, "model": "cylinders"}
    more = ({BAND: band} if found else {}) | ({KNOWN: known} if known else {})
    return replace(result, record=result.record | more)


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _reasons(found: Mapping[str, Slip]) -> dict[str, str]:
    return {words: each.why for words, each in found.items() if each.why}


def _known(result: "Result", slip: ContactState, here: Slip, of_closures: Mapping[str, Slip]) -> dict[str, Any]:
    """Return the band over all assumptions; empty where none changes friction."""
    finger = result.finger if result.finger is not None and "full_slip" in result.finger.states else None
    mu = slip.mu_app if finger is None else finger.states["full_slip"].mu_app
    unknown = ["slices"] if finger is not None and "f_t" not in known_at(finger.f_ext) else []
    found: dict[str, Any] = {"mu_app": mu, "low": None, "high": None, "whole": finger is not None, "parts": []}
    found |= {"not_known": unknown}
    if here.why:
        return found | {"no_number": {_OWN: here.why}}
    parts = [part for part in _parts(result, slip, here.mu_app, mu, of_closures) if part]
    if not parts:
        return {}
    parts.sort(key=lambda part: -np.inf if part["high"] is None else -np.log(part["high"] / part["low"]))
    below = np.sqrt(sum(np.log(part["low"] / mu) ** 2 for part in parts))
    above = np.sqrt(sum(np.log(part["high"] / mu) ** 2 for part in parts if part["high"] is not None))
    found |= {"low": mu * float(np.exp(-below)), "parts": parts}
    at_least = mu * float(np.exp(above))
    is_open = any(part["high"] is None for part in parts)
    return found | ({"high": None, "at_least": at_least} if is_open else {"high": at_least})


def _parts(
    result: "Result", slip: ContactState, here: float, mu: float, of_closures: Mapping[str, Slip]
) -> Iterator[dict[str, Any]]:
    """Yield the parts of the band about µ_app, ``mu``; ``here`` is that of the charged cylinders at full slip."""
    numbers = {words: each for words, each in of_closures.items() if not each.why}
    largest = max(numbers, key=lambda words: numbers[words].mu_app, default="")
    part = _part("rough contact", mu, [each.mu_app / here for each in numbers.values()], _reasons(of_closures))
    bound = numbers[largest].balanced if largest else 0.0
    yield part | ({"upper_bounds": {largest: bound}} if bound else {})
    full = powers() if coefficient(result.scene) is not None else {LAW: powers()[LAW]}
    for name, changed in changes(result.scene, slip, result.uncharged).items():
        found = [friction(each, slip, law, result.uncharged, tips) for each, law, tips in changed]
        pairs = zip(found, full.get(name, (1.0, 1.0)), strict=True)
        ratios = [(each.mu_app / here) ** power for each, power in pairs if not each.why]
        yield _part(name, mu, ratios, {f"changed {name}": each.why for each in found if each.why})
    if result.finger is not None and "f_t" in (ends := known_at(result.finger.f_ext)):
        yield _part("slices", mu, [1 / (1 + end) for end in ends["f_t"]], {})


def _part(name: str, mu: float, ratios: Sequence[float], no_number: Mapping[str, str]) -> dict[str, Any]:
    """Return a part, empty without a change.

    Args:
        name: of the assumption.
        mu: µ_app of the result.
        ratios: µ_app over that, of the changes that have a number.
        no_number: reasons of those that have none, by words.
    """
    if not ratios and not no_number:
        return {}
    found, high = {"name": name, "low": mu * min([1.0, *ratios])}, mu * max([1.0, *ratios])
    return found | ({"high": None, "at_least": high, "no_number": dict(no_number)} if no_number else {"high": high})


def changes(
    scene: Scene, slip: ContactState, press: ContactState | None
) -> dict[str, list[tuple[Scene, Closure, float]]]:
    """Return two changes of each assumption but the closure, by part: scene, closure and radius of tips over its own.

    Arguments are those of :func:`friction`, and it raises SceneError of a finger that is none of cylinders.
    """
    own: Any = scene.closure()
    still = _cylinders(scene, slip, own, press, 0.0)
    laws = laws_like(scene.friction_law(), still.f_contact / still.contact_length)
    found: dict[str, list[tuple[Scene, Closure, float]]] = {
        LAW: [(scene.model_copy(update={"friction": law}), own, 1.0) for law in laws],
        "tips": [(scene, own, tips) for tips in TIPS],
    }
    if own.shared:
        found["roughness"] = [(scene, replace(own, h_rms=factor * own.h_rms), 1.0) for factor in _CHANGE]
        found["coating"] = [(*_coated(scene, own, factor), 1.0) for factor in _CHANGE]
    return found


def laws_like(own: Friction | None, p_c: float) -> tuple[float, Derjaguin]:
    """Return a friction coefficient, and a shear stress, with the friction of a law at a mean contact pressure (Pa).

    On the ridge that they have in common the pressure is the same too: what friction shears is its own.
    """
    stress = 0.0 if own is None else float(own.limit(p_c))
    return stress / p_c, replace(_SHEAR_STRESS, tau_0=stress / float(_SHEAR_STRESS.limit(p_c)))


@cache
def powers() -> Mapping[str, Sequence[float]]:
    """Return the powers of the cylinders' ratios that give the full model's, by part, of its two changes in order.

    Where a change has no ratio, as from Coulomb's law to itself, the power is that of the other one.
    """
    kept = json.loads((files("fingerpad.reduced") / "full_changes.json").read_text(encoding="utf-8"))
    found = {name: [np.log(full) / np.log(closed) for full, closed in part] for name, part in kept.items()}
    return {name: (*map(float, part), float(part[0]))[:2] for name, part in found.items()}


def _coated(scene: Scene, own: Any, factor: float) -> tuple[Scene, Closure]:
    """Return a scene and its closure with a multiple of the effective insulator thickness."""
    electric = scene.electric
    changed = electric.model_copy(update={"d_i": factor * electric.d_i, "eps_sc": electric.eps_sc / factor})
    other = scene.model_copy(update={"electric": changed})
    return other, replace(own, h_0=other.h_0)
