"""The bearing area model against the numbers of the paper and of independent evaluations."""

import subprocess
import sys

import numpy as np
import pytest

from variational.roughness.bam import BearingArea

H_0 = 425e-6 / 1650 + 1e-6 / 3.9
UM, KPA = 1e-6, 1e3


@pytest.fixture
def bam() -> BearingArea:
    return BearingArea(H_0)


def test_least_air_gap(bam):
    """Eq. 14 prints 1.49 um at zero separation; the true minimum lies at h_0 / 2. Tolerance: printed digits."""
    assert bam.air_gap(0.0) == pytest.approx(1.489 * UM, abs=0.5e-9)
    u = np.linspace(0, 2 * UM, 20001)
    d = bam.air_gap(u)
    assert d.min() == pytest.approx(1.486 * UM, abs=0.5e-9)
    assert u[d.argmin()] == pytest.approx(H_0 / 2, abs=1e-9)


@pytest.mark.parametrize(
    ("u_bar", "d_eq"), [(0, 1.489), (2, 1.650), (3, 1.917), (4, 2.363), (5, 3.071), (6, 4.193), (8, 8.97)]
)
def test_air_gap_over_separation(bam, u_bar, d_eq):
    """Tolerance: half of the last digit given."""
    assert bam.air_gap(u_bar * UM) == pytest.approx(d_eq * UM, abs=(5e-9 if u_bar == 8 else 0.6e-9))


def test_thresholds(bam):
    """Eq. 15 gives 155.2 V; minimising Eq. 9 gives 163.6 V with its own prefactor, 141.7 V with 3/4 of it."""
    assert bam.threshold(approximate=True) == pytest.approx(155.2, abs=0.06)
    assert bam.threshold() == pytest.approx(163.6, abs=0.05)
    assert BearingArea(H_0, beta=0.75).threshold() == pytest.approx(141.7, abs=0.05)


def test_folds_at_200_volts(bam):
    """Pull-off at u_bar = 4.95 um, d_eq = 3.03 um, p_ext = -3.46 kPa; none below 155.5 V."""
    fold = bam.pull_off_fold(200.0)
    assert fold == pytest.approx(4.95 * UM, abs=0.005 * UM)
    assert bam.air_gap(fold) == pytest.approx(3.03 * UM, abs=0.005 * UM)
    assert bam.external_pressure(fold, 200.0) == pytest.approx(-3.46 * KPA, abs=5)
    assert bam.contact_pressure(fold) == pytest.approx(10.7 * KPA, abs=50)
    assert bam.pull_off_fold(155.0) is None
    assert bam.pull_off_fold(156.0) == pytest.approx(2.5 * bam.h_rms, rel=0.05)


@pytest.mark.parametrize(
    ("voltage", "expected"), [(0, (4.37, 2.348, 1.565)), (100, (3.508, 2.135, 1.546)), (200, (1.981, 1.742, 1.509))]
)
def test_air_gap_over_external_pressure(bam, voltage, expected):
    """At 5, 20 and 100 kPa; tolerance: half of the last digit given."""
    for p_ext, d_eq in zip((5, 20, 100), expected, strict=True):
        tolerance = 5e-9 if d_eq == 4.37 else 0.6e-9
        assert bam.air_gap_at_external(p_ext * KPA, voltage) == pytest.approx(d_eq * UM, abs=tolerance)


@pytest.mark.parametrize(
    ("p_ext", "voltage", "d_eq", "mu_app"),
    [(10, 100, 2.67, 0.359), (20, 150, 1.93, 0.459), (30, 200, 1.67, 0.560), (50, 50, 1.76, 0.261)],
)
def test_apparent_friction_of_a_uniform_ridge(bam, p_ext, voltage, d_eq, mu_app):
    """mu_app = mu_0 (1 + p_el / p_ext), keyed on p_c = p_ext + p_el; tolerance: the digits given."""
    p_el = 0.0
    for _ in range(200):
        gap = float(bam(p_ext * KPA + p_el).d_eq)
        p_el = 8.854e-12 * voltage**2 / 2 / (H_0 + gap) ** 2
    assert gap == pytest.approx(d_eq * UM, abs=0.6e-8)
    assert 0.25 * (1 + p_el / (p_ext * KPA)) == pytest.approx(mu_app, abs=6e-4)


def test_derivative(bam):
    """Central differences of step 1e-4 relative leave an error of 1e-8 times the third derivative's scale."""
    p = np.array([2e3, 1e4, 5e4, 2e5])
    step = 1e-4 * p
    numeric = (bam(p + step).d_eq - bam(p - step).d_eq) / (2 * step)
    np.testing.assert_allclose(bam(p).derivative, numeric, rtol=1e-6)


def test_ends_are_held_and_named(bam):
    assert bam(0.0).d_eq == bam(bam.p_floor).d_eq == pytest.approx(11.8 * UM, abs=0.05 * UM)
    assert bam(1e6).d_eq == bam.air_gap(0.0)
    assert bam(0.0).derivative == bam(1e6).derivative == 0
    assert bam.full_pressure == pytest.approx(259.7 * KPA, abs=50)
    assert [bam.state(p, 200.0) for p in (0, 500, 5e3, 5e4, 3e5)] == [
        "", "below p_floor", "past the fold", "", "beyond zero separation",
    ]  # fmt: skip


def test_no_equilibrium_is_an_error(bam):
    with pytest.raises(ValueError, match="p_ext is -4000 Pa; at 200 V"):
        bam.air_gap_at_external(-4e3, 200.0)


def test_imports_without_dolfinx():
    """The microscale is a plain Python module: importing it must not pull in dolfinx or PETSc."""
    code = (
        "import sys; import variational.roughness.bam; "
        "sys.exit(any(m in sys.modules for m in ('dolfinx', 'petsc4py', 'mpi4py', 'ufl')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
