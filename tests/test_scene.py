"""Scenes: defaults are the paper's, and what is given wins."""

import json
from pathlib import Path

import pytest

from fingerpad.cli import main
from fingerpad.model.options import check
from fingerpad.scene import Load, Scene, SceneError
from fingerpad.scene import scene as scenes
from fingerpad.scene.keys import every
from fingerpad.scene.reading import model_of
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty

SCENES = Path(__file__).parent.parent / "demos/scenes"


# -- defaults ------------------------------------------------------------------------------------------
def test_default_scene():
    scene = scenes.load()
    assert scene == Scene()
    assert (scene.f_ext, scene.voltage, scene.friction, scene.mesh.contact) == (75.0, 200.0, 0.25, 10e-6)
    assert scene.loads() == (
        Load(name="press", f_ext=75.0),
        Load(name="charge", voltage=200.0),
        Load(name="slide", bone_x=5e-3, until_full_slip=True),
    )
    check(scene)


def test_default_materials_are_table_2():
    m = Scene().materials
    layers = (m.subcutis, m.dermis, m.viable_epidermis, m.stratum_corneum)
    assert [(s.shear_modulus, s.alpha) for s in layers] == [
        (25e3, 5.0), (2.55e3, -14.53), (61.75e3, -14.53), (86.76e3, -14.53),
    ]  # fmt: skip
    assert {s.poisson for s in layers} == {0.48}
    assert [(s.young, s.poisson) for s in (m.nail, m.nail_bed)] == [(170e6, 0.3), (1e6, 0.3)]


# -- files and overrides -------------------------------------------------------------------------------


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.toml")), ids=lambda path: path.stem)
def test_scenes_that_come_along(path):
    """They can be run."""
    scene = scenes.load(path)
    check(scene)
    assert scene.loads()


@pytest.mark.parametrize("name", [None, "coarse.toml", "voltage_while_sliding.toml"])
def test_parameters_give_the_scene_again(name):
    scene = scenes.load(SCENES / name if name else None, {"materials.exponent": "abaqus"})
    again = scenes.from_data(json.loads(json.dumps(scene.parameters())))
    assert again == scene and again.loads() == scene.loads()


@pytest.mark.parametrize(
    ("given", "law"),
    [
        ({}, Penalty(1.5e12, 5e10)),
        ({"formulation": "nitsche"}, Nitsche(1.0, 0)),
        ({"formulation": "nitsche", "theta": -1, "gamma_0": 3.0}, Nitsche(3.0, -1)),
        ({"formulation": "augmented"}, AugmentedLagrangian(1.5e13, 5e11, 5e-9)),
    ],
)
def test_formulation(given, law):
    """A name and its own parameters, each with a default that suits it; the parameters in use give it again."""
    scene = scenes.load(None, {f"contact.{key}": value for key, value in given.items()})
    assert scene.contact.law == law
    assert scenes.from_data(json.loads(json.dumps(scene.parameters()))).contact.law == law


def test_scene_of_a_run_s_folder_is_a_scene(tmp_path):
    """With changes on top, as a scene in TOML; a run that was given more is refused, and so is other JSON."""
    given = Scene(f_ext=20.0, accuracy={"mu_app": 0.02})
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(given.parameters() | {"model": "cylinders"}), encoding="utf-8")
    assert model_of(file) == "cylinders" and model_of(tmp_path / "scene.toml") == model_of(None) == "full"
    assert Scene.load(file) == given and scenes.load(file, {"f_ext": "30 N/m"}) == given.replace(f_ext=30.0)
    for data, words in (
        ({"f_ext": 5.0}, "is not the scene.json of a run; other scenes are in TOML"),
        ([], "is not the scene.json of a run"),
    ):
        file.write_text(json.dumps(data), encoding="utf-8")
        with pytest.raises(SceneError, match=words):
            Scene.load(file)
    file.write_text("{", encoding="utf-8")
    with pytest.raises(SceneError, match="is not JSON"):
        Scene.load(file)
    with pytest.raises(SceneError, match="cannot be read: No such file"):
        Scene.load(tmp_path / "other.json")


# -- the reference ---------------------------------------------------------------------------------------------------
def test_page_has_every_key(capsys):
    assert main(["params", "--markdown"]) == 0
    page = capsys.readouterr().out
    assert [key.name for key in every(Scene) if f"`{key.name.rpartition('.')[2]}`" not in page] == []
