"""The closed form's errors on scenes drawn anew, which nothing was fitted to: docs/fresh.json."""

import math

import pytest
from scipy.stats import binomtest

from benchmarks.loads import fresh, meshes
from benchmarks.loads.scenes import SEED, forces
from tests.commands import kept

COVERED = 0.9
"""Part of the states that a ± is to cover, as of those in docs/loads.json that test it."""


def test_scenes_are_of_another_seed():
    """In the order of their sequence, so that none was chosen for its error."""
    every, numbers = fresh.fresh(), kept("fresh.json")
    assert numbers["seed"] == fresh.SEED != SEED
    assert [each["scene"] for each in numbers["scenes"]] == list(range(fresh.COUNT))
    for each in numbers["scenes"]:
        assert each["values"] == pytest.approx(every[each["scene"]])
        assert [state["f_ext"] for state in each["states"]] == pytest.approx(forces(each["values"]))


@pytest.mark.parametrize(("key", "least"), [("mu_app", 21), ("contact_length", 24)])
def test_errors_cover_scenes_drawn_anew(key, least):
    """So many of 24 states with a ±, as the page says: no fewer than chance leaves of nine of ten, to a twentieth.

    The three of µ_app that are outside are so by less than a tenth of their ±.
    """
    mesh = meshes.errors(kept("loads.json")["mesh"], kept("models.json")["scenes"])
    found = [each for each in fresh.beside(kept("fresh.json")["scenes"], key, mesh) if not math.isnan(each.error)]
    inside = sum(each.inside for each in found)
    assert (inside, len(found)) == (least, 24)
    assert binomtest(inside, len(found), COVERED, "less").pvalue > 0.05
    assert max(abs(each.off) / each.error for each in found) < 1.1
