"""The doors agree: a scene from Python, from TOML and from the command line is the same scene, or the same refusal."""

import tomllib
from collections.abc import Callable

import numpy as np
import pytest

from fingerpad.scene import Scene, SceneError, override
from fingerpad.scene import scene as scenes
from fingerpad.scene.loads import Load
from fingerpad.scene.parameters import Contact
from geometry.parameters import Fingertip, MeshSize
from tests import fuzz_files
from tests.fuzz import Mutant, bad_refusal, fault, mutant, prepare

ASKED = {"mu_app": 0.01}
LOADS = [{"name": "press", "f_ext": 20.0}, {"name": "charge", "voltage": 80.0}]


def outcome(door: Callable[[], Scene]) -> Scene | str:
    """Return a scene, or why there is none."""
    try:
        return door()
    except SceneError as error:
        return str(error)


# -- Python and TOML -----------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "text",
    [
        "f_ext = 75.0\nvoltage = 200\nfriction = 0.25",
        'f_ext = "0.05 N/mm"',
        "accuracy = {mu_app = 0.01}\nmesh = {contact = 10e-6}",
        'history = [{name = "press", f_ext = 20}, {name = "slide", bone_x = 1e-3, until_full_slip = true}]',
        'contact = {formulation = "augmented", eps_t = 1e11}',
        "f_ext = -1",
        'f_ext = "50 V"',
        "volts = 3",
        "accuracy = {}",
        "history = []",
        'history = [{name = "press"}]',
        "geometry.ridge_count = 55.0",
    ],
)
def test_python_and_toml(write, text):
    """Equal scenes, equal sentences."""
    assert outcome(lambda: Scene(**tomllib.loads(text))) == outcome(lambda: scenes.load(write(text)))


@pytest.mark.slow
def test_mutants(write, tmp_path):
    """Scenes as nobody should write them; of those that are TOML some are accepted, most refused."""
    path, refused, accepted = tmp_path / "scene.toml", 0, 0
    for k in range(100):
        file = mutant(17, k).file
        try:
            data = tomllib.loads((file or b"\xff").decode("utf-8-sig"))
        except (ValueError, RecursionError):
            continue
        path.write_bytes(file)
        if len(file) > 1_000_000:  # refused as a file
            continue
        by_python, by_file = outcome(lambda data=data: Scene(**data)), outcome(lambda: scenes.load(path))
        assert by_python == by_file, f"mutant {k}"
        refused, accepted = refused + isinstance(by_file, str), accepted + isinstance(by_file, Scene)
    assert refused > 15 and accepted > 5


# -- what only Python has ------------------------------------------------------------------------------
def test_numpy_is_as_python():
    given = Scene(
        f_ext=np.float32(50), voltage=np.int64(100), geometry={"ridge_profile": np.array([1, -0.5])},
        output={"receptors": np.False_}, numerics={"coupling_cap": np.int8(9)}, friction=np.longdouble(0.5),
    )  # fmt: skip
    assert given == Scene(
        f_ext=50, voltage=100, geometry={"ridge_profile": (1.0, -0.5)}, output={"receptors": False},
        numerics={"coupling_cap": 9}, friction=0.5,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("objects", "tables"),
    [
        ({"mesh": MeshSize(contact=10e-6), "accuracy": ASKED}, {"mesh": {"contact": 10e-6}, "accuracy": ASKED}),
        ({"geometry": Fingertip(width=21e-3)}, {"geometry": {"width": 21e-3}}),
        ({"history": tuple(Load(**load) for load in LOADS)}, {"history": LOADS}),
        ({"contact": Contact(formulation="nitsche")}, {"contact": {"formulation": "nitsche"}}),
    ],
)
def test_objects_are_as_tables(objects, tables):
    assert Scene(**objects) == Scene(**tables)


# -- copies --------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("before", "changes", "after"),
    [
        ({"f_ext": 50}, {"voltage": "0.1 kV"}, {"f_ext": 50, "voltage": 100}),
        ({"mesh": {"contact": 9e-6}}, {"mesh": {"growth": 0.3}}, {"mesh": {"contact": 9e-6, "growth": 0.3}}),
        ({"mesh": {"contact": 9e-6}}, {"mesh": MeshSize(growth=0.3)}, {"mesh": {"growth": 0.3}}),
        ({}, {"accuracy": ASKED}, {"accuracy": ASKED}),
        ({"mesh": {"contact": 9e-6}}, {"accuracy": ASKED}, {"mesh": {"contact": 9e-6}, "accuracy": ASKED}),
        ({"accuracy": ASKED}, {"accuracy": {"sed": 0.1}}, {"accuracy": ASKED | {"sed": 0.1}}),
        ({"history": LOADS}, {"history": None, "f_ext": 50}, {"f_ext": 50}),
        (
            {"contact": {"formulation": "augmented", "length": "gap"}},
            {"contact": {"formulation": "nitsche"}},
            {"contact": {"formulation": "nitsche", "length": "gap"}},
        ),
    ],
)
def test_copy_with_changes(before, changes, after):
    """As if the scene had been given so from the start."""
    assert Scene(**before).replace(**changes) == Scene(**after)


# -- changes as text -----------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("mesh.contact = 10e-6", "mesh.contact", 10e-6),
        ("voltage=.5", "voltage", 0.5),
        ("numerics.coupling_cap=9", "numerics.coupling_cap", 9),
        ("output.receptors=false", "output.receptors", False),
        ("contact.formulation=nitsche", "contact.formulation", "nitsche"),
        ("numerics.element=P2 reduced", "numerics.element", "P2 reduced"),
        ("geometry.ridge_profile=[1, -0.2]", "geometry.ridge_profile", [1, -0.2]),
        ("f_ext=50 N/m", "f_ext", "50 N/m"),
        ("history[1].voltage=100", "history[1].voltage", 100),
    ],
)
def test_change_as_text(text, key, value):
    """Whole numbers stay whole, where a scene wants them so."""
    found = override(text)
    assert found == (key, value) and type(found[1]) is type(value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f_ext", "f_ext is no change of a scene; it must be key=value, as in mesh.contact=10e-6"),
        ("f_ext=", "f_ext= is no change of a scene; it must be key=value, as in mesh.contact=10e-6"),
        ("=5", "=5 is no change of a scene; it must be key=value, as in mesh.contact=10e-6"),
        ("", "an empty text is no change of a scene; it must be key=value, as in mesh.contact=10e-6"),
        ("f ext=5", "f ext=5 is no change of a scene; it must be key=value, as in mesh.contact=10e-6"),
        ("a=[1,", "a is '[1,'; it must be a value as in TOML, with all brackets and quotes"),
    ],
)
def test_change_as_text_is_refused(text, message):
    with pytest.raises(SceneError) as error:
        override(text)
    assert str(error.value) == message


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("history[9].f_ext", "history[9] is not there; history has 1 entries"),
        ("mesh[0].contact", "mesh is {}; it must be a list"),
        ("history.f_ext", "history is [{"),
    ],
)
def test_change_of_a_load_that_is_not_there(write, key, message):
    path = write('mesh = {}\nhistory = [{name = "press", f_ext = 3.0}]')
    assert str(outcome(lambda: scenes.load(path, {key: 1.0}))).startswith(message)


# -- mutated scenes, command lines and files -------------------------------------------------------------------------
SEED = 16


@pytest.fixture
def folder(tmp_path):
    prepare(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_mutants_of_scenes_and_lines(folder):
    """Some are ready, most are refused, and of neither kind is there anything wrong."""
    found = [fault(mutant(SEED, k), folder) for k in range(100)]
    assert [(k, wrong) for k, (wrong, _) in enumerate(found) if wrong] == []
    ready = [how for _, how in found].count("ready")
    assert 0.1 * len(found) < ready < 0.5 * len(found)


@pytest.mark.parametrize(
    ("broken", "value"),
    [("fingerpad.scene.reading._MAX_DEPTH", 10**6), ("fingerpad.model.options.refuse_sizes", lambda *given: None)],
)
@pytest.mark.slow
def test_what_is_broken_is_found(folder, monkeypatch, broken, value):
    """Without one of the guards there is a mutant that shows it: the first is made for sizes."""
    monkeypatch.setattr(broken, value)
    made = [Mutant(0, b"mesh.contact = 2e-8\n", ("{folder}/scene.toml",))]
    assert any(fault(each, folder)[0] for each in (*made, *(mutant(SEED, k) for k in (75, *range(400)))))


# -- files -------------------------------------------------------------------------------------------------
@pytest.mark.slow
def test_mutants_of_files(folder):
    """Each kind as it is, and mutants of them: there is nothing wrong, some are read and some refused."""
    kinds = {ending: content for ending, content in fuzz_files.whole() if len(content) > 60}
    found = [fuzz_files.fault(fuzz_files.Mutant(0, *kind), folder, bad_refusal) for kind in kinds.items()]
    found += [fuzz_files.fault(fuzz_files.mutant(SEED, k), folder, bad_refusal) for k in range(8)]
    assert [wrong for wrong, _ in found if wrong] == []
    assert {how == "ready" for _, how in found} == {True, False}
