"""One measurement of benchmarks/performance.py in a process of its own; rank 0 prints JSON.

python3 -m benchmarks.measure run [SCENE.toml] | compile | operations FACTOR
"""

import functools
import json
import os
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fingerpad.startup import MPI, start

start()

import dolfinx.jit
import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from fingerpad.accuracy.refinement import Refinement
from fingerpad.model.checks import StabilityChecks
from fingerpad.model.finger import Finger
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.report import Report
from fingerpad.model.simulation import Simulation
from fingerpad.results import dataset
from fingerpad.results.pictures.drawing import Drawing
from fingerpad.runs import full
from fingerpad.runs.context import RunContext
from fingerpad.scene import load
from variational.resultants import Observer
from variational.solvers.equations import Equations
from variational.solvers.iteration import PREFIX, Iteration
from variational.solvers.outcome import memory_mb
from variational.solvers.skin_layer import SkinLayer

Numbers = dict[str, Any]
_Key = tuple[str, str]
STRAIN = (0.01, -0.02)  # of the body whose tangent is measured
_REPEATS, _SIZES = 5, ("contact", "receptor", "interface", "growth")
_NEWTON, _PATH, _ERRORS, _LAYER = "rest of Newton's method", "rest of the path", "errors", "layer at the screen"
_WHOLE = ("stability", "output", "set-up", _LAYER)  # parts to which all that is called in them belongs
_WATCHED: dict[str, list[tuple[Any, str]]] = {
    _PATH: [(Simulation, "run")],
    _ERRORS: [(Refinement, "run")],
    _NEWTON: [(Iteration, "run")],
    _LAYER: [(SkinLayer, "balance")],
    "set-up": [(Finger, "__init__")],
    "residual": [(Equations, "residual")],
    "tangent": [(Equations, "assemble_tangent")],
    "stability": [(StabilityChecks, "check")],
    "coupling": [(Observer, "state"), (Observer, "ridge_loads")],
    "output": [(Report, "step"), (Report, "load_reached"), (Report, "final"), (Drawing, "write"), (dataset, "content")],
}
_EVENTS = {"MatLUFactorSym": "factorisation", "MatLUFactorNum": "factorisation", "MatSolve": "back-substitution"}


def _logged() -> NDArray[np.float64]:
    """Return seconds and number of each event in PETSc's log so far, shape (events, 2)."""
    found = [PETSc.Log.Event(event).getPerfInfo() for event in _EVENTS]
    return np.array([[each["time"], each["count"]] for each in found])


class Parts:
    """Processor seconds and calls by phase (path, errors, beside) and part, each without the parts called from it.

    What PETSc does inside Newton's method is split by its own log, whose wall times are scaled to processor time.
    """

    def __init__(self) -> None:
        """Watch the parts of the program from now on."""
        self.seconds, self.calls = defaultdict[_Key, float](float), defaultdict[_Key, float](float)
        self._stack, self._last = ["rest of the run"], time.process_time()
        self._aside = np.zeros((len(_EVENTS), 2))  # what PETSc's log has of the layer's solves
        PETSc.Log.begin()
        for name, methods in _WATCHED.items():
            for owner, method in methods:
                setattr(owner, method, self._watched(getattr(owner, method), name))

    def _watched(self, inner: Callable[..., Any], name: str) -> Callable[..., Any]:
        charged = {_NEWTON: self._newton, _LAYER: self._layer}.get(name, self._part)

        @functools.wraps(inner)
        def timed(*args: Any, **more: Any) -> Any:
            with charged(name):
                return inner(*args, **more)

        return timed

    def _key(self, name: str) -> _Key:
        return next((part for part in self._stack if part in (_PATH, _ERRORS)), "beside"), name

    def _charge(self) -> None:
        now = time.process_time()
        self.seconds[self._key(self._stack[-1])] += now - self._last
        self._last = now

    @contextmanager
    def _part(self, name: str) -> Iterator[None]:
        self._charge()
        inside = self._stack[-1] in _WHOLE
        self._stack.append(self._stack[-1] if inside else name)
        self.calls[self._key(name)] += not inside
        try:
            yield
        finally:
            self._charge()
            self._stack.pop()

    @contextmanager
    def _newton(self, name: str) -> Iterator[None]:
        before = _logged() - self._aside
        wall, processor = time.perf_counter(), time.process_time()
        with self._part(name):
            yield
        scale = (time.process_time() - processor) / (time.perf_counter() - wall)
        own = _logged() - self._aside - before
        for k, (event, part) in enumerate(_EVENTS.items()):
            seconds, count = scale * float(own[k, 0]), float(own[k, 1])
            self.seconds[self._key(part)] += seconds
            self.seconds[self._key(name)] -= seconds
            self.calls[self._key(part)] += (event != "MatLUFactorSym") * count

    @contextmanager
    def _layer(self, name: str) -> Iterator[None]:
        before = _logged()
        with self._part(name):
            yield
        own = _logged() - before
        self._aside += own
        self.calls[self._key(name)] += own[list(_EVENTS).index("MatLUFactorNum"), 1] - 1  # factorisations, not calls

    def of(self, phase: str, counted: dict[_Key, float]) -> dict[str, float]:
        """Return the seconds or calls of a phase by part."""
        return {part: value for (its, part), value in counted.items() if its == phase}


def run(scene: str = "") -> Numbers:
    """Return counts and processor seconds of a whole run with errors and pictures."""
    started, parts = time.process_time(), Parts()
    with tempfile.TemporaryDirectory() as folder:
        result = full.run(load(Path(scene) if scene else None), RunContext(Path(folder)))
    parts._charge()  # of what follows from the states, after the last file
    errors = sum(parts.of(_ERRORS, parts.seconds).values())
    return {
        "newton": result.cost.newton_iterations,
        "factorisations": result.cost.factorisations,
        "steps": len(result.steps),
        "led": sum(state.record.factorisations for state in result.steps if abs(state.bone_x) < 1e-12 and state.record),
        "processor": time.process_time(),
        "path": parts.of(_PATH, parts.seconds),
        "beside": {"start of the program": started, "errors": errors} | parts.of("beside", parts.seconds),
        "calls": parts.of(_PATH, parts.calls),
    }


def default_finger(factor: str) -> Finger:
    """Return the default finger with its element sizes times a factor."""
    scene = by_rule(load())
    size = scene.mesh.model_copy(update={name: float(factor) * getattr(scene.mesh, name) for name in _SIZES})
    model = FingerModel(scene.model_copy(update={"mesh": size}), plan(scene))
    return Finger(model, MPI.COMM_WORLD, lambda target, part, attempt: False)


def operations(factor: str) -> Numbers:
    """Return the cost of single operations on the default finger with its element sizes times a factor.

    Processor seconds are of all ranks, wall seconds of the slowest; both are the least of some repetitions.
    """
    comm, before = MPI.COMM_WORLD, memory_mb()
    finger = default_finger(factor)
    solver, equations = finger.solver, finger.solver.equations
    x = solver.problem.V.tabulate_dof_coordinates()[:, :2]
    solver.set_displacement(x * STRAIN, np.zeros(2))
    K, f, step = (equations.layout.create_matrix(), *(equations.layout.create_vector() for _ in "ab"))
    ksp = PETSc.KSP().create(comm)
    ksp.setOptionsPrefix(PREFIX)
    ksp.setFromOptions()

    def tangent() -> None:
        K.zeroEntries()
        equations.assemble_tangent(K)
        K.zeroRows(equations.prescribed_rows(), diag=equations.stiffness)

    def factorise() -> None:
        ksp.setOperators(K)
        ksp.setUp()

    jobs: dict[str, Callable[[], None]] = {
        "tangent": tangent,
        "factorisation": factorise,
        "solution": lambda: ksp.solve(f, step),
        "residual": lambda: equations.residual(solver.x, f),
    }
    rounds = [{name: _timed(job, comm) for name, job in jobs.items()} for _ in range(1 + _REPEATS)]
    processor, wall = ({name: min(each[name][k] for each in rounds[1:]) for name in jobs} for k in range(2))
    factors = ksp.getPC().getFactorMatrix()
    return {
        "factor": float(factor),
        "unknowns": finger.unknowns,
        "processor": processor,
        "wall": wall,
        "first": rounds[0]["factorisation"][0],
        "memory": comm.allreduce(memory_mb()),
        "before": comm.allreduce(before),
        "front": factors.getMumpsInfog(11),
    }


def _timed(job: Callable[[], None], comm: MPI.Comm) -> tuple[float, float]:
    comm.barrier()
    wall, processor = time.perf_counter(), time.process_time()
    job()
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    return comm.allreduce(processor), comm.allreduce(wall, op=MPI.MAX)


def forms() -> Numbers:
    """Return the processor seconds in which a run compiles its forms, or loads them, those of compilers included."""
    compiled, seconds = dolfinx.jit.ffcx_jit, list[float]()

    def timed(*args: Any, **more: Any) -> Any:
        before = sum(os.times()[:4])
        found = compiled(*args, **more)
        seconds.append(sum(os.times()[:4]) - before)
        return found

    dolfinx.jit.ffcx_jit = timed
    small = load(Path(__file__).parents[1] / "demos" / "scenes" / "small_finger.toml")
    with tempfile.TemporaryDirectory() as folder:
        full.run(small.replace(output={"receptors": True}), RunContext(Path(folder)))
    return {"seconds": sum(seconds)}


if __name__ == "__main__":
    jobs: dict[str, Callable[..., Numbers]] = {
        "run": run,
        "operations": operations,
        "compile": forms,
    }
    measured = jobs[sys.argv[1]](*sys.argv[2:])
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(measured))
