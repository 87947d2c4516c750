"""Closures by tables of gaps and by Persson's theory, against independent numbers and integrals."""

import re

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import erf

import fingerpad as fp
from variational.roughness import persson
from variational.roughness.gaps import breakdown_voltage, breaking_gaps

H_0 = 0.514e-6
PRESSURES = np.array([5e3, 10e3, 20e3, 50e3, 100e3])
# Computed by other code: periodic half-space, 4 x 4 lambda_0, 256^2, six surfaces, mean and scatter of one (µm).
EVERYWHERE = (1.98, 0.08), (1.41, 0.04), (0.967, 0.030), (0.532, 0.017), (0.300, 0.013)
OUTSIDE = (2.69, 0.11), (2.10, 0.07), (1.65, 0.05), (1.18, 0.03), (0.960, 0.018)
AREA = (0.0167, 0.0013), (0.0331, 0.0014), (0.0640, 0.0026), (0.150, 0.005), (0.277, 0.010)
GAP = (5.60, 0.13), (4.69, 0.10), (3.71, 0.08), (2.35, 0.07), (1.37, 0.08)
CLOSURES = {
    "boundary elements": fp.BoundaryElements(H_0),
    "outside": fp.BoundaryElements(H_0, field_in_contact=False),
    "between": fp.BoundaryElements(H_0, shortest_wave=4e-6),
    "hurst": fp.BoundaryElements(H_0, hurst=0.825),
    "persson": fp.Persson(H_0),
    "bearing area": fp.BearingArea(H_0),
}
each_closure = pytest.mark.parametrize("closure", CLOSURES.values(), ids=CLOSURES)


@pytest.mark.parametrize(
    ("found", "known"),
    [
        (CLOSURES["boundary elements"](PRESSURES).d_eq * 1e6, EVERYWHERE),
        (CLOSURES["outside"](PRESSURES).d_eq * 1e6, OUTSIDE),
        (CLOSURES["outside"].statistics(PRESSURES).area, AREA),
        (CLOSURES["outside"].statistics(PRESSURES).u_bar * 1e6, GAP),
    ],
    ids=["everywhere", "outside", "area", "gap"],
)
def test_independent_numbers(found, known):
    """Within the scatter of one surface, which is more than twice that of the mean of either six."""
    for value, (mean, scatter) in zip(found, known, strict=True):
        assert abs(value - mean) <= scatter


def test_spread_is_of_the_order_of_the_independent_one():
    """A standard deviation of six is good to a third: within a factor of two."""
    found = CLOSURES["boundary elements"].spread(PRESSURES) * 1e6
    for value, (_, scatter) in zip(found, EVERYWHERE, strict=True):
        assert scatter / 2 < value < 2 * scatter
    assert not CLOSURES["persson"].spread(PRESSURES).any()


@each_closure
def test_slopes(closure):
    """Against central differences, to their error of 1e-8 and what roundoff makes of it; across nodes, too."""
    p, step = np.geomspace(1.5e3, 2e5, 101), 1e-5
    more, less, here = (closure.statistics(p * factor) for factor in (1 + step, 1 - step, 1.0))
    for name in ("area", "u_bar", "inverse_square", "d_eq"):
        difference = (getattr(more, name) - getattr(less, name)) / (2 * step * p)
        scale = np.abs(getattr(here, name)) / p
        assert np.max(np.abs(difference - getattr(here.slopes, name)) / scale) < 1e-6
    np.testing.assert_array_equal(closure(p).derivative, here.slopes.d_eq)


@pytest.mark.parametrize("name", ["boundary elements", "between", "hurst", "persson"])
def test_monotone(name):
    """Contact grows, gaps close, at ten thousand pressures: no oscillation between the nodes."""
    found = CLOSURES[name].statistics(np.geomspace(1.01e3, 5e5, 10_000))
    assert (np.diff(found.area) > 0).all() and (np.diff(found.u_bar) < 0).all() and (np.diff(found.d_eq) < 0).all()


@each_closure
def test_pressures_outside_are_refused_by_statistics_and_held_by_the_closure(closure):
    low, high = closure.pressures
    for p in (low / 2, high * 2):
        with pytest.raises(ValueError, match=re.escape(f"contact pressure is {p:g} Pa; {type(closure).__name__} has ")):
            closure.statistics(p)
        assert closure.state(p, 0.0)
    assert closure(0.0).d_eq == pytest.approx(float(closure(low).d_eq), rel=1e-9)
    assert closure(high * 2).d_eq == pytest.approx(float(closure(high).d_eq), rel=1e-9)
    assert closure.state(2e4, 0.0) == ""


def test_self_similar():
    """Twice the height and the insulator, half the modulus: the same pressures, twice the gap, to roundoff."""
    other = fp.BoundaryElements(2 * H_0, h_rms=6.2e-6, young=0.5e6)
    np.testing.assert_allclose(other(PRESSURES).d_eq, 2 * CLOSURES["boundary elements"](PRESSURES).d_eq, rtol=1e-12)


@each_closure
def test_sticking(closure):
    """At this voltage the attraction exceeds the pressure by 1 kPa at one pressure, and just below it at none."""
    p = np.geomspace(*closure.pressures, 4001)
    d_eq, voltage = closure(p).d_eq, closure.sticking_voltage()
    pull = [(8.854e-12 * (part * voltage) ** 2 / 2 / (H_0 + d_eq) ** 2 - p).max() for part in (1.001, 0.999)]
    assert pull[0] > 1e3 > pull[1]


FLAT = (("bearing area", 150.0, 0.459), ("bearing area", 200.0, 0.685), ("boundary elements", 70.7, 0.44))


@pytest.mark.parametrize(("words", "voltage", "known"), FLAT)
def test_friction_of_a_flat_ridge(words, voltage, known):
    """Under an external pressure of 20 kPa, p_c = p_ext + attraction; 70.7 V is the effective value of 200 V in all."""
    law = CLOSURES[words]
    p_c = brentq(lambda p: p - 2e4 - 8.854e-12 * voltage**2 / 2 / (H_0 + float(law(p).d_eq)) ** 2, 2e4, 1e5)
    assert 0.25 * p_c / 2e4 == pytest.approx(known, rel=0.015)


def test_past_the_fold():
    """Where the attraction grows faster than the pressure, p_ext falls as p_c rises."""
    closure = CLOSURES["boundary elements"]
    p = np.geomspace(1.1e3, 3e5, 200)
    external = p - closure.attraction(p, 100.0)
    falls = np.gradient(external, p) < 0
    named = np.array([closure.state(float(each), 100.0) == "past the fold" for each in p])
    assert np.count_nonzero(falls != named) <= 2  # at the fold itself the difference is one of neighbours
    assert falls.any() and not falls.all()


def test_part_that_attraction_balances():
    """That of Eq. 3 at no gap, over the area in contact, beside the pressure; none without a field in contact."""
    closure = CLOSURES["boundary elements"]
    exact = 8.854e-12 * 70.0**2 / 2 / H_0**2 * closure.statistics(PRESSURES).area / PRESSURES
    np.testing.assert_allclose(closure.balanced(PRESSURES, -70.0), exact, rtol=1e-12)
    assert not CLOSURES["outside"].balanced(PRESSURES, 200.0).any()


# -- breakdown ---------------------------------------------------------------------------------------------
def test_gaps_that_break_down():
    """The voltage over the air of each is above what the air bears, by sampling; none at 100 V."""
    assert breaking_gaps(100.0, H_0) == []
    gap = np.geomspace(1e-10, 1e-4, 5000)
    for voltage in (200.0, -300.0, 400.0, 1000.0):
        breaks = abs(voltage) * gap / (H_0 + gap) > breakdown_voltage(gap)
        inside = np.zeros_like(breaks)
        for low, high in breaking_gaps(voltage, H_0):
            inside |= (gap > low) & (gap < high)
        np.testing.assert_array_equal(inside, breaks)


@each_closure
def test_share_that_breaks_down(closure):
    """None at 100 V, little at 200 V, more at 1 kV; with the contact never more than the whole area."""
    shares = [closure.statistics(2e4, voltage) for voltage in (100.0, 200.0, 1e3)]
    assert shares[0].broken_down == 0 < shares[1].broken_down < shares[2].broken_down
    assert shares[2].broken_down + shares[2].area <= 1 + 1e-9


@pytest.mark.parametrize("law", [fp.BearingArea, fp.BoundaryElements, fp.Persson])
def test_numbers_that_are_no_lengths(law):
    """In one sentence, and no number that is none is looked up as another one."""
    for name in ("h_0", "h_rms", "young", "p_floor"):
        for value in (0.0, -1e-6, np.inf, np.nan):
            with pytest.raises(ValueError, match=f"{name} of {law.__name__} is .*; it must be finite and greater"):
                law(**{"h_0": H_0} | {name: value})
    assert np.isnan(law(H_0)([np.nan, 1e4]).d_eq).tolist() == [True, False]
    with pytest.raises(ValueError, match=f"contact pressure is nan Pa; {law.__name__} has"):
        law(H_0).statistics([1e4, np.nan])


# -- persson's theory as a closure: spectrum, separation and distribution of gaps beside their integrals; refusals ---
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
