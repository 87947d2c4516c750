"""Ctrl-C before, beside and after a run ends the program without a traceback; a library leaves signals alone."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
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


def python(code: str, *words: str, moment: str = "", handler: str = "default_int_handler"):
    """Run code in a process that gets SIGINT at a moment: when a module is imported, or at the end."""
    command = [sys.executable, "-c", START.format(moment=moment, handler=handler) + code, *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=100)


@pytest.mark.parametrize(
    ("door", "moment"), [("module", "numpy"), ("script", "fingerpad.cli.params"), ("script", "the end")]
)
def test_ctrl_c_ends_the_program_quietly(door, moment):
    done = python(DOORS[door], "params", "f_ext", moment=moment)
    assert (done.returncode, done.stderr) == (130, "")


@pytest.mark.slow
def test_ctrl_c_while_finite_elements_are_imported(tmp_path):
    """The run has not begun then."""
    done = python(DOORS["module"], "run", "--out", str(tmp_path / "new"), moment="dolfinx")
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")
    assert not (tmp_path / "new").exists()


@pytest.mark.slow
def test_ctrl_c_that_is_ignored_stays_ignored():
    done = python(DOORS["module"], "params", "f_ext", moment="numpy", handler="SIG_IGN")
    assert (done.returncode, done.stderr) == (0, "") and "f_ext" in done.stdout


def test_library_leaves_signals_alone():
    code = "import fingerpad, fingerpad.__main__, fingerpad.cli.run\n"
    code += "assert signal.getsignal(signal.SIGINT) is signal.default_int_handler"
    assert python(code).returncode == 0
