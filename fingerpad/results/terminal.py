"""What a person at a terminal gets of a run: one line a step, a progress bar and the time that is left.

mpirun prints through a terminal of its own, whatever its output goes to: under a launcher, the output of the launcher
counts.
"""

import math
import os
import re
import sys
import time
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, TextIO

from fingerpad import launcher, notebook
from fingerpad.results.quantities import PER_LENGTH, QUANTITIES
from variational.state import ContactState, StepRecord

if TYPE_CHECKING:
    from mpi4py import MPI

_OnStep = Callable[[ContactState, float], None]
_TERMINAL = r"/dev/(pts/\d+|tty\w*|console)"
_LEGEND = (
    "f_ext: external force on the bone; U: voltage; bone x, bone y: its place; f_T: friction; µ_app = f_T / f_ext",
    "f_el: attraction; contact: sum of the lengths in contact; iter.: Newton iterations; fact.: factorisations",
    "path left: time left of the loads, by the pace so far",
    PER_LENGTH,
)
_HEADER = "step load     f_ext     U  bone x   bone y      f_T   µ_app    f_el ridges  contact  iter. fact.  path left"
_UNITS = "           (N/m)   (V)    (mm)     (mm)    (N/m)          (N/m)           (mm)"
_KNOWN = 0.1  # part done from which on the pace is known
_SPREAD, _SMALLEST_SPREAD = 2.0, 1.25  # factors either way of the time left, at the beginning and at the end
_SLIPPED = 0.9  # of a load that ends with full slip: done where friction is at its largest, before it is held
_LOAD_TOLERANCE = 1e-9  # of a load's end


def watched(stream: TextIO | None = None) -> bool:
    """Return whether a person watches a stream (standard output), to whom bars and colours may be shown."""
    stream = sys.stdout if stream is None else stream
    if launcher.rank() or os.environ.get("NO_COLOR") or os.environ.get("TERM", "dumb") == "dumb" or not stream.isatty():
        return False
    if not launcher.launched():
        return True
    try:
        return re.fullmatch(_TERMINAL, os.readlink(f"/proc/{os.getppid()}/fd/1")) is not None
    except OSError:
        return False


def in_words(*seconds: float) -> str:
    """Return a time (s), or a range of two, in the unit in which the longest one is read."""
    if seconds[-1] < 1.0:
        return "less than 1 s"
    size, unit = next(((s, u) for s, u in ((3600.0, "hours"), (60.0, "minutes")) if seconds[-1] >= 2 * s), (1.0, "s"))
    return f"{' to '.join(about(each / size) for each in seconds)} {unit}"


def about(value: float) -> str:
    """Return a number of two digits, as it is read."""
    rounded = float(f"{value:.2g}")
    return f"{rounded:,.0f}".replace(",", " ") if rounded >= 10 else f"{rounded:g}"


class Pace:
    """How far a run is along its loads, each of which counts the same."""

    def __init__(self, loads: int = 1, first: int = 0, clock: Callable[[], float] = time.monotonic) -> None:
        """Start.

        Args:
            loads: their number.
            first: load from which on the pace is counted, as of a waveform, whose steps take longer than those before.
            clock: returns the time (s).
        """
        self._loads, self._first, self._clock = loads, first, clock
        self._start = clock() if first == 0 else math.nan
        self.part = 0.0
        """Part of the loads that is done."""

    def at(self, done: float, slipped: float = 0.0) -> None:
        """Take the part of the loads that is done, and of a load that ends with full slip friction over its largest."""
        number = min(done, 1.0) * self._loads
        k = min(int(number + _LOAD_TOLERANCE), self._loads - 1)
        part = number - k
        if part > _LOAD_TOLERANCE:  # else the load before has just ended, perhaps with full slip
            part = max(part, min(slipped, _SLIPPED))
        self.part = (k + part) / self._loads
        if math.isnan(self._start) and number >= self._first - _LOAD_TOLERANCE:
            self._start = self._clock()

    def left(self) -> str:
        """Return the time left in words, as a range; that it is not known before a tenth is done."""
        before = self._first / self._loads
        done = (self.part - before) / (1 - before)
        if math.isnan(self._start) or done < _KNOWN:
            return "not known"
        seconds = (self._clock() - self._start) * (1 - done) / done
        spread = max(_SPREAD ** (1 - done), _SMALLEST_SPREAD)
        return in_words(seconds / spread, seconds * spread)


class Console:
    """Prints the lines of a run, or nothing but the progress bar, or nothing."""

    def __init__(self, comm: "MPI.Comm", lines: bool = True, bar: bool = True, on_step: _OnStep | None = None) -> None:
        """Start the progress bar, where a person watches: in a terminal, or in the cell of a notebook.

        Args:
            comm: communicator of the run.
            lines: whether to print lines.
            bar: whether to show the bar.
            on_step: called with each accepted state and the part of the run that is done, on every rank.
        """
        from rich.progress import BarColumn, Progress, TimeElapsedColumn  # not for those who only read

        self._lines, self._on_step = lines and comm.rank == 0, on_step
        self._cell = notebook.Bar() if bar and comm.rank == 0 and notebook.running() else None
        columns = BarColumn(), "{task.percentage:3.0f} %", TimeElapsedColumn(), "{task.fields[left]}"
        hidden = comm.rank != 0 or not (bar and watched())
        self._progress = Progress("{task.description}", *columns, disable=hidden, transient=True)
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
        """Start a path: its number of loads, those that end with full slip, µ_0, and ``first`` of :class:`Pace`."""
        self._pace, self._slipping, self._mu_0 = Pace(loads, first), slipping, mu_0

    def phase(self, text: str, part: float | None = None) -> None:
        """Show what is being done besides steps, in the bar or as a line, and the part of it that is done from 0 on."""
        if part == 0:
            self._pace = Pace()
        if part is not None:
            self._pace.at(part)
        left = "" if not part else f"time left: {self._pace.left()}"
        if self._progress.disable:
            self.show("; ".join(filter(None, (text, left))))
        self._update(text, left)

    def head(self) -> None:
        """Print legend and head of the table of steps."""
        for line in (*_LEGEND, _HEADER, _UNITS):
            self.show(line)

    def step(self, s: ContactState, done: float) -> None:
        """Print an accepted state, with the part of the whole history that is done."""
        work = "" if s.record is None else f"{s.record.newton_iterations:6d} {s.record.factorisations:5d}"
        most = self._mu_0 * s.f_contact if s.load in self._slipping else 0.0
        self._pace.at(done, abs(s.f_t) / most if most > 0 else 0.0)
        left, mu = self._pace.left(), QUANTITIES["mu_app"].shown(s.mu_app)
        self.show(
            f"{s.step:4d} {s.load[:7]:7s} {s.f_ext:7.3f} {s.voltage:z5.1f} {s.bone_x * 1e3:z7.4f} "
            f"{s.bone_height * 1e3:z8.5f} {s.f_t:z8.4f} {mu:>7s} {s.f_electrostatic:7.3f} "
            f"{s.ridges_in_contact:6d} {s.contact_length * 1e3:8.4f} {work:12s}  {left}"
            f"{_jump(s.record) if s.record else ''}"
        )
        loads = f"{s.load}: {s.f_ext:.1f} N/m, {s.voltage:.0f} V, x {s.bone_x * 1e3:.2f} mm"
        words = loads if math.isnan(s.mu_app) else f"{loads}, µ_app {s.mu_app:z.3f}"
        self._update(words, f"path left: {left}")
        if self._on_step is not None:
            self._on_step(s, self._pace.part)

    def _update(self, words: str, left: str) -> None:
        """Show in the bar what is being done, and the time left in words."""
        self._progress.update(self._task, completed=self._pace.part, description=words, left=left)
        if self._cell is not None:
            self._cell.update(self._pace.part, " ".join(filter(None, (words, left))))

    def close(self) -> None:
        """Take the progress bar away."""
        if self._cell is not None:
            self._cell.close()
        if not self._progress.disable:
            self._progress.stop()


def _jump(record: StepRecord) -> str:
    """Return the energy that a jump released in words, or below what it is where its own error hides it."""
    value, error = record.energy_released, record.released_error
    if not record.jump:
        return ""
    below = f"energy released below {max(value, 0.0) + error:.2g} J/m"
    return f"  jump, {below if abs(value) <= error else f'{value:.2g} ± {error:.1g} J/m released'}"
