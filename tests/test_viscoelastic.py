"""Viscous layers: relaxation, creep, oscillation and dissipation against closed forms, and refusals."""

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fingerpad.model.state import least_dissipation
from geometry import tags
from geometry.bodies import block
from geometry.mesh import load
from variational import kinematics
from variational.body import Body
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.materials.neo_hooke import NeoHooke
from variational.materials.ogden import Ogden
from variational.materials.qlv import QLV
from variational.materials.viscoelastic import Viscoelastic
from variational.output import Receptors
from variational.problem import Problem
from variational.solvers.continuation import Target

pytestmark = pytest.mark.mpi
MOUSE = QLV((0.154, 0.495), (1.111, 0.092))
ELASTIC = Ogden(86.76e3, -14.53)
LAW = Viscoelastic(ELASTIC, MOUSE)
HEIGHT = 0.5e-3


@pytest.fixture(scope="module")
def body():
    """A block of 4 x 2 x 2 cells on the screen."""
    return load(MPI.COMM_WORLD, block(1e-3, HEIGHT, 0.25e-3))


def over(body, law=LAW, mu_f=0.0, element="P2", **more) -> Body:
    """Return a block over the screen whose sides do not move sideways."""
    interface = Interface(Penalty(), mu_f, 0.5e-6, None)
    solids = {tags.STRATUM_CORNEUM: law}
    return Body(body, solids, interface, element=element, held=body.facets(tags.SIDES), tolerance=1e-10, **more)


class Strained:
    """A body whose history follows a displacement that is prescribed everywhere, without a solve."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        ((group, self.law),) = problem.laws.items()
        F = kinematics.deformation_gradient(ufl.grad(problem.w))
        self._sigma = fem.Expression(kinematics.cauchy(self.law, F, 0.0), np.array([[0.2, 0.5]]))
        self.layers = problem.relaxations[group]
        self.fields = list(self.layers.fields.values())

    def to(self, F: np.ndarray, lapse: float) -> np.ndarray:
        """Take a step to a homogeneous F; return the Cauchy stress (Pa) without the volumetric part, (3, 3)."""
        problem = self.problem
        problem.w.interpolate(lambda x: (F - np.eye(2)) @ x[:2])
        problem.elapse(lapse)
        history = problem.history
        on_the_way = self.stress()
        history.accept({**history.accepted, **self.layers.left()})
        problem.elapse(0.0)
        np.testing.assert_allclose(self.stress(), on_the_way, atol=1e-12 * np.abs(on_the_way).max())
        return on_the_way

    def stress(self) -> np.ndarray:
        values = self._sigma.eval(self.problem.mesh, np.array([0], dtype=np.int32)).reshape(3, 3)
        return np.asarray(values)

    def value(self, name: str) -> np.ndarray:
        """Return the values of a field at all points, which are the same, as one."""
        field = next(each for each in self.fields if each.name.startswith(name))
        found = field.at_points(field.function.x.array)
        np.testing.assert_allclose(found, np.broadcast_to(found[0, 0], found.shape), atol=1e-9 * np.abs(found).max())
        return np.asarray(found[0, 0])


def sheared(a: float, b: float) -> np.ndarray:
    return np.array([[1 + a, b], [0.3 * b, 1 - 0.5 * a]])


# -- closed forms --------------------------------------------------------------------------------------
def test_relaxation_function():
    """Golden values of the mouse's set, computed apart. Tolerance: their four digits."""
    times = [0.01, 0.05, 0.092, 0.2, 0.5, 1, 2, 5]
    expected = [0.9476, 0.7857, 0.6749, 0.5359, 0.4513, 0.4136, 0.3765, 0.3527]
    np.testing.assert_allclose(MOUSE.relaxation(times), expected, atol=5.1e-5)


@pytest.mark.parametrize("element", ["P1", "P2", "P2 reduced", "P2-P1", "P3"])
def test_stress_relaxes(body, element):
    """After a step of strain the stress falls as G(t), whatever the steps in time. Tolerance: roundoff."""
    strained = Strained(over(body, element=element).problem)
    at_once = strained.to(sheared(-0.05, 0.08), 0.0)
    t = 0.0
    for lapse in (0.003, 0.04, 0.2, 0.01, 3.0):
        t += lapse
        found = strained.to(sheared(-0.05, 0.08), lapse)
        np.testing.assert_allclose(found, at_once * MOUSE.relaxation(t), atol=1e-10 * np.abs(at_once).max())


@pytest.mark.parametrize("held", [0.0, 0.05, 1.0])
def test_density_has_what_branches_store(body, held):
    """Of the springs of a generalised Maxwell solid in simple shear γ, held for a time t.

    W = G(0) γ² / 2 (1 - Σ g (1 - exp(-2 t / τ))). Tolerance: nonlinear terms, of the order of γ and its product with α.
    """
    gamma, G = 1e-5, 86.76e3
    strained = Strained(over(body).problem)
    strained.to(np.array([[1.0, gamma], [0.0, 1.0]]), 0.0)
    strained.to(np.array([[1.0, gamma], [0.0, 1.0]]), held)
    (density,) = Receptors(strained.problem, np.array([[0.1e-3, 0.2e-3]])).sed()
    relaxed = sum(g * (1 - np.exp(-2 * held / tau)) for g, tau in ((0.154, 1.111), (0.495, 0.092)))
    at_once = G / (1 - 0.154 - 0.495)
    assert density == pytest.approx(at_once * gamma**2 / 2 * (1 - relaxed), rel=1e-3)


def test_convolution(body):
    """Along a random history the stress is the sum over all past steps of S. Tolerance: 1e-10, roundoff of 30 steps."""
    strained, rng = Strained(over(body).problem), np.random.default_rng(1)
    jumps, places, before, t = [], [], np.zeros(4), 0.0
    for _ in range(30):
        lapse = 10 ** rng.uniform(-3, 0)
        strained.to(sheared(*rng.uniform(-0.1, 0.1, 2)), lapse)
        now = strained.value("isochoric stress")
        jumps.append(now - before)
        places.append(t + lapse / 2)
        before, t = now, t + lapse
    for k, (beta, tau) in enumerate(LAW.branches, 1):
        direct = beta * sum(np.exp(-(t - place) / tau) * jump for jump, place in zip(jumps, places, strict=True))
        np.testing.assert_allclose(strained.value(f"overstress {k}"), direct, atol=1e-10 * np.abs(direct).max())


@pytest.mark.parametrize("frequency", [0.1, 1.0, 10.0, 100.0])
def test_storage_and_loss(body, frequency):
    """Stress under a small oscillation has the complex modulus's two parts.

    Tolerance: 1e-6, with Richardson's extrapolation of the second-order error of 200 and 400 steps a period. The
    period begins with the branches of the steady oscillation.
    """
    found = []
    for steps in (200, 400):
        strained = Strained(over(body, Viscoelastic(NeoHooke(1e3), MOUSE)).problem)
        amplitude, parts = 1e-5, []
        times = np.arange(1, 1 + steps) / steps / frequency
        w = 2 * np.pi * frequency
        history = strained.problem.history
        start, held = {}, 0.0
        for k, (beta, tau) in enumerate(LAW.branches, 1):
            field = next(each for each in strained.fields if each.name.startswith(f"overstress {k}"))
            values = field.function.x.array.reshape(-1, 4) * 0
            values[:, 2] = beta * 1e3 * amplitude * (1j * w * tau / (1 + 1j * w * tau)).imag
            held += values[0, 2]
            start[field.name] = values.ravel()
        history.accept({**history.accepted, **start})
        assert strained.stress()[0, 1] == pytest.approx(held, rel=1e-12)  # the stress has the accepted branches at once
        for t in times:
            F = np.eye(2) + np.array([[0, amplitude * np.sin(w * t)], [0, 0]])
            parts.append(strained.to(F, 1 / frequency / steps)[0, 1])
        wave = 2 / steps * np.sum(np.array(parts) * np.exp(-1j * w * times)) * 1j
        found.append(wave * (1 - sum(MOUSE.moduli)) / (1e3 * amplitude))
    limit = (4 * found[1] - found[0]) / 3
    assert limit == pytest.approx(MOUSE.complex_modulus(frequency), abs=1e-6)


# -- solved bodies -------------------------------------------------------------------------------------
def test_creep(body):
    """Under a held force the confined block creeps as the closed form of its spring and branches.

    Small strain: with M(t) = K + 4/3 G(t) the creep has the retardation times of the roots of M's transform. Tolerance:
    the error of the steps, 1e-3 of the creep, and of second order.
    """
    K, G = ELASTIC.bulk, ELASTIC.shear_modulus * 4 / 3
    f, seconds, errors = 1e-6 * (K + G) * 1e-3, 0.3, []
    for scale in (1.0, 0.5):
        made = over(body, step_scale=scale)
        path = made.continuation
        path.run(Target("press", f_ext=f))
        at_once = float(made.solver.bone[1])
        path.run(Target("hold", f_ext=f, duration=seconds))
        creep = float(made.solver.bone[1]) - at_once
        assert path.time == pytest.approx(seconds, rel=1e-12)
        errors.append(creep / (compliance(K, G, seconds) - compliance(K, G, 0.0)) / (-f / 1e-3 * HEIGHT) - 1)
    assert abs(errors[0]) < 1e-3
    assert abs(errors[1]) < 0.4 * abs(errors[0])


def compliance(K: float, G: float, t: float) -> float:
    """Return the creep compliance (1/Pa) of a spring K beside G (1 + sum of branches), by partial fractions."""
    (b1, t1), (b2, t2) = LAW.branches
    # s M(s) = (K + G) + G sum b s tau / (1 + s tau), over a common denominator
    d = np.polymul([t1, 1], [t2, 1])
    n = np.polyadd((K + G) * d, G * np.polyadd(np.polymul([b1 * t1, 0], [t2, 1]), np.polymul([b2 * t2, 0], [t1, 1])))
    roots = np.roots(n)
    slope = np.polyder(n)
    return 1 / (K + G) + sum(np.polyval(d, r) / (r * np.polyval(slope, r)) * np.exp(r * t) for r in roots).real


# -- refusals ------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("moduli", "times", "message"),
    [
        ([0.5, 0.5], [1.0, 2.0], r"moduli sum to 1; .* below 1"),
        ([0.5], [0.0], "times has 0; it must be finite and greater than 0"),
        ([-0.5], [1.0], "moduli has -0.5"),
        ([0.5], [1.0, 2.0], "moduli has 1 entries and times 2"),
    ],
)
def test_refused(moduli, times, message):
    with pytest.raises(ValueError, match=message):
        QLV(moduli, times)


# -- what branches of viscous layers dissipate: at held strain, in an oscillation, of a law whose sign is wrong ------
AREA = 1e-3 * HEIGHT  # m^2, of the block


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
