r"""Fingers similar to the default one: all lengths on one scale, all soft layers stiffer by one factor.

Without voltage the contact of a finger depends on forces, lengths and moduli alone. With lengths :math:`s` and moduli
:math:`m` times those of the default finger, dimensional analysis gives its contact length from the default one,
:math:`L(f) = s\,L_0(f / (s m))`, with as many ridges in contact; forces are per length, N/m. *Assumption*: nail and
nail bed, which stay as they are, have no influence, nor have differences of 1 % between lengths or between moduli.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

from fingerpad.scene.fingers import SOFT
from fingerpad.scene.law_keys import parameters
from fingerpad.scene.scene import Scene
from geometry.parameters import Fingertip

_SAME = 0.01  # relative difference of ratios


@dataclass(frozen=True)
class Similar:
    """How a finger is scaled."""

    length: float = 1.0
    """Its lengths over those of the default finger."""
    modulus: float = 1.0
    """Its soft layers' moduli over those."""

    @property
    def force(self) -> float:
        """Forces per length at which it has the shape of the default finger, over those."""
        return self.length * self.modulus

    @property
    def words(self) -> str:
        """For a reader; empty of the default finger."""
        if self == Similar():
            return ""
        return f"as a finger of {self.length:.3g} times its lengths and {self.modulus:.3g} times its stiffness"


_default = cache(Scene)


def similar(scene: Scene) -> Similar | str:
    """Return how a scene's finger is scaled, or the table of the scene in which it is another finger."""
    default = _default()
    if scene.contact != default.contact:
        return "contact"
    length = _length(scene) if scene.geometry != default.geometry else 1.0
    modulus = _modulus(scene) if scene.materials != default.materials else 1.0
    return "geometry" if length is None else "materials" if modulus is None else Similar(length, modulus)


def _length(scene: Scene) -> float | None:
    shape, default, ratios = scene.geometry, Fingertip(), list[float]()
    if shape.file is not None:
        return None
    for name in Fingertip.model_fields:
        value, known = getattr(shape, name), getattr(default, name)
        if isinstance(known, float):
            ratios.append(value / known)
        elif value != known:
            return None
    return _mean(ratios)


def _modulus(scene: Scene) -> float | None:
    default, ratios = _default().materials, list[float]()
    for name in type(scene.materials).model_fields:
        law, known = getattr(scene.materials, name), getattr(default, name)
        if law == known and name not in SOFT:
            continue
        if name not in SOFT or type(law) is not type(known):
            return None
        mine, theirs = (_without_modulus(each) for each in (law, known))
        if mine != theirs:
            return None
        ratios.append(law.shear_modulus / known.shear_modulus)
    return _mean(ratios)


def _without_modulus(law: Any) -> dict[str, Any]:
    return {name: value for name, value in parameters(law).items() if name != "shear_modulus"}


def _mean(ratios: Iterable[float]) -> float | None:
    """Return the mean of ratios that are the same within 1 %."""
    found = sorted(ratios)
    return sum(found) / len(found) if found[-1] <= (1 + _SAME) * found[0] else None
