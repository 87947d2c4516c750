"""Restarts of a run: all loads again, since an omitted part of the model turned out to matter."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fingerpad.io.console import Console
from fingerpad.model.cost import Clock
from fingerpad.model.finger import Finger
from fingerpad.model.simulation import RestartRequired
from variational.state import ContactState


class Restarts:
    """Reports restarts and keeps them.

    Attributes:
        table: the restarts, ready for JSON.
        notes: remarks for a reader of the result, on the restarts with smaller elements.
    """

    def __init__(self, log: logging.Logger, console: Console) -> None:
        """Start without any."""
        self._log, self._console = log, console
        self.table: list[dict[str, Any]] = []
        self.notes: list[str] = []
        self._seconds = 0.0

    def kept(self) -> dict[str, Any]:
        """Return what another process needs to go on."""
        return {"table": self.table, "notes": self.notes, "seconds": self._seconds}

    def resume(self, kept: Mapping[str, Any]) -> None:
        """Go on from what another process kept."""
        self.table, self.notes, self._seconds = kept["table"], kept["notes"], kept["seconds"]

    def record(self, restart: RestartRequired, states: Sequence[ContactState], finger: Finger, clock: Clock) -> None:
        """Record a restart; collective.

        Args:
            restart: what is to be added, and why.
            states: accepted until here.
            finger: with the model until here.
            clock: of the run.
        """
        mesh = restart.model.mesh
        step, load = (states[-1].step, states[-1].load) if states else (0, "start")
        whole, seconds = restart.model.options.both_halves, clock.processor_seconds()
        halves = " and both halves of the finger" if whole and not finger.options.both_halves else ""
        added = f"mesh.touching_half_arc {mesh.touching_half_arc:g} m{halves}"
        if mesh.contact < finger.size.contact:
            added = f"mesh.contact {mesh.contact:g} m"
            size = finger.size.contact * 1e6
            self.notes.append(
                f"No equilibrium was found with a contact size of {size:g} µm; the run started again with half of it."
            )
        text = f"step {step} ({load}): {restart.reason}; all loads again with {added}"
        self._console.show(f"fingerpad: {text}")
        self._log.warning(text)
        counts = finger.solver.counts
        self.table.append(
            {
                "step": step,
                "load": load,
                "reason": restart.reason,
                "contact": mesh.contact,
                "touching_half_arc": mesh.touching_half_arc,
                "both_halves": whole,
                "unknowns": finger.unknowns,
                "newton_iterations": counts.newton,
                "factorisations": counts.factorisations,
                "processor_seconds": seconds - self._seconds,
            }
        )
        self._seconds = seconds
