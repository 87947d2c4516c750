"""The command fingerpad: options win over the file, PETSc's options go through, bad input ends in one sentence."""

import argparse
import csv
import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from fingerpad.cli import COMMANDS, cost, estimate, keys, main, microscale, ranges, sweep
from fingerpad.cli.arguments import Parser, positive, scene_of, separate
from fingerpad.io import terminal
from fingerpad.model import balance
from fingerpad.model.options import plan
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene, from_data, load
from fingerpad.scene.messages import SceneError
from variational.roughness.bam import BearingArea
from variational.roughness.selfaffine import SelfAffine
from variational.state import ContactState

ROOT = Path(__file__).parent.parent
SCENES = ROOT / "demos/scenes"
COARSE = ("mesh.contact=30e-6", "mesh.receptor=80e-6", "mesh.interface=120e-6", "mesh.growth=0.5")


def run_line(*argv: str) -> tuple[Scene, argparse.Namespace, list[str]]:
    parser = Parser("fingerpad run", "Run.", "fingerpad run")
    parser.add_scene()
    parser.add_out("results", "folder")
    args, petsc = parser.read_with_petsc(argv)
    return scene_of(args), args, petsc


def refused(capsys, *argv: str) -> str:
    """Return the sentence by which the command refuses its arguments."""
    assert main(argv) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.startswith("fingerpad: ") and err.count("\n") == 1
    return err.removeprefix("fingerpad: ")


# -- options -----------------------------------------------------------------------------------------------
def test_options():
    words = "--set f_ext=30 --set voltage=1e2 -fingerpad_snes_monitor --set mesh.contact=1e-5 --set friction=0.3"
    words += " -fingerpad_snes_rtol -1 --out there"
    scene, args, petsc = run_line(*words.split())
    assert (scene.f_ext, scene.voltage, scene.mesh.contact, scene.friction) == (30.0, 100.0, 1e-5, 0.3)
    assert args.out == Path("there")
    assert petsc == ["-fingerpad_snes_monitor", "-fingerpad_snes_rtol", "-1"]


def test_options_win_over_the_file():
    scene, _, _ = run_line(str(SCENES / "coarse.toml"), "--set", "voltage=0")
    assert (scene.f_ext, scene.voltage, scene.mesh.interface) == (10.0, 0.0, 120e-6)


@pytest.mark.parametrize("key", ['contact.formulation="nitsche"', "contact.formulation=nitsche"])
def test_texts_need_no_quotes(key):
    assert run_line("--set", key)[0].contact.formulation == "nitsche"


@pytest.mark.parametrize(
    ("words", "own", "petsc"),
    [
        ("-fingerpad_snes_monitor scene.toml", "scene.toml", "-fingerpad_snes_monitor"),
        ("-fingerpad_ksp_type preonly scene.toml", "scene.toml", "-fingerpad_ksp_type preonly"),
        ("-fingerpad_a -fingerpad_b -1e-3 --out x", "--out x", "-fingerpad_a -fingerpad_b -1e-3"),
        ("scene.toml -fingerpad_a 1 2", "scene.toml 2", "-fingerpad_a 1"),
    ],
)
def test_options_of_petsc_are_told_from_the_others(words, own, petsc):
    """A word after one of them is its value, but no TOML file is."""
    assert separate(words.split()) == (own.split(), petsc.split())


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["--set", "voltage=high"], "voltage is 'high'; it must be a number"),
        (["--set", "f_ext=nan"], "f_ext is nan; it must be a finite number"),
        (["--set", "f_ext=-3"], "f_ext is -3 N/m; it must be from 0.001 to 5000 N/m"),
        (["--set", "mesh.contact=2e-4"], "mesh.contact is 0.0002 m, too large for a ridge of 0.000483 m"),
        (["--set", "voltage"], "voltage is no change of a scene; it must be key=value"),
        (["--set", "f_exd=3"], "f_exd is not a key of a scene; did you mean f_ext?"),
        (["--voltage", "3"], "--voltage is not an option; did you mean --set voltage=...?"),
        (["-voltage", "300"], "-voltage is not an option; did you mean --set voltage=...?"),
        (["-f_ext=3"], "-f_ext=3 is not an option; did you mean --set f_ext=...?"),
        (["--h-rms", "1"], "--h-rms is not an option; did you mean --set roughness.h_rms=...?"),
        (["--uot", "x"], "--uot is not an option; did you mean --out?"),
        (["-snes_monitor"], "-snes_monitor is not an option; did you mean -fingerpad_snes_monitor?"),
        (["results"], "scene file results cannot be read:"),
        (["--set"], "command line: argument --set: expected one argument"),
        (["--out", ""], "command line: argument --out: it is empty; it must be a path"),
        (["--out", "results\udcff"], "--out results\\udcff is not UTF-8;"),
        (["--out", "a" * 300], f"--out {'a' * 77}... is too long; a name can have 255 bytes"),
        (["--out", "a/" * 2000], f"--out {'a/' * 38}a... is too long; a path can have 4096 bytes"),
        (["--out", __file__], f"--out {__file__} cannot be a folder, since it is a file;"),
        (["--out", f"{__file__}/below"], f"--out {__file__}/below cannot be a folder, since {__file__} is a file;"),
        (["none.toml", "-fingerpad_snes_rtol", "1e-6", "1e-7"], "1e-7 is not an option;"),
        ([str(SCENES / "voltage_while_sliding.toml"), "--set", "f_ext=50"], "f_ext is 50 and history is given"),
        (["none.toml"], "scene file none.toml cannot be read:"),
    ],
)
def test_bad_command_line(argv, message, capsys):
    assert refused(capsys, "run", *argv).startswith(message)


def test_folder_that_is_read_only(tmp_path, monkeypatch, capsys):
    """Root may write anywhere but on a file system that is read-only; the system says so."""
    monkeypatch.setattr("os.access", lambda path, mode: Path(path) != tmp_path)
    assert "cannot be written to: " in refused(capsys, "run", "--out", str(tmp_path / "new" / "results"))


def test_refused_folder_is_not_made(tmp_path, capsys):
    """A scene that is refused leaves no trace."""
    refused(capsys, "run", "--set", "f_ext=-1", "--out", str(tmp_path / "new" / "results"))
    assert not list(tmp_path.iterdir())


def test_quiet_ranks(monkeypatch, capsys):
    """Under a launcher rank 0 alone prints, refusals and help too."""
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    for argv in (["run", "--set", "voltage=high"], ["run", "--set"], ["swep"]):
        assert main(argv) == 2
    for argv in (["--help"], ["run", "--help"], ["--version"], ["params"]):
        assert main(argv) == 0
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("kind", "text", "words"),
    [
        (int, "0", "0 is not allowed; it must be a whole number greater than 0"),
        (int, "two", "two is not allowed; it must be a whole number greater than 0"),
        (float, "-1", "-1 is not allowed; it must be a number greater than 0"),
        (float, "nan", "nan is not allowed; it must be a number greater than 0"),
        (float, "inf", "inf is not allowed; it must be a number greater than 0"),
    ],
)
def test_positive_arguments(kind, text, words):
    with pytest.raises(argparse.ArgumentTypeError) as refusal:
        positive(kind)(text)
    assert str(refusal.value) == words
    assert positive(kind)("3") == 3


# -- commands ----------------------------------------------------------------------------------------------
def test_help_lists_every_command(capsys):
    """And each command has help of its own, with examples."""
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    for name in COMMANDS:
        assert f"\n  {name} " in text
        assert main([name, "--help"]) == 0
        assert f"examples:\n  fingerpad {name}" in capsys.readouterr().out.replace("mpirun -n 2 ", "")


def test_unknown_command(capsys):
    assert refused(capsys, "swep") == "swep is not a command; did you mean sweep?\n"
    assert refused(capsys, "frobnicate").startswith("frobnicate is not a command; commands are estimate, run,")


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("fingerpad 0.")


def test_as_a_module():
    done = subprocess.run([sys.executable, "-m", "fingerpad", "--version"], capture_output=True, text=True, cwd=ROOT)
    assert (done.returncode, done.stderr) == (0, "")


# -- without finite elements -------------------------------------------------------------------------------
def plainly(*argv: str, folder: Path = ROOT, blocked: Sequence[str] = ()) -> subprocess.CompletedProcess[str]:
    """Run the command where finite elements, MPI and gmsh cannot be imported."""
    names = ("dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "gmsh", *blocked)
    code = f"import sys; sys.modules.update(dict.fromkeys({names!r}))\n"
    code += "from fingerpad.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", code, *argv]
    return subprocess.run(
        command, capture_output=True, text=True, check=False, cwd=folder, env={"PYTHONPATH": str(ROOT)}
    )


@pytest.mark.parametrize(
    "argv",
    [
        ["estimate", "--voltage", "0,200"],
        ["microscale"],
        ["params", "roughness"],
        ["check"],
        ["topography", "map.txt", "--unit", "um", "--size", "100", "100"],
    ],
)
def test_commands_without_finite_elements(argv, tmp_path):
    np.savetxt(tmp_path / "map.txt", SelfAffine().surface((32, 32), (100e-6, 100e-6), 1).heights * 1e6)
    done = plainly(*argv, folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(done.stdout.splitlines()) > 5


def test_closed_form_as_a_run(tmp_path):
    """A model without finite elements needs none, and leaves a summary."""
    done = plainly("run", "--model", "cylinders", "--set", 'f_ext="50 N/m"', "--out", "out", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("Result (model 'cylinders')")
    assert json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["f_ext"] == 50.0


@pytest.mark.parametrize(("command", "needed"), [("run", "mpi4py"), ("mesh", "gmsh")])
def test_commands_with_finite_elements_say_what_is_missing(command, needed, tmp_path):
    done = plainly(command, folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(f"fingerpad: {command} needs {needed}, which is not installed;")
    assert done.stderr.count("\n") == 1


def test_check_without_a_mesher(tmp_path):
    done = plainly("check", folder=tmp_path)
    assert "The mesh is not drawn, since gmsh is not installed." in done.stdout
    assert not list(tmp_path.iterdir())


def test_foreign_configuration_is_not_read(tmp_path):
    """A matplotlibrc of the current folder may be anybody's."""
    (tmp_path / "matplotlibrc").write_text("figure.dpi : nonsense\n")
    done = plainly("microscale", "--plot", "a.png", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "a.png").stat().st_size > 10_000


# -- values of a quantity ----------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("75", [75.0]),
        ("20, 50,75", [20.0, 50.0, 75.0]),
        ("0:200:5", [0.0, 50.0, 100.0, 150.0, 200.0]),
        ("200:0:2", [200.0, 0.0]),
        ("1e3:1e6:4:log", [1e3, 1e4, 1e5, 1e6]),
        ("0:0.2:3 kV", ["0.0 kV", "0.1 kV", "0.2 kV"]),
        ("50 N/m", ["50.0 N/m"]),
    ],
)
def test_ranges(text, values):
    """Ends are exact and inner values rounded to 12 digits, so that 0.3 is 0.3."""
    assert ranges.read("x", text) == values


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "x is empty; write one value"),
        ("1:2", "x is 1:2; write one value"),
        ("a:b:3", "x is a:b:3; write one value"),
        ("1,,2", "x is 1,,2; write one value"),
        ("0:1:0", "x is 0:1:0, of 0 values; it must be of 1 to 10000"),
        ("0:1:1", "x is 0:1:1, one value with two ends"),
        ("0:1:3:log", "x is 0:1:3:log; both ends must be greater than 0"),
    ],
)
def test_bad_ranges(text, message):
    with pytest.raises(SceneError) as refusal:
        ranges.read("x", text)
    assert str(refusal.value).startswith(message)


# -- estimate ----------------------------------------------------------------------------------------------
def kept(file: str) -> dict:
    return json.loads((ROOT / "docs" / file).read_text(encoding="utf-8"))["numbers"]


def test_known_error_is_that_of_the_kept_runs():
    """The figures printed are the largest differences of closed form and full runs in docs/models.json, rounded up."""
    runs = kept("models.json")["scenes"]
    assert len(runs) == estimate.KNOWN_RUNS
    points = [tuple(float(part.split()[0]) for part in name.split(",")) for name in runs]
    assert estimate.KNOWN_FORCES == (min(f for f, _ in points), max(f for f, _ in points))
    assert estimate.KNOWN_VOLTAGES == (min(u for _, u in points), max(u for _, u in points))
    for key, known in estimate.KNOWN_ERROR.items():
        ratios = [
            found["cylinders"]["summary"][f"slip_{key}"] / found["full"]["summary"][f"slip_{key}"]
            for found in runs.values()
        ]
        worst = max(abs(ratio - 1) for ratio in ratios)
        assert worst <= known < worst + 1e-4


def test_estimate_is_the_closed_form(tmp_path, capsys):
    file = tmp_path / "mu.csv"
    assert main(["estimate", "--f-ext", "50,75", "--voltage", "0:100:2", "--csv", str(file)]) == 0
    assert "Known error: mu_app within 2.4 %" in capsys.readouterr().out
    with file.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [(float(r["f_ext"]), float(r["voltage"])) for r in rows] == [(50, 0), (50, 100), (75, 0), (75, 100)]
    one = cylinders.solve(from_data({"f_ext": 75.0, "voltage": 100.0})).full_slip
    assert float(rows[-1]["mu_app"]) == one.mu_app
    assert float(rows[0]["mu_app"]) == pytest.approx(0.25, rel=1e-12)


def test_estimate_says_where_its_error_is_not_known(capsys):
    assert main(["estimate", "--f-ext", "75,500", "--set", "friction=0.3"]) == 0
    text = capsys.readouterr().out
    assert "1 of 2 points are outside of that" in text
    assert "Those runs have the default friction" in text


def test_estimate_refuses(capsys):
    assert "f_ext is -5 N/m" in refused(capsys, "estimate", "--f-ext=-5,20")
    assert refused(capsys, "estimate", "--set", "geometry.width=19e-3").startswith(
        "geometry is not that of the default"
    )
    assert "its folder is not there" in refused(capsys, "estimate", "--csv", "nowhere/mu.csv")


def test_estimate_draws_a_curve_for_each_force(tmp_path):
    """The picture is there; the labels are those of the forces."""
    rows, _ = estimate.grid(Scene(), [25.0, 75.0], [0.0, 100.0])
    estimate.draw(tmp_path / "mu.png", rows)
    assert (tmp_path / "mu.png").stat().st_size > 10_000


# -- microscale --------------------------------------------------------------------------------------------
def test_real_area_is_the_bearing_area():
    """Half of the surface is above its mean, a sixth above one rms height (15.87 % of a Gaussian)."""
    law = BearingArea(0.5e-6)
    assert law.contact_area([0.0, law.h_rms]) == pytest.approx([0.5, 0.158655], rel=1e-5)


def test_microscale_table_is_the_closure():
    """External pressure is that of Eq. 9, attraction that across the equivalent air gap (Eq. 12), to roundoff."""
    scene = Scene()
    law = scene.roughness.bearing_area(scene.h_0)
    for row in microscale.table(scene, [100.0, 200.0], [5e3, 5e4]):
        assert row["p_ext"] == pytest.approx(float(law.external_pressure(row["u_bar"], row["voltage"])), rel=1e-9)
        across = 8.854e-12 * row["voltage"] ** 2 / 2 / (scene.h_0 + row["d_eq"]) ** 2
        assert row["p_el"] == pytest.approx(across, rel=1e-9)


def test_microscale_refuses(capsys):
    assert refused(capsys, "microscale", "--p", "0:1e5:3").startswith("--p has the value 0.0;")


# -- params ------------------------------------------------------------------------------------------------
def test_params_as_a_scene_is_the_default(tmp_path, capsys):
    assert main(["params", "--toml"]) == 0
    file = tmp_path / "scene.toml"
    file.write_text(capsys.readouterr().out, encoding="utf-8")
    assert load(file) == Scene()


def test_every_key_is_listed():
    """Those that a scene writes down are among them, with a meaning, a unit where it has one, and a range."""
    found = {key.name: key for key in keys.every()}
    named = {key for key in _flat(Scene().parameters())}
    assert named <= set(found)
    assert (found["roughness.h_rms"].unit, found["roughness.h_rms"].default) == ("m", 3.1e-6)
    assert found["roughness.h_rms"].meaning.startswith("Root mean square height")
    assert found["mesh.touching_half_arc"].allowed == "1e-06 to 0.2"
    assert found["contact.formulation"].allowed == '"penalty", "nitsche", "augmented"'
    assert found["geometry.ridge_count"].allowed == "whole, 1 to 101"
    assert found["history[].name"].required


def _flat(data: dict, table: str = "") -> list[str]:
    return [k for n, v in data.items() for k in (_flat(v, f"{table}{n}.") if isinstance(v, dict) else [table + n])]


def test_params_refuses_a_filter_without_keys(capsys):
    assert refused(capsys, "params", "zebra").startswith("no key of a scene has zebra in its name")


# -- check and mesh ----------------------------------------------------------------------------------------
def test_check(tmp_path, capsys):
    """Loads in order, what is left out with its reason, and a picture."""
    argv = ["check", "--set", "voltage=0", "--out", str(tmp_path)]
    assert main([*argv, *(word for text in COARSE for word in ("--set", text))]) == 0
    text = capsys.readouterr().out
    assert text.index("1. press: force to 75 N/m") < text.index("3. slide: bone sideways to 5 mm, or until full slip")
    assert "attraction and the air gaps of the ridges: no load has a voltage" in text
    assert "friction: Coulomb(mu_f=0.25)" in text and "closure: none" in text
    assert (tmp_path / "mesh.png").stat().st_size > 10_000


def test_rule_of_the_cost_is_that_of_kept_runs():
    """Shares, factors and time are the default run's of docs/chart.json; factorisations fit docs/models.json."""
    points = {point["label"]: point for point in kept("chart.json")["points"]}
    work = points["default"]["work"]
    slip, charged, pressed = work["slip"], work["normal"], work["uncharged"]
    shares = {"force": pressed / slip, "voltage": (charged - pressed) / slip, "slide": (slip - charged) / slip}
    assert cost.SHARES == pytest.approx(shares, abs=0.01)
    at_10_um = points["10 µm"]["work"]["slip"]
    for name, label in (("nitsche", "Nitsche, γ_0 = 1"), ("augmented", "augmented Lagrangian")):
        assert cost.FORMULATIONS[name] == pytest.approx(points[label]["work"]["slip"] / at_10_um, rel=0.01)
    own = ("contact size", "growth", "all sizes", "element", "formulation", "solver", "steps")
    took = [p["seconds"]["slip"] / p["work"]["slip"] for p in points.values() if p["family"] in own and p["seconds"]]
    assert cost.SECONDS == pytest.approx(np.median(took), rel=0.02)
    for name, found in kept("models.json")["scenes"].items():
        f_ext, voltage = (float(part.split()[0]) for part in name.split(","))
        scene = from_data({"f_ext": f_ext, "voltage": voltage})
        ratio = cost.expected(scene, plan(scene)).factorisations / found["full"]["cost"]["factorisations"]
        assert 0.5 < ratio < 2, name


def test_cost_of_a_press_is_a_part():
    scene = from_data({"history": [{"name": "press", "f_ext": 75.0}]})
    assert cost.expected(scene, plan(scene)).factorisations == pytest.approx(0.26 * 160)


def test_mesh_is_read_again_with_its_names(tmp_path, capsys):
    """Lengths in m, groups by name; a facet of 30 um takes 1 um off the tip of a ridge, of a radius of 0.12 mm."""
    import gmsh

    file = tmp_path / "finger.msh"
    assert main(["mesh", "--out", str(file), *(word for text in COARSE for word in ("--set", text))]) == 0
    assert "ridges that can touch" in capsys.readouterr().out
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(file))
        groups = {gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups()}
        y = gmsh.model.mesh.getNodes()[1].reshape(-1, 3)[:, 1]
    finally:
        gmsh.finalize()
    assert {"stratum corneum", "dermis", "bone rim", "outer skin", "ridge 0", "ridge -1"} <= groups
    assert y.min() == pytest.approx(0, abs=2e-6)
    assert y.max() == pytest.approx(Scene().geometry.height, rel=1e-3)  # chords of an ellipse


def test_mesh_refuses_another_name(capsys):
    assert "does not end with .msh" in refused(capsys, "mesh", "--out", "finger.stl")


# -- topography --------------------------------------------------------------------------------------------
def heights(folder: Path) -> np.ndarray:
    found = SelfAffine().surface((64, 64), (400e-6, 400e-6), 3).heights * 1e6
    found[np.random.default_rng(1).random(found.shape) < 0.03] = np.nan
    return found


def table_of(text: str) -> dict[str, float]:
    lines = text.partition("[roughness]\n")[2].splitlines()
    return {line.split(" = ")[0]: float(line.split(" = ")[1]) for line in lines if " = " in line}


def test_topography_whatever_the_layout(tmp_path, capsys):
    """Semicolons and decimal commas with empty places, and points x, y, z without them: the same table."""
    h = heights(tmp_path)
    comma = "\n".join(";".join("" if np.isnan(v) else f"{v:.6f}".replace(".", ",") for v in row) for row in h)
    (tmp_path / "map.csv").write_text("height in um\n" + comma)
    x, y = np.meshgrid(*(np.arange(64) * 6.25,) * 2, indexing="ij")
    points = np.stack([x, y, h], axis=-1).reshape(-1, 3)
    np.savetxt(tmp_path / "map.xyz", points[np.isfinite(points[:, 2])], fmt="%.6f")
    found = []
    for words in (
        ["map.csv", "--pixel", "6.25", "6.25"],
        ["map.csv", "--size", "0.4", "0.4", "--size-unit", "mm"],
        ["map.xyz"],
    ):
        assert main(["topography", str(tmp_path / words[0]), "--unit", "um", *words[1:]]) == 0
        text = capsys.readouterr().out
        assert "pixels missing" in text and "Hurst exponent" in text
        found.append(table_of(text))
    assert found[0] == found[1] == found[2]
    assert (
        load(None, {f"roughness.{key}": value for key, value in found[0].items()}).roughness.h_rms == found[0]["h_rms"]
    )


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        ("1 2 3 4\n" * 4, ["--size", "1", "1"], "holds numbers without a unit; give --unit"),
        ("1 2 3 4\n" * 4, ["--unit", "um"], "holds heights alone; give --size or --pixel too"),
        ("1 2 3 4\n1 2 3\n", ["--unit", "um", "--size", "1", "1"], "line 2 has 3 of them, the first one 4"),
        ("1 2 3 4\n1 2 x 4\n", ["--unit", "um", "--size", "1", "1"], "line 2 has 'x'; a mark of missing pixels"),
        ("1 2 nan nan\n" * 4, ["--unit", "um", "--size", "1", "1"], "8 of 16 heights are missing or infinite"),
        ("no numbers\n", ["--unit", "um", "--size", "1", "1"], "no line starts with one"),
    ],
)
def test_topography_refuses(text, options, message, tmp_path, capsys):
    (tmp_path / "map.txt").write_text(text)
    assert message in refused(capsys, "topography", str(tmp_path / "map.txt"), *options)


# -- studies -----------------------------------------------------------------------------------------------
def test_study_of_a_file_and_of_options(tmp_path):
    """Keys of a table may be dotted, ranges are written alike, and an option wins over the file."""
    file = tmp_path / "study.toml"
    file.write_text('friction = 0.3\n[sweep]\nvoltage = "0:200:3"\nf_ext = [25, 75]\nroughness.h_rms = [2e-6, 3e-6]\n')
    base, axes = sweep.study(file, ["slide_length=1e-3"], ["voltage=50"])
    assert base == {"friction": 0.3, "slide_length": 1e-3}
    assert axes == {"voltage": [50.0], "f_ext": [25, 75], "roughness.h_rms": [2e-6, 3e-6]}


def test_sweep_prints_and_keeps_a_table(tmp_path, capsys):
    """A range with a unit; values come out in SI."""
    argv = ["sweep", "--over", "voltage=0:0.2:2 kV", "--model", "cylinders", "--out", str(tmp_path)]
    assert main(argv) == 0
    assert "apparent" not in capsys.readouterr().err
    with (tmp_path / "table.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["voltage"]) for row in rows] == [0.0, 200.0]
    assert float(rows[0]["slip_mu_app"]) == pytest.approx(0.25, rel=1e-12)


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        ([], "nothing is varied; give a table [sweep]"),
        (["--over", "voltage"], "--over voltage is no KEY=RANGE"),
        (["--over", "voltage=0:1"], "--over voltage is 0:1; write one value"),
        (["--over", "voltage=0,-5"], "voltage is -5 V; it must be"),
        (["--over", "volts=0,5"], "volts is not a key of a scene; did you mean voltage?"),
        (["--over", "voltage=0,5", "--set", "voltage=5"], "--set voltage is given and voltage is varied"),
        (["--over", "voltage=0:200:200", "--over", "f_ext=1:200:200"], "the sweep has 40000 points"),
    ],
)
def test_sweep_refuses(argv, message, capsys, tmp_path):
    assert refused(capsys, "sweep", *argv, "--out", str(tmp_path / "new")).startswith(message)
    assert not list(tmp_path.iterdir())


# -- models side by side -----------------------------------------------------------------------------------
def test_compare_prints_keys_and_notes(capsys):
    assert main(["compare", "--model", "cylinders", "--set", "f_ext=50", "--set", "voltage=0"]) == 0
    printed = capsys.readouterr().out
    assert "0.25" in next(line for line in printed.splitlines() if "full slip: apparent friction" in line)
    assert "uncharged contact length interpolated" in printed


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["--ridges", "3"], "one of --contact-length and --ridges is given without the other"),
        (["--model", "smooth", "--ridges", "3"], "--ridges is given without the model cylinders"),
    ],
)
def test_compare_refuses(argv, message, capsys):
    assert refused(capsys, "compare", *argv).startswith(message)


# -- what every run is checked for -------------------------------------------------------------------------
SLIP = {"f_contact": 100.0, "f_electrostatic": 25.0, "f_ext": 75.0, "f_t": -25.0, "voltage": 200.0, "mu_app": 1 / 3}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, ""),
        ({"f_ext": 75.1}, "out of balance by -0.1 N/m"),
        ({"f_t": 25.1}, "friction at full slip is 25.1 N/m and its limit 25 N/m"),
    ],
)
def test_balance_and_cone(change, words):
    """Errors of 0.1 N/m are a thousand times what the solves leave."""
    slip = ContactState(**(SLIP | {"ridges_in_contact": 3, "contact_length": 1e-3} | change))
    found = balance.broken(slip, 1e-4, 0.25)
    assert words in found and bool(found) == bool(words)
    assert balance.broken(None, 1e-4, 0.25) == ""


def test_friction_of_another_law_is_not_compared_with_coulomb_s():
    slip = ContactState(**(SLIP | {"ridges_in_contact": 3, "contact_length": 1e-3, "f_t": 30.0}))
    assert balance.broken(slip, 1e-4, None) == ""


# -- a person, or a file -----------------------------------------------------------------------------------
class Screen:
    def __init__(self, terminal: bool) -> None:
        self.terminal = terminal

    def isatty(self) -> bool:
        return self.terminal


@pytest.fixture
def bare(monkeypatch):
    for name in (*terminal._RANKS, "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    return monkeypatch


def test_a_person_watches_a_terminal(bare):
    assert terminal.watched(Screen(True))
    assert not terminal.watched(Screen(False))


@pytest.mark.parametrize(("name", "value"), [("NO_COLOR", "1"), ("TERM", "dumb"), ("PMIX_RANK", "1")])
def test_nobody_watches(bare, name, value):
    """Nor the ranks beside rank 0, whose output goes to the same terminal."""
    bare.setattr("os.readlink", lambda path: "/dev/pts/3")
    bare.setenv(name, value)
    assert not terminal.watched(Screen(True))


@pytest.mark.parametrize(("output", "watches"), [("/dev/pts/3", True), ("/tmp/log", False), ("pipe:[17]", False)])
def test_the_launchers_output_counts(bare, output, watches):
    """mpirun prints through a terminal of its own whatever its output goes to."""
    bare.setenv("OMPI_COMM_WORLD_RANK", "0")
    bare.setattr("os.readlink", lambda path: output)
    assert terminal.watched(Screen(True)) == watches


def test_scene_may_name_a_height_map(tmp_path, capsys):
    """Beside the scene file; h_rms and wavelength are those that the command prints, to its four digits."""
    h = SelfAffine().surface((64, 64), (400e-6, 400e-6), 3).heights
    np.savetxt(tmp_path / "skin.csv", h * 1e6, delimiter=";")
    (tmp_path / "scene.toml").write_text(
        '[roughness.topography]\nfile = "skin.csv"\nunit = "um"\nsize = [0.4, 0.4]\nsize_unit = "mm"\n'
    )
    scene = load(tmp_path / "scene.toml")
    size = ("--size", "400", "400")
    assert main(["topography", str(tmp_path / "skin.csv"), "--unit", "um", *size]) == 0
    table = table_of(capsys.readouterr().out)
    assert (scene.roughness.h_rms, scene.roughness.wavelength) == pytest.approx(
        (table["h_rms"], table["wavelength"]), rel=1e-3
    )
    again = from_data(scene.parameters())
    assert again == scene and scene.replace(voltage=100.0).roughness == scene.roughness


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"file": "none.csv", "unit": "um"}, "roughness.topography.file is 'none.csv': No such file"),
        ({"file": "none.csv"}, "roughness.topography.unit is missing"),
        ({"file": "none.csv", "unit": "inch"}, "roughness.topography.unit is 'inch'; it must be 'm'"),
        ({"fil": "none.csv"}, "roughness.topography.file is missing"),
        ("skin.csv", "roughness.topography is 'skin.csv'; it must be a table of keys"),
    ],
)
def test_bad_height_map_of_a_scene(table, message):
    with pytest.raises(SceneError) as refusal:
        from_data({"roughness": {"topography": table}})
    assert str(refusal.value).startswith(message)


def test_height_map_and_its_numbers_are_refused():
    with pytest.raises(SceneError, match="roughness.h_rms is 3e-06 and roughness.topography is given too"):
        from_data({"roughness": {"h_rms": 3e-6, "topography": {"file": "skin.csv", "unit": "um"}}})
