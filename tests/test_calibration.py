"""The printed error against known errors: of runs from two meshes, and with an accuracy from all sizes in turn."""

import pytest

from benchmarks import harness, two_meshes
from benchmarks.accuracy import KINDS, WANTED, coverage, kept
from fingerpad.accuracy.richardson import SITES, TWO

COVERED = 0.95  # of the known errors of each kind, by the two meshes of a run


# -- two meshes ----------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def numbers():
    return harness.kept("two_meshes").numbers


@pytest.mark.parametrize("kind", two_meshes.KINDS)
def test_errors_from_two_meshes_cover_the_known_ones(numbers, kind):
    """By what half of all sizes changes, and by the whole error; a case for each state of each scene at least."""
    n, covered = two_meshes.coverage(two_meshes.cases(numbers), kind)
    assert n >= (1 if kind == "friction" else 3) * len(two_meshes.solved(numbers))
    assert min(covered, whole(two_meshes.cases(numbers), kind)) >= COVERED * n


def whole(known, kind: str) -> int:
    """Return how many whole errors of a kind are covered."""
    return sum(case.whole <= case.estimated for case in known if case.kind == kind)


@pytest.mark.parametrize(("safety", "sites"), [(1.0, SITES), (TWO, 0.0), (1.0, 0.0)])
def test_errors_from_two_meshes_need_their_factors(numbers, safety, sites):
    """Without either of them the whole errors of a kind are covered in fewer cases than are wanted."""
    weaker = two_meshes.cases(numbers, safety, sites)
    counts = {kind: two_meshes.coverage(weaker, kind)[0] for kind in two_meshes.KINDS}
    assert any(whole(weaker, kind) < COVERED * n for kind, n in counts.items())


# -- runs with an accuracy -----------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def cases():
    return kept()


@pytest.mark.parametrize("kind", KINDS)
def test_known_errors_of_whole_runs_are_covered(cases, kind):
    """What a user gets: runs of scenes, all their sizes at once."""
    n, _, safe = coverage(cases, kind)
    assert safe >= WANTED * n
    # Of most energy densities the limit is less certain than the run is wrong: those that are not clear count too.
    every = [case.covered(case.factor) for case in cases if case.kind == kind]
    assert len(every) >= 20 and sum(every) >= WANTED * len(every)
    # Of friction 16 errors of 25 are clear: the others are smaller than what the limit itself is uncertain by.
    assert n >= {"energy density": 0, "friction": 15}.get(kind, 20)


def test_every_quantity_of_the_default_run_is_covered(cases):
    default = [case for case in cases if case.scene == "default scene as it is"]
    assert len(default) == 10, (
        "three states with length, highest pressure and the worst density, and friction at full slip"
    )
    assert all(case.covered(case.factor) for case in default)
    assert not all(case.covered(1.0) for case in default)
