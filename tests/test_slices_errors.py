"""Errors of a whole finger: of mesh, points of a trace and its correction, a run's estimate, and slices."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.report.run_page import page
from fingerpad.results.dataset import _finger as finger
from fingerpad.results.states import STATES
from fingerpad.runs.sweep_columns import row
from fingerpad.scene.parameters import Slices
from fingerpad.slices import errors
from fingerpad.slices.correction import Pair, corrected, correction_errors, mesh_errors
from fingerpad.slices.total import at_force, at_indentation, profile
from fingerpad.slices.trace import NAMES, Trace, TraceError, trace
from tests.measures import contact_state
from tests.test_slices import foundation, whole
from variational.state import ContactState, RidgeStates

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


# -- a trace corrected by states on a finer mesh: what is exact at these states, and its two errors ------------------
WAVELENGTH, MU_0 = 0.48e-3, 0.25
FORCES = np.geomspace(1.0, 100.0, 9)
FINGER, COUNT, FORCE = profile(Slices()), 24, 0.4
FACETS = 16e-6, 1e-6


def state(f_ext: float, attraction: float = 1.0, longer: float = 1.0, lower: float = 1.0, f_t: float = 1.0):
    """Return a section by power laws of the force, times factors; two ridges bear it."""
    f_el, length = attraction * 10.0 * f_ext**0.5, longer * 1e-4 * f_ext**0.6
    ridges = RidgeStates(np.array([0, 1]), length * np.array([0.7, 0.3]), *(np.zeros(2) for _ in range(5)))
    return ContactState(
        f_ext=f_ext, voltage=200.0, f_t=f_t * MU_0 * (f_ext + f_el), mu_app=0.0, f_contact=f_ext + f_el,
        f_electrostatic=f_el, ridges_in_contact=2, contact_length=length, bone_height=-lower * 1e-4 * f_ext**0.5,
        ridges=ridges,
    )  # fmt: skip


def of(*factors: float):
    return trace([state(force, *factors) for force in FORCES], WAVELENGTH)


def test_constant_ratios_are_taken_away():
    """A coarse mesh that is wrong by one factor a quantity gives the trace of the fine one, by any of its states."""
    fine = of()
    for at in (FORCES[2], FORCES[-1]):
        pair = Pair(state(at, 1.02, 0.97, 0.99), state(at), FACETS)
        found = corrected(of(1.02, 0.97, 0.99), [pair], WAVELENGTH)
        assert found.depth == pytest.approx(fine.depth, rel=1e-12)
        for name, values in fine.columns.items():
            exact = 2e-2 if name == "gross_width" else 1e-12  # of ridges that are counted, and a length
            assert found.columns[name] == pytest.approx(values, rel=exact), name


def test_two_states_are_met_and_ratios_go_evenly_between():
    """In the logarithm of the force; friction stays Coulomb's of the contact force."""
    ratios = (FORCES[2], 0.04), (FORCES[6], 0.02)
    coarse, pairs = of(), [Pair(state(at), state(at, 1 + more), FACETS) for at, more in ratios]
    found = corrected(coarse, pairs, WAVELENGTH)
    ratio = found.columns["f_electrostatic"] / coarse.columns["f_electrostatic"]
    assert ratio == pytest.approx(1 + 0.01 * np.array([4, 4, 4, 3.5, 3, 2.5, 2, 2, 2]), rel=1e-12)
    borne = found.columns["f_ext"] + found.columns["f_electrostatic"]
    assert found.columns["f_t"] == pytest.approx(MU_0 * borne, rel=1e-12)


def test_error_of_the_mesh_is_that_of_two_meshes():
    """Twice the change over r^p - 1: of first order in the facets at the ends for lengths, else p = 2 in all elements.

    The change of a length is at least the root of the ridges' squared ones.
    """
    pair = Pair(state(50.0, longer=0.98, lower=1.01), state(50.0), FACETS)
    found = mesh_errors(pair, WAVELENGTH)
    assert found["contact_area"] == pytest.approx(0.04 / (16 - 1), rel=1e-9)
    assert found["indentation"] == pytest.approx(0.02 / 3, rel=1e-9)
    assert mesh_errors(pair, WAVELENGTH, 1)["indentation"] == pytest.approx(0.02, rel=1e-9)
    ridges = replace(pair.fine.ridges, length=pair.fine.ridges.length[::-1].copy())
    turned = mesh_errors(Pair(pair.fine, replace(pair.fine, ridges=ridges), FACETS), WAVELENGTH)
    assert turned["contact_area"] == pytest.approx(2 * 0.4 * 2**0.5 / (16 - 1), rel=1e-9)
    bare = mesh_errors(Pair(state(50.0, 0.0), state(50.0, 0.0), FACETS), WAVELENGTH)
    assert set(bare) == {*found} - {"f_electrostatic"}
    still = Pair(state(50.0, f_t=0.0), replace(state(50.0), f_t=1e-13), FACETS)
    assert not {"f_t", "mu_app"} & set(mesh_errors(still, WAVELENGTH)), "roundoff is no friction"


def test_error_of_the_correction_is_what_other_states_change():
    """Of one state, all that it changes; of more, what the sum changes without one of them but the last."""
    coarse, one = of(), Pair(state(FORCES[6]), state(FORCES[6], 1.02), FACETS)
    found = correction_errors(FINGER, coarse, [one], WAVELENGTH, FORCE, COUNT)
    sums = [at_force(FINGER, each, FORCE, COUNT).values for each in (corrected(coarse, [one], WAVELENGTH), coarse)]
    assert found["f_electrostatic"] == pytest.approx(1 - sums[1]["f_electrostatic"] / sums[0]["f_electrostatic"])
    assert found["f_electrostatic"] == pytest.approx(0.02, rel=0.03)
    same = Pair(state(FORCES[2]), state(FORCES[2], 1.02), FACETS)
    assert max(correction_errors(FINGER, coarse, [same, one], WAVELENGTH, FORCE, COUNT).values()) < 1e-12
    other = Pair(state(FORCES[2]), state(FORCES[2], 1.04), FACETS)
    found = correction_errors(FINGER, coarse, [other, one], WAVELENGTH, FORCE, COUNT)
    assert 0.001 < found["f_electrostatic"] < 0.02
