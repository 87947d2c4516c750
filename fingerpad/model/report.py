"""What is kept of a run while it goes: its states, the skin and the finger to draw, and in the end its result."""

import json
import logging
import time
from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from mpi4py import MPI

from fingerpad.io import states
from fingerpad.io.console import Console
from fingerpad.io.drawing import Drawing, End
from fingerpad.io.place import Place
from fingerpad.io.provenance import provenance
from fingerpad.io.result import Cost, Result
from fingerpad.io.views import Profile, View
from fingerpad.io.writing import Writer
from fingerpad.model.balance import broken
from fingerpad.model.contact_zone import RestartRequired
from fingerpad.model.options import Omission
from fingerpad.model.simulation import Simulation
from fingerpad.model.steps import Checked, Step, force_error
from fingerpad.model.touching import left_out
from fingerpad.model.viewer import Viewer
from fingerpad.scene import Scene
from fingerpad.scene.laws import coefficient, used
from variational.solvers.timing import memory_mb
from variational.state import ContactState


class Report:
    """Keeps and prints a run, and writes it into a folder if there is one.

    Attributes:
        states: accepted states, on every rank.
        console: what a person sees.
        seconds: spent here (s).
    """

    def __init__(self, scene: Scene, place: Place | None, comm: MPI.Comm, console: Console) -> None:
        """Nothing is written before there is a step.

        Args:
            scene: what is run.
            place: the folder, locked; None to write nothing.
            comm: communicator of the run.
            console: prints.
        """
        self.scene, self.comm, self.console = scene, comm, console
        self._folder = None if place is None else place.folder
        self._writer = Writer(place, comm)
        self.log = self._writer.log
        self.log.info("scene %s", json.dumps(scene.parameters()))
        self.states: list[ContactState] = []
        self.seconds = 0.0
        self._start = self._begun = time.perf_counter()
        self._processor = time.process_time()
        self._setup = 0.0
        self._simulation: Simulation | None = None
        self._profiles: dict[int, Profile] = {}
        self._ends: dict[str, End] = {}
        self._finer: dict[str, View] = {}
        self._written = self._checks = 0
        self._woken: list[dict[str, Any]] = []

    def say(self, text: str) -> None:
        """Print a line on rank 0, above the progress bar."""
        self.console.say(text)

    def open(self, simulation: Simulation) -> None:
        """Meet the simulation, once it is set up."""
        self._simulation = simulation
        self._setup += time.perf_counter() - self._begun
        self._viewer = Viewer(simulation)
        for omission in self._omitted(simulation):
            self.say(f"{omission}")
            self.log.info("%s", omission)
        self.say(f"{simulation.unknowns} unknowns, {len(simulation.ridges)} ridges that can touch")
        self.console.head()

    def restart(self, wake: RestartRequired) -> None:
        """Forget every step: the loads are gone through again, with what was left out."""
        assert self._simulation is not None
        counts, half_arc = self._simulation.solver.counts, wake.scene.mesh.touching_half_arc
        step, load = (self.states[-1].step, self.states[-1].load) if self.states else (0, "start")
        halves = " and both halves of the finger" if wake.needed.both_halves else ""
        text = f"step {step} ({load}): {wake}; all loads again with mesh.touching_half_arc {half_arc:g} m{halves}"
        self.say(f"fingerpad: {text}")
        self.log.warning(text)
        self._woken.append(
            {
                "step": step,
                "load": load,
                "reason": str(wake),
                "touching_half_arc": half_arc,
                "both_halves": wake.needed.both_halves,
                "newton_iterations": counts.newton,
                "factorisations": counts.factorisations,
            }
        )
        self._writer.restart()
        for kept in (self.states, self._profiles, self._ends, self._finer):
            kept.clear()
        self._written = self._checks = 0
        self._begun = time.perf_counter()

    # -- steps -----------------------------------------------------------------------------------------
    def step(self, step: Step, done: float) -> None:
        """Report an accepted step; collective."""
        start = time.perf_counter()
        assert self._simulation is not None and step.state.record is not None
        self._writer.take(self._simulation.problem)
        record = replace(step.state.record, processor_seconds=self._processor_seconds())
        state = replace(step.state, record=record)
        self.states.append(state)
        profile, receptors = self._viewer.profile(step), self._viewer.receptors(step)
        if profile is not None:
            self._profiles[state.step] = profile
        self._writer.row("steps", state.row())
        size = {"mesh_contact": state.mesh_contact}
        for name, found in (("ridges", self._viewer.ridges(step)), ("receptors", receptors)):
            for each in found:
                self._writer.row(name, each | size)
        for sweep, change in enumerate(step.attempt.changes):
            self._writer.row("coupling", {"step": state.step, "sweep": sweep + 1, "change": change})
        self.console.step(state, done)
        if self.comm.rank == 0:
            self._log(step, state)
        self.seconds += time.perf_counter() - start

    def _log(self, step: Step, state: ContactState) -> None:
        assert self._simulation is not None
        self.log.info("step %s sweeps %s", json.dumps(state.row()), step.attempt.changes)
        for cut in step.attempt.cutbacks:
            self.log.warning("step %d cut: %s", state.step, cut)
        notes = [f"ridge {j} {note}" for j, note in zip(self._simulation.ridges, step.notes, strict=True) if note]
        if notes:
            self.log.warning("step %d closure: %s", state.step, ", ".join(notes))

    def _processor_seconds(self) -> float:
        """Return the processor time (s) of all ranks since the start; collective."""
        return float(self.comm.allreduce(time.process_time() - self._processor))

    def load_reached(self) -> None:
        """Write the present state for ParaView and keep it for the pictures, if it was reported; collective."""
        start = time.perf_counter()
        assert self._simulation is not None
        last = self.states[-1].step if self.states else 0
        if self._written != last == self._simulation.continuation.steps:
            self._written = last
            self._writer.fields(last)
            self._log_checks()
            snapshot, merkel = self._viewer.picture()
            if snapshot is not None:
                self._ends[self.states[-1].load] = End(self.states[-1], snapshot, merkel)
        self.seconds += time.perf_counter() - start

    def look(self, simulation: Simulation) -> View:
        """Return what is to be shown of a state that was solved again on another mesh; collective."""
        return Viewer(simulation).view()

    def finer(self, views: Mapping[str, View]) -> None:
        """Take states of the mesh that the run ended with, by name, and write their tables."""
        self._finer = dict(views)
        if views:
            words = "; ".join(f"{states.WORDS[name]}: contact size {v.mesh.contact:g} m" for name, v in views.items())
            self.log.info("steps.csv, history.png and *.bp are of the path on the starting mesh; %s", words)
        for state, view in views.items():
            for name, found in (("ridges", view.ridges), ("receptors", view.receptors)):
                for row in found:
                    values = {key: value for key, value in row.items() if key != "step"}
                    size = {"mesh_contact": view.mesh.contact}
                    self._writer.row(f"{name}_final", {"of": state} | values | size)

    def _log_checks(self) -> None:
        assert self._simulation is not None
        for step, check in list(self._simulation.checks.items())[self._checks :]:
            self.log.log(logging.INFO if check.stable else logging.WARNING, "state of step %d is %s", step, check)
        self._checks = len(self._simulation.checks)

    # -- the end ---------------------------------------------------------------------------------------
    def named(self) -> dict[str, ContactState]:
        """Return the named states of the path, with their stability and, on every rank, their skin; collective."""
        found = {name: self._complete(state) for name, state in states.named(self.states).items()}
        # It counts because it was held; its own row is of before that.
        return {n: replace(s, slip_held=True) if n == "full_slip" else s for n, s in found.items()}

    def _complete(self, state: ContactState) -> ContactState:
        state, check = self._with_skin(state, self._profiles.get(state.step)), self._check(state)
        if check is None:
            return state
        return replace(state, stable=check.stable, lambda_min=check.frozen.lambda_min, gain=check.gain)

    def on_final_mesh(self, named: Mapping[str, ContactState]) -> dict[str, ContactState]:
        """Return named states with the skin of the mesh that the run ended with, where there is one; collective."""
        return {
            name: self._with_skin(state, self._finer[name].profile) if name in self._finer else state
            for name, state in named.items()
        }

    def _with_skin(self, state: ContactState, profile: Profile | None) -> ContactState:
        """Return a state with the skin that rank 0 has; collective."""
        numbers = np.arange(0) if state.ridges is None else state.ridges.number
        return replace(state, skin=self.comm.bcast(None if profile is None else profile.skin(numbers)))

    def _check(self, state: ContactState) -> Checked | None:
        """Return the stability of a state, or of another one of the same full slip; None where none was examined."""
        assert self._simulation is not None
        same = [other.step for other in self.states if other.slip_began == state.slip_began > 0]
        return next((self._simulation.checks[k] for k in (state.step, *same) if k in self._simulation.checks), None)

    def result(self, named: Mapping[str, ContactState], ended: Mapping[str, Any]) -> Result:
        """Return the result, and write it and the pictures; collective.

        Args:
            named: the named states.
            ended: ``failure``, ``interrupted``, ``notes`` and ``unknowns`` of the final mesh, where there are any, and
                what else is to be kept of the run's end.
        """
        assert self._simulation is not None
        start = time.perf_counter()
        self._writer.take(self._simulation.problem)
        more = dict(ended)
        unknowns = int(more.pop("unknowns", self._simulation.unknowns))
        words = {name: more.pop(name, "") for name in ("failure", "interrupted")}
        notes = tuple(more.pop("notes", ()))
        drawing = self._drawing(named)
        if drawing is not None and self._folder is not None:
            drawing.write(self._folder)
        self.seconds += time.perf_counter() - start
        record = self.comm.bcast(self._record(unknowns))
        found = Result(
            self.scene,
            "full",
            named.get("uncharged"),
            named.get("charged"),
            named.get("full_slip"),
            steps=tuple(self.states),
            loads=tuple(self._loads()),
            cost=self.comm.bcast(self._cost(unknowns)),
            **words,
            notes=notes,
            record=record | more | {"laws": used(self.scene), "provenance": provenance()},
            folder=self._folder,
            drawing=drawing,
        )
        defect = broken(found.full_slip, found.record["force_error"], coefficient(self.scene))
        if defect and not found.failure:
            found = replace(found, failure=defect)
        self._writer.summary(found.to_dict())
        return found

    def _drawing(self, named: Mapping[str, ContactState]) -> Drawing | None:
        """Return what the pictures are drawn from, on rank 0."""
        assert self._simulation is not None
        if not self.states or self.comm.rank != 0:
            return None
        size = None if self.scene.accuracy is None else self._simulation.scene.mesh.contact
        whole = Drawing(coefficient(self.scene), self.states, self._profiles, self._ends, self._finer, size, named)
        shown = whole.steps_along()
        return replace(whole, profiles={step: p for step, p in self._profiles.items() if step in shown})

    def _loads(self) -> list[states.LoadResult]:
        found = []
        for name, mine in states.by_load(self.states):
            check = self._check(mine[-1])
            found.append(states.load_result(name, mine, None if check is None else check.stable))
        return found

    def _cost(self, unknowns: int) -> Cost:
        assert self._simulation is not None
        counts = self._simulation.solver.counts
        return Cost(
            self._processor_seconds(),
            time.perf_counter() - self._start,
            counts.newton,
            counts.factorisations,
            unknowns,
            self.comm.allreduce(memory_mb()),
            self.comm.size,
        )

    def _record(self, unknowns: int) -> dict[str, Any]:
        """Return what else is to be said of the path, ready for JSON."""
        assert self._simulation is not None
        simulation, records = self._simulation, [s.record for s in self.states if s.record is not None]
        jumps = [r for r in records if r.jump]
        floor = max((r.floor for r in records), default=0.0)
        left = max(self.scene.numerics.tolerance, floor)
        seconds = {"setup": self._setup, **simulation.solver.timings.seconds, "output": self.seconds}
        return {
            "unknowns_path": simulation.unknowns,
            "path_mesh": None if self.scene.laws.mesh else simulation.scene.mesh.model_dump(),
            "steps": len(self.states),
            "jumps": len(jumps),
            "cutbacks": sum(r.cutbacks for r in records),
            "penetration": max((r.penetration for r in records), default=0.0),
            "imbalance": max((r.imbalance for r in records), default=0.0),
            "energy_released": sum(r.energy_released for r in jumps),
            "energy_released_error": sum(r.released_error for r in jumps),
            "dissipation": sum(r.dissipation for r in records),
            **{f"seconds_{phase}": value for phase, value in seconds.items()},
            "floor": floor,
            "force_error": force_error(unknowns, left, simulation.solver.force_scale),
            "omitted": [asdict(omission) for omission in self._omitted(simulation)],
            "woken": self._woken,
        }

    @staticmethod
    def _omitted(simulation: Simulation) -> tuple[Omission, ...]:
        return (*simulation.plan.omitted, *left_out(simulation.scene))

    def close(self, whole: bool = True) -> None:
        """Close every file; ``whole`` as in :meth:`fingerpad.io.writing.Writer.close`."""
        self.console.close()
        self._writer.close(whole)
