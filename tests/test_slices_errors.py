"""Errors of a whole finger: of the mesh, of the points of a trace, of a run's estimate, and of slices themselves."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from benchmarks import newtons
from fingerpad.report.run_page import page
from fingerpad.results.dataset import _finger as finger
from fingerpad.results.states import STATES
from fingerpad.runs.sweep_columns import row
from fingerpad.scene.parameters import Slices
from fingerpad.slices import errors
from fingerpad.slices.estimate import estimate
from fingerpad.slices.finger import WholeFinger
from fingerpad.slices.total import at_force, at_indentation, profile
from fingerpad.slices.trace import NAMES, Trace, TraceError, trace
from tests.measures import contact_state
from tests.test_slices import foundation, kept, whole

KEPT = Path(__file__).parents[1] / "docs"
FINGER = profile(Slices())


# -- below the first point, and points that are one ------------------------------------------------------
def begun(**columns) -> Trace:
    """Return a trace from 0.1 mm whose columns grow as powers of the depth between its first two points."""
    depth = 1e-4 * np.array([1.0, 2.0, 4.0])
    return Trace(depth, {name: 1e-4 * (depth / depth[0]) ** columns.get(name, 1.0) for name in NAMES})


@pytest.mark.parametrize("attraction", [0.5, 2.0])
def test_pressure_does_not_grow_without_bound_below_the_first_point(attraction):
    """A contact that shortens faster than the forces fall would bear any pressure: it falls as they do."""
    of = begun(contact_length=3.0, f_ext=1.5, f_electrostatic=attraction)
    first, below = (of.at(np.array([depth])) for depth in (1e-4, 1e-6))
    for force in ("f_ext", "f_electrostatic"):
        pressure = [float(each[force][0] / each["contact_length"][0]) for each in (first, below)]
        assert pressure[1] <= pressure[0] * (1 + 1e-9)
    fall = min(1.5, attraction)
    assert below["contact_length"][0] == pytest.approx(first["contact_length"][0] * 100**-fall, rel=1e-9)


def test_repeated_states_are_one_point():
    """Full slip under a constant force repeats itself up to the solvers' tolerances: no slope is made from those."""
    states = [
        contact_state(f_ext=force, bone_height=-depth, contact_length=depth, ridges_in_contact=1)
        for force, depth in ((1.0, 1e-4), (1 + 1e-15, 1e-4 + 1e-11), (2.0, 2e-4), (4.0, 4e-4), (4 + 1e-14, 4.00001e-4))
    ]
    of = trace(states, 5e-4)
    assert of.columns["f_ext"] == pytest.approx([1.0, 2.0, 4.0])
    assert of.at(np.array([1e-5]))["f_ext"][0] == pytest.approx(0.1, rel=1e-9), "as the force grows between 1 and 2"
    with pytest.raises(TraceError, match="2 states with growing indentation and force are no trace"):
        trace(states[:3], 5e-4)


# -- discretisation, interpolation, estimate -------------------------------------------------------------
def test_power_law_has_no_error_of_interpolation():
    """Hertz's law and others are interpolated to roundoff, below the first point as well."""
    of = foundation()
    found = errors.interpolation(FINGER, of, at_force(FINGER, of, 0.5, 24), 24)
    assert set(found) > {"f_t", "gross_area", "indentation"} and max(found.values()) < 1e-6


@pytest.mark.parametrize("points", [10, 30])
def test_interpolation_covers_a_width_that_grows_by_ridges(points):
    """A gross width that jumps by a ridge at a time, on few points beside many; on average over forces."""

    def stepped(count: int) -> Trace:
        smooth = foundation(count)
        width = 4e-4 * (1 + np.floor(smooth.columns["gross_width"] / 4e-4))
        return Trace(smooth.depth, smooth.columns | {"gross_width": width})

    coarse, fine = stepped(points), stepped(2000)
    change, known = [], []
    for force in np.geomspace(0.05, 1.5, 6):
        one, other = (at_force(FINGER, each, force, 24) for each in (coarse, fine))
        change.append(abs(one.values["gross_area"] / other.values["gross_area"] - 1))
        known.append(errors.interpolation(FINGER, coarse, one, 24)["gross_area"])
    assert np.mean(change) < np.mean(known) < 10 * np.mean(change)


def jumping(depth: np.ndarray) -> Trace:
    """Return a trace of a parabola whose attraction and width jump by a ridge at a time, smooth between."""
    columns = foundation().at(depth)
    ridges = 1 + np.floor(columns["gross_width"] / 4e-4)
    columns |= {"gross_width": 4e-4 * ridges, "f_electrostatic": 3.0 * ridges + 0.1 * columns["f_ext"]}
    return Trace(depth, columns | {"f_t": 0.25 * (columns["f_ext"] + columns["f_electrostatic"])}, ridges)


def test_error_between_points_with_known_ridges_is_that_of_where_they_jump():
    """It covers the change; points that are nearer to the jumps make it less, where leaving points out does not."""
    even = np.geomspace(2e-5, 1.5e-3, 14)
    coarse, fine = jumping(even), jumping(np.geomspace(2e-5, 1.5e-3, 3000))
    jumps = fine.depth[1:][np.diff(fine.ridges) > 0]
    jumps = jumps[jumps > 2e-4]  # nearer to the first point they are about its power law
    near = jumping(np.unique(np.concatenate([even, 0.99 * jumps, 1.01 * jumps])))
    change, known, less = list[float](), list[float](), list[float]()
    for deepest in np.linspace(5e-4, 1.2e-3, 6):
        force = at_indentation(FINGER, coarse, deepest, 48).totals["f_ext"]
        one, other, many = (at_force(FINGER, each, force, 48) for each in (coarse, fine, near))
        change.append(abs(one.values["f_t"] / other.values["f_t"] - 1))
        known.append(errors.interpolation(FINGER, coarse, one, 48)["f_t"])
        less.append(errors.interpolation(FINGER, near, many, 48)["f_t"])
        assert less[-1] < errors.interpolation(FINGER, replace(near, ridges=None), many, 48)["f_t"]
    assert np.all(np.array(change) < known) and np.mean(less) < 0.8 * np.mean(known)


def test_error_of_a_smaller_force_covers_the_trace_of_more_points():
    """Kept runs at eight forces, and every second of them with the last: forces below and between the points."""
    of = kept(200.0)
    half = of.halves()[0]
    of_half = WholeFinger({"full_slip": at_force(FINGER, half, 0.5, 48)}, "", {}, {"full_slip": half})
    for force in (0.05, 0.1, 0.3, 0.8):
        less, full = of_half.under(force), at_force(FINGER, of, force, 48)
        for key in ("f_t", "contact_area", "gross_area"):
            assert abs(less.values("full_slip")[key] - full.values[key]) <= less.error["full_slip"][key], (force, key)


def test_estimate_of_a_run_covers_the_traces_of_the_full_model():
    """Each kept estimate, with the largest errors of all."""
    found = json.loads((KEPT / "newtons.json").read_text())["numbers"]["estimates"]
    assert len(found) > 40
    for each in found:
        known = errors.ESTIMATE[each["state"]]
        for key in ("f_electrostatic", "contact_area", "gross_area", "indentation"):
            assert abs(each[key]) <= known[key], (each, key)
        borne = each["f_ext_full"] + each["f_electrostatic_full"]
        friction = known["f_electrostatic"] * each["f_electrostatic_full"] / borne
        assert each["state"] == "charged" or abs(each["f_t"]) <= friction + 1e-6, each


@pytest.mark.parametrize("share", [0.5, 0.2])
def test_estimate_under_a_smaller_force_covers_the_traces_of_the_full_model(share):
    """Read twice from a kept run at 100 N/m and 200 V, as in one go; errors grow away from its own force."""
    scenes = json.loads((KEPT / "models.json").read_text())["numbers"]["scenes"]
    press = newtons.states(scenes, "full", 0.0, "charged")[:6]
    named = {state: newtons.states(scenes, "full", 200.0, state)[5] for state in ("charged", "full_slip")}
    of = estimate(fp.Scene(f_ext=100.0), press, {"uncharged": press[-1]} | named)
    less = of.under(0.8 * of.f_ext).under(share * of.f_ext)
    assert less.error["full_slip"]["f_t"] == pytest.approx(of.under(less.f_ext).error["full_slip"]["f_t"], rel=1e-6)
    for state in named:
        values, error = less.values(state), less.error[state]
        full = at_force(FINGER, newtons.kept(scenes, "full", 200.0, state), less.f_ext, 48).values
        for key in ("f_electrostatic", "contact_area", "gross_area", "indentation"):
            assert abs(values[key] - full[key]) <= error[key], (state, key)
            assert error[key] / values[key] > of.error[state][key] / of.values(state)[key]


def test_everything_that_is_printed_and_kept_has_the_whole_error():
    """Text, table of a sweep, dataset, summary and report: of the gross area it is the interpolation's alone."""
    result = replace(fp.run(model="cylinders"), finger=whole())
    error, shown = result.finger.error["full_slip"]["gross_area"], result.finger.shown("full_slip", "gross_area")
    printed, drawn = str(result), page(result).replace("\u00a0", " ")
    assert error > 1e-7 and "±" in shown and shown in printed and shown in drawn
    words = "±: error by mesh of the cross-section, points of the traces; what the finger and"
    assert words in printed and words in drawn
    assert row(result)["full_slip_finger_gross_area_error"] == error
    assert result.to_dict()["full_slip_finger_gross_area_error"] == error
    assert float(finger(result.finger)["finger_gross_area_error"][1][STATES.index("full_slip")]) == error


# -- slices themselves -----------------------------------------------------------------------------------
SOLID = json.loads((KEPT / "solid.json").read_text())["numbers"]


def test_error_of_slices_covers_the_kept_finger_in_three_dimensions():
    """At each of its forces, and between: no narrower than both neighbours."""
    forces = [each["f_ext"] for each in SOLID]
    found = [each["area_slices_at_force"] / each["area"] - 1 for each in SOLID]
    assert len(SOLID) > 4
    for k, (force, error) in enumerate(zip(forces, found, strict=True)):
        near = [force, *([np.sqrt(force * forces[k + 1])] if k + 1 < len(SOLID) else [])]
        near += [np.sqrt(force * forces[k - 1])] if k else []
        for at in near:
            low, high = errors.known_at(at)["gross_area"]
            assert low <= error <= high


def test_error_of_slices_at_the_force_at_hand():
    """Friction from 0.1 to 1 N; gross area at other forces, of the smooth finger alone; nothing beyond all."""
    assert errors.known_at(0.5)["f_t"] == errors.known_at(0.1)["f_t"] == errors.known_at(1.0)["f_t"] == (-0.007, 0.002)
    assert errors.known_at(0.5)["gross_area"] == (0.001, 0.07)
    assert errors.known_at(0.05)["gross_area"][1] > 0.13
    assert set(errors.known_at(0.05)) == {"gross_area"} == set(errors.known_at(1.2))
    assert errors.known_at(0.01) == errors.known_at(2.0) == {}
    low, middle, none = errors.remarks([0.6, 0.05, 2.0, 0.5])
    assert "gross area +13 to +30.1 %; friction, attraction, ridge area, indentation not known." in low
    assert middle.startswith("Error of the sum of slices at 0.5, 0.6 N, beside a finger of 20 × 14 × 28 mm in three")
    assert "friction −0.7 to +0.2 %" in middle and "not known" not in middle
    assert none.endswith(": friction, attraction, gross area, ridge area, indentation not known.")
