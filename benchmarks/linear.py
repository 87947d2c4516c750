"""Linear solvers on one tangent of the default finger: the part "solvers" of benchmarks/performance.py.

Each solves K x = r for the tangent K and the residual r of a strained finger. The first set-up of a direct solver has
the analysis, the later ones have new numbers in the same pattern. An iterative solver ends at 1e-8 of the residual;
*kept LU* is preconditioned by the factors of a finger strained by a tenth less.
"""

import time
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from petsc4py import PETSc

from benchmarks.harness import table
from variational.solvers.iteration import DEFAULTS, PREFIX
from variational.solvers.newton import Solver

Numbers = dict[str, Any]
STRAIN = (0.01, -0.02)  # of the body whose tangent it is
_OTHER = 0.9  # part of it that the kept factorisation is of
_REPEATS, _MOST, _RESTART, _REST = 3, 300, 100, 1e-8
_MISSING = (86, 92)  # PETSc's errors where it was built without a type, or without a package for a factorisation


class Way(NamedTuple):
    """A linear solver by its options in PETSc, without their prefix."""

    options: Mapping[str, Any]
    blocks: bool = True
    """Whether it takes the matrix in blocks of two unknowns, as assembled, or needs one of single entries."""
    kept: bool = False
    """Whether it is set up with the tangent of another strain."""


_MUMPS = {name: value for name, value in DEFAULTS.items() if not name.startswith("snes")}
_GMRES = {"ksp_type": "gmres", "ksp_rtol": _REST, "ksp_max_it": _MOST, "ksp_gmres_restart": _RESTART}


def _lu(package: str) -> dict[str, Any]:
    return {"ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": package}


NOW = "MUMPS, as it is"
WAYS = {
    NOW: Way(_MUMPS),
    "its AMF ordering": Way(_MUMPS | {"mat_mumps_icntl_7": 2}),
    "its AMD ordering": Way(_MUMPS | {"mat_mumps_icntl_7": 0}),
    "its QAMD ordering": Way(_MUMPS | {"mat_mumps_icntl_7": 6}),
    "scaled": Way(_MUMPS | {"mat_mumps_icntl_8": 77}),
    "without pivoting": Way(_MUMPS | {"mat_mumps_cntl_1": 0}),
    "block low rank, 1e-6": Way(_MUMPS | {"mat_mumps_icntl_35": 2, "mat_mumps_cntl_7": 1e-6}),
    "PETSc's own LU, nested dissection": Way(_lu("petsc") | {"pc_factor_mat_ordering_type": "nd"}),
    "UMFPACK": Way(_lu("umfpack"), blocks=False),
    "KLU": Way(_lu("klu"), blocks=False),
    "SuperLU": Way(_lu("superlu"), blocks=False),
    "SuperLU_DIST": Way(_lu("superlu_dist"), blocks=False),
    "GMRES, kept LU": Way(_MUMPS | _GMRES, kept=True),
    "GMRES, smoothed aggregation (GAMG)": Way(_GMRES | {"pc_type": "gamg"}, blocks=False),
    "GMRES, BoomerAMG": Way(_GMRES | {"pc_type": "hypre", "pc_hypre_type": "boomeramg"}, blocks=False),
}


def strain(solver: Solver, part: float = 1.0) -> None:
    """Give a finger's displacement a part of ``STRAIN``."""
    x = solver.problem.V.tabulate_dof_coordinates()[:, :2]
    solver.set_displacement(x * STRAIN * np.float64(part), np.zeros(2))


def _rigid_motions(solver: Solver) -> PETSc.NullSpace:
    """Return the two translations and the rotation, which multigrid needs of an elastic body."""
    x, layout = solver.problem.V.tabulate_dof_coordinates()[:, :2], solver.layout
    motions = [(np.ones_like(x) * axis, axis) for axis in np.eye(2)] + [(x[:, ::-1] * [-1.0, 1.0], np.zeros(2))]
    vectors = list[PETSc.Vec]()
    for nodal, bone in motions:
        vectors.append(layout.create_vector())
        layout.from_nodes(nodal.ravel(), bone, vectors[-1])
        for other in vectors[:-1]:
            vectors[-1].axpy(-vectors[-1].dot(other), other)
        vectors[-1].normalize()
    return PETSc.NullSpace().create(vectors=vectors, comm=layout.comm)


def measure(solver: Solver) -> dict[str, Numbers]:
    """Return seconds and residual of each way, on one rank; what this PETSc does not have is left out.

    Args:
        solver: of a finger.
    """
    equations, matrices = solver.equations, dict[bool, PETSc.Mat]()
    b, rigid = equations.layout.create_vector(), _rigid_motions(solver)
    for kept in (True, False):
        strain(solver, _OTHER if kept else 1.0)
        K = matrices[kept] = equations.layout.create_matrix()
        equations.assemble_tangent(K)
        K.zeroRows(equations.prescribed_rows(), diag=equations.stiffness)
        K.setNearNullSpace(rigid)
        equations.residual(solver.x, b)
    found = {name: _timed(way, matrices, b, f"{PREFIX}way_{k}_") for k, (name, way) in enumerate(WAYS.items())}
    return {name: numbers for name, numbers in found.items() if numbers}


def _timed(way: Way, matrices: Mapping[bool, PETSc.Mat], b: PETSc.Vec, prefix: str) -> Numbers:
    """Return what a way costs; nothing where PETSc was built without it."""
    options = PETSc.Options()
    for name, value in way.options.items():
        options.setValue(prefix + name, value)
    A, P = (matrices[kept] if way.blocks else _single(matrices[kept]) for kept in (False, way.kept))
    ksp, x = PETSc.KSP().create(A.comm), b.duplicate()
    ksp.setOptionsPrefix(prefix)
    try:
        ksp.setFromOptions()
        direct = ksp.getType() == PETSc.KSP.Type.PREONLY
        times = [_once(ksp, A, P, b, x) for _ in range(1 + (_REPEATS if direct else 1))]
    except PETSc.Error as error:
        if error.ierr in _MISSING:
            return {}
        raise
    rest = b.duplicate()
    A.mult(x, rest)
    rest.axpy(-1.0, b)
    mumps = way.options.get("pc_factor_mat_solver_type") == "mumps"
    return {
        "first": times[0][0],
        "set-up": min(seconds[0] for seconds in times[1:]),
        "solve": min(seconds[1] for seconds in times[1:]),
        "entries": ksp.getPC().getFactorMatrix().getMumpsInfog(9) if mumps else None,
        "iterations": None if direct else ksp.getIterationNumber(),
        "rest": rest.norm() / b.norm(),
    }


def _single(K: PETSc.Mat) -> PETSc.Mat:
    """Return a matrix of single entries instead of blocks."""
    A = K.convert("aij", PETSc.Mat())
    A.setNearNullSpace(K.getNearNullSpace())
    return A


def _once(ksp: PETSc.KSP, A: PETSc.Mat, P: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec) -> tuple[float, float]:
    """Return the processor seconds of a set-up with numbers that count as new, and of a solve."""
    P.stateIncrease()
    start = time.process_time()
    ksp.setOperators(A, P)
    ksp.setUp()
    ready = time.process_time()
    ksp.solve(b, x)
    return ready - start, time.process_time() - ready


def rows(found: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the table of the ways."""
    now, lines = found[NOW], list[list[Any]]()
    for name, each in found.items():
        entries, times = each["entries"] and each["entries"] / 1e6, each["set-up"] / now["set-up"]
        seconds = (each[part] for part in ("first", "set-up", "solve"))
        lines.append([name, f"{times:.2f}", *seconds, entries, each["iterations"], f"{each['rest']:.0e}"])
    head = ["solver", "set-up over MUMPS's", "first set-up (s)", "set-up (s)", "solve (s)", "entries (million)"]
    return table([*head, "iterations", "residual left"], lines)
