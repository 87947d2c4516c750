"""One body at the door: the same numbers as from its parts, closed forms, unusual orders of loads, refusals."""

from functools import cache

import numpy as np
import pytest
from mpi4py import MPI

import geometry
from fingerpad.model.body import Body
from geometry import tags
from geometry.mesh import load
from variational import body as parts
from variational.contact.interface import Interface
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.materials.saint_venant import SaintVenant
from variational.roughness.bam import BearingArea
from variational.solvers import continuation
from variational.solvers.continuation import StepFailed, Target

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
def test_ridges_share_the_load_by_their_places():
    """Three ridges bear the force together; the outer two bear alike, and less than the middle one.

    Tolerance of the outer two: their meshes are not each other's image.
    """
    body = Body(geometry.ridges(3, size=30e-6), SKIN, contact=SPRINGS).press(3 * FORCE)
    assert body.state.ridges.number.tolist() == [-1, 0, 1]
    left, middle, right = body.state.ridges.f_contact
    assert left + middle + right == pytest.approx(3 * FORCE, rel=1e-8)
    assert left == pytest.approx(right, rel=1e-3) and left < 0.99 * middle


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
        ({"shape": 3}, "shape is 3; it must be a shape of fingerpad.geometry, a mesh, or a file of one"),
        ({"element": "P7"}, "element is 'P7'; it must be one of P1, P2"),
        ({"element": ["P1"]}, "element is .*; it must be one of P1, P2"),
        ({"step_scale": float("nan")}, "step_scale is nan; it must be"),
        ({"contact": 3}, "contact is 3; it must be a Formulation"),
        ({"h_0": -1.0}, "h_0 is -1.0; it must be a finite number greater than 0"),
    ],
)
def test_arguments_are_refused(given, words):
    with pytest.raises(ValueError, match=words):
        Body(**{"shape": RIDGE, "material": SKIN} | given)


@pytest.mark.parametrize(
    ("kind", "numbers", "name"),
    [(Penalty, (1e12, -5e10), "eps_t"), (Penalty, (float("inf"), 1.0), "eps_n"), (Nitsche, (0.0,), "gamma_0")],
)
def test_stiffnesses_are_positive(kind, numbers, name):
    """A negative one drags the skin along: µ_app of -0.36 under a coefficient of 0.25."""
    with pytest.raises(ValueError, match=f"{name} of {kind.__name__} is .*; it must be finite and"):
        kind(*numbers)
    with pytest.raises(ValueError, match="theta of Nitsche is 5; it must be 1, 0 or -1"):
        Nitsche(10.0, 5)


def test_slide_in_another_unit_is_refused():
    with pytest.raises(ValueError, match=r"distance is 10 m; the body of 0.0006 m slides by 0.6 m at most"):
        slid(alone=True).slide(10.0)


@pytest.mark.mpi
def test_same_path_by_its_parts():
    """The same calls in the same order: what is left is what two runs on threads of another number may differ by."""
    tagged = load(MPI.COMM_WORLD, RIDGE)
    law = Interface(SPRINGS, MU_F, H_0)
    made = parts.Body(tagged, {tags.STRATUM_CORNEUM: SKIN}, law, BearingArea(H_0))
    size = 600e-6  # m, of the ridge
    for target in (
        Target("press", f_ext=FORCE),
        Target("charge", voltage=VOLTAGE),
        Target("slide", bone_x=size, until_full_slip=True),
    ):
        made.continuation.run(target)
    body, loads = slid(), made.observer.ridge_loads(made.continuation.surface_state)
    assert body.state.f_t == pytest.approx(-made.solver.reaction[0], rel=1e-12)
    assert body.state.d_eq == pytest.approx(made.coupling.d_eq, rel=1e-12)
    assert body.state.contact_length == pytest.approx(loads.length.sum(), rel=1e-12)
    assert len(body.states) == body.state.step == made.continuation.steps


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


def test_arrays_have_the_documented_shapes():
    body = slid()
    nodes, points = body.coordinates.shape[0], body.skin.p_n.shape[1]
    assert body.displacement.shape == body.coordinates.shape == (nodes, 2)
    assert body.triangles.max() == nodes - 1
    facets = len(body.skin.ridge)
    for name in ("x", "y", "p_n", "t_t", "p_el"):
        assert getattr(body.skin, name).shape == (facets, points)
    assert body.state.d_eq.shape == body.state.p_c.shape == (1,)


def test_top_moves_with_the_bone():
    body = slid()
    top = body.coordinates[:, 1] > 600e-6 - 1e-12
    bone = np.array([body.state.bone_x, body.state.bone_height])
    assert body.displacement[top] == pytest.approx(np.tile(bone, (top.sum(), 1)), abs=1e-15)


def test_skin_runs_from_left_to_right_and_bears_the_force():
    """The trapezoidal rule over the Gauss points is within 5 % of the resultant, with some ten facets in contact."""
    skin, state = slid().skin, slid().state
    x, p_n = skin.x.ravel(), skin.p_n.ravel()
    assert (np.diff(x) > 0).all()
    assert np.trapezoid(p_n, x) == pytest.approx(state.f_contact, rel=0.05)
    sliding = skin.p_n > 0
    assert skin.t_t[sliding] == pytest.approx(-MU_F * skin.p_n[sliding], rel=1e-6)


def test_hertz():
    """A pad without friction against Hertz, with facets of a / 8.

    The half-width is located inside a facet. Pressures of a stiff penalty alternate within facets, not their means.
    """
    young, poisson, radius, half_width = 1e6, 0.3, 10e-3, 50e-6
    e_star = young / (1 - poisson**2)
    force = np.pi * e_star * half_width**2 / (4 * radius)
    shape = geometry.pad(size=half_width / 8, facets=12, radius=radius, span=200 * half_width)
    stiff = 100 * e_star / (half_width / 8)
    body = Body(shape, SaintVenant(young, poisson), contact=Penalty(stiff, stiff), touch_depth=50e-9).press(force)
    assert body.state.contact_length == pytest.approx(2 * half_width, rel=0.01)
    weights = np.polynomial.legendre.leggauss(4)[1] / 2
    x, p_n = body.skin.x @ weights, body.skin.p_n @ weights
    inner = np.abs(x) < 0.8 * half_width
    exact = 2 * force / (np.pi * half_width) * np.sqrt(1 - (x[inner] / half_width) ** 2)
    assert p_n[inner] == pytest.approx(exact, rel=0.03)


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


def test_charged_while_it_slides_as_before():
    """Voltage first or slide first, full slip is the same; the air gaps are accepted within 1e-6 of themselves."""
    other = ridge().press(FORCE).slide(until_full_slip=True).charge(VOLTAGE).slide(until_full_slip=True).state
    assert other.mu_app == pytest.approx(slid().state.mu_app, rel=1e-5)


def test_the_sign_of_a_voltage_does_not_matter():
    """Nor a change of sign, through no voltage at all; air gaps are accepted within 1e-6 of themselves."""
    charged = [ridge(friction=0.0).press(FORCE).charge(voltage) for voltage in (VOLTAGE, -VOLTAGE)]
    plus, minus = (body.state for body in charged)
    assert plus.f_electrostatic > 0
    assert minus.f_electrostatic == pytest.approx(plus.f_electrostatic, rel=1e-10)
    turned = charged[0].charge(-VOLTAGE).state
    assert turned.voltage == -VOLTAGE
    assert turned.f_electrostatic == pytest.approx(plus.f_electrostatic, rel=1e-5)


def test_full_slip_goes_on():
    """Sliding on at full slip changes nothing; it is the same full slip."""
    body = ridge().press(FORCE).slide(until_full_slip=True)
    first = body.state
    body.slide(100e-6)
    assert body.state.f_t == pytest.approx(first.f_t, rel=1e-6)
    assert body.state.f_t == pytest.approx(MU_F * body.state.f_contact, rel=1e-6)
    assert body.state.slip_began == first.slip_began
    assert body.state.bone_x == pytest.approx(first.bone_x + 100e-6)


def test_full_slip_from_full_slip_takes_one_step(monkeypatch):
    """Also where roundoff, here 1e-11 m, has it begin before the load does."""
    body = ridge().press(FORCE).slide(until_full_slip=True)
    first, exact = body.state, continuation.return_to_onset
    monkeypatch.setattr(continuation, "return_to_onset", lambda *given: exact(*given) + 1e-11)
    again = body.slide(until_full_slip=True).state
    assert again.step == first.step + 1 and again.all_slip
    assert again.f_t == pytest.approx(first.f_t, rel=1e-6)


@pytest.mark.mpi
def test_lifted_body_bears_nothing():
    """Pressed by height, charged and lifted: strain energy is gone, what friction spent is not."""
    body = ridge().press(height=-30e-6).charge(100.0).slide(20e-6).charge(0.0).lift(5e-6)
    state = body.state
    assert (state.f_contact, state.contact_length, state.ridges_in_contact) == (0.0, 0.0, 0)
    assert state.f_ext == pytest.approx(0.0, abs=1e-8)  # N/m, ten times the tolerance of the solves
    assert np.isnan(state.mu_app), "friction over a force that is roundoff"
    assert body.energy.stored == pytest.approx(0.0, abs=1e-12)
    assert body.energy.dissipated > 0
    assert np.abs(body.displacement - [20e-6, 5e-6]).max() < 1e-10


def test_energy_of_a_lifted_body_is_checked(monkeypatch):
    """The state is not among the accepted ones."""
    monkeypatch.setattr("fingerpad.model.state._AT_REST", -1.0)
    body = ridge(MPI.COMM_SELF).press(height=-20e-6)
    with pytest.raises(StepFailed, match=r"\(lift\): nothing loads the body"):
        body.lift(5e-6)
    assert body.state.ridges_in_contact == 1 and body.states[-1] is body.state


def test_press_by_height_and_by_force_agree():
    """The force of the one leads the other to its height; the way of a frictionless body does not matter."""
    by_height = ridge(friction=0.0, roughness=None).press(height=-30e-6)
    by_force = ridge(friction=0.0, roughness=None).press(by_height.state.f_ext)
    assert by_force.state.bone_height == pytest.approx(-30e-6, rel=1e-6)
    assert np.isnan(by_force.state.d_eq).all()


@pytest.mark.slow
def test_load_is_a_text_with_a_unit():
    """The texts are converted in decimals, so that the loads are the same numbers."""
    text = ridge(roughness=None).press("0.0044 N/mm").slide("1 µm").state
    number = ridge(roughness=None).press(4.4).slide(1e-6).state
    assert text.bone_x == number.bone_x
    assert text.f_t == pytest.approx(number.f_t, rel=1e-12)


# -- materials, meshes -------------------------------------------------------------------------------------
def test_material_of_a_layer_by_its_name():
    """With a space or an underscore, as in a scene."""
    alone = Body(RIDGE, SKIN, contact=SPRINGS).press(height=-10e-6).state.f_ext
    for name in ("stratum corneum", "stratum_corneum"):
        by_name = Body(RIDGE, {name: SKIN}, contact=SPRINGS).press(height=-10e-6)
        assert by_name.state.f_ext == pytest.approx(alone)


# -- refusals ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda b: b.charge(100.0), "the body has no roughness, so that it has no air gap to charge"),
        (lambda b: b.press(), "press takes either f_ext, in N/m, or height, in m"),
        (lambda b: b.press(float("nan")), "f_ext is nan N/m; it must be a finite number"),
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
        ({"stratum corneum": SKIN, "bone": SKIN}, "'bone', which is no layer of the body; its layers are 'stratum c"),
        ({"stratum corneum": 5.0}, "the material of 'stratum corneum' is 5.0; it must be a Material"),
        ({}, "there is no material for the layer 'stratum corneum'"),
    ],
)
def test_materials_are_refused(material, message):
    with pytest.raises(ValueError, match=message):
        Body(RIDGE, material, contact=SPRINGS)


def test_body_has_the_insulator_of_its_roughness():
    with pytest.raises(ValueError, match="has h_0 = 5.1e-07 m, and the attraction has an effective .* of 1e-06 m"):
        Body(RIDGE, SKIN, contact=SPRINGS, roughness=BearingArea(H_0), h_0=1e-6)


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
