"""Measured findings beside ours: rules of the verdicts, fits with known answers, and what the page claims in words."""

import numpy as np
import pytest

from benchmarks.measured import rows, rules
from benchmarks.measured.rules import HIT, MISS, PART, by_factor, by_form, by_share
from benchmarks.runs import VOLTAGES


def test_rules():
    """The same for all rows of a kind; a bound belongs to the better verdict."""
    assert [by_share(share) for share in (1.0, 0.99, 0.5, 0.49)] == [HIT, PART, PART, MISS]
    assert [by_factor(*ours, 2.0, 4.0) for ours in ((2, 4), (1.9, 3), (2, 8), (0.9, 3), (3, 8.1))] == [
        HIT,
        *(PART, PART, MISS, MISS),
    ]
    assert by_factor(1.6, 1.6, 2.0, 2.0, 1.25) == HIT and by_factor(1.5, 1.5, 2.0, 2.0, 1.25) == PART


def test_exponents_of_a_power():
    """U² and U³ over any base, each force by itself."""
    u = np.array(VOLTAGES)
    values = np.array([5 + 0.3 * u**2, 1e-3 + 1e-9 * u**3])
    assert rows.exponents(values, VOLTAGES[1:4]) == pytest.approx([2.0, 3.0], abs=1e-9)


@pytest.mark.parametrize(
    ("misfits", "others", "verdict"),
    [
        ((0.1,), (0.11,), HIT),
        ((0.05,), (0.1,), PART),
        ((0.11,), (0.0,), MISS),
        ((0.05, 0.05), (0.05, 0.2), HIT),
        ((0.05, 0.11), (0.05, 0.05), PART),
    ],
)
def test_form_has_to_fit_and_another_not_to(misfits, others, verdict):
    """Where another form with as many parameters fits too, the curve does not show which form it has."""
    assert by_form(misfits, others) == verdict


@pytest.mark.parametrize("fit", [rules.of_each, rules.of_largest])
@pytest.mark.parametrize(("form", "parameter"), [(rules.exponential, 4.0), (rules.power, 2.2), (rules.line, 0.3)])
def test_forms_find_their_own_curves(form, parameter, fit):
    """The parameter comes back at any scale, and nothing is left."""
    x = np.linspace(0.1e-3, 1e-3, 8)
    found = fit(form, x, 3e4 * form(x, parameter))
    assert found.parameter == pytest.approx(parameter, rel=1e-4) and found.misfit < 1e-4
