"""Newtons from runs: at their ends for nothing, from traces of the full model, and on three meshes."""

import re
from dataclasses import replace
from itertools import combinations

import pytest

import fingerpad as fp
from fingerpad.report import run_page, trust
from fingerpad.report.page import GOOD
from fingerpad.results.quantities import FINGER
from fingerpad.runs.solve import find
from fingerpad.scene import SceneError, load
from fingerpad.slices.errors import COARSE
from fingerpad.slices.estimate import with_newtons
from tests.runs import no_pictures
from tests.small_finger import small

pytestmark = pytest.mark.slow
SMALL = {"output": {"receptors": False, "errors": False}, "slices": {"radius": 6e-3, "length": 8e-3}}
FORCE = 2e-3  # N


@pytest.fixture(scope="module")
def traced(tmp_path_factory) -> fp.Result:
    """The small finger under a force in newtons, by traces of the full model, from its files."""
    folder = tmp_path_factory.mktemp("newtons")
    with no_pictures():
        fp.run(small(**SMALL).replace(force=f"{1e3 * FORCE} mN"), out=folder)
    return fp.Result.load(folder)


@pytest.fixture(scope="module")
def ran() -> fp.Result:
    return fp.run(small(**SMALL))


def test_force_is_the_one_asked_for(traced):
    """In each state, whose friction at full slip is Coulomb's of the sum. Tolerance: Newton's."""
    sums = {name: total.totals for name, total in traced.finger.states.items()}
    assert list(sums) == ["uncharged", "charged", "full_slip"]
    assert all(each["f_ext"] == pytest.approx(FORCE, rel=1e-9) for each in sums.values())
    slip = sums["full_slip"]
    assert slip["f_t"] == pytest.approx(0.25 * (slip["f_ext"] + slip["f_electrostatic"]), rel=1e-6)


def test_files_have_the_finger(traced):
    """Sums and slices in result.nc, and both pictures; the report begins with one, and no load has an empty cell."""
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(traced.folder / "result.nc", engine="scipy") as data:
        slip = data.sel(state="full_slip")
        total = float((slip.slice_thickness * slip.slice_f_ext).sum())
        assert total == pytest.approx(float(slip.finger_f_ext), rel=1e-12)
        assert data.finger_gross_area.attrs["units"] == "m^2"
    there = {file.name for file in traced.folder.iterdir()}
    assert {"footprint.png", "solid.png"} <= there and "checkpoint" not in there
    page = run_page.page(traced)
    first, _, rest = page.partition("<nav>")
    assert "<img" in first and "The finger in three dimensions" in first and "Gross contact" in rest
    assert "The whole finger, in newtons" in rest and "The finger in three dimensions" not in rest
    assert "What was asked" in rest and "state at its end" not in rest


def test_named_states_are_the_section_at_the_centre(traced):
    """As its trace has it between its points: under the centre's force. Tolerance of friction: Newton's."""
    for name, total in traced.finger.states.items():
        state, at = traced.named[name], total.depth.argmax()
        assert state.f_ext == pytest.approx(total.centre, rel=1e-9)
        assert state.contact_length == pytest.approx(total.columns["contact_length"][at], rel=0.02)
        assert state.bone_height == pytest.approx(-total.delta, rel=1e-9)
    slip = traced.full_slip
    assert slip.f_t == pytest.approx(0.25 * (slip.f_ext + slip.f_electrostatic), rel=1e-6)
    assert not traced.steps and traced.scene.force == FORCE


def test_stability_of_the_section_is_examined(traced):
    """In all its states, on the scene's own mesh; so the report of a sound run of a force has no caution on it."""
    assert all(state.stable and state.lambda_min > 0 for state in traced.named.values())
    found = {finding.what: finding for finding in trust.findings(traced)}
    assert found["stability"].verdict == GOOD and "full slip of the middle section" in found["stability"].words


def test_run_has_newtons_for_nothing(ran):
    """The run's own states at the centre, and less beside it; F_ext over f_ext is no constant of 20 mm."""
    finger = ran.finger
    assert set(finger.states) == {"uncharged", "charged", "full_slip"}
    slip = finger.states["full_slip"]
    assert slip.centre <= ran.full_slip.f_ext * (1 + 1e-9)
    assert slip.mu_app > ran.full_slip.mu_app
    assert "Whole finger" in str(ran)
    turned = [replace(state, f_t=-1e-15) if state.load == "press" else state for state in ran.steps]
    again = with_newtons(replace(ran, steps=tuple(turned), finger=None)).finger
    assert again.states["full_slip"].totals == slip.totals, "sideways roundoff leaves no state of the press out"


def test_estimate_by_another_law_has_the_friction_of_the_run():
    """Its limit is per reference area, and the slices' forces are spread over current lengths."""
    run = fp.run(small(f_ext=600.0, friction=fp.Derjaguin(0.1, 1e4), **SMALL))
    assert run.finger.traces["full_slip"].columns["f_t"][-1] == pytest.approx(run.full_slip.f_t, rel=1e-12)


@pytest.mark.parametrize("name", ["uncharged", "charged", "full_slip"])
def test_trace_of_the_closed_form_is_scene_by_scene(name):
    """Points that are computed together are those of one scene after the other, to the tolerance of roots."""
    scene = fp.Scene(voltage=120.0)
    found = fp.run(scene.replace(force=0.3), model="cylinders").finger.traces[name]
    kind, voltage = ("full_slip" if name == "full_slip" else "charged"), (0.0 if name == "uncharged" else 120.0)
    for k, f_ext in enumerate(found.columns["f_ext"]):
        state = fp.run(scene.replace(f_ext=float(f_ext), voltage=voltage), model="cylinders").named[kind]
        for key in ("f_t", "f_electrostatic", "contact_length"):
            assert found.columns[key][k] == pytest.approx(getattr(state, key), rel=1e-11, abs=0)


class Stop(Exception):
    """Stops at the first scene."""


def test_least_force(tmp_path):
    """Every scene of its traces is one that can be run; where that of the centre is none, the force is named."""
    given = []

    def solve(scene):
        given.append(scene)
        raise Stop

    with pytest.raises(Stop):
        find("cylinders").whole(fp.Scene(force=1e-5), solve)
    assert all(load.f_ext >= 1e-3 for scene in given for load in scene.loads() if load.f_ext is not None)
    finger = fp.run(fp.Scene(force=1e-5), model="cylinders").finger
    assert finger.states["full_slip"].totals["f_ext"] == pytest.approx(1e-5, rel=1e-9)
    straight = fp.Scene(force=1e-5, slices={"z": [-50e-3, 50e-3], "height": [0.0, 0.0]})
    with pytest.raises(SceneError, match=r"^force is 1e-05 N, under which the centre of the finger bears 0.0001 N/m"):
        fp.run(straight, model="cylinders")


@pytest.mark.parametrize(
    ("other", "words"),
    [
        ({"f_ext": "50 N/m"}, "force is 0.5 N and f_ext is 50 N/m; give one of the two"),
        ({"history": [{"name": "press", "f_ext": 1.0}]}, "force is 0.5 N and history is given; a force on the whole"),
    ],
)
def test_force_is_exclusive(tmp_path, other, words):
    """Beside another load or mesh it is refused; a change to one of two loads replaces the other."""
    with pytest.raises(SceneError, match=re.escape(words)):
        fp.Scene(force="0.5 N", **other)
    assert fp.Scene(force=0.5).replace(f_ext=20.0) == fp.Scene(f_ext=20.0)
    assert fp.Scene(f_ext=20.0).replace(force=0.5) == fp.Scene(force=0.5)
    file = tmp_path / "scene.toml"
    file.write_text("f_ext = 20", encoding="utf-8")
    assert load(file, {"force": "0.5 N"}) == fp.Scene(force=0.5)
    assert "f_ext" not in fp.Scene(force=0.5).parameters() and "force" not in fp.Scene().parameters()


def test_profile_that_does_not_fit_costs_a_note_alone():
    """A run whose contact is longer than the finger keeps its results."""
    scene = small(**SMALL).replace(slices={"radius": 1.0, "length": 1e-3})
    result = fp.run(scene)
    assert result.finger is None and any(
        "no newtons of the whole finger: the finger ends at z" in note for note in result.notes
    )


# -- the whole finger on three meshes: every row of its table, in every state, within the errors that are printed ----
SIZES = (20e-6, 10e-6, 5e-6)  # m
SHAPE = {"radius": 6e-3, "length": 8e-3}
ROUNDOFF = 1e-8
LOADS = {
    "three ridges": {"f_ext": 4.0},
    "one ridge": {"f_ext": 0.5},
    "force": {"force": 2e-3},
}


@pytest.fixture(
    scope="module",
    params=["three ridges", *(pytest.param(name, marks=pytest.mark.long) for name in ("one ridge", "force"))],
)
def runs(request) -> list[fp.Result]:
    """The small finger at 100 V with three contact sizes: under 4 and 0.5 N/m, and under a force."""
    load = LOADS[request.param]
    return [fp.run(small(slices=SHAPE).replace(**load, mesh={"contact": size})) for size in SIZES]


def test_all_rows_differ_by_no_more_than_their_errors(runs):
    """Each pair of meshes, by the sum of the two errors; without any tolerance but that of roots."""
    fingers, missed = [run.finger for run in runs], []
    for one, other in combinations(fingers, 2):
        assert list(one.states) == ["uncharged", "charged", "full_slip"]
        for name in one.states:
            for key in FINGER.keys() & one.values(name).keys():
                mine, its = one.values(name)[key], other.values(name)[key]
                known = one.error[name].get(key, 0.0) + other.error[name].get(key, 0.0)
                if abs(mine - its) > known + ROUNDOFF * abs(its):
                    missed.append((name, key, mine, its, known))
    assert missed == []


def test_part_of_the_coarser_mesh_falls(runs):
    """Of the area in contact, by half or more from 20 to 5 µm: it covers, and it informs."""
    for name in runs[0].finger.states:
        first, last = (run.finger.carried[name][COARSE]["contact_area"] for run in (runs[0], runs[-1]))
        assert last < 0.5 * first, name


def test_traces_end_in_the_states_of_the_section(runs):
    """Of a run in N/m: as they are on the final mesh, without voltage too."""
    for run in runs:
        for name, state in run.named.items() if run.scene.force is None else ():
            end = run.finger.traces[name]
            assert end.columns["contact_length"][-1] == pytest.approx(state.contact_length, rel=1e-12)
            assert end.depth[-1] == pytest.approx(-state.bone_height, rel=1e-12)
