"""The energy balance closes on smooth paths, each of its terms is a derivative, and a jump leaves what it releases."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from mpi4py import MPI

from geometry.bodies import block, ridge
from geometry.mesh import load
from tests import spring
from tests.cycle import D_EQ, PHASES, VOLTAGE, Walk, cycle
from tests.test_contact import HEIGHT, MU_F, WIDTH, make
from variational.attraction import electroadhesion
from variational.attraction.electroadhesion import Attraction
from variational.energy import Balance, EnergyBook
from variational.resultants import Observer
from variational.solvers.equations import Control

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=["block", "ridge"])
def cycles(request):
    """Cycles of 8, 16 and 32 steps a phase, without jumps."""
    flat = request.param == "block"
    model = block(WIDTH, HEIGHT, 0.25e-3) if flat else ridge(40e-6)
    depth, far = (2e-6, 30e-6) if flat else (20e-6, 150e-6)
    body = load(MPI.COMM_WORLD, model)
    law = {"mu_f": MU_F, "eps_n": 1e11, "eps_t": 1e10, "held": False}
    return [cycle(make(body, **law), depth, far, steps) for steps in (8, 16, 32)]


def total(phase: list[Balance], name: str) -> float:
    return sum(abs(getattr(balance, name)) for balance in phase)


@pytest.mark.parametrize("phase", PHASES)
def test_balance_closes_with_the_square_of_the_step(cycles, phase, request):
    """The imbalances of a phase add up to a quarter when the step is halved.

    Over two halvings the rates measured lie between 1.80 and 2.07 on the block. On the ridge points touch, part and
    start to slip one by one, somewhere inside a step: between 1.24 and 2.89 here, and from 128 to 512 steps between
    1.80 and 2.05 but for the discharge, whose imbalance is at the solver's tolerance by then. The last step of the lift
    is left out: it ends where the body just leaves the screen, and roundoff says which points still bear.
    """
    last = -1 if phase == "lift" else None
    errors = np.array([total(c[phase][:last], "released") for c in cycles])
    assert np.log2(errors[0] / errors[-1]) / 2 > (1.75 if "block" in request.node.name else 1.2)
    assert (np.diff(errors) < 0).all()


# -- the terms, each against a difference of energies ------------------------------------------------------
@pytest.fixture
def walk():
    """A ridge pressed and charged without friction."""
    walk = Walk(make(load(MPI.COMM_WORLD, ridge(20e-6)), held=False))
    for part in (0.25, 0.5, 0.75, 1.0):
        walk.to(Control(0.0, -20e-6 * part))
    walk.to(Control(0.0, -20e-6), VOLTAGE)
    return walk


def stored(walk: Walk) -> float:
    """Return the stored energy in the present state, equilibrium or not."""
    solver = walk.solver
    balance = walk.book.step(walk.observer.state(), solver.bone, solver.reaction, np.array([D_EQ]))
    return balance.stored


@pytest.mark.mpi
@pytest.mark.parametrize(("name", "voltage", "d_eq"), [("voltage", 1.5, 1.0), ("air_gap", 1.0, 1.01)])
def test_work_at_frozen_shape_is_the_energys_change(walk, name, voltage, d_eq):
    """The energy is linear in U^2, so that the trapezoidal rule has no error. Tolerance: roundoff of the energies."""
    before, gaps, solver = stored(walk), np.array([d_eq * D_EQ]), walk.solver
    solver.problem.voltage.value = voltage * VOLTAGE
    solver.problem.set_air_gaps(gaps)
    balance = walk.book.step(walk.observer.state(), solver.bone, solver.reaction, gaps)
    assert getattr(balance, name) == pytest.approx(balance.stored - before, rel=1e-9, abs=0)


@pytest.mark.mpi
def test_work_of_the_bone_is_the_energys_change(walk):
    """Without friction, over 0.1 um of sinking, by the trapezoidal rule, whose error is 1e-4 here."""
    balance = walk.to(Control(0.0, -20.1e-6), VOLTAGE)
    assert balance.external == pytest.approx(balance.change, rel=1e-3, abs=0)
    assert balance.external > 0


def test_contact_springs_give_the_contact_forces():
    """The springs' energy falls by the work of p_n and t_t on sticking skin: central differences, exact for springs.

    Tolerance: roundoff of energies that differ by a hundredth.
    """
    solver = make(load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3)), mu_f=10.0)
    problem, observer = solver.problem, Observer(solver.problem)
    energies, step = [], 1e-9
    for sign in (-1, 0, 1):
        problem.w.interpolate(lambda x, s=sign: np.stack([5e-8 + s * step + 0 * x[0], -1e-7 + s * step + 0 * x[0]]))
        state = observer.state()
        energies.append(problem.surface.per_ridge(problem.interface.formulation.stored(state))[0])
        if sign == 0:
            force = problem.surface.per_ridge(state.p_n + state.t_t)[0]
    assert -(energies[2] - energies[0]) / (2 * step) == pytest.approx(force, rel=1e-9)


def test_dissipation_of_full_slip():
    """A block that slips everywhere dissipates its friction times the way. Tolerance: elastic skin still adjusts."""
    body = load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3))
    walk = Walk(make(body, MU_F, eps_n=1e11, eps_t=1e10, held=False))
    walk.to(Control(0.0, -2e-6))
    for x in (4e-6, 20e-6, 40e-6, 60e-6):
        balance = walk.to(Control(x, -2e-6))
    assert walk.observer.slip(walk.state) == (1.0, True)
    assert balance.dissipation == pytest.approx(-walk.solver.reaction[0] * 20e-6, rel=1e-6, abs=0)


# -- a jump ------------------------------------------------------------------------------------------------
def released_by_pull_in() -> float:
    """Return the energy per length that the spring releases from the fold to where it rests inside d_eq.

    The energy per area is k (g - y)^2 / 2 + phi(y), with g the skin's height without attraction.
    """
    pull = spring.HALF / (spring.H_0 + spring.FOLD) ** 2
    g = spring.FOLD + pull / spring.STIFFNESS
    inside = spring.HALF / (spring.H_0 + spring.D_EQ) ** 2
    end = g - inside / spring.STIFFNESS
    phi = (
        -spring.HALF / (spring.H_0 + spring.FOLD),
        -spring.HALF / (spring.H_0 + spring.D_EQ) - inside * (spring.D_EQ - end),
    )
    springs = [spring.STIFFNESS / 2 * (g - y) ** 2 for y in (spring.FOLD, end)]
    return spring.WIDTH * (springs[0] + phi[0] - springs[1] - phi[1])


@cache
def pulled_in(steps: int) -> list[Balance]:
    """Return the balances of a bone that is lowered by 2 um, in whose course the skin jumps to the screen."""
    walk = Walk(spring.charged())  # its gap is the spring's too
    walk.to(Control(), spring.VOLTAGE)
    return [walk.to(Control(0.0, -2e-6 * part), spring.VOLTAGE) for part in np.arange(1, steps + 1) / steps]


@pytest.mark.mpi
@pytest.mark.parametrize("steps", [8, 16, 32])
def test_energy_released_by_pull_in(steps):
    """Lowering the bone makes the skin jump to the screen; the balance leaves the closed form's energy.

    Where in the step it jumps is not known, which is the balance's own error: half the reaction's jump times the step.
    The spring is linear to its strain, below 1 %.
    """
    balances = pulled_in(steps)
    released = np.array([balance.released for balance in balances])
    jump = int(np.argmax(released))
    expected = released_by_pull_in()
    assert released[jump] > 0
    assert released[jump] == pytest.approx(expected, abs=balances[jump].released_error + 0.01 * expected)
    assert np.abs(np.delete(released, jump)).sum() < 0.02 * expected


def test_error_of_a_jump_while_the_voltage_rises():
    """Half the jump of the energy's derivative times the change of U^2, at a bone that stays.

    Charged in one step from 120 V to 200 V, the skin jumps to the screen.
    """
    walk, d_eq = Walk(spring.charged()), np.array([D_EQ])
    bone = Control(0.0, -1.5e-6)
    phi, squares = [], []
    for voltage in (60.0, 120.0, spring.VOLTAGE):
        balance = walk.to(bone, voltage)
        phi.append(float(walk.book._potential(walk.state, d_eq).sum()))
        squares.append(voltage**2)
    assert phi[2] < 1.5 * phi[1] < 0, "it jumped"
    expected = (phi[1] - phi[2]) * (squares[2] - squares[1]) / 2
    assert balance.released_error == pytest.approx(expected, rel=1e-9)


def test_another_attraction_is_refused():
    """The book takes the work of the voltage from the electrostatic potential."""
    problem = make(load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3))).problem
    other = Attraction(electroadhesion.attraction, lambda y, d_eq, voltage, h_0: -y)
    problem.interface = replace(problem.interface, attraction=other)
    with pytest.raises(ValueError, match="electrostatic attraction only"):
        EnergyBook(problem, Observer(problem).state(), np.zeros(2), np.zeros(2), np.array([D_EQ]))
