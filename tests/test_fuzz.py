"""Mutated scenes and command lines are run-ready or refused in one sentence; ten thousand with ``tests.fuzz``."""

import os

import pytest

from tests import fuzz_files
from tests.fuzz import bad_refusal, fault, main, mutant, prepare

SEED = 16


@pytest.fixture
def folder(tmp_path):
    prepare(tmp_path)
    return tmp_path


def test_mutants(folder):
    """Some are ready, most are refused, and of neither kind is there anything wrong."""
    found = [fault(mutant(SEED, k), folder) for k in range(200)]
    assert [(k, wrong) for k, (wrong, _) in enumerate(found) if wrong] == []
    ready = [how for _, how in found].count("ready")
    assert 0.1 * len(found) < ready < 0.5 * len(found)


def test_mutants_are_repeatable():
    assert [mutant(SEED, k) for k in range(50)] == [mutant(SEED, k) for k in range(50)]
    assert mutant(SEED, 1) != mutant(SEED + 1, 1)


@pytest.mark.parametrize(
    ("broken", "value"),
    [("fingerpad.scene.reading._MOST_DEPTH", 10**6), ("fingerpad.model.feasibility.refuse_sizes", lambda *given: None)],
)
def test_what_is_broken_is_found(folder, monkeypatch, broken, value):
    """Without one of the guards there is a mutant that shows it."""
    monkeypatch.setattr(broken, value)
    assert any(fault(mutant(SEED, k), folder)[0] for k in range(400))


def test_command(capsys):
    assert main(["--count", "5", "--seed", "2"]) == 0
    assert "5 mutants: " in capsys.readouterr().out


# -- files -------------------------------------------------------------------------------------------------
def test_files(folder):
    """Each kind as it is, and mutants of them: there is nothing wrong, some are read and some refused."""
    kinds = {ending: content for ending, content in fuzz_files.whole() if len(content) > 60}
    found = [fuzz_files.fault(fuzz_files.Mutant(0, *kind), folder, bad_refusal) for kind in kinds.items()]
    found += [fuzz_files.fault(fuzz_files.mutant(SEED, k), folder, bad_refusal) for k in range(8)]
    assert [wrong for wrong, _ in found if wrong] == []
    assert {how == "ready" for _, how in found} == {True, False}


def test_mutants_of_files_are_repeatable():
    cases = [[fuzz_files.mutant(SEED, k) for k in range(20)] for _ in range(2)]
    assert cases[0] == cases[1]


@pytest.mark.parametrize(
    ("broken", "text"),
    [("os._exit(3)", "exit code 3"), ("1 / 0", "ZeroDivisionError"), ("os.kill(os.getpid(), 9)", "signal 9")],
)
def test_what_a_file_breaks_is_found(folder, monkeypatch, broken, text):
    """A wrong exit code, an error and the end of the process."""
    monkeypatch.setattr(fuzz_files, "_read", lambda path: exec(broken, {"os": os}))
    assert text in fuzz_files.fault(fuzz_files.mutant(SEED, 1), folder, bad_refusal)[0]
