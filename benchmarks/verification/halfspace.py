r"""Contact of a periodic half-space by FFT: Hertz's sphere.

**Sphere** of radius R (Hertz 1882; Johnson 1985, sec. 4.2(a)): contact radius a and pressure
:math:`p = p_0 \sqrt{1 - r^2 / a^2}` with :math:`F = 4 E^* a^3 / 3R`, :math:`p_0 = 2 E^* a / \pi R`. The second moment
of the pressure is :math:`2 a^2 F / 5`; it gives the radius to less than a pixel. The sphere's images at the distances
L R_k of the square lattice lift the surface by :math:`F r^2 S / 4 \pi E^* L^3` about its mean over directions, with
:math:`S = \sum R_k^{-3} = 9.0336`; the map is flatter by that much.
"""

import numpy as np

from benchmarks.verification.case import Case, Row, order, order_row
from variational.roughness.halfspace import press
from variational.roughness.topography import HeightMap

_TIGHT = 1e-9
_IMAGES = 9.0336217  # sum of R^-3 over a square lattice without its origin
_RADII = np.linspace(0.046, 0.054, 5)  # of spheres, over the period
_WIDE = "scatter of where the edge lies in its pixel"
_ASKED = 1e-3, "what is asked of 512 pixels; the contact's edge is found to a pixel"
_COARSE = 1e-2, "the square of a pixel over the contact's size, at the largest pixels"


def hertz(n: int, a: float = 0.05) -> tuple[float, float, float]:
    """Return contact radius and largest pressure of a sphere over the known ones, and the pressure's mean error.

    Args:
        n: pixels in the period, 1.
        a: contact radius.
    """
    x = np.linspace(-0.5, 0.5, n, endpoint=False)
    r2, force = x[:, None] ** 2 + x[None] ** 2, 4 / 3 * a**3
    curvature = 1 - force * _IMAGES / (2 * np.pi)
    found = press(HeightMap(-r2 / 2 * curvature, (1.0, 1.0)), force, 1.0, tolerance=_TIGHT)
    most = 2 * a / np.pi
    exact = most * np.sqrt(np.maximum(1 - r2 / a**2, 0.0))
    of_moment = np.sqrt(2.5 * (found.pressure * r2).sum() / found.pressure.sum())
    error = np.abs(found.pressure - exact).mean() / force
    return float(of_moment / a), float(found.pressure.max() / most), float(error)


def sphere(small: bool) -> list[Row]:
    """Radius and pressure of Hertz's sphere: means over five radii, whose edges lie anywhere."""
    pixels, (tolerance, why) = ((64, 128), _COARSE) if small else ((64, 128, 256, 512), _ASKED)
    found = np.array([[hertz(n, a) for a in _RADII] for n in pixels])
    radius, most, pressure = np.abs(found - [1.0, 1.0, 0.0]).mean(axis=1).T
    mesh = f"{pixels[-1]} × {pixels[-1]} pixels, {0.05 * pixels[-1]:.1f} to the radius"
    observed = order(pressure, pixels)
    return [
        Row("relative error of the contact radius", radius[-1], 0.0, tolerance, why, mesh, absolute=True),
        Row("relative error of the largest pressure", most[-1], 0.0, tolerance, why, mesh, absolute=True),
        order_row("order of the pressure's error", observed, 1.5, 0.3, f"{_WIDE}; a root ends there", mesh),
    ]


_JOHNSON = "Johnson, Contact Mechanics, 1985, doi 10.1017/CBO9781139171731"
CASES = (Case("Sphere on a half-space, by FFT", f"Hertz 1882, in {_JOHNSON}, sec. 4.2(a)", sphere),)
