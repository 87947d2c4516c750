r"""The ridge in GetFEM: an energy and a weak form in its assembly language, history as its data at integration points.

The stretches are those of the eigenvalues of C, :math:`\lambda^2 = \tfrac12 \mathrm{tr} C \pm r` with
:math:`r^2 = \tfrac14 (C_{11} - C_{22})^2 + C_{12}^2 + \delta^2`: delta keeps the root's derivatives finite where the
two coincide and changes the energy by G_0 delta^2. GetFEM differentiates both forms by itself.
"""

import subprocess

import getfem as gf
import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve

from benchmarks.peers.exchange import DELTA, MOST, TOLERANCE, Answer, Case, Load, Ridge, main, nearest, plain

_SKIN = 1  # number of a region
_MACROS = {
    "F": "(Id(2) + Grad_u)",
    "C": "(F' * F)",
    "J": "Det(F)",
    "root": "sqrt(sqr((C(1,1) - C(2,2)) / 2) + sqr(C(1,2)) + sqr(delta))",
    "powers": "(pow(J, -a / 3) * (pow(Trace(C) / 2 + root, a / 2) + pow(Trace(C) / 2 - root, a / 2) + 1))",
    "p": "(eps_n * pos_part(-X(2) - u(2)))",
    "t": "min(max(eps_t * (anchor - u(1)), -mu_f * p), mu_f * p)",
}


def mesh_of(ridge: Ridge) -> gf.Mesh:
    """Return the mesh with its touching edges as a region."""
    mesh = gf.Mesh("empty", 2)
    corners = ridge.triangles[:, :3]
    cells = mesh.add_convex(gf.GeoTrans("GT_PK(2,1)"), ridge.points[corners].transpose(2, 1, 0))
    skin = ridge.skin_pairs
    faces = [
        (cell, opposite)
        for cell, vertices in zip(cells, plain(corners), strict=True)
        for opposite in range(3)
        if frozenset(vertices[:opposite] + vertices[opposite + 1 :]) in skin
    ]
    mesh.set_region(_SKIN, np.array(faces).T)
    return mesh


def solve(case: Case, ridge: Ridge) -> Answer:
    """Lead the ridge along the loads."""
    gf.util_trace_level(1)
    mesh = mesh_of(ridge)
    space = gf.MeshFem(mesh, 2)
    space.set_fem(gf.Fem("FEM_PK(2,2)"))
    body = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(2)"))
    edges = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(7)"))  # four Gauss points on an edge
    at_points = gf.MeshImData(edges, _SKIN)

    model = gf.Model("real")
    model.add_fem_variable("u", space)
    model.add_im_data("anchor", at_points)
    data = {"a": case.exponent, "G": case.shear_modulus, "K": case.bulk_modulus, "delta": DELTA}
    for name, value in {**data, "eps_n": case.eps_n, "eps_t": case.eps_t, "mu_f": case.mu_f}.items():
        model.add_initialized_data(name, [value])
    for name, text in _MACROS.items():
        model.add_macro(name, text)
    model.add_nonlinear_term(body, "2 * G / sqr(a) * (powers - 3) + K / 2 * sqr(J - 1)")
    model.add_nonlinear_term(edges, "-p * Test_u(2) - t * Test_u(1)", _SKIN)

    # GetFEM numbers components of a node one after the other.
    places = space.basic_dof_nodes()[:, ::2].T
    node = np.array(nearest(places, ridge.points))
    held = {"x": 2 * node[ridge.held], "y": 2 * node[ridge.top] + 1}
    skin = node[ridge.skin.ravel()]
    query = ["dpkg-query", "-W", "-f", "${Version}", "python3-getfem"]
    version = subprocess.run(query, check=True, capture_output=True, text=True).stdout
    answer = Answer("GetFEM", version, "LGPL 3 or later")
    answer.ready()
    for load in case.loads:
        forces = _newton(model, held, load, answer)
        points = (model.interpolation(text, at_points, _SKIN) for text in ("X(1) + u(1)", "p", "t"))
        u = model.variable("u").reshape(-1, 2)
        answer.report(load, -forces[held["y"]].sum(), -forces[held["x"]].sum(), u[skin], *points)
        model.set_variable("anchor", model.interpolation("u(1) + t / eps_t", at_points, _SKIN))
    return answer


def _newton(model: gf.Model, held: dict[str, np.ndarray], load: Load, answer: Answer) -> np.ndarray:
    """Find the equilibrium at a load; return the nodal forces that the supports bear (N/mm)."""
    u = model.variable("u").copy()
    step = np.zeros_like(u)
    step[held["x"]], step[held["y"]] = load.x - u[held["x"]], load.y - u[held["y"]]
    free = np.setdiff1d(np.arange(len(u)), np.concatenate(list(held.values())))
    for iteration in range(MOST):
        model.set_variable("u", u)
        model.assembly("build_all")
        forces = -model.rhs()
        if iteration and np.linalg.norm(forces[free]) < TOLERANCE:
            answer.iterations += iteration
            return forces
        tangent = model.tangent_matrix()
        rows, columns = tangent.csc_ind()[::-1]
        A = csc_matrix((tangent.csc_val(), rows, columns), shape=tangent.size())[free]
        step[free] = spsolve(A[:, free], -forces[free] - A @ step)
        u += step
        step[:] = 0.0
    raise RuntimeError("Newton's method found no equilibrium")


if __name__ == "__main__":
    main(solve)
