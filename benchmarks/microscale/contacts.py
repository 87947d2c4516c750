"""Exact contacts of the page on the microscale: independent numbers, two grids, and attraction that deforms."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from benchmarks.gap_tables import surfaces
from benchmarks.microscale.adhesive import pressed
from fingerpad.scene import Scene
from variational.roughness.halfspace import Contact, NoContactError, press
from variational.roughness.topography import HeightMap

H_RMS, WAVE, MODULUS = 3.1e-6, 100e-6, 4 / 3 * 1e6
PRESSURES = (5e3, 10e3, 20e3, 50e3, 100e3)
P_EXT = 20e3  # Pa, under which attraction deforms or does not
CHARGED = {True: (25.0, 50.0, 70.7, 100.0, 141.4), False: (25.0, 50.0, 70.7)}
"""Voltages (V) with and without a field in contact."""
# Other code, see the page: d_eq everywhere and outside contact (µm), area in contact, mean gap (µm); mean and scatter.
KNOWN = {
    "wide": (
        ((1.98, 0.08), (1.41, 0.04), (0.967, 0.030), (0.532, 0.017), (0.300, 0.013)),
        ((2.69, 0.11), (2.10, 0.07), (1.65, 0.05), (1.18, 0.03), (0.960, 0.018)),
        ((0.0167, 0.0013), (0.0331, 0.0014), (0.0640, 0.0026), (0.150, 0.005), (0.277, 0.010)),
        ((5.60, 0.13), (4.69, 0.10), (3.71, 0.08), (2.35, 0.07), (1.37, 0.08)),
    ),
    "narrow": (
        ((1.98, 0.29), (1.43, None), (0.973, 0.08), (0.543, None), (0.317, None)),
        ((2.45, None), (1.88, None), (1.39, None), (0.94, None), (0.74, None)),
        ((0.0124, None), (0.0241, None), (0.0467, None), (0.114, None), (0.216, None)),
    ),
}
_SIZES = {"wide": (16.0, 4), "narrow": (64.0, 1)}  # ratio of waves, largest waves in a side


def scaled(surface: HeightMap) -> HeightMap:
    """Return a surface in units of q_0 and h_rms in m, with the rms height of the default scene."""
    unit = WAVE / (2 * np.pi)
    h = surface.heights - surface.heights.mean()
    return HeightMap(h / h.std() * H_RMS, (surface.size[0] * unit, surface.size[1] * unit))


def values(found: Contact) -> tuple[float, float, float, float]:
    """Return the air gap (µm) with and without field in contact, the area in contact and the mean gap (µm)."""
    h_0, touching = Scene().h_0, found.pressure > 0
    square = (h_0 + found.gap) ** -2
    gaps = [float(np.mean(part)) ** -0.5 - h_0 for part in (square, np.where(touching, 0.0, square))]
    return gaps[0] * 1e6, gaps[1] * 1e6, found.fraction, float(found.gap.mean()) * 1e6


def _pressed(surface: HeightMap) -> Iterator[tuple[float, float, float, float]]:
    start = None
    for p in PRESSURES:
        found = press(surface, p, MODULUS, start)
        start = found.pressure
        yield values(found)


def direct() -> dict[str, Any]:
    """Return mean and scatter over six surfaces at the pressures, by size: lists by quantity and pressure."""
    found = {}
    for size, (ratio, waves) in _SIZES.items():
        every = np.array([list(_pressed(scaled(each))) for each in surfaces(ratio, 6, waves)])
        pairs = np.stack([every.mean(axis=0), every.std(axis=0, ddof=1)], axis=-1)
        found[size] = np.swapaxes(pairs, 0, 1).tolist()
    return found


def grids() -> list[dict[str, Any]]:
    """Return the numbers of one surface on its pixels and on those of half their size."""
    rough, rows = scaled(surfaces(16.0, 1)[0]), []
    for k in (1, 2):
        fine = finer(rough, k)
        rows += [
            {"pixels": len(fine.heights), "p_c": p, "values": values(press(fine, p, MODULUS))}
            for p in (5e3, 20e3, 100e3)
        ]
    return rows


def adhesive() -> list[dict[str, Any]]:
    """Return contact pressure, attraction and area under 20 kPa where attraction deforms, and where it does not."""
    fine, h_0, rows = scaled(surfaces(16.0, 1, 2)[0]), Scene().h_0, []
    rough = HeightMap(fine.heights[::2, ::2], fine.size)  # four pixels to the shortest wave, as in the tables
    for in_contact, voltages in CHARGED.items():
        for voltage in voltages:
            row: dict[str, Any] = {"in_contact": in_contact, "voltage": voltage}
            for deforms in (False, True):
                try:
                    found = pressed(rough, P_EXT, MODULUS, h_0, voltage, in_contact, deforms)._asdict()
                except NoContactError:
                    found = None
                row["deforms" if deforms else "rigid"] = found
            rows.append(row)
    return rows


def finer(surface: HeightMap, k: int) -> HeightMap:
    """Return the same surface on k times the pixels along each side, a number of pixels that is even."""
    n = len(surface.heights)
    modes = np.fft.ifftshift(np.pad(np.fft.fftshift(np.fft.fft2(surface.heights)), n * (k - 1) // 2))
    return HeightMap(np.fft.ifft2(modes).real * k**2, surface.size)
