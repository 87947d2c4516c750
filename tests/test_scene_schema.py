"""The JSON Schema of scenes: kept up to date, true to scenes that run, and strict against slips of the keyboard."""

import json
import tomllib
from pathlib import Path

import jsonschema
import pytest

from fingerpad.cli import main
from fingerpad.scene import Scene, SceneError, from_data
from fingerpad.scene.keys import DIALECT, schema

ROOT = Path(__file__).parents[1]
FILE = ROOT / "docs" / "scene.schema.json"
CHECK = jsonschema.Draft202012Validator(schema(Scene))
SCENES = sorted((ROOT / "demos" / "scenes").glob("*.toml"))
WRONG = [
    {"f_exts": 50.0},
    {"mesh": {"contacts": 1e-5}},
    {"mesh": {"contact": 10.0}},
    {"friction": "0.2"},
    {"contact": {"formulation": "nitche"}},
    {"history": [{"f_ext": 1.0}]},
    {"numerics": {"quadrature_points": 2.5}},
]
RIGHT = [
    {},
    {"f_ext": "50 N/m", "mesh": {"contact": "10 µm"}},
    {"history": [{"name": "press", "bone_height": -1e-4}, {"name": "charge", "voltage": 0}]},
    {"materials": {"dermis": {"shear_modulus": "3 kPa"}}},
    {"geometry": {"ridge_profile": [1.0, -0.2]}},
]


def test_file_is_the_generated_one(capsys):
    """If not: fingerpad params --schema > docs/scene.schema.json."""
    assert main(["params", "--schema"]) == 0
    assert FILE.read_text(encoding="utf-8") == capsys.readouterr().out


def test_schema_is_of_its_dialect():
    assert schema(Scene)["$schema"] == DIALECT
    jsonschema.Draft202012Validator.check_schema(schema(Scene))


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_scene_of_the_demos_is_valid(scene):
    CHECK.validate(tomllib.loads(scene.read_text(encoding="utf-8")))


@pytest.mark.parametrize("data", RIGHT, ids=json.dumps)
def test_what_the_program_takes_is_valid(data):
    from_data(data)
    CHECK.validate(data)


@pytest.mark.parametrize("data", WRONG, ids=json.dumps)
def test_slip_is_refused_by_both(data):
    with pytest.raises(SceneError):
        from_data(data)
    assert list(CHECK.iter_errors(data))


def test_every_key_has_a_description():
    """Editors show it beside the key; tables have that of their model."""
    found = schema(Scene)
    parts = [found, *found["$defs"].values(), *found["$defs"]["Contact"]["anyOf"]]
    keys = [item for part in parts for item in part.get("properties", {}).items()]
    bare = [key for key, value in keys if not {"description", "$ref"} & {*value}]
    assert bare == []
