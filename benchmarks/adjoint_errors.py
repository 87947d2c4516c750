r"""Errors of friction by the adjoint on a state's own mesh, beside known ones: why runs do not estimate them so.

environment/run python3 -m benchmarks.adjoint_errors [--jobs 1]     half an hour of one processor

With the residual R and friction J on cubic elements of the same mesh and eight points a facet,

.. math:: J(u) - J_h(u_h) \approx J(u_h) - J_h(u_h) - R(u_h; z), \qquad K^T z = J'

(Becker and Rannacher 2001, doi 10.1017/S0962492901000010). It is what one step of Newton's method on these elements
changes, air gaps included, and is computed so. The known error is that to cubic elements of half the size, with small
facets where contact ends. *Path* is the mesh of a run's path, *final* that of its results, which has such facets too.
Writes docs/adjoint_errors.json and docs/errors.md.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from dolfinx import fem
from dolfinx.fem.petsc import interpolation_matrix
from mpi4py import MPI
from petsc4py import PETSc
from scipy import sparse
from scipy.sparse.linalg import splu

from benchmarks import harness
from benchmarks.accuracy import drawn
from fingerpad.accuracy.solves import follow
from fingerpad.accuracy.states import State, contact_ends, edge_places
from fingerpad.model.finger import assembled
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import RestartRequired
from fingerpad.results.states import SLIDE_ON
from fingerpad.scene import Scene, from_data, load
from geometry.mesh import TaggedMesh
from geometry.profiles import Profiles
from variational.body import Body
from variational.numbers import Numbers
from variational.roughness.closure import air_gaps
from variational.sensitivity import Linearised, Varied
from variational.solvers.layout import RigidRimLayout
from variational.solvers.state_snapshot import StateSnapshot, take_snapshot
from variational.solvers.transfer import restore

Inverse = Callable[[np.ndarray], np.ndarray]
NINE: dict[str, float] = {
    "geometry.ridge_count": 9, "mesh.contact": 10e-6, "mesh.receptor": 40e-6,
    "mesh.interface": 100e-6, "mesh.growth": 0.5, "mesh.touching_half_arc": 1e-3,
}  # fmt: skip
LOADS = ((5, 200), (3, 200), (1, 200), (1, 60), (2, 100), (4, 150), (6, 50), (5, 100), (3, 100))  # N/m, V
KEYS: tuple[dict[str, float], ...] = (
    {"friction": 0.15}, {"friction": 0.5}, {"materials.stratum_corneum.shear_modulus": 6e5},
    {"materials.subcutis.shear_modulus": 1.5e4}, {"electric.d_i": 0.5e-6}, {"roughness.h_rms": 2e-6},
    {"mesh.growth": 1.0, "mesh.interface": 200e-6, "mesh.receptor": 100e-6}, {"mesh.contact": 20e-6},
)  # fmt: skip
WHOLE = ("4", "7")  # of the scenes drawn for docs/errors.md
DEFAULT, MESHES = "default scene", ("path", "final")
NUMERICS = {"tolerance": 1e-11, "coupling_tolerance": 1e-9}
ESTIMATES = {
    "cubic": "adjoint in cubic elements",
    "gaps held": "the same at fixed air gaps",
    "quadratic": "adjoint in the elements of the state",
    "solved": "no adjoint: state of cubic elements",
}
LIMIT = 3600.0  # s of processor time, of each case
GOOD, LARGE = (0.5, 2.0), 1e-4  # estimates over known errors; errors over friction


def cases() -> dict[str, Any]:
    """Return scenes by name: fingers of nine ridges, whose errors are large, and whole ones."""
    nine = [{"f_ext": float(n), "voltage": float(v)} for n, v in LOADS]
    nine += [{"f_ext": 4.0, "voltage": 200.0} | each for each in KEYS]
    found = {DEFAULT: Scene()}
    found |= {", ".join(f"{key} {value:g}" for key, value in each.items()): load(None, NINE | each) for each in nine}
    found |= {name: each for name, each in drawn().items() if name.split(":")[0] in WHOLE}
    return {name: each.parameters() for name, each in found.items()}


class Enriched(Linearised):
    """Steps of Newton's method from fields that are no equilibrium of their elements."""

    def change(self, gaps: bool = True, inverse: Inverse | None = None) -> float:
        """Return by how much a step changes friction, of air gaps too or held ones, by the factorisation or another."""
        self._charged, self._inverse, problem = gaps, inverse, self.problem
        load = self.coupling.closure, self.solver.control, float(problem.voltage.value)
        numbers = Numbers(problem._solids, problem.interface, *load, problem.mesh.geometry.x.copy())
        return float(self._by({"": lambda part: numbers})[""].stair["mu_app"])

    def _fixed(self, varied: Varied) -> Any:
        f, pressures = self.solver.layout.create_vector(), self._pressures(self._skin)
        self.solver.equations.residual(self.solver.x, f)
        gaps = air_gaps(self.coupling.closure, pressures) - self.coupling.d_eq  # type: ignore[arg-type]
        return SimpleNamespace(residual=f.array_r.copy(), skin=0.0, gaps=gaps, explicit=0.0)

    def _solve(self, right: list[np.ndarray]) -> list[np.ndarray]:
        return [-self._inverse(each) for each in right] if self._inverse else super()._solve(right)


def matrix(A: PETSc.Mat) -> sparse.csr_matrix:
    """Return a matrix of PETSc's as SciPy's."""
    return sparse.csr_matrix(A.getValuesCSR()[::-1], A.getSize())


def by_quadratic(body: Body, tagged: TaggedMesh, tangent: PETSc.Mat) -> Inverse:
    """Return the inverse of the cubic elements' tangent in the quadratic ones that they contain."""
    V, fine = body.problem.V, body.solver.layout
    quadratic = fem.functionspace(V.mesh, ("Lagrange", 2, (2,)))
    coarse, between = RigidRimLayout(quadratic, tagged.rim), interpolation_matrix(quadratic, V)
    between.assemble()
    spread = sparse.csr_matrix((np.ones(len(coarse.rows)), coarse.rows, np.arange(len(coarse.rows) + 1)))
    node = np.empty(fine.global_size, dtype=np.int64)
    node[fine.rows] = np.arange(len(fine.rows))
    P = (matrix(between) @ spread)[node]
    solved = splu((P.T @ matrix(tangent.copy().convert("aij")) @ P).tocsc())
    return lambda r: np.asarray(P @ solved.solve(P.T @ r))


def made(model: FingerModel, element: str = "P2", points: int = 4) -> tuple[TaggedMesh, Body]:
    """Return a mesh and a finger on it, with elements of a name."""
    numerics = model.numerics.model_copy(update={"element": element, "quadrature_points": points})
    return assembled(model.changed(numerics=numerics), MPI.COMM_SELF, lambda target, part, attempt: True, half=False)


def friction(body: Body, skin: Any = None) -> float:
    """Return µ_app."""
    return -float(body.observer.ridge_loads(skin).f_friction.sum()) / body.solver.control.force


def balanced(body: Body, snapshot: StateSnapshot, direction: int) -> tuple[float, StateSnapshot]:
    """Return the friction of a state that is solved for again, and the state."""
    restore(snapshot, body.coupling, direction * SLIDE_ON)
    body.continuation.re_equilibrate("full slip")
    return friction(body), take_snapshot(body.coupling, body.continuation.surface_state)


def of_mesh(model: FingerModel, state: State) -> tuple[dict[str, float], StateSnapshot]:
    """Return friction on a mesh, what cubic elements change of it, and processor seconds (s); and the state."""
    begin = time.process_time()
    mu, snapshot = balanced(made(model)[1], state.snapshot, state.direction)
    found = {"mu_app": mu, "run": time.process_time() - begin}
    begin, (tagged, body) = time.process_time(), made(model, "P3", 8)
    restore(snapshot, body.coupling, state.direction * SLIDE_ON)
    moved = friction(body) - mu
    linear = Enriched(body.coupling, lambda skin, loads, bone: {"mu_app": friction(body, skin)})
    found["cubic"] = moved + linear.change()
    found["adjoint"] = time.process_time() - begin
    found["gaps held"] = moved + linear.change(gaps=False)
    found["quadratic"] = moved + linear.change(inverse=by_quadratic(body, tagged, linear._K))
    return found | {"solved": balanced(body, snapshot, state.direction)[0] - mu}, snapshot


def whole(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Return the answers of a scene by mesh, and friction on the finest one."""
    read = from_data(dict(scene)).replace(output={"receptors": False}, numerics=NUMERICS)
    model = FingerModel(by_rule(read), plan(read)).of_path()
    while isinstance(path := follow(model, MPI.COMM_SELF), RestartRequired):
        model = path.model
    state, final = path.states["full_slip"], model.final or model.mesh
    ends = contact_ends(state.snapshot, Profiles(model.geometry).along_skin, state.facet)
    sizes = [(mesh, edge_places([(ends, state.facet)], mesh)) for mesh in (final, final.scaled(0.5))]
    fine, finest = (model.changed(mesh=mesh, edges=edges) for mesh, edges in sizes)
    (on_path, _), (on_final, snapshot) = (of_mesh(each, state) for each in (model, fine))
    known = balanced(made(finest, "P3", 8)[1], snapshot, state.direction)[0]
    return {"path": on_path, "final": on_final, "known": known}


def compute(args: argparse.Namespace) -> None:
    """Solve the scenes that are not kept yet, and keep their numbers."""
    found = harness.solve("benchmarks.adjoint_errors", cases(), args.out.parent / "adjoint_errors", args.jobs, LIMIT)
    harness.keep("adjoint_errors", found, harness.made(), args.docs)


def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    every = {name: case for name, case in harness.kept("adjoint_errors", docs).numbers.items() if "failure" not in case}
    known = {mesh: {name: case["known"] - case[mesh]["mu_app"] for name, case in every.items()} for mesh in MESHES}

    def cells(mesh: str, estimate: str) -> tuple[str, str]:
        over = [case[mesh][estimate] / known[mesh][name] for name, case in every.items()]
        return f"{sum(GOOD[0] <= each <= GOOD[1] for each in over)}", f"{min(over):.2g} to {max(over):.2g}"

    names: dict[str, Any] = {"scenes": every, "default": every[DEFAULT], "known": known}
    large = {name: each for name, each in known["final"].items() if abs(each) > LARGE * every[name]["known"]}
    names["fits"] = [GOOD[0] <= every[name]["final"]["cubic"] / each <= GOOD[1] for name, each in large.items()]
    names["table"] = [(words, *cells("path", name), *cells("final", name)) for name, words in ESTIMATES.items()]
    names["part"] = float(np.median([case["final"]["adjoint"] / case["final"]["run"] for case in every.values()]))
    return harness.page(docs, "adjoint_errors", "python3 -m benchmarks.adjoint_errors", globals() | names)


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1].startswith("{"):
        print(json.dumps(whole(json.loads(sys.argv[1]))))
    else:
        sys.exit(harness.main(__doc__, compute, draw))
