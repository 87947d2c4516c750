"""The ridge in FElupe: its Ogden law, differentiated by tensortrax, and its own contact with a rigid plane.

In FElupe 11.3.0 the derivative by s of the quadratic triangle's last shape function, 4 s (1 - r - s), is 4 (1 - 2r - s)
instead of 4 (1 - r - 2s): gradients of quadratic fields are wrong. The element is corrected here; the variant "as
installed" shows what the slip does.

The contact is between nodes and a plane, its stiffness one number per node. So that it is a penalty per area, every
node of the skin gets a plane of its own, with the penalty times the area that belongs to the node: the weights of
Simpson's rule, by which the middle of an edge has 2/3 of its length and each end 1/6. A node that touches during a step
is taken to be dragged from the moment of the touch, found by interpolation, not from the beginning of the step.
"""

import felupe as fem
import numpy as np

from benchmarks.peers.exchange import MOST, Answer, Case, Ridge, main

_TOLERANCE = 1e-10  # norm of the imbalance over that of the reactions


class CorrectedTriangle(fem.QuadraticTriangle):
    """The quadratic triangle with the derivatives of its own shape functions."""

    def gradient(self, rs):
        """Return the derivatives of the shape functions at (r, s), shape (6, 2)."""
        r, s = rs
        t = 1 - r - s
        corners = [[1 - 4 * t, 1 - 4 * t], [4 * r - 1, 0], [0, 4 * s - 1]]
        return np.array([*corners, [4 * (t - r), -4 * r], [4 * s, 4 * r], [-4 * s, 4 * (t - s)]])


def areas(ridge: Ridge) -> tuple[np.ndarray, np.ndarray]:
    """Return the skin's nodes and the area (mm^2 per mm) that belongs to each."""
    length = np.linalg.norm(ridge.points[ridge.skin[:, 1]] - ridge.points[ridge.skin[:, 0]], axis=1)
    of_all = np.zeros(len(ridge.points))
    np.add.at(of_all, ridge.skin, length[:, None] * np.array([1, 1, 4]) / 6)
    nodes = np.unique(ridge.skin)
    return nodes, of_all[nodes]


def solve(case: Case, ridge: Ridge) -> Answer:
    """Lead the ridge along the loads."""
    plane = len(ridge.points)  # the node that is the plane
    mesh = fem.Mesh(np.vstack([ridge.points, [0.0, 0.0]]), ridge.triangles, "triangle6")
    element = fem.QuadraticTriangle() if case.variant == "as installed" else CorrectedTriangle()
    region = fem.Region(mesh, element, fem.TriangleQuadrature(order=2))
    u = fem.FieldPlaneStrain(region, dim=2)
    field = fem.FieldContainer([u])
    law = fem.Hyperelastic(fem.ogden, mu=[case.shear_modulus], alpha=[case.exponent])
    bodies = [fem.SolidBody(law, field), fem.SolidBody(fem.Volumetric(bulk=case.bulk_modulus), field)]
    nodes, area = areas(ridge)
    look = {"centerpoint": plane, "normal": np.array([0.0, 1.0]), "friction": case.mu_f}
    contacts = [
        fem.ContactRigidPlane(
            field, points=[node], multiplier=case.eps_n * weight, multiplier_tangential=case.eps_t * weight, **look
        )
        for node, weight in zip(nodes, area, strict=True)
    ]

    def support(points: np.ndarray, skip: tuple[int, int]) -> fem.Boundary:
        return fem.Boundary(u, mask=np.isin(np.arange(len(mesh.points)), points), skip=skip)

    planes = np.array([plane])
    supports = {"x": support(ridge.held, (0, 1)), "y": support(ridge.top, (1, 0)), "plane": support(planes, (0, 0))}
    dof0, dof1 = fem.dof.partition(field, supports)
    how = {"items": [*bodies, *contacts], "dof0": dof0, "dof1": dof1, "tol": _TOLERANCE, "maxiter": MOST, "verbose": 0}
    answer = Answer("FElupe", fem.__version__, "GPL 3 or later")
    answer.ready()
    for load in case.loads:
        supports["x"].value, supports["y"].value = load.x, load.y
        found = fem.newtonraphson(ext0=fem.dof.apply(field, supports, dof0), **how)
        answer.iterations += found.iterations
        if load.name:
            forces = np.asarray(found.fun).reshape(-1, 2)
            of_contacts = sum(contact.assemble.vector(field).toarray() for contact in contacts)
            t, p = -of_contacts.reshape(-1, 2)[nodes].T / area
            x = ridge.points[nodes, 0] + u.values[nodes, 0]
            f_n, f_t = -forces[ridge.top, 1].sum(), -forces[ridge.held, 0].sum()
            answer.report(load, f_n, f_t, u.values[ridge.skin.ravel()], x, p, t)
    return answer


if __name__ == "__main__":
    main(solve)
