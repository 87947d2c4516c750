"""The error estimate on errors that are known: what it finds, and what it does not believe."""

import pytest

from fingerpad.richardson import MORE, ONCE, MeshParameter, errors, to_refine


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


def test_second_order_is_overestimated_three_times():
    """First order is taken: the whole of the last change, of which second order leaves a third."""
    assert parameter(law(2.0), 0, 1).share("q") == pytest.approx(3 * 0.1 / 16, rel=1e-12)


@pytest.mark.parametrize(("degree", "left"), [(1, 0.3), (2, 0.1), (3, 0.1)])
def test_energy_density_is_taken_for_the_order_of_strains(degree, left):
    """Half of the last change is left at first order, a quarter at second; cubic elements have no more to show for."""
    found = MeshParameter(degree=degree)
    found.record({"full_slip_sed_0": 1.3}, {"full_slip_sed_0": 1.0})
    assert found.share("full_slip_sed_0") == pytest.approx(left, rel=1e-12)


@pytest.mark.parametrize(("name", "left"), [("full_slip_f_t", 0.1 / 4), ("full_slip_sed_0", 0.1 / 4 / 3)])
def test_accidentally_small_change_is_not_believed(name, left):
    """A change of nothing at all counts as the quarter of the one before it that second order leaves."""
    found = MeshParameter()
    found.record({name: 1.1}, {name: 1.0})
    found.record({name: 1.0}, {name: 1.0})
    assert found.share(name) == pytest.approx(left, rel=1e-12)


def test_ridges_that_change_both_ways_do_not_cancel():
    """Sixteen that go up and down by 0.1, a sum that does not change: 0.4, as if their signs were random."""
    found = MeshParameter()
    found.record({"length": [1.0] * 16}, {"length": [1.1, 0.9] * 8})
    assert found.share("length") == pytest.approx(0.4, rel=1e-12)


def test_ridges_that_change_one_way_add_up():
    found = MeshParameter()
    found.record({"length": [1.0] * 16}, {"length": [1.1] * 16})
    assert found.share("length") == pytest.approx(1.6, rel=1e-12)


def test_errors_of_parameters_add_up_whatever_their_signs():
    """Two parameters of first order whose errors cancel on this mesh."""
    parameters = {"a": parameter(law(1.0, 0.1), 0), "b": parameter(law(1.0, -0.1), 0)}
    assert errors(parameters, ["q"])["q"] == pytest.approx(ONCE * 0.1, rel=1e-12)


def test_each_parameter_has_its_own_factor_of_safety():
    """Shares of 0.05, known from one change, and 0.025, from two."""
    parameters = {"a": parameter(law(1.0), 0), "b": parameter(law(1.0), 0, 1)}
    assert errors(parameters, ["q"])["q"] == pytest.approx(ONCE * 0.05 + MORE * 0.025, rel=1e-12)


def test_nothing_is_halved_within_the_tolerance():
    """The tolerance holds for the share of 0.05 with its factor of safety."""
    assert to_refine({"a": parameter(law(1.0), 0)}, {"q": ONCE * 0.0501}) == []
    assert to_refine({"a": parameter(law(1.0), 0)}, {"q": ONCE * 0.0499}) == ["a"]


@pytest.mark.parametrize(
    ("allowed", "keys"), [(0.06, []), (0.05, ["a"]), (0.031, ["a"]), (0.0101, ["a"]), (0.0095, ["b", "a"])]
)
def test_as_few_are_halved_as_will_do(allowed, keys):
    """Shares of 0.05 and 0.005 become half at first order; each may spend half of what is allowed."""
    parameters = {"b": parameter(law(1.0, 0.01), 0), "a": parameter(law(1.0, 0.1), 0)}
    assert to_refine(parameters, {"q": ONCE * allowed}) == keys
