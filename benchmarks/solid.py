"""A smooth finger in three dimensions beside its own section in plane strain, summed over slices.

The finger is the lower half of an ellipsoid with semi-axes of 10, 7 and 14 mm about a rigid core, an ellipsoid with 4,
2.6 and 14 mm. From outside to inside it has layers of 0.6 and 1.4 mm at the centre and the rest; they get thinner with
the section towards the end. So each section is the middle one on another scale, and the sum of slices leaves out the
third dimension alone. Neo-Hookean solids of 80, 5 and 25 kPa, Poisson's ratio 0.48, frictionless, uncharged; a penalty.
The core and the plane through it are lowered. Quadratic hexahedra, or quadrilaterals; the grid is that of the section
times one along the finger.

environment/run python3 -m benchmarks.solid [--draw]     some ten minutes

Writes docs/solid.json, which docs/newtons.md shows.
"""

import argparse
import sys
from collections.abc import Sequence

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx.fem.petsc import NonlinearProblem
from dolfinx.nls.petsc import NewtonSolver
from mpi4py import MPI
from petsc4py import PETSc

from benchmarks import harness
from fingerpad.slices.total import Profile, at_force, at_indentation
from fingerpad.slices.trace import Trace
from variational.materials.neo_hooke import NeoHooke

OUTER, CORE = (10.0, 7.0, 14.0), (4.0, 2.6, 14.0)  # mm
LAYERS = ((0.6, 80e-3), (1.4, 5e-3), (2.4, 25e-3))  # mm and MPa, from outside
POISSON, PENALTY = 0.48, 10.0  # 1, MPa/mm
DEPTHS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)  # mm
BETWEEN = (0.03, 0.06, 1.1, 1.2)  # mm, of the section alone
FINE = 8  # elements over the part that can touch
COUNT = 400  # slices
_STEP = 0.1  # mm, largest one of the depth
_END = 1.25  # of π/2, where the finger is cut off: a fourth of the section is left


def _graded(fine: int, coarse: int, last: float) -> np.ndarray:
    """Return angles from 0, fine up to 0.6, where the finger can touch."""
    return np.concatenate([np.linspace(0, 0.6, fine + 1), np.linspace(0.6, last, coarse + 1)[1:]])


class Solid:
    """The finger, or its middle section, on the screen; mm, N, MPa."""

    def __init__(self, dimension: int, fine: int = FINE) -> None:
        """Mesh it.

        Args:
            dimension: 3, or 2 for the section.
            fine: elements over the part that can touch, across and along the finger.
        """
        thick = np.array([0.0, *np.cumsum([each[0] for each in LAYERS])])
        steps = np.concatenate([np.linspace(a, b, 3)[:-1] for a, b in zip(thick[:-1], thick[1:], strict=True)])
        t = 1 - np.append(steps, thick[-1]) / thick[-1]  # 1 on the skin, 0 on the core
        phi = _graded(fine, 4, np.pi / 2)
        beta = _graded(fine, 4, _END) if dimension == 3 else np.zeros(1)
        grid = np.stack(np.meshgrid(t, phi, beta, indexing="ij"), axis=-1)
        points = place(*np.moveaxis(grid.reshape(-1, 3), 1, 0))[:, :dimension]
        number = np.arange(len(points)).reshape(grid.shape[:3])
        if dimension == 3:
            corners = [number[i:, j:, k:][: len(t) - 1, : len(phi) - 1, : len(beta) - 1].ravel() for i in (0, 1)
                       for j in (0, 1) for k in (0, 1)]  # fmt: skip
        else:
            corners = [number[i:, j:, 0][: len(t) - 1, : len(phi) - 1].ravel() for i in (0, 1) for j in (0, 1)]
        kind = "hexahedron" if dimension == 3 else "quadrilateral"
        element = basix.ufl.element("Lagrange", kind, 1, shape=(dimension,))
        cells, layer = np.stack(corners, axis=1), np.repeat(np.arange(len(LAYERS)), 2)
        which = np.repeat(layer, (len(phi) - 1) * max(len(beta) - 1, 1))
        self.mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells, points, element)
        modulus = dolfinx.fem.Function(dolfinx.fem.functionspace(self.mesh, ("DG", 0)))
        shear = np.array([each[1] for each in LAYERS])
        modulus.x.array[:] = shear[which[self.mesh.topology.original_cell_index]]
        self._set_up(dimension, modulus)

    def _set_up(self, dimension: int, modulus: dolfinx.fem.Function) -> None:
        mesh, tdim = self.mesh, dimension
        space = dolfinx.fem.functionspace(mesh, ("Lagrange", 2, (dimension,)))
        self.u, v = dolfinx.fem.Function(space), ufl.TestFunction(space)
        mesh.topology.create_connectivity(tdim - 1, tdim)

        def facets(where):
            return dolfinx.mesh.locate_entities_boundary(mesh, tdim - 1, where)

        def level(x, axes):
            z = x[2] / axes[2] if tdim == 3 else 0 * x[0]
            return np.sqrt((x[0] / axes[0]) ** 2 + ((x[1] - OUTER[1]) / axes[1]) ** 2 + z**2)

        skin = facets(lambda x: np.isclose(level(x, OUTER), 1, atol=1e-6))
        held = facets(lambda x: np.isclose(level(x, CORE), 1, atol=1e-6) | np.isclose(x[1], OUTER[1]))
        tagged = dolfinx.mesh.meshtags(mesh, tdim - 1, np.sort(skin), np.full(len(skin), 1, dtype=np.int32))
        ds = ufl.Measure("ds", mesh, subdomain_data=tagged, metadata={"quadrature_degree": 8})(1)
        self.depth = dolfinx.fem.Function(space)
        conditions = [dolfinx.fem.dirichletbc(self.depth, dolfinx.fem.locate_dofs_topological(space, tdim - 1, held))]
        for axis in range(0, tdim, 2):
            part, _ = space.sub(axis).collapse()
            zero = dolfinx.fem.Function(part)
            plane = facets(lambda x, axis=axis: np.isclose(x[axis], 0))
            dofs = dolfinx.fem.locate_dofs_topological((space.sub(axis), part), tdim - 1, plane)
            conditions.insert(0, dolfinx.fem.dirichletbc(zero, dofs, space.sub(axis)))
        gradient = ufl.grad(self.u)
        if tdim == 2:
            gradient = ufl.as_tensor(
                [[gradient[0, 0], gradient[0, 1], 0], [gradient[1, 0], gradient[1, 1], 0], [0, 0, 0]]
            )
        F = ufl.variable(ufl.Identity(3) + gradient)
        J = ufl.det(F)
        bulk = NeoHooke(1.0, POISSON).bulk
        energy = modulus * (0.5 * (J ** (-2 / 3) * ufl.inner(F, F) - 3) + bulk / 2 * (J - 1) ** 2)
        y = ufl.SpatialCoordinate(mesh)[1] + self.u[1]
        pressure = PENALTY * ufl.max_value(-y, 0)
        residual = ufl.derivative(energy * ufl.dx(metadata={"quadrature_degree": 4}), self.u, v) - pressure * v[1] * ds
        self._force = dolfinx.fem.form(pressure * ds)
        self._area = dolfinx.fem.form(ufl.conditional(ufl.lt(y, 0), 1.0, 0.0) * ds)
        self._solver = NewtonSolver(mesh.comm, NonlinearProblem(residual, self.u, conditions))
        self._solver.rtol, self._solver.atol, self._solver.max_it = 1e-8, 1e-9, 40
        self._solver.convergence_criterion = "residual"
        options = PETSc.Options()
        prefix = self._solver.krylov_solver.getOptionsPrefix()
        for name, value in (("ksp_type", "preonly"), ("pc_type", "lu"), ("pc_factor_mat_solver_type", "mumps")):
            options[f"{prefix}{name}"] = value
        self._solver.krylov_solver.setFromOptions()
        self.parts = 2 if tdim == 2 else 4

    def lower(self, depths: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        """Return force and area of contact (N and mm², of the section per mm) at depths (mm)."""
        found, now = [], 0.0
        for depth in depths:
            for d in np.linspace(now, depth, 1 + int(np.ceil((depth - now) / _STEP - 1e-9)))[1:]:
                self.depth.x.array[1 :: self.mesh.geometry.dim] = -d
                self._solver.solve(self.u)
            now = depth
            found.append([self.parts * dolfinx.fem.assemble_scalar(form) for form in (self._force, self._area)])
            print(
                f"{self.mesh.geometry.dim} dimensions, {depth:g} mm: {found[-1][0]:.5g} N, {found[-1][1]:.4g} mm2",
                flush=True,
            )
        forces, areas = np.array(found).T
        return forces, areas


def place(t: np.ndarray, phi: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Return points of the finger (mm), shape (points, 3); its lowest one is at y = 0."""
    a, b, c = ((1 - t) * inner + t * outer for inner, outer in zip(CORE, OUTER, strict=True))
    scale = np.cos(beta)
    return np.stack([a * scale * np.sin(phi), OUTER[1] - b * scale * np.cos(phi), c * np.sin(beta)], axis=-1)


def compare(fine: int = FINE) -> list[dict[str, float]]:
    """Return forces (N) and areas (m²) of the finger and of the sum of slices, at equal depth and equal force."""
    deep = sorted((*DEPTHS, *BETWEEN))
    force, width = Solid(2, fine).lower(deep)
    columns = {"f_ext": 1e3 * force, "f_t": 0 * force, "f_electrostatic": 0 * force}
    columns |= {"contact_length": 1e-3 * width, "gross_width": 1e-3 * width}
    of = Trace(1e-3 * np.array(deep), columns)
    end = 1e-3 * OUTER[2] * np.sin(_END)

    def scale(z):
        return np.sqrt(1 - (np.asarray(z) / (1e-3 * OUTER[2])) ** 2)

    finger = Profile((-end, end), lambda z: 1e-3 * OUTER[1] * (1 - scale(z)), scale)
    found = []
    for depth, newtons, area in zip(DEPTHS, *Solid(3, fine).lower(DEPTHS), strict=True):
        equal, same = at_indentation(finger, of, 1e-3 * depth, COUNT), at_force(finger, of, float(newtons), COUNT)
        found.append(
            {
                "depth": 1e-3 * depth, "f_ext": float(newtons), "area": 1e-6 * float(area), "centre": equal.centre,
                "f_ext_slices": equal.totals["f_ext"], "area_slices": equal.totals["gross_area"],
                "area_slices_at_force": same.totals["gross_area"],
            }
        )  # fmt: skip
    return found


def compute(args: argparse.Namespace) -> None:
    """Keep the numbers, of 8 elements over the part that can touch."""
    harness.keep("solid", compare(FINE), harness.made(), args.docs)


if __name__ == "__main__":
    from benchmarks import newtons

    sys.exit(harness.main(__doc__, compute, newtons.draw))
