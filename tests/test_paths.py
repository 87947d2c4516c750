"""Paths there and back: what returns, what friction keeps, where a flat ridge jumps, what a ridge does on leaving."""

from dataclasses import dataclass

import numpy as np
import pytest
from dolfinx import fem
from mpi4py import MPI
from scipy.optimize import brentq, minimize_scalar

from geometry import tags
from geometry.bodies import block, ridge
from geometry.mesh import load
from tests.test_contact import MU_F, make
from variational.body import Body
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.energy import Balance, EnergyBook
from variational.materials.saint_venant import SaintVenant
from variational.resultants import Observer, RidgeLoads
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import Attempt, Continuation, Target
from variational.solvers.coupling import Coupling
from variational.solvers.equations import Equations
from variational.solvers.newton import Solver

H_0, EPS_0 = 0.514e-6, 8.854e-12


@dataclass
class State:
    load: str
    voltage: float
    d_eq: float
    loads: RidgeLoads
    reaction: np.ndarray
    bone: np.ndarray
    attempt: Attempt
    energy: Balance


class Path:
    """Leads a body with one ridge along targets and keeps its states."""

    def __init__(self, solver: Solver, closure: BearingArea, touch_depth: float = 5e-6, step_scale: float = 1.0):
        self.solver, self.states = solver, []
        coupling = Coupling(solver, Observer(solver.problem), closure)
        self.continuation = c = Continuation(coupling, self._accepted, touch_depth, step_scale)
        self.book = EnergyBook(solver.problem, c.surface_state, solver.bone, solver.reaction, coupling.d_eq)

    def _accepted(self, target: Target, part: float, attempt: Attempt) -> None:
        c, s = self.continuation, self.solver
        now = s.bone, s.reaction.copy(), c.coupling.d_eq
        self.states.append(
            State(
                target.name,
                float(s.problem.voltage.value),
                float(c.coupling.d_eq[0]),
                c.observer.ridge_loads(c.surface_state),
                now[1],
                now[0],
                attempt,
                self.book.step(c.surface_state, *now),
            )
        )

    def to(self, name: str, **target: float) -> State:
        self.continuation.run(Target(name, **target))
        return self.states[-1]


# -- press and release -------------------------------------------------------------------------------------
@pytest.fixture(scope="module", params=[0.0, MU_F], ids=["frictionless", "friction"])
def released(request):
    """A ridge pressed to 10 N/m and lifted by displacement until it is 2 um above the screen."""
    path = Path(make(load(MPI.COMM_WORLD, ridge(20e-6)), request.param, held=False), BearingArea(H_0))
    path.to("press", f_ext=10.0)
    path.to("release", bone_height=2e-6)
    return path


def test_release_leaves_no_displacement(released):
    """The body has moved as one. Tolerance: some hundred imbalances of 1e-9 N/m over a shear modulus of 1e5 Pa."""
    u = released.solver.problem.displacement()
    np.testing.assert_allclose(u - [0.0, 2e-6], 0, atol=1e-12)


# -- forth and back ----------------------------------------------------------------------------------------
FORCE, FAR, STEPS = 2.0, 0.5e-6, 20
WIDTH, HEIGHT, EPS_T, YOUNG = 1e-3, 0.25e-3, 1e10, 1e9


@pytest.fixture(scope="module")
def slid():
    """A stiff block slid by its bone at constant force: out, back, and forth again, 20 steps a way."""
    body = load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.125e-3))
    solids, law = {tags.STRATUM_CORNEUM: SaintVenant(YOUNG, 0.0)}, Interface(Penalty(1e11, EPS_T), MU_F, H_0)
    path = Path(Body(body, solids, law, force_scale=FORCE).solver, BearingArea(H_0), touch_depth=20e-9)
    path.to("press", f_ext=FORCE)
    path.to("out", bone_x=FAR)
    way = FAR * (1 - 2 * np.arange(1, STEPS + 1) / STEPS)
    for x in way:
        path.to("back", bone_x=x)
    for x in -way:
        path.to("forth", bone_x=x)
    return path


def test_friction_loop(slid):
    """The bone's work over a closed cycle is that of a slider behind a spring, 4 mu_f N (s - s_el).

    s_el = mu_f N (1 / eps_t w + H / G w) is the way to full slip. Tolerance: friction tips the block, so that its
    points do not start to slip all at once; that shifts parts of s_el, a tenth of s.
    """
    k = 1 / (1 / (EPS_T * WIDTH) + HEIGHT / (YOUNG / 2 * WIDTH))
    elastic = MU_F * FORCE / k
    assert 0.05 * FAR < elastic < 0.2 * FAR
    out = [s for s in slid.states if s.load == "out"][-1]
    cycle = [out, *(s for s in slid.states if s.load in ("back", "forth"))]
    x, f_t = np.array([[s.bone[0], -s.reaction[0]] for s in cycle]).T
    assert x[-1] == pytest.approx(x[0], abs=1e-20)  # roundoff of 0.5 um
    assert f_t[-1] == pytest.approx(f_t[0], rel=1e-9)  # at full slip, to the solve's 1e-9
    assert f_t[0] == pytest.approx(MU_F * FORCE, rel=1e-9)
    area = np.trapezoid(f_t, x)
    assert area == pytest.approx(4 * MU_F * FORCE * (FAR - elastic), rel=0.01)


# -- a flat ridge, charged and discharged ------------------------------------------------------------------
P_EXT, SIDE = 50.0, 0.25e-3  # Pa, m
STEP = 0.05  # of the largest U^2: what a voltage step spans at most


class FlatRidge:
    """The scalar model of a flat ridge under P_EXT, p_c = P_EXT + sigma_el(d_eq(p_c))."""

    def __init__(self, p_floor: float) -> None:
        self.closure = BearingArea(H_0, p_floor=p_floor)
        self.held = float(self.closure(0.0).d_eq)
        end = float(self.closure.separation(max(p_floor, P_EXT * (1 + 1e-9))))
        self.off = minimize_scalar(self.square, bounds=(2e-6, 8e-6), method="bounded", options={"xatol": 1e-14})
        # The other fold is the highest voltage beyond the first one: smooth, or where d_eq begins to be held.
        self.on = minimize_scalar(
            lambda u: -self.square(u), bounds=(self.off.x, end), method="bounded", options={"xatol": 1e-14}
        )
        self.end = end

    def square(self, u_bar: float) -> float:
        """Return U^2 of the equilibrium at a mean separation (m)."""
        d = float(self.closure.air_gap(u_bar))
        return float((self.closure.contact_pressure(u_bar) - P_EXT) * 2 / EPS_0 * (H_0 + d) ** 2)

    @property
    def folds(self) -> tuple[float, float]:
        return float(np.sqrt(self.off.fun)), float(np.sqrt(-self.on.fun))

    def d_eq(self, voltage: float, near: bool) -> float:
        """Return the air gap (m) on the branch near the screen or on that far from it."""
        if not near and voltage**2 <= self.square(self.end) and self.held < 20e-6:
            return self.held
        a, b = (0.0, self.off.x) if near else (self.on.x, self.end)
        u = brentq(lambda v: self.square(v) - voltage**2, a, b, xtol=1e-18, rtol=1e-14)
        return float(self.closure.air_gap(u))


@pytest.fixture(scope="module", params=[(1e3, 200.0), (1.0, 300.0)], ids=["floor", "no floor"])
def charged(request):
    """A flat ridge at P_EXT charged and discharged, with its scalar model; d_eq is held below 1 kPa or hardly ever.

    Held, it jumps on where its pressure reaches 1 kPa, at 180 V; otherwise at the fold of the smooth model, 270 V.
    """
    p_floor, most = request.param
    body = load(MPI.COMM_WORLD, block(SIDE, SIDE, SIDE))
    solver = make(body)
    sides = fem.locate_dofs_topological(solver.problem.V, 1, body.facet_tags.find(tags.SIDES))
    rim = body.facet_tags.find(tags.BONE_RIM)
    solver = Solver(Equations(solver.problem, rim, [(2 * sides, 0.0)]), P_EXT * SIDE)
    model = FlatRidge(p_floor)
    path = Path(solver, model.closure, touch_depth=5e-9, step_scale=STEP / 0.5)
    path.to("press", f_ext=P_EXT * SIDE)
    path.to("charge", voltage=most)
    path.to("discharge", voltage=0.0)
    return model, path, most


def near(model: FlatRidge, state: State) -> bool:
    """Tell whether the scalar model is on the branch near the screen."""
    off, on = model.folds
    return state.voltage > (on if state.load == "charge" else off)


def test_flat_ridge_is_on_its_branch(charged):
    """Every state is the scalar model's to 1e-6, the coupling's tolerance, before and after the jumps."""
    model, path, _ = charged
    states = [s for s in path.states if s.load in ("charge", "discharge") and s.voltage > 1]
    found = np.array([s.d_eq for s in states])
    expected = np.array([model.d_eq(s.voltage, near(model, s)) for s in states])
    np.testing.assert_allclose(found, expected, rtol=1e-6)


@pytest.mark.parametrize("way", ["charge", "discharge"])
def test_flat_ridge_jumps_at_the_fold(charged, way):
    """Between two neighbouring voltages with the fold in between, d_eq changes by more than a factor of two."""
    model, path, most = charged
    states = [s for s in path.states if s.load == way and s.voltage > 1]
    ratio = np.abs(np.diff(np.log([s.d_eq for s in states])))
    k = int(ratio.argmax())
    before, after = states[k].voltage, states[k + 1].voltage
    fold = model.folds[1 if way == "charge" else 0]
    assert ratio[k] > np.log(2)
    assert min(before, after) <= fold <= max(before, after)
    assert abs(after**2 - before**2) <= STEP * most**2 * (1 + 1e-9)
    assert states[k + 1].attempt.jumped == {0}
    assert [s for s in states if s.attempt.jumped] == [states[k + 1]]


# -- leaving contact ---------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def lifted():
    """A round ridge pressed, charged, and lifted by displacement far beyond the end of its contact."""
    path = Path(make(load(MPI.COMM_WORLD, ridge(10e-6)), held=False), BearingArea(H_0))
    path.to("press", f_ext=2.0)
    path.to("charge", voltage=150.0)
    path.to("lift", bone_height=40e-6)
    return path


def test_ridge_without_contact_is_attracted_across_its_height(lifted):
    """Higher than its d_eq a ridge feels Eq. 3 at its height: an integral over the cosine, 1e-4 of it.

    Attraction stretches the ridge by some 0.05 um of the 40 um at its tip, on whose square it depends; the cosine is
    where the tip is.
    """
    stretch = lifted.continuation.surface_state.y.min() - 40e-6
    assert -0.1e-6 < stretch < 0
    x = np.linspace(-483e-6 / 2, 483e-6 / 2, 20001)
    y = 40e-6 + stretch + 50e-6 * (1 - np.cos(2 * np.pi * x / 483e-6))
    expected = np.trapezoid(EPS_0 * 150.0**2 / 2 / (H_0 + y) ** 2, x)
    assert lifted.states[-1].loads.f_attraction[0] == pytest.approx(expected, rel=3e-4)
