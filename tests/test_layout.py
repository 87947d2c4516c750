"""A body glued to a rigid one: the numbering is T, which gives all rim nodes one translation."""

import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from numpy.testing import assert_allclose

from variational.solvers.layout import RigidRimLayout

pytestmark = pytest.mark.mpi
CELLS = 4


@pytest.fixture(params=[1, 2], ids=["linear", "quadratic"])
def space(request) -> fem.FunctionSpace:
    """Vectors on a unit square."""
    domain = mesh.create_unit_square(MPI.COMM_WORLD, CELLS, CELLS)
    return fem.functionspace(domain, ("Lagrange", request.param, (2,)))


@pytest.fixture
def layout(space) -> RigidRimLayout:
    return RigidRimLayout(space, rim(space.mesh))


def rim(domain):
    return mesh.locate_entities_boundary(domain, 1, lambda x: np.isclose(x[1], 1))


def bilinear(space):
    """Return a form without any symmetry, and free of stress under translation."""
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    x = ufl.SpatialCoordinate(space.mesh)
    skew = ufl.as_matrix([[1, 3], [-2, 5]])
    return ufl.inner(ufl.grad(u) * skew + (1 + x[0]) * ufl.grad(u).T, ufl.grad(v)) * ufl.dx


def smooth(space) -> fem.Function:
    """Return a field that is (0.7, -0.4) on the rim."""
    f = fem.Function(space)
    f.interpolate(
        lambda x: np.stack([0.7 + (1 - x[1]) * np.sin(3 * x[0]), -0.4 + (1 - x[1]) * np.cos(2 * x[0] + x[1])])
    )
    return f


def unknowns(layout, f):
    """Return the vector of unknowns of a field that is (0.7, -0.4) on the rim."""
    x = layout.create_vector()
    layout.from_nodes(f.x.array, np.array([0.7, -0.4]), x)
    return x


def matrix(layout, space):
    A = layout.create_matrix()
    fem.petsc.assemble_matrix(A, fem.form(bilinear(space)))
    A.assemble()
    return A


def test_round_trip(space, layout):
    """Nodal values survive the way to the unknowns and back, ghosts included."""
    f, back = smooth(space), np.empty_like(smooth(space).x.array)
    layout.to_nodes(unknowns(layout, f), back)
    assert_allclose(back, f.x.array, rtol=0, atol=1e-15)


@pytest.mark.parametrize("transposed", [False, True])
def test_matrix_is_the_reduced_one(space, layout, transposed):
    """The matrix times the unknowns of u is T^T times the action on u. Tolerance: roundoff of some thirty terms.

    The same for the rows: the product of the transposed matrix and the action of the adjoint form.
    """
    A, f, form = matrix(layout, space), smooth(space), bilinear(space)
    nodal = fem.assemble_vector(fem.form(ufl.action(ufl.adjoint(form) if transposed else form, f))).array
    expected, product = layout.create_vector(), layout.create_vector()
    expected.set(0.0)
    layout.add_to_unknowns(nodal, expected)
    (A.multTranspose if transposed else A.mult)(unknowns(layout, f), product)
    assert_allclose(product.array_r, expected.array_r, rtol=0, atol=1e-13 * expected.norm(3))
