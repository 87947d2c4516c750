"""Faults put into a run: each ends in a named error with what to try, with every accepted step on disk."""

import json
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fingerpad.runs import restarts
from fingerpad.scene import from_data
from geometry.bodies import block
from geometry.mesh import load
from tests.measures import accepted
from tests.runs import run
from tests.test_contact import HEIGHT, MU_F, WIDTH, over
from variational.roughness.bam import BearingArea
from variational.roughness.closure import AirGap
from variational.solvers.continuation import Attempt, Continuation
from variational.solvers.equations import Control, Equations
from variational.solvers.newton import Solver
from variational.solvers.outcome import NotConverged

pytestmark = pytest.mark.slow
MESH = {"contact": 30e-6, "receptor": 80e-6, "interface": 150e-6, "growth": 0.8, "touching_half_arc": 1.3e-3}
HISTORY = [{"name": "press", "bone_height": -60e-6}, {"name": "charge", "voltage": 100.0}]
GOOD = 2  # steps accepted before a fault


@pytest.fixture(autouse=True)
def one_start(monkeypatch):
    """A fault is one of its mesh: no run starts again with smaller elements."""
    monkeypatch.setattr(restarts, "FINEST", 1.0)


@pytest.fixture
def scene():
    """A finger of nine ridges pressed in two steps and charged in four; without errors, that no fault is put into."""

    def make_scene(**numerics):
        parts = {"geometry": {"ridge_count": 9}, "output": {"errors": False}}
        return from_data({"mesh": MESH, "history": HISTORY, "numerics": numerics, **parts})

    return make_scene


def ends(scene, folder: Path, *words: str, steps: int = GOOD) -> None:
    """Run a scene that fails, and check what it says and leaves."""
    summary = run(scene, folder, MPI.COMM_WORLD)
    for word in words:
        assert word in summary["failure"]
    assert json.loads((folder / "summary.json").read_text(encoding="utf-8"))["failure"] == summary["failure"]
    assert summary["failure"] in (folder / "run.log").read_text(encoding="utf-8")
    rows = accepted(folder)
    assert [int(row["step"]) for row in rows] == list(range(1, steps + 1))
    assert summary["steps"] == steps
    assert all(np.isfinite(float(row[name])) for row in rows for name in ("f_ext", "f_contact", "stored", "imbalance"))


@pytest.fixture
def before_solves(monkeypatch):
    """Return a function that has something done to the solver before each solve after the good steps."""

    def install(act):
        solve, accept, count = Solver.solve, Continuation.accept, [0]

        def counted(self):
            accept(self)
            count[0] += 1

        def disturbed(self, *how, **more):
            if count[0] >= GOOD:
                act(self)
            solve(self, *how, **more)

        monkeypatch.setattr(Continuation, "accept", counted)
        monkeypatch.setattr(Solver, "solve", disturbed)

    return install


def test_not_a_number_from_the_closure(scene, tmp_path, monkeypatch):
    original = BearingArea.__call__

    def broken(self, p_c):
        gap = original(self, p_c)
        d_eq = np.where((np.asarray(p_c) > 0) & (Continuation_steps() >= GOOD), np.nan, gap.d_eq)
        return AirGap(d_eq, gap.derivative)

    def Continuation_steps():
        return len(accepted(tmp_path))

    monkeypatch.setattr(BearingArea, "__call__", broken)
    ends(scene(), tmp_path, "NOT_A_NUMBER in the air gap of ridge", "try")


def test_inverted_elements(scene, tmp_path, before_solves):
    """Nodes thrown about by a tenth of a millimetre turn elements inside out."""

    def act(solver):
        solver.x.array_w[:] += 1e-4 * np.random.default_rng(0).uniform(-1, 1, solver.layout.local_size)

    before_solves(act)
    ends(scene(), tmp_path, "step 3 (charge", "elements inverted (J <= 0)", "try a smaller f_ext")


def test_mumps_out_of_memory(scene, tmp_path, before_solves):
    """MUMPS may use one megabyte: it says so, and no smaller step is tried in vain."""

    def act(solver):
        solver.iteration.snes.getKSP().getPC().getFactorMatrix().setMumpsIcntl(23, 1)
        solver.iteration.tangent.stale = True

    before_solves(act)
    ends(scene(), tmp_path, "step 3 (charge", "MUMPS_OUT_OF_MEMORY (INFOG(1) = -", "try a larger mesh.contact")
    assert (tmp_path / "run.log").read_text(encoding="utf-8").count(" cut: ") == 0


def test_mumps_out_of_workspace_gets_more(scene, tmp_path, before_solves):
    """Each factorisation begins with a tenth of its estimate: the same states, and no smaller step."""
    expected = run(scene(), tmp_path / "expected", MPI.COMM_WORLD)
    option = "fingerpad_mat_mumps_icntl_14"

    def act(solver):
        if not PETSc.Options().hasName(option):  # it has run out of it
            solver.iteration.snes.getKSP().getPC().getFactorMatrix().setMumpsIcntl(14, -90)
            solver.iteration.tangent.stale = True

    before_solves(act)
    found = run(scene(), tmp_path / "found", MPI.COMM_WORLD)
    assert PETSc.Options().getInt(option) == 100
    PETSc.Options().delValue(option)
    assert "failure" not in found and found["steps"] == expected["steps"] and found["cutbacks"] == 0
    assert found["charged_f_electrostatic"] == pytest.approx(expected["charged_f_electrostatic"], rel=1e-8)


def test_fixed_point_at_its_cap(scene, tmp_path):
    ends(scene(coupling_cap=1), tmp_path, "COUPLING_CAP at ridge", "try a larger numerics.coupling_cap")


def test_bone_and_screen_disagree(scene, tmp_path, monkeypatch):
    """A reaction that is wrong by 1e-5 of f_ext is not passed over."""
    kept = Equations.residual

    def wrong(self, x, f, *part):
        kept(self, x, f, *part)
        self.reaction[1] += 1e-5

    monkeypatch.setattr(Equations, "residual", wrong)
    ends(scene(), tmp_path, "forces are not balanced", "try", steps=0)


# -- rejected iterates -------------------------------------------------------------------------------------
def trajectory(chance: float, seed: int) -> tuple[list[dict[str, np.ndarray]], int]:
    """Press, charge and slide a block; after a solve, reject by chance and try the same step again."""
    made = over(load(MPI.COMM_SELF, block(WIDTH, HEIGHT, 0.125e-3)), MU_F, 1e11, 1e10, held=False)
    solver, coupling, continuation = made.solver, made.coupling, made.continuation
    draw, rejected = np.random.default_rng(seed), 0

    def capricious(solve):
        def solve_or_not(*how, **more):
            found = solve(*how, **more)
            if draw.uniform() < chance:
                solver.problem.guess.value *= -1  # as an attempt does that took the other guess too
                raise NotConverged("drawn", False)
            return found

        return solve_or_not

    solver.solve, solver.attempt = capricious(solver.solve), capricious(solver.attempt)
    loads = [(Control(0.0, -4e-6 * part), 0.0) for part in (0.5, 1.0)]
    loads += [(Control(0.0, None, 2.0), voltage) for voltage in (0.0, 60.0, 90.0)]
    loads += [(Control(x, None, 2.0), 90.0) for x in (1e-6, 3e-6, 8e-6, 20e-6, 40e-6, 80e-6, 60e-6, 20e-6)]
    states = []
    for control, voltage in loads:
        while True:
            solver.iteration.tangent.stale = True  # a factorisation that is kept leaves its roundoff
            try:
                continuation._try(
                    (Control(control.x, control.y, control.force), voltage), Attempt(), pseudo_transient=True
                )
                break
            except NotConverged as failure:
                assert failure.reason == "drawn"
                rejected += 1
                continuation._restore()
        continuation.accept()
        problem, state = solver.problem, continuation.surface_state
        states.append(
            {
                "unknowns": solver.x.array_r.copy(),
                "displacement": problem.w.x.array.copy(),
                "friction history": problem.anchor.x.array.copy(),
                "air gaps": coupling.d_eq.copy(),
                "reaction": solver.reaction.copy(),
                "traction": state.t_t.copy(),
                "imbalance": np.array(solver.imbalance()),
                "guess": problem.guess.value.copy(),
            }
        )
    return states, rejected


@pytest.fixture(scope="module")
def undisturbed():
    return trajectory(0.0, 0)[0]


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.long)])
def test_rejections_leave_no_trace(undisturbed, seed):
    """A run with rejections at random is the undisturbed one, bit for bit."""
    disturbed, rejected = trajectory(0.3, seed)
    assert rejected >= 5
    for k, (state, other) in enumerate(zip(undisturbed, disturbed, strict=True)):
        for name, value in state.items():
            assert np.array_equal(value, other[name]), f"{name} of step {k + 1}"
