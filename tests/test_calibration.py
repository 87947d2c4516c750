"""Errors: of runs from two meshes and with an accuracy beside known ones, and limits of sequences of meshes."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import errors, harness, limits, two_meshes
from benchmarks.accuracy import KINDS, WANTED, coverage, kept
from benchmarks.errors import QUANTITIES
from benchmarks.limits import limit
from fingerpad.accuracy.richardson import SITES, TWO
from fingerpad.scene import Scene
from variational.solvers.continuation import StepFailed

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


# -- the error study of the default scene, on made-up runs whose limits are known ------------------------------------
def exact(mesh):
    """A quantity whose errors are 1 % times the sizes over their defaults, of second order."""
    sizes = mesh.contact / 5e-6, mesh.growth / 0.25, mesh.receptor / 5e-6
    return dict.fromkeys(QUANTITIES, 2 + 0.02 * sum(size**2 for size in sizes))


def solve(mesh, off=0.0):
    values = {name: value + off for name, value in exact(mesh).items()}
    return {"mesh": mesh.model_dump(), "unknowns": 10, "factorisations": 3, "values": values}


@pytest.fixture
def again():
    meshes = limits.meshes(errors.DEFAULT.mesh, errors.LEVELS)
    own = solve(errors.DEFAULT.mesh)
    return {"path": own, "own": own, "levels": [solve(mesh) for mesh in meshes]}


def test_reference_is_the_limit(again):
    """Errors of second order are taken away exactly, the bar is Roache's for the finest mesh. Tolerance: roundoff."""
    found = errors.reference(again, exact(errors.DEFAULT.mesh))
    finest = limits.meshes(errors.DEFAULT.mesh, errors.LEVELS)[-1]
    assert set(found) == set(QUANTITIES)
    for name, each in found.items():
        assert each.value == pytest.approx(2, rel=1e-12, abs=0)
        assert each.order == pytest.approx(2, rel=1e-9)
        assert each.bar == pytest.approx(1.25 * (exact(finest)[name] - 2), rel=1e-9, abs=0)


# -- Limits of scenes: their path, the kept output, and one solve for each scene ---


@pytest.mark.parametrize(("lost", "levels"), [(4, 4), (3, 3), (2, None)])
def test_limit_is_of_the_meshes_before_one_on_which_a_state_is_lost(monkeypatch, lost, levels):
    """The meshes are numbered from zero, each of half the sizes; of fewer than three no limit is made."""
    meshes = limits.meshes(Scene().mesh, 4)
    for name in limits._HALVED:
        assert [getattr(mesh, name) for mesh in meshes[:3]] == [getattr(meshes[0], name) / k for k in (1, 2, 4)]

    def solved(model, states, comm):
        if meshes[lost:] and model.mesh.contact == meshes[lost].contact:
            raise StepFailed("lost")
        cost = {"unknowns": 1, "factorisations": 1, "processor_seconds": 0.0}
        return SimpleNamespace(states={}, mesh=model.mesh, values=dict, **cost)

    monkeypatch.setattr(limits, "solve_again", solved)
    monkeypatch.setattr(limits, "_path", lambda scene: solved(Scene(), {}, None))
    if levels is None:
        with pytest.raises(StepFailed, match="lost"):
            limits._solve(Scene(), 4)
    else:
        assert len(limits._solve(Scene(), 4)["levels"]) == levels


# -- limits of sequences ---------------------------------------------------------------------------------------------
SIZES = 0.5 ** np.arange(4)


@pytest.mark.parametrize("order", [0.6, 1.0, 1.5, 2.0])
def test_power_law(order):
    """A single power of the size is found exactly. Tolerance: roundoff of differences, 1e-14 of numbers about 2."""
    found = limit(list(2 - 0.3 * SIZES**order))
    assert found.order == pytest.approx(order, rel=1e-12)
    assert found.value == pytest.approx(2, rel=1e-14, abs=0)
    assert found.bar == pytest.approx(1.25 * 0.3 * SIZES[-1] ** order, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    "values", [[1.0, 1.05, 1.2, 1.05], [1.0, 1.1, 1.2, 1.3], [1.0, 1.1, 1.2, 1.28], [1.0, 1.0, 1.1, 1.1]]
)
def test_no_order(values):
    """Changes that swing as far as before, hardly shrink, or vanish: three times the largest of the last two.

    Tolerance: roundoff.
    """
    found = limit(values)
    assert found.order is None
    assert found.value == values[-1]
    changes = abs(values[-1] - values[-2]), abs(values[-2] - values[-3])
    assert found.bar == pytest.approx(3 * max(changes), rel=1e-14, abs=0)
