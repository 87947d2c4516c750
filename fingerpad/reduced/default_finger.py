r"""The default finger's contact without voltage, and fingers that are similar to it.

**Tables** over the force of the section, between which others lie. Up to 150 N/m they are full runs with a contact size
of 10 µm, of docs/models.json. Beyond, they are the last of these, times the ratios of states on a coarser mesh, of
docs/loads.json. ``benchmarks.models`` and ``benchmarks.loads`` print them.

**Similar fingers** have all lengths on one scale, and all soft layers stiffer by one factor. Without voltage the
contact of a finger depends on forces, lengths and moduli alone. With lengths :math:`s` and moduli :math:`m` times those
of the default finger, dimensional analysis gives its contact length from the default one,
:math:`L(f) = s\,L_0(f / (s m))`, with as many ridges in contact; forces are per length, N/m. *Assumption*: nail and
nail bed, which stay as they are, have no influence, nor have differences of 1 % between lengths or between moduli.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fingerpad.scene.fingers import SOFT
from fingerpad.scene.law_keys import parameters
from fingerpad.scene.scene import Scene
from geometry.parameters import Fingertip

Array = NDArray[np.float64]
_EQUAL = 0.01  # relative difference of ratios
FORCES = (5.0, 10.0, 25.0, 50.0, 75.0, 100.0, 120.0, 150.0, 200.0, 280.0, 400.0)
"""External forces (N/m)."""
LENGTHS = {  # m, in contact
    "charged": (0.2396e-3, 0.3864e-3, 0.6706e-3, 1.0542e-3, 1.3326e-3, 1.5400e-3, 1.7306e-3, 1.9294e-3)
    + (2.2556e-3, 2.6713e-3, 3.2059e-3),
    "full_slip": (0.2395e-3, 0.3805e-3, 0.6786e-3, 1.0137e-3, 1.2680e-3, 1.4924e-3, 1.6371e-3, 1.8214e-3)
    + (2.1118e-3, 2.5220e-3, 2.9995e-3),
}
RIDGES = {
    "charged": (7, 9, 11, 15, 17, 17, 19, 19, 21, 21, 23),
    "full_slip": (7, 9, 12, 14, 16, 17, 18, 18, 20, 21, 22),
}
INDENTATIONS = {  # m, how far the bone is lowered
    "charged": (0.1455e-3, 0.2241e-3, 0.3890e-3, 0.5839e-3, 0.7371e-3, 0.8654e-3, 0.9549e-3, 1.0728e-3)
    + (1.2363e-3, 1.4390e-3, 1.6609e-3),
    "full_slip": (0.1450e-3, 0.2236e-3, 0.3888e-3, 0.5833e-3, 0.7332e-3, 0.8552e-3, 0.9398e-3, 1.0488e-3)
    + (1.1970e-3, 1.3766e-3, 1.5690e-3),
}
"""Each by state."""


def lengths(f_ext: ArrayLike, state: str) -> Array:
    """Return the contact length (m) under external forces (N/m).

    Args:
        f_ext: external forces.
        state: ``charged``, normal contact, or ``full_slip``.
    """
    return interpolate(f_ext, LENGTHS[state])


def ridges(f_ext: ArrayLike, state: str) -> NDArray[np.int_]:
    """Return the number of ridges in contact; arguments of :func:`lengths`."""
    return np.maximum(np.rint(interpolate(f_ext, RIDGES[state])).astype(int), 1)


def indentation(f_ext: float, state: str) -> float:
    """Return how far the bone is lowered (m), which the closed form itself has not.

    Args:
        f_ext: external force (N/m).
        state: ``charged`` or ``full_slip``. A voltage of 200 V moves the bone at full slip by up to 6 %.
    """
    return float(interpolate(f_ext, INDENTATIONS[state]))


def interpolate(f_ext: ArrayLike, values: tuple[float, ...] | tuple[int, ...]) -> Array:
    """Return power laws through the two neighbours, at the ends through the last two; shape of the forces."""
    x, y, at = np.log(FORCES), np.log(values), np.log(f_ext)
    k = np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2)
    return np.exp(y[k] + (y[k + 1] - y[k]) * (at - x[k]) / (x[k + 1] - x[k]))


# -- similar fingers -----------------------------------------------------------------------------------------
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
    return sum(found) / len(found) if found[-1] <= (1 + _EQUAL) * found[0] else None
