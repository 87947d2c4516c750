"""What follows a path that is lost, or whose model is too small: hints in the words of a scene's keys, and restarts."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fingerpad.model.finger import Finger, meshed
from fingerpad.model.options import FingerModel
from fingerpad.model.simulation import RestartRequired
from fingerpad.results.interrupt import Interrupted
from fingerpad.results.terminal import Console
from fingerpad.startup import MPI
from geometry.profiles import GeometryError
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import NotConverged
from variational.state import ContactState

FINEST = 5e-6
"""Contact size (m) down to which a run starts again by itself where the path of its loads cannot be followed."""
_HINTS = {
    "NOT_A_NUMBER": "report it with the scene; until then try parameters nearer to the defaults",
    "MUMPS_OUT_OF_MEMORY": "try a larger mesh.contact, fewer ranks, or a machine with more memory",
    "MUMPS_OUT_OF_WORKSPACE": "try fewer ranks or a larger mesh.contact; it had 17 times the workspace of its estimate",
    "MUMPS_SINGULAR": "try pressing with a bone_height before an f_ext, or a smaller voltage",
    "MUMPS_FAILED": "look the code up in the users' guide of MUMPS, section 8",
    "COUPLING_CAP": "try a larger numerics.coupling_cap, or another voltage: the ridge may be at its fold",
    "DIVERGED_MAX_IT": "try a larger -fingerpad_snes_max_it, or a smaller mesh.contact",
}
_INVERTED = (
    "try a smaller f_ext or voltage, or a smaller mesh.contact and mesh.interface, where elements turn inside out"
)
_OTHERWISE = "try a smaller mesh.contact, which lets the edge of the contact move, or another voltage or f_ext"


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

    def record(self, restart: RestartRequired, states: Sequence[ContactState], finger: Finger, seconds: float) -> None:
        """Record a restart, or show one that carries; states, finger and processor time (s) are those until here."""
        mesh, counts = restart.model.mesh, finger.solver.counts
        step, load = (states[-1].step, states[-1].load) if states else (0, "start")
        whole = restart.model.options.both_halves
        halves = " and both halves of the finger" if whole and not finger.options.both_halves else ""
        added = f"mesh.touching_half_arc {mesh.touching_half_arc:g} m{halves}"
        if mesh.contact < finger.size.contact:
            added = f"mesh.contact {mesh.contact:g} m"
            size = finger.size.contact * 1e6
            self.notes.append(
                f"No equilibrium was found with a contact size of {size:g} µm; the run started again with half of it."
            )
        text = f"step {step} ({load}): {restart.reason}; "
        text += f"{'the path goes on' if restart.carries else 'all loads again'} with {added}"
        self._console.show(f"fingerpad: {text}")
        self._log.warning(text)
        if restart.carries:
            return
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


def hint(error: StepFailed) -> str:
    """Return what to try against a load that could not be reached, empty if the error names it itself."""
    cause = error.__cause__
    if not isinstance(cause, NotConverged):
        return ""
    if cause.inverted:
        return _INVERTED
    return next((words for name, words in _HINTS.items() if cause.reason.startswith(name)), _OTHERWISE)


def _finer_mesh_may_help(error: StepFailed, coarse_start: bool) -> bool:
    """Return whether a load that could not be reached may be with a smaller ``mesh.contact``.

    A mesh that was chosen as one to start from, and not by a person, may always be too coarse.
    """
    if coarse_start:
        return not isinstance(error, Interrupted)
    return "smaller mesh.contact" in hint(error)


def finer(model: FingerModel, error: StepFailed, comm: "MPI.Comm", reason: str = "") -> RestartRequired | None:
    """Return a restart with smaller elements, where that may help and is possible; collective.

    A path whose elements are twice as large as those of the final mesh is followed on that mesh. Else the contact size
    is halved.

    ``reason`` is why the loads were not reached, with what else is known of the state before, in place of the error's
    words.
    """
    coarse = model.final is not None and model.mesh.contact > model.final.contact
    helps = model.mesh_file is None and _finer_mesh_may_help(error, bool(model.asked) or coarse)
    contact = model.mesh.contact / 2
    if not helps or (contact < FINEST and not coarse):
        return None
    mesh = model.final if coarse else model.mesh.model_copy(update={"contact": contact})
    finer = model.changed(mesh=mesh, final=None if model.final is None else mesh)
    try:
        meshed(finer, comm)
    except GeometryError:  # more than the memory allowed
        return None
    return RestartRequired(reason or str(error), finer)
