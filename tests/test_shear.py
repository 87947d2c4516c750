"""Shear of the closed form: nothing with the default friction or without slip, a shorter contact with more of it."""

import numpy as np
import pytest

from benchmarks.loads import meshes
from benchmarks.loads.compared import fits
from benchmarks.loads.shear import Point, differences, fitted, points, spread
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene
from tests.commands import kept

STRONG = 0.8


@pytest.fixture(scope="module")
def reached() -> list[Point]:
    """States of the full model without the error of their mesh."""
    numbers = kept("loads.json")
    mesh = meshes.errors(numbers["mesh"], kept("models.json")["scenes"])
    return points(meshes.without(numbers["scenes"], mesh))


def test_nothing_changes_up_to_the_friction_of_the_table():
    """To the last digit: of the default coefficient, weaker friction, and normal contact."""

    def values(friction: float, state: str, shear: float) -> tuple[float, float]:
        (found,) = cylinders.over_forces(Scene(friction=friction), [75.0], state, shear=shear)
        return found.f_electrostatic, found.contact_length

    for friction in (0.1, 0.25):
        assert values(friction, "full_slip", cylinders.SHEAR) == values(friction, "full_slip", 0.0)
    assert values(STRONG, "full_slip", cylinders.SHEAR) != values(STRONG, "full_slip", 0.0)
    assert values(STRONG, "charged", cylinders.SHEAR) == values(0.25, "charged", 0.0)


def test_ridge_is_stiffer_by_the_shear_stress_at_its_own_pressure():
    """Its modulus, by Hertz's law without voltage, is that of the table and kappa times the stress beyond it."""
    (table,), (found,) = (
        cylinders.over_forces(Scene(friction=mu_f, voltage=0.0), [75.0], "full_slip") for mu_f in (0.25, STRONG)
    )
    radius, n = cylinders.tip_radius(Scene().geometry), table.ridges_in_contact
    own, stiffer = (
        cylinders.hertz_modulus(radius, 75.0 / n, state.contact_length / n).item() for state in (table, found)
    )
    p_c = 75.0 / found.contact_length
    assert stiffer - own == pytest.approx(cylinders.SHEAR * (STRONG - 0.25) * p_c, rel=1e-9)


def test_number_is_that_of_the_kept_states(reached):
    """To one digit."""
    assert cylinders.SHEAR == float(f"{fitted(reached):.1g}")


def test_states_that_did_not_make_it_come_nearer(reached):
    """With a friction coefficient above 0.5 attraction and length differ by less than half as much, at 95 % of them."""
    tests = [each for each in reached if not fits(each) and each.values["friction"] > 0.5]
    without, own = (spread(tests, shear) for shear in (0.0, cylinders.SHEAR))
    assert len(tests) >= 20
    assert own.most < without.most / 2 and own.length_most < without.length_most / 2
    assert abs(np.expm1(differences(tests, 0.0))).max() > 0.3, "so that there is something to correct"
