"""Whether a person watches the output, or a file takes it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fingerpad.results import terminal

ROOT = Path(__file__).resolve().parents[1]


class Screen:
    def __init__(self, terminal: bool) -> None:
        self.terminal = terminal

    def isatty(self) -> bool:
        return self.terminal


@pytest.fixture
def bare(monkeypatch):
    for name in (*terminal._RANKS, "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    return monkeypatch


@pytest.mark.parametrize(("name", "value"), [("NO_COLOR", "1"), ("TERM", "dumb"), ("PMIX_RANK", "1")])
def test_nobody_watches(bare, name, value):
    """Nor the ranks beside rank 0, whose output goes to the same terminal."""
    bare.setattr("os.readlink", lambda path: "/dev/pts/3")
    bare.setenv(name, value)
    assert not terminal.watched(Screen(True))


@pytest.mark.parametrize(("output", "watches"), [("/dev/pts/3", True), ("/tmp/log", False), ("pipe:[17]", False)])
def test_the_launchers_output_counts(bare, output, watches):
    """mpirun prints through a terminal of its own whatever its output goes to."""
    bare.setenv("OMPI_COMM_WORLD_RANK", "0")
    bare.setattr("os.readlink", lambda path: output)
    assert terminal.watched(Screen(True)) == watches


@pytest.mark.parametrize(
    "closed",
    [
        (0, 1, 2),
    ],
)
def test_closed_output_costs_nothing(tmp_path, closed):
    """After ``>&-``: the command does its work, and no file that it opens takes the number of the output."""
    code = "import os, sys; from fingerpad.__main__ import main; sys.argv[1:] = ['params', 'f_ext']; code = main()\n"
    code += f"open({str(tmp_path / 'found')!r}, 'w').write(f'{{code}} {{os.readlink(\"/proc/self/fd/1\")}}')"
    done = subprocess.run(
        [sys.executable, "-P", "-c", code],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        preexec_fn=lambda: [os.close(number) for number in closed],
    )
    assert (done.returncode, (tmp_path / "found").read_text()) == (0, "0 /dev/null")


@pytest.mark.parametrize("error", [BrokenPipeError(), SystemExit(1)])
def test_run_goes_on_where_nobody_reads(monkeypatch, error):
    """After ``| head``: the steps are in the folder of results; rich raises SystemExit, or nothing of its own."""
    from mpi4py import MPI

    from fingerpad.results.terminal import Console

    console, printed = Console(MPI.COMM_SELF, bar=False), []

    def broken(text, **options):
        printed.append(text)
        raise error

    monkeypatch.setattr(console._progress.console, "print", broken)
    for text in ("first", "second"):
        console.show(text)
    assert printed == ["first"]
