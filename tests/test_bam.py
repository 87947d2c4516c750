"""The bearing area model: derivative, ends, errors; its numbers are in benchmarks/verification/microscale.py.

Known answers are computed in 30 digits, so that a tolerance of 1e-12 is roundoff's and what differences amplify of it.
"""

import numpy as np
import pytest

from benchmarks.verification import bearing_area as exact
from variational.roughness.bam import BearingArea

H_0 = float(exact.H_0)


@pytest.fixture
def bam() -> BearingArea:
    return BearingArea(H_0)


def test_no_fold_at_low_voltage(bam):
    """p_ext(u_bar) turns first at 155.47 V, at a separation of 2.50 h_rms; at more there is a fold nearer.

    It moves with the root of the voltage's excess: by 0.7 % for 1e-4, nine of the places at which it is looked for.
    """
    u_bar, voltage = map(float, exact.first_turn())
    assert bam.pull_off_fold((1 - 1e-9) * voltage) is None
    found = bam.pull_off_fold((1 + 1e-4) * voltage)
    assert found == pytest.approx(float(exact.turn((1 + 1e-4) * voltage, 0.99 * u_bar)), rel=1e-12, abs=0)


def test_derivative(bam):
    """The slope of d_eq over p_c, by differentiation in 30 digits."""
    u_bar = np.array([0.5e-6, 2e-6, 5e-6, 7.5e-6])
    slopes = [float(exact.slope(u)) for u in u_bar]
    np.testing.assert_allclose(bam(bam.contact_pressure(u_bar)).derivative, slopes, rtol=1e-12)


def test_ends_are_held_and_named(bam):
    """Beyond either end d_eq is that of the end."""
    assert bam(0.0).d_eq == bam(bam.p_floor).d_eq == pytest.approx(float(exact.held(1000)), rel=1e-12, abs=0)
    assert bam(1e6).d_eq == bam.air_gap(0.0)
    assert bam(0.0).derivative == bam(1e6).derivative == 0
    assert [bam.state(p, 200.0) for p in (0, 500, 5e3, 5e4, 3e5)] == [
        "", "below p_floor", "past the fold", "", "beyond zero separation",
    ]  # fmt: skip


def test_thick_insulators_are_named_where_the_air_gap_rises_with_pressure():
    """From the least d_eq on, at a mean separation of half of h_0; a thin insulator's is next to zero separation."""
    thick = BearingArea(10 * 1e-6)
    turn = float(thick.contact_pressure(5e-6))
    assert thick.state(0.99 * turn, 0.0) == ""
    assert "rises with pressure" in thick.state(1.01 * turn, 0.0)
    gaps = thick(turn * np.array([0.9, 1.0, 1.1])).d_eq
    assert gaps[1] < gaps[0] and gaps[1] < gaps[2]


@pytest.mark.parametrize("h_rms", [1e-6, 1e-4, 1e-3])
def test_threshold_of_any_roughness(h_rms):
    """The least p_ext is zero at it, to roundoff of p_c from below and, sampled a thousandth of h_rms beside, above."""
    bam = BearingArea(H_0, h_rms=h_rms)
    u_bar, voltage = np.linspace(0, 8 * h_rms, 4001), bam.threshold()
    least = (bam.external_pressure(u_bar, voltage) / bam.contact_pressure(u_bar)).min()
    assert -1e-12 < least < 1e-5


@pytest.mark.parametrize(("h_0", "h_rms", "gamma"), [(30e-6, 3.1e-6, 0.5), (1e-6, 3e-6, 0.1), (5e-6, 0.5e-6, 0.4)])
def test_threshold_with_thick_insulators_or_a_short_decay(h_0, h_rms, gamma):
    """Where p_c and attraction both are tiny: the least of their ratio over a million separations, to its spacing's
    square. The fold at twice the threshold is nearer.
    """
    bam = BearingArea(h_0, h_rms=h_rms, gamma=gamma)
    u_bar = np.linspace(0, h_0 + 30 * h_rms, 1_000_001)[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = bam.contact_pressure(u_bar) / bam.attraction(u_bar, 1.0)
    assert bam.threshold() == pytest.approx(np.sqrt(np.nanmin(ratio)), rel=1e-6, abs=0)
    least = float(u_bar[np.nanargmin(ratio)])
    assert bam.pull_off_fold(bam.threshold() / 2) is None
    fold = bam.pull_off_fold(1.2 * bam.threshold())
    assert fold is not None and h_0 / 2 < fold < least
    p_ext = bam.external_pressure(np.array([0.999, 1.0, 1.001]) * fold, 1.2 * bam.threshold())
    assert p_ext[1] < p_ext[0] and p_ext[1] < p_ext[2]


@pytest.mark.parametrize("gamma", [0.4, 0.5])
@pytest.mark.parametrize("key", ["h_0", "h_rms", "young"])
def test_sticking_voltage_rises_with_insulator_roughness_and_modulus(key, gamma):
    """Over its whole range, five decades of which are asked for; outside, where it would fall, there is none."""
    first = {"h_0": 1e-8, "h_rms": 1e-8, "young": 1e4}[key]
    closures = [BearingArea(**{"h_0": H_0, "gamma": gamma} | {key: v}) for v in np.geomspace(first, 1e5 * first, 101)]
    found = [closure.sticking_voltage() for closure in closures]
    known = np.array([voltage for voltage in found if voltage is not None])
    assert len(known) > 40 and (np.diff(known) > 0).all()
    assert {closure.h_0 <= 1.5 * gamma * closure.h_rms for closure, v in zip(closures, found, strict=True) if v} == {
        True
    }
    assert key == "young" or None in found
