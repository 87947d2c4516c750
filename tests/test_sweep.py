"""Sweeps: what names a run, what is run again, and what a run that is stopped costs."""

import contextlib
import fcntl
import json
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

import fingerpad as fp
from fingerpad.runs import batch as module
from fingerpad.runs import processes
from fingerpad.runs.batch import key, result, sweep
from fingerpad.runs.processes import End
from fingerpad.runs.processes import run as run_module
from fingerpad.scene import Scene, from_data
from tests.small_finger import NINE, small


@pytest.fixture
def started(monkeypatch):
    """Arguments of the runs that were started; each leaves a summary with the force of its scene."""
    runs = []

    def run(name, arguments, limit, folders):
        runs.append(arguments)
        scene = json.loads(Path(arguments[0]).read_text(encoding="utf-8"))
        if scene["f_ext"] == 666:
            return End(-11, "CRASH_-11", "segmentation fault", "")
        Path(arguments[1], "summary.json").write_text(json.dumps({"f_ext": scene["f_ext"]}), encoding="utf-8")
        return End(0, "", "", "")

    monkeypatch.setattr(module, "run", run)
    return runs


def scenes(*forces):
    return {f"{force} N/m": from_data({"f_ext": force}) for force in forces}


def test_key_follows_every_parameter():
    keys = {key(from_data(data)) for data in ({}, {"voltage": 100}, {"mesh": {"contact": 2e-5}}, {"friction": 0.3})}
    assert len(keys) == 4
    assert key(from_data({})) == key(from_data({"voltage": 200.0}))


def test_only_what_is_new_is_run(started, tmp_path):
    sweep(scenes(10, 20), tmp_path)
    summaries = sweep(scenes(10, 20, 30), tmp_path)
    assert len(started) == 3
    assert {name: s["f_ext"] for name, s in summaries.items()} == {"10 N/m": 10, "20 N/m": 20, "30 N/m": 30}


def test_crash_is_told_and_tried_again(started, tmp_path):
    for _ in range(2):
        assert sweep(scenes(666), tmp_path)["666 N/m"] == {"failure": "CRASH_-11: segmentation fault"}
    assert len(started) == 2


def test_point_whose_files_are_not_whole_fails_alone(started, tmp_path):
    found = fp.sweep(Scene(), tmp_path, quiet=True, f_ext=[10, 666])
    assert [r.failure.partition(":")[0] for r in found.results][1] == "CRASH_-11"
    assert "is not a folder of a finished run" in found.results[0].failure


@pytest.mark.slow
def test_run_that_was_refused_its_folder_is_tried_again(tmp_path):
    """A run of a killed sweep may still be at it; when that is gone the scene is run."""
    scene = small().replace(mesh={"contact": 40e-6}, output={"receptors": False, "errors": False, "each_load": False})
    place = tmp_path / key(scene)
    place.mkdir()
    with (place / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert sweep({"one": scene}, tmp_path, quiet=True)["one"]["failure"].startswith("another run is writing to")
    assert result(scene, tmp_path) is None
    assert sweep({"one": scene}, tmp_path, quiet=True)["one"]["full_slip"]


@pytest.mark.parametrize("content", [b'{"f_ext": 1', b"\xff\xfe"])
def test_damaged_summary_is_no_result(started, tmp_path, content):
    scene = from_data({"f_ext": 10})
    (tmp_path / key(scene)).mkdir()
    (tmp_path / key(scene) / "summary.json").write_bytes(content)
    assert result(scene, tmp_path) is None


@pytest.mark.parametrize(
    "stopped",
    [
        {"f_ext": 10, "failure": "stopped by SIGTERM", "interrupted": True},
        {"f_ext": 10, "failure": "step 1 (touch) found no equilibrium: MUMPS_OUT_OF_MEMORY (INFOG(1) = -19)"},
    ],
    ids=["stopped", "out of memory"],
)
def test_run_that_another_machine_may_end_is_no_result(started, tmp_path, stopped):
    """Its summary is for whoever stopped it; the sweep runs the scene again."""
    scene = from_data({"f_ext": 10})
    (tmp_path / key(scene)).mkdir()
    (tmp_path / key(scene) / "summary.json").write_text(json.dumps(stopped))
    assert sweep(scenes(10), tmp_path)["10 N/m"] == {"f_ext": 10}
    assert len(started) == 1


def test_two_sweeps_in_one_folder_run_a_scene_once(started, monkeypatch, tmp_path):
    """The second waits for the first and takes its result; without the lock both would start it."""
    fake, inside = module.run, threading.Barrier(2)

    def slow(*arguments):
        with contextlib.suppress(threading.BrokenBarrierError):
            inside.wait(0.5)  # s; two runs at a time meet here
        return fake(*arguments)

    monkeypatch.setattr(module, "run", slow)
    with ThreadPoolExecutor(2) as pool:
        found = list(pool.map(lambda _: sweep(scenes(10), tmp_path), range(2)))
    assert len(started) == 1
    assert found == [{"10 N/m": {"f_ext": 10}}] * 2


def test_run_out_of_time_is_named(tmp_path):
    """A second of processor time is not enough to mesh the default finger and compile its forms."""
    summary = sweep({"slow": from_data({})}, tmp_path, limit=1.0)["slow"]
    assert summary == {"failure": "TIME_LIMIT: not done after 1 s of processor time"}


JOB = """
import os, time
from pathlib import Path
from fingerpad.runs.processes import limit_processor_time
limit_processor_time(100)
Path("pid").write_text(str(os.getpid()))
time.sleep(100)
"""


def until(done):
    end = time.monotonic() + 60
    while not done():
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.mark.slow
def test_executor_whose_worker_is_killed(tmp_path):
    """Points of lost workers fail with that reason; the same sweep computes them by the workers of another executor."""
    scene = from_data(NINE | {"f_ext": 1.0, "output": {"receptors": False, "errors": False, "each_load": False}})
    axes, workers = {"voltage": [0.0, 60.0]}, lambda: ProcessPoolExecutor(2, get_context("spawn"))

    def kill():
        until(lambda: any(tmp_path.glob("full/*/scene.json")))
        os.kill(next(iter(pool._processes)), signal.SIGKILL)

    with workers() as pool:
        threading.Thread(target=kill).start()
        first = fp.sweep(scene, tmp_path, quiet=True, executor=pool, **axes)
    assert any(r.failure.startswith("LOST: BrokenProcessPool") for r in first.results)
    with workers() as pool:
        found = fp.sweep(scene, tmp_path, quiet=True, executor=pool, **axes)
    assert [r.failure for r in found.results] == [""] * 2 and (found.array("f_t")[1:] > found.array("f_t")[:-1]).all()
    with pytest.raises(fp.SceneError, match="executor is 3; it must be one of concurrent.futures"):
        fp.sweep(scene, tmp_path, executor=3, **axes)


def test_program_that_is_killed_leaves_no_job(tmp_path):
    """Its job gets SIGTERM from the system, and is gone at once; it sleeps for longer than the test waits."""
    (tmp_path / "job.py").write_text(JOB, encoding="utf-8")
    code = "from fingerpad.runs.processes import run; run('job', [], 100.0)"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), str(tmp_path)])}

    with subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path, env=environment) as program:
        until(lambda: (tmp_path / "pid").exists() and (tmp_path / "pid").read_text())
        program.kill()
    job = Path("/proc", (tmp_path / "pid").read_text(), "stat")
    until(lambda: not job.exists() or job.read_text().rpartition(") ")[2].startswith("Z"))


@pytest.fixture
def waits(monkeypatch):
    """An event: a pool has begun its jobs and waits for them."""
    event, plain = threading.Event(), processes.wait

    def wait(*args, **more):
        event.set()
        return plain(*args, **more)

    monkeypatch.setattr(processes, "wait", wait)
    return event


@pytest.mark.parametrize(("number", "error"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, SystemExit)])
def test_signal_stops_the_jobs_too(capsys, waits, number, error):
    """Else they would go on without the program, or keep it."""
    ends = []

    def job():
        ends.append(run_module("timeit", ["-n1", "-r1", "__import__('time').sleep(100)"], 100.0))
        return ends[-1]

    def send():
        assert waits.wait(60.0)
        while len(processes._RUNNING) < 2:
            time.sleep(0.01)
        signal.pthread_kill(threading.main_thread().ident, number)  # another thread would not wake it

    usual = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
    before = signal.signal(number, usual)  # a caller in the background may ignore it
    try:
        threading.Thread(target=send).start()
        with pytest.raises(error) as stopped:
            processes.finish(dict.fromkeys(range(3), job), lambda *end: None, jobs=2)
        assert signal.getsignal(number) == usual
    finally:
        signal.signal(number, before)
    assert [end.code for end in ends] == [-signal.SIGTERM] * 2
    assert number == signal.SIGINT or stopped.value.code == 128 + number
    assert capsys.readouterr().err == "fingerpad: running points that stop after their present step: 2\n"


def test_jobs_are_no_ranks_of_a_launcher(monkeypatch):
    """Else MPI would take each for the rank of the sweep itself, as in a batch system's job."""
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    monkeypatch.setenv("PMIX_RANK", "1")
    code = "import os; print([name for name in os.environ if name.startswith(('OMPI_COMM', 'PMIX'))])"
    assert run_module("timeit", ["-n1", "-r1", code], 10.0).stdout.startswith("[]\n")
