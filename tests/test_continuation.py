"""Steps that are cut, that go over a fold, and that are given up, on a block that slides."""

import itertools

import pytest
from mpi4py import MPI

from geometry.bodies import block
from geometry.mesh import load
from tests.runs import followed
from tests.small_finger import small
from tests.test_contact import HEIGHT, MU_F, WIDTH, over
from variational.solvers import continuation
from variational.solvers.continuation import StepFailed, Target
from variational.solvers.outcome import NotConverged


@pytest.fixture
def sliding():
    """Return a function that slides a pressed block by 0.6 mm, where solves in a range of loads fail."""

    def slide(first, last, cycling=False, times=1000, each=0, but_pseudo_transient=False, jumps=False):
        run = over(load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3)), MU_F, 1e11, 1e10, held=False).continuation
        solver, run.step_scale = run.solver, 0.5  # of 60 um
        run.run(Target("press", bone_height=-2e-6))
        solve, reached = run.coupling.solve, []

        def failing(pseudo_transient=False):
            nonlocal times
            if first <= solver.control.x <= last and times > 0 and not (pseudo_transient and but_pseudo_transient):
                times -= 1
                raise NotConverged("TEST", False, cycling=cycling)
            solve(pseudo_transient)
            solver.counts.pseudo_transient += jumps and pseudo_transient
            solver.counts.factorisations += each if solver.control.x > 1e-9 else 0

        run.coupling.solve = failing
        run.run(Target("back", bone_x=-30e-6))
        run.on_accept = lambda target, part, attempt: reached.append((solver.control.x, attempt))
        run.run(Target("slide", bone_x=0.6e-3))
        return reached[1:]  # without the shorter step with which a slide begins

    return slide


def test_range_without_equilibrium_is_stepped_over(sliding):
    """Steps of 60 um lead into it; one of 90 um leads over it, is said to have, and costs one failed attempt."""
    reached = sliding(0.235e-3, 0.260e-3, cycling=True)
    assert reached[-1][0] == pytest.approx(0.6e-3)
    crossed = [(x, attempt) for x, attempt in reached if attempt.stepped_over_fold]
    assert [x for x, _ in crossed] == [pytest.approx(0.27e-3)]
    assert [len(attempt.cutbacks) for _, attempt in reached if attempt.cutbacks] == [1]
    wide = sliding(0.215e-3, 0.275e-3, cycling=True)  # halved steps go up to it, and a longer one leads over
    assert wide[-1][0] == pytest.approx(0.6e-3)
    assert sum(attempt.stepped_over_fold for _, attempt in wide) == 1


@pytest.mark.slow
@pytest.mark.parametrize("voltage", [0.0, 100.0])
def test_finger_that_was_lifted_comes_down_at_once(voltage):
    """From 1 mm above the screen in the steps of the bone's height, not in those of the first touch.

    Force control begins where skin bears the bone; the residual of a bone in the air has either sign.
    """
    press = {"name": "press", "f_ext": 1.0}
    charge = [{"name": "charge", "voltage": voltage}] if voltage else []
    loads = [press, *charge, {"name": "lift", "bone_height": 1e-3}, {"name": "again", "f_ext": 1.0}]
    scene = small().replace(history=loads)
    path = followed(scene)
    down = [state for state in path.states if state.load_number == len(loads)]
    touching = [state.load == "touch" for state in down]
    assert touching == sorted(touching, reverse=True)
    assert sum(touching) <= 30
    last = down[sum(touching) - 1]
    assert last.ridges_in_contact > 0 and -1e-5 < last.bone_height < 0
    first = next(state for state in reversed(path.states) if state.load == "press")
    if not voltage:
        assert down[-1].contact_length == pytest.approx(first.contact_length, rel=1e-3)


def test_load_of_ever_smaller_steps_is_given_up(sliding, monkeypatch):
    """Steps that stay small do not go on for ever: the message says how many there were, and where they led."""
    monkeypatch.setattr(continuation, "_MAX_STEPS_PER_LARGEST", 0)
    monkeypatch.setattr(continuation, "_MAX_FURTHER_STEPS", 7)
    with pytest.raises(StepFailed, match=r"% done\) found no equilibrium beyond .* TOO_SMALL_STEPS, 7 of them"):
        sliding(0.235e-3, 0.260e-3)


@pytest.mark.parametrize("each", [0, 100])
def test_steps_grow_again_after_a_cut(sliding, each):
    """Of 60 um, one is cut in half: the next is whole where steps are easy, the fourth where each costs a hundred."""
    places = [x for x, _ in sliding(0.235e-3, 0.245e-3, cycling=False, times=1, each=each)]
    sizes = [(b - a) / 1e-6 for a, b in itertools.pairwise(places)]
    same = 1 if each == 0 else 4
    assert sizes[:3] == pytest.approx([60, 60, 30])
    assert sizes[2 : 3 + same] == pytest.approx([30] * same + [60])
