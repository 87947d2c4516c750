"""Full slip of the full model in many scenes on few meshes: each state is solved for from the nearest one before.

Where that does not lead to it, the voltage of the scene rises from a small one, at the scene's force. Each rung is
solved for from the nearest state in its turn. A rung that is not found is halved, and at last the state is given up.
"""

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.loads.scenes import (
    DEFAULT,
    FAR,
    FIRST,
    LADDER,
    LEAST_RISE,
    LIGHT,
    LOWEST,
    MESHES,
    MOST,
    RISE,
    WORK,
    Data,
    Tasks,
    meshed,
    tasks,
)
from fingerpad.results.files import replace
from fingerpad.results.quantities import RESULTS
from fingerpad.scene import from_data
from variational.solvers.outcome import NotConverged
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.model.full_slip import FullSlips, Solved

_SHORT = ("f_ext", "f_t", "mu_app", "f_electrostatic", "contact_length", "ridges_in_contact", "bone_height",
          "factorisations", "failure", "reached")  # fmt: skip


class _TooManyError(RuntimeError):
    """A state that takes more work than it is given."""


@dataclass
class Pool:
    """States of full slip on one mesh, each a start for others."""

    which: int
    slips: "FullSlips"
    solved: "list[Solved]"
    most: int = 0
    """Factorisations up to which the present state is looked for."""
    why: str = ""
    """It was not found at last."""

    @classmethod
    def begin(cls, which: int) -> "Pool":
        """Return the pool with one state, the end of a path."""
        from fingerpad.model.full_slip import Conditions, FullSlips
        from fingerpad.model.simulation import Simulation
        from fingerpad.startup import MPI

        model = _model({"voltage": 0.0} | DEFAULT, LIGHT[which], which)
        simulation = Simulation(model, MPI.COMM_WORLD)
        if simulation.run() is not None:
            raise RuntimeError("the path asks for another mesh")
        slips = FullSlips(simulation)
        pool = cls(which, slips, [slips.first(Conditions.of(model))])
        pool._cap()
        for f_ext, voltage, friction in LADDER[which]:
            pool.state({"voltage": voltage} | DEFAULT | {"friction": friction}, f_ext)
        return pool

    def _cap(self) -> None:
        """Let iterations end, and no solve begin, once :attr:`most` factorisations are made."""
        from petsc4py import PETSc

        path, solver = self.slips.finger.continuation, self.slips.finger.solver
        solve, snes = path.solve, solver.iteration.snes
        test, too_many = snes.getConvergenceTest()[0], PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT

        def judge(*iterate: Any) -> int:
            return test(*iterate) or (too_many if solver.counts.factorisations >= self.most else 0)

        def begin(pseudo_transient: bool) -> None:
            if solver.counts.factorisations >= self.most:
                raise _TooManyError(f"too many factorisations: {self.why}")
            try:
                solve(pseudo_transient)
            except NotConverged as failure:
                self.why = str(failure)
                raise

        snes.setConvergenceTest(judge)
        path.solve = begin

    def state(self, data: Data, f_ext: float) -> Data:
        """Return full slip, ready for JSON; the ``failure`` and the largest voltage before it where there is none."""
        counts, wanted = self.slips.finger.solver.counts, data["voltage"]
        before, last, ratio = counts.factorisations, 0.0, RISE
        found = self._from_nearest(data, f_ext, FIRST)
        while "failure" in found and counts.factorisations < before + WORK and ratio > LEAST_RISE:
            at = min(max(LOWEST, ratio * last), wanted)
            rung = self._from_nearest(data | {"voltage": at}, f_ext, MOST)
            if "failure" not in rung:
                last = at
                found = rung if at == wanted else found
            elif last:
                found, ratio = rung, ratio**0.5
            else:
                break
        reached = {"reached": last} if "failure" in found else {}
        return found | reached | {"factorisations": counts.factorisations - before}

    def _from_nearest(self, data: Data, f_ext: float, most: int) -> Data:
        """Return full slip or its ``failure`` from the nearest state, with so many factorisations at most."""
        from fingerpad.model.full_slip import Conditions
        from variational.solvers.continuation import StepFailed

        wanted = Conditions.of(_model(data, f_ext, self.which))
        self.most, self.why = self.slips.finger.solver.counts.factorisations + most, ""
        start = min(self.solved, key=lambda each: _distance(each.conditions, wanted))
        try:
            self.solved.append(self.slips.solve(wanted, start))
        except (StepFailed, _TooManyError) as error:
            return {"f_ext": f_ext, "failure": str(error)}
        return _kept(self.solved[-1].state, f_ext)


def _model(data: Data, f_ext: float, which: int) -> Any:
    from fingerpad.model.options import FingerModel, by_rule, plan

    scene = meshed(data, f_ext, which)
    return FingerModel(by_rule(scene), plan(scene.replace(voltage=400.0))).of_path()


def _distance(one: Any, other: Any) -> float:
    """Return how far two conditions are apart; ridges that leave the screen take more work than those that come."""

    def place(conditions: Any) -> tuple[float, float, float]:
        pull = (conditions.voltage / (conditions.h_0 + 1.6e-6)) ** 2 / 1e16  # attraction, some 1 at 200 V
        return (
            float(np.log(conditions.f_ext)),
            float(np.log1p(pull)),
            float(np.log(conditions.friction.coefficient(1e4))),
        )

    steps = [b - a for a, b in zip(place(one), place(other), strict=True)]
    return float(sum(weight * max(step, -4 * step) for weight, step in zip((1.0, 2.0, 0.5), steps, strict=True)))


def pressed() -> list[Data]:
    """Return normal contact of the default finger without voltage under :data:`FAR`, on the second mesh."""
    from fingerpad.model.options import FingerModel, by_rule, plan
    from fingerpad.model.simulation import Simulation
    from fingerpad.startup import MPI

    history = [{"name": f"press {f_ext:g}", "f_ext": f_ext} for f_ext in FAR]
    scene = from_data({"history": history, "mesh": MESHES[1], "output": {"errors": False, "receptors": False}})
    simulation = Simulation(FingerModel(by_rule(scene), plan(scene)), MPI.COMM_WORLD)
    simulation.run()
    by_load = {state.load: state for state in simulation.states}  # the last one of each
    return [_kept(by_load[f"press {f_ext:g}"], f_ext) for f_ext in FAR]


def _kept(state: ContactState, f_ext: float) -> Data:
    values = {key: getattr(state, key) for key in RESULTS}
    return {"f_ext": f_ext} | {key: value for key, value in values.items() if isinstance(value, int | float)}


def solved(folder: Path, minutes: float, of: Tasks | None = None) -> dict[str, list[Data]]:
    """Return the states of tasks by name, computing those that are missing; each task is a file in the folder.

    Args:
        folder: of the tasks.
        minutes: of processor time after which no task is begun.
        of: the tasks; by default all of :func:`benchmarks.loads.scenes.tasks`.
    """
    folder.mkdir(parents=True, exist_ok=True)
    pools: dict[int, Pool] = {}
    found = {}
    for name, (which, points) in (tasks() if of is None else of).items():
        text = json.dumps([points, MESHES[which]], sort_keys=True)
        file = folder / f"{sha256(text.encode()).hexdigest()[:12]}.json"
        if not file.exists():
            if time.process_time() > 60 * minutes:
                continue
            if which not in pools:
                pools[which] = Pool.begin(which)
            states = [pools[which].state(data, f_ext) for data, f_ext in points]
            replace(file, json.dumps(states) + "\n")
            print(f"{name}: {' '.join(_shown(each) for each in states)}", flush=True)
        found[name] = json.loads(file.read_text(encoding="utf-8"))
    return found


def _shown(state: Data) -> str:
    value = f"{state['mu_app']:.4g}" if "mu_app" in state else "none"
    return f"{value} ({state['factorisations']})"


def short(state: Data) -> Data:
    """Return what a file in docs has of a state, numbers of seven digits."""
    found = {key: state[key] for key in _SHORT if key in state}
    return {key: float(f"{value:.7g}") if isinstance(value, float) else value for key, value in found.items()}


def by_scene(every: Sequence[Data], states: Mapping[str, Sequence[Data]]) -> list[Data]:
    """Return the scenes that were solved, each with its number, values and states."""
    return [
        {"scene": k, "values": data, "states": [short(each) for each in states[f"scene {k}"]]}
        for k, data in enumerate(every)
        if f"scene {k}" in states
    ]
