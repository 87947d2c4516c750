r"""Contact of a periodic half-space by FFT: Hertz's sphere, and waves in one and in two directions.

**Sphere** of radius R (Hertz 1882; Johnson 1985, sec. 4.2(a)): contact radius a and pressure
:math:`p = p_0 \sqrt{1 - r^2 / a^2}` with :math:`F = 4 E^* a^3 / 3R`, :math:`p_0 = 2 E^* a / \pi R`. The second moment
of the pressure is :math:`2 a^2 F / 5`; it gives the radius to less than a pixel.

**Wave** of height :math:`h \cos 2 \pi x / \lambda` (Westergaard 1939; Johnson 1985, sec. 13.2): with the pressure of
full contact :math:`p^* = \pi E^* h / \lambda` and a contact length 2a in each wave,

.. math:: \bar p = p^* \sin^2 \frac{\pi a}{\lambda}, \qquad p = \frac{2 \bar p \cos (\pi x / \lambda)}{\sin^2 (\pi a /
          \lambda)} \sqrt{\sin^2 \frac{\pi a}{\lambda} - \sin^2 \frac{\pi x}{\lambda}}, \qquad
          \langle p \cos 2 \pi x / \lambda \rangle = \bar p \Big(1 - \frac12 \sin^2 \frac{\pi a}{\lambda} \Big).

The last mean gives the length. **Waves in two directions**, :math:`h \cos q x \cos q y`, in full contact: the mean
pressure and :math:`\sqrt2 E^* q h / 2 \cos q x \cos q y`.
"""

import numpy as np

from benchmarks.verification.case import Case, Row, order, order_row
from variational.roughness.halfspace import press
from variational.roughness.topography import HeightMap

_PARTS = np.linspace(0.3, 0.5, 9)  # of the pressure of full contact
_TIGHT = 1e-9
_ASKED = 1e-3, "what is asked of 512 pixels; the contact's edge is found to a pixel"
_COARSE = 1e-2, "the square of a pixel over the contact's size, at the largest pixels"


def hertz(n: int) -> tuple[float, float]:
    """Return contact radius and largest pressure of a sphere over the known ones, on n x n pixels."""
    radius, a = 1.0, 0.05
    x = np.linspace(-0.5, 0.5, n, endpoint=False)
    r2 = x[:, None] ** 2 + x[None] ** 2
    sphere = HeightMap(np.asarray(-r2 / 2 / radius, dtype=np.float64), (1.0, 1.0))
    found = press(sphere, 4 / 3 * a**3 / radius, 1.0, tolerance=_TIGHT)
    of_moment = np.sqrt(2.5 * (found.pressure * r2).sum() / found.pressure.sum())
    return float(of_moment / a), float(found.pressure.max() / (2 * a / np.pi / radius))


def westergaard(n: int, part: float) -> tuple[float, float]:
    """Return the contact length of a wave over the known one, and the mean error of the pressure over its mean.

    Args:
        n: pixels in the wave.
        part: mean pressure over that of full contact.
    """
    height, x = 0.01, np.arange(n) / n
    x = np.where(x > 0.5, x - 1, x)
    wave = HeightMap(height * np.cos(2 * np.pi * x)[:, None] * np.ones((1, 4)), (1.0, 4 / n))
    mean = part * np.pi * height
    pressure = press(wave, mean, 1.0, tolerance=_TIGHT).pressure[:, 0]
    a = np.arcsin(np.sqrt(part)) / np.pi
    root = np.sqrt(np.maximum(part - np.sin(np.pi * x) ** 2, 0.0))
    exact = 2 * mean * np.cos(np.pi * x) / part * root
    of_moment = np.arcsin(np.sqrt(2 * (1 - (pressure * np.cos(2 * np.pi * x)).mean() / mean))) / np.pi
    return float(of_moment / a), float(np.abs(pressure - exact).mean() / mean)


def sphere(small: bool) -> list[Row]:
    """Radius and largest pressure of Hertz's sphere, which its periodic images change by some 1e-4."""
    pixels, (tolerance, why) = ((64, 128), _COARSE) if small else ((128, 256, 512), _ASKED)
    radius, pressure = np.array([hertz(n) for n in pixels]).T
    mesh = f"{pixels[-1]} × {pixels[-1]} pixels, {0.05 * pixels[-1]:.1f} to the radius"
    return [
        Row("contact radius over the known one", radius[-1], 1.0, tolerance, why, mesh),
        Row("largest pressure over the known one", pressure[-1], 1.0, tolerance, why, mesh),
    ]


def wave(small: bool) -> list[Row]:
    """Contact length and pressure of a wave in one direction: means over nine pressures, whose edges lie anywhere."""
    pixels, (tolerance, why) = ((32, 64, 128), _COARSE) if small else ((64, 128, 256, 512), _ASKED)
    found = np.array([[westergaard(n, part) for part in _PARTS] for n in pixels])
    length, pressure = np.abs(found - [1.0, 0.0]).mean(axis=1).T
    mesh, wide = f"{pixels[-1]} pixels in the wave", "scatter of where the edge lies in its pixel"
    orders = order(length, pixels), order(pressure, pixels)
    return [
        Row("relative error of the contact length", length[-1], 0.0, tolerance, why, mesh, absolute=True),
        order_row("order of the length's error", orders[0], 2.0, 0.3, f"{wide}; moments are smooth", mesh),
        Row("error of the pressure over its mean", pressure[-1], 0.0, tolerance, why, mesh, absolute=True),
        order_row("order of the pressure's error", orders[1], 1.5, 0.3, f"{wide}; a root ends there", mesh),
    ]


def full_contact(small: bool) -> list[Row]:
    """Pressure of waves in two directions where it is most off."""
    n, height, part = 32, 0.01, 1.2
    x = 2 * np.pi * np.arange(n) / n
    waves = np.cos(x)[:, None] * np.cos(x)[None]
    most = np.sqrt(2) * np.pi * height
    pressure = press(HeightMap(height * waves, (1.0, 1.0)), part * most, 1.0, tolerance=1e-10).pressure
    exact = most * (part + waves)
    where = np.unravel_index(int(np.argmax(np.abs(pressure / exact - 1))), exact.shape)
    why = "the tolerance of the gap, 1e-10 of the height, over the least pressure"
    return [Row("p_n where it is most off, over E*", pressure[where], exact[where], 1e-7, why, f"{n} × {n} pixels")]


_JOHNSON = "Johnson, Contact Mechanics, 1985, doi 10.1017/CBO9781139171731"
CASES = (
    Case("Sphere on a half-space, by FFT", f"Hertz 1882, in {_JOHNSON}, sec. 4.2(a)", sphere),
    Case("Wave on a half-space, by FFT", f"Westergaard 1939, in {_JOHNSON}, sec. 13.2", wave),
    Case("Waves in two directions, full contact", f"closed form, {_JOHNSON}, sec. 13.1", full_contact),
)
