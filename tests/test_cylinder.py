"""A charged cylinder against Hertz, Maugis and the closure's scalar equation.

Roots are found to 1e-12 of the pressure; where no other tolerance is named, 1e-9 is what that leaves of forces and
lengths, well above roundoff.
"""

import numpy as np
import pytest
from scipy.integrate import quad

from benchmarks.verification.adhesion import maugis_force, maugis_ratio
from benchmarks.verification.microscale import H_0, air_gap_at_external, scalar
from variational.attraction.cylinder import Cylinder, NoEquilibriumError
from variational.attraction.tip import Round
from variational.roughness.bam import BearingArea
from variational.roughness.closure import AirGap, Closure

EPS_0, RADIUS, MODULUS, VOLTAGE = 8.854e-12, 118e-6, 330e3, 200.0


class Held(Closure):
    """A microscale with one air gap."""

    def __init__(self, d_eq: float) -> None:
        self.d_eq = d_eq

    def __call__(self, p_c):
        return AirGap(np.full_like(np.asarray(p_c, dtype=float), self.d_eq))


class Wide(Round):
    """A contact ten metres wide, whatever it bears."""

    power = 1e12

    def alone(self, modulus, f):
        return np.full_like(f, 5.0)


def ridge(closure=None) -> Cylinder:
    return Cylinder(Round(RADIUS), MODULUS, H_0, closure or BearingArea(H_0))


@pytest.mark.parametrize("f", [0.01, 1.0, 10.0])
def test_uncharged_cylinder_is_hertz(f):
    """f = pi E* a^2 / 4R, and the modulus of a tip is its inverse."""
    state = ridge().under_loads([f], 0.0)[0]
    assert state.length == pytest.approx(2 * np.sqrt(4 * RADIUS * f / (np.pi * MODULUS)), rel=1e-9)
    assert state.p_c == pytest.approx(f / state.length, rel=1e-9)
    assert state.f_attraction == 0
    assert Round(RADIUS).modulus(f, state.length) == pytest.approx(MODULUS, rel=1e-9)


@pytest.mark.parametrize("f", [0.01, 1.0, 10.0])
def test_charged_cylinder_is_maugis(f):
    """At one air gap, force and attracted length are those of a constant attraction of its strength and range."""
    d_eq = 1.7e-6
    state = ridge(Held(d_eq)).under_loads([f], VOLTAGE)[0]
    sigma, a = EPS_0 * VOLTAGE**2 / 2 / (H_0 + d_eq) ** 2, state.length / 2
    m = maugis_ratio(a, RADIUS, MODULUS, sigma, H_0 + 2 * d_eq)
    assert state.attracted == pytest.approx(2 * m * a, rel=1e-9)
    assert maugis_force(a, RADIUS, MODULUS, sigma, H_0 + 2 * d_eq) == pytest.approx(f, rel=1e-9)
    assert state.f_attraction == pytest.approx(sigma * state.attracted, rel=1e-9)


def test_range_keeps_the_work_of_adhesion():
    """The attraction from contact to infinity does the work sigma (h_0 + 2 d_eq); quadrature's tolerance is 1e-8."""
    d_eq = 1.7e-6
    scaled, _ = quad(lambda y: 1 / (H_0 / 1e-6 + max(y, d_eq / 1e-6)) ** 2, 0, np.inf, limit=200, epsrel=1e-10)
    assert scaled * 1e-6 == pytest.approx((H_0 + 2 * d_eq) / ((H_0 + d_eq) / 1e-6) ** 2, rel=1e-7)


@pytest.mark.parametrize("voltage", [50.0, 100.0, 200.0])
@pytest.mark.parametrize("p_ext", [10e3, 50e3])
def test_wide_contact_is_the_closure_table(p_ext, voltage):
    """Of a contact ten metres wide the ends do not matter: p_c = p_ext + sigma(d_eq(p_c)).

    Tolerance: the attraction reaches (delta R / a^2)^(2/3) = 4e-8 of the width beyond the ends; the gain of the loop
    over the scales makes that some times larger.
    """
    (state,) = Cylinder(Wide(RADIUS), MODULUS, H_0, BearingArea(H_0)).under_loads([10 * p_ext], voltage)
    d_eq, p_c, _ = scalar(p_ext, voltage)
    assert state.d_eq == pytest.approx(d_eq, rel=1e-6)
    assert state.p_c == pytest.approx(p_c, rel=1e-6)


@pytest.mark.parametrize("voltage", [0.0, 100.0, 200.0])
def test_modulus_that_grows_with_pressure(voltage):
    """The state is that of the constant modulus which it has at its own pressure."""
    forces, growth = [0.1, 3.0], 4.0
    grown = Cylinder(Round(RADIUS), MODULUS, H_0, BearingArea(H_0), lambda p_c: growth * p_c)
    for f, state in zip(forces, grown.under_loads(forces, voltage), strict=True):
        modulus = MODULUS + growth * state.p_c
        same = Cylinder(Round(RADIUS), modulus, H_0, BearingArea(H_0)).under_loads([f], voltage)[0]
        assert (state.length, state.p_c) == pytest.approx((same.length, same.p_c), rel=1e-9)
        assert state.length < ridge().under_loads([f], voltage)[0].length


def test_branch_in_contact_is_taken_and_the_others_are_named():
    """Near 0.05 kPa and 200 V a flat ridge has three states; the one in contact has the smallest air gap.

    Tolerance as for the wide contact.
    """
    closure = BearingArea(H_0, p_floor=1.0)
    (state,) = Cylinder(Wide(RADIUS), MODULUS, H_0, closure).under_loads([500.0], VOLTAGE)
    assert state.d_eq == pytest.approx(air_gap_at_external(closure, 50.0, VOLTAGE), rel=1e-6)
    assert len(state.others) == 2
    assert max(state.others) < closure.contact_pressure(closure.pull_off_fold(VOLTAGE)) < state.p_c


@pytest.mark.parametrize("voltage", [1e4, 1e6, 1e9])
def test_absurd_voltage_is_refused(voltage):
    """In one sentence."""
    with pytest.raises(NoEquilibriumError) as refusal:
        ridge().under_loads([1.0], voltage)
    assert len(str(refusal.value)) < 300
