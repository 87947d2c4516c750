"""Laws of one's own in a scene: closure, materials, friction and mesh, refused in one sentence or used throughout."""

import json
import pickle
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import ufl
from mpi4py import MPI

from fingerpad.model.options import FingerModel, plan
from fingerpad.model.simulation import Simulation
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene, SceneError, from_data, laws
from fingerpad.scene.law_source import digest
from fingerpad.scene.laws import Laws, used
from geometry import tags
from variational.contact.friction import CONE_ROUNDOFF, Coulomb, Derjaguin, Friction
from variational.materials.material import Material
from variational.materials.neo_hooke import NeoHooke
from variational.materials.ogden import Ogden
from variational.materials.saint_venant import SaintVenant
from variational.roughness.bam import BearingArea
from variational.roughness.closure import AirGap, Closure

DERJAGUIN = Derjaguin(0.3, tau_0=5e3)


@dataclass(frozen=True)
class Held(Closure):
    """A constant gap, the least that a closure of one's own is."""

    gap: float = 2e-6

    def __call__(self, p_c):
        return AirGap(self.gap + 0 * np.asarray(p_c, dtype=float))


@dataclass(frozen=True)
class Saturating(Friction):
    """A friction law of one's own: it levels off at a shear strength."""

    mu_f: float
    t_most: float

    def limit(self, p):
        return self.mu_f * p / (1 + self.mu_f * p / self.t_most)


@dataclass(frozen=True)
class Mine(Material):
    """A material of one's own."""

    shear_modulus: float
    bulk: float

    def energy(self, F):
        return self.shear_modulus / 2 * (ufl.det(F) ** (-2 / 3) * ufl.inner(F, F) - 3)


OWN = {"closure": Held(), "materials": {"dermis": Mine(2.5e3, 6e4)}, "friction": Saturating(0.4, 2e4)}


# -- in the scene ----------------------------------------------------------------------------------------------
def test_scene_without_laws_has_its_own():
    scene = Scene()
    assert not scene.laws
    assert "laws" not in scene.parameters()
    assert scene.closure() == scene.roughness.bearing_area(scene.h_0)
    assert scene.friction_law() == Coulomb(0.25)
    assert scene.solids()[tags.DERMIS] == Ogden(2.55e3, -14.53, 0.48)


def test_scene_takes_laws():
    scene = Scene().with_laws(**OWN)
    assert scene.closure() == Held()
    assert scene.friction_law() == OWN["friction"]
    solids = scene.solids()
    assert solids[tags.DERMIS] == OWN["materials"]["dermis"]
    assert solids[tags.SUBCUTIS] == Scene().solids()[tags.SUBCUTIS]
    assert set(solids) == set(tags.LAYERS.values())


def test_laws_are_kept_by_copies():
    scene = Scene().with_laws(**OWN)
    assert scene.model_copy(update={"f_ext": 10.0}).laws == scene.laws
    assert pickle.loads(pickle.dumps(scene)) == scene != Scene()


def test_laws_are_kept_by_changes():
    """But for friction, whose number takes the place of a law: a series of runs over it is one over it."""
    scene = Scene().with_laws(**OWN)
    assert scene.replace(f_ext=10.0).laws == scene.laws
    changed = scene.replace(friction=0.1)
    assert changed.friction_law() == Coulomb(0.1)
    assert changed.closure() == Held()


def test_laws_are_added_to_those_there_are():
    scene = Scene().with_laws(materials={"dermis": NeoHooke(2e3)}).with_laws(materials={"nail": NeoHooke(1e7)})
    assert set(scene.with_laws(friction=0.1).laws.materials) == {"dermis", "nail"}


@pytest.mark.parametrize(("given", "law"), [(0.4, Coulomb(0.4)), (0, None), (0.0, None), (DERJAGUIN, DERJAGUIN)])
def test_friction_is_a_law_or_a_coefficient(given, law):
    assert Scene().with_laws(friction=given).friction_law() == law


def test_model_has_friction_where_the_law_is_one():
    assert plan(from_data({"friction": 0.0}).with_laws(friction=DERJAGUIN)).friction
    assert not plan(Scene().with_laws(friction=0.0)).friction


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (
            {"materials": {"derms": NeoHooke(1e3)}},
            "materials has 'derms', which is no layer; layers are",
        ),
        ({"materials": {"dermis": 2.5e3}}, "materials['dermis'] is 2500; it must be a Material"),
        ({"materials": NeoHooke(1e3)}, "it must be a table of materials by layer"),
        ({"materials": {"dermis": NeoHooke(-1.0)}}, "materials['dermis']: NeoHooke(shear_modulus=-1.0, poisson=0.48)"),
        ({"closure": 2e-6}, "closure is 2e-06; it must be a Closure"),
        ({"closure": Held(-1e-6)}, "closure Held returns an air gap of -1e-06 m at a pressure of 0 Pa"),
        ({"closure": Held(float("nan"))}, "closure Held returns an air gap of nan m"),
        ({"friction": "smooth"}, "friction is 'smooth'; it must be a Friction, a friction coefficient"),
        ({"friction": Derjaguin(0.3, -5e3)}, "it must be finite and not negative"),
        ({"mesh": 3}, "mesh is 3; it must be the path of a file"),
        ({"mesh": "nowhere.msh"}, "mesh is 'nowhere.msh', and there is no such file"),
    ],
)
def test_what_is_no_law_is_refused(given, sentence):
    with pytest.raises(SceneError) as error:
        Scene().with_laws(**given)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


def test_files_hold_no_laws():
    for make in (from_data, lambda data: Scene(**data)):
        with pytest.raises(SceneError, match="laws is no key, since no file can hold one; give laws from Python"):
            make({"laws": {"friction": {"mu_f": 0.3}}})


# -- scenes apart ----------------------------------------------------------------------------------------------
def test_parameters_tell_laws_apart(tmp_path):
    """Equal laws give equal text, other numbers or another class another; the mesh counts by what is in it."""
    file = tmp_path / "mine.msh"
    file.write_text("one", encoding="utf-8")
    given = [
        *({name: law} for name, law in OWN.items()),
        {"friction": Saturating(0.4, 3e4)},
        {"friction": Coulomb(0.4)},
    ]
    scenes = [Scene(), *(Scene().with_laws(**one) for one in given), Scene().with_laws(mesh=file)]
    texts = [json.dumps(scene.parameters(), sort_keys=True, allow_nan=False) for scene in scenes]
    assert len(set(texts)) == len(texts)
    again = Scene().with_laws(friction=Saturating(0.4, 20000))
    assert json.dumps(again.parameters(), sort_keys=True) == texts[3]
    file.write_text("other", encoding="utf-8")
    assert json.dumps(Scene().with_laws(mesh=file).parameters(), sort_keys=True) != texts[-1]


def test_names_of_the_laws():
    found = used(Scene().with_laws(**OWN))
    assert set(found) == {*laws.LAYERS, "contact", "friction", "attraction", "closure"}
    assert found["dermis"] == "Mine(shear_modulus=2500, bulk=60000)"
    assert found["subcutis"] == "Ogden(shear_modulus=25000, alpha=5, poisson=0.48, convention='printed')"
    assert found["nail"] == "SaintVenant(young=170000000, poisson=0.3)"
    assert found["friction"] == "Saturating(mu_f=0.4, t_most=20000)"
    assert found["closure"] == "Held(gap=2e-06)"
    assert found["contact"].startswith("Penalty(eps_n=")


def test_names_of_what_is_left_out():
    found = used(from_data({"voltage": 0.0, "friction": 0.0}))
    assert (found["friction"], found["attraction"], found["closure"]) == ("none", "none", "none")


def test_names_are_those_of_the_objects():
    """What is named without finite elements is what the finite elements are given."""
    scene = Scene()
    for layer, tag in laws.LAYERS.items():
        assert used(scene)[layer] == laws._words(scene.solids()[tag])
    assert used(scene)["contact"] == laws._words(scene.contact.law())


# -- laws beside keys ------------------------------------------------------------------------------------------
def test_number_is_the_key_friction():
    """A number is no law: what is read of the scene is what acts."""
    scene = Scene().with_laws(friction=DERJAGUIN).with_laws(friction=0.4)
    assert scene == Scene().replace(friction=0.4)
    assert (scene.friction, scene.parameters()["friction"], scene.laws.friction) == (0.4, 0.4, None)


def test_layer_is_named_by_key_or_by_name():
    one, other = (Scene().with_laws(materials={name: NeoHooke(2e3)}) for name in ("nail_bed", "nail bed"))
    assert one == other
    assert other.solids()[tags.NAIL_BED] == NeoHooke(2e3)
    with pytest.raises(SceneError, match="materials has the layer 'nail_bed' twice, by its key and by its name"):
        one.with_laws(materials={"nail bed": NeoHooke(1e3), "nail_bed": NeoHooke(2e3)})


@pytest.mark.parametrize(
    ("law", "change", "sentence"),
    [
        (
            {"closure": Held()},
            {"roughness": {"h_rms": 2e-6}},
            "roughness is changed, and the scene has the closure Held",
        ),
        (
            {"materials": {"dermis": NeoHooke(2e3)}},
            {"materials": {"dermis": {"poisson": 0.4}}},
            "materials.dermis is changed, and the scene has the material NeoHooke",
        ),
    ],
)
def test_key_that_a_law_replaces_is_not_changed(law, change, sentence):
    with pytest.raises(SceneError, match=sentence):
        Scene().with_laws(**law).replace(**change)
    assert Scene().with_laws(**law).replace(materials={"subcutis": {"poisson": 0.4}}, f_ext=10.0).f_ext == 10.0


def test_closure_has_the_insulator_of_the_attraction():
    """Equal but for roundoff; otherwise air gaps and attraction are of two insulators."""
    h_0 = Scene().h_0
    scene = Scene().with_laws(closure=BearingArea(h_0 * (1 + 1e-9)))
    with pytest.raises(
        SceneError, match="the closure BearingArea has h_0 = 2e-06 m, and the attraction has .* 5.13986"
    ):
        scene.with_laws(closure=BearingArea(2e-6))
    with pytest.raises(SceneError, match="the two must be the same"):
        scene.replace(geometry={"sc_thickness": 250e-6})


def test_mesh_is_read_when_it_is_given(tmp_path):
    """A run of hours ends with the hash of what it began with, be the file gone."""
    file = tmp_path / "mine.msh"
    file.write_text("one", encoding="utf-8")
    scene = Scene().with_laws(mesh=file)
    before = scene.parameters()
    file.unlink()
    assert scene.parameters() == before
    assert len(before["laws"]["mesh"]["sha256"]) == 64


@pytest.mark.parametrize("solid", [NeoHooke(2e3, 0.5), Ogden(2e3, -14.0, 0.5), SaintVenant(1e6, 0.5)], ids=repr)
def test_incompressible_solid_is_refused(solid):
    with pytest.raises(SceneError, match="moduli that are divided by zero; poisson must be above -1 and below 0.5"):
        Scene().with_laws(materials={"dermis": solid})


@dataclass(frozen=True)
class OfArrays(Mine):
    """A material written with NumPy's functions."""

    def energy(self, F):
        return self.shear_modulus * np.tanh(F[0, 0])


def test_energy_that_ufl_cannot_hold_is_refused():
    with pytest.raises(SceneError, match="energy of OfArrays.*, to be written with arithmetic and ufl's functions"):
        Scene().with_laws(materials={"dermis": OfArrays(2.5e3, 6e4)})


# -- all at once -----------------------------------------------------------------------------------------------
SMALL = {
    "f_ext": 1.0,
    "voltage": 100.0,
    "slide_length": 1e-3,
    "geometry": {"ridge_count": 9},
    "mesh": {"contact": 40e-6, "receptor": 100e-6, "interface": 200e-6, "growth": 1.0, "touching_half_arc": 1.0e-3},
    "output": {"errors": False, "receptors": False},
}


@pytest.fixture(scope="module")
def slid() -> Simulation:
    """A small finger with a closure, a dermis and a friction law of one's own, pressed, charged and slid."""
    scene = from_data(SMALL).with_laws(**OWN)
    simulation = Simulation(FingerModel(scene, plan(scene)), MPI.COMM_WORLD)
    simulation.run()
    return simulation


@pytest.mark.mpi
def test_finger_of_own_laws_reaches_full_slip(slid):
    """f_T is the sum of the limits of its points. Tolerance: forces left at nodes, roundoff of the limit."""
    state, limit = slid.states[-1], float(slid.finger.ridge_loads().f_limit.sum())
    assert state.all_slip
    assert state.f_t == pytest.approx(limit, abs=slid.finger.force_error + CONE_ROUNDOFF * limit)
    assert state.f_contact - state.f_electrostatic == pytest.approx(1.0, abs=slid.finger.force_error)


@pytest.mark.mpi
def test_friction_of_own_law_is_below_coulombs(slid):
    """It levels off with the pressure."""
    loads = slid.finger.ridge_loads()
    assert 0 < loads.f_limit.sum() < 0.95 * 0.4 * loads.f_contact.sum()


@pytest.mark.mpi
def test_air_gaps_are_the_closures(slid):
    assert (slid.finger.coupling.d_eq == 2e-6).all()


@pytest.mark.mpi
def test_dermis_is_the_given_material(slid):
    group = next(group for group in slid.finger.problem.laws if tags.DERMIS in group)
    assert group == (tags.DERMIS,)
    assert isinstance(slid.finger.problem.laws[group], Mine)


@pytest.mark.mpi
def test_energies_of_own_laws_balance(slid):
    """What friction spends is positive, and steps that do not jump release little of it."""
    sliding = [state.record for state in slid.states if state.load == "slide" and not state.record.jump]
    spent = sum(record.dissipation for record in sliding)
    assert spent > 0
    assert sum(abs(record.energy_released) for record in sliding) < 0.1 * spent


def test_laws_of_a_run_tell_its_folder():
    """Kept results are found by the parameters, which have the laws with module and numbers."""
    given = Laws(**OWN).parameters()
    law = {"law": f"{Saturating.__module__}.Saturating", "source code": digest(Saturating)}
    assert given["friction"] == law | {"mu_f": 0.4, "t_most": 2e4}
    assert given["materials"]["dermis"]["bulk"] == 6e4
    assert Path(__file__).stem in given["closure"]["law"]


def test_answers_name_their_laws():
    """The summary of a model has every law in words."""
    scene = Scene().with_laws(friction=DERJAGUIN)
    summary = json.loads(json.dumps(cylinders.solve(scene).to_dict(), allow_nan=False))
    assert summary["laws"] == used(scene)
    assert summary["parameters"]["laws"]["friction"]["tau_0"] == 5e3
