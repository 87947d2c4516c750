"""Penalty, Nitsche and augmented Lagrangian solve the same contact problems, on any number of ranks."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.cli.check import _model
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.scene import from_data
from fingerpad.scene.parameters import FORMULATIONS
from fingerpad.scene.remarks import used
from geometry.bodies import block, ridge
from geometry.mesh import load
from tests.test_contact import HEIGHT, MU_F, TOLERANCE, WIDTH, confined_stress, over
from variational.caution import Caution
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation, Springs
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.solvers.continuation import Continuation, Target

pytestmark = [pytest.mark.mpi, pytest.mark.slow]
NITSCHE = [Nitsche(10.0, 0), Nitsche(100.0, 1), Nitsche(10.0, -1)]


def make(body, formulation, mu_f=0.0, held=True) -> Continuation:
    """Return a body above the screen; with ``held`` its sides do not move sideways."""
    return over(body, mu_f, held=held, formulation=formulation).continuation


def contact_force(run: Continuation) -> float:
    return float(run.observer.ridge_loads(run.surface_state).f_contact[0])


# -- patch test ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("voltage", [0.0, 200.0])
@pytest.mark.parametrize("formulation", [*NITSCHE, AugmentedLagrangian(1.5e12, 1e11, 1e-14)], ids=repr)
def test_patch(formulation, voltage):
    """A block pressed flat bears confined compression's pressure and the attraction everywhere, without a bias.

    Tolerance: the imbalance at which solves end, 1e-9 N/m on a tenth of a millimetre, is 1e-9 of the pressure;
    the skin is on the screen to what that much bends it.
    """
    run = make(load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3)), formulation)
    run.run(Target("press", bone_height=-0.02 * HEIGHT))
    if voltage:
        run.run(Target("charge", voltage=voltage))
    np.testing.assert_allclose(run.surface_state.p_n - run.surface_state.p_el, -confined_stress(0.98), rtol=1e-8)
    assert np.abs(run.surface_state.y).max(initial=0.0) < 1e-13


# -- a formulation of one's own -------------------------------------------------------------------------
@dataclass(frozen=True)
class OneSpring(Formulation):
    """Springs of one stiffness (Pa/m) in both directions, by the recipe of CONTRIBUTING."""

    eps: float = 1.5e12

    symmetric_start: ClassVar[bool] = False

    def cautions(self) -> list[Caution]:
        return [Caution("one spring", "contact by one spring")]

    def springs(self, skin) -> Springs:
        return Springs(0.0, 0.0, skin.constant(self.eps), skin.constant(self.eps))


def test_formulation_of_one_s_own_is_a_key_of_a_scene(monkeypatch):
    """One line of the registry: scenes, refusals, the check and what a run leaves out take it from its class."""
    monkeypatch.setitem(FORMULATIONS, "one spring", OneSpring)
    scene = from_data({"contact": {"formulation": "one spring", "eps": 2e12}})
    model = FingerModel(by_rule(scene), plan(scene))
    assert model.contact == OneSpring(2e12)
    assert not model.options.symmetric_start and plan(from_data({})).symmetric_start
    assert used(scene)["contact"] == "OneSpring(eps=2e+12)" and "contact by one spring" in [*_model(scene, plan(scene))]


# -- one ridge -----------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def pressed():
    """Press one ridge by 60 um without friction; the accepted run by formulation."""
    body = load(MPI.COMM_WORLD, ridge(20e-6))

    @cache
    def press(formulation) -> Continuation:
        run = make(body, formulation)
        run.run(Target("press", bone_height=-60e-6))
        return run

    return press


@pytest.fixture(scope="module")
def exact(pressed) -> Continuation:
    """The ridge with a penetration of at most a nanometre."""
    return pressed(AugmentedLagrangian(1.5e13, 5e11, 1e-9))


def test_bias_of_the_penalty(pressed, exact):
    """The force that a penalty misses is inverse to its stiffness.

    Tolerance: the next term, and facets that touch or not; both are as small against the bias as the bias itself.
    """
    stiffness = np.array([3e11, 1.5e12, 7.5e12])
    bias = np.array([contact_force(exact) - contact_force(pressed(Penalty(eps_n, 5e10))) for eps_n in stiffness])
    np.testing.assert_allclose(np.diff(np.log(bias)) / np.diff(np.log(stiffness)), -1, atol=0.05)


@pytest.mark.parametrize("formulation", [*NITSCHE, AugmentedLagrangian(1.5e13, 5e11, 5e-9)], ids=repr)
def test_force_of_a_ridge(pressed, exact, formulation):
    """All agree in the force, on facets of 20 um that miss the limit of fine meshes by 4e-3, to a tenth of that."""
    run = pressed(formulation)
    assert contact_force(run) == pytest.approx(contact_force(exact), rel=5e-4)
    assert contact_force(run) == pytest.approx(run.solver.reaction[1], abs=100 * TOLERANCE)


# -- friction ------------------------------------------------------------------------------------------
SLIDING = [Penalty(1e11, 1e10), AugmentedLagrangian(1e12, 1e10, 5e-9), *(Nitsche(10.0, theta) for theta in (0, 1, -1))]


@cache
def slide(ranks: int, formulation) -> list:
    """Press a block whose sides are free with friction and move it sideways at constant force; states by step."""
    run = make(
        load(MPI.COMM_SELF if ranks == 1 else MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3)),
        formulation,
        MU_F,
        held=False,
    )
    steps = []

    def accept(target, part, attempt):
        steps.append((target.name, run.surface_state, run.slip, contact_force(run), run.solver.reaction.copy()))

    run.on_accept = accept
    run.run(Target("press", f_ext=2.0))
    for x in (0.2e-6, 1e-6, 4e-6, 16e-6, 64e-6, 128e-6):
        run.run(Target("slide", bone_x=x))
    return steps


# The other variants of Nitsche's method do nothing else on several ranks.
@pytest.fixture(scope="module", params=SLIDING if MPI.COMM_WORLD.size == 1 else SLIDING[:3], ids=repr)
def slid(request):
    return slide(MPI.COMM_WORLD.size, request.param)


def test_full_slip_is_the_cone(slid):
    """At the end every point slips: f_T = mu_f times the contact force. Tolerance: nodal imbalances of the solve."""
    *_, share, f_contact, reaction = slid[-1]
    assert share == (1.0, True)
    assert f_contact == pytest.approx(2.0, abs=100 * TOLERANCE)
    assert reaction[0] == pytest.approx(-MU_F * f_contact, abs=100 * TOLERANCE)


@pytest.mark.parametrize("formulation", [SLIDING[1], SLIDING[2]], ids=repr)
def test_ranks(formulation):
    """Forces by step are those of one rank, to the tolerances of solves and multipliers."""
    found, alone = (np.array([[f, *r] for *_, f, r in slide(ranks, formulation)]) for ranks in (MPI.COMM_WORLD.size, 1))
    np.testing.assert_allclose(found, alone, rtol=0, atol=1e-6)
