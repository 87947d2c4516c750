"""The output of a run in a terminal: one line a step under a legend, and a progress bar; on rank 0."""

from mpi4py import MPI
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from fingerpad.io.quantities import PER_LENGTH
from fingerpad.io.terminal import watched
from variational.state import ContactState

_LEGEND = (
    "f_ext: external force on the bone; U: voltage; bone x, bone y: its place; f_T: friction; µ_app = f_T / f_ext",
    "f_el: attraction; contact: sum of the lengths in contact; iter.: Newton iterations; fact.: factorisations",
    PER_LENGTH,
)
_HEADER = "step load     f_ext     U  bone x   bone y      f_T   µ_app    f_el ridges  contact  iter. fact."
_UNITS = "           (N/m)   (V)    (mm)     (mm)    (N/m)          (N/m)           (mm)"


class Console:
    """Prints the lines of a run, or nothing but the progress bar."""

    def __init__(self, comm: MPI.Comm, lines: bool = True) -> None:
        """Start the progress bar.

        Args:
            comm: communicator of the run.
            lines: whether to print lines; a program of one's own prints its own.
        """
        self._lines = lines and comm.rank == 0
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:3.0f} %"),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            disable=comm.rank != 0,
            transient=True,
        )
        self._progress.disable |= not watched()
        self._task = self._progress.add_task("meshing the finger", total=1.0)
        if not self._progress.disable:
            self._progress.start()

    def show(self, text: str) -> None:
        """Print a line above the progress bar."""
        if self._lines:
            self._progress.console.print(text, highlight=False, soft_wrap=True, markup=False)

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
        self.show(
            f"{s.step:4d} {s.load[:7]:7s} {s.f_ext:7.3f} {s.voltage:5.1f} {s.bone_x * 1e3:7.4f} "
            f"{s.bone_height * 1e3:8.5f} {s.f_t:8.4f} {s.mu_app:7.4f} {s.f_electrostatic:7.3f} "
            f"{s.ridges_in_contact:6d} {s.contact_length * 1e3:8.4f} {s.record.newton_iterations:6d} "
            f"{s.record.factorisations:5d}{'  jump, ' + _released(s) if s.record.jump else ''}"
        )
        loads = f"{s.load}: {s.f_ext:.1f} N/m, {s.voltage:.0f} V, x {s.bone_x * 1e3:.2f} mm"
        self._progress.update(self._task, completed=done, description=f"{loads}, µ_app {s.mu_app:.3f}")

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
