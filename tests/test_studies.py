"""Measured findings beside ours: rules of the verdicts, on what is felt too, and fits with known answers."""

import copy

import numpy as np
import pytest

from benchmarks.feel import rules as feel_rules
from benchmarks.feel import scenes
from benchmarks.measured import rows, rules
from benchmarks.measured.rules import HIT, MISS, PART, by_factor, by_form, by_share
from benchmarks.microscale import readings
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


# -- the page of closures: what its finding has of states with a number, of upper bounds, and of ridges that adhere --
def state(mu_app, d_eq=1e-6, balanced=0.0, beyond=0.0):
    return {"mu_app": mu_app, "p_c": 5e4, "d_eq": d_eq, "area": 0.1, "balanced": balanced, "beyond": beyond}


def read(**closures):
    states = {words: {"rms": {readings.LOAD: each}} for words, each in closures.items()}
    return {each.words: each for each in readings.read({"read": states})}


def test_states_beyond_the_table_have_no_number():
    """Nor without an equilibrium: neither in a row, nor in the band, whose upper end is open."""
    found = read(soft=state(0.5), hard=state(0.7), stuck=state(0.9, beyond=1.0), lost=None)
    assert readings.span(list(found.values()), "rms")["none"] == 2
    assert found["stuck"].cells().startswith("adheres") and not found["stuck"].friction and not found["stuck"].gaps


def test_upper_bound_is_marked():
    assert read(a=state(0.5, balanced=0.2))["a"].cells().startswith("≤ 0.50")


def test_agreement_with_published_numbers():
    found = read(both=state(0.55, 2e-6), friction=state(0.6, 1e-6), gap=state(0.7, 2.4e-6), none=state(0.4, 2.6e-6))
    agree = {words: (each.friction, bool(each.gaps)) for words, each in found.items()}
    assert agree == {"both": (True, True), "friction": (True, False), "gap": (False, True), "none": (False, False)}


# -- the page on what is felt: rules of its verdicts on numbers made by hand, and what needs no finite elements ------
STEP = {
    "rise": {"RA1": 20, "f_t": 2.0, "length": 2.0, "strain": 2.0},
    "fall": {"RA1": 10, "f_t": 1.0, "length": 1.0, "strain": 1.0},
}
NUMBERS = {
    "steps": {"25": {**STEP, "rise": STEP["rise"] | {"f_t": 3.0}}, "75": STEP, "150": STEP},
    "elastic": {load: STEP for load in ("25", "75", "150")},
    "gratings": [
        {"load": load, "period": period, "f_t": 1e-3 / period, "rate": 25 / load / period, "RA1": 25 / load / period}
        for load in scenes.GRATING_LOADS
        for period in scenes.PERIODS
    ],
    "onset": {"RA1 strain": 3.0, "RA1": 2.0, "SA1": 2.0, "SA1 before": 1.0},
    "hold": {"RA1": 0, "least": 1.5, "most": 2.0},
    "subfield": {"width": 0.4e-3},
    "shear": {"vertical": 0.04, "horizontal": 0.02, "with_rotation": [0.1, 0.1]},
    "same": {law: {"charged": 100, "same": 100, "apart": 10} for law in ("SA1", "RA1")} | {"mu_app": 0.5, "sed": 0.01},
    "thresholds": {law: {"rms": bar} for law, bar in feel_rules.RMS.items()},
}
"""Every statement is just hit."""
WORSE = {
    1: ("steps", "75", "rise", "RA1", 11),
    2: ("steps", "150", "rise", "f_t", 1.01),
    3: ("steps", "25", "rise", "strain", 1.0),
    4: ("steps", "25", "rise", "f_t", 1.9),
    6: ("gratings", 1, "f_t", 1.0),
    7: ("gratings", 2, "RA1", 1e5),
    8: ("gratings", 0, "rate", 0.0),
    9: ("onset", "SA1", 2.1),
    10: ("hold", "RA1", 1),
    11: ("subfield", "width", 0.51e-3),
    12: ("shear", "horizontal", 0.021),
    13: ("same", "RA1", "apart", 11),
    14: ("thresholds", "PC", "rms", 0.31),
}
"""By statement a number that makes a miss of it."""


def test_numbers_that_are_just_hit():
    judged = feel_rules.judge(NUMBERS)
    assert [row.number for row in judged] == list(range(1, 15)) and len(judged) == len(feel_rules.STATEMENTS)
    assert {row.number: row.verdict for row in judged if row.verdict != HIT} == {5: feel_rules.OPEN}


@pytest.mark.parametrize("number", WORSE)
def test_each_rule_can_miss(number):
    """One number beyond its bar makes a miss of its own statement."""
    numbers = copy.deepcopy(NUMBERS)
    *path, key, value = WORSE[number]
    part = numbers
    for step in path:
        part = part[step]
    part[key] = value
    assert feel_rules.judge(numbers)[number - 1].verdict == MISS
