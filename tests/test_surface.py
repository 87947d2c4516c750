"""History, integrals, contact patches and the highest pressure of the surface, on any number of ranks."""

from itertools import permutations
from types import SimpleNamespace

import basix.ufl
import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

from geometry import tags
from geometry.bodies import block
from geometry.mesh import TaggedMesh, load
from tests.measures import integral
from variational.ends import Ends
from variational.resultants import highest, neighbours
from variational.surface import Surface

pytestmark = pytest.mark.mpi


@pytest.fixture(scope="module")
def strip() -> TaggedMesh:
    """A strip of triangles in each of the six orders of their nodes: facets of any local number and direction.

    The builder of meshes gives boundary facets one local number only; nothing says that it must.
    """
    comm, count = MPI.COMM_WORLD, 12
    low = np.stack([np.arange(count + 1), np.zeros(count + 1)], axis=1)
    high = np.stack([np.arange(count) + 0.5, np.ones(count)], axis=1)
    orders = list(permutations(range(3)))
    cells = [np.array([k, k + 1, count + 1 + k])[list(orders[k % 6])] for k in range(count)]
    cells += [np.array([count + 1 + k, k + 1, count + 2 + k]) for k in range(count - 1)]
    cells = np.array(cells, dtype=np.int64) if comm.rank == 0 else np.empty((0, 3), dtype=np.int64)
    x = np.concatenate([low, high]) * 1e-4 if comm.rank == 0 else np.empty((0, 2))
    element = basix.ufl.element("Lagrange", "triangle", 1, shape=(2,))
    domain = mesh.create_mesh(comm, cells=cells, x=x, e=element)
    facets = np.sort(mesh.locate_entities_boundary(domain, 1, lambda x: np.isclose(x[1], 0)))
    marked = mesh.meshtags(domain, 1, facets, np.full(len(facets), tags.ridge(0), dtype=np.int32))
    return TaggedMesh(domain, marked, marked)


def make(body) -> Surface:
    return Surface(body.mesh, body.facet_tags, {j: tags.ridge(j) for j in body.ridges()})


def points(surface):
    """Return reference coordinates at the surface's points, shape (2, facets, points)."""
    x = ufl.SpatialCoordinate(surface.mesh)
    return surface.evaluate(surface.compile([x[0], x[1]]))


def total(surface, integrand) -> float:
    """Integrate over the surface and all ranks."""
    part = fem.assemble_scalar(fem.form(integrand * surface.measure))
    return surface.mesh.comm.allreduce(part)


@pytest.mark.parametrize(("written", "read"), [(np.sin, ufl.sin), (np.array, lambda x: x)], ids=["sine", "abscissa"])
@pytest.mark.parametrize("body", ["square", "strip", "finger_mesh"])
def test_history_is_read_where_it_was_written(body, written, read, request):
    """A form finds at each point what was written there, of no polynomial shape.

    Tolerance: the square of the roundoff of a small linear solve, some 1e-16.
    """
    surface = make(request.getfixturevalue(body))
    history = fem.Function(surface.history_space)
    surface.set_history(history, written(3e4 * points(surface)[0]))
    there = read(3e4 * ufl.SpatialCoordinate(surface.mesh)[0])
    assert total(surface, (history - there) ** 2) < 1e-29 * total(surface, there**2)


@pytest.mark.parametrize("name", ["strip", "finger_mesh"])
def test_every_facet_is_counted_once(name, request):
    """Facets of all ranks together have the length that the mesh's own measure gives. Tolerance: roundoff."""
    body = request.getfixturevalue(name)
    surface = make(body)
    lengths = surface.per_ridge(np.ones((len(surface.pairs), 4)))
    for k, j in enumerate(surface.ridge_numbers):
        assert lengths[k] == pytest.approx(integral(body, tags.ridge(j), kind="ds"), rel=1e-12, abs=0)


# -- contact patches -----------------------------------------------------------------------------------
def below(surface, x, y, level) -> float:
    """Return the current length below a level on all ranks."""
    return float(surface.sum_over_facets(surface.closed_length(x, y, y - level)).sum())


@pytest.mark.parametrize("part", [0.0, 0.03, 0.37, 0.5, 0.81, 1.0])
@pytest.mark.parametrize("slope", [1e-6, 0.1, 1.0])
def test_flat_skin_partly_below(square, slope, part):
    """A slope is below a level over its lower part. Tolerance: roundoff of a root that a flat slope leaves."""
    surface = make(square)
    x, _ = points(surface)
    y = 1e-4 + slope * (x + 0.5e-3)
    expected = part * 1e-3 * np.hypot(1, slope)
    assert below(surface, x, y, 1e-4 + part * slope * 1e-3) == pytest.approx(expected, rel=1e-10, abs=1e-13)


def test_order_of_the_contact_length():
    """A circle, through second-order displacements: its ends inside facets converge with the third order.

    The interpolation's error at the end is h^3 times a function of the end's place in its facet, so single
    rates vary; the fit over four meshes is held to 2.5, far from the first order of counting points. The finest
    mesh is 4e-8 off.
    """
    radius, depth = 0.8e-3, 0.1e-3
    exact = 2 * radius * np.arccos(1 - depth / radius)
    sizes, errors = 0.5 ** np.arange(4) * 0.1e-3, []
    for size in sizes:
        surface = make(load(MPI.COMM_WORLD, block(1.1e-3, 0.2e-3, size)))
        u = fem.Function(fem.functionspace(surface.mesh, ("Lagrange", 2, (2,))))
        u.interpolate(lambda x: np.stack([0 * x[0], radius - depth - np.sqrt(radius**2 - x[0] ** 2)]))
        position = ufl.SpatialCoordinate(surface.mesh) + u
        x, y = surface.evaluate(surface.compile([position[0], position[1]]))
        errors.append(abs(below(surface, x, y, 0.0) / exact - 1))
    assert errors[-1] < 2e-7
    assert np.polyfit(np.log(sizes), np.log(errors), 1)[0] > 2.5


# -- the highest pressure from mean pressures of facets: exact for parabolas, blind to a saw, as good on the half ----
def facets(edges, p, closed=None):
    """Return forces (N/m), widths (m), parts in contact (m) and ends (m) of facets under a pressure (Pa)."""
    gauss, weights = np.polynomial.legendre.leggauss(8)
    width = np.diff(edges)
    x = edges[:-1, None] + width[:, None] * (1 + gauss) / 2
    force = (p(x) @ weights) * width / 2
    ends = np.stack([np.stack([edges[k : len(edges) - 1 + k], 0 * width], axis=1) for k in (0, 1)], axis=1)
    return force, width, width.copy() if closed is None else closed, ends


def highest_of(force, width, closed, ends):
    return highest(force, width, closed, neighbours(ends))


@pytest.mark.parametrize("seed", range(4))
def test_a_parabola_is_found_exactly_in_any_order_of_uneven_facets(seed):
    rng = np.random.default_rng(seed)
    edges = np.concatenate([[-1.0], np.sort(rng.uniform(-0.9, 0.9, 12)), [1.0]])
    at = rng.uniform(-0.3, 0.3)
    found = rng.permutation(13)
    given = facets(edges, lambda x: 3.0 - (x - at) ** 2)
    assert highest_of(*(each[found] for each in given)) == pytest.approx(3.0, rel=1e-12)
    turned = [each[found] for each in given]
    turned[3] = turned[3][:, ::-1]  # from the second end to the first
    assert highest_of(*turned) == pytest.approx(3.0, rel=1e-12)


def test_a_saw_of_five_per_cent_within_facets_moves_it_by_less_than_a_thousandth():
    edges = np.linspace(-1.0, 1.0, 15)
    width = edges[1] - edges[0]

    def pressure(x, saw=0.0):
        t = (x + 1) / width % 1
        return np.sqrt(np.maximum(1 - x**2, 0)) * (1 + saw * (6 * t * (1 - t) - 1))  # of no mean

    smooth, rough = (highest_of(*facets(edges, lambda x, saw=saw: pressure(x, saw))) for saw in (0.0, 0.05))
    assert smooth == pytest.approx(1.0, abs=1e-3)
    assert rough == pytest.approx(smooth, abs=1e-3)
    assert pressure(np.linspace(-1, 1, 10001), 0.05).max() > 1.015  # what single points would give


def test_it_converges_with_the_facets_to_the_highest_value_of_a_hertzian_pressure():
    errors = []
    for count in (8, 16, 32):
        edges = np.linspace(-1.1, 1.0, count + 1)
        errors.append(abs(highest_of(*facets(edges, lambda x: np.sqrt(np.maximum(1 - x**2, 0)))) - 1))
    assert errors[1] < errors[0] / 4
    assert errors[2] < errors[1] / 4


def test_the_half_of_a_symmetric_contact_has_the_value_of_the_whole():
    edges = np.linspace(-1.0, 1.0, 13)
    whole = facets(edges, lambda x: 2.0 - x**2)
    half = [each[6:] for each in whole]
    mirrored = [np.concatenate([each, each]) for each in half[:3]]
    mirrored.append(np.concatenate([half[3], half[3] * [-1.0, 1.0]]))
    assert highest_of(*mirrored) == pytest.approx(highest_of(*whole), rel=1e-12)


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_ends_of_a_cylinders_contact_move_as_its_pressure_does(tilt):
    """Ends at -49.3 and 50.4 µm on facets of 2 µm, which move by -1 and +2 as the pressure grows."""
    edges = 1e-6 * np.linspace(-60.0, 60.0, 61)
    gauss, weights = np.polynomial.legendre.leggauss(4)
    x = edges[:-1, None] + np.diff(edges)[:, None] * (1 + gauss) / 2

    def state(part):
        at = x * (1 - 4e4 * part)
        square = (1e10 + 3e14 * part) * (50.4e-6 + 2 * part - at) * (at + 49.3e-6 + part) * (1 + tilt * at / 60e-6)
        return SimpleNamespace(x=at, p_n=np.sqrt(np.maximum(square, 0)))

    ends, given = facets(edges, np.zeros_like)[3], {"ridge": np.zeros(60, int), "ridge_numbers": [0]}
    given |= {"ends": lambda: ends, "mesh": SimpleNamespace(comm=MPI.COMM_SELF), "weights": weights / 2}
    change = SimpleNamespace(x=-4e4 * x, p_n=(state(1e-11).p_n - state(-1e-11).p_n) / 2e-11)
    assert Ends(SimpleNamespace(**given), state(0.0)).rates(change) == pytest.approx(3.0, rel=2e-3)
