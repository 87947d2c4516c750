"""What is impossible in a scene is refused in one short sentence that names the key, the value and what is allowed."""

import re
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.model.options import check
from fingerpad.scene import SceneError
from fingerpad.scene import scene as scenes

ROOT = Path(__file__).parent.parent


def refusal(path: Path | None = None, **overrides) -> str:
    with pytest.raises(SceneError) as error:
        check(scenes.load(path, {key.replace("__", "."): value for key, value in overrides.items()}))
    message = str(error.value)
    assert "\n" not in message
    return message


# -- refusals: values ----------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("f_ext", -3, "f_ext is -3 N/m; it must be from 0.001 to 5000 N/m"),
        ("f_ext", float("nan"), "f_ext is nan; it must be a finite number"),
        (
            "roughness.p_floor", 1e6,
            "roughness.p_floor is 1000000; it must be below the pressure at zero separation, 2.597e+05 Pa",
        ),
        (
            "geometry.ridge_count", 54,
            "geometry.ridge_count is 54; it must be odd, so that one ridge is at x = 0",
        ),
        ("geometry.ridge_count", 5.0, "geometry.ridge_count is 5.0; it must be a whole number"),
        ("numerics.quadrature_points", 9, "numerics.quadrature_points is 9; it must be at most 8"),
        ("friction", "0.25", "friction is '0.25'; it must be a number"),
        ("friction", [0.25], "friction is [0.25]; it must be a number, a table or a Friction"),
        ("voltage", -1e9, "voltage is -1000000000 V; it must be 0 or from 0.001 to 5000 V, with either sign"),
        ("mesh", 3, "mesh is 3; it must be a table of keys"),
        (
            "materials.subcutis.alpha", 0,
            "materials.subcutis.alpha is 0; it must be from 0.01 to 50, with either sign",
        ),
        ("roughness.h_rms", 0, "roughness.h_rms is 0 m; it must be from 1e-09 to 0.001 m"),
        (
            "roughness.gamma", 2,
            "roughness.p_floor is 1000, where the air gap would be held at 3.13e+07 m; it must be below 1 m: take a "
            "larger p_floor, or a smaller gamma or h_rms",
        ),
        ("contact.eps_n", 0, "contact.eps_n is 0 Pa/m; it must be from 1e+07 to 1e+17 Pa/m"),
        (
            "numerics.quadrature_points", 2,
            "numerics.quadrature_points is 2; it must be at least 3 for numerics.element 'P2'",
        ),
    ],
)  # fmt: skip
def test_impossible_value(key, value, message):
    assert refusal(None, **{key.replace(".", "__"): value}) == message


@pytest.mark.parametrize(
    ("formulation", "key", "value", "message"),
    [
        (
            "penalty",
            "gamma_0",
            10.0,
            "contact.gamma_0 is not a key of contact with the law penalty; keys are eps_n, eps_t",
        ),
        ("augmented", "tolerance", 0, "contact.tolerance is 0 m; it must be from 1e-12 to 1e-06 m"),
        ("nitsche", "theta", 2, "contact.theta is 2; it must be -1, 0 or 1"),
    ],
)
def test_impossible_formulation(formulation, key, value, message):
    """A key that would be silently ignored is refused, also where its value is the default."""
    assert refusal(None, **{"contact__formulation": formulation, f"contact__{key}": value}) == message


def test_impossible_geometry_and_mesh():
    """The finger's own checks, with keys as a scene spells them."""
    assert refusal(mesh__contact=5e-4) == (
        "mesh.contact is 0.0005 m, too large for a ridge of 0.000483 m: at most a quarter of it, 0.00012075 m"
    )
    assert "geometry.ve_thickness is 5e-05 m and must exceed" in refusal(geometry__ve_thickness=50e-6)
    assert "geometry.bone_centre (0.004 m)" in refusal(geometry__bone_centre=4e-3)


# -- refusals: keys ------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("text", "start"),
    [
        ("volts = 3", "volts is not a key of a scene; did you mean voltage?"),
        ("[mesh]\ncontcat = 1", "mesh.contcat is not a key of mesh; did you mean mesh.contact?"),
        (
            "[materials.dermis]\nnu = 0.4",
            "materials.dermis.nu is not a key of materials.dermis with the law Ogden; keys are shear_modulus, alpha",
        ),
        ("f_ext = 1979-05-27", "f_ext is '1979-05-27'; its unit is not known; it must be a number in N/m"),
    ],
)
def test_unknown_key(write, text, start):
    assert refusal(write(text)).startswith(start)


def test_first_of_several(write):
    assert refusal(write("voltage = -1\nf_ext = -3")) == "f_ext is -3 N/m; it must be from 0.001 to 5000 N/m"


# -- refusals: files -----------------------------------------------------------------------------------
def test_files_that_cannot_be_read(write, tmp_path, monkeypatch):
    """Named as they were given, if that is not too long."""
    monkeypatch.chdir(tmp_path)
    missing = Path("none.toml")
    assert refusal(missing) == f"scene file {missing} cannot be read: No such file or directory"
    assert refusal(Path()) == "scene file . cannot be read: Is a directory"
    assert refusal(tmp_path / ("n" * 300)).endswith(" cannot be read: File name too long")
    path = write("f_ext = ").relative_to(tmp_path)
    assert refusal(path) == f"scene file {path} is not TOML: Invalid value (at end of document)"
    path.write_bytes(b"\xff\xfe")
    assert refusal(path) == f"scene file {path} is not text in UTF-8; save it in UTF-8"


def test_byte_order_mark(write):
    """Windows editors write one; it is as if it were not there."""
    path = write("f_ext = 30\n")
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert scenes.load(path).f_ext == 30


DOTS = "a." * 400_000 + "a"


@pytest.mark.timeout(20)
@pytest.mark.parametrize(
    "text",
    [
        f"{DOTS} = 1",
        f"x = {{{DOTS} = 1}}",
        f'x = {{s = """\n""", {DOTS} = 1}}',
        f'x = "\\"" # "\n{DOTS} = 1',
        '"=".' * 200_000 + "a = 1",
    ],
    ids=lambda text: text[:12],
)
def test_long_dotted_key_is_refused_at_once(write, text):
    """Wherever it stands; tomllib takes minutes, and hours for a megabyte."""
    assert "has lists or tables that are nested too deep; a scene has at most 8" in refusal(write(text))


def test_dots_that_are_no_key(write):
    """In comments, texts and lists of numbers."""
    dots = "." * 50
    numbers = ", ".join(["1.5"] * 12)
    text = f'# {dots} don\'t\nfriction = 0.25 # "{dots}\n[[history]]\nname = "a{dots}"\nf_ext = 5.0\n[geometry]\n'
    assert scenes.load(write(f"{text}ridge_profile = [\n{numbers}\n]")).history[0].name == f"a{dots}"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f_ext = " + "9" * 400, "f_ext has some 400 digits; at most 300 are read"),
        ("f_ext = " + "[" * 5000 + "]" * 5000, "nested too deep"),
        (f"{'a.' * 3000}a = 1", "a.a.a has lists or tables that are nested too deep"),
        ('"" = 1', "'' is not a key of a scene; keys are f_ext, force, voltage,"),
        (f"{'k' * 100_000} = 1", f"{'k' * 37}... is not a key of a scene;"),
        (f'voltage = "{"v" * 100_000}"', f"voltage is '{'v' * 55}...'; it must be a number"),
        ("geometry.ridge_profile = [1, inf]", "geometry.ridge_profile[1] is inf; it must be a finite number"),
        (f"geometry.ridge_profile = {[1] * 500}", "ridge_profile has too many entries; it must have at most 16"),
        ("ridge_count = 9", "ridge_count is not a key of a scene; did you mean geometry.ridge_count?"),
        ("until_full_slip = true", "until_full_slip is not a key of a scene; did you mean history[0].until_full_slip?"),
    ],
)
def test_odd_text(write, text, message):
    """Whatever is in a file, the sentence is short and names the key."""
    found = refusal(write(text))
    assert message in found
    assert len(found) < 289


@pytest.mark.parametrize(
    ("key", "value", "meant"),
    [
        ("geometry.width", 16, "16 m; it must be from 0.001 to 0.1 m (lengths are in m; did you mean 0.016?)"),
        ("roughness.h_rms", 1.97, "1.97 m; .*did you mean 1.97e-06"),
        ("materials.stratum_corneum.shear_modulus", 0.087, "0.087 Pa; .*did you mean 87000"),
        ("f_ext", 1e300, "1e+300 N/m; it must be from 0.001 to 5000 N/m$"),
        ("geometry.merkel_offset", 900e-6, "0.0009 m; it must be below the thickness of the viable epidermis"),
    ],
)
def test_value_nobody_can_mean(key, value, meant):
    """Beyond the range, whose unit is named, and what was meant where that can be told."""
    pattern = re.escape(f"{key} is ") + re.sub(r"[+()?]", r"\\\g<0>", meant)
    assert re.match(pattern, refusal(None, **{key.replace(".", "__"): value}))


# -- arguments in Python -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("call", [fp.run, fp.press, lambda scene: fp.sweep(scene, model="cylinders", voltage=[0.0])])
@pytest.mark.parametrize("scene", [{}, 0, {"f_ext": 5.0}, "scene.toml"])
def test_what_is_no_scene_is_refused(call, scene):
    """Nothing that is false is the default scene."""
    with pytest.raises(SceneError, match=r"^scene is .*; it must be a Scene, and a file is read by Scene\.load"):
        call(scene)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: fp.run(out=5), "out is 5; it must be the path of a folder"),
        (lambda: fp.sweep(out=None, voltage=[0.0]), "out is empty; it must be the path of a folder"),
        (lambda: fp.sweep(voltage=np.array(3)), "voltage of the sweep is 3; it must be a list, such as"),
        (lambda: fp.sweep(jobs="2", voltage=[0.0]), "jobs is '2'; it must be a whole number, at least 1"),
    ],
)
def test_wrong_arguments_are_refused(call, words):
    with pytest.raises(SceneError, match=words):
        call()


# -- A history of loads that cannot be run is refused in one short sentence ---
HELD = (
    "which ends at f_ext 0 and voltage 0, where nothing holds the skin on the screen; one of the two must be greater "
    "than 0, or a bone_height be given"
)
OWN_NAME = (
    "each load must have a name of its own, also where spaces become _ and letters have no case, since files are named "
    "by it"
)


def named(name: str) -> list[dict]:
    """Return a history of one load."""
    return [{"name": name, "f_ext": 1}]


@pytest.mark.parametrize(
    ("history", "message"),
    [
        ([], "history is empty; it must have at least one entry"),
        (3, "history is 3; it must be a list"),
        ([3], "history[0] is 3; it must be a table of keys"),
        ([{"f_ext": 3}], "history[0].name is missing; it must be given"),
        ([{"name": "a", "f_ext": 0}], f"history[0].name is 'a', {HELD}"),
        ([{"name": "a", "f_ext": 0, "voltage": 9}, {"name": "b", "voltage": 0}], f"history[1].name is 'b', {HELD}"),
        ([{"name": "a", "f_ext": -1}], "history[0].f_ext is -1 N/m; it must be 0 or from 0.001 to 5000 N/m"),
        (
            [{"name": "a", "f_ext": 1, "until_full_slip": 1}],
            "history[0].until_full_slip is 1; it must be true or false",
        ),
        (
            [{"name": "a", "f_ext": 1, "bone_height": -1e-3}],
            "history[0].f_ext is 1 and history[0].bone_height is -0.001; at most one of the two can be prescribed",
        ),
        (
            [*named("a"), {"name": "b", "until_full_slip": True}],
            "history[1].name is 'b' and nothing else is given; it must come with at least one of "
            "history[1].f_ext, history[1].bone_height, history[1].voltage, history[1].bone_x and history[1].bone_x_by",
        ),
        (
            [*named("a"), {"name": "b", "voltage": 80, "bone_x": 1e-3, "until_full_slip": True}],
            "history[1].voltage is 80 and history[1].until_full_slip is true, which may stop before that is reached; "
            "history[1].voltage must come in a load of its own",
        ),
        (
            [{"name": "a", "voltage": 200}],
            "history[0].name is 'a', with neither f_ext nor bone_height; the first load must give one of them",
        ),
        (named("a/b"), "history[0].name is 'a/b'; it must be without '/', since files are named by it"),
        (named(" "), "history[0].name is ' '; it must have a letter or a digit"),
        (
            named("n" * 300),
            f"history[0].name is '{'n' * 55}...'; it must be of 100 bytes at most, since files are named by it",
        ),
        (named("voltage") * 2, f"history[1].name is 'voltage' and history[0].name is 'voltage'; {OWN_NAME}"),
        (named("on off") + named("On_off"), f"history[1].name is 'On_off' and history[0].name is 'on off'; {OWN_NAME}"),
        *(
            (
                named(f"{first}1+1"),
                f"history[0].name is '{first}1+1'; it must not begin with '{first}', which makes a formula of it when "
                "a table is opened",
            )
            for first in "=+@\uff1d"
        ),
    ],
)
def test_impossible_history(history, message):
    assert refusal(None, history=history) == message


@pytest.mark.parametrize(("key", "value"), [("f_ext", 50.0), ("voltage", 0.0), ("slide_length", 1e-3)])
def test_history_and_a_default_load_s_value(key, value):
    """Also where the value given is the default: it would be silently ignored."""
    for given in (value, getattr(fp.Scene(), key)):
        assert refusal(ROOT / "demos" / "scenes" / "voltage_while_sliding.toml", **{key: given}) == (
            f"{key} is {given:g} and history is given too; with a history each load states its own values"
        )
