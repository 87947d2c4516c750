"""A mesh that follows the layers and ridges of a fingertip as their numbers change, without another mesh.

A place in the skin is an arc length s and a depth below the elliptical outline. Its depth stays where it is between the
curves about it (:mod:`geometry.profiles`), and its arc length between the grooves of its ridge. Deeper than the dermis
the way that places are moved falls to nothing before the bone, and beyond the last ridge before the nail, so that bone
and nail stay.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.parameters import Fingertip
from geometry.profiles import GeometryError, Profiles

Array = NDArray[np.float64]
FOLLOWED = (
    "sc_thickness", "ve_thickness", "dermis_thickness", "ridge_wavelength", "ridge_amplitude",
    "intermediate_ridge_height", "limiting_ridge_height", "merkel_offset", "meissner_offset",
)  # fmt: skip
"""Numbers of a fingertip that a mesh can follow."""


class Morph:
    """Places of a mesh, to be moved with the numbers of its finger."""

    def __init__(self, finger: Fingertip, places: Array) -> None:
        """Find arc length and depth of places.

        Args:
            finger: of the mesh.
            places: nodes (m), shape (nodes, 2).

        Raises:
            GeometryError: the bone, the dermis and the nail leave no way between them.
        """
        self._now, self.places = Profiles(finger), places
        self._s, self._depth = self._now.below(places)
        now, end = self._now, self._now.ridged_arc + finger.ridge_wavelength
        rim = now.below(now.bone(np.linspace(-np.pi / 2, np.pi / 2, 181)))[1]
        deepest = float(now.d_sub(0.0))
        if min(rim.min() - deepest, now.nail_arc - end) <= 0:
            raise GeometryError("the nail or the bone is where ridges or dermis end, so that a mesh cannot follow them")
        self._part = _fall((np.abs(self._s) - end) / (now.nail_arc - end))
        self._part *= _fall((self._depth - deepest) / (rim.min() - deepest))

    def to(self, finger: Fingertip) -> Array:
        """Return the places (m), shape (nodes, 2), of a finger with others of :data:`FOLLOWED`.

        Raises:
            GeometryError: another number is another one.
        """
        then = Profiles(finger)
        for name, value in self._now.finger:
            if getattr(finger, name) != value and name not in FOLLOWED:
                raise GeometryError(f"{name} moves bone, nail or outline, which the mesh does not follow")
        s = self._s * finger.ridge_wavelength / self._now.finger.ridge_wavelength
        curves = [
            np.stack([f(at) for f in (p.skin, p.sc_ve, p.ve_d, p.d_sub)])
            for p, at in ((self._now, self._s), (then, s))
        ]  # fmt: skip
        before, after = (np.concatenate([c, c[-1:] + 1.0]) for c in curves)
        k = np.clip((before <= self._depth).sum(axis=0) - 1, 0, len(before) - 2)
        at = np.arange(len(k))
        rise = (after[k + 1, at] - after[k, at]) / (before[k + 1, at] - before[k, at])
        moved = then.point(s, after[k, at] + rise * (self._depth - before[k, at])) - self.places
        return np.asarray(self.places + self._part[:, None] * moved)


def _fall(t: NDArray[np.floating[Any]]) -> Array:
    """Return one below 0 and zero above 1, smooth between."""
    t = np.clip(t, 0.0, 1.0)
    return np.asarray(1 - t**3 * (10 - 15 * t + 6 * t**2))
