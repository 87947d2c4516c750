"""How far a run is and what time is left of it, in a terminal, in a file, and in quiet."""

import pytest
from mpi4py import MPI

from fingerpad import launcher
from fingerpad.cli import main
from fingerpad.results import terminal
from fingerpad.results.terminal import Console, Pace
from fingerpad.runs.batch import times_left

PRESS = '[[history]]\nname = "press"\nbone_height = -50e-6\n\n[output]\nerrors = false\nreceptors = false\n'
MESH = "\n[mesh]\ncontact = 40e-6\nreceptor = 80e-6\ninterface = 150e-6\ngrowth = 0.8\n"


# -- time left -----------------------------------------------------------------------------------------
def after(seconds, done, **more):
    """Return the time left (words) where a part is done after a time (s)."""
    times = iter([0.0, seconds])
    pace = Pace(clock=lambda: next(times), **more)
    pace.at(done)
    return pace.left()


def test_load_that_ends_with_full_slip_is_as_far_as_its_friction():
    """Not as far as its way, of which it needs a part alone."""
    pace = Pace(2)
    pace.at(0.5 + 0.1 / 2, slipped=0.75)
    assert pace.part == pytest.approx(0.5 + 0.75 / 2)


def test_time_left_is_not_known_before_a_waveform_has_its_pace():
    """It begins after 10 s; a fifth of it takes 8.8 s, so that 35.2 s are left."""
    now = [0.0]
    pace = Pace(2, first=1, clock=lambda: now[0])
    for done, seconds in ((0.25, 5.0), (0.5, 10.0), (0.54, 13.2)):
        now[0] = seconds
        pace.at(done)
        assert pace.left() == "not known"
    now[0] = 10.0 + 8.8
    pace.at(0.5 + 0.2 / 2)
    low, _, high, unit = pace.left().split()
    assert unit == "s" and float(low) < 35.2 < float(high) < 2 * 35.2


def test_time_left_of_a_sweep_is_by_its_runs():
    """Six runs left, two at a time: from two rounds and a half of the shortest to three of the longest."""
    assert times_left([10.0, 30.0], 6, 2) == (25.0, 90.0)
    assert times_left([10.0], 1, 2) == (5.0, 12.5)


# -- console -------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_run_in_quiet_prints_the_result_alone(tmp_path, write, capsys):
    """No step, no phase; the result as a table, once."""
    assert main(["run", str(write(PRESS + MESH)), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    said = capsys.readouterr().out
    assert said.count("ridges in contact") == 1
    assert not any(words in said for words in ("path left", "meshing the finger", "Report: "))


# -- whether a person watches the output -----------------------------------------------------------------------------


class Screen:
    def __init__(self, terminal: bool) -> None:
        self.terminal = terminal

    def isatty(self) -> bool:
        return self.terminal


@pytest.fixture
def bare(monkeypatch):
    for name in (*launcher.RANKS, "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    return monkeypatch


@pytest.mark.parametrize(("output", "watches"), [("/dev/pts/3", True), ("/tmp/log", False), ("pipe:[17]", False)])
def test_the_launchers_output_counts(bare, output, watches):
    """mpirun prints through a terminal of its own whatever its output goes to."""
    bare.setenv("OMPI_COMM_WORLD_RANK", "0")
    bare.setattr("os.readlink", lambda path: output)
    assert terminal.watched(Screen(True)) == watches


@pytest.mark.parametrize("error", [BrokenPipeError(), SystemExit(1)])
def test_run_goes_on_where_nobody_reads(monkeypatch, error):
    """After ``| head``: the steps are in the folder of results; rich raises SystemExit, or nothing of its own."""

    console, printed = Console(MPI.COMM_SELF, bar=False), []

    def broken(text, **options):
        printed.append(text)
        raise error

    monkeypatch.setattr(console._progress.console, "print", broken)
    for text in ("first", "second"):
        console.show(text)
    assert printed == ["first"]
