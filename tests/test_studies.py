"""Findings on human fingers: their file, rules of the verdicts, on what is felt too, and rows with known answers."""

import copy
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.measured import __main__ as measured
from benchmarks.measured import felt, felt_rows, findings, fingers, rows, rules
from benchmarks.measured.rules import HIT, MISS, PART, by_factor, by_form, by_rule, by_share
from benchmarks.microscale import readings
from benchmarks.runs import VOLTAGES, Unfinished
from fingerpad.scene import Scene
from variational.state import ContactState


def test_rules():
    """The same for all rows of a kind; a bound belongs to the better verdict."""
    assert [by_share(share) for share in (1.0, 0.99, 0.5, 0.49)] == [HIT, PART, PART, MISS]
    assert [by_factor(*ours, 2.0, 4.0) for ours in ((2, 4), (1.9, 3), (2, 8), (0.9, 3), (3, 8.1))] == [
        HIT,
        *(PART, PART, MISS, MISS),
    ]
    assert by_factor(1.6, 1.6, 2.0, 2.0, 1.25) == HIT and by_factor(1.5, 1.5, 2.0, 2.0, 1.25) == PART


def test_every_finding_is_complete():
    """Rows that judge or that fingers are fitted to are computed, and computed rows have words."""
    every, sources = findings.read()
    assert len(every) >= 60 and len(sources) > 60
    assert {name for name, row in every.items() if row.role != "context"} <= set(measured.WORDS) <= set(every)
    assert set(measured.WORDS) == {row.id for row in measured.chosen((), every)}


def test_no_fit_judges():
    """Rows of one number in one state are not both fitted and judging."""
    every, _ = findings.read()
    fitted = {(rows.ROWS[name], row.finger) for name, row in every.items() if row.role == "fit" and name in rows.ROWS}
    judge = {(rows.ROWS[name], row.finger) for name, row in every.items() if row.role == "judge" and name in rows.ROWS}
    assert not fitted & judge


def test_contradictions_are_named_once():
    every, _ = findings.read()
    found = findings.pairs(every)
    assert {("real_sliding", "real_shear"), ("sc_hydrated", "sc_marginal")} <= {(a.id, b.id) for a, b in found}
    assert len(found) == sum(len(row.against) for row in every.values()) / 2


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('against = ["area_linear"]', "", "finding area_linear is against 'area_power', which is not against it"),
        ('unit = "mm^2"', 'unit = "mm^^2"', "unit is 'mm^^2', which is no unit of pint"),
        ("spread = 0.07\n", "", "finding share_db2 lacks a spread"),
        ('source = "maltoni"', 'source = "nobody"', "finding ridge_width has the source 'nobody'"),
        ('rule = "form"', 'rule = "none"', "finding area_power lacks a rule and judges"),
        ('rule = "bar"', 'rule = "trend"', "finding stuck_share lacks the words of its bar"),
        ('why = "presets are fitted to nearly the same number on prints"\n', "", "finding ridge_width lacks a why"),
        (
            "[source.maltoni]",
            '[source.idle]\nwords = ""\nlink = ""\n[source.maltoni]',
            "no finding has the source 'idle'",
        ),
    ],
)
def test_file_of_findings_is_refused(tmp_path, old, new, words):
    path = tmp_path / "findings.toml"
    path.write_text(findings.FILE.read_text(encoding="utf-8").replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ValueError, match=re.escape(words)):
        findings.read(path)


@pytest.mark.parametrize(
    ("name", "numbers", "verdict"),
    [
        ("friction_input", (0.07, 0.43), HIT),  # 0.25 and 1.5 times 0.125
        ("friction_input", (0.25, 0.44), MISS),
        ("gross_1n", (100, 180), HIT),
        ("gross_1n", (60, 180), PART),
        ("friction_occluded", (4, 6.25), HIT),
        ("friction_occluded", (4, 6.3), PART),
        ("skin_phase", (-60, -50), HIT),
        ("skin_phase", (50, 60), MISS),
        ("gap_sliding", (0, 3), MISS),
    ],
)
def test_rule_of_a_finding(name, numbers, verdict):
    assert by_rule(findings.read()[0][name], *numbers) == verdict


# -- rows of a finger whose states are written down ---------------------------------------------------------------
def made(force, voltage, load, share=1.0):
    """Return a state of friction 0.3 that rises with U², and of a contact length that goes as the force."""
    length, slips, borne = share * 40e-6 * force, "slip" in load, force * (1 + (voltage / 200) ** 2)
    forces = {"f_ext": force, "f_contact": borne, "f_electrostatic": borne - force, "f_t": 0.3 * borne * slips}
    more = {"load": load, "voltage": voltage, "mu_app": 0.3, "slipping": float(slips), "all_slip": slips}
    return ContactState(bone_height=-1e-4 * force**0.5, contact_length=length, ridges_in_contact=5, **forces, **more)


@pytest.fixture
def finger():
    runs = {}
    for force in fingers.FORCES:
        steps = [made(f, 0.0, "press") for f in (force / 8, force / 4, force / 2, force)]
        steps += [made(force, u, f"slip {u:g}", 0.9) for u in fingers.VOLTAGES]
        for size in fingers.SIZES:
            runs[f"slide {force:g} {1e6 * size:g}"] = SimpleNamespace(result=SimpleNamespace(steps=steps))
    return fingers.Finger(Scene(), runs)


@pytest.mark.parametrize(
    ("name", "verdict", "numbers"),
    [
        ("friction_voltage", HIT, {"low": 2.0, "high": 2.0, "holds": 4, "error": 0.0}),
        ("friction_load", HIT, {"factor": 1.0}),
        ("friction_occluded", MISS, {"factor": 1.0}),
        ("real_shear", HIT, {"low": -0.1, "high": -0.1}),
        ("real_sliding", MISS, {"holds": 0}),
        ("friction_slip", HIT, {"low": 1.0}),
        ("depth_1n", PART, {"error": 0.0}),
    ],
)
def test_row_of_a_finger(finger, name, verdict, numbers):
    """Exponents, factors and changes that the states were made with."""
    row = findings.read()[0][name]
    found, judged = rows.ROWS[name](fingers.Case(row, finger, {"fitted": finger}))
    assert judged == verdict and {key: found[key] for key in numbers} == pytest.approx(numbers, abs=1e-9)


def test_depth_of_a_whole_finger(finger):
    """F = ∫ (d/c)² dz over d = δ - z²/2R with f = (d / 0.1 mm)²: 16/15 √(2R) δ^2.5 / c²."""
    states, radius = finger.pressed, finger.scene.slices.radius
    delta = (15 / 16 * 1.0 * 1e-8 / np.sqrt(2 * radius)) ** 0.4
    assert finger.at(states, "indentation", 1.0) == pytest.approx(delta, rel=1e-6)


def test_rows_of_a_finger_that_did_not_slip(finger):
    """Two forces are too few for any row; a missing one is left out."""
    few = {name: run for name, run in finger.runs.items() if "slide 5 " not in name}
    assert replace(finger, runs=few).forces == fingers.FORCES[1:]
    with pytest.raises(Unfinished, match="full slip was reached at 2 of 4 forces"):
        _ = replace(finger, runs={name: run for name, run in few.items() if "slide 20 " not in name}).forces


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
    "viscous": {"25": {**STEP, "rise": STEP["rise"] | {"f_t": 3.0}}, "75": STEP, "150": STEP},
    "elastic": {load: STEP for load in ("25", "75", "150")},
    "gratings": [
        {"load": load, "period": period, "f_t": 1e-3 / period, "rate": 25 / load / period, "RA1": 25 / load / period}
        for load in felt.GRATING_LOADS
        for period in felt.PERIODS
    ],
    "onset": {"RA1 strain": 3.0, "RA1": 2.0, "SA1": 2.0, "SA1 before": 1.0},
    "hold": {"RA1": 0, "least": 1.5, "most": 2.0},
    "subfield": {"width": 0.4e-3},
    "shear": {"vertical": 0.04, "horizontal": 0.02, "rotated": 0.1},
    "same": {law: {"charged": 100, "same": 100, "apart": 10} for law in ("SA1", "RA1")} | {"mu_app": 0.5, "sed": 0.01},
    "thresholds": {law: (1.0, bar) for law, bar in felt_rows.RMS.items()},
}
"""Every statement is just hit."""
WORSE = {
    "rise_felt": ("viscous", "75", "rise", "RA1", 11),
    "rise_friction": ("viscous", "150", "rise", "f_t", 1.01),
    "rise_contact": ("viscous", "25", "rise", "strain", 1.0),
    "rise_low_load": ("viscous", "25", "rise", "f_t", 1.9),
    "gratings_period": ("gratings", 1, "f_t", 1.0),
    "gratings_load": ("gratings", 2, "RA1", 1e5),
    "gratings_rate": ("gratings", 0, "rate", 0.0),
    "slip_onset": ("onset", "SA1", 2.1),
    "hold_adapts": ("hold", "RA1", 1),
    "subfield": ("subfield", "width", 0.51e-3),
    "flanks": ("shear", "horizontal", 0.021),
    "same_energy": ("same", "RA1", "apart", 11),
    "nerve_thresholds": ("thresholds", "PC", (1.0, 0.31)),
}
"""By finding a number that makes a miss of it."""


@pytest.mark.parametrize("name", WORSE)
def test_each_rule_of_what_is_felt_can_miss(name):
    """One number beyond its bar makes a miss of its own finding, which is a hit without."""
    numbers = copy.deepcopy(NUMBERS)
    assert felt_rows.ROWS[name](numbers)[1] == HIT
    *path, key, value = WORSE[name]
    part = numbers
    for step in path:
        part = part[step]
    part[key] = value
    assert felt_rows.ROWS[name](numbers)[1] == MISS
