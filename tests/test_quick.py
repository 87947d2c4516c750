"""What `make check` runs touches the whole library."""

import subprocess
import sys
from pathlib import Path

from fingerpad.cli import _BESIDE, COMMANDS
from tests.conftest import LONGER

ROOT = Path(__file__).parents[1]
TESTS = [file.stem for file in sorted((ROOT / "tests").glob("test_*.py"))]
QUICK = [name for name in TESTS if name.removeprefix("test_") not in LONGER.split()]


def test_each_module_is_imported_by_a_quick_test():
    """In a process of its own: what the files of the quick tests import, and what that imports.

    The program imports a command where it is given, and what draws where a picture is asked for; test_command does.
    Reports, their pictures and processes of sweeps are of whole runs, which make check leaves out: test_report.
    """
    packages = ("geometry", "variational", "fingerpad")
    files = [file.relative_to(ROOT) for package in packages for file in (ROOT / package).rglob("*.py")]
    names = {".".join(file.with_suffix("").parts) for file in files if file.stem != "__main__"}
    imports = [
        *(f"tests.{name}" for name in QUICK),
        *(f"fingerpad.cli.{_BESIDE.get(name, name)}" for name in COMMANDS),
        *(
            "fingerpad.report.run_page",
            "fingerpad.report.sweep_page",
            "fingerpad.results.kept_drawing",
            "fingerpad.runs.one",
        ),
    ]
    code = "\n".join(["import sys", *(f"import {name}" for name in imports), "print(*sys.modules)"])
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert sorted({name.removesuffix(".__init__") for name in names} - set(done.stdout.split())) == []


def test_files_left_out_are_there():
    assert {f"test_{name}" for name in LONGER.split()} <= set(TESTS)
