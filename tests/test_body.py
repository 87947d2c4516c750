"""One body at the door: the same numbers as from its parts, closed forms, unusual orders of loads, refusals."""

from functools import cache

import numpy as np
import pytest
from mpi4py import MPI

import geometry
from fingerpad.model.body import Body
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import StepFailed

MU_F, H_0, FORCE, VOLTAGE = 0.25, 0.51e-6, 4.4, 150.0
SKIN, SPRINGS = Ogden(86.76e3, -14.53, 0.48), Penalty(1.5e12, 5e10)
RIDGE = geometry.ridge(size=30e-6)


def ridge(comm=MPI.COMM_WORLD, friction=MU_F, roughness=BearingArea(H_0)) -> Body:  # noqa: B008
    return Body(RIDGE, SKIN, contact=SPRINGS, friction=friction, roughness=roughness, comm=comm)


def slid(alone=False) -> Body:
    """Return a ridge pressed, charged and slid to full slip, not to be loaded further; ``alone`` on each rank."""
    return _slid(1 if alone else MPI.COMM_WORLD.size)


@cache
def _slid(ranks: int) -> Body:
    body = ridge(MPI.COMM_SELF if ranks == 1 else MPI.COMM_WORLD)
    return body.press(FORCE).charge(VOLTAGE).slide(until_full_slip=True)


@pytest.mark.mpi
def test_fields_are_those_of_the_last_state():
    """The same on every rank: displacement as the body has it, and stress that is as deep as the contact pressure."""
    body = slid()
    found = body.fields
    np.testing.assert_allclose(found.points, body.coordinates, rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.displacement, body.displacement, rtol=0, atol=1e-15)
    assert found.stress.shape == (len(found.triangles), 3, 3)
    assert -1.5 * body.state.p_max < found.stress[:, 1, 1].min() < -0.3 * body.state.p_max


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"element": "P7"}, "element is 'P7'; it must be one of P1, P2"),
        ({"contact": 3}, "contact is 3; it must be a Formulation"),
        ({"h_0": -1.0}, "h_0 is -1.0; it must be a finite number greater than 0"),
    ],
)
def test_arguments_are_refused(given, words):
    with pytest.raises(ValueError, match=words):
        Body(**{"shape": RIDGE, "material": SKIN} | given)


@pytest.mark.mpi
def test_arrays_do_not_depend_on_the_ranks():
    """Nodes and facets come in one order; values differ by the solves' tolerance, 1e-9 of 1 N/m.

    Full slip begins at one place.
    """
    mine, alone = slid(), slid(alone=True)
    assert mine.coordinates == pytest.approx(alone.coordinates, abs=1e-18)
    assert (mine.triangles == alone.triangles).all()
    assert mine.displacement == pytest.approx(alone.displacement, abs=1e-12)
    assert mine.skin.x == pytest.approx(alone.skin.x, abs=1e-12)
    assert mine.skin.p_n == pytest.approx(alone.skin.p_n, abs=1.0)
    assert mine.energy.stored == pytest.approx(alone.energy.stored, rel=1e-8)
    assert mine.state.bone_x == pytest.approx(alone.state.bone_x, rel=1e-6)


def test_skin_runs_from_left_to_right_and_bears_the_force():
    """The trapezoidal rule over the Gauss points is within 5 % of the resultant, with some ten facets in contact."""
    skin, state = slid().skin, slid().state
    x, p_n = skin.x.ravel(), skin.p_n.ravel()
    assert (np.diff(x) > 0).all()
    assert np.trapezoid(p_n, x) == pytest.approx(state.f_contact, rel=0.05)
    sliding = skin.p_n > 0
    assert skin.t_t[sliding] == pytest.approx(-MU_F * skin.p_n[sliding], rel=1e-6)


# -- unusual histories -------------------------------------------------------------------------------------
@pytest.mark.mpi
def test_there_and_back():
    """Full slip does not depend on the way: that to the left is the mirror image of that to the right.

    Within 1e-6, since air gaps are accepted within that part of themselves, and a gmsh mesh is not its mirror image.
    """
    body = ridge().press(FORCE).slide(until_full_slip=True)
    right = body.state
    left = body.slide(-600e-6, until_full_slip=True).state
    again = body.slide(until_full_slip=True).state
    assert left.f_t == pytest.approx(-right.f_t, rel=1e-6)
    assert again.f_t == pytest.approx(right.f_t, rel=1e-6)
    assert right.slip_began < left.slip_began < again.slip_began
    assert body.energy.dissipated > 0


# -- refusals ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda b: b.charge(100.0), "the body has no roughness, so that it has no air gap to charge"),
        (lambda b: b.press(-1.0), "f_ext is -1 N/m; it must be positive"),
        (lambda b: b.press("4.4 N"), "f_ext is '4.4 N'; its unit is not a unit of force per length"),
        (lambda b: b.slide(), "slide takes a distance, in m, or until_full_slip=True"),
        (lambda b: b.slide(1e-3, until_full_slip=True), "the body has no friction"),
    ],
)
def test_load_is_refused(call, message):
    body = Body(RIDGE, SKIN, contact=SPRINGS)
    with pytest.raises(ValueError, match=message):
        call(body)
    assert body.states == []


@pytest.mark.parametrize(
    ("material", "message"),
    [
        ({"stratum corneom": SKIN}, "'stratum corneom', which is no layer of the body; did you mean 'stratum corneum'"),
        (5.0, "material is 5.0; it must be a Material, or a dictionary of one for each layer"),
        ({}, "there is no material for the layer 'stratum corneum'"),
    ],
)
def test_materials_are_refused(material, message):
    with pytest.raises(ValueError, match=message):
        Body(RIDGE, material, contact=SPRINGS)


@pytest.mark.mpi
def test_load_that_fails_keeps_what_was_reached():
    """No full slip within 1 um: the body is in the state it came to, and is led on from there."""
    body = ridge().press(FORCE)
    with pytest.raises(StepFailed, match="slide: there is no full slip within 1e-06 m; give a larger distance"):
        body.slide(1e-6, until_full_slip=True)
    assert body.state.bone_x == pytest.approx(1e-6)
    assert body.slide(until_full_slip=True).state.f_t == pytest.approx(MU_F * body.state.f_contact, rel=1e-6)


@pytest.mark.slow
def test_step_that_fails_keeps_the_last_state():
    """Pressed through itself a ridge has no equilibrium: the failure names the step, the states before are kept."""
    body = ridge(roughness=None).press(FORCE)
    with pytest.raises(StepFailed, match="found no equilibrium beyond bone height"):
        body.press(height=-599e-6)
    assert body.states[-1] is body.state
    before = body.state
    body.press(height=before.bone_height)
    assert body.state.f_ext == pytest.approx(before.f_ext, rel=1e-6)
