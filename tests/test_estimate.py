"""The error estimate on errors that are known: what it finds, and what it does not believe."""

import pytest

from fingerpad.accuracy.richardson import ONCE, ORDER, MeshParameter, errors, rigid, to_refine
from fingerpad.model.schedule import loads_to_normal_contact
from fingerpad.scene import SceneError, from_data


def law(order: float, c: float = 0.1):
    """Return q over how often the size was halved: 1 + c h^order."""
    return lambda n: {"q": 1 + c * 2 ** (-order * n)}


def parameter(q, *at: int) -> MeshParameter:
    """Return a parameter that was halved from each of these on."""
    found = MeshParameter()
    for n in at:
        found.record(q(n), q(n + 1))
    return found


@pytest.mark.parametrize("at", [(0,), (0, 1), (0, 1, 2)])
def test_first_order_is_found_exactly(at):
    """What is left at the size in use. Roundoff of a difference of ones."""
    assert parameter(law(1.0), *at).share("q") == pytest.approx(0.1 / 2 ** (at[-1] + 1), rel=1e-12)


@pytest.mark.parametrize(("name", "left"), [("full_slip_f_t", 0.1 / 4), ("full_slip_sed_0", 0.1 / 4 / 3)])
def test_accidentally_small_change_is_not_believed(name, left):
    """A change of nothing at all counts as the quarter of the one before it that second order leaves."""
    found = MeshParameter()
    found.record({name: 1.1}, {name: 1.0})
    found.record({name: 1.0}, {name: 1.0})
    assert found.share(name) == pytest.approx(left, rel=1e-12)


@pytest.mark.parametrize(("after", "left"), [([1.1, 0.9] * 8, 0.4), ([1.1] * 16, 1.6)])
def test_ridges_that_change_both_ways_do_not_cancel(after, left):
    """Sixteen that go up and down by 0.1, a sum that does not change: 0.4, as if their signs were random."""
    found = MeshParameter()
    found.record({"length": [1.0] * 16}, {"length": after})
    assert found.share("length") == pytest.approx(left, rel=1e-12)


def test_errors_of_parameters_add_up_whatever_their_signs():
    """Two parameters of first order whose errors cancel on this mesh."""
    parameters = {"a": parameter(law(1.0, 0.1), 0), "b": parameter(law(1.0, -0.1), 0)}
    assert errors(parameters, ["q"])["q"] == pytest.approx(ONCE * 0.1, rel=1e-12)


@pytest.mark.parametrize(
    ("allowed", "keys"), [(0.06, []), (0.05, ["a"]), (0.031, ["a"]), (0.0101, ["a"]), (0.0095, ["b", "a"])]
)
def test_as_few_are_halved_as_will_do(allowed, keys):
    """Shares of 0.05 and 0.005 become half at first order; each may spend half of what is allowed."""
    parameters = {"b": parameter(law(1.0, 0.01), 0), "a": parameter(law(1.0, 0.1), 0)}
    assert to_refine(parameters, {"q": ONCE * allowed}) == keys


# -- what a penalty changes ------------------------------------------------------------------------------------------
def test_law_is_extrapolated_exactly():
    """To roundoff."""

    def q(eps):
        return 1 + 0.3 * eps**-ORDER

    assert rigid({"q": q(4.0)}, {"q": q(8.0)})["q"] == pytest.approx(1 - q(4.0), rel=1e-12)


def test_scene_that_asks_starts_coarse_where_it_gives_no_size():
    mesh = from_data({"accuracy": {"mu_app": 0.01}, "mesh": {"growth": 0.3}}).mesh
    assert (mesh.contact, mesh.growth, mesh.receptor) == (20e-6, 0.3, 40e-6)
    assert from_data({"accuracy": {"sed": 0.01}}).mesh.receptor == 10e-6, "coarser sites do not see the tips"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"accuracy": {"mu_app": 1.5}}, "accuracy.mu_app is 1.5; it must be from 1e-06 to 0.5"),
        ({"accuracy": {}}, "accuracy is empty; give at least one of accuracy.mu_app, accuracy.f_t"),
        (
            {"accuracy": {"sed": 0.1}, "output": {"receptors": False}},
            "accuracy.sed is 0.1 and output.receptors is false, without which there are no sites",
        ),
        (
            {"accuracy": {"f_t": 0.1}, "friction": 0},
            "accuracy.f_t is 0.1 and friction is 0, with which the quantity is zero and has no relative accuracy",
        ),
        (
            {"accuracy": {"f_t": 0.1}, "history": [{"name": "Full_slip", "f_ext": 1.0}]},
            "history.0..name is 'Full_slip', and the state of that name has files of its own; take another name",
        ),
    ],
)
def test_impossible_accuracy_is_refused(given, words):
    with pytest.raises(SceneError, match=words):
        from_data(given)


@pytest.mark.parametrize(
    ("places", "kept"),
    [
        ((None, None, 1e-3), 2),
        ((2e-3, None, 3e-3), 2),
        ((2e-3, 2e-3, 1e-3), 2),
        ((2e-3, 3e-3, 4e-3), 1),
        ((None, None, {"waveform": "file", "times": [0, 1, 2], "values": [0, 1e-3, 0]}), 2),  # there and back
        ((None, None, None, 2e-3, None, 3e-3), 5),
    ],
)
def test_loads_to_normal_contact(places, kept):
    """A way through the air is none; a bone that is pressed and moved in one load slides in that load."""
    loads = [{"name": "away", "bone_height": 1e-5}, {"name": "press", "f_ext": 1.0}, {"name": "slide"}]
    if len(places) > 3:
        loads[2:] = [{"name": "lift", "bone_height": 1e-5}, {"name": "over"}, {"name": "again", "f_ext": 1.0}, loads[2]]
    moves = [{} if place is None else {"bone_x": place} for place in places]
    scene = from_data({"history": [load | move for load, move in zip(loads, moves, strict=True)]})
    assert loads_to_normal_contact(scene.loads()) == scene.history[:kept]
