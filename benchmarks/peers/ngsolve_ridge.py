r"""The ridge in NGSolve: energies and weak forms written in its own symbols.

The stretches are those of the eigenvalues of C, :math:`\lambda^2 = \tfrac12 \mathrm{tr} C \pm r` with
:math:`r^2 = \tfrac14 (C_{11} - C_{22})^2 + C_{12}^2 + \delta^2`: delta keeps the root's derivatives finite where the
two coincide and changes the energy by G_0 delta^2. Friction anchors are values at the integration points of the skin.
"""

import netgen.meshing as netgen
import ngsolve as ng
import numpy as np

from benchmarks.peers.exchange import DELTA, MOST, TOLERANCE, Answer, Case, Ridge, left_to_right, main

_POINTS = 4  # Gauss points on an edge
_TRIANGLE = ng.IntegrationRule([(1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)], [1 / 6] * 3)


def mesh_of(ridge: Ridge) -> ng.Mesh:
    """Return the mesh, with boundaries named skin, top and sides."""
    mesh = netgen.Mesh(dim=2)
    points = [mesh.Add(netgen.MeshPoint(netgen.Pnt(x, y, 0.0))) for x, y in ridge.points[: ridge.vertices]]
    body = mesh.AddRegion("body", dim=2)
    for corners in ridge.triangles[:, :3]:
        mesh.Add(netgen.Element2D(body, [points[k] for k in corners]))
    on = {"skin": ridge.skin_pairs.__contains__, "top": {*ridge.top}.issuperset, "sides": {*ridge.sides}.issuperset}
    regions = {name: mesh.AddRegion(name, dim=1) for name in on}
    for a, b, c in (map(int, corners) for corners in ridge.triangles[:, :3]):
        for pair in ((a, b), (b, c), (c, a)):
            for name in (name for name, holds in on.items() if holds(frozenset(pair))):
                mesh.Add(netgen.Element1D([points[k] for k in pair], index=regions[name]))
    return ng.Mesh(mesh)


def energy(case: Case, F):
    """Return the strain energy density (MPa)."""
    C, J, a = F.trans * F, ng.Det(F), case.exponent
    root = ng.sqrt((C[0, 0] - C[1, 1]) ** 2 / 4 + C[0, 1] ** 2 + DELTA**2)
    squares = (ng.Trace(C) / 2 + root, ng.Trace(C) / 2 - root, 1.0)
    powers = sum((J ** (-2 / 3) * square) ** (a / 2) for square in squares)
    return 2 * case.shear_modulus / a**2 * (powers - 3) + case.bulk_modulus / 2 * (J - 1) ** 2


def solve(case: Case, ridge: Ridge) -> Answer:
    """Lead the ridge along the loads."""
    mesh = mesh_of(ridge)
    V = ng.VectorH1(mesh, order=2, dirichletx="top|sides", dirichlety="top")
    u, v = V.TnT()
    now = ng.GridFunction(V)
    edge = ng.IntegrationRule(ng.SEGM, 2 * _POINTS - 1)
    places = ng.comp.IntegrationRuleSpaceSurface(mesh, order=len(edge.points) - 1, definedon=mesh.Boundaries("skin"))
    if places.ndof != len(edge.points) * len(ridge.skin):
        raise RuntimeError("friction's history has other points than the integrals over the skin")
    anchor = ng.GridFunction(places)

    def tractions(displacement):
        """Return friction and pressure per reference area."""
        depth = -(ng.y + displacement[1])
        p = case.eps_n * ng.IfPos(depth, depth, 0.0)
        limit, trial = case.mu_f * p, case.eps_t * (anchor - displacement[0])
        t = ng.IfPos(trial - limit, limit, ng.IfPos(-limit - trial, -limit, trial))
        return t, p

    loaded = ng.BilinearForm(V)
    loaded += ng.Variation(energy(case, ng.Id(2) + ng.Grad(u)).Compile() * ng.dx(intrules={ng.TRIG: _TRIANGLE}))
    t, p = tractions(u.Trace())
    loaded += -(t * v.Trace()[0] + p * v.Trace()[1]) * ng.ds("skin", intrules={ng.SEGM: edge})

    lifts = {}
    for name, where, direction in (("x", "top|sides", (1.0, 0.0)), ("y", "top", (0.0, 1.0))):
        lifts[name] = ng.GridFunction(V)
        lifts[name].Set(ng.CF(direction), definedon=mesh.Boundaries(where))
    residual = now.vec.CreateVector()
    skin = mesh.Boundaries("skin")
    nodes = mesh.MapToAllElements({ng.SEGM: ng.IntegrationRule([(0.0,), (1.0,), (0.5,)], [1.0] * 3)}, skin)
    points = mesh.MapToAllElements({ng.SEGM: edge}, skin)
    dofs = np.concatenate([e.dofs for e in places.Elements(ng.BND) if e.mat == "skin"])  # read by number of the point
    answer = Answer("NGSolve")
    for before, load in case.steps():
        now.vec.data += (load.x - before.x) * lifts["x"].vec + (load.y - before.y) * lifts["y"].vec
        answer.iterations += _newton(loaded, now, residual)
        t, p = tractions(now)
        loaded.Apply(now.vec, residual)
        f_n, f_t = (-ng.InnerProduct(residual, lifts[name].vec) for name in ("y", "x"))
        columns = [np.reshape(f(nodes), (-1, 1)) for f in (ng.x, now[0], now[1])]
        places_of = np.hstack(columns).reshape(-1, 3, 3)
        edges = left_to_right(places_of, places_of[:, :, 0])
        answer.report(load, f_n, f_t, edges[:, :, 1:].reshape(-1, 2), np.ravel(p(points)))
        anchor.vec.FV().NumPy()[dofs] = np.ravel((now[0] + t / case.eps_t)(points))
    return answer


def _newton(loaded: ng.BilinearForm, now: ng.GridFunction, residual: ng.BaseVector) -> int:
    """Find the equilibrium at the prescribed displacements in ``now``; return how many systems were solved."""
    free = now.space.FreeDofs()
    for iteration in range(MOST):
        loaded.Apply(now.vec, residual)
        if iteration and np.linalg.norm(residual.FV().NumPy()[np.array(free)]) < TOLERANCE:
            return iteration
        loaded.AssembleLinearization(now.vec)
        now.vec.data -= loaded.mat.Inverse(free, inverse="umfpack") * residual
    raise RuntimeError("Newton's method found no equilibrium")


if __name__ == "__main__":
    main(solve)
