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


def test_energy_density_counts_once():
    """One at the mirrored site of a symmetric state is the same number; full slip has no such symmetry."""
    facets, one = {"charged": 1e-6, "full_slip": 1e-6}, {"charged_sed_1": 8.0, "charged_sed_-1": 8.0}
    parts = one | {"full_slip_sed_-1": 8.0, "full_slip_mu_app": 0.5, "full_slip_f_t": 37.5}
    finer = {name: 1.01 * value for name, value in parts.items()}
    solves = {name: {"parts": parts, "facets": facets} for name in ("coarse", "final")}
    known = two_meshes.cases({"a scene": solves | {"finer": {"parts": finer}}, "another": {"failure": "none"}})
    assert [case.name for case in known] == ["charged_sed_1", "full_slip_sed_-1", "full_slip_mu_app"]
    assert [case.known for case in known] == pytest.approx([100 * 0.01 / 1.01] * 3, rel=1e-9)
    assert two_meshes.coverage(known) == (3, 0)  # two meshes that agree estimate no error


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
