"""Persson's theory as a closure: spectrum, separation and distribution of gaps beside their integrals; refusals."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf

import fingerpad as fp
from tests.test_microscale_closures import CLOSURES, H_0, PRESSURES
from variational.roughness import persson


def test_spectrum_of_persson():
    """Mean square height and slope are its integrals, by quadrature."""
    spectrum = persson.Spectrum(0.7, 20.0)
    exponent = -2 - 2 * 0.7
    height = quad(lambda q: 2 * np.pi * q * spectrum.level * q**exponent, 1, 20)[0]
    slope = quad(lambda q: 2 * np.pi * q**3 * spectrum.level * q**exponent, 1, 7)[0]
    assert height == pytest.approx(1) == spectrum.height(np.array(1.0))
    assert spectrum.slope_squared(np.array(7.0)) == pytest.approx(slope)


def test_separation_of_persson():
    """The double integral at the whole area, by adaptive quadrature of both, to 1e-4 of it."""
    spectrum, p, gamma = persson.Spectrum(0.75, 16.0), 0.05, 0.45

    def inner(x: float) -> float:
        return quad(lambda z: (gamma + 3 * (1 - gamma) * erf(np.exp(z)) ** 2) * np.exp(-np.exp(2 * z)), np.log(x), 2)[0]

    def outer(t: float) -> float:
        q = np.exp(t**2)
        w = np.sqrt(2 / spectrum.slope_squared(np.array(q)))
        return float(spectrum.level * q ** (1 - 1.5) * w * inner(w * p) * 2 * t)

    exact = np.sqrt(np.pi) * quad(outer, 1e-6, np.sqrt(np.log(16)), epsrel=1e-8)[0]
    found = persson.separation(np.array([p]), spectrum, np.array([1.0]))[0, 0]
    assert found == pytest.approx(exact, rel=1e-4)


def test_mean_separation_of_persson():
    """That of Yang and Persson at the nodes, and within 10 % of exact contacts between 5 and 100 kPa.

    The mean of the folded distributions is 28 % larger than that of exact contacts at 100 kPa.
    """
    closure, table = CLOSURES["persson"], persson.table_of(0.75, 16.0)
    exact = persson.separation(table.pressure, persson.Spectrum(0.75, 16.0), np.array([1.0]))[:, 0]
    inside = slice(5, -1)
    found = closure.statistics(table.pressure[inside] * closure.unit_pressure).u_bar
    np.testing.assert_allclose(found, exact[inside] * closure.h_rms, rtol=1e-9)
    known = CLOSURES["boundary elements"].statistics(PRESSURES).u_bar
    np.testing.assert_allclose(closure.statistics(PRESSURES).u_bar, known, rtol=0.1)
    mean = (table.weight * table.mean).sum(axis=-1)[0]
    assert np.interp(1e5 / closure.unit_pressure, table.pressure, mean) * closure.h_rms > 1.2 * known[-1]


def test_distribution_of_persson():
    """All of the area is in contact or in a bin, and contact is proportional to small pressures, 1.6 p / (E* slope)."""
    table = persson.table_of(0.75, 16.0)
    np.testing.assert_allclose(table.area + table.weight.sum(axis=-1), 1, rtol=1e-9)
    slope = np.sqrt(persson.Spectrum(0.75, 16.0).slope_squared(np.array(16.0)))
    assert table.area[0, 0] == pytest.approx(np.sqrt(8 / np.pi) * table.pressure[0] / slope, rel=1e-4)


@pytest.mark.parametrize("hurst", [0.6, 0.65, 0.75, 0.8, 0.9])
def test_persson_is_near_boundary_elements(hurst):
    """Air gaps within 30 %: between 5 and 100 kPa, theory and contacts of six surfaces."""
    gaps = [law(H_0, hurst=hurst)(PRESSURES).d_eq for law in (fp.Persson, fp.BoundaryElements)]
    np.testing.assert_allclose(*gaps, rtol=0.3)


def test_persson_needs_shorter_waves():
    with pytest.raises(fp.SceneError, match="roughness.shortest_wave is 9e-05 m; it must be below two thirds"):
        fp.Scene(roughness={"law": "Persson", "shortest_wave": 90e-6})
