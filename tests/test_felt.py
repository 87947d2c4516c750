"""Spikes of a run over time: stimuli at its sites by symmetry and translation, jumps, tables, and what is refused."""

import csv
import shutil
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.afferents.afferent import Afferent
from fingerpad.cli import main
from fingerpad.model.stimuli import SiteStimuli
from fingerpad.report import run_page
from fingerpad.results.result import Result
from fingerpad.results.spikes import COLUMNS
from fingerpad.scene import Scene, SceneError, from_data
from tests.browser import SIZES, asked
from tests.runs import path_of
from tests.small_finger import NINE
from variational.state import ContactState, Sites, Stimuli

PRESS = {"name": "press", "f_ext": 4.0, "duration": 0.02}
HOLD = {"name": "hold", "bone_x_by": 0.0, "duration": 0.05}
SLIDE = {"name": "slide", "bone_x": 400e-6, "speed": 20e-3}
FIELDS = ("merkel_stress", "meissner_stress_left", "meissner_stress_right", "pacinian_stress")


def scene(*loads: dict, **more) -> Scene:
    mesh = NINE["mesh"] | {"contact": 60e-6}
    return from_data(NINE | {"mesh": mesh, "output": {"errors": False, "each_load": False}, "history": loads} | more)


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Result:
    """A small finger that is pressed, held and slid, in its folder."""
    place = None if MPI.COMM_WORLD.size > 1 else tmp_path_factory.mktemp("felt") / "run"
    return fp.run(scene(PRESS, HOLD, SLIDE, numerics={"step_scale": 0.5}), out=place)


# -- stimuli ---------------------------------------------------------------------------------------------------------
@pytest.mark.mpi
def test_stimuli_of_a_press_are_symmetric(run):
    """Sites of ridges j and -j, left and right. Tolerance: the mesh is its own mirror image, its solves end at 1e-8."""
    stimuli = next(state for state in reversed(run.steps) if state.load == "hold").stimuli
    assert stimuli.merkel_stress == pytest.approx(stimuli.merkel_stress[::-1], rel=1e-5)
    assert stimuli.meissner_stress_left == pytest.approx(stimuli.meissner_stress_right[::-1], rel=1e-5)
    assert stimuli.surface_strain_left == pytest.approx(stimuli.surface_strain_right[::-1], rel=1e-5, nan_ok=True)
    touching = np.isfinite(stimuli.surface_strain_left)
    assert touching.sum() >= 3
    assert stimuli.surface_strain_left[stimuli.number == 0] < 0 < stimuli.pacinian_stress[stimuli.number == 0]


@pytest.mark.mpi
def test_stimuli_do_not_depend_on_the_half(run):
    """A press on one half of the finger has the stimuli of that on the whole, up to the solves' tolerance."""
    half = fp.run(scene(PRESS, numerics={"step_scale": 0.5}))
    one, other = half.steps[-1].stimuli, next(s for s in reversed(run.steps) if s.load == "press").stimuli
    for name in (*FIELDS, "surface_strain_left", "surface_strain_right"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-4, abs=1e-6, nan_ok=True)


@pytest.mark.mpi
def test_stimuli_of_a_homogeneous_deformation():
    """Closed forms of small strains at the sites, and of the skin when all lengths grow by a part.

    Tolerances: strains of 4e-6 are nonlinear by 1e-4 of themselves at most; facets are stretched exactly.
    """
    skin = scene(PRESS)
    finger = path_of(skin).finger
    x, y = -1e-6, -3e-6
    finger.problem.w.interpolate(lambda place: np.stack([x * place[0], y * place[1]]))
    stimuli = SiteStimuli(finger).present()
    for name, layer in zip(FIELDS, ("viable_epidermis", "dermis", "dermis", "subcutis"), strict=True):
        of = getattr(skin.materials, layer)
        lame = 2 * of.shear_modulus * of.poisson / (1 - 2 * of.poisson)
        stress = 2 * of.shear_modulus * y + lame * (x + y)
        assert getattr(stimuli, name) == pytest.approx(-stress, rel=1e-3), layer
    finger.problem.w.interpolate(lambda place: 0.01 * place[:2])
    finger.continuation.surface_state = finger.observer.state()
    stimuli = SiteStimuli(finger).present()
    for strain in (stimuli.surface_strain_left, stimuli.surface_strain_right):
        assert strain[np.isfinite(strain)] == pytest.approx(0.01, rel=1e-9) and np.isfinite(strain).sum() >= 3


def test_full_slip_has_constant_stimuli(run):
    """The screen is the same everywhere, so a finger in full slip changes no more."""
    slip = [state for state in run.steps if state.load == "slide" and state.all_slip]
    assert len(slip) >= 2
    for name in FIELDS:
        assert getattr(slip[-1].stimuli, name) == pytest.approx(getattr(slip[0].stimuli, name), rel=1e-5)


def test_stimuli_are_read_back(run):
    """Bit for bit."""
    again = fp.Result.load(run.folder)
    for mine, kept in zip(run.steps, again.steps, strict=True):
        for name in (*FIELDS, "surface_strain_left"):
            assert np.array_equal(getattr(mine.stimuli, name), getattr(kept.stimuli, name), equal_nan=True)
    assert str(again.afferents()) == str(run.afferents())


def test_run_without_time_has_no_stimuli():
    """Neither in its states nor in its file."""
    found = fp.run(scene({"name": "press", "f_ext": 1.0}))
    assert found.steps[-1].stimuli is None and found.steps[-1].sites is not None
    assert "merkel_stress" not in found.to_xarray()
    with pytest.raises(SceneError, match="the run has no load over time, so nothing is felt over time; give its loads"):
        found.afferents()


# -- spikes ----------------------------------------------------------------------------------------------------------
def test_command(run, tmp_path, capsys):
    """A table on the screen, one of all spikes, a dataset and a picture."""
    shutil.copytree(run.folder, tmp_path / "run")
    assert main(["report", str(tmp_path / "run"), "--feel", "--class", "SA1", "--class", "RA1 strain"]) == 0
    printed = capsys.readouterr().out
    assert "SA1" in printed and "RA1 strain" in printed and "Thresholds are relative" in printed
    spikes = run.afferents(["SA1", "RA1 strain"])
    with (tmp_path / "run" / "spikes.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == COLUMNS
    assert [float(row["t"]) for row in rows] == pytest.approx(np.concatenate([np.empty(0), *spikes.trains]))
    assert (tmp_path / "run" / "raster.png").stat().st_size > 1000
    kept = pytest.importorskip("xarray").open_dataset(tmp_path / "run" / "spikes.nc")
    assert kept.spikes.units == "s" and np.isfinite(kept.spikes).sum() == len(rows)
    assert kept.rate.values == pytest.approx(spikes.rate)
    assert np.array_equal(kept["first"].values, spikes.first, equal_nan=True)


def test_densities_above_the_spikes(run):
    """A curve a Merkel site below the ridges that can touch, in kPa over the same time as the spikes."""
    spikes = run.afferents(["SA1", "RA1"])
    top, *below = spikes.plot().axes
    ridges = sorted({unit.ridge for unit in spikes.units})
    curves = [line for line in top.lines if line.get_label().startswith("_child") and len(line.get_xdata()) > 2]
    assert len(curves) == len(ridges) and spikes.densities.ridges == tuple(ridges)
    sites = run.steps[-1].sites
    last = [curve.get_ydata()[-1] for curve in curves]
    assert last == pytest.approx(1e-3 * sites.merkel[np.isin(sites.number, ridges)])
    assert {ax.get_xlim() for ax in below} == {top.get_xlim()} and len(below) == 2


def made(run: Result, times: list[float], stress: list[float], loads: list[str] | None = None) -> Result:
    """Return a run of two ridges whose compressive stress (Pa) is the same at every site, at times (s)."""
    number, one = np.array([-1, 0]), np.ones(2)
    steps = []
    for k, (time, value) in enumerate(zip(times, stress, strict=True)):
        stimuli = Stimuli(number, *[value * one] * 4, 0 * one, -1e-6 * value * one)
        state = ContactState(
            step=k + 1, load=(loads or ["press"] * len(times))[k], f_ext=1.0, voltage=0.0, f_t=0.0, mu_app=0.0,
            f_contact=1.0, f_electrostatic=0.0, ridges_in_contact=2, contact_length=1e-4, time=time, mesh_contact=1e-5,
            sites=Sites(number, value * one, value * one, value * one), stimuli=stimuli,
        )  # fmt: skip
        steps.append(state)
    return replace(run, steps=tuple(steps))


def test_spikes_are_those_of_the_stimulus(run):
    """A ramp and a hold of 20 kPa: those of the law alone, below every ridge."""
    times = [*np.linspace(0, 0.1, 101), 1.0]
    found = made(run, times, [*np.linspace(0, 2e4, 101), 2e4], ["press"] * 101 + ["hold"]).afferents()
    grid = np.interp(1e-4 * np.arange(10001), [0, 0.1], [0, 2e4])
    for law, count in (("SA1", 2), ("RA1", 4), ("PC", 1)):
        assert len(found.of(law)) == count
        for train in found.of(law):
            assert train == pytest.approx(fp.afferents.find(law).spikes(grid, 1e-4), abs=1.1e-4)
    assert found.count("RA1", "hold") <= 4 < found.count("RA1", "press") and found.laws == ["SA1", "RA1", "PC"]
    assert [unit.ridge for unit in found.units] == [-1, 0, -1, -1, 0, 0, None]


def test_jump_takes_no_time(run):
    """Two states of one time: the jump excites RA1 at once, and is not smeared over the step before."""
    times, stress = [0.0, 0.5e-3, 0.1, 0.1, 0.102, 0.2], [0.0, 0.0, 0.0, 2e4, 2e4, 2e4]
    (train, *_) = made(run, times, stress).afferents("RA1").trains
    assert 0.1 < train[0] < 0.103


def test_hold_may_have_long_steps(run):
    """And a slow change may not."""
    times = [0.0, 1e-3, 2e-3, 1.0]
    assert made(run, times, [0, 1e4, 2e4, 2e4]).afferents("RA1").count("RA1") > 0
    coarse = made(run, [*times, 1.5], [0, 1e4, 2e4, 2e4, 1e4])
    with pytest.raises(SceneError, match=r"RA1 needs a state every 3.1 ms and the load 'press' has two 500 ms"):
        coarse.afferents("RA1")
    some = made(run, np.linspace(0, 0.1, 11), np.linspace(0, 2e4, 11)).afferents()  # 10 ms apart: too far for RA1
    assert some.laws == ["SA1"] and sum("Left out: " in note for note in some.notes) == 2
    with pytest.raises(SceneError, match="SA1 needs a state every 13 ms"):
        made(run, [0.0, 0.1], [0, 2e4]).afferents()


class Elsewhere(Afferent):
    """A law at a site that there is none of."""

    name, site, longest_step = "Elsewhere", "ruffini", 1.0

    def stimulus(self, history):
        return history.stress

    def fire(self, stimulus):
        return stimulus > 0


@pytest.mark.parametrize(
    ("laws", "said"),
    [
        ("SA7", "the class is 'SA7'; it must be 'SA1' or 'SA1 sed'"),
        ([], "no class of afferents is given; give one at least"),
        (Elsewhere(), "the site of Elsewhere is 'ruffini'; it must be 'merkel' or 'meissner' or 'pacinian'"),
    ],
)
def test_refused_classes(run, laws, said):
    with pytest.raises(SceneError, match=said):
        run.afferents(laws)


def test_sites_that_are_missing(run):
    """Of a run without receptors, and of a mesh of one's own."""
    bare = replace(run, steps=tuple(replace(state, stimuli=None, sites=None) for state in run.steps))
    without = replace(bare, scene=run.scene.replace(output={"receptors": False}))
    with pytest.raises(SceneError, match="the run has no stimuli at receptor sites: output.receptors is false"):
        without.afferents()
    own = replace(bare, scene=run.scene.model_copy(update={"geometry": run.scene.geometry.model_copy()}))
    object.__setattr__(own.scene.geometry, "file", "mine.msh")
    with pytest.raises(SceneError, match="no stimuli at receptor sites: its mesh is one of your own; run a finger of"):
        own.afferents()


# -- the report ------------------------------------------------------------------------------------------------------
@pytest.mark.slow
@pytest.mark.parametrize("size", sorted(SIZES))
def test_report_has_what_is_felt(run, tmp_path, size):
    """A raster with every spike below the pressure of the ridges, caution and table; it fits a laptop and a phone."""
    page, (width, height) = run_page.page(run), SIZES[size]
    assert 'href="#felt"' in page and "Thresholds are relative" in page
    ridges = [dict(zip(state.ridges.number, state.ridges.p_c, strict=True)) for state in run.steps]
    assert len({len(each) for each in ridges}) == 2, "the path goes on with more ridges"
    assert all(f"ridge {j}" in page for each in ridges for j, p_c in each.items() if p_c > 0)
    program = """
    const marks = [...document.querySelectorAll("#felt [data-marks]")].map((g) => g.dataset.marks.split(" ").length);
    const root = document.documentElement;
    return { points: marks.reduce((a, b) => a + b, 0), wide: root.scrollWidth, width: root.clientWidth };"""
    found = asked(page, program, tmp_path, width=width, height=height)
    assert found["points"] == sum(map(len, run.afferents().trains))
    assert found["wide"] <= found["width"]


def test_report_of_a_run_that_is_too_coarse(run):
    """One sentence in the place of the section; nothing of a run without time."""
    page = run_page.page(made(run, [0.0, 0.1], [0, 2e4])).replace("\u00a0", " ")
    assert "No spikes are computed: SA1 needs a state every 13 ms" in page
    assert 'id="felt"' not in run_page.page(replace(run, steps=()))
