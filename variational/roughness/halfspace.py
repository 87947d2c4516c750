r"""Contact of a rough, periodic elastic half-space with a rigid plane, solved exactly on a grid by FFT.

Heights h of the rough surface, contact pressure p >= 0 and gap g >= 0 are fields on a periodic rectangle. The plane is
hard: where p > 0 the surfaces touch, elsewhere nothing presses,

.. math:: g = \delta + u - h \ge 0, \qquad p \ge 0, \qquad p\,g = 0, \qquad
          \hat u(\mathbf q) = \frac{2}{E^* |\mathbf q|} (\hat p(\mathbf q) - \hat a(\mathbf q)), \quad
          \mathbf q \ne 0.

The mean pressure is given, and the approach delta follows from it. An attraction a (Pa) may act on the surface too; it
is zero where attraction does not deform (Derjaguin, Muller and Toporov), and acts across the gaps that are found. The
conditions are those of the least complementary energy over pressures of that mean. They are solved by the conjugate
gradients of Polonsky and Keer (1999, Wear 231, 206, doi:10.1016/S0043-1648(99)00113-1): the mean gap over the contact
is subtracted from the gradient, points that would pull leave the contact, and points that overlap enter it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from variational.roughness.topography import HeightMap, wavevectors

Array = NDArray[np.float64]
_TOLERANCE = 1e-6
_ITERATIONS = 5000


class NoContactError(ValueError):
    """A contact that was not found; one sentence."""


class Contact(NamedTuple):
    """A rough surface on a rigid plane."""

    pressure: Array
    """Contact pressure (Pa), shape (nx, ny)."""
    gap: Array
    """Gap (m), shape (nx, ny); zero in contact."""
    iterations: int

    @property
    def fraction(self) -> float:
        """Part of the area that is in contact."""
        return float(np.mean(self.pressure > 0))


def compliance(shape: tuple[int, ...], size: tuple[float, float], modulus: float) -> Array:
    """Return displacement over pressure of each mode (m/Pa), in the order of ``scipy.fft.rfft2``; zero at q = 0.

    Args:
        shape: pixels along x and y.
        size: lengths (m) along x and y.
        modulus: contact modulus E* (Pa).
    """
    q = wavevectors(shape, size)[:, : shape[1] // 2 + 1]
    return np.divide(2 / modulus, q, out=np.zeros_like(q), where=q > 0)


def displacement(pressure: Array, modes: Array) -> Array:
    """Return the surface's displacement (m), of zero mean, under a pressure (Pa) by :func:`compliance`."""
    return np.asarray(fft.irfft2(modes * fft.rfft2(pressure), s=pressure.shape))


def press(
    surface: HeightMap,
    mean_pressure: float,
    modulus: float,
    start: Array | None = None,
    tolerance: float = _TOLERANCE,
    attraction: Array | None = None,
) -> Contact:
    """Return the contact of a surface under a mean contact pressure.

    Args:
        surface: heights, positive towards the plane, taken as periodic.
        mean_pressure: (Pa), greater than 0.
        modulus: contact modulus E* (Pa).
        start: contact pressure to start at (Pa), shape (nx, ny), of any mean; uniform by default.
        tolerance: largest rms of the gap in contact, and largest overlap beside it, over the rms height.
        attraction: held attraction (Pa), shape (nx, ny), which pulls the surface to the plane; none by default.

    Raises:
        ValueError: a pressure or a modulus that is not positive, or a flat surface; in one sentence.
        NoContactError: the iteration does not converge.
    """
    h, h_rms = surface.heights, surface.h_rms
    for name, value, unit in (("mean pressure", mean_pressure, "Pa"), ("modulus", modulus, "Pa")):
        if not 0 < value < np.inf:
            raise ValueError(f"the {name} of a contact is {value:g} {unit}; it must be finite and greater than 0")
    if h_rms == 0:
        raise ValueError("all heights are the same; there is no roughness to press")
    modes = compliance(h.shape, surface.size, modulus)
    p = np.full(h.shape, mean_pressure) if start is None else start * (mean_pressure / float(start.mean()))
    if attraction is not None:
        h = h + displacement(attraction, modes)
    direction, before, conjugate = np.zeros_like(h), 1.0, False
    for iteration in range(_ITERATIONS):
        contact = p > 0
        gap = displacement(p, modes) - h
        gap -= gap[contact].mean()
        inside = np.where(contact, gap, 0.0)
        square = float(np.vdot(inside, inside))
        if max(np.sqrt(square / np.count_nonzero(contact)), -float(gap.min())) <= tolerance * h_rms:
            return Contact(p, np.where(contact, 0.0, np.maximum(gap, 0.0)), iteration)
        direction = np.where(contact, inside + (square / before * direction if conjugate else 0.0), 0.0)
        before = square
        change = displacement(direction, modes)
        change -= change[contact].mean()
        curvature = float(np.vdot(change, direction))
        # One pixel alone in contact has no direction: others come in by the steepest descent's safe step.
        step = float(np.vdot(inside, direction)) / curvature if curvature > 0 else 1 / float(modes.max())
        p = np.maximum(p - step * direction, 0.0)
        overlap = (p == 0) & (gap < 0)
        conjugate = not overlap.any()
        p[overlap] -= step * gap[overlap]
        p *= mean_pressure / float(p.mean())
    raise NoContactError(
        f"no contact under {mean_pressure:g} Pa was found in {_ITERATIONS} iterations on {h.shape[0]} x {h.shape[1]} "
        "pixels; take a smoother surface or a larger tolerance"
    )
