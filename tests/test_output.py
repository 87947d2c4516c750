"""Cell means, receptor sites and lines of a body against closed forms."""

import dolfinx
import numpy as np
import pytest
import ufl
from matplotlib.tri import Triangulation
from mpi4py import MPI

from variational import kinematics
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.materials import ogden, saint_venant
from variational.materials.ogden import Ogden
from variational.materials.saint_venant import SaintVenant
from variational.output import Cellwise, Lines, Receptors
from variational.problem import Problem
from variational.snapshot import loops, outline
from variational.surface import Surface

pytestmark = pytest.mark.mpi

SKIN, NAIL = 1, 2
SOLIDS = {SKIN: Ogden(shear_modulus=86760.0, alpha=-14.53, poisson=0.48), NAIL: SaintVenant(young=1e6, poisson=0.3)}
F_GIVEN = np.array([[1.08, 0.12], [-0.05, 0.91]])
F_EQUAL = np.array([[1.05, 0.0], [0.0, 1.05]])  # in-plane stretches coincide
ROUNDOFF = 1e-12  # relative: closed forms against compiled ones; the energy loses digits as a difference of ones


def block(comm: MPI.Comm = MPI.COMM_WORLD) -> Problem:
    """Return a block of 1 mm x 1 mm, skin below and nail above, without load."""
    mesh = dolfinx.mesh.create_rectangle(comm, [np.zeros(2), np.full(2, 1e-3)], [6, 6])
    cells = np.arange(mesh.topology.index_map(2).size_local + mesh.topology.index_map(2).num_ghosts, dtype=np.int32)
    above = dolfinx.mesh.compute_midpoints(mesh, 2, cells)[:, 1] > 0.5e-3
    cell_tags = dolfinx.mesh.meshtags(mesh, 2, cells, np.where(above, NAIL, SKIN).astype(np.int32))
    mesh.topology.create_connectivity(1, 2)
    # The lower facets in the middle: corner cells would have two facets on the surface.
    low = dolfinx.mesh.locate_entities_boundary(mesh, 1, lambda x: np.isclose(x[1], 0) & (np.abs(x[0] - 5e-4) < 4e-4))
    facet_tags = dolfinx.mesh.meshtags(mesh, 1, np.sort(low), np.full(len(low), 7, dtype=np.int32))
    interface = Interface(Penalty(eps_n=1e12, eps_t=1e11), friction=0.25, h_0=0.5e-6)
    return Problem(mesh, cell_tags, Surface(mesh, facet_tags, {0: 7}), SOLIDS, interface)


def deform(problem: Problem, F: np.ndarray) -> None:
    problem.w.interpolate(lambda x: (F - np.eye(2)) @ x[:2])


def energy_3d(tag: int, F: np.ndarray, stretch_3: float = 1.0) -> float:
    """Return the energy density of the three-dimensional solid, from eigenvalues: no UFL and no plane strain."""
    full = np.zeros((3, 3))
    full[:2, :2], full[2, 2] = F, stretch_3
    solid, J = SOLIDS[tag], np.linalg.det(full)
    if isinstance(solid, SaintVenant):
        lame, shear = saint_venant.lame_constants(solid.young, solid.poisson)
        E = (full.T @ full - np.eye(3)) / 2
        return float(lame / 2 * np.trace(E) ** 2 + shear * np.sum(E * E))
    a = ogden.exponent(solid.alpha, solid.convention)
    stretches = J ** (-1 / 3) * np.sqrt(np.linalg.eigvalsh(full.T @ full))
    bulk = ogden.bulk_modulus(solid.shear_modulus, solid.poisson)
    return float(2 * solid.shear_modulus / a**2 * (np.sum(stretches**a) - 3) + bulk / 2 * (J - 1) ** 2)


def cauchy_3d(tag: int, F: np.ndarray) -> np.ndarray:
    """Return the Cauchy stress (3, 3) by central differences of :func:`energy_3d`."""
    h, P = 1e-5, np.zeros((3, 3))
    for i in range(2):
        for j in range(2):
            step = np.zeros((2, 2))
            step[i, j] = h
            P[i, j] = (energy_3d(tag, F + step) - energy_3d(tag, F - step)) / (2 * h)
    P[2, 2] = (energy_3d(tag, F, 1 + h) - energy_3d(tag, F, 1 - h)) / (2 * h)
    full = np.eye(3)
    full[:2, :2] = F
    return P @ full.T / np.linalg.det(F)


@pytest.fixture(scope="module")
def problem() -> Problem:
    return block()


@pytest.mark.parametrize("F", [F_GIVEN, F_EQUAL], ids=["general", "equal stretches"])
def test_cauchy_stress(problem, F):
    """All nine components of both solids; 1e-9 of the largest is what central differences leave ((h a)^2 / 24)."""
    deform(problem, F)
    gradient = kinematics.deformation_gradient(ufl.grad(problem.u))
    expressions = {tags: kinematics.cauchy(law, gradient) for tags, law in problem.laws.items()}
    found = Cellwise(problem.mesh, problem.cell_tags, expressions, np.array([[0.3, 0.3]])).evaluate()[:, 0]
    for tag in SOLIDS:
        cells = problem.cell_tags.find(tag)
        expected = cauchy_3d(tag, F)
        error = np.abs(found[cells[cells < len(found)]] - expected.ravel()).max(initial=0)
        assert error < 5e-9 * np.abs(expected).max()


def test_gathered_mesh(problem):
    """Rank 0 has every vertex and cell once, with its displacement, density and tag; the others have nothing.

    Tolerance: roundoff of a millimetre and of its square.
    """
    deform(problem, F_GIVEN)
    snapshot = Lines(problem).snapshot(problem)
    assert (snapshot is None) == (problem.mesh.comm.rank > 0)
    if snapshot is None:
        return
    lines = 4 * 6 + 6  # around the square, and between its two layers
    assert snapshot.lines.shape == (lines, 3) and snapshot.x.shape == snapshot.u.shape == (49 + lines, 2)
    begin, middle, end = snapshot.x[snapshot.lines].swapaxes(0, 1)
    assert np.abs(middle - (begin + end) / 2).max() < 1e-17
    assert snapshot.triangles.shape == (72, 3)
    assert np.abs(snapshot.x + snapshot.u - snapshot.x @ F_GIVEN.T).max() < 1e-17
    strain = (F_GIVEN.T @ F_GIVEN - np.eye(2)) / 2
    assert snapshot.strain == pytest.approx(np.tile(strain[[0, 1, 0], [0, 1, 1]], (72, 1)), abs=1e-13)
    for tag in SOLIDS:  # 5e-9 is of the central differences
        sigma = cauchy_3d(tag, F_GIVEN)
        error = snapshot.stress[snapshot.tag == tag] - sigma[[0, 1, 2, 0], [0, 1, 2, 1]]
        assert np.abs(error).max() < 5e-9 * np.abs(sigma).max()
    corners = snapshot.x[snapshot.triangles]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    assert np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2 == pytest.approx(1e-6, rel=1e-12, abs=0)
    above = corners[:, :, 1].mean(axis=1) > 0.5e-3
    assert (snapshot.tag == np.where(above, NAIL, SKIN)).all()
    expected = np.where(above, energy_3d(NAIL, F_GIVEN), energy_3d(SKIN, F_GIVEN))
    assert snapshot.sed == pytest.approx(expected, rel=ROUNDOFF)


def test_receptors(problem):
    """Density and current position at sites inside cells, on an edge and on a vertex, the same on every rank.

    Tolerance: the constant; roundoff of a millimetre.
    """
    sites = np.array([[0.31e-3, 0.22e-3], [0.25e-3, 0.75e-3], [1e-3 / 3, 1e-3 / 6], [0.0, 1e-3], [0.5e-3, 0.1e-3]])
    deform(problem, F_GIVEN)
    receptors = Receptors(problem, sites)
    tags = [SKIN, NAIL, SKIN, NAIL, SKIN]
    assert receptors.sed() == pytest.approx([energy_3d(tag, F_GIVEN) for tag in tags], rel=ROUNDOFF)
    assert np.abs(receptors.positions() - sites @ F_GIVEN.T).max() < 1e-17


def test_receptor_outside(problem):
    """The message names the site, on every rank."""
    with pytest.raises(ValueError, match="receptor site 1 at x = 0.002 m, y = 0.0005 m lies outside the mesh"):
        Receptors(problem, np.array([[0.5e-3, 0.5e-3], [2e-3, 0.5e-3]]))
    with pytest.raises(ValueError, match="no receptor site"):
        Receptors(problem, np.zeros((0, 2)))


# -- lines of a body, beside closed forms: loops and areas -----------------------------------------------------------
def square(n: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and triangles, either way round, of a square of two units with a hole of a third of its side."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1)))
    triangles = Triangulation(x, y).triangles.astype(np.int64)
    centre = np.abs(np.column_stack([x, y])[triangles].mean(axis=1)).max(axis=1)
    triangles = triangles[centre > 1 / 3]
    triangles[::2] = triangles[::2, ::-1]
    return np.column_stack([x, y]), triangles


def area(points: np.ndarray) -> float:
    """Return the area inside a polygon, positive where it is counterclockwise."""
    x, y = points.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def test_loops_go_around_each_part():
    """A part is on their left: its outer loop is counterclockwise and that of a hole is clockwise."""
    x, triangles = square()
    tag = np.where(x[triangles].mean(axis=1)[:, 1] > 0, 7, 5).astype(np.int32)
    ends, cells, edge = outline(x, triangles, tag)
    apart = triangles[cells[:, 0]] != triangles[cells[:, 0], edge][:, None]
    assert (np.sort(triangles[cells[:, 0]][apart].reshape(-1, 2)) == np.sort(ends)).all()
    lines = np.stack([ends[:, 0], ends[:, 0], ends[:, 1]], axis=1)
    areas = {part: sorted(area(x[loop[:, 0]]) for loop in loops(lines, cells, tag, part)) for part in (5, 7, 0)}
    assert areas[5] == pytest.approx([2 - 2 / 9]) == areas[7]
    assert areas[0] == pytest.approx([-4, 4 / 9])
