"""The ridge by this package, and its mesh for the others."""

from collections.abc import Iterator

import dolfinx
import numpy as np
from mpi4py import MPI

from benchmarks.peers.exchange import Answer, Case, Load, Ridge, left_to_right, nearest
from geometry import tags
from geometry.bodies import ridge
from geometry.mesh import TaggedMesh, load
from variational.body import Body
from variational.compat import cell_geometry
from variational.contact.formulation import SurfaceState
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.solvers.target import Control

_MM = 1e-3  # m
_STIFFNESS = 1e9  # Pa/m in a N/mm^3
_H_0 = 0.514e-6  # m, without effect: there is no voltage
_IMBALANCE = 1e-9  # N/m


def make(size: float) -> TaggedMesh:
    """Return the ridge with straight facets of a given length (mm), which every program takes."""
    body = load(MPI.COMM_SELF, ridge(size * _MM))
    cells, x = cell_geometry(body.mesh), body.mesh.geometry.x
    for middle, (a, b) in zip(cells[:, 3:].T, ((1, 2), (0, 2), (0, 1)), strict=True):
        x[middle] = (x[cells[:, a]] + x[cells[:, b]]) / 2
    return body


def for_peers(body: TaggedMesh) -> Ridge:
    """Return the same mesh for the others, with a node in the middle of each edge."""
    mesh, nodes, x = body.mesh, cell_geometry(body.mesh), body.mesh.geometry.x[:, :2] / _MM
    used = np.unique(nodes[:, :3])
    corners, cells = x[used], np.searchsorted(used, nodes[:, :3])
    opposite = np.sort(cells[:, [[1, 2], [0, 2], [0, 1]]].reshape(-1, 2), axis=1)
    edges: np.ndarray
    edges, first = np.unique(opposite, axis=0, return_index=True)
    clockwise = np.linalg.det(corners[cells[:, 1:]] - corners[cells[:, :1]]) < 0
    cells[clockwise, 1:] = cells[clockwise, :0:-1]
    pairs = np.sort(cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    number = np.unique(pairs, axis=0, return_inverse=True)[1]
    triangles = np.hstack([cells, len(corners) + number.reshape(-1, 3)])
    middle_of = {frozenset((int(a), int(b))): len(corners) + k for k, (a, b) in enumerate(edges.reshape(-1, 2))}

    def edges_of(tag: int) -> np.ndarray:
        facets = body.facet_tags.find(tag)
        ends = np.searchsorted(used, dolfinx.mesh.entities_to_geometry(mesh, 1, facets)[:, :2])
        return np.array([[*pair, middle_of[frozenset(pair)]] for pair in ends.tolist()])

    points = np.vstack([corners, x[nodes[:, 3:].ravel()[first]]])
    skin = edges_of(tags.ridge(0))
    held = (np.unique(edges_of(tag)) for tag in (tags.BONE_RIM, tags.SIDES))
    return Ridge(points, triangles, left_to_right(skin, points[skin, 0]), *held)


def create(case: Case, tagged: TaggedMesh) -> Body:
    """Return the ridge of a case on a mesh, its sides fixed to its top."""
    skins = {tags.STRATUM_CORNEUM: Ogden(case.shear_modulus * 1e6, -case.exponent, case.poisson)}
    law = Interface(Penalty(case.eps_n * _STIFFNESS, case.eps_t * _STIFFNESS), case.mu_f, _H_0)
    return Body(tagged, skins, law, tolerance=_IMBALANCE, moving_sides=tagged.facets(tags.SIDES))


def follow(case: Case, made: Body) -> Iterator[tuple[Load, SurfaceState]]:
    """Lead the ridge along the loads; yield each with the skin then.

    The screen is moved instead of top and sides, the other way: the screen acts on friction by its anchors alone.
    """
    problem, solver = made.problem, made.solver
    for before, now in case.steps():
        moved = (now.x - before.x) * _MM
        problem.history.accept(problem.history.translated(-moved))
        solver.x.array_w[-2] -= moved  # of the bone and all that is relative to it: no point slips at first
        solver.new_load(Control(0.0, now.y * _MM), 0.0, slipping=bool(now.x))
        solver.solve()
        s = made.observer.state()
        problem.history.accept(s.history)
        yield now, s


def solve(case: Case, body: TaggedMesh, skin: np.ndarray) -> Answer:
    """Lead the ridge along the loads.

    Args:
        case: penalty per reference area.
        body: made by :func:`make`.
        skin: places (mm) of the skin's nodes to be reported.
    """
    made = create(case, body)
    problem, solver, observer = made.problem, made.solver, made.observer
    places = problem.V.tabulate_dof_coordinates()[:, :2] / _MM
    nodes = nearest(places, skin)
    answer = Answer("fingerpad")
    for now, s in follow(case, made):
        displacement = problem.displacement()[nodes] / _MM + (now.x, 0.0)
        f_n, f_t = solver.reaction[1] * _MM, observer.ridge_loads(s).f_friction[0] * _MM
        answer.report(now, f_n, f_t, displacement, s.p_n / 1e6)
    answer.iterations = solver.counts.newton
    return answer
