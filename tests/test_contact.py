"""Contact, force control and friction of solved states against closed forms and balances, on any number of ranks."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq

from geometry import tags
from geometry.bodies import block
from geometry.mesh import load
from tests.test_element import confined_stress as confined
from variational.body import Body
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.resultants import Observer
from variational.roughness.bam import BearingArea
from variational.solvers.equations import Control
from variational.solvers.newton import Solver

pytestmark = pytest.mark.mpi
WIDTH, HEIGHT = 1e-3, 0.5e-3
G_0, ALPHA, NU = 86.76e3, -14.53, 0.48
EPS_N, EPS_T, MU_F, H_0 = 1.5e12, 1e11, 0.25, 0.514e-6
D_EQ, VOLTAGE = 2e-6, 200.0
P_EL = 8.854e-12 * VOLTAGE**2 / 2 / (H_0 + D_EQ) ** 2
TOLERANCE = 1e-9  # N/m, imbalance of the nodal forces at which the solves here end


def over(body, mu_f=0.0, eps_n=EPS_N, eps_t=EPS_T, held=True, element="P2", formulation=None) -> Body:
    """Return a body over the screen; with ``held`` its sides do not move sideways."""
    skin = {tags.STRATUM_CORNEUM: Ogden(G_0, ALPHA, NU)}
    interface = Interface(formulation or Penalty(eps_n, eps_t), mu_f, H_0)
    sides = body.facets(tags.SIDES) if held else None
    return Body(body, skin, interface, BearingArea(H_0), element=element, tolerance=TOLERANCE, held=sides)


def make(body, *args, **kwargs) -> Solver:
    """Return the solver of :func:`over` with every air gap at D_EQ."""
    solver = over(body, *args, **kwargs).solver
    solver.problem.set_air_gaps(np.array([D_EQ]))
    return solver


@pytest.fixture(scope="module")
def body():
    """A block of 4 x 2 x 2 cells on the screen."""
    return load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3))


def confined_stress(stretch: float) -> float:
    """Return dW/dlambda_2 of Eqs. 1 and 2 at stretches (1, stretch, 1)."""
    return confined(Ogden(G_0, ALPHA, NU), stretch)


def uniform_pressure(depth: float, p_el: float = 0.0) -> float:
    """Return p_n of a block whose top is lowered: the skin sinks p_n / eps_n below the screen."""

    def imbalance(p_n: float) -> float:
        return confined_stress(1 - (depth - p_n / EPS_N) / HEIGHT) + p_n - p_el

    return brentq(imbalance, 0.0, 1e6, xtol=1e-12, rtol=1e-15)


# -- patch test ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("part", [0.001, 0.02, 0.1])
def test_patch(body, part):
    """A block pressed flat bears one pressure everywhere, confined compression's.

    Tolerance: that of the solve, 1e-9 N/m on a sixth of a facet of 0.25 mm, is 1e-8 of the least pressure, 2 kPa.
    """
    solver = make(body)
    solver.control = Control(0.0, -part * HEIGHT)
    solver.solve()
    p_n = Observer(solver.problem).state().p_n
    np.testing.assert_allclose(p_n, uniform_pressure(part * HEIGHT), rtol=2e-8)


def test_patch_under_voltage(body):
    """Attraction adds to the contact pressure: p_n = elastic stress + p_el. Resultants are those times the width.

    Tolerance: the solve's on 73 kPa; roundoff for what does not depend on the pressure.
    """
    solver = make(body)
    solver.problem.voltage.value = VOLTAGE
    solver.control = Control(0.0, -0.02 * HEIGHT)
    solver.solve()
    loads, p_n = Observer(solver.problem).ridge_loads(), uniform_pressure(0.02 * HEIGHT, P_EL)
    np.testing.assert_allclose(Observer(solver.problem).state().p_n, p_n, rtol=1e-9)
    assert loads.length[0] == pytest.approx(WIDTH, rel=1e-10, abs=0)  # the skin stays flat to the solve's tolerance
    assert loads.f_contact[0] == pytest.approx(p_n * WIDTH, rel=1e-9)
    assert loads.p_c[0] == pytest.approx(p_n, rel=1e-9)
    assert loads.f_attraction[0] == pytest.approx(P_EL * WIDTH, rel=1e-12)
    assert loads.f_attraction_x[0] == pytest.approx(0, abs=1e-12 * P_EL * WIDTH)


# -- force control -------------------------------------------------------------------------------------
def press(solver, force: float, voltage: float = 0.0):
    """Touch by displacement, then let the force take over."""
    solver.control = Control(0.0, -0.01 * HEIGHT)
    solver.solve()
    solver.problem.voltage.value = voltage
    solver.control = Control(0.0, None, force)
    solver.solve()


@pytest.fixture(scope="module")
def pressed(body) -> Solver:
    """The block under 5 N/m."""
    press(solver := make(body), 5.0)
    return solver


@pytest.mark.parametrize("voltage", [0.0, VOLTAGE])
def test_force_is_reached(body, voltage):
    """The bone's reaction is the prescribed force, and contact less attraction. Tolerance: that of the solve."""
    force = 5.0
    press(solver := make(body), force, voltage)
    loads = Observer(solver.problem).ridge_loads()
    attraction = P_EL * WIDTH if voltage else 0.0
    assert solver.reaction[1] == pytest.approx(force, abs=10 * TOLERANCE)
    # The balance over all nodes adds up to some fifty imbalances
    assert (loads.f_contact - loads.f_attraction)[0] == pytest.approx(force, abs=50 * TOLERANCE)
    assert loads.f_attraction[0] == pytest.approx(attraction, rel=1e-12)  # roundoff: the skin is below d_eq


def test_height_under_force(pressed):
    """Force and height are two ways to the same state: the height reached is confined compression's.

    Tolerance: some ten imbalances of 1e-9 N/m in 5 N/m, on a height of a micrometre.
    """
    p_n = 5.0 / WIDTH
    stretch = brentq(lambda x: confined_stress(x) + p_n, 0.5, 1.0, xtol=1e-15)
    assert pressed.bone[1] == pytest.approx(-(1 - stretch) * HEIGHT - p_n / EPS_N, rel=1e-8, abs=0)
    assert pressed.bone[0] == 0


# -- friction ------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def slide():
    """Press a block whose sides are free with friction, then move it sideways at constant force; states by step.

    The penalties are as stiff, against elements of 0.1 mm, as those of a fingertip against elements of 5 um.
    """
    body = load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.125e-3))
    solver = make(body, MU_F, eps_n=1e11, eps_t=1e10, held=False)
    observer = Observer(solver.problem)
    states = []

    def step(control: Control):
        solver.control = control
        solver.solve()
        state = observer.state()
        states.append((control, state, observer.ridge_loads(state), solver.reaction.copy(), observer.slip(state)))
        solver.problem.history.accept(state.history)

    step(Control(0.0, -0.001 * HEIGHT))
    step(Control(0.0, None, 2.0))
    for x in (0.1e-6, 0.2e-6, 0.4e-6, 1e-6, 2e-6, 4e-6, 8e-6, 16e-6, 32e-6, 64e-6, 128e-6):
        step(Control(x, None, 2.0))
    return states


def test_friction_stays_in_its_cone(slide):
    """No point at any step bears more than mu_f p_n. Tolerance: the law's own 1e-9 about the cone."""
    for _, state, *_ in slide:
        assert (np.abs(state.t_t) <= MU_F * state.p_n * (1 + 2e-9)).all()


def test_full_slip_is_the_cone(slide):
    """Where every point slips, f_T = mu_f times the contact force, against the motion. Tolerance: roundoff."""
    _, _, loads, *_ = slide[-1]
    assert loads.f_friction[0] == pytest.approx(-MU_F * loads.f_contact[0], rel=1e-12)


@pytest.mark.parametrize(
    ("pull", "found"),
    [
        (lambda x: 1.0, (1.0, True)),
        (lambda x: -1.0, (1.0, True)),
        (np.sign, (1.0, False)),
        (lambda x: np.where(x < 0, 0.5, 1.0), (0.5, False)),
    ],
    ids=["forth", "back", "apart", "half sticks"],
)
def test_full_slip_is_one_way(body, pull, found):
    """Skin at its cone that spreads, left half one way and right half the other, slips everywhere and does not slide.

    The tractions are written down, so that the count is exact.
    """
    observer = Observer(make(body, MU_F).problem)
    state = observer.state()
    p_n = np.full_like(state.x, 1e4)
    assert observer.slip(replace(state, p_n=p_n, limit=MU_F * p_n, t_t=MU_F * p_n * pull(state.x))) == found
