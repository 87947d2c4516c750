r"""Contact of a periodic half-space by FFT: Hertz's sphere, waves in one and two directions, a random surface.

**Sphere** of radius R (Hertz 1882; Johnson 1985, sec. 4.2(a)): contact radius a and pressure
:math:`p = p_0 \sqrt{1 - r^2 / a^2}` with :math:`F = 4 E^* a^3 / 3R`, :math:`p_0 = 2 E^* a / \pi R`. The second moment
of the pressure is :math:`2 a^2 F / 5`; it gives the radius to less than a pixel. The sphere's images at the distances
L R_k of the square lattice lift the surface by :math:`F r^2 S / 4 \pi E^* L^3` about its mean over directions, with
:math:`S = \sum R_k^{-3} = 9.0336`; the map is flatter by that much.

**Wave** of height :math:`h \cos 2 \pi x / \lambda` (Westergaard 1939; Johnson 1985, sec. 13.2): with the pressure of
full contact :math:`p^* = \pi E^* h / \lambda` and a contact length 2a in each wave,

.. math:: \bar p = p^* \sin^2 \frac{\pi a}{\lambda}, \qquad p = \frac{2 \bar p \cos (\pi x / \lambda)}{\sin^2 (\pi a /
          \lambda)} \sqrt{\sin^2 \frac{\pi a}{\lambda} - \sin^2 \frac{\pi x}{\lambda}}, \qquad
          \langle p \cos 2 \pi x / \lambda \rangle = \bar p \Big(1 - \frac12 \sin^2 \frac{\pi a}{\lambda} \Big).

The last mean gives the length. **Waves in two directions**, :math:`h \cos q x \cos q y`, in full contact: the mean
pressure and :math:`\sqrt2 E^* q h / 2 \cos q x \cos q y`.
"""

import numpy as np

from benchmarks.verification.case import CONVERGENCE, Case, Row, order, order_row
from variational.roughness.halfspace import press
from variational.roughness.spectrum import SelfAffine
from variational.roughness.topography import HeightMap

_PARTS = np.linspace(0.3, 0.5, 9)  # of the pressure of full contact
_TIGHT = 1e-9
_IMAGES = 9.0336217  # sum of R^-3 over a square lattice without its origin
_RADII = np.linspace(0.046, 0.054, 5)  # of spheres, over the period
_WIDE = "scatter of where the edge lies in its pixel"
_H_0 = 1 / 6  # effective insulator thickness over h_rms, about the default scene's
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


def wave(small: bool) -> list[Row]:
    """Contact length and pressure of a wave in one direction: means over nine pressures, whose edges lie anywhere."""
    pixels, (tolerance, why) = ((32, 64, 128), _COARSE) if small else ((64, 128, 256, 512), _ASKED)
    found = np.array([[westergaard(n, part) for part in _PARTS] for n in pixels])
    length, pressure = np.abs(found - [1.0, 0.0]).mean(axis=1).T
    mesh = f"{pixels[-1]} pixels in the wave"
    orders = order(length, pixels), order(pressure, pixels)
    return [
        Row("relative error of the contact length", length[-1], 0.0, tolerance, why, mesh, absolute=True),
        order_row("order of the length's error", orders[0], 2.0, 0.3, f"{_WIDE}; moments are smooth", mesh),
        Row("error of the pressure over its mean", pressure[-1], 0.0, tolerance, why, mesh, absolute=True),
        order_row("order of the pressure's error", orders[1], 1.5, 0.3, f"{_WIDE}; a root ends there", mesh),
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


def finer(surface: HeightMap, k: int) -> HeightMap:
    """Return the same surface on k times the pixels along each side, a number of pixels that is even."""
    n = len(surface.heights)
    modes = np.fft.ifftshift(np.pad(np.fft.fftshift(np.fft.fft2(surface.heights)), n * (k - 1) // 2))
    return HeightMap(np.fft.ifft2(modes).real * k**2, surface.size)


def grids(small: bool) -> list[Row]:
    """Mean over random surfaces with four pixels to the shortest wave, as in the package's tables, beside more."""
    spectrum = SelfAffine(1.0, 0.75, 2 * np.pi, plateau=False, shortest=2 * np.pi / 8)
    times, count = ((1, 2), 1) if small else ((1, 2, 4), 3)
    found = []
    for seed in range(count):
        rough = spectrum.surface((128, 128), (8 * np.pi, 8 * np.pi), seed)
        contacts = [press(finer(rough, k), 0.1, 1.0) for k in times]
        found.append([(c.gap.mean(), ((_H_0 + c.gap) ** -2).mean(), c.fraction) for c in contacts])
    means = np.array(found).mean(axis=0)
    gap, square, area = means[:-1].T / means[-1][:, None]
    words, finest = "on 4 pixels to the shortest wave over that on", 4 * times[-1]
    mesh = f"{count} surfaces, {128 * times[-1]} × {128 * times[-1]} pixels at most"
    edge = "the contact's edge is found to a pixel"
    rows = [
        Row(f"mean gap {words} {finest}", gap[0], 1.0, 2e-3, "what is asked of two grids: 0.2 %", mesh),
        Row(f"<(h_0 + g)^-2> {words} {finest}, h_0 = h_rms / 6", square[0], 1.0, 0.02, f"{edge}; h_0 is small", mesh),
        Row(f"area in contact {words} {finest}", area[0], 1.0, 0.2, f"{edge}, and one wave has four", mesh),
    ]
    if not small:
        observed = float(np.log2((area[0] - area[1]) / (area[1] - 1)))
        rows.append(order_row("order of the area's error", observed, 1.0, 0.5, f"{_WIDE}, of few contacts", mesh))
    return rows


_JOHNSON = "Johnson, Contact Mechanics, 1985, doi 10.1017/CBO9781139171731"
CASES = (
    Case("Sphere on a half-space, by FFT", f"Hertz 1882, in {_JOHNSON}, sec. 4.2(a)", sphere),
    Case("Wave on a half-space, by FFT", f"Westergaard 1939, in {_JOHNSON}, sec. 13.2", wave),
    Case("Waves in two directions, full contact", f"closed form, {_JOHNSON}, sec. 13.1", full_contact),
    Case("Random surface on two grids and more", "the same surface on finer pixels", grids, CONVERGENCE),
)
