"""Rung 2 on a finger of few ridges, lightly pressed: what it answers, and that it is in balance."""

import json
import os
import shutil
import signal
from dataclasses import replace

import numpy as np
import pytest
import ufl
from mpi4py import MPI

from fingerpad.installed import source
from fingerpad.io.result import Result
from fingerpad.model.options import FingerModel, plan
from fingerpad.model.simulation import Simulation
from fingerpad.model.touching import by_rule
from fingerpad.reduced import ridge_cell, smooth, stages
from fingerpad.reduced.answer import TooLight
from fingerpad.richardson import ONCE
from fingerpad.runs import batch
from fingerpad.scene import SceneError, from_data, load
from geometry.parameters import Fingertip
from tests.small_finger import SMALL
from variational.contact.ridge_law import RidgeTable
from variational.state import RESULTS, ContactState

SCENE = {
    "f_ext": 2.1445,
    "voltage": 0.0,
    "geometry": {"ridge_count": 21},
    "mesh": {"contact": 10e-6, "touching_half_arc": 2e-3},
}


def skin(finger) -> tuple[np.ndarray, np.ndarray]:
    """Return the length along the skin to each of its points (m), sorted, and their height (m)."""
    surface = finger.observer.surface
    x, y = surface.evaluate(surface.compile(list(ufl.SpatialCoordinate(surface.mesh)))).reshape(2, -1)
    order = np.argsort(x)
    along = np.cumsum(np.hypot(np.diff(x[order], prepend=x[order][0]), np.diff(y[order], prepend=y[order][0])))
    return along, finger.walk.surface_state.y.ravel()[order]


@pytest.fixture(scope="module")
def contacts():
    """Skin, table and contact of each state that a finger reaches."""
    return []


@pytest.fixture(scope="module")
def answer(tmp_path_factory, contacts):
    folder, contact = tmp_path_factory.mktemp("tables"), smooth._SmoothFinger._contact

    def noting(finger):
        contacts.append((*skin(finger), finger.law.table, contact(finger)))
        return contacts[-1][-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(smooth._SmoothFinger, "_contact", noting)
        return smooth.solve(from_data(SCENE), folder), folder


def test_everything_is_known(answer):
    assert [name for state in answer[0].named.values() for name in RESULTS if np.isnan(getattr(state, name))] == []
    assert set(answer[0].named) == {"charged", "full_slip"}


@pytest.mark.parametrize("state", ["charged", "full_slip"])
def test_the_law_bears_the_load(answer, state):
    """Contact less attraction, read from the tables, against the force prescribed: the solver's 1e-9 and roundoff."""
    s = answer[0].named[state]
    assert s.f_contact - s.f_electrostatic == pytest.approx(2.1445, rel=1e-6)
    assert s.bone_height < -10e-6


def test_contact_adds_up(answer, contacts):
    """Force and length of the table at each height of the skin, over the width of a ridge.

    Tolerance: the trapezoidal rule between points a twelfth of a ridge apart, 0.16 % at most here.
    """
    assert len(contacts) == 4  # normal contact and full slip, of two sizes of facets
    for along, height, table, found in contacts:
        force, length = (np.interp(height, table.y, values) for values in (table.contact, table.length))
        per_ridge = 1 / Fingertip().ridge_wavelength
        assert per_ridge * np.trapezoid(force, along) == pytest.approx(found["f_contact"], rel=5e-3)
        assert per_ridge * np.trapezoid(length, along) == pytest.approx(found["contact_length"], rel=5e-3)


def test_contact_is_that_of_the_full_model(answer):
    """The stated error of the contact length, which depends on the facets most, covers the difference.

    The bone sinks 1.2 % less than the full model's, with facets of 10 to 2.5 um: the model spreads its ridges.
    """
    scene = from_data({"history": [{"name": "press", "f_ext": 2.1445}], **{k: SCENE[k] for k in ("geometry", "mesh")}})
    full = Simulation(FingerModel(by_rule(scene), plan(scene)), MPI.COMM_WORLD)
    full.run()
    s, expected = answer[0].charged, full.states[-1]
    assert abs(s.contact_length - expected.contact_length) <= s.error.contact_length
    assert 0.985 < s.bone_height / expected.bone_height < 1


def test_one_table_is_kept(answer):
    """Without voltage the scene's table and the uncharged one are one; there is one of each size of facets."""
    assert len(list(answer[1].glob("*.json"))) == 2


# -- the discretisation error ------------------------------------------------------------------------------
ROUGH = {"h_rms": 2e-6, "wavelength": 80e-6}  # its air gaps are smaller, and attraction falls faster over the gap


def rough(voltage: float, contact: float):
    mesh = SCENE["mesh"] | {"contact": contact}
    return from_data(SCENE | {"voltage": voltage, "roughness": ROUGH, "mesh": mesh})


def test_table_of_many_rows_keeps_those_that_bend():
    """Of a line with a bend, its ends and the bend; a column of zeros has no part."""
    y = np.linspace(0.0, 1.0, 61)
    rows = np.stack([y, np.maximum(y - y[20], 0.0), 0 * y], axis=1)
    np.testing.assert_array_equal(ridge_cell.thinned(rows, 3), rows[[0, 20, 60]])
    assert ridge_cell.thinned(rows, 61) is rows


def test_facets_that_lose_the_ridge_are_refused():
    """A lifted ridge that is lost while 2 % of its largest force press it on the screen: no answer comes of that."""
    y, force = np.array([-2e-6, 0.0, 2e-6, 4e-6]), np.array([1.0, 0.02, 0.0, 0.0])
    table = RidgeTable(y, force, 0 * y, (force > 0) * 1e-5)
    with pytest.raises(SceneError, match=r"mesh.contact is 2e-05 m, .* is lost at .*; give a mesh.contact of 1e-05 m"):
        smooth._refuse_lost(rough(200.0, 20e-6), table)
    smooth._refuse_lost(rough(200.0, 20e-6), replace(table, contact=np.array([1.0, 0.009, 0.0, 0.0])))


@pytest.mark.long
@pytest.mark.parametrize("voltage", [100.0, 200.0])
def test_error_covers_the_difference_to_finer_facets(tmp_path, voltage):
    """Facets of 20 um, against those of a quarter of their size; at 200 V a table of 10 um has too many rows."""
    coarse = smooth.solve(rough(voltage, 20e-6), tmp_path)
    finer = smooth.solve(rough(voltage, 5e-6), tmp_path).named
    for name, state in coarse.named.items():
        for quantity in ("f_electrostatic", "contact_length"):
            change = abs(getattr(state, quantity) - getattr(finer[name], quantity))
            assert 0 < change <= getattr(state.error, quantity), (name, quantity)
    slip = coarse.full_slip
    assert abs(slip.mu_app - finer["full_slip"].mu_app) <= slip.error.mu_app


def contact(mu_app: float) -> ContactState:
    rest = {"f_contact": 3.0, "f_electrostatic": 1.0, "ridges_in_contact": 16, "contact_length": 1e-3}
    return ContactState(f_ext=2.0, voltage=200.0, mu_app=mu_app, f_t=2 * mu_app, **rest)


def test_error_of_first_order():
    """1 + h: halving h = 0.2 changes 0.1, and the error left, 0.1, counts with its factor of safety."""
    found = smooth.estimated(contact(1.2), contact(1.1))
    assert found.mu_app == pytest.approx(0.1 + ONCE * 0.1, rel=1e-12)
    assert found.contact_length == 0 and np.isnan(found.bone_height)


def test_error_too_large_to_mean_anything_is_refused():
    """The issue's scene: 0.788 with facets of 20 um, 1.019 with those of half the size."""
    scene, coarse = rough(200.0, 20e-6), {"full_slip": contact(0.788)}
    words = "mu_app of full slip in the model 'smooth' is 0.788 with an estimated .* error of 0.69"
    with pytest.raises(SceneError, match=words) as caught:
        smooth._refuse_coarse(scene, coarse, {"full_slip": smooth.estimated(coarse["full_slip"], contact(1.019))})
    assert "give a mesh.contact of 1e-05 m or less" in str(caught.value)
    assert len(str(caught.value)) < 300
    smooth._refuse_coarse(scene, coarse, {"full_slip": smooth.estimated(coarse["full_slip"], contact(0.80))})


def test_error_that_is_not_known_is_refused():
    """Full slip with one size of facets and none with the other."""
    coarse = {"full_slip": contact(0.5)}
    with pytest.raises(SceneError, match="mu_app of full slip .* is not known with facets of half the size"):
        smooth._refuse_coarse(rough(200.0, 20e-6), coarse, {"full_slip": smooth.estimated(coarse["full_slip"], None)})


def test_every_number_comes_with_its_error(answer):
    """But ridges, which are counted."""
    for state in answer[0].named.values():
        assert set(state.error.known()) == set(RESULTS) - {"ridges_in_contact"}
    slip = answer[0].full_slip
    assert 0 < slip.error.contact_length < 0.5 * slip.contact_length
    assert answer[0].cost.factorisations > 0


def test_error_of_the_model_is_not_known_of_another_finger(answer):
    """Its ± is of the mesh alone, and nothing else is told of its error."""
    assert answer[0].record["model_error"] == {}
    assert any("known with the default geometry, and not here" in text for text in answer[0].cautions)


class Recorder:
    """In the place of a console."""

    def __init__(self):
        self.whole, self.told = 0.0, []

    def expect(self, loads, after):
        self.whole = sum(loads.values()) + after

    def phase(self, text, part):
        self.told.append((text, part))


def test_stages_are_those_that_take_time(answer):
    """Tables that are kept are read; the two fingers are half of the time each."""
    shown = Recorder()
    smooth.solve(from_data(SCENE), answer[1], console=shown)
    assert [part for _, part in shown.told] == [0.0, 0.5]
    assert all(text.startswith("the smooth finger") for text, _ in shown.told)
    assert shown.whole == 2 * stages.FINGER


@pytest.mark.parametrize(("voltage", "count"), [(0.0, 4), (100.0, 6)])
def test_tables_that_are_missing_count(tmp_path, voltage, count):
    """Of each of two meshes: one table or two, and the finger. Its last stage is not the end."""
    shown = Recorder()
    scenes = [from_data(SCENE | {"voltage": voltage, "mesh": SCENE["mesh"] | {"contact": h}}) for h in (1e-5, 5e-6)]
    there = stages.Stages(scenes, tmp_path, MPI.COMM_SELF, shown)
    for k in range(count):
        there.begin(str(k))
    parts = [part for _, part in shown.told]
    assert [text for text, _ in shown.told] == [str(k) for k in range(count)]
    assert parts[0] == 0.0 and parts == sorted(set(parts))
    assert parts[-1] == pytest.approx(1 - stages.FINGER / shown.whole)


def shortened(least: int):
    """Return what gives tables that end at a fiftieth of the force, where they are less than so many times deeper."""
    tables = ridge_cell.tables

    def short(scene, folder, comm, deeper, pause):
        found = tables(scene, folder, comm)
        for table in (found.normal, found.slip) if deeper < least else ():
            keep = np.arange(len(table.y)) >= np.argmax(table.contact < 0.04)
            for name, values in vars(table).items():
                object.__setattr__(table, name, values[keep])
        return found

    return short


def test_table_that_ends_too_soon_is_said(answer, monkeypatch):
    """The finger stops where it ends, with one sentence."""
    monkeypatch.setattr(ridge_cell, "tables", shortened(2))
    monkeypatch.setattr(smooth, "_DEEPEST", 1)
    with pytest.raises(SceneError, match="its table ends at"):
        smooth.solve(from_data(SCENE), answer[1])


def test_table_that_ends_too_soon_is_made_deeper(answer, monkeypatch):
    """Twice, and the finger begins again; its stages are counted anew."""
    monkeypatch.setattr(ridge_cell, "tables", shortened(4))
    shown = Recorder()
    found = smooth.solve(from_data(SCENE), answer[1], console=shown)
    assert found.full_slip.f_t == answer[0].full_slip.f_t
    parts = [part for _, part in shown.told]
    assert 0 <= min(parts) and max(parts) < 1


def test_table_goes_deeper(tmp_path):
    """To twice the force, in a file of its own."""
    scene = from_data(SCENE)
    once, twice = (ridge_cell.tables(scene, tmp_path, MPI.COMM_SELF, deeper) for deeper in (1, 2))
    assert twice.normal.contact.max() == pytest.approx(2 * once.normal.contact.max(), rel=1e-6)
    assert once.name != twice.name


def test_less_than_a_ridge_is_refused(tmp_path):
    """Spread evenly over its width, a ridge of a sharply curved finger that touches by a part of it is too stiff."""
    light = load(SMALL).replace(f_ext=0.3, voltage=0.0, mesh={"contact": 10e-6})
    with pytest.raises(TooLight, match="touches over 0.* mm, less than a ridge of 0.483 mm"):
        smooth.solve(light, tmp_path)


def test_contact_beyond_the_fine_skin_is_refused(answer):
    narrow = from_data(SCENE).replace(mesh={"touching_half_arc": 0.6e-3})
    with pytest.raises(SceneError, match=r"the skin touches beyond mesh\.touching_half_arc, which must be larger"):
        smooth.solve(narrow, answer[1])


def test_few_ridges_are_told(answer):
    """Of a flat finger with skin that touches over three and over two of them."""
    light = smooth.solve(from_data(SCENE | {"f_ext": 0.5}), answer[1])
    told = [[text for text in found.cautions if "stand apart" in text] for found in (answer[0], light)]
    assert not told[0] and told[1][0].startswith("the skin touches over 2")


def test_remarks_on_the_scene_are_cautions(answer, monkeypatch):
    """Whatever they are: a roughness as long as ridges has tables of its own, which take long."""
    monkeypatch.setattr(smooth, "remarks", lambda scene: ["a remark"])
    assert "a remark" in smooth.solve(from_data(SCENE), answer[1]).cautions


@pytest.mark.parametrize(("number", "error"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, SystemExit)])
@pytest.mark.parametrize("kept", [True, False], ids=["finger", "ridge"])
def test_signal_ends_it_after_the_step(answer, tmp_path, kept, number, error):
    """In the ridge's path or in the finger's, and not inside PETSc."""

    class Stopping(Recorder):
        def phase(self, text, part):
            os.kill(os.getpid(), number)

    before = signal.signal(number, signal.default_int_handler)  # a caller in the background may ignore it
    try:
        with pytest.raises(error) as stopped:
            smooth.solve(from_data(SCENE), answer[1] if kept else tmp_path, console=Stopping())
    finally:
        signal.signal(number, before)
    if number == signal.SIGINT:
        assert str(stopped.value).startswith("stopped by SIGINT after step")


def test_history_is_refused(tmp_path):
    with pytest.raises(SceneError, match="history is given; the model 'smooth'"):
        smooth.solve(from_data({"history": [{"name": "press", "f_ext": 5.0}]}), tmp_path, MPI.COMM_WORLD)


def test_point_of_a_sweep_names_its_versions(answer, tmp_path):
    """As a run does: a sweep tells points of another state of the program by them."""
    shutil.copytree(answer[1], tmp_path / "ridge_tables")
    asked, place = tmp_path / "asked.json", tmp_path / "point"
    asked.write_text(json.dumps(from_data(SCENE).parameters()), encoding="utf-8")
    place.mkdir()
    batch._one(asked, place, "smooth")
    assert Result.load(place).record["provenance"]["versions"]["source"] == source()
