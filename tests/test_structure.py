"""The structure of the product that CONTRIBUTING promises: no import circle, no long module, few levels."""

import re
from pathlib import Path

import pytest

from benchmarks import structure
from fingerpad.cli import _BESIDE, COMMANDS
from tests.commands import python

FILES = {name: path for folder in structure.PRODUCT for name, path in structure.modules(folder).items()}


def test_no_import_circle():
    """Counting the imports inside functions and for type checkers, too."""
    assert [group for group in structure.circles(structure.imports(FILES)) if len(group) > 1] == []


def test_no_module_is_long():
    """A module is one idea; past 350 lines it is two."""
    assert [name for name, path in FILES.items() if structure.lines(path) > structure.LONGEST] == []


@pytest.mark.parametrize(
    ("count", "most"),
    [
        (lambda: sum(map(structure.lines, FILES.values())), 42_400),
        (lambda: sum(map(structure.code, FILES.values())), 26_300),
        (lambda: len(FILES), 235),
        (lambda: max(structure.levels(structure.imports(FILES)).values()), 23),
        (lambda: structure.for_checkers(FILES), 40),
        (lambda: len(structure.passed(FILES)), 38),
        (lambda: sum(returns for _, returns in structure.passed(FILES).values()), 35),
        (lambda: len(structure.lists_of_quantities(FILES)), 19),
        (lambda: len(structure.tests_of_laws(FILES)), 0),
        (lambda: sum(len(structure.public(path)) for path in FILES.values()), 904),
        (lambda: structure.longest(FILES)[0], 100),
        (lambda: sum(map(structure.lines, structure.modules("tests").values())), 25_120),
        (lambda: sum(map(structure.lines, structure.modules("benchmarks").values())), 12_110),
        (lambda: structure.words()[1], 45_000),
    ],
    ids="lines code modules levels typed scene returns lists laws public longest tests benchmarks words".split(),
)
def test_size(count, most):
    """What a reader has to follow does not grow: a new feature makes something needless."""
    assert count() <= most


@pytest.mark.parametrize(
    ("graph", "circles", "height"),
    [({"a": set(), "b": {"a"}, "c": {"b"}}, [], 3), ({"a": {"b"}, "b": {"a"}, "c": {"b"}}, [["a", "b"]], 2)],
)
def test_levels_and_circles_of_a_graph(graph, circles, height):
    """The modules of a circle have one level."""
    assert [group for group in structure.circles(graph) if len(group) > 1] == circles
    assert max(structure.levels(graph).values()) == height


# -- what make check runs --------------------------------------------------------------------------------------------
ROOT = Path(__file__).parents[1]
SLOW = re.compile(r"^pytestmark = .*\bslow\b", re.MULTILINE)
QUICK = [file.stem for file in (ROOT / "tests").glob("test_*.py") if not SLOW.search(file.read_text(encoding="utf-8"))]


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
            f"fingerpad.{name}"
            for name in (
                "report.run_page",
                "report.sweep_page",
                "results.pictures.animation",
                "results.pictures.drawing",
                "results.pictures.curves",
                "results.spikes",
                "results.pictures.solid",
                "runs.batch",
                "runs.newtons",
            )
        ),
    ]
    code = "\n".join(["import sys", *(f"import {name}" for name in imports), "print(*sys.modules)"])
    done = python("-c", code, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert sorted({name.removesuffix(".__init__") for name in names} - set(done.stdout.split())) == []
