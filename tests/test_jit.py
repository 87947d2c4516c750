"""The cache of compiled forms: several processes, killed and stopped ones, and compilers that fail."""

import os
import shutil
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest
from mpi4py import MPI

from fingerpad.launcher import COMPILER
from tests.one_form import integral
from variational import jit

ROOT = Path(__file__).resolve().parents[1]
UNFINISHED, WAITING = "did not finish; compiling again", "waiting for another process"
COMPILE = """#!/bin/sh
echo "$@" >> {folder}/called
while [ -e {folder}/hold ]; do sleep 0.05; done
exec {compiler} "$@"
"""


class Others:
    """Other processes with the same cache, whose compiler waits as long as there is a file."""

    def __init__(self, folder: Path) -> None:
        self.cache, self.hold, self.called = (folder / name for name in ("cache", "hold", "called"))
        self._compiler = folder / "compiler"
        real = os.environ.get("CC") or sysconfig.get_config_var("CC")
        self._compiler.write_text(COMPILE.format(folder=folder, compiler=real))
        self._compiler.chmod(0o755)
        self._folder, self._started = folder, list[subprocess.Popen]()
        self.hold.touch()

    def start(self) -> subprocess.Popen:
        """Start one; return when it compiles, or waits for one that does."""
        environment = os.environ | {"CC": str(self._compiler), "TMPDIR": str(self._folder), "PYTHONPATH": str(ROOT)}
        command = [sys.executable, str(ROOT / "tests" / "one_form.py"), str(self.cache)]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        other = subprocess.Popen(command, env=environment, text=True, **pipes)
        first = not self._started
        self._started.append(other)
        if first:
            while not self.called.exists():
                assert other.poll() is None, other.stderr.read()
                time.sleep(0.02)
        else:
            assert WAITING in other.stderr.readline()
        return other

    def end(self) -> None:
        """Let every compiler go on, and kill what is still there."""
        self.hold.unlink(missing_ok=True)
        for other in self._started:
            other.kill()
            other.communicate()


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache; waiting is told at once."""
    monkeypatch.setitem(jit.OPTIONS, "cache_dir", tmp_path / "cache")
    monkeypatch.setattr(jit, "_SILENT", 0.0)
    return tmp_path / "cache"


@pytest.fixture
def others(tmp_path, cache):
    others = Others(tmp_path)
    yield others
    others.end()


def test_killed_compile_is_made_again_at_once(others, capfd):
    """Nobody waits for it, though the compiler that the killed process started is still there."""
    other = others.start()
    other.kill()
    other.wait()
    assert integral() == 2.5
    words = capfd.readouterr().err
    assert UNFINISHED in words and WAITING not in words
    others.hold.unlink()
    assert integral() == 2.5 and capfd.readouterr().err == ""


@pytest.mark.slow
def test_two_processes_compile_a_form_once(others):
    """The second waits, says so, and takes what the first has compiled."""
    first, second = others.start(), others.start()
    calls = others.called.read_text()
    others.hold.unlink()
    for other in (first, second):
        printed, words = other.communicate()
        assert (printed, other.returncode) == ("2.5\n", 0) and UNFINISHED not in words
    assert others.called.read_text().count(" -c ") == calls.count(" -c ") == 1


@pytest.mark.parametrize(
    ("left", "compiled"),
    [
        ("source", True),
        ("source finished empty", True),
        ("source finished", True),
        ("finished", True),
        ("library finished", False),
    ],
)
def test_what_is_not_whole_is_compiled_again(cache, tmp_path, monkeypatch, capfd, left, compiled):
    """And what is whole is taken."""
    monkeypatch.setitem(jit.OPTIONS, "cache_dir", tmp_path / "good")
    integral()
    cache.mkdir()
    (good,) = (tmp_path / "good").glob("*.so")
    name = good.name.partition(".")[0]
    for kind in left.split():
        if kind == "library":
            shutil.copy(good, cache)
        else:
            (cache / {"source": f"{name}.c", "finished": f"{name}.c.cached", "empty": good.name}[kind]).touch()
    monkeypatch.setitem(jit.OPTIONS, "cache_dir", cache)
    assert integral() == 2.5
    assert (UNFINISHED in capfd.readouterr().err) is compiled
    assert (cache / f"{name}.c").exists() is compiled or "source" in left


def test_compiler_that_fails_is_one_sentence(cache, monkeypatch):
    """It names the cause; with a compiler that works the next compile succeeds."""
    monkeypatch.setenv("CC", "false")
    with pytest.raises(jit.CompileError, match="^a form cannot be compiled in .* kept in .*false'") as found:
        integral()
    assert found.value.name == COMPILER and "\n" not in str(found.value)
    monkeypatch.delenv("CC")
    assert integral() == 2.5


@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="a rank among others")
def test_failure_of_one_rank_is_all_ranks(monkeypatch):
    """None goes on and waits for it."""

    def fail(comm):
        if comm.rank == comm.size - 1:
            raise OSError("no room on its node")

    monkeypatch.setattr(jit, "_on_each_rank", fail)
    with pytest.raises(jit.CompileError, match="^no room on its node$"):
        jit._on_all_ranks(MPI.COMM_WORLD)
