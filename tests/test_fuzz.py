"""Mutated scenes and command lines are run-ready or refused in one sentence; ten thousand with ``tests.fuzz``."""

import pytest

from tests.fuzz import fault, main, mutant, prepare

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
    [("fingerpad.scene.reading._MOST_DEPTH", 10**6), ("fingerpad.model.check.refuse_beyond", lambda *given: None)],
)
def test_what_is_broken_is_found(folder, monkeypatch, broken, value):
    """Without one of the guards there is a mutant that shows it."""
    monkeypatch.setattr(broken, value)
    assert any(fault(mutant(SEED, k), folder)[0] for k in range(400))


def test_command(capsys):
    assert main(["--count", "5", "--seed", "2"]) == 0
    assert "5 mutants: " in capsys.readouterr().out
