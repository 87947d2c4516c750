"""A path while it is followed: each accepted state kept, printed and written at once, and the time that it takes."""

import json
import logging
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from mpi4py import MPI

from fingerpad.model.finger import Step
from fingerpad.model.options import Omission
from fingerpad.model.record import PathRecord, Viewer
from fingerpad.model.simulation import Simulation
from fingerpad.results import states
from fingerpad.results.data import Cost, valued
from fingerpad.results.fields import View
from fingerpad.results.pictures import animation
from fingerpad.results.quantities import Output
from fingerpad.results.terminal import Console
from fingerpad.results.writing import Writer
from fingerpad.scene.messages import counted
from variational.solvers.outcome import Counts, memory_mb
from variational.state import ContactState

_PICTURED = ("skins", "moved", "ends")  # what pictures need of a path's record, beside its states


class Clock:
    """Wall and processor time since the run began.

    Attributes:
        seconds: wall time of the set-up and of the output (s), by these names.
    """

    def __init__(self, comm: MPI.Comm) -> None:
        """Start."""
        self._comm = comm
        self._wall, self._processor = time.perf_counter(), time.process_time()
        self.seconds = {"setup": 0.0, "output": 0.0}

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Count the time inside as that of a phase, ``setup`` or ``output``."""
        start = time.perf_counter()
        yield
        self.seconds[name] += time.perf_counter() - start

    def earlier(self, wall: float, processor: float) -> None:
        """Add the time (s) that the run took before it was cut short, all ranks' processor time together."""
        self._wall -= wall
        self._processor -= processor / self._comm.size

    def present(self) -> tuple[float, float]:
        """Return wall time and processor time of all ranks since the start (s); collective."""
        return time.perf_counter() - self._wall, self.processor_seconds()

    def processor_seconds(self) -> float:
        """Return the processor time (s) of all ranks since the start; collective."""
        return float(self._comm.allreduce(time.process_time() - self._processor))

    def cost(self, counts: Counts, unknowns: int) -> Cost:
        """Return the cost of a run of these iterations and unknowns, the same on every rank; collective."""
        memory, (wall, processor) = self._comm.allreduce(memory_mb()), self.present()
        found = Cost(processor, wall, counts.newton, counts.factorisations, unknowns, memory, self._comm.size)
        return self._comm.bcast(found)


class Report:
    """Prints and writes the states of a simulation.

    Attributes:
        record: the states.
        lost: outputs that could not be computed, by name, and why.
    """

    def __init__(
        self,
        simulation: Simulation,
        omitted: Sequence[Omission],
        loads: Sequence[str],
        writer: Writer,
        console: Console,
        clock: Clock,
        outputs: Sequence[Output] = (),
    ) -> None:
        """Print the model, and the parts that it leaves out; nothing is written before there is a step.

        Args:
            simulation: set up, at its start.
            omitted: parts that its model leaves out.
            loads: names of its loads in order.
            writer: of the folder.
            console: of the run.
            clock: of the run.
            outputs: computed from each state.
        """
        self._outputs, self.lost = outputs, dict[str, str]()
        self._simulation, self._writer, self._console, self._clock = simulation, writer, console, clock
        finger, checks = simulation.finger, simulation.checks
        self.record = PathRecord(finger.problem.mesh.comm, checks)
        self._viewer = Viewer(finger)
        self._shown = self._logged = 0  # step of the last load's end, and checks
        self._loads = loads
        for omission in omitted:
            console.show(f"{omission}")
            writer.log.info("%s", omission)
        console.show(f"{finger.unknowns} unknowns, {counted(len(finger.ridges), 'ridge')} that can touch")
        console.head()

    def step(self, step: Step, done: float) -> None:
        """Report an accepted step, the present state, with the part of the whole history that is done; collective."""
        with self._clock.phase("output"):
            assert step.state.record is not None
            self._writer.take()
            record = replace(step.state.record, processor_seconds=self._clock.processor_seconds())
            state = replace(step.state, record=record, changes=tuple(step.attempt.changes))
            state = replace(state, sites=self._viewer.sites(), stimuli=self._viewer.stimuli(step))
            state = valued(state, self._outputs, self.lost)
            self.record.states.append(state)
            skin, body = self._viewer.skin(step), self._viewer.body(fields=False)
            self._show(state, done)
            if skin is not None and body is not None:  # on rank 0
                self.record.move(state, skin, body)
                self._log(step, state)

    def _show(self, state: ContactState, done: float) -> None:
        self._writer.row("steps", state.row())
        self._console.step(state, done)

    def _log(self, step: Step, state: ContactState) -> None:
        log = self._writer.log
        log.info("step %s coupling iterations %s", json.dumps(state.row()), step.attempt.changes)
        for cut in step.attempt.cutbacks:
            log.warning("step %d cut: %s", state.step, cut)
        assert state.ridges is not None
        notes = [f"ridge {j} {note}" for j, note in zip(state.ridges.number, state.ridges.note, strict=True) if note]
        if notes:
            log.warning("step %d closure: %s", state.step, ", ".join(notes))

    def load_reached(self) -> None:
        """Keep the present state for pictures and fields, if it was reported; collective."""
        with self._clock.phase("output"):
            done = self.record.states
            last = done[-1].step if done else 0
            if self._shown != last == self._simulation.finger.continuation.steps:
                self._shown = last
                self._log_checks()
                snapshot, merkel = self._viewer.picture()
                if snapshot is not None:
                    self.record.ends[done[-1].load] = View(done[-1], None, None, snapshot, merkel)

    def kept(self) -> dict[str, Any]:
        """Return what another process needs to go on with all tables and pictures but the states, whole on rank 0."""
        self.record.prune(self._loads)
        found = {name: getattr(self.record, name) for name in _PICTURED}
        return found | {"shown": self._shown, "logged": self._logged, "log": self._writer.log_text()}

    def resume(self, states: list[ContactState], kept: Mapping[str, Any], done: float, listed: bool) -> None:
        """Go on from the states that another process accepted and from what it kept, on every rank; collective.

        Where this process has ``listed`` them, they are of another mesh, and the motion of the finger begins anew.
        """
        self._writer.earlier_log = kept["log"]
        self._writer.take()
        self.record.states, self._logged, self._shown = states, kept["logged"], kept["shown"]
        if self._simulation.finger.problem.mesh.comm.rank == 0:
            for name in _PICTURED:
                setattr(self.record, name, kept[name])
        if listed:
            self.record.moved = {}
        for state in self.record.states if not listed else ():
            self._show(state, done)

    def motion(self) -> dict[str, Any]:
        """Return the motion of the finger as a group of ``fields.npz``, on rank 0, nothing elsewhere; collective."""
        body = self._viewer.body(fields=False)
        return {} if body is None or not self.record.moved else {"motion": animation.group(body, self.record.moved)}

    def _log_checks(self) -> None:
        for step, check in list(self._simulation.checks.items())[self._logged :]:
            level = logging.INFO if check.stable else logging.WARNING
            self._writer.log.log(level, "state of step %d is %s", step, check)
        self._logged = len(self._simulation.checks)

    def final(self, views: Mapping[str, View]) -> None:
        """Log which states are on the mesh that the run ended with, by name."""
        if views:
            words = "; ".join(f"{states.WORDS[name]}: contact size {v.size:g} m" for name, v in views.items())
            self._writer.log.info("steps.csv and history.png are of the mesh of the path; %s", words)
