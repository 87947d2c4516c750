"""Half a body in the place of one that is its own mirror image, and a whole finger led by its half."""

from dataclasses import dataclass, replace

import basix.ufl
import dolfinx
import numpy as np
import pytest
import ufl
from mpi4py import MPI

from fingerpad.model import options, simulation
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import Simulation
from fingerpad.runs import full as run_module
from fingerpad.scene import from_data
from geometry import tags
from geometry.mesh import TaggedMesh
from tests.runs import followed, run
from tests.small_finger import NINE
from variational.body import Body
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.energy import EnergyBook
from variational.materials.neo_hooke import NeoHooke
from variational.materials.ogden import Ogden
from variational.roughness.bam import BearingArea
from variational.snapshot import Snapshot
from variational.solvers.continuation import Target
from variational.solvers.stability import StabilityCheck

pytestmark = pytest.mark.slow
H_0, WIDTH, HEIGHT, FORCE = 0.514e-6, 0.5e-3, 0.5e-3, 3.0
MU_F = 0.02  # so little that some points slip
SKIN, BOTTOM, TOP, LINE = tags.STRATUM_CORNEUM, tags.ridge(0), tags.BONE_RIM, tags.SYMMETRY


# -- the plan ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("loads", "both"),
    [
        ([{"f_ext": 5.0}, {"voltage": 100.0}], False),
        ([{"f_ext": 5.0, "bone_x": 0.0}], False),
        ([{"f_ext": 5.0}, {"bone_x": -1e-3}, {"bone_x": 0.0}], True),
    ],
)
def test_half_the_finger_where_the_bone_never_moves_sideways(loads, both):
    history = [{"name": f"load {k}"} | load for k, load in enumerate(loads)]
    needed = plan(from_data({"history": history}))
    assert needed.both_halves is both
    assert any("mirror image" in omission.reason for omission in needed.omitted) is not both


# -- a block and its half ----------------------------------------------------------------------------------
def mesh_of(half: bool, n: int = 6) -> dolfinx.mesh.Mesh:
    """Return a block, 2 n x n rectangles halved, its own mirror image to the last diagonal, or its right half."""
    x, y = np.meshgrid(np.linspace(0, WIDTH, n + 1), np.linspace(0, HEIGHT, n + 1))
    points = np.column_stack([x.ravel(), y.ravel()])
    a = np.arange(n * (n + 1)).reshape(n, n + 1)[:, :-1].ravel()
    cells = np.concatenate([np.stack([a, a + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + n + 1], 1)])
    if not half:
        nothing = np.zeros(len(cells))
        whole = Snapshot(points, points, cells, nothing, nothing).whole()
        points, cells = whole.x, whole.triangles
    element = ufl.Mesh(basix.ufl.element("Lagrange", "triangle", 1, shape=(2,)))
    return dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells, x=points, e=element)


class Block:
    """A barrelling block pressed with friction and charged; what it ended in."""

    def __init__(self, half: bool) -> None:
        mesh = mesh_of(half)
        cells = np.arange(mesh.topology.index_map(2).size_local, dtype=np.int32)
        cell_tags = dolfinx.mesh.meshtags(mesh, 2, cells, np.full(len(cells), SKIN, dtype=np.int32))
        mesh.topology.create_connectivity(1, 2)
        where = {BOTTOM: lambda x: x[1] < 1e-9, TOP: lambda x: x[1] > HEIGHT - 1e-9}
        if half:
            where[LINE] = lambda x: x[0] < 1e-9
        found = {tag: dolfinx.mesh.locate_entities_boundary(mesh, 1, place) for tag, place in where.items()}
        facets = np.concatenate(list(found.values()))
        values = np.repeat(np.array(list(found), dtype=np.int32), [len(f) for f in found.values()])
        order = np.argsort(facets)
        facet_tags = dolfinx.mesh.meshtags(mesh, 1, facets[order], values[order])
        body = TaggedMesh(mesh, cell_tags, facet_tags)
        interface = Interface(Penalty(1.5e12, 5e10), MU_F, H_0)
        made = Body(
            body, {SKIN: Ogden(86.76e3, -14.53, 0.48)}, interface, BearingArea(H_0), force_scale=FORCE, tolerance=1e-11,
            mirror=body.facets(LINE) if half else None, coupling_tolerance=1e-10,
        )  # fmt: skip
        problem, self.solver, coupling, self.path = made.problem, made.solver, made.coupling, made.continuation
        path, copies = self.path, 2 if half else 1
        book = EnergyBook(problem, path.surface_state, self.solver.bone, self.solver.reaction, coupling.d_eq, copies)
        path.run(Target("press", f_ext=FORCE))
        path.run(Target("charge", voltage=100.0))
        self.energy = book.step(path.surface_state, self.solver.bone, self.solver.reaction, coupling.d_eq)
        loads = path.observer.ridge_loads(path.surface_state)
        self.loads = loads.whole() if half else loads


@pytest.fixture(scope="module")
def blocks():
    return Block(True), Block(False)


CLOSE = 1e-8  # relative: imbalances of 1e-11 of the load over some hundred nodes and twenty steps


def test_half_block_bears_and_sinks_as_the_whole(blocks):
    half, whole = blocks
    for name in ("f_contact", "f_attraction", "length"):
        assert getattr(half.loads, name) == pytest.approx(getattr(whole.loads, name), rel=CLOSE)
    assert half.path.slip == pytest.approx(whole.path.slip) and half.path.slip[0] > 0
    assert half.solver.layout.global_size < 0.55 * whole.solver.layout.global_size
    assert half.solver.bone[1] == pytest.approx(whole.solver.bone[1], rel=CLOSE)
    assert half.solver.reaction == pytest.approx([0.0, FORCE], rel=CLOSE)
    assert half.path.coupling.d_eq == pytest.approx(whole.path.coupling.d_eq, rel=CLOSE)


def test_half_block_never_slips_one_way(blocks):
    """Where all its points slip forth the image's slip back."""
    slips = []
    for block in blocks:
        state = block.path.surface_state
        slips.append(block.path.observer.slip(replace(state, t_t=MU_F * state.p_n)))
    assert slips == [(1.0, False), (1.0, True)]


def test_stability_of_the_half_is_that_of_the_whole(blocks):
    """The least eigenvalue, of whichever symmetry; Ritz pairs settle to 1e-6 of the largest growth."""
    half, whole = (StabilityCheck(block.solver).check() for block in blocks)
    assert half.settled and whole.settled
    assert half.lambda_min == pytest.approx(whole.lambda_min, rel=1e-4)


# -- the finger --------------------------------------------------------------------------------------------
MESH = {"contact": 12e-6, "receptor": 80e-6, "interface": 150e-6, "growth": 0.8, "touching_half_arc": 0.8e-3}
HISTORY = [{"name": "press", "bone_height": -60e-6}, {"name": "charge", "voltage": 60.0}]


@pytest.fixture(scope="module")
def fingers(tmp_path_factory):
    folders = [tmp_path_factory.mktemp(name) for name in ("half", "whole")]
    scene = from_data({"mesh": MESH, "history": HISTORY, "geometry": {"ridge_count": 9}})
    half = run(scene, folders[0], MPI.COMM_WORLD)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run_module, "plan", lambda scene: options.plan(scene).with_both_halves())
        whole = run(scene, folders[1], MPI.COMM_WORLD)
    assert "failure" not in half and "failure" not in whole
    return (half, whole), folders


@pytest.mark.long
def test_half_the_finger_has_the_whole_s_numbers_and_errors(fingers):
    """Within the air gaps' tolerance of 1e-6: the whole's mesh is the half's and its mirror image.

    Two halves of a length are not known better than one: of the size of the whole's error, of which a facet is a fifth.
    """
    half, whole = fingers[0]
    for name in ("f_ext", "charged_f_contact", "charged_f_electrostatic", "charged_contact_length"):
        assert half[name] == pytest.approx(whole[name], rel=1e-5), name
    error = "charged_contact_length_error"
    assert whole[error] / 5 < half[error] < 5 * whole[error]
    assert "charged_contact_length" in half["accuracy"]["quantities"]
    assert half["unknowns"] < 0.55 * whole["unknowns"]
    assert half["charged_f_t"] == 0.0


# -- a whole finger led by its half until the bone moves sideways: the same states, and where there is none ----------
NEAR = 1e-5  # relative: air gaps are within 1e-6
LOADS = [
    {"name": "press", "f_ext": 1.0},
    {"name": "charge", "voltage": 100.0},
    {"name": "slide", "bone_x": 60e-6},
    {"name": "back", "bone_x": 0.0},
]


BRIEF = [LOADS[0], {"name": "slide", "bone_x": 5e-6}]


def model(history, led: bool = True) -> FingerModel:
    """Return a small finger's model, led by its half or not."""
    scene = by_rule(from_data(NINE | {"history": history}))
    needed = plan(scene)
    assert needed.symmetric_start
    return FingerModel(scene, replace(needed, symmetric_start=led))


FOLLOWED: dict[str, Simulation] = {}


def follow(history, led: bool) -> Simulation:
    """Return a small finger's path, led by its half or not; each path is followed once."""
    key = str((history, led))
    if key not in FOLLOWED:
        path = Simulation(model(history, led), MPI.COMM_WORLD)
        assert path.run() is None
        FOLLOWED[key] = path
    return FOLLOWED[key]


@pytest.mark.parametrize(
    "history",
    [
        pytest.param(LOADS, id="press, charge, slide"),
        pytest.param([{"name": "lower", "bone_height": -60e-6}, *LOADS[2:]], id="bone height", marks=pytest.mark.mpi),
        pytest.param([LOADS[0], {"name": "lift", "f_ext": 0.2}, LOADS[1], BRIEF[1]], id="lift", marks=pytest.mark.long),
    ],
)
def test_half_leads_to_the_states_of_the_whole(history):
    led, whole = (follow(history, half).states for half in (True, False))
    assert [state.load for state in led] == [state.load for state in whole]
    for mine, other in zip(led, whole, strict=True):
        for name in ("f_ext", "bone_height", "f_contact", "f_electrostatic", "contact_length", "slipping"):
            assert getattr(mine, name) == pytest.approx(getattr(other, name), rel=NEAR, abs=1e-12), name
        assert mine.f_t == pytest.approx(other.f_t, rel=NEAR, abs=1e-7)
        assert mine.ridges.d_eq == pytest.approx(other.ridges.d_eq, rel=NEAR, nan_ok=True)


def test_stability_is_examined_on_the_whole_finger(monkeypatch):
    """Where the symmetric state is not stable the result says so; a whole finger's would be symmetric, too."""
    checks, examined = simulation.StabilityChecks.check, []

    def unstable(self, load):
        found = checks(self, load)
        assert self._finger.options.both_halves
        examined.append(load)
        return replace(found, frozen=replace(found.frozen, lambda_min=-1.0))

    monkeypatch.setattr(simulation.StabilityChecks, "check", unstable)
    path = Simulation(model(LOADS[:3]), MPI.COMM_SELF)
    assert path.run() is None
    assert examined[:2] == ["press", "charge"]


@pytest.mark.mpi
def test_mixed_element_is_in_balance_on_the_whole_finger():
    """The pressure comes over with the displacement. Solved for again it left up to 5e-8, with a floor of 0."""
    layers = {layer: {"poisson": 0.4999} for layer in ("stratum_corneum", "viable_epidermis", "dermis")}
    scene = NINE | {"history": BRIEF, "numerics": {"element": "P2-P1"}, "materials": layers}
    scene = by_rule(from_data(scene))
    assert plan(scene).symmetric_start
    path = followed(scene)
    tolerance = scene.numerics.tolerance
    assert [state.record.imbalance for state in path.states if state.record.imbalance > tolerance] == []
    assert [state.record.floor for state in path.states] == [0.0] * len(path.states)


@dataclass(frozen=True)
class Fibres(NeoHooke):
    """Fibres at an angle, which the mirror turns round."""

    stiffness: float = 1e3

    def energy(self, F):
        along = F * ufl.as_vector([0.6, 0.8, 0.0])
        return super().energy(F) + self.stiffness / 2 * (ufl.inner(along, along) - 1) ** 2


@pytest.mark.parametrize(("history", "moves"), [(LOADS, True), (LOADS[:2], False)])
def test_no_half_where_the_finger_is_not_its_own_mirror_image(history, moves):
    """An own material may have fibres at an angle; one of the program's may not."""
    scene = from_data(NINE | {"history": history})
    straight, inclined = (
        plan(scene.replace(materials={"dermis": solid})) for solid in (NeoHooke(2.5e3), Fibres(2.5e3))
    )
    assert (straight.both_halves, straight.symmetric_start) == (moves, moves)
    assert (inclined.both_halves, inclined.symmetric_start) == (True, False)
