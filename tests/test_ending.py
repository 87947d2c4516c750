"""How a run ends that is killed, asked to stop, alone in trouble, or out of room: nothing written before is lost."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pytest
from mpi4py import MPI

from fingerpad.results.files import Table, replace_json
from fingerpad.results.interrupt import Interrupt, Interrupted
from tests.commands import python
from tests.measures import accepted

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[1]
GOOD = 2  # steps accepted before a run is disturbed
LONG = """# a light finger on a long way: its start is short, and there are a hundred steps to disturb it in
geometry.ridge_count = 9
mesh = {contact = 40e-6, receptor = 100e-6, interface = 200e-6, growth = 1.0, touching_half_arc = 1.0e-3}
output = {errors = false, receptors = false}
history = [{name = "press", f_ext = 1.0}, {name = "slide", bone_x = 5e-3}]
"""


# -- killed ------------------------------------------------------------------------------------------------
def start(folder: Path, ranks: int = 1) -> subprocess.Popen:
    """Start a run in a process of its own, or in more, and wait for its first steps.

    A pytest in the background has processes ignore SIGINT; here they do not.
    """
    scene = folder.with_name(f"{folder.name}.toml")
    scene.write_text(LONG, encoding="utf-8")
    command = ["env", "--default-signal", *(["mpirun", "-n", str(ranks)] if ranks > 1 else []), sys.executable]
    command += ["-m", "fingerpad", "run", str(scene), "--out", str(folder)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 300
    while len(accepted(folder)) < GOOD:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < until
        time.sleep(0.05)
    return process


def test_killed(tmp_path):
    """What was accepted before a kill is on disk, whole, and no summary pretends that the run ended."""
    with start(tmp_path) as process:
        process.kill()
        process.communicate()
    rows = accepted(tmp_path)
    assert len(rows) >= GOOD
    assert [int(row["step"]) for row in rows] == list(range(1, len(rows) + 1))
    assert not (tmp_path / "summary.json").exists()


@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.long)])
def test_asked_to_stop(tmp_path, number):
    """The run ends after the step it is at, names the signal, and leaves a summary."""
    with start(tmp_path) as process:
        process.send_signal(number)
        out, err = process.communicate(timeout=300)
    assert process.returncode == 128 + number
    assert f"stopped by {number.name} after step" in out
    assert "Traceback" not in err
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert number.name in summary["failure"]
    assert summary["interrupted"] == number.name  # a sweep runs it again
    assert len(accepted(tmp_path)) == summary["steps"] >= GOOD


def test_signals_that_mpirun_passes_on(tmp_path):
    """It kills its ranks a second after SIGINT; environment/run sends SIGUSR1 in its place."""
    with start(tmp_path, ranks=2) as process:
        process.send_signal(signal.SIGUSR1)
        out, err = process.communicate(timeout=300)
    assert process.returncode == 128 + signal.SIGINT
    assert "stopped by SIGINT after step" in out
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert summary["interrupted"] == "SIGINT" and summary["ranks"] == 2


def test_a_second_signal_acts_at_once(monkeypatch):
    clock, killed = [0.0], []
    monkeypatch.setattr("fingerpad.results.interrupt.time.monotonic", lambda: clock[0])
    monkeypatch.setattr("fingerpad.results.interrupt.os.kill", lambda *what: killed.append(what))
    with Interrupt(MPI.COMM_SELF) as interrupt:
        for clock[0], number in ((0.0, signal.SIGTERM), (0.1, signal.SIGHUP), (0.9, signal.SIGTERM)):
            signal.raise_signal(number)  # terminals, launchers and batch systems send more than one
        assert not killed
        clock[0] = 1.1
        signal.raise_signal(signal.SIGTERM)
        assert killed == [(os.getpid(), signal.SIGTERM)]
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
        with pytest.raises(Interrupted, match="stopped by SIGTERM after step 7"):
            interrupt.stop_if_asked(7)


def test_ignored_signals_stay_ignored():
    """A run under nohup outlives its terminal."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with Interrupt(MPI.COMM_SELF) as interrupt:
            signal.raise_signal(signal.SIGHUP)
            interrupt.stop_if_asked(1)
    finally:
        signal.signal(signal.SIGHUP, before)


# -- one rank ----------------------------------------------------------------------------------------------
RAISES = """
import sys
from pathlib import Path
from fingerpad.startup import MPI
from fingerpad.results.files import Table, replace_json
from fingerpad.results.interrupt import Interrupt, Interrupted
from tests.runs import run
from fingerpad.scene import load
from variational.solvers.continuation import Continuation
accept, steps = Continuation.accept, []  # of the half finger, and of the whole
def raising(self):
    accept(self)
    steps.append(1)
    if len(steps) == 4 and MPI.COMM_WORLD.rank == int(sys.argv[3]):
        raise ValueError("raised on one rank")
Continuation.accept = raising
run(load(Path(sys.argv[1])), Path(sys.argv[2]), MPI.COMM_WORLD)
"""


@pytest.mark.parametrize("rank", [pytest.param(0, marks=pytest.mark.long), 1])
def test_what_one_rank_raises_ends_all(tmp_path, rank):
    """The other one waits in a collective call."""
    (scene := tmp_path / "scene.toml").write_text(LONG, encoding="utf-8")
    done = python("-c", RAISES, scene, tmp_path / "out", rank, ranks=2)
    assert done.returncode == 1
    assert done.stderr.count("ValueError: raised on one rank") == 1
    assert (tmp_path / "out" / "steps.csv").exists() and not (tmp_path / "out" / "summary.json").exists()


# -- a full disk -------------------------------------------------------------------------------------------
def test_full_disk(tmp_path):
    """The first checkpoint finds no room; a limit of file sizes stands for the disk."""
    code = "import resource, runpy, sys\nimport fingerpad.startup\n"
    code += "resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))\n"
    code += "runpy.run_module('fingerpad', run_name='__main__')"
    (scene := tmp_path / "scene.toml").write_text(LONG, encoding="utf-8")
    done = python("-c", code, "run", scene, "--out", tmp_path / "out")
    assert done.returncode == 1
    said = done.stderr.strip()
    assert said.startswith("fingerpad: File too large: no more results can be written")
    assert "\n" not in said and len(said) < 300
    assert len(accepted(tmp_path / "out")) >= 1
    assert not (tmp_path / "out" / "summary.json").exists()


def test_no_room_for_a_row(tmp_path):
    """Rows that were written stay, whole, and none is in part."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    rows = [{"step": k, "load": "slide" * 10} for k in range(10)]
    table = Table(tmp_path / "steps.csv", rows[0])
    resource.setrlimit(resource.RLIMIT_FSIZE, (300, before[1]))
    try:
        with pytest.raises(OSError, match="File too large"):
            for row in rows:
                table.write(row)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        table.close()
    found = accepted(tmp_path)
    assert 3 < len(found) < 10
    assert found == [{name: str(value) for name, value in row.items()} for row in rows[: len(found)]]


def test_no_room_for_a_summary(tmp_path):
    """The one that was there stays."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    replace_json(tmp_path / "summary.json", {"old": 1})
    resource.setrlimit(resource.RLIMIT_FSIZE, (300, before[1]))
    try:
        with pytest.raises(OSError, match="File too large"):
            replace_json(tmp_path / "summary.json", {"new": "x" * 1000})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert json.loads((tmp_path / "summary.json").read_text()) == {"old": 1}
    assert [file.name for file in tmp_path.iterdir()] == ["summary.json"]


def test_numbers_that_json_lacks_are_null(tmp_path):
    """Other programs could not read them, and hours of a run are not lost by one: no rate of growth is inf."""
    data = {"lambda_min": float("inf"), "shares": [float("nan"), 1.0], "number": (2, None)}
    replace_json(tmp_path / "summary.json", data)
    text = (tmp_path / "summary.json").read_text()
    assert json.loads(text) == {"lambda_min": None, "shares": [None, 1.0], "number": [2, None]}


# -- Ctrl-C before, beside and after a run ---------------------------------------------------------------------------
START = """
import atexit, os, runpy, signal, sys
signal.signal(signal.SIGINT, signal.{handler})  # a pytest in the background has processes ignore it
def come():
    os.kill(os.getpid(), signal.SIGINT)
class Callback:
    def __del__(self):  # as importlib's own, where an exception is lost
        come()
class Finder:
    def find_spec(self, name, path, target=None):
        if name == {moment!r}:
            Callback()
sys.meta_path.insert(0, Finder())
if {moment!r} == "the end":
    atexit.register(come)
"""
SCRIPT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["scripts"]["fingerpad"]
DOORS = {
    "module": "runpy.run_module('fingerpad', run_name='__main__', alter_sys=True)",
    "script": "from {} import {} as main; sys.exit(main())".format(*SCRIPT.split(":")),
}


def interrupted(code: str, *words: object, moment: str = "", handler: str = "default_int_handler"):
    """Run code in a process that gets SIGINT at a moment: when a module is imported, or at the end."""
    return python("-c", START.format(moment=moment, handler=handler) + code, *words)


@pytest.mark.parametrize(
    ("door", "moment"), [("module", "numpy"), ("script", "fingerpad.cli.params"), ("script", "the end")]
)
def test_ctrl_c_ends_the_program_quietly(door, moment):
    done = interrupted(DOORS[door], "params", "f_ext", moment=moment)
    assert (done.returncode, done.stderr) == (130, "")
