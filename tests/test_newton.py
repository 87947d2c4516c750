"""Newton's method: which steps it takes, shortens and refuses, and the layer at the screen; on any ranks."""

import numpy as np
import pytest
from mpi4py import MPI

from geometry.bodies import block, ridge
from geometry.mesh import load
from tests.test_contact import HEIGHT, MU_F, WIDTH, make
from variational.solvers import iteration as module
from variational.solvers.equations import Control
from variational.solvers.outcome import NotConverged
from variational.solvers.tangent import Anderson

pytestmark = pytest.mark.mpi


@pytest.fixture(scope="module")
def body():
    return load(MPI.COMM_WORLD, ridge(20e-6))


@pytest.fixture(scope="module")
def flat():
    """A block of 4 x 2 x 2 cells on the screen."""
    return load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3))


class Trace:
    """Norms of the residual, and whether the step that led to each used a kept factorisation."""

    def __init__(self, solver):
        self.norms: list[float] = []
        self.kept: list[bool] = []
        solver.iteration.snes.setMonitor(lambda snes, iteration, norm: self._note(solver, iteration, norm))

    def _note(self, solver, iteration, norm):
        if iteration == 0:
            self.norms, self.kept = [], []
        self.norms.append(norm)
        self.kept.append(solver.iteration.tangent.kept)

    def rises(self):
        """Return by how much the residual rose in iterations from the second on that used a kept factorisation."""
        pairs = zip(self.norms[1:], self.norms[2:], self.kept[2:], strict=False)
        return [after / before for before, after, kept in pairs if kept and after > before * (1 + 1e-12)]


def walk(solver, loads, slipping=False, after=lambda: None):
    """Solve for one load after the other, each with the history that the one before it left."""
    surface = solver.problem.surface
    anchor = surface.compile([solver.problem.contact.new_anchor])
    for control in loads:
        solver.new_load(control, 0.0, slipping)
        solver.solve()
        after()
        surface.set_history(solver.problem.anchor, surface.evaluate(anchor)[0])


def test_kept_factorisation_never_raises_the_residual(body):
    """Once the prescribed displacement is made, what an old tangent proposes is taken only if it helps."""
    solver = make(body, MU_F, eps_t=5e10)
    trace, rises, kept = Trace(solver), [], []

    def note():
        rises.extend(trace.rises())
        kept.extend(trace.kept[1:])

    walk(solver, [Control(0.0, -10e-6 * k) for k in (1, 2, 3, 4)], after=note)
    walk(solver, [Control(20e-6 * k, -40e-6) for k in (1, 2, 3)], after=note)
    assert rises == []
    assert sum(kept) > 5


@pytest.mark.parametrize("held", [True, False])
def test_cycle_with_kept_factorisations_ends_with_own_ones(held):
    """On a stiff screen kept factorisations bring the wrong points into contact; a tangent for each step does not.

    A penalty ten times the default's, and steps of 6 um: twelve ridges of 10, 5 and 2.5 um, with and without friction,
    reach the end so, and four of them where a cycle ends the solve.
    """
    solver = make(load(MPI.COMM_WORLD, ridge(10e-6)), MU_F, eps_n=1.5e13, eps_t=5e11, held=held)
    walk(solver, [Control(0.0, -6e-6 * k) for k in range(1, 11)])
    assert solver.bone[1] == pytest.approx(-60e-6, rel=1e-12, abs=0)  # roundoff of the last step


def test_step_that_inverts_is_halved(flat, monkeypatch):
    """A block is flattened at once so far that the full step turns elements inside out."""
    far = Control(0.0, -0.6 * HEIGHT)
    solver = make(flat, held=False)
    solver.new_load(far, 0.0)
    solver.solve()
    assert solver.bone[1] == pytest.approx(far.y, rel=1e-12, abs=0)  # roundoff of the halvings
    monkeypatch.setattr(module, "_HALVINGS", 0)
    solver = make(flat, held=False)
    solver.new_load(far, 0.0)
    with pytest.raises(NotConverged, match="inverted"):
        solver.solve()


def test_steady_slip_is_solved_at_once(body):
    """At full slip a further translation is the first step of Newton's method if points are taken to slip on."""
    solver = make(body, MU_F, eps_t=5e10, held=False)
    walk(solver, [Control(0.0, -5e-6 * k) for k in range(1, 5)])
    walk(solver, [Control(20e-6 * k, -20e-6) for k in range(1, 11)])
    before = solver.counts.newton
    walk(solver, [Control(300e-6, -20e-6)], slipping=True)
    assert solver.counts.newton - before == 1


def test_friction_is_softened_only_where_steps_were_cut_before(body, monkeypatch):
    """On flat tips softening took 40 to 100 factorisations in a step, and a smaller step takes ten."""
    solver, softened = make(body, MU_F, held=False), []
    monkeypatch.setattr(solver.iteration, "run", lambda *args, **options: -1)
    monkeypatch.setattr(solver, "_sideways", lambda: 1.0)
    monkeypatch.setattr(solver, "_ease", lambda start: softened.append(start) or 1)
    with pytest.raises(NotConverged):
        solver.solve()
    assert not softened
    solver.solve(pseudo_transient=True)
    assert len(softened) == 1


# -- Anderson acceleration with a kept factorisation -----------------------------------------------------------------
SIZE, RANK = 60, 3
ROWS = np.array_split(np.arange(SIZE), MPI.COMM_WORLD.size)[MPI.COMM_WORLD.rank]


@pytest.fixture
def linear():
    """Return a matrix, a right-hand side and the matrix kept: the other without a part of rank three."""
    rng = np.random.default_rng(0)
    kept = np.diag(rng.uniform(1, 2, SIZE))
    change = 0.3 * np.linalg.qr(rng.normal(size=(SIZE, RANK)))[0]
    return kept + change @ change.T * 8, rng.normal(size=SIZE), kept


def norms(linear, accelerated: bool) -> list[float]:
    """Return the residuals' norms of an iteration; each rank has its rows of the vectors."""
    matrix, right, kept = linear
    x, found, anderson = np.zeros(SIZE), [], Anderson(MPI.COMM_WORLD)
    for _ in range(9):
        r = matrix @ x - right
        found.append(float(np.linalg.norm(r)))
        step = np.linalg.solve(kept, r)
        more = anderson.correction(x[ROWS], r[ROWS], step[ROWS]) if accelerated else None
        if more is not None:
            step += np.concatenate(MPI.COMM_WORLD.allgather(more))
        x = x - step
    return found


def test_change_of_low_rank_is_learnt(linear):
    """A kept matrix that lacks three directions is made good by three differences; the plain iteration goes on slowly.

    Tolerance: roundoff of the least squares, and their share that counts as dependent, 1e-8.
    """
    plain, accelerated = norms(linear, False), norms(linear, True)
    assert accelerated[RANK + 2] < 1e-6 * accelerated[0]
    assert plain[RANK + 2] > 1e-3 * plain[0]


# -- the layer of elements next to the screen, brought into balance by itself, on any number of ranks ----------------
PRESS = [Control(0.0, -10e-6 * k) for k in (1, 2, 3, 4)]
SLIDE = [Control(20e-6 * k, -40e-6) for k in (1, 2, 3)]


@pytest.fixture
def pressed(body):
    """A solver in equilibrium with a layer, its layer, and an iterate whose layer is out of balance by 0.1 um."""
    solver = make(body, MU_F, eps_t=5e10)
    walk(solver, PRESS)
    layer, x = solver.iteration._layer, solver.x.copy()
    rng = np.random.default_rng(MPI.COMM_WORLD.rank)
    x.array_w[layer._rows] += 1e-7 * rng.uniform(-1, 1, len(layer._rows))
    return solver, layer, x


def total(part) -> float:
    """Return the norm of a vector of which each rank has a part."""
    return float(np.sqrt(MPI.COMM_WORLD.allreduce(float(part @ part))))


def test_forms_of_the_layer_are_the_rows_of_the_whole(pressed):
    """Residual and tangent, in the layer's rows and columns. Tolerance: roundoff of the sums, of the largest entry."""
    solver, layer, x = pressed
    equations, tangent, rows = solver.equations, solver.iteration.tangent, layer._rows
    whole, part = x.duplicate(), x.duplicate()
    equations.residual(x, part, layer._residual)
    layer._iterate(layer._ksp, x.copy(), part, np.inf)  # assembles the tangent at the iterate it starts from
    equations.residual(x, part, layer._residual)
    equations.residual(x, whole)
    assert total((part.array_r - whole.array_r)[rows]) < 1e-12 * total(whole.array_r[rows])
    tangent.stale = True
    tangent.update(None, x, tangent.relative, tangent.matrix)
    direction, product = tangent.matrix.createVecs()
    small, found = layer._K.createVecs()
    some = np.random.default_rng(MPI.COMM_WORLD.rank).uniform(-1, 1, len(rows))
    direction.array_w[rows], small.array_w[:] = some, some
    tangent.matrix.mult(direction, product)
    layer._K.mult(small, found)
    assert total(found.array_r - product.array_r[rows]) < 1e-12 * total(product.array_r[rows])


def test_balance_moves_the_layer_alone(pressed):
    """Its residual falls to what was asked for; everything else stays where it was, to the last bit."""
    solver, layer, x = pressed
    before, f = x.array_r.copy(), x.duplicate()
    solver.equations.residual(x, f)
    first = total(f.array_r[layer._rows])
    layer.balance(x, f, 1e-9 * first, np.inf)
    solver.equations.residual(x, f)
    assert total(f.array_r[layer._rows]) <= 1e-9 * first
    rest = np.delete(x.array_r - before, layer._rows)
    assert not rest.any()
    assert total(x.array_r - before) > 0


@pytest.mark.slow
def test_equilibrium_is_the_same_without_the_layer(body):
    """With it fewer factorisations lead there. Tolerance: the solve's, 1e-9 N/m over the tangent's stiffness."""
    states, factorisations = [], []
    for with_layer in (True, False):
        solver = make(body, MU_F, eps_t=5e10)
        solver.iteration._layer = solver.iteration._layer if with_layer else None
        walk(solver, PRESS + SLIDE)
        states.append(solver.x.array_r.copy())
        factorisations.append(solver.counts.factorisations)
    assert total(states[1] - states[0]) < 1e-8 * total(states[0])
    assert factorisations[0] < 0.8 * factorisations[1]
