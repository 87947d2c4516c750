r"""Rough contact by theory and by table: Persson's diffusion and energy, and numbers of another program.

**Area.** In Persson's theory (2001, doi 10.1063/1.1388626) the distribution of pressures P diffuses as waves are added,

.. math:: \frac{\partial P}{\partial t} = \frac12 \frac{\partial^2 P}{\partial p^2}, \qquad P(0, t) = 0, \qquad
          t = (E^* s / 2)^2,

with s the rms slope, from one pressure on; what is left of it is the area in contact. Here it is followed as a random
walk on a lattice. **Separation.** The elastic energy of a unit of area is

.. math:: U = \frac{\pi E^*}{2} \int q^2 C(q) A \left[ \gamma + (1 - \gamma) A^2 \right] dq, \qquad
          p = -\frac{dU}{d\bar u},

with A the area in contact where waves up to q are seen (Yang and Persson 2008, doi 10.1088/0953-8984/20/21/215214).
Differences of the separation between pressures follow from differences of U. **Tables.** The program ContactMechanics
pressed surfaces of the same spectrum; its means and scatter over six of them were computed apart from this package.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.special import erf

from benchmarks.microscale import contacts
from benchmarks.verification.case import Case, Row
from fingerpad.scene import Scene
from variational.roughness.boundary_elements import BoundaryElements
from variational.roughness.persson import Spectrum, contact_area, separation

Array = NDArray[np.float64]
_HURST, _RATIO, _GAMMA = 0.75, 16.0, 0.45
_SPECTRUM = Spectrum(_HURST, _RATIO)


def _slope_squared(q: Array) -> Array:
    """Return the mean square slope of waves from 1 to q, by the trapezoidal rule, of an rms height of 1."""
    x = np.geomspace(1.0, q[-1], 200001)
    density = x ** (-1 - 2 * _HURST)  # q C, of which the mean square height is the integral
    density /= np.trapezoid(density, x)
    return np.interp(q, x, cumulative_trapezoid(x**2 * density, x, initial=0.0))


def _walked(pressure: float, variance: float, steps: int) -> float:
    """Return what is left of a random walk from a pressure, absorbed at 0."""
    jump = np.sqrt(variance / steps)
    sites = np.zeros(int(pressure / jump + 8 * np.sqrt(steps)) + 2)
    start = pressure / jump
    sites[int(start)], sites[int(start) + 1] = 1 - start % 1, start % 1
    for _ in range(steps):
        moved = np.zeros_like(sites)
        moved[1:] += sites[:-1] / 2
        moved[:-1] += sites[1:] / 2
        moved[0] = 0.0
        sites = moved
    return float(sites.sum())


def theory(small: bool) -> list[Row]:
    """Area in contact by a walk of the pressure, and separation by the elastic energy."""
    q = np.array([_RATIO])
    variance = float(_slope_squared(q)[0]) / 4
    rows, steps = [], 4000
    why = "a step of the walk beside the pressure, squared"
    for pressure in (0.05, 0.5):
        area_left = float(contact_area(np.array([pressure]), _SPECTRUM, q)[0, 0])
        walked = _walked(pressure, variance, steps)
        rows.append(
            Row(f"area in contact at {pressure:g} E* q_0 h_rms", area_left, walked, 5e-3, why, f"{steps} steps")
        )
    p: Array = np.geomspace(0.02, 0.5, 2001, dtype=np.float64)
    x: Array = np.geomspace(1.0 + 1e-9, _RATIO, 4001, dtype=np.float64)
    level = x ** (-2 - 2 * _HURST)
    level /= 2 * np.pi * np.trapezoid(x * level, x)
    area = erf(np.sqrt(2) * p[:, None] / np.sqrt(_slope_squared(x)))
    energy = np.pi / 2 * np.trapezoid(x**2 * level * area * (_GAMMA + (1 - _GAMMA) * area**2), x, axis=1)
    fallen = float((np.diff(energy) / np.sqrt(p[1:] * p[:-1])).sum())
    ours = separation(p[[0, -1]], _SPECTRUM, np.array([1.0 + 1e-12]))[:, 0]
    why = "quadratures over 4001 waves and 2001 pressures"
    rows.append(
        Row("fall of the separation, 0.02 to 0.5 E* q_0 h_rms, over h_rms", ours[0] - ours[1], fallen, 2e-3, why)
    )
    return rows


def tables(small: bool) -> list[Row]:
    """Air gaps of the default closure's table, with a field in contact and without, and the area in contact."""
    h_0, rows = Scene().h_0, []
    laws = [BoundaryElements(h_0), BoundaryElements(h_0, field_in_contact=False)]
    p, known = np.array(contacts.PRESSURES), contacts.KNOWN["wide"]
    found = [*(1e6 * law(p).d_eq for law in laws), laws[0].statistics(p).area]
    words = ("air gap (µm)", "air gap without field in contact (µm)", "area in contact")
    for ours, theirs, quantity in zip(found, known, words, strict=False):
        for k in (0, 2, 4):
            mean, scatter = theirs[k]
            assert scatter is not None  # of the wide surfaces all are known
            why = "scatter of one surface in that program"
            rows.append(Row(f"{quantity}, {p[k] / 1e3:g} kPa", float(ours[k]), mean, scatter, why, absolute=True))
    return rows


CASES = (
    Case("Persson's theory", "Persson 2001 as a random walk; Yang and Persson 2008 by the energy", theory),
    Case("Tables of boundary elements", "ContactMechanics, github.com/ContactEngineering/ContactMechanics", tables),
)
