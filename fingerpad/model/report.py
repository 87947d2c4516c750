"""A path while it is followed: each accepted state is kept, with what pictures need, printed and written at once."""

import json
import logging
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI

from fingerpad.io import states
from fingerpad.io.console import Console
from fingerpad.io.drawing import Drawing, End, Profile, View
from fingerpad.io.quantities import Output, valued
from fingerpad.io.writing import Writer, ridge_rows, site_rows
from fingerpad.model.cost import Clock
from fingerpad.model.finger import Step
from fingerpad.model.options import Omission
from fingerpad.model.simulation import Simulation
from fingerpad.model.stability import Checked
from fingerpad.model.viewer import Viewer
from fingerpad.scene import Load
from variational.state import ContactState


class PathRecord:
    """Keeps accepted states.

    Attributes:
        states: in order, on every rank.
        profiles: the skin by step, on rank 0.
        ends: the finger at the end of each load, by load, on rank 0.
    """

    def __init__(self, comm: MPI.Comm, checks: Mapping[int, Checked]) -> None:
        """Keep nothing yet.

        Args:
            comm: communicator of the run.
            checks: stability by step, as far as it is examined.
        """
        self._comm, self._checks = comm, checks
        self.states: list[ContactState] = []
        self.profiles: dict[int, Profile] = {}
        self.ends: dict[str, End] = {}

    def named(self, final: Mapping[str, View], loads: Sequence[str]) -> dict[str, ContactState]:
        """Return the named states with their stability and, on every rank, their skin; collective.

        Args:
            final: states on the mesh that the run ended with, whose skin is to be shown, by name.
            loads: names of the loads in order.
        """
        found = {}
        for name, state in states.named(self.states, loads).items():
            profile = final[name].profile if name in final else self.profiles.get(state.step)
            numbers = np.arange(0) if state.ridges is None else state.ridges.number
            skin = self._comm.bcast(None if profile is None else profile.skin(numbers))
            # A full slip counts because it was held; the row of its first step is of before that.
            found[name] = replace(state, skin=skin, slip_held=state.slip_held or name == "full_slip")
            check = self._check(state)
            if check is not None:
                verdict, least = check.stable, check.frozen.lambda_min
                found[name] = replace(found[name], stable=verdict, lambda_min=least, gain=check.gain)
        return found

    def _check(self, state: ContactState) -> Checked | None:
        """Return the stability of a state, or of another one of the same full slip; None where none was examined."""
        same = [other.step for other in self.states if other.slip_began == state.slip_began > 0]
        return next((self._checks[k] for k in (state.step, *same) if k in self._checks), None)

    def loads(self, loads: Sequence[Load]) -> list[states.LoadResult]:
        """Return the result of each load of a history."""

        def stable(k: int, end: ContactState) -> bool | None:
            check = self._check(end)
            return None if check is None else check.stable

        return list(states.load_results(self.states, loads, stable))

    def drawing(
        self, mu_0: float | None, final: Mapping[str, View], size: float | None, named: Mapping[str, ContactState]
    ) -> Drawing | None:
        """Return what the pictures are drawn from, on rank 0; None without a state.

        Args:
            mu_0: friction coefficient; None where the law of friction is not Coulomb's.
            final: as of :meth:`named`.
            size: contact size (m) of the path's mesh, where an accuracy was asked for.
            named: the named states, with their estimated errors.
        """
        if not self.states or self._comm.rank != 0:
            return None
        whole = Drawing(mu_0, self.states, self.profiles, self.ends, final, size, named)
        shown = whole.steps_along()
        return replace(whole, profiles={step: p for step, p in self.profiles.items() if step in shown})

    def totals(self) -> dict[str, Any]:
        """Return sums and largest values over all states, ready for JSON."""
        records = [s.record for s in self.states if s.record is not None]
        jumps = [r for r in records if r.jump]
        return {
            "steps": len(self.states),
            "jumps": len(jumps),
            "cutbacks": sum(r.cutbacks for r in records),
            "penetration": max((r.penetration for r in records), default=0.0),
            "imbalance": max((r.imbalance for r in records), default=0.0),
            "energy_released": sum(r.energy_released for r in jumps),
            "energy_released_error": sum(r.released_error for r in jumps),
            "dissipation": sum(r.dissipation for r in records),
            "floor": max((r.floor for r in records), default=0.0),
        }


class Report:
    """Prints and writes the states of a simulation.

    Attributes:
        record: the states.
    """

    def __init__(
        self,
        simulation: Simulation,
        omitted: Sequence[Omission],
        writer: Writer,
        console: Console,
        clock: Clock,
        outputs: Sequence[Output] = (),
    ) -> None:
        """Print the model; nothing is written before there is a step.

        Args:
            simulation: set up, at its start.
            omitted: parts that its model leaves out.
            writer: writes into the folder.
            console: prints.
            clock: of the run.
            outputs: computed from each state.
        """
        self._outputs = outputs
        self._simulation, self._writer, self._console, self._clock = simulation, writer, console, clock
        finger, checks = simulation.finger, simulation.checks
        self.record = PathRecord(finger.problem.mesh.comm, checks)
        self._viewer = Viewer(finger)
        self._written = self._logged = 0
        for omission in omitted:
            console.show(f"{omission}")
            writer.log.info("%s", omission)
        console.show(f"{finger.unknowns} unknowns, {len(finger.ridges)} ridges that can touch")
        console.head()

    def step(self, step: Step, done: float) -> None:
        """Report an accepted step; collective.

        Args:
            step: the present state.
            done: part of the whole history that is done.
        """
        with self._clock.phase("output"):
            assert step.state.record is not None
            self._writer.take(self._simulation.finger.problem)
            record = replace(step.state.record, processor_seconds=self._clock.processor_seconds())
            state = replace(step.state, record=record, sites=self._viewer.sites(), changes=tuple(step.attempt.changes))
            state = valued(state, self._outputs)
            self.record.states.append(state)
            profile = self._viewer.profile(step)
            if profile is not None:
                self.record.profiles[state.step] = profile
            self._writer.row("steps", state.row())
            self._tables("", {"step": state.step}, state, state.mesh_contact)
            for iteration, change in enumerate(state.changes):
                self._writer.row("coupling", {"step": state.step, "iteration": iteration + 1, "change": change})
            self._console.step(state, done)
            if self._simulation.finger.problem.mesh.comm.rank == 0:
                self._log(step, state)

    def _tables(self, end: str, first: Mapping[str, Any], state: ContactState, size: float) -> None:
        """Write the rows of ridges in contact and of receptor sites of a state."""
        for name, rows in (("ridges", ridge_rows(state)), ("receptors", site_rows(state))):
            for row in rows:
                self._writer.row(f"{name}{end}", {**first, **row, "mesh_contact": size})

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
        """Write the present state for ParaView and keep it for the pictures, if it was reported; collective."""
        with self._clock.phase("output"):
            done = self.record.states
            last = done[-1].step if done else 0
            if self._written != last == self._simulation.finger.continuation.steps:
                self._written = last
                self._writer.fields(last, done[-1].load if done else "")
                self._log_checks()
                snapshot, merkel = self._viewer.picture()
                if snapshot is not None:
                    self.record.ends[done[-1].load] = End(done[-1], snapshot, merkel)

    def _log_checks(self) -> None:
        for step, check in list(self._simulation.checks.items())[self._logged :]:
            level = logging.INFO if check.stable else logging.WARNING
            self._writer.log.log(level, "state of step %d is %s", step, check)
        self._logged = len(self._simulation.checks)

    def final(self, views: Mapping[str, View]) -> None:
        """Write the tables of states on the mesh that the run ended with, by name."""
        if views:
            words = "; ".join(f"{states.WORDS[name]}: contact size {v.mesh.contact:g} m" for name, v in views.items())
            path = "steps.csv, history.png and *.bp are of the path on the starting mesh; %s"
            self._writer.log.info(path, words)
        for state, view in views.items():
            self._tables("_final", {"of": state}, view.state, view.mesh.contact)
