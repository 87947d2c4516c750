"""The bearing area model: derivative, ends, errors; its numbers are in benchmarks/verification/microscale.py."""

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


def test_no_fold_at_low_voltage(bam):
    """p_ext(u_bar) turns first at 155.5 V, at a separation of 2.5 h_rms.

    Tolerance: half a volt higher the fold, which moves with the root of the voltage's excess, is 4 % nearer.
    """
    assert bam.pull_off_fold(155.0) is None
    assert bam.pull_off_fold(156.0) == pytest.approx(2.5 * bam.h_rms, rel=0.05, abs=0)


def test_derivative(bam):
    """Central differences of step 1e-4 relative leave an error of 1e-8 times the third derivative's scale: 6e-8."""
    p = np.array([2e3, 1e4, 5e4, 2e5])
    step = 1e-4 * p
    numeric = (bam(p + step).d_eq - bam(p - step).d_eq) / (2 * step)
    np.testing.assert_allclose(bam(p).derivative, numeric, rtol=2e-7)


def test_ends_are_held_and_named(bam):
    """Beyond either end d_eq is that of the end. Tolerance: half the last digit of 11.8 um and of 259.7 kPa."""
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
