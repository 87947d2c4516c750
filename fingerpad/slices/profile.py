"""The finger along its axis: height of its lower side, tilt of its bone, scale of its slices."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from fingerpad.scene.messages import SceneError

if TYPE_CHECKING:
    from fingerpad.scene.parameters import Slices

Array = NDArray[np.floating[Any]]
_SEARCHED = 2001  # places along the finger between which ends of contact are looked for


@dataclass(frozen=True)
class Profile:
    """A finger along its axis, from ``ends[0]`` to ``ends[1]`` (m)."""

    ends: tuple[float, float]
    height: Callable[[Array | float], Array | float]
    """Height s (m) of the lower side at places z (m)."""
    width: Callable[[Array], Array]
    """Scale w of the slices at places z (m)."""
    tilt: float = 0.0
    """Slope θ of the bone."""
    straight: bool = False
    """Whether all heights are 0: then the ends may touch."""

    def rise(self, z: Array | float) -> Array:
        """Return how far slices stand above the bone's lowest place, s + θ z (m)."""
        return np.asarray(self.height(z) + self.tilt * z, dtype=float)

    @cached_property
    def _searched(self) -> tuple[Array, Array]:
        """Places along the finger (m), and the rise of the slices there (m)."""
        z = np.linspace(*self.ends, _SEARCHED)
        return z, self.rise(z)

    @cached_property
    def lowest(self) -> tuple[float, float]:
        """The place (m) where the finger first touches, and the rise (m) there, the least one.

        Raises:
            SceneError: it is at an end of the finger, whose pad then touches nothing.
        """
        z, rise = self._searched
        k = int(np.argmin(rise))
        if k in (0, len(z) - 1) and not (self.straight and self.tilt == 0):
            raise SceneError(
                f"slices.tilt is {self.tilt:g} rad, with which the finger is lowest at its end, at z = {z[k]:.3g} m, "
                "and its pad has no contact; give a smaller tilt, a smaller radius or a longer finger"
            )
        fine = np.linspace(z[max(k - 1, 0)], z[min(k + 1, len(z) - 1)], _SEARCHED)
        found = self.rise(fine)
        return float(fine[found.argmin()]), float(found.min())

    @cached_property
    def centre_scale(self) -> float:
        """The scale of the slice where the finger first touches."""
        return float(self.width(np.array([self.lowest[0]]))[0])

    def contact(self, delta: float) -> list[tuple[float, float]]:
        """Return the stretches (m) of the finger that touch, from one end of contact to the other.

        Args:
            delta: lowering of the bone (m).

        Raises:
            SceneError: the contact reaches an end of the finger.
        """
        z, rise = self._searched
        touches = delta - rise > 0
        if not touches.any():
            return self._between(delta, z)
        if not self.straight and (touches[0] or touches[-1]):
            end = z[0] if touches[0] else z[-1]
            raise SceneError(
                f"the finger ends at z = {end:.3g} m, and at an indentation of {delta:.3g} m the contact goes beyond; "
                "give a smaller force or tilt, or a longer finger (slices.length, or slices.z and slices.height)"
            )
        edges = np.flatnonzero(touches[1:] != touches[:-1])
        roots = [self._root(delta, z[k], z[k + 1]) for k in edges]
        roots = [*([z[0]] if touches[0] else []), *roots, *([z[-1]] if touches[-1] else [])]
        return [(float(a), float(b)) for a, b in zip(roots[::2], roots[1::2], strict=True)]

    def _between(self, delta: float, z: Array) -> list[tuple[float, float]]:
        """Return a contact shorter than the places searched, if there is one."""
        k = int(np.clip(np.argmin(self._searched[1]), 1, len(z) - 2))
        fine = np.linspace(z[k - 1], z[k + 1], _SEARCHED)
        inside = np.flatnonzero(delta - self.rise(fine) > 0)
        if not inside.size:
            return []
        a, b = fine[max(inside[0] - 1, 0)], fine[min(inside[-1] + 1, len(fine) - 1)]
        return [(self._root(delta, a, fine[inside[0]]), self._root(delta, fine[inside[-1]], b))]

    def _root(self, delta: float, a: float, b: float) -> float:
        return float(brentq(lambda z: delta - float(self.rise(z)), a, b, xtol=1e-15))


def profile(slices: "Slices") -> Profile:
    """Return the finger that a scene's table describes; tables are interpolated monotonically, by cubics."""
    places = None if slices.z is None else np.array(slices.z)
    width = np.ones_like if slices.width is None else PchipInterpolator(places, slices.width)
    if slices.height is not None:
        assert places is not None
        height = np.array(slices.height)
        bent = PchipInterpolator(places, height)
        return Profile((places[0], places[-1]), bent, width, slices.tilt, straight=not height.any())
    half = slices.length / 2
    ends = (-half, half) if places is None else (max(-half, places[0]), min(half, places[-1]))
    return Profile(ends, lambda z: z**2 / (2 * slices.radius), width, slices.tilt)


def cylinder(length: float) -> Profile:
    """Return a straight finger of a length (m), for checks: forces are those of the cross-section times it."""
    return Profile((0.0, length), np.zeros_like, np.ones_like, straight=True)
