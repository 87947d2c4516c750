"""A rigid translation changes no force: the unknowns are relative to the bone, and a solve ends at its floor."""

import numpy as np
import pytest
from dolfinx import fem

from fingerpad.model.simulation import Simulation
from fingerpad.scene import from_data
from tests.runs import followed, path_of
from tests.small_finger import NINE

pytestmark = pytest.mark.slow


def slid(away: float, f_ext: float, voltage: float, tolerance: float) -> Simulation:
    """Carry the bone sideways over the screen (m), press, charge and slide to full slip."""
    loads = [
        {"name": "away", "bone_height": 0.0, "bone_x": away},
        {"name": "press", "f_ext": f_ext},
        {"name": "charge", "voltage": voltage},
        {"name": "slide", "bone_x": away + 0.9e-3, "until_full_slip": True},
    ]
    data = {"history": loads[away == 0.0 :], "output": {"errors": False}}
    scene = from_data(NINE | data)
    # Below what a scene may ask for, where a test is of the floor.
    scene = scene.model_copy(update={"numerics": scene.numerics.model_copy(update={"tolerance": tolerance})})
    made = followed(scene)
    return made


def highest_floor(made: Simulation) -> float:
    """Return the highest floor, over f_ext, that a row of the steps tells."""
    return max(state.record.floor for state in made.states if state.record)


def held(made: Simulation) -> bool:
    return made.states[-1].slip_held


def forces(made: Simulation) -> np.ndarray:
    """Return the bone's reactions and each ridge's contact force, friction and length."""
    loads = made.finger.ridge_loads()
    return np.concatenate([made.finger.solver.reaction, loads.f_contact, loads.f_friction, 1e3 * loads.length])


@pytest.fixture(scope="module")
def at_the_start() -> Simulation:
    return slid(0.0, 1.0, 100.0, 1e-11)


@pytest.mark.parametrize("away", [1e-3, pytest.param(10e-3, marks=pytest.mark.long)])
def test_forces_do_not_depend_on_where_the_finger_is(at_the_start, away):
    """Relative 1e-9 of the load, a hundred times the tolerance of the solve; before, the residual stalled above it."""
    moved = slid(away, 1.0, 100.0, 1e-11)
    assert held(moved) and held(at_the_start)
    assert moved.finger.solver.bone[0] - at_the_start.finger.solver.bone[0] == pytest.approx(away, rel=1e-12)
    np.testing.assert_allclose(forces(moved), forces(at_the_start), rtol=0, atol=3e-9)


def test_translated_body_bears_no_force():
    """Off the screen, 10 mm aside: every nodal force is zero to the last bit."""
    scene = from_data(NINE | {"f_ext": 1.0})
    made = path_of(scene)
    u = np.tile([10e-3, 3e-3], (len(made.finger.problem.displacement()), 1))
    made.finger.solver.set_displacement(u, np.array([10e-3, 3e-3]))
    np.testing.assert_array_equal(made.finger.problem.displacement(), u)
    made.finger.problem.history.accept({})
    np.testing.assert_array_equal(fem.assemble_vector(made.finger.problem.residual).array, 0.0)


def test_solve_ends_at_its_floor(at_the_start):
    """A tolerance below roundoff: what is left is some units of it, is said, and the forces are the same."""
    made = slid(0.0, 1.0, 100.0, 1e-14)
    assert 1e-14 < highest_floor(made) < 1e-10
    assert highest_floor(at_the_start) == 0.0, "a tolerance that can be met is met"
    np.testing.assert_allclose(forces(made), forces(at_the_start), rtol=0, atol=1e-10)
