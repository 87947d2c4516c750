"""A slide until full slip ends where full slip begins, however long its steps are."""

import numpy as np
import pytest
from mpi4py import MPI

from geometry.bodies import block
from geometry.mesh import load
from tests.test_body import FORCE, MU_F, RIDGE, SKIN, SPRINGS, VOLTAGE, Body
from tests.test_contact import HEIGHT, WIDTH, over
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.nitsche import Nitsche
from variational.roughness.bam import BearingArea
from variational.solvers.accepted import return_to_onset
from variational.solvers.continuation import Target


def charged(contact, step_scale=1.0) -> Body:
    roughness = BearingArea(0.51e-6)
    skin = {"contact": contact, "friction": MU_F, "roughness": roughness}
    return Body(RIDGE, SKIN, **skin, step_scale=step_scale).press(FORCE).charge(VOLTAGE)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("contact", "way"),
    [(SPRINGS, 1), (Nitsche(10.0), -1), (AugmentedLagrangian(1.5e12, 5e10, 5e-9), 1)],
    ids=["penalty", "nitsche", "augmented"],
)
@pytest.mark.slow
def test_place_of_full_slip_does_not_depend_on_the_step(contact, way):
    """Steps of 60 and of 15 um end 67 um from the start, and not up to a step further.

    The tolerance of 0.3 um is what longer steps change in the slip of single points on the way there: measured 0.1 um
    and less. Without the way back the places are 105 um apart.
    """
    long, short = (charged(contact, scale).slide(way * 0.3e-3, until_full_slip=True) for scale in (1.0, 0.25))
    assert long.state.all_slip and short.state.all_slip
    assert long.state.bone_x == pytest.approx(short.state.bone_x, abs=0.3e-6)
    assert way * long.state.f_t == pytest.approx(MU_F * long.state.f_contact, rel=1e-8)


@pytest.mark.slow
def test_work_of_friction_does_not_depend_on_the_step():
    """There and back to full slip, under steps of 60 and of 15 um.

    Tolerance: the trapezoidal rule on the way to full slip, measured 2 %. Without the way back the longer steps
    have nine times the work of the shorter ones.
    """
    spent = []
    for scale in (1.0, 0.25):
        body = Body(RIDGE, SKIN, contact=SPRINGS, friction=MU_F, step_scale=scale).press(FORCE)
        body.slide(until_full_slip=True).slide(-0.5e-3, until_full_slip=True)
        spent.append(body.energy.dissipated)
    assert spent[0] == pytest.approx(spent[1], rel=5e-2)


def test_full_slip_begins_at_once_where_it_is():
    """A second slide the same way moves nothing and spends nothing; one by a given length goes on from there."""
    body = charged(SPRINGS).slide(until_full_slip=True)
    x, spent, f_t = body.state.bone_x, body.energy.dissipated, body.state.f_t
    body.slide(until_full_slip=True)
    assert body.state.bone_x == pytest.approx(x, rel=1e-6)
    assert body.energy.dissipated == pytest.approx(spent, rel=1e-5)
    body.slide(50e-6)
    assert body.state.bone_x == pytest.approx(x + 50e-6, rel=1e-6)
    assert body.energy.dissipated - spent == pytest.approx(f_t * 50e-6, rel=1e-4)


def test_body_that_something_else_holds_stays_where_it_is():
    """The lateral facets of a block are held in place: translated back the forces would not balance, so it stays."""
    run = over(load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3)), MU_F, 1e11, 1e10).continuation
    run.run(Target("press", bone_height=-2e-6))
    run.run(Target("slide", bone_x=0.1e-3))
    x, unknowns = run.solver.control.x, run.solver.x.array_r.copy()
    assert return_to_onset(run.solver, run.observer, 0.1e-3) == 0.0
    assert run.solver.control.x == x
    np.testing.assert_allclose(run.solver.x.array_r, unknowns, rtol=0, atol=1e-18)
