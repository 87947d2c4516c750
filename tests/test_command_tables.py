"""Commands that print tables: closed form, microscale, keys, studies and models side by side."""

import csv
import errno
import re
from pathlib import Path

import pytest

from fingerpad.cli import estimate, main, microscale, sweep, tables
from fingerpad.io import style
from fingerpad.io.result import Result
from fingerpad.reduced import cylinders
from fingerpad.runs.sweep import sweep as run_sweep
from fingerpad.scene import Scene, SceneError, from_data, keys, load
from fingerpad.scene.remarks import LEAKAGE
from tests.commands import refused
from variational.roughness.bam import BearingArea


# -- estimate ----------------------------------------------------------------------------------------------
def test_estimate_is_the_closed_form(tmp_path, capsys):
    file = tmp_path / "mu.csv"
    assert main(["estimate", "--f-ext", "50,75", "--voltage", "0:100:2", "--csv", str(file)]) == 0
    out = capsys.readouterr().out
    assert "Known error: mu_app and friction within 2.4 %, attraction within 5.0 %, contact within 6.3 % of 44" in out
    assert out.count(LEAKAGE) == 1
    with file.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [(float(r["f_ext"]), float(r["voltage"])) for r in rows] == [(50, 0), (50, 100), (75, 0), (75, 100)]
    one = cylinders.solve(from_data({"f_ext": 75.0, "voltage": 100.0})).full_slip
    assert float(rows[-1]["mu_app"]) == one.mu_app
    assert float(rows[0]["mu_app"]) == pytest.approx(0.25, rel=1e-12)


def test_zeros_have_no_sign():
    """As of friction that is roundoff, or of a friction coefficient of 0."""
    assert [tables.Column("f_t", "friction", digits=digits).cell(-0.0) for digits in (".4g", ".3f")] == ["0", "0.000"]


def test_estimate_says_where_its_error_is_not_known(capsys):
    assert main(["estimate", "--f-ext", "75,500", "--set", "friction=0.3"]) == 0
    text = capsys.readouterr().out
    assert "1 of 2 points are outside of that" in text
    assert "Those runs have the default friction; here the error is not known." in text


def test_estimate_draws_a_curve_for_each_force(tmp_path):
    """The picture is there; the labels are those of the forces."""
    rows, _ = estimate.grid(Scene(), [25.0, 75.0], [0.0, 100.0])
    estimate.draw(tmp_path / "mu.png", rows)
    assert (tmp_path / "mu.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("command", "voltages"),
    [
        (estimate, [0.0]),
        (estimate, [-100.0]),
        (microscale, [0.0]),
        (microscale, [-100.0, 0.0]),
        (microscale, [-100.0, -50.0]),
        (microscale, [-100.0, 50.0]),
    ],
)
def test_colours_of_voltages_go_up_to_the_largest_amount(command, voltages, tmp_path, monkeypatch):
    """It may be zero or of a negative voltage; the sign does not change a colour."""
    drawn, colour = [], style.voltage
    monkeypatch.setattr(style, "voltage", lambda *args: drawn.append(args) or colour(*args))
    monkeypatch.setattr(style, "save", lambda figure, file: None)
    if command is estimate:
        rows, _ = estimate.grid(Scene(), [25.0, 75.0], voltages)
    else:
        rows = microscale.table(Scene(), voltages, [5e3, 5e4])
    command.draw(tmp_path / "plot.png", rows)
    assert [args[0] for args in drawn] == voltages
    assert {abs(args[1]) for args in drawn} == {max(map(abs, voltages))}
    assert [colour(*args) for args in drawn] == [colour(abs(a), max(map(abs, voltages)) or 1.0) for a in voltages]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("estimate --f-ext=-5,20", "f_ext is -5 N/m"),
        ("estimate --set geometry.width=19e-3", "geometry is not that of the default"),
        ("estimate --csv nowhere/mu.csv", "its folder is not there"),
        ("estimate --plot same.png --csv same.png", "same.png is given twice, once to be written;"),
        ("estimate demos/scenes/unload.toml", "history is given; the model 'cylinders' answers for press, charge and"),
        ("microscale --p 0:1e5:3", "--p: 0.0 is not allowed; it must be greater than 0"),
        ("microscale demos/scenes/sine_while_sliding.toml", "name those wanted by --voltage"),
        ("params zebra", "no key of a scene has zebra in its name"),
        ("compare --ridges 3", "one of --contact-length and --ridges is given without the other"),
        ("compare --run none --model cylinders", "none is not a folder of a finished run"),
        ("compare --model full --ridges 3", "--ridges is given without the model cylinders"),
        ("compare --contact-length 1.58 --ridges 16", "--contact-length is 1580 mm, longer than 16 ridges, 7.73 mm"),
        ("compare --contact-length 1.58mm --ridges 60", "--ridges is 60, and the finger has 55; count those that"),
        ("compare --contact-length 1.58N --ridges 16", "1.58N is not allowed"),
    ],
)
def test_bad_command_line(capsys, line, words):
    assert words in refused(capsys, *line.split())


def test_estimate_says_where_the_closure_ends(capsys):
    assert main(["estimate", "--set", "roughness.h_rms=1e-7", "--f-ext", "25,75"]) == 0
    words = "In 2 of 2 states the closure is out of its range: the mean pressure of ridges is beyond zero separation."
    assert words in capsys.readouterr().out


def test_file_that_cannot_be_written_is_named(capsys, tmp_path, monkeypatch):
    """As on a disk that is full: in a sentence, after the table."""

    def full(file, data):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    assert main(["estimate", "--csv", str(tmp_path / "mu.csv")]) == 2
    said = capsys.readouterr()
    assert "mu_app" in said.out and "mu.csv cannot be used: No space left on device" in said.err


def test_file_in_a_folder_that_takes_none_is_named(capsys, tmp_path, monkeypatch):
    """As it was given, where the file that is written first cannot be deleted either: on a read-only disk."""

    def read_only(file, *data, **options):
        raise OSError(errno.EROFS, "Read-only file system", str(file))

    monkeypatch.setattr(Path, "write_bytes", read_only)
    monkeypatch.setattr(Path, "unlink", read_only)
    monkeypatch.chdir(tmp_path)
    assert main(["estimate", "--csv", "mu.csv"]) == 2
    assert capsys.readouterr().err == "fingerpad: mu.csv cannot be used: Read-only file system\n"


# -- microscale --------------------------------------------------------------------------------------------
def test_real_area_is_the_bearing_area():
    """Half of the surface is above its mean, a sixth above one rms height (15.87 % of a Gaussian)."""
    law = BearingArea(0.5e-6)
    assert law.contact_area([0.0, law.h_rms]) == pytest.approx([0.5, 0.158655], rel=1e-5)


def test_microscale_table_is_the_closure():
    """External pressure is that of Eq. 9, attraction that across the equivalent air gap (Eq. 12), to roundoff."""
    scene = Scene()
    law = scene.closure()
    for row in microscale.table(scene, [100.0, 200.0], [5e3, 5e4]):
        assert row["p_ext"] == pytest.approx(float(law.external_pressure(row["u_bar"], row["voltage"])), rel=1e-9)
        across = 8.854e-12 * row["voltage"] ** 2 / 2 / (scene.h_0 + row["d_eq"]) ** 2
        assert row["p_el"] == pytest.approx(across, rel=1e-9)


def test_microscale_of_a_history(capsys):
    """Its skin and screen, at voltages that are given: the default's is none of its own."""
    file = "demos/scenes/sine_while_sliding.toml"
    assert main(["microscale", file, "--voltage", "100", "--p", "61 kPa"]) == 0
    assert re.search(r"^ +100 +61 ", capsys.readouterr().out, re.MULTILINE)


# -- params ------------------------------------------------------------------------------------------------
def test_params_as_a_scene_is_the_default(tmp_path, capsys):
    assert main(["params", "--toml"]) == 0
    file = tmp_path / "scene.toml"
    file.write_text(capsys.readouterr().out, encoding="utf-8")
    assert load(file) == Scene()


def test_every_key_is_listed():
    """Those that a scene writes down are among them, with a meaning, a unit where it has one, and a range."""
    found = {key.name: key for key in keys.every(Scene)}
    named = {key for key in _flat(Scene().parameters())}
    assert named <= set(found)
    assert (found["roughness.h_rms"].unit, found["roughness.h_rms"].default) == ("m", 3.1e-6)
    assert found["roughness.h_rms"].meaning.startswith("Root mean square height")
    assert found["mesh.touching_half_arc"].allowed == "1e-06 to 0.2"
    assert found["contact.formulation"].allowed == '"penalty", "nitsche", "augmented" or module:Class'
    assert found["geometry.ridge_count"].allowed == "whole, 1 to 101"
    assert found["history[].name"].required


def _flat(data: dict, table: str = "") -> list[str]:
    return [k for n, v in data.items() for k in (_flat(v, f"{table}{n}.") if isinstance(v, dict) else [table + n])]


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
    assert float(rows[0]["full_slip_mu_app"]) == pytest.approx(0.25, rel=1e-12)


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        ([], "nothing is varied; give a table [sweep]"),
        (["--over", "voltage"], "--over voltage is no KEY=RANGE"),
        (["--over", "voltage=0:1"], "--over voltage is 0:1; write one value"),
        (["--over", "voltage=0,-5500"], "voltage is -5500 V; it must be"),
        (["--over", "volts=0,5"], "volts is not a key of a scene; did you mean voltage?"),
        (["--over", "voltage=0,5", "--set", "voltage=5"], "--set voltage is given and voltage is varied"),
        (["--over", "voltage=0,5", "--over", "voltage=9"], "--over voltage is given twice"),
        (["--over", "voltage=5,5"], "voltage of the sweep is [5, 5]; each value must be there once"),
        (["--over", "voltage=0:200:200", "--over", "f_ext=1:200:200"], "the sweep has 40000 points"),
    ],
)
def test_sweep_refuses(argv, message, capsys, tmp_path):
    assert refused(capsys, "sweep", *argv, "--out", str(tmp_path / "new")).startswith(message)
    assert not list(tmp_path.iterdir())


def test_sweep_over_words_switches_and_whole_numbers(tmp_path, capsys):
    """Points are read; that the closed form is of one finger fails some of them and no other."""
    axes = ["contact.formulation=penalty,nitsche", "output.errors=true,false", "geometry.ridge_count=55:57:2"]
    assert main(["sweep", *(f"--over={axis}" for axis in axes), "--model=cylinders", f"--out={tmp_path}"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert [sum(f" {word} " in f" {line}" for line in lines) for word in ("nitsche", "true", "55")] == [4, 4, 4]
    assert sum("is not that of the default finger" in line for line in lines) == 6


def test_sweep_head_has_units(tmp_path):
    found = run_sweep(Scene(), tmp_path, model="cylinders", **{"roughness.h_rms": [2e-6, 3e-6]})
    assert "roughness.h_rms (m)" in str(found)


def test_sweep_over_keys_that_need_each_other(tmp_path):
    """Only the points are checked: a value may need that of another axis."""
    axes = {"contact.formulation": ["nitsche"], "contact.gamma_0": [1, 2]}
    found = run_sweep(Scene(), tmp_path, model="cylinders", **axes)
    assert [result.scene.contact.gamma_0 for result in found] == [1.0, 2.0]


def test_files_of_a_study_are_beside_it(tmp_path):
    text = """[sweep]
    "geometry.file" = ["a.msh", "sub/b.msh"]
    roughness.topography.file = ["map.npy"]
    """
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    _, axes = sweep.study(tmp_path / "study.toml", [], [])
    assert axes["geometry.file"] == [str(tmp_path / "a.msh"), str(tmp_path / "sub" / "b.msh")]
    assert axes["roughness.topography.file"] == [str(tmp_path / "map.npy")]


def test_sweep_and_run_have_folders_of_their_own(tmp_path, capsys):
    """One would replace the other's report."""
    run, study = tmp_path / "run", tmp_path / "study"
    assert main(["run", "--model=cylinders", f"--out={run}"]) == 0
    over = "--over=voltage=0,100"
    assert main(["sweep", "--model=cylinders", over, f"--out={study}"]) == 0
    capsys.readouterr()
    assert "holds the results of a run (scene.json)" in refused(
        capsys, "sweep", "--model=cylinders", over, f"--out={run}"
    )
    assert "holds the results of a sweep" in refused(capsys, "run", "--model=cylinders", f"--out={study}")


def test_folder_of_a_sweep_that_is_a_file(tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(SceneError, match="out .*file cannot be a folder, since it is a file"):
        run_sweep(Scene(), tmp_path / "file", model="cylinders", voltage=[1.0])


# -- models side by side -----------------------------------------------------------------------------------
def test_compare_takes_a_length_with_a_unit(capsys):
    printed = []
    for length in ("1.58 mm", "1.58e-3"):
        assert main(["compare", "--model", "cylinders", "--contact-length", length, "--ridges", "16"]) == 0
        printed.append([line for line in capsys.readouterr().out.splitlines() if "seconds" not in line])
    assert any("contact length" in line and "1.5800" in line for line in printed[0])
    assert [line for line in printed[0] if "time" not in line] == [line for line in printed[1] if "time" not in line]


def test_compare_prints_keys_and_notes(capsys):
    assert main(["compare", "--model", "cylinders", "--set", "f_ext=50", "--set", "voltage=0"]) == 0
    printed = capsys.readouterr().out
    assert "0.25" in next(line for line in printed.splitlines() if "full slip: apparent friction" in line)
    assert "uncharged contact length interpolated" in printed


@pytest.mark.parametrize("name", ["", "none", "file"])
def test_folder_of_no_run(name, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(SceneError, match=rf"^{tmp_path / name} is not a folder of a finished run$"):
        Result.load(tmp_path / name)


def test_pressures_at_an_end_of_the_closure_are_counted(capsys):
    """The air gap rises with the pressure under thick insulators; without a voltage the default screen has none."""
    assert main(["microscale", "--set", "electric.d_i=100 um", "--p", "1e3:1e5:3:log"]) == 0
    words = (
        "3 of 3 pressures and voltages the closure is out of its range: the mean pressure of ridges is where d_eq rises"
    )
    assert words in capsys.readouterr().out
    assert main(["microscale", "--p", "1e3:1e5:3:log", "--voltage", "0"]) == 0
    assert "pressures and voltages" not in capsys.readouterr().out
