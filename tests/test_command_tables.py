"""Commands that print tables: closed form, microscale, keys, studies and models side by side."""

import re
import shlex

import pytest

import fingerpad as fp
from fingerpad.cli import estimate, main, ranges, roughness, sweep
from fingerpad.reduced import cylinders
from fingerpad.runs.sweep import sweep as run_sweep
from fingerpad.scene import Scene, from_data, keys, load
from tests.commands import ROOT, refused
from tests.measures import rows_of
from variational.roughness.bam import BearingArea


# -- estimate ----------------------------------------------------------------------------------------------
def test_estimate_is_the_closed_form(tmp_path, capsys):
    file = tmp_path / "mu.csv"
    assert main(["estimate", "--f-ext", "50,75", "--voltage", "0:100:2", "--csv", str(file)]) == 0
    out = capsys.readouterr().out
    assert "\n±: error by closed form, points of the traces; what the finger and the model assume is not in it" in out
    rows = rows_of(tmp_path, "mu")
    loads = [(float(r["f_ext_of_section"]), float(r["voltage"])) for r in rows]
    assert loads == [(50, 0), (50, 100), (75, 0), (75, 100)]
    one = cylinders.solve(from_data({"f_ext": 75.0, "voltage": 100.0})).full_slip
    assert float(rows[-1]["mu_app_of_section"]) == one.mu_app
    assert float(rows[0]["mu_app_of_section"]) == pytest.approx(0.25, rel=1e-12)


def test_estimate_has_the_whole_finger_first(tmp_path, capsys):
    """With newtons and without: the same finger, that of a run whose centre bears 75 N/m. Four digits are printed."""
    assert main(["estimate", "--voltage", "0,200", "--csv", str(tmp_path / "one.csv")]) == 0
    assert capsys.readouterr().out.startswith("Friction of the whole finger at full slip")
    _, charged = rows_of(tmp_path, "one")
    assert main(["estimate", "--force", charged["force"], "--voltage", "200", "--csv", str(tmp_path / "two.csv")]) == 0
    (again,) = rows_of(tmp_path, "two")
    assert float(charged["mu_app"]) == pytest.approx(float(again["mu_app"]), rel=1e-9)
    assert float(charged["mu_app"]) > float(charged["mu_app_of_section"])
    finger = fp.run(Scene(force=float(charged["force"])), model="cylinders").finger
    assert float(again["mu_app"]) == pytest.approx(finger.states["full_slip"].mu_app, rel=1e-12)
    assert fp.run(Scene(), model="cylinders").finger.f_ext == pytest.approx(float(charged["force"]), rel=1e-4)


def test_errors_are_drawn_and_forces_have_their_unit(tmp_path, monkeypatch):
    """A band about each curve, as high as the ± of the table, and N in the legend."""
    figures = []
    monkeypatch.setattr("fingerpad.results.style.save", lambda figure, file: figures.append(figure))
    rows, _ = estimate.grid(Scene(), [0.3, 0.5], [0.0, 100.0, 200.0], "force")
    estimate.draw("force", tmp_path / "mu.png", rows)
    (ax,) = figures[0].axes
    bands = [each.get_paths()[0].vertices for each in ax.collections]
    assert len(bands) == 2
    for band, force in zip(bands, (0.3, 0.5), strict=True):
        (row,) = (each for each in rows if each["force"] == force and each["voltage"] == 200.0)
        heights = band[band[:, 0] == 200.0, 1]
        assert heights.max() - heights.min() == pytest.approx(2 * row["mu_app_error"], rel=1e-9)
    legend, (canvas, label) = ax.get_legend(), (figures[0].canvas, ax.yaxis.label)
    canvas.draw()
    assert label.get_window_extent().height < figures[0].bbox.height
    assert [text.get_text() for text in legend.get_texts()] == ["0.3 N", "0.5 N"]
    assert "band: ± error" in legend.get_title().get_text()


def test_estimate_without_a_whole_finger_has_the_section(capsys):
    """Under 4 kN/m at its centre the contact is longer than the finger."""
    assert main(["estimate", "--f-ext", "4000"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("Friction of the section at full slip")
    assert "At 4000 N/m there is no whole finger: the finger ends at" in text


def test_estimate_says_where_its_error_is_not_known(capsys):
    assert main(["estimate", "--f-ext", "75,5000", "--set", "roughness.gamma=0.6"]) == 0
    text = capsys.readouterr().out
    assert re.search(r"At 1 of 2 points the error is not known; it is known for f_ext [\d.]+ to \d+ N/m\.\n", text)
    assert "Here the error is not known; it is known for roughness.gamma 0.5." in text


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("estimate --f-ext=-5,20", "f_ext is -5 N/m"),
        ("estimate --set geometry.width=19e-3", "geometry is not that of the default"),
        ("estimate --csv nowhere/mu.csv", "its folder is not there"),
        ("estimate demos/scenes/unload.toml", "history is given; the model 'cylinders' answers for press, charge and"),
        ("microscale --p 0:1e5:3", "--p: 0.0 is not allowed; it must be greater than 0"),
        ("microscale demos/scenes/sine_while_sliding.toml", "name those wanted by --voltage"),
        ("estimate --plot mu.txt", "mu.txt cannot be a picture; its name must end with one of .png"),
        ("params zebra", "no key of a scene has zebra in its name"),
        ("mesh --out finger.stl", "finger.stl cannot be a mesh; its name must end with .msh"),
        ("sweep --over model=full,cylinders", "model is varied and is no key of a scene; a sweep has one model"),
        ("sweep --over out=1,2 --model cylinders", "out is varied and is no key of a scene"),
        ("compare --ridges 3", "one of --contact-length and --ridges is given without the other"),
        ("compare --run none --model cylinders", "none is not a folder of a finished run"),
        ("compare --contact-length 1.58 --ridges 16", "--contact-length is 1580 mm, longer than 16 ridges, 7.73 mm"),
        ("estimate --f-ext 75 --set f_ext=50", "--set f_ext is given and --f-ext too; give one of"),
        ("estimate --voltage -200:200:3", "has an equals sign before it; write --voltage=-200:200:3"),
        ("run --force '-0.5 N'", "has an equals sign before it; write --force='-0.5 N'"),
    ],
)
def test_bad_command_line(capsys, line, words):
    assert words in refused(capsys, *shlex.split(line))


# -- microscale --------------------------------------------------------------------------------------------
def test_real_area_is_the_bearing_area():
    """Half of the surface is above its mean, a sixth above one rms height (15.87 % of a Gaussian)."""
    law = BearingArea(0.5e-6)
    assert law.contact_area([0.0, law.h_rms]) == pytest.approx([0.5, 0.158655], rel=1e-5)


def test_microscale_table_is_the_closure():
    """External pressure is that of Eq. 9, attraction that across the equivalent air gap (Eq. 12), to roundoff."""
    scene = Scene()
    law = scene.closure()
    for row in roughness.table(scene, [100.0, 200.0], [5e3, 5e4]):
        assert row["p_ext"] == pytest.approx(float(law.external_pressure(row["u_bar"], row["voltage"])), rel=1e-9)
        across = 8.854e-12 * row["voltage"] ** 2 / 2 / (scene.h_0 + row["d_eq"]) ** 2
        assert row["p_el"] == pytest.approx(across, rel=1e-9)


# -- params ------------------------------------------------------------------------------------------------
def test_params_as_a_scene_is_the_default(tmp_path, capsys):
    assert main(["params", "--toml"]) == 0
    file = tmp_path / "scene.toml"
    file.write_text(capsys.readouterr().out, encoding="utf-8")
    assert load(file) == Scene()


def test_every_key_is_listed():
    """Those that a scene writes down are among them, with a meaning, a unit where it has one, and a range."""
    found = keys.by_name(Scene)
    named = {key for key in _flat(Scene().parameters())}
    assert named <= set(found)
    assert (found["roughness.h_rms"].unit, found["roughness.h_rms"].default) == ("m", 3.1e-6)
    assert found["roughness.h_rms"].meaning.startswith("Root mean square height")
    assert found["mesh.touching_half_arc"].allowed == "1e-06 to 0.2"
    assert found["contact.formulation"].allowed == '"penalty", "nitsche", "augmented" or module:Class'
    assert found["geometry.ridge_count"].allowed == "whole, 1 to 101"
    assert found["history[].name"].required


def test_each_law_has_its_own_range_and_meaning():
    """Of a name that several laws have: that of Coulomb's coefficient is not that of Speed's."""
    rows = [key for key in keys.every(Scene) if key.name == "friction.mu_f"]
    assert {key.meaning.rpartition(" Of ")[2]: key.allowed for key in rows} == {
        "Coulomb alone.": "0 or 1e-06 to 2",
        "Derjaguin alone.": "0 or 1e-06 to 2",
        "Speed alone.": "1e-06 to 5",
    }
    with pytest.raises(fp.SceneError, match="friction.mu_f is 6; it must be from 1e-06 to 5"):
        from_data({"friction": {"law": "Speed", "mu_f": 6.0}})


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


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        ([], "nothing is varied; give a table [sweep]"),
        (["--over", "voltage"], "--over voltage is no KEY=RANGE"),
        (["--over", "voltage=0,5", "--over", "voltage=9"], "--over voltage is given twice"),
        (["--over", "voltage=0,-5500"], "voltage is -5500 V; it must be"),
        (["--over", "volts=0,5"], "volts is not a key of a scene; did you mean voltage?"),
        (["--over", "voltage=0,5", "--set", "voltage=5"], "--set voltage is given and voltage is varied"),
        (["--over", "voltage=5,5"], "voltage of the sweep is [5, 5]; each value must be there once"),
    ],
)
def test_sweep_refuses(argv, message, capsys, tmp_path):
    assert refused(capsys, "sweep", *argv, "--out", str(tmp_path / "new")).startswith(message)
    assert not list(tmp_path.iterdir())


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


# -- models side by side -----------------------------------------------------------------------------------
def test_compare_says_why_a_model_has_no_values(capsys):
    """In one sentence below a column of dashes."""
    assert main(["compare", str(ROOT / "demos" / "scenes" / "small_finger.toml"), "--model", "cylinders"]) == 1
    out = capsys.readouterr().out
    assert "cylinders: no values, since geometry is not that of the default finger" in out


def test_compare_takes_a_length_with_a_unit(capsys):
    printed = []
    for length in ("1.58 mm", "1.58e-3"):
        assert main(["compare", "--model", "cylinders", "--contact-length", length, "--ridges", "16"]) == 0
        printed.append([line for line in capsys.readouterr().out.splitlines() if "seconds" not in line])
    assert any("contact length" in line and "1.5800" in line for line in printed[0])
    assert [line for line in printed[0] if "time" not in line] == [line for line in printed[1] if "time" not in line]


def test_sweep_over_keys_that_need_each_other_and_whole_numbers(tmp_path):
    """Only the points are checked: a value may need that of another axis. Some keys take whole numbers alone."""
    axes = {"contact.formulation": ["nitsche"], "contact.gamma_0": [1, 2]}
    found = run_sweep(Scene(), tmp_path, model="cylinders", **axes)
    assert [result.scene.contact.gamma_0 for result in found] == [1.0, 2.0]
    for text in ("55,57", "55:59:3", "-3"):
        assert all(isinstance(value, int) for value in ranges.read("x", text))
    assert [type(value) for value in ranges.read("x", "0:1:3")] == [float] * 3
