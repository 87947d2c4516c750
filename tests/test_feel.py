"""The page on what is felt: rules of its verdicts on numbers made by hand, and what needs no finite elements."""

import copy

import pytest

from benchmarks.feel import rules, scenes
from benchmarks.measured.rules import HIT, MISS

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
    "thresholds": {law: {"rms": bar} for law, bar in rules.RMS.items()},
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
    judged = rules.judge(NUMBERS)
    assert [row.number for row in judged] == list(range(1, 15)) and len(judged) == len(rules.STATEMENTS)
    assert {row.number: row.verdict for row in judged if row.verdict != HIT} == {5: rules.OPEN}


@pytest.mark.parametrize("number", WORSE)
def test_each_rule_can_miss(number):
    """One number beyond its bar makes a miss of its own statement."""
    numbers = copy.deepcopy(NUMBERS)
    *path, key, value = WORSE[number]
    part = numbers
    for step in path:
        part = part[step]
    part[key] = value
    assert rules.judge(numbers)[number - 1].verdict == MISS
