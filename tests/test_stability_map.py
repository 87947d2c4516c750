"""The stability map: its plan, its kept runs, single runs of a coarse strip, and the page drawn from their numbers."""

from argparse import Namespace
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.stability import plan, solve
from benchmarks.stability.__main__ import outcomes
from benchmarks.stability.plan import Case
from variational.solvers.equations import Control
from variational.solvers.newton import Solver

pytestmark = pytest.mark.slow

# A press of half an newton a metre on facets of 60 um: two seconds a run.
TINY = Case(contact_size=60e-6, force=0.5, voltage=50.0, element="P1", slide=0.0)
IRRECOVERABLE = replace(TINY, parameter=1.5e24)


@pytest.fixture(scope="module")
def panel() -> plan.Panel:
    x = plan.Axis("voltage", "voltage (V)", (0.0, 50.0))
    y = plan.Axis("contact_size", "contact size (µm)", (60e-6,), 1e-6)
    return plan.Panel("penalty", TINY, x, y)


@pytest.fixture(scope="module")
def tiny(panel, tmp_path_factory):
    """The outcomes of the panel's runs, and of one that fails; all are kept."""
    given, cases = options(tmp_path_factory.mktemp("stability")), [*panel.cases(), IRRECOVERABLE]
    found = outcomes(cases, given)
    assert set(found) == set(cases) and outcomes(cases, options(given.out, hours=0.0)) == found
    return found


def options(out, limit=300.0, hours=1.0):
    """Return the options of the command."""
    return Namespace(out=out, jobs=2, limit=limit, hours=hours)


# -- the plan ------------------------------------------------------------------------------------------


def test_default_is_the_products():
    """The map's default is what a scene has by default."""
    from fingerpad.scene import Scene

    scene, case = Scene(), plan.DEFAULT
    assert case.parameter == scene.contact.eps_n
    assert case.contact_size == scene.mesh.contact and case.contact_size in plan.SIZE.values
    assert (case.element, case.voltage, case.mu_f) == (scene.numerics.element, scene.voltage, scene.friction)
    assert case.nu == scene.materials.dermis.poisson


# -- runs that are kept ------------------------------------------------------------------------------
def test_tiny_map_converges(tiny, panel):
    """Pressed by half a newton a metre the ridge bears it, whatever the voltage. Tolerance: the solve's."""
    for case in panel.cases():
        found = tiny[case]
        assert found.status == "converged"
        assert found.f_ext == pytest.approx(0.5, rel=1e-7)
        assert found.newton >= found.steps > 1
        assert found.contact_length > 0 < found.penetration


def test_friction_at_full_slip(tmp_path):
    """Without voltage the screen drags with mu_0 times the force. Tolerance: the solve's."""
    case = replace(TINY, voltage=0.0, slide=1e-3)
    found = outcomes([case], options(tmp_path))[case]
    assert found.full_slip
    assert found.f_t == pytest.approx(0.25 * 0.5, rel=1e-6)


@pytest.mark.parametrize("sides", ["carried", "free"])
def test_strip_off_the_screen_follows_the_bone(sides):
    """Lifted and moved sideways without touching, all of it translates alike, lateral faces included."""
    body = solve.make(replace(TINY, sides=sides))
    body.solver.control = Control(5e-6, 2e-6)
    body.solver.solve()
    nodes = body.problem.V.dofmap.index_map.size_local
    np.testing.assert_allclose(body.problem.displacement(), [[5e-6, 2e-6]] * nodes)


def test_failure_is_recorded_with_its_reason(tiny):
    """A penalty 1e8 times the default leaves no digits: the run says by which name and in which load it ended."""
    found = tiny[IRRECOVERABLE]
    assert found.status == "failed"
    assert found.reason.startswith("DIVERGED_")
    assert found.reason in found.message
    assert found.load == "press"
    assert found.cutbacks >= 0 < found.newton


@pytest.mark.parametrize("allowed", [True, False])
def test_newton_alone_is_never_pseudo_transient(monkeypatch, allowed):
    """Of every solve of a path with voltage, also where a later iteration of the loop finds no equilibrium."""
    asked, newton = set(), Solver.solve

    def solve_and_note(self, pseudo_transient=False, *more, **how):
        asked.add(pseudo_transient)
        newton(self, pseudo_transient, *more, **how)

    monkeypatch.setattr(Solver, "attempt", lambda self, stop: False)
    monkeypatch.setattr(Solver, "solve", solve_and_note)
    solve.run(replace(TINY, pseudo_transient=allowed))
    assert asked == {allowed, False}


def test_time_limit(tmp_path):
    """A run that takes too long is stopped and reported so: steps of a billionth never end on any machine."""
    (found,) = outcomes([replace(TINY, step_scale=1e-9)], options(tmp_path, limit=1)).values()
    assert (found.status, found.reason, found.seconds) == ("failed", "TIME_LIMIT", 1)
