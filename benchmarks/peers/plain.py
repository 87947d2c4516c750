"""The ridge as a user of dolfinx writes it without this package: UFL forms, SNES, and MUMPS in every iteration."""

import numpy as np
import ufl
from basix.ufl import element, quadrature_element
from dolfinx import fem, mesh
from dolfinx.fem.petsc import apply_lifting, assemble_matrix, assemble_vector, create_matrix, create_vector, set_bc
from mpi4py import MPI
from petsc4py import PETSc

from benchmarks.peers.exchange import DELTA, MOST, TOLERANCE, Answer, Case, Ridge, nearest

_NODES = [0, 1, 2, 4, 5, 3]  # of a triangle in the order of dolfinx: an edge's middle by the opposite vertex


def solve(case: Case, ridge: Ridge) -> Answer:
    """Lead the ridge along the loads."""
    vertices, corners = ridge.points[: ridge.vertices], ridge.triangles[:, :3]
    given, cells, degree = (ridge.points, ridge.triangles[:, _NODES], 2) if ridge.curved else (vertices, corners, 1)
    msh = mesh.create_mesh(MPI.COMM_SELF, cells=cells, x=given, e=element("P", "triangle", degree, shape=(2,)))
    V = fem.functionspace(msh, ("P", 2, (2,)))
    msh.topology.create_connectivity(1, 2)
    width, height = vertices.max(axis=0)
    top = mesh.locate_entities_boundary(msh, 1, lambda x: np.isclose(x[1], height))
    sides = mesh.locate_entities_boundary(msh, 1, lambda x: np.isclose(abs(x[0]), width))
    skin = np.setdiff1d(mesh.exterior_facet_indices(msh.topology), np.concatenate([top, sides]))

    # Friction's anchors are at the quadrature points of a mesh of the skin.
    sub, of_sub, *_ = mesh.create_submesh(msh, 1, skin)
    to_sub = np.full(msh.topology.index_map(1).size_local, -1, dtype=np.int32)
    to_sub[of_sub] = np.arange(len(of_sub))
    anchor = fem.Function(fem.functionspace(sub, quadrature_element("interval", degree=7)))

    u, v = fem.Function(V), ufl.TestFunction(V)
    F = ufl.Identity(2) + ufl.grad(u)
    C, J, a = F.T * F, ufl.det(F), case.exponent
    root = ufl.sqrt((C[0, 0] - C[1, 1]) ** 2 / 4 + C[0, 1] ** 2 + DELTA**2)
    powers = (ufl.tr(C) / 2 + root) ** (a / 2) + (ufl.tr(C) / 2 - root) ** (a / 2) + 1
    psi = 2 * case.shear_modulus / a**2 * (J ** (-a / 3) * powers - 3) + case.bulk_modulus / 2 * (J - 1) ** 2
    place = ufl.SpatialCoordinate(msh) + u
    p = case.eps_n * ufl.max_value(-place[1], 0)
    t = ufl.max_value(ufl.min_value(case.eps_t * (anchor - u[0]), case.mu_f * p), -case.mu_f * p)
    ds = ufl.Measure("ds", msh, subdomain_data=mesh.meshtags(msh, 1, skin, 1), metadata={"quadrature_degree": 7})
    work = ufl.derivative(psi, u, v) * ufl.dx(metadata={"quadrature_degree": 2}) - (p * v[1] + t * v[0]) * ds(1)
    residual = fem.form(work, entity_maps={sub: to_sub})
    jacobian = fem.form(ufl.derivative(work, u), entity_maps={sub: to_sub})
    at_points = fem.Expression(ufl.as_vector([place[0], u[0], p]), anchor.function_space.element.interpolation_points())

    x, y = (fem.Constant(msh, 0.0) for _ in range(2))
    held = [fem.locate_dofs_topological(V.sub(k), 1, np.concatenate(on)) for k, on in enumerate(([top, sides], [top]))]
    bcs = [fem.dirichletbc(value, dofs, V.sub(k)) for k, (value, dofs) in enumerate(zip((x, y), held, strict=True))]

    def imbalance(_snes: PETSc.SNES, now: PETSc.Vec, f: PETSc.Vec) -> None:
        u.x.array[:], f.array[:] = now.array_r, 0.0
        assemble_vector(f, residual)
        apply_lifting(f, [jacobian], [bcs], [now], -1.0)
        set_bc(f, bcs, now, -1.0)

    def tangent(_snes: PETSc.SNES, _now: PETSc.Vec, A: PETSc.Mat, _P: PETSc.Mat) -> None:
        A.zeroEntries()
        assemble_matrix(A, jacobian, bcs)
        A.assemble()

    forces, now = create_vector(residual), create_vector(residual)
    snes = PETSc.SNES().create(msh.comm)
    snes.setFunction(imbalance, forces)
    snes.setJacobian(tangent, create_matrix(jacobian))
    snes.setTolerances(rtol=0, atol=TOLERANCE, stol=0, max_it=MOST)
    solver = {"ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"}
    for name, value in solver.items():
        PETSc.Options().setValue(name, value)
    snes.setFromOptions()
    places = V.tabulate_dof_coordinates()[:, :2]
    nodes = nearest(places, ridge.points[ridge.skin.ravel()])
    answer = Answer("plain dolfinx")
    for load in case.loads:
        x.value, y.value = load.x, load.y
        snes.solve(None, now)
        if snes.getConvergedReason() <= 0:
            raise RuntimeError(f"SNES ended with reason {snes.getConvergedReason()}")
        answer.iterations += snes.getIterationNumber()
        forces.array[:] = 0.0
        assemble_vector(forces, residual)
        pairs = fem.compute_integration_domains(fem.IntegralType.exterior_facet, msh.topology, of_sub, 1)
        s, u_x, p_n = np.moveaxis(at_points.eval(msh, pairs).reshape(len(of_sub), -1, 3), 2, 0)
        limit, old = case.mu_f * p_n, anchor.x.array.reshape(p_n.shape)
        t_t = np.clip(case.eps_t * (old - u_x), -limit, limit)
        old[:] = u_x + t_t / case.eps_t
        f_n, f_t = -forces.array[held[1]].sum(), -forces.array[held[0]].sum()
        answer.report(load, f_n, f_t, u.x.array.reshape(-1, 2)[nodes], p_n)
    return answer
