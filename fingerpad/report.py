"""What a run leaves: printed steps, tables, fields, summary, log and a progress bar; rank 0 alone writes text."""

import json
import logging
import logging.handlers
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from fingerpad import mirror, pictures
from fingerpad.files import Table, replace_json
from fingerpad.place import Place
from fingerpad.provenance import provenance
from fingerpad.scene import Scene
from fingerpad.simulation import Simulation, Step
from fingerpad.zone import Woken
from variational.output import Fields, Snapshot, gather_mesh
from variational.receptors import Receptors
from variational.timing import memory_mb

_NAMED = ("f_t", "mu_app", "f_electrostatic", "f_contact", "bone_height", "ridges_in_contact", "contact_length")
_STATES = ("normal", "partial", "slip")  # as surface.npz calls them
_STILL = 1e-12  # m, below which the bone has not moved sideways
_PROFILE = ("x", "y", "p_n", "t_t", "p_el", "area_x", "area_y")
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
        self._profiles: list[dict[str, Any]] = []
        self._kept: dict[str, tuple[Snapshot | None, Any]] = {}
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
        profiles = simulation.profiles
        sites = np.concatenate([profiles.merkel_sites(), profiles.meissner_sites()])
        if not simulation.plan.both_halves:  # where their mirror images are
            sites[:, 0] = np.abs(sites[:, 0])
        self._sites = Receptors(simulation.problem, sites) if simulation.plan.receptors else None
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
        for kept in (self.rows, self._profiles, self._kept, self._tables):
            kept.clear()
        self._written = self._checks = 0
        self._begun = time.perf_counter()

    # -- steps -----------------------------------------------------------------------------------------
    def step(self, step: Step, done: float) -> None:
        """Report an accepted step; collective."""
        start = time.perf_counter()
        assert self._simulation is not None
        self._take()
        row = step.row | {"processor_seconds": self._processor_seconds()}
        self.rows.append(row)
        surface = self._simulation.problem.surface
        stacked = np.stack([getattr(step.surface, name) for name in _PROFILE])
        gathered, ridge = surface.gather(stacked), surface.gather(surface.ridge[None, :, None].astype(float))
        sed = self._sites.sed() if self._sites else None
        if self.comm.rank == 0:
            assert gathered is not None and ridge is not None
            values, where = gathered, ridge[0, :, 0].astype(int)
            if not self._simulation.plan.both_halves:
                values, where = mirror.profile(_PROFILE, gathered, where)
            self._profiles.append({"ridge": where, "values": values, "d_eq": step.d_eq, "row": row})
            self._table("steps", row)
            for k, j in enumerate(self._names):
                if step.ridges.length[k] > 0:
                    self._table("ridges", self._ridge_row(step, k, j))
            for ridge_row in self._receptor_rows(step.row["step"], sed) if sed is not None else ():
                self._table("receptors", ridge_row)
            for sweep, change in enumerate(step.attempt.changes):
                self._table("coupling", {"step": step.row["step"], "sweep": sweep + 1, "change": change})
            self._print(step, done)
        self.seconds += time.perf_counter() - start

    def _processor_seconds(self) -> float:
        """Return the processor time (s) of all ranks since the start; collective."""
        return float(self.comm.allreduce(time.process_time() - self._processor))

    def _print(self, step: Step, done: float) -> None:
        r = step.row
        released = f"  jump, {r['energy_released']:.2g} J/m released"
        self.say(
            f"{r['step']:4d} {r['load'][:7]:7s} {r['f_ext']:7.3f} {r['voltage']:5.1f} {r['bone_x'] * 1e3:7.4f} "
            f"{r['bone_height'] * 1e3:8.5f} {r['f_t']:8.4f} {r['mu_app']:7.4f} {r['f_electrostatic']:7.3f} "
            f"{r['ridges_in_contact']:6d} {r['contact_length'] * 1e3:8.4f} {r['newton_iterations']:6d} "
            f"{r['factorisations']:5d}{released if r['jump'] else ''}"
        )
        self.log.info("step %s sweeps %s", json.dumps(r), step.attempt.changes)
        for cut in step.attempt.cutbacks:
            self.log.warning("step %d cut: %s", r["step"], cut)
        notes = [f"ridge {j} {s}" for j, s in zip(self._names, step.states, strict=True) if s]
        if notes:
            self.log.warning("step %d closure: %s", r["step"], ", ".join(notes))
        loads = f"{r['load']}: {r['f_ext']:.1f} N/m, {r['voltage']:.0f} V, x {r['bone_x'] * 1e3:.2f} mm"
        self._progress.update(self._task, completed=done, description=f"{loads}, µ {r['mu_app']:.3f}")

    @property
    def _names(self) -> list[int]:
        assert self._simulation is not None
        return self._simulation.ridges

    def _ridge_row(self, step: Step, k: int, j: int) -> dict[str, Any]:
        values = step.ridges
        return {
            "step": step.row["step"],
            "ridge": j,
            "contact_length": values.length[k],
            "f_contact": values.f_contact[k],
            "f_friction": values.f_friction[k],
            "f_electrostatic": values.f_attraction[k],
            "p_c": values.p_c[k],
            "d_eq": step.d_eq[k],
            "state": step.states[k],
        }

    def _receptor_rows(self, step: int, sed: NDArray[np.float64]) -> Iterator[dict[str, Any]]:
        assert self._simulation is not None
        names = self._simulation.profiles.ridges
        merkel, meissner = sed[: len(names)], sed[len(names) :].reshape(-1, 2)
        for j, at_tip, (left, right) in zip(names, merkel, meissner, strict=True):
            yield {"step": step, "ridge": j, "merkel_sed": at_tip, "meissner_left": left, "meissner_right": right}

    def _table(self, name: str, row: dict[str, Any]) -> None:
        if name not in self._tables:
            self._tables[name] = Table(self.folder / f"{name}.csv", row)
        self._tables[name].write(row)

    def load_reached(self) -> None:
        """Write the present state for ParaView and keep it for the pictures; collective."""
        start = time.perf_counter()
        if self.rows and self._written != self.rows[-1]["step"]:
            assert self._simulation is not None and self._fields is not None
            self._written = self.rows[-1]["step"]
            self._fields.write(float(self._written))
            self._log_checks()
            self._kept[self.rows[-1]["load"]] = self._picture()
        self.seconds += time.perf_counter() - start

    def _picture(self) -> tuple[Snapshot | None, Any]:
        """Return the present state of the whole finger, and where the Merkel sites are if they are wanted."""
        assert self._simulation is not None
        snapshot, ridges = gather_mesh(self._simulation.problem), np.array(self._simulation.profiles.ridges)
        merkel = self._sites.positions()[: len(ridges)] if self._sites else None
        if not self._simulation.plan.both_halves:
            snapshot = mirror.snapshot(snapshot) if snapshot else None
            if merkel is not None:
                merkel[ridges < 0, 0] *= -1
        return snapshot, merkel

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
            "full_slip": self._simulation.full_slip,
            "newton_iterations": solver.counts.newton,
            "factorisations": solver.counts.factorisations,
            "unknowns": self._simulation.unknowns,
            "wall_seconds": time.perf_counter() - self._start,
            "processor_seconds": self._processor_seconds(),
            "steps": len(rows),
            "jumps": sum(row["jump"] for row in rows),
            "cutbacks": sum(row["cutbacks"] for row in rows),
            "penetration": max((row["penetration"] for row in rows), default=0.0),
            "imbalance": max((row["imbalance"] for row in rows), default=0.0),
            "energy_released": sum(row["energy_released"] for row in rows if row["jump"]),
            "dissipation": sum(row["dissipation"] for row in rows),
            "memory_mb": peak,
            "ranks": self.comm.size,
            **{f"seconds_{phase}": value for phase, value in seconds.items()},
        }
        normal, slip = self._named_rows()
        for prefix, row in (("normal", normal), ("slip", slip)):
            result |= {f"{prefix}_{name}": None if row is None else row[name] for name in _NAMED}
            check = None if row is None else self._simulation.checks.get(row["step"])
            result[f"{prefix}_stable"] = None if check is None else check.stable
            result[f"{prefix}_lambda_min"] = None if check is None else check.frozen.lambda_min
            result[f"{prefix}_gain"] = None if check is None else check.gain
        result |= ended | {"omitted": self._simulation.plan.table(), "woken": self._woken}
        result["provenance"] = provenance()
        result["parameters"] = self.scene.parameters()
        if self.comm.rank == 0:
            replace_json(self.folder / "summary.json", result)
        return result

    def _named_rows(self) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
        """Return the rows of normal contact (the last before the bone first moves) and of full slip."""
        still = [row for row in self.rows if abs(row["bone_x"]) < _STILL]
        full = [row for row in self.rows if row["all_slip"]] if self._simulation and self._simulation.full_slip else []
        return (still[-1] if still else None), (full[0] if full else None)

    def draw(self) -> None:
        """Draw the run, on rank 0."""
        start = time.perf_counter()
        if self.rows and self.comm.rank == 0:
            self._draw()
        self.seconds += time.perf_counter() - start

    def _draw(self) -> None:
        normal, slip = self._named_rows()
        mu_0 = self.scene.friction
        for load, (snapshot, sites) in self._kept.items():
            if snapshot is None:
                continue
            row = [row for row in self.rows if row["load"] == load][-1]
            title = f"After {load}: {pictures.conditions(row['f_ext'], row['voltage'], mu_0)}"
            name = load.replace(" ", "_")
            shown = {} if sites is None else {"merkel": sites}
            np.savez_compressed(self.folder / f"finger_{name}.npz", **shown, **vars(snapshot))
            pictures.finger(self.folder / f"finger_{name}.png", snapshot, sites, title)
        sliding = [row for row in self.rows if abs(row["bone_x"]) >= _STILL]
        if normal is None or not sliding:
            return
        end = slip or sliding[-1]
        partial = min(sliding, key=lambda row: abs(row["slipping"] - 0.5))
        named = {"Normal contact": normal, "Partial slip": partial, "Full slip" if slip else "Last state": end}
        states = [self._profile(name, row) for name, row in named.items()]
        conditions = pictures.conditions(end["f_ext"], end["voltage"], mu_0)
        arrays: dict[str, Any] = {f"{name}_{field}": value for name, state in zip(_STATES, states, strict=True)
                  for field, value in vars(state).items() if isinstance(value, np.ndarray)}  # fmt: skip
        np.savez_compressed(self.folder / "surface.npz", **arrays)
        pictures.surface(self.folder / "surface.png", states, conditions)
        pictures.history(self.folder / "history.png", self.rows, conditions, mu_0)

    def _profile(self, title: str, row: dict[str, Any]) -> pictures.SurfaceProfile:
        kept = next(k for k in self._profiles if k["row"] is row)
        x, y, p_n, t_t, p_el, area_x, area_y = kept["values"]
        ridge, d_eq = kept["ridge"], kept["d_eq"]
        stretch = np.hypot(area_x, area_y)
        columns: list[list[Any]] = [[] for _ in range(6)]
        for k in np.unique(ridge):
            mine = ridge == k
            order = np.argsort(x[mine], axis=None)
            parts = (x, y, p_n / stretch, t_t / stretch, p_el, np.broadcast_to(d_eq[ridge][:, None], x.shape))
            for column, part in zip(columns, parts, strict=True):
                column += [part[mine].ravel()[order], [np.nan]]
        arrays = [np.concatenate(column) for column in columns]
        x, y, p, t, p_el, gap = arrays
        return pictures.SurfaceProfile(title, x, y, p, t, p_el, gap, row["f_ext"], row["contact_length"])

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
