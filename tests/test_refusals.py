"""What is impossible in a scene is refused in one short sentence that names the key, the value and what is allowed."""

import re
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.model.feasibility import check
from fingerpad.scene import SceneError
from fingerpad.scene import scene as scenes

SCENES = Path(__file__).parent.parent / "demos/scenes"


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
        ("f_ext", 0, "f_ext is 0 N/m; it must be from 0.001 to 5000 N/m"),
        ("f_ext", float("nan"), "f_ext is nan; it must be a finite number"),
        ("f_ext", float("inf"), "f_ext is inf; it must be a finite number"),
        ("f_ext", True, "f_ext is true; it must be a number"),
        ("f_ext", [1], "f_ext is [1]; it must be a number"),
        ("voltage", "high", "voltage is 'high'; it must be a number in V or a text such as '1 V'"),
        ("voltage", "200", "voltage is '200'; it has no unit; it must be a number in V or a text such as '200 V'"),
        ("friction", "0.25", "friction is '0.25'; it must be a number"),
        ("voltage", -1e9, "voltage is -1000000000 V; it must be 0 or from 0.001 to 5000 V, with either sign"),
        ("friction", -0.1, "friction is -0.1; it must be 0 or from 1e-06 to 2"),
        ("friction", 2.1, "friction is 2.1; it must be 0 or from 1e-06 to 2"),
        ("slide_length", 0, "slide_length is 0 m; it must be from 1e-09 to 0.1 m"),
        ("mesh", 3, "mesh is 3; it must be a table of keys"),
        ("materials", 3, "materials is 3; it must be a table of keys"),
        ("materials.dermis", 3, "materials.dermis is 3; it must be a table of keys"),
        (
            "mesh.contact", "5e-6",
            "mesh.contact is '5e-6'; it has no unit; it must be a number in m or a text such as '5e-6 m'",
        ),
        ("mesh.contact", float("nan"), "mesh.contact is nan; it must be a finite number"),
        ("mesh.contact", -5e-6, "mesh.contact is -5e-06 m; it must be from 1e-08 to 0.01 m"),
        ("mesh.growth", 1.5, "mesh.growth is 1.5; it must be from 0.0001 to 1"),
        ("materials.dermis.poisson", 0.5, "materials.dermis.poisson is 0.5; it must be from -0.9 to 0.4999"),
        ("materials.nail.poisson", -1, "materials.nail.poisson is -1; it must be from -0.9 to 0.4999"),
        ("materials.nail.young", 0, "materials.nail.young is 0 Pa; it must be from 1 to 1e+12 Pa"),
        (
            "materials.dermis.shear_modulus", -1,
            "materials.dermis.shear_modulus is -1 Pa; it must be from 1 to 1e+12 Pa",
        ),
        (
            "materials.subcutis.alpha", 0,
            "materials.subcutis.alpha is 0; it must be from 0.01 to 50, with either sign",
        ),
        ("materials.exponent", "ansys", "materials.exponent is 'ansys'; it must be 'printed' or 'abaqus'"),
        ("electric.eps_i", 0.5, "electric.eps_i is 0.5; it must be from 1 to 1e+07"),
        ("electric.d_i", 0, "electric.d_i is 0 m; it must be from 1e-09 to 0.01 m"),
        ("roughness.h_rms", 0, "roughness.h_rms is 0 m; it must be from 1e-09 to 0.001 m"),
        (
            "roughness.p_floor", 1e6,
            "roughness.p_floor is 1000000; it must be below the pressure at zero separation, 2.597e+05 Pa",
        ),
        (
            "roughness.gamma", 2,
            "roughness.p_floor is 1000, where the air gap would be held at 3.13e+07 m; it must be below 1 m: take a "
            "larger p_floor, or a smaller gamma or h_rms",
        ),
        ("contact.eps_n", 0, "contact.eps_n is 0 Pa/m; it must be from 1e+07 to 1e+17 Pa/m"),
        (
            "contact.formulation", "mortar",
            "contact.formulation is 'mortar'; it must be 'penalty', 'nitsche', 'augmented' or a law of your own, as "
            "'module:Class'",
        ),
        ("contact.length", "area", "contact.length is 'area'; it must be 'pressure' or 'gap'"),
        (
            "numerics.element", "P4",
            "numerics.element is 'P4'; it must be 'P1', 'P2', 'P2 reduced', 'P2-P1' or 'P3'",
        ),
        ("numerics.coupling_cap", 1.5, "numerics.coupling_cap is 1.5; it must be a whole number"),
        ("geometry.ridge_count", 5.0, "geometry.ridge_count is 5.0; it must be a whole number"),
        ("numerics.quadrature_points", 9, "numerics.quadrature_points is 9; it must be at most 8"),
        (
            "numerics.quadrature_points", 2,
            "numerics.quadrature_points is 2; it must be at least 3 for numerics.element 'P2'",
        ),
        ("numerics.tolerance", 0, "numerics.tolerance is 0; it must be from 1e-12 to 1e-07"),
        ("numerics.coupling_cap", 0, "numerics.coupling_cap is 0; it must be at least 1"),
        (
            "geometry.ridge_count", 54,
            "geometry.ridge_count is 54; it must be odd, so that one ridge is at x = 0",
        ),
        ("geometry.width", 0, "geometry.width is 0 m; it must be from 0.001 to 0.1 m"),
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
        (
            "nitsche",
            "eps_n",
            1e12,
            "contact.eps_n is not a key of contact with the law nitsche; keys are gamma_0, theta",
        ),
        (
            "augmented",
            "theta",
            0,
            "contact.theta is not a key of contact with the law augmented; keys are eps_n, eps_t, tolerance",
        ),
        ("augmented", "tolerance", 0, "contact.tolerance is 0 m; it must be from 1e-12 to 1e-06 m"),
        ("nitsche", "gamma_0", -1, "contact.gamma_0 is -1; it must be from 0.001 to 1e+06"),
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
        (
            "[materials.bone]\nyoung = 1",
            "materials.bone is not a key of materials; keys are exponent, subcutis, dermis,",
        ),
        (
            '[[history]]\nname = "a"\nf_ext = 1\nu = 3',
            "history[0].u is not a key of history[0]; keys are name, f_ext, bone_height, voltage, bone_x,",
        ),
        ("f_ext = 1979-05-27", "f_ext is '1979-05-27'; its unit is not known; it must be a number in N/m"),
    ],
)
def test_unknown_key(write, text, start):
    assert refusal(write(text)).startswith(start)


def test_override_of_something_that_is_no_table(write):
    assert refusal(write("mesh = 3"), mesh__contact=1e-6) == "mesh is 3; it must be a table of keys"


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


@pytest.mark.parametrize(("value", "column"), [("50,0", 11), ("50 N/m", 12)])
def test_values_of_other_languages(write, value, column):
    """The parser's place stays in the sentence."""
    assert refusal(write(f"f_ext = {value}")).endswith(
        f"after a statement (at line 1, column {column}); decimals have points, and a value with a unit has quotes"
    )


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
        f"[{DOTS}]",
        f"x = {{{DOTS} = 1}}",
        f'x = {{s = """\n""", {DOTS} = 1}}',
        f'# """\n{DOTS} = 1\n# """',
        f'x = "\\"" # "\n{DOTS} = 1',
        f"x = '\\' # '\n{DOTS} = 1",
        '"=".' * 200_000 + "a = 1",
        "a . " * 200_000 + "a = 1",
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
        ("numerics.coupling_cap = " + "9" * 30, "numerics.coupling_cap is 1e+30; it must be at most 1000"),
        ("voltage = " + "9" * 30, "voltage is 1e+30 V; it must be 0 or from 0.001 to 5000 V"),
        ("f_ext = " + "[" * 5000 + "]" * 5000, "nested too deep"),
        (f"{'a.' * 3000}a = 1", "a.a.a has lists or tables that are nested too deep"),
        ('"" = 1', "'' is not a key of a scene; keys are f_ext, force, voltage,"),
        ('"mesh.contact" = 1', "'mesh.contact' is not a key of a scene;"),
        ('"a\\nb" = 1', "'a\\nb' is not a key of a scene;"),
        (f"{'k' * 100_000} = 1", f"{'k' * 37}... is not a key of a scene;"),
        (f'voltage = "{"v" * 100_000}"', f"voltage is '{'v' * 55}...'; it must be a number"),
        (f"{'k' * 100_000}", "is not TOML: Expected '=' after a key"),
        ("geometry.ridge_profile = []", "geometry.ridge_profile is empty; it must have at least one entry"),
        ("geometry.ridge_profile = [nan]", "geometry.ridge_profile[0] is nan; it must be a finite number"),
        ("geometry.ridge_profile = [1, inf]", "geometry.ridge_profile[1] is inf; it must be a finite number"),
        (
            f"geometry.ridge_profile = {[1] * 500}",
            "geometry.ridge_profile has too many entries; it must have at most 16",
        ),
        ("ridge_count = 9", "ridge_count is not a key of a scene; did you mean geometry.ridge_count?"),
        ("mesh.ridge_cuont = 9", "mesh.ridge_cuont is not a key of mesh; did you mean geometry.ridge_count?"),
        ("dermis.alpha = 9", "dermis is not a key of a scene; did you mean materials.dermis?"),
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
        ("geometry.sc_thickness", 425, "425 m; .*did you mean 0.000425"),
        ("geometry.sc_thickness", 1e-9, "1e-09 m; it must be from 1e-06 to 0.01 m$"),
        ("geometry.nail_thickness", 1e-9, "1e-09 m; it must be from 1e-05"),
        ("roughness.h_rms", 1.97, "1.97 m; .*did you mean 1.97e-06"),
        ("mesh.contact", 5, "5 m; .*did you mean 5e-06"),
        ("mesh.coarsest", 1, "1 m; .*did you mean 0.001"),
        ("slide_length", 5, "5 m; .*did you mean 0.005"),
        ("geometry.ridge_amplitude", 100, "100 m; .*did you mean 0.0001"),
        ("materials.stratum_corneum.shear_modulus", 0.087, "0.087 Pa; .*did you mean 87000"),
        ("contact.eps_n", 1.5, "1.5 Pa/m; .*did you mean 1.5e"),
        ("f_ext", 75e3, "75000 N/m; .*did you mean 75?"),
        ("f_ext", 1e300, "1e+300 N/m; it must be from 0.001 to 5000 N/m$"),
        ("voltage", 1e9, "1000000000 V; it must be 0 or from 0.001 to 5000 V, with either sign$"),
        ("voltage", 2e14, "2e+14 V; it must be"),
        ("numerics.step_scale", 1e-9, "1e-09; it must be from 0.001 to 10$"),
        ("numerics.coupling_tolerance", 0.9, "0.9; it must be from 1e-12 to 0.001$"),
        ("numerics.tolerance", 0.9, "0.9; it must be from 1e-12 to 1e-07$"),
        ("mesh.growth", 1e-9, "1e-09; it must be from 0.0001 to 1$"),
        ("mesh.coarsest", 1e-9, "1e-09 m; it must be from 1e-08"),
        ("mesh.touching_half_arc", 1e308, "1e+308 m; it must be from 1e-06 to 0.2 m$"),
        ("geometry.width", 1e308, "1e+308 m; it must be from 0.001 to 0.1 m$"),
        ("geometry.height", 5e-324, "4.94065645841e-324 m; it must be from 0.001 to 0.1 m$"),
        ("geometry.merkel_offset", 1.0, "1 m; .*did you mean 1e-06"),
        ("geometry.merkel_offset", 900e-6, "0.0009 m; it must be below the thickness of the viable epidermis"),
    ],
)
def test_value_nobody_can_mean(key, value, meant):
    """Beyond the range, whose unit is named, and what was meant where that can be told."""
    pattern = re.escape(f"{key} is ") + meant.replace("+", r"\+").replace("(", r"\(").replace(")", r"\)").replace(
        "?", r"\?"
    )
    assert re.match(pattern, refusal(None, **{key.replace(".", "__"): value}))


# -- arguments in Python -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("call", [fp.run, lambda scene: fp.sweep(scene, model="cylinders", voltage=[0.0])])
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
