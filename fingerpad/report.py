"""What a run leaves: printed steps, tables, fields, summary, log and a progress bar; rank 0 alone writes text."""

import json
import logging
import logging.handlers
import time
from collections.abc import Mapping
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from fingerpad import drawing, states
from fingerpad.files import Table, replace_json
from fingerpad.laws import coefficient
from fingerpad.place import Place
from fingerpad.provenance import provenance
from fingerpad.scene import Scene
from fingerpad.simulation import Simulation
from fingerpad.steps import Checked, Step, force_error
from fingerpad.views import Profile, View, Viewer
from fingerpad.zone import Woken
from variational.output import Fields, Snapshot
from variational.timing import memory_mb

_HEADER = "step load     f_ext    U  bone x   bone y      f_T  mu_app    f_el ridges  contact newton fact."
_UNITS = "               N/m     V      mm       mm      N/m             N/m             mm"


class Report:
    """Writes a run into a folder; every accepted step is on disk before the next one starts.

    Attributes:
        rows: accepted steps, on every rank.
    """

    def __init__(self, scene: Scene, place: Place, comm: MPI.Comm) -> None:
        """Start the progress bar; nothing is written before there is a step.

        Args:
            scene: what is run.
            place: the folder, locked.
            comm: communicator of the run.
        """
        self.scene, self.folder, self.comm = scene, place.folder, comm
        self._place, self._taken = place, False
        self._fields: Fields | None = None
        self.rows: list[dict[str, Any]] = []
        self.seconds = 0.0
        self._start = self._begun = time.perf_counter()
        self._processor = time.process_time()
        self._setup = 0.0
        self._simulation: Simulation | None = None
        self._profiles: dict[int, Profile] = {}
        self._ends: dict[str, tuple[dict[str, Any], Snapshot, NDArray[np.float64] | None]] = {}
        self._finer: dict[str, View] = {}
        self._tables: dict[str, Table] = {}
        self._written = self._checks = 0
        self._woken: list[dict[str, Any]] = []
        self.log = logging.getLogger("fingerpad")
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:3.0f} %"),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            disable=comm.rank != 0,
            transient=True,
        )
        self._progress.disable |= not self._progress.console.is_terminal
        self._task = self._progress.add_task("meshing the finger", total=1.0)
        self.log.handlers = [logging.handlers.MemoryHandler(1000, logging.CRITICAL, flushOnClose=False)]
        self.log.setLevel(logging.INFO)
        self.log.info("scene %s", scene.model_dump_json())
        self._progress.start()

    def say(self, text: str) -> None:
        """Print a line on rank 0, above the progress bar."""
        if self.comm.rank == 0:
            self._progress.console.print(text, highlight=False, soft_wrap=True, markup=False)

    def open(self, simulation: Simulation) -> None:
        """Meet the simulation, once it is set up."""
        self._simulation = simulation
        self._setup += time.perf_counter() - self._begun
        self._viewer = Viewer(simulation)
        for omission in simulation.plan.omitted:
            self.say(f"{omission}")
            self.log.info("%s", omission)
        self.say(f"{simulation.unknowns} unknowns, {len(simulation.ridges)} ridges that can touch")
        self.say(_HEADER)
        self.say(_UNITS)

    def _take(self) -> None:
        """Open the log and the fields where that has not been done, an earlier run's files gone; collective."""
        assert self._simulation is not None
        if not self._taken:
            self._taken = True
            self._place.take()
            if self.comm.rank == 0:
                _send(self.log, _LogFile(self.folder / "run.log", mode="w", encoding="utf-8"))
        if self._fields is None:
            self._fields = Fields(self._simulation.problem, self.folder)

    def restart(self, wake: Woken) -> None:
        """Forget every step: the loads are gone through again, with what was left out."""
        assert self._simulation is not None
        counts, half_arc = self._simulation.solver.counts, wake.scene.mesh.touching_half_arc
        last: dict[str, Any] = self.rows[-1] if self.rows else {"step": 0, "load": "start"}
        halves = " and both halves of the finger" if wake.needed.both_halves else ""
        text = f"step {last['step']} ({last['load']}): {wake}; all loads again with "
        text += f"mesh.touching_half_arc {half_arc:g} m{halves}"
        self.say(f"fingerpad: {text}")
        self.log.warning(text)
        self._woken.append(
            {
                "step": last["step"],
                "load": last["load"],
                "reason": str(wake),
                "touching_half_arc": half_arc,
                "both_halves": wake.needed.both_halves,
                "newton_iterations": counts.newton,
                "factorisations": counts.factorisations,
            }
        )
        self._close_files()
        for kept in (self.rows, self._profiles, self._ends, self._finer, self._tables):
            kept.clear()
        self._written = self._checks = 0
        self._begun = time.perf_counter()

    # -- steps -----------------------------------------------------------------------------------------
    def step(self, step: Step, done: float) -> None:
        """Report an accepted step; collective."""
        start = time.perf_counter()
        assert self._simulation is not None
        self._take()
        size = {"mesh_contact": self._simulation.scene.mesh.contact}
        row = step.row | size | {"processor_seconds": self._processor_seconds()}
        self.rows.append(row)
        profile, receptors = self._viewer.profile(step), self._viewer.receptors(step)
        if self.comm.rank == 0:
            assert profile is not None
            self._profiles[row["step"]] = profile
            self._table("steps", row)
            for name, found in (("ridges", self._viewer.ridges(step)), ("receptors", receptors)):
                for each in found:
                    self._table(name, each | size)
            for sweep, change in enumerate(step.attempt.changes):
                self._table("coupling", {"step": row["step"], "sweep": sweep + 1, "change": change})
            self._print(step, done)
        self.seconds += time.perf_counter() - start

    def _processor_seconds(self) -> float:
        """Return the processor time (s) of all ranks since the start; collective."""
        return float(self.comm.allreduce(time.process_time() - self._processor))

    def _print(self, step: Step, done: float) -> None:
        r = step.row
        self.say(
            f"{r['step']:4d} {r['load'][:7]:7s} {r['f_ext']:7.3f} {r['voltage']:5.1f} {r['bone_x'] * 1e3:7.4f} "
            f"{r['bone_height'] * 1e3:8.5f} {r['f_t']:8.4f} {r['mu_app']:7.4f} {r['f_electrostatic']:7.3f} "
            f"{r['ridges_in_contact']:6d} {r['contact_length'] * 1e3:8.4f} {r['newton_iterations']:6d} "
            f"{r['factorisations']:5d}{'  jump, ' + _released(r) if r['jump'] else ''}"
        )
        self.log.info("step %s sweeps %s", json.dumps(r), step.attempt.changes)
        for cut in step.attempt.cutbacks:
            self.log.warning("step %d cut: %s", r["step"], cut)
        assert self._simulation is not None
        notes = [f"ridge {j} {s}" for j, s in zip(self._simulation.ridges, step.states, strict=True) if s]
        if notes:
            self.log.warning("step %d closure: %s", r["step"], ", ".join(notes))
        loads = f"{r['load']}: {r['f_ext']:.1f} N/m, {r['voltage']:.0f} V, x {r['bone_x'] * 1e3:.2f} mm"
        self._progress.update(self._task, completed=done, description=f"{loads}, µ {r['mu_app']:.3f}")

    def _table(self, name: str, row: dict[str, Any]) -> None:
        if name not in self._tables:
            self._tables[name] = Table(self.folder / f"{name}.csv", row)
        self._tables[name].write(row)

    def load_reached(self) -> None:
        """Write the present state for ParaView and keep it for the pictures, if it was reported; collective."""
        start = time.perf_counter()
        assert self._simulation is not None
        last = self.rows[-1] if self.rows else {"step": 0}
        if self._written != last["step"] == self._simulation.continuation.steps:
            assert self._fields is not None
            self._written = last["step"]
            self._fields.write(float(self._written))
            self._log_checks()
            snapshot, merkel = self._viewer.picture()
            if snapshot is not None:
                self._ends[last["load"]] = (last, snapshot, merkel)
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
        if self.comm.rank == 0:
            for state, view in views.items():
                for name, found in (("ridges", view.ridges), ("receptors", view.receptors)):
                    for row in found:
                        values = {key: value for key, value in row.items() if key != "step"}
                        self._table(f"{name}_final", {"of": state} | values | {"mesh_contact": view.mesh.contact})

    def _log_checks(self) -> None:
        assert self._simulation is not None
        for step, check in list(self._simulation.checks.items())[self._checks :]:
            self.log.log(logging.INFO if check.stable else logging.WARNING, "state of step %d is %s", step, check)
        self._checks = len(self._simulation.checks)

    # -- the end ---------------------------------------------------------------------------------------
    def summary(self, ended: dict[str, Any]) -> dict[str, Any]:
        """Write ``summary.json`` and return it; ``ended`` is what else is to be said of the run's end."""
        assert self._simulation is not None
        self._take()
        solver, rows = self._simulation.solver, self.rows
        last: dict[str, Any] = rows[-1] if rows else {}
        seconds = {"setup": self._setup, **solver.timings.seconds, "output": self.seconds}
        peak = self.comm.allreduce(memory_mb())
        result: dict[str, Any] = {
            "f_ext": last.get("f_ext", 0.0),
            "voltage": last.get("voltage", 0.0),
            "full_slip": any(row["slip_held"] for row in rows),
            "newton_iterations": solver.counts.newton,
            "factorisations": solver.counts.factorisations,
            "unknowns": self._simulation.unknowns,
            "unknowns_path": self._simulation.unknowns,
            "path_mesh": self._simulation.scene.mesh.model_dump(),
            "wall_seconds": time.perf_counter() - self._start,
            "processor_seconds": self._processor_seconds(),
            "steps": len(rows),
            "jumps": sum(row["jump"] for row in rows),
            "cutbacks": sum(row["cutbacks"] for row in rows),
            "penetration": max((row["penetration"] for row in rows), default=0.0),
            "imbalance": max((row["imbalance"] for row in rows), default=0.0),
            "energy_released": sum(row["energy_released"] for row in rows if row["jump"]),
            "energy_released_error": sum(row["released_error"] for row in rows if row["jump"]),
            "dissipation": sum(row["dissipation"] for row in rows),
            "memory_mb": peak,
            "ranks": self.comm.size,
            **{f"seconds_{phase}": value for phase, value in seconds.items()},
        }
        found = states.named(rows)
        for prefix in states.STATES:
            row = found.get(prefix)
            names = (*states.CONDITIONS, *states.RESULTS)
            result |= {f"{prefix}_{name}": None if row is None else row[name] for name in names}
            check = None if row is None else self._check(row)
            result[f"{prefix}_stable"] = None if check is None else check.stable
            result[f"{prefix}_lambda_min"] = None if check is None else check.frozen.lambda_min
            result[f"{prefix}_gain"] = None if check is None else check.gain
        result["loads"] = []
        for name, mine in states.by_load(rows):
            check = self._check(mine[-1])
            result["loads"].append(states.summary(name, mine, None if check is None else check.stable))
        result |= ended
        numerics, scale = self.scene.numerics, solver.force_scale
        result["floor"] = max((row["floor"] for row in rows), default=0.0)
        left = max(numerics.tolerance, result["floor"])
        result["force_error"] = force_error(result["unknowns"], left, scale)
        result |= {"omitted": self._simulation.plan.table(), "woken": self._woken}
        result["provenance"] = provenance()
        result["parameters"] = self.scene.parameters()
        if self.comm.rank == 0:
            replace_json(self.folder / "summary.json", result)
        return result

    def _check(self, row: states.Row) -> Checked | None:
        """Return the stability of a state, or of another one of the same full slip; None where none was examined."""
        assert self._simulation is not None
        same = [other["step"] for other in self.rows if other["slip_began"] == row["slip_began"] > 0]
        return next((self._simulation.checks[k] for k in (row["step"], *same) if k in self._simulation.checks), None)

    def draw(self) -> None:
        """Draw the run, on rank 0."""
        start = time.perf_counter()
        if self.rows and self.comm.rank == 0:
            assert self._simulation is not None
            size = None if self.scene.accuracy is None else self._simulation.scene.mesh.contact
            drawing.Drawing(
                self.folder, coefficient(self.scene), self.rows, self._profiles, self._ends, self._finer, size
            ).draw()
        self.seconds += time.perf_counter() - start

    def close(self, whole: bool = True) -> None:
        """Close every file.

        Args:
            whole: all ranks do so; else fields stay as they are, since closing them waits for all ranks.
        """
        self._progress.stop()
        if whole:
            self._close_files()
        elif self._fields is not None:
            self._fields.abandon()
        for handler in self.log.handlers:
            handler.close()

    def _close_files(self) -> None:
        if self._fields is not None:
            self._fields.close()
            self._fields = None
        for table in self._tables.values():
            table.close()


class _LogFile(logging.FileHandler):
    """A log that says so where it cannot be written, as tables do."""

    def handleError(self, record: logging.LogRecord) -> None:
        """Raise what went wrong."""
        raise  # noqa: PLE0704


def _send(log: logging.Logger, file: logging.Handler) -> None:
    """Write what was logged so far, and what is to come, into a file."""
    file.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    for memory in log.handlers:
        if isinstance(memory, logging.handlers.MemoryHandler):
            memory.setTarget(file)
            memory.flush()
    log.handlers = [file]


def _released(row: dict[str, Any]) -> str:
    """Return the energy that a jump released in words, or below what it is where its own error hides it."""
    value, error = row["energy_released"], row["released_error"]
    if abs(value) <= error:
        return f"energy released below {max(value, 0.0) + error:.2g} J/m"
    return f"{value:.2g} ± {error:.1g} J/m released"
