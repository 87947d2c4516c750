"""The output of a run in a terminal: one line a step under a legend, and a progress bar; on rank 0."""

import math
from collections.abc import Collection

from mpi4py import MPI
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from fingerpad.results.pace import Pace
from fingerpad.results.quantities import PER_LENGTH, cell
from fingerpad.results.terminal import watched
from variational.state import ContactState

_LEGEND = (
    "f_ext: external force on the bone; U: voltage; bone x, bone y: its place; f_T: friction; µ_app = f_T / f_ext",
    "f_el: attraction; contact: sum of the lengths in contact; iter.: Newton iterations; fact.: factorisations",
    "path left: time left of the loads, by the pace so far",
    PER_LENGTH,
)
_HEADER = "step load     f_ext     U  bone x   bone y      f_T   µ_app    f_el ridges  contact  iter. fact.  path left"
_UNITS = "           (N/m)   (V)    (mm)     (mm)    (N/m)          (N/m)           (mm)"


class Console:
    """Prints the lines of a run, or nothing but the progress bar, or nothing."""

    def __init__(self, comm: MPI.Comm, lines: bool = True, bar: bool = True) -> None:
        """Start the progress bar, where a person watches.

        Args:
            comm: communicator of the run.
            lines: whether to print lines; a program of one's own prints its own.
            bar: whether to show the bar.
        """
        self._lines = lines and comm.rank == 0
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:3.0f} %"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[left]}"),
            disable=comm.rank != 0,
            transient=True,
        )
        self._progress.disable |= not (bar and watched())
        self._task = self._progress.add_task("starting", total=1.0, left="")
        self.expect(1)
        if not self._progress.disable:
            self._progress.start()

    def show(self, text: str) -> None:
        """Print a line above the progress bar; the run goes on where nobody reads any more, as after ``| head``."""
        if self._lines:
            try:
                self._progress.console.print(text, highlight=False, soft_wrap=True, markup=False)
            except (BrokenPipeError, SystemExit):  # the latter is rich's
                self._lines = False

    def expect(self, loads: int, slipping: Collection[str] = (), mu_0: float = 0.0, first: int = 0) -> None:
        """Take what a path that starts now is made of.

        Args:
            loads: number of its loads.
            slipping: names of the loads that end with full slip.
            mu_0: friction coefficient.
            first: number of the load from which on its pace counts, see :class:`fingerpad.results.pace.Pace`.
        """
        self._pace, self._slipping, self._mu_0 = Pace(loads, first), slipping, mu_0

    def phase(self, text: str, part: float | None = None) -> None:
        """Show what is being done besides steps: in the bar, or as a line where there is none.

        Args:
            text: what is being done.
            part: of it that is done; 0 where it begins. Without it, the time left is not known.
        """
        if part == 0:
            self._pace = Pace()
        if part is not None:
            self._pace.at(part)
        left = "" if not part else f"time left: {self._pace.left()}"
        if self._progress.disable:
            self.show("; ".join(filter(None, (text, left))))
        self._progress.update(self._task, completed=self._pace.part, description=text, left=left)

    def head(self) -> None:
        """Print legend and head of the table of steps."""
        for line in (*_LEGEND, _HEADER, _UNITS):
            self.show(line)

    def step(self, s: ContactState, done: float) -> None:
        """Print an accepted state.

        Args:
            s: the state, with its record.
            done: part of the whole history that is done.
        """
        assert s.record is not None
        most = self._mu_0 * s.f_contact if s.load in self._slipping else 0.0
        self._pace.at(done, abs(s.f_t) / most if most > 0 else 0.0)
        left, mu = self._pace.left(), cell("mu_app", s.mu_app)
        self.show(
            f"{s.step:4d} {s.load[:7]:7s} {s.f_ext:7.3f} {s.voltage:z5.1f} {s.bone_x * 1e3:z7.4f} "
            f"{s.bone_height * 1e3:z8.5f} {s.f_t:z8.4f} {mu:>7s} {s.f_electrostatic:7.3f} "
            f"{s.ridges_in_contact:6d} {s.contact_length * 1e3:8.4f} {s.record.newton_iterations:6d} "
            f"{s.record.factorisations:5d}  {left}{'  jump, ' + _released(s) if s.record.jump else ''}"
        )
        loads = f"{s.load}: {s.f_ext:.1f} N/m, {s.voltage:.0f} V, x {s.bone_x * 1e3:.2f} mm"
        words = loads if math.isnan(s.mu_app) else f"{loads}, µ_app {s.mu_app:z.3f}"
        self._progress.update(self._task, completed=self._pace.part, description=words, left=f"path left: {left}")

    def close(self) -> None:
        """Take the progress bar away."""
        if not self._progress.disable:
            self._progress.stop()


def _released(s: ContactState) -> str:
    """Return the energy that a jump released in words, or below what it is where its own error hides it."""
    assert s.record is not None
    value, error = s.record.energy_released, s.record.released_error
    if abs(value) <= error:
        return f"energy released below {max(value, 0.0) + error:.2g} J/m"
    return f"{value:.2g} ± {error:.1g} J/m released"
