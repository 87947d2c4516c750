"""The closed form's errors on scenes drawn anew, which nothing was fitted to: docs/fresh.json."""

import pytest

from benchmarks.loads import fresh, meshes
from benchmarks.loads.scenes import SEED, forces, section
from fingerpad.reduced import cylinders
from tests.commands import kept

COVERED = 0.9
"""Part of the states that a ± is to cover, as of those in docs/loads.json that test it."""


@pytest.fixture(scope="module")
def scenes() -> list[dict]:
    return kept("fresh.json")["scenes"]


def test_scenes_are_of_another_seed(scenes):
    """In the order of their sequence, so that none was chosen for its error."""
    every = fresh.fresh()
    assert kept("fresh.json")["seed"] == fresh.SEED != SEED and len(scenes) > fresh.COUNT / 2
    for each in scenes:
        assert each["values"] == pytest.approx(every[each["scene"]])
        assert [state["f_ext"] for state in each["states"]] == pytest.approx(forces(each["values"]))


@pytest.mark.parametrize("key", ["mu_app", "contact_length"])
def test_errors_cover_scenes_drawn_anew(scenes, key):
    """Nine of ten states with a ±, of the full model without the error of its mesh; others have a caution."""
    mesh = meshes.errors(kept("loads.json")["mesh"], kept("models.json")["scenes"])
    inside = []
    for each in meshes.without(scenes, mesh):
        for state in (state for state in each["states"] if "failure" not in state):
            result = cylinders.solve(section(each["values"], state["f_ext"]))
            number = result.number("full_slip", key)
            if number.error == number.error:
                inside.append(abs(state[key] - number.value) <= number.error)
            else:
                assert any("error of this model is not known here" in text for text in result.cautions)
    assert len(inside) >= 10 and sum(inside) >= COVERED * len(inside)
