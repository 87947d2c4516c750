"""Mutated scenes and command lines are run-ready or refused in one sentence; ten thousand with ``tests.fuzz``."""

import pytest

from tests import fuzz_files
from tests.fuzz import bad_refusal, fault, mutant, prepare

SEED = 16


@pytest.fixture
def folder(tmp_path):
    prepare(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_mutants(folder):
    """Some are ready, most are refused, and of neither kind is there anything wrong."""
    found = [fault(mutant(SEED, k), folder) for k in range(100)]
    assert [(k, wrong) for k, (wrong, _) in enumerate(found) if wrong] == []
    ready = [how for _, how in found].count("ready")
    assert 0.1 * len(found) < ready < 0.5 * len(found)


@pytest.mark.parametrize(
    ("broken", "value"),
    [("fingerpad.scene.reading._MAX_DEPTH", 10**6), ("fingerpad.model.feasibility.refuse_sizes", lambda *given: None)],
)
@pytest.mark.slow
def test_what_is_broken_is_found(folder, monkeypatch, broken, value):
    """Without one of the guards there is a mutant that shows it: at present the two that are tried first."""
    monkeypatch.setattr(broken, value)
    assert any(fault(mutant(SEED, k), folder)[0] for k in (75, 265, *range(400)))


# -- files -------------------------------------------------------------------------------------------------
@pytest.mark.slow
def test_files(folder):
    """Each kind as it is, and mutants of them: there is nothing wrong, some are read and some refused."""
    kinds = {ending: content for ending, content in fuzz_files.whole() if len(content) > 60}
    found = [fuzz_files.fault(fuzz_files.Mutant(0, *kind), folder, bad_refusal) for kind in kinds.items()]
    found += [fuzz_files.fault(fuzz_files.mutant(SEED, k), folder, bad_refusal) for k in range(8)]
    assert [wrong for wrong, _ in found if wrong] == []
    assert {how == "ready" for _, how in found} == {True, False}
