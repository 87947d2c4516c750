"""What branches of viscous layers dissipate: at held strain, in an oscillation, of a law whose sign is wrong."""

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.model.state import least_dissipation
from geometry.bodies import block
from geometry.mesh import load
from tests.test_viscoelastic import HEIGHT, LAW, MOUSE, Strained, over, sheared
from variational.materials.neo_hooke import NeoHooke
from variational.materials.qlv import QLV
from variational.materials.viscoelastic import Viscoelastic

pytestmark = pytest.mark.mpi
AREA = 1e-3 * HEIGHT  # m^2, of the block


@pytest.fixture(scope="module")
def body():
    """A block of 4 x 2 x 2 cells on the screen."""
    return load(MPI.COMM_WORLD, block(1e-3, HEIGHT, 0.25e-3))


def lost(strained: Strained) -> np.ndarray:
    """Return what each branch lost in the last step (J/m^3), the same at all points."""
    found = strained.layers.lost
    np.testing.assert_allclose(found, np.broadcast_to(found[:1, :1], found.shape), atol=1e-9 * np.abs(found).max())
    return np.asarray(found[0, 0])


@pytest.mark.parametrize("element", ["P1", "P2", "P3"])
def test_held_strain(body, element):
    """At a held strain each branch loses exp(-2 t / tau) of its energy, whatever the steps. Tolerance: roundoff."""
    strained = Strained(over(body, element=element).problem)
    strained.to(sheared(-0.05, 0.08), 0.0)
    np.testing.assert_array_equal(lost(strained), 0.0)  # a jump takes no time
    before = strained.value("branch energies")
    assert (before > 0).all()
    whole = np.zeros(2)
    for lapse in (0.003, 0.04, 0.2, 0.01):
        strained.to(sheared(-0.05, 0.08), lapse)
        whole += lost(strained)
        assert strained.problem.spent()[1] == pytest.approx(AREA * lost(strained).sum(), rel=1e-9)
    expected = before * -np.expm1(-2 * 0.253 / np.array(MOUSE.times))
    np.testing.assert_allclose(whole, expected, rtol=1e-10)
    np.testing.assert_allclose(before - strained.value("branch energies"), expected, rtol=1e-10)


@pytest.mark.slow
def test_oscillation(body):
    """A period of a small shear dissipates pi G'' times the square of its amplitude, and does as much work.

    The work is that of the trapezoidal rule. Tolerance: 5e-3. The second-order error of 60 steps a period is up to
    (2 pi / 60)^2 / 4 = 3e-3; after 6 s the branch of 1.1 s has exp(-6 / 1.1) = 0.4 % left of where it began, in a part
    of the loss of less than a tenth.
    """
    strained, amplitude, steps, frequency = (
        Strained(over(body, Viscoelastic(NeoHooke(1e3), MOUSE)).problem), 1e-4, 60, 1.0,
    )  # fmt: skip
    periods = 7
    whole, work = 0.0, 0.0
    for k in range(1, periods * steps + 1):
        F = np.eye(2) + np.array([[0, amplitude * np.sin(2 * np.pi * k / steps)], [0, 0]])
        if k == (periods - 1) * steps + 1:
            begun, work = float(strained.value("branch energies").sum()), float(strained.value("viscous work")[0])
        strained.to(F, 1 / frequency / steps)
        if k > (periods - 1) * steps:
            whole += lost(strained).sum()
            assert (lost(strained) >= 0).all()
    G = 1e3 / (1 - sum(MOUSE.moduli))
    closed = np.pi * G * MOUSE.complex_modulus(frequency).imag * amplitude**2
    assert whole == pytest.approx(closed, rel=5e-3)
    stored = float(strained.value("branch energies").sum()) - begun
    assert float(strained.value("viscous work")[0]) - work - stored == pytest.approx(closed, rel=5e-3)


@pytest.mark.parametrize("wrong", ["moduli", "times"])
def test_wrong_sign(body, wrong):
    """A branch whose weight or time has the wrong sign makes energy, and is seen; of the right one none does."""
    law = QLV(MOUSE.moduli, MOUSE.times)
    values = getattr(law, wrong)
    for sign in (1.0, -1.0):
        object.__setattr__(law, wrong, (sign * values[0], values[1]))
        made = over(body, Viscoelastic(LAW.elastic, law))
        strained = Strained(made.problem)
        strained.to(sheared(-0.05, 0.08), 0.0)
        strained.to(sheared(-0.05, 0.08), 0.02)
        least = least_dissipation(made.continuation)
        assert least >= 0.0 if sign > 0 else least < -1e-3
