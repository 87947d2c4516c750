r"""The subfield of one Merkel site: its stress under a line load that moves over the skin, in one linear solve.

The finger is linearised about the unloaded state. With the stiffness K, forces f and the functional j of the mean
compressive stress in the element of the site, the response is j . K^-1 f = w . f with K w = j, since K is symmetric:
at each point of the skin the vertical component of w is the response to a unit line load pressing there.
"""

from functools import partial

import numpy as np
import ufl
from dolfinx import fem, geometry
from dolfinx.fem.petsc import LinearProblem
from mpi4py import MPI
from numpy.typing import NDArray

from benchmarks.measured import felt
from fingerpad.model.options import FingerModel, by_rule, plan
from geometry import fingertip, mesh
from geometry.profiles import Profiles
from variational import kinematics
from variational.output import owned_cells

Array = NDArray[np.float64]


def response() -> tuple[Array, Array]:
    """Return arc lengths from the middle of ridge 0 (m), and the site's stress over its largest; on one rank."""
    scene = felt.onset()
    model, profiles = FingerModel(by_rule(scene), plan(scene)), Profiles(scene.geometry)
    tagged = mesh.load(MPI.COMM_SELF, partial(fingertip.build, model.geometry, model.mesh, True, False, ()))
    V = fem.functionspace(tagged.mesh, ("Lagrange", 2, (2,)))
    u, v, du = fem.Function(V), ufl.TestFunction(V), ufl.TrialFunction(V)
    F = kinematics.deformation_gradient(ufl.grad(u))
    dx = ufl.Measure("dx", tagged.mesh, subdomain_data=tagged.cell_tags)
    stiffness = sum(
        ufl.derivative(ufl.inner(kinematics.first_piola_kirchhoff(solid, F), ufl.grad(v)) * dx(tag), u, du)
        for tag, solid in model.solids.items()
    )
    site = profiles.merkel_sites()[list(profiles.ridges).index(0)]
    here = fem.Function(fem.functionspace(tagged.mesh, ("Discontinuous Lagrange", 0)))
    cell = _cell(tagged, site)
    here.x.array[cell] = 1.0
    tag = int(tagged.cell_tags.values[tagged.cell_tags.indices == cell][0])
    stress = -kinematics.cauchy(model.solids[tag], F)[1, 1]
    functional = ufl.derivative(here * stress * dx(tag), u, v)
    rim = fem.locate_dofs_topological(V, 1, tagged.rim)
    bcs = [fem.dirichletbc(np.zeros(2), rim, V)]
    direct = {"ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"}
    w = LinearProblem(stiffness, functional, bcs=bcs, petsc_options=direct).solve()
    skin = np.concatenate([tagged.facets(tag) for tag in tagged.ridge_tags().values()])
    nodes = np.unique(fem.locate_dofs_topological(V, 1, skin))
    arcs = profiles.along_skin(V.tabulate_dof_coordinates()[nodes, :2])
    values, order = w.x.array.reshape(-1, 2)[nodes, 1], np.argsort(arcs)
    return arcs[order], values[order] / values.max()


def _cell(tagged: mesh.TaggedMesh, site: Array) -> int:
    """Return the cell in which a point is."""
    tree, place = geometry.bb_tree(tagged.mesh, 2, entities=owned_cells(tagged.mesh)), np.array([[*site, 0.0]])
    near = geometry.compute_collisions_points(tree, place)
    return int(geometry.compute_colliding_cells(tagged.mesh, near, place).links(0)[0])


def width(arcs: Array, values: Array) -> float:
    """Return the width (m) about the largest value over which a response is half of it or more."""
    top = int(values.argmax())
    below = np.flatnonzero(values < 0.5)
    left, right = below[below < top].max(), below[below > top].min()

    def cross(a: int, b: int) -> float:
        return float(arcs[a] + (0.5 - values[a]) / (values[b] - values[a]) * (arcs[b] - arcs[a]))

    return cross(right - 1, right) - cross(left, left + 1)
