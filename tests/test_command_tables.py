"""Commands that print tables: closed form, microscale, keys, studies and models side by side."""

import shlex

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.cli import estimate, main, ranges, roughness, sweep
from fingerpad.runs.sweep import sweep as run_sweep
from fingerpad.scene import Scene, from_data, keys
from fingerpad.scene.parameters import FORMULATIONS
from tests.commands import ROOT, refused
from tests.measures import rows_of


# -- estimate ----------------------------------------------------------------------------------------------
def test_estimate_is_the_closed_form(tmp_path, capsys):
    """A sweep of the model "cylinders", of which nothing is kept but the table."""
    file = tmp_path / "mu.csv"
    for _ in range(2):  # its own file is replaced
        assert main(["estimate", "--f-ext", "50,75", "--voltage", "0:100:2", "--csv", str(file)]) == 0
    out = capsys.readouterr().out
    assert "\n±: error by closed form, points of the traces; what the finger and the model assume is not in it" in out
    rows = rows_of(tmp_path, "mu")
    assert [(float(r["f_ext"]), float(r["voltage"])) for r in rows] == [(50, 0), (50, 100), (75, 0), (75, 100)]
    one = fp.run(from_data({"f_ext": 75.0, "voltage": 100.0}), model="cylinders")
    assert float(rows[-1]["full_slip_mu_app"]) == one.full_slip.mu_app
    assert float(rows[-1]["full_slip_finger_mu_app"]) == one.finger.states["full_slip"].mu_app
    assert float(rows[0]["full_slip_mu_app"]) == pytest.approx(0.25, rel=1e-12)
    assert [each.name for each in tmp_path.iterdir()] == ["mu.csv"]


def drawn(monkeypatch, over, **more):
    """Return the sweep and the first panel of its picture."""
    figures = []
    monkeypatch.setattr("fingerpad.results.pictures.style.save", lambda figure, file: figures.append(figure))
    found = run_sweep(Scene(force=None if "force" in over else 0.5), None, model="cylinders", **over)
    estimate.draw(found, ROOT / "mu.png", **more)
    figures[0].canvas.draw()
    return found, figures[0].axes[0]


def test_picture_has_a_curve_with_its_error_for_each_force(monkeypatch):
    """A band about each curve, as high as the ± of the table."""
    found, ax = drawn(monkeypatch, {"force": [0.3, 0.5], "voltage": [0.0, 100.0, 200.0]})
    bands = [each.get_paths()[0].vertices for each in ax.collections]
    assert len(bands) == 2
    for band, row in zip(bands, found.rows()[2::3], strict=True):
        heights = band[band[:, 0] == 200.0, 1]
        assert heights.max() - heights.min() == pytest.approx(2 * row["full_slip_finger_mu_app_error"], rel=1e-9)
    legend = ax.get_legend()
    assert (legend.get_title().get_text(), [text.get_text() for text in legend.get_texts()]) == (
        "force (N)", ["0.3", "0.5"]
    )  # fmt: skip


def test_picture_of_two_keys_is_a_map(monkeypatch):
    """Hatched where the error is not known, and with a line through the voltage that a search finds."""
    over = {"voltage": np.linspace(0.0, 200.0, 9).tolist(), "electric.d_i": np.geomspace(2e-6, 2e-5, 7).tolist()}
    found, ax = drawn(monkeypatch, over, target=0.4)
    mesh, hatched, line = ax.collections
    assert mesh.get_array().max() == found.array("mu_app").max() and hatched.hatches == ["/"]
    (root,) = fp.solve(Scene(force=0.5, electric={"d_i": 2e-6}), mu_app=0.4).values
    (path,) = (p for p in line.get_paths() if len(p.vertices))
    across = (
        min(path.vertices.tolist()) if ax.get_xlabel().startswith("electric") else min(path.vertices[:, ::-1].tolist())
    )
    assert across == pytest.approx([2e-6, root], rel=0.01)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("estimate --f-ext=-5,20", "f_ext is -5 N/m"),
        ("estimate --csv nowhere/mu.csv", "its folder is not there"),
        ("estimate demos/scenes/unload.toml", "history is given; the model 'cylinders' answers for press, charge and"),
        ("microscale demos/scenes/sine_while_sliding.toml", "name those wanted by --voltage"),
        ("params zebra", "no key of a scene has zebra in its name"),
        ("sweep --over model=full,cylinders", "model is varied and is no key of a scene; a sweep has one model"),
        ("estimate --f-ext 75 --set f_ext=50", "--set f_ext is given and --f-ext too; give one of"),
        ("estimate --over force --f-ext 75", "--force is given and --f-ext too"),
        ("estimate --over geometry.ridge_count", "it must be a key of one number that may have a fraction"),
        ("estimate --over voltage --over friction --over force --plot a.png", "a picture is over one key or two"),
        ("estimate --voltage -200:200:3", "has an equals sign before it; write --voltage=-200:200:3"),
    ],
)
def test_bad_command_line(capsys, line, words):
    assert words in refused(capsys, *shlex.split(line))


# -- microscale --------------------------------------------------------------------------------------------


def test_microscale_table_is_the_closure():
    """External pressure is that of Eq. 9, attraction that across the equivalent air gap (Eq. 12), to roundoff."""
    scene = Scene()
    law = scene.closure()
    for row in roughness.table(scene, [100.0, 200.0], [5e3, 5e4]):
        assert row["p_ext"] == pytest.approx(float(law.external_pressure(row["u_bar"], row["voltage"])), rel=1e-9)
        across = 8.854e-12 * row["voltage"] ** 2 / 2 / (scene.h_0 + row["d_eq"]) ** 2
        assert row["p_el"] == pytest.approx(across, rel=1e-9)


# -- params ------------------------------------------------------------------------------------------------
def test_every_key_is_listed():
    """Those that a scene writes down are among them, with a meaning, a unit where it has one, and a range."""
    found = keys.by_name(Scene)
    named = {key for key in _flat(Scene().parameters())}
    assert named <= set(found)
    assert (found["roughness.h_rms"].unit, found["roughness.h_rms"].default) == ("m", 3.1e-6)
    assert found["roughness.h_rms"].meaning.startswith("Root mean square height")
    assert found["mesh.touching_half_arc"].allowed == "1e-06 to 0.2"
    names = ", ".join(f'"{name}"' for name in FORMULATIONS)
    assert found["contact.formulation"].allowed == f"{names} or module:Class"
    assert found["geometry.ridge_count"].allowed == "whole, 1 to 101"
    assert found["history[].name"].required


def test_each_law_has_its_own_range_and_meaning():
    """Of a name that several laws have: that of Coulomb's coefficient is not that of Speed's."""
    rows = [key for key in keys.every(Scene) if key.name == "friction.mu_f"]
    found = {key.meaning.rpartition(" Of ")[2]: key.allowed for key in rows}
    assert found["Coulomb alone."] == found["Derjaguin alone."] == "0 or 1e-06 to 2"
    assert found["Speed alone."] == "1e-06 to 5"
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
        (["--over", "voltage=0,-5500"], "voltage is -5500 V; it must be"),
        (["--over", "voltage=0,5", "--set", "voltage=5"], "--set voltage is given and voltage is varied"),
        (["--over", "voltage=5,5"], "voltage of the sweep is [5, 5]; each value must be there once"),
    ],
)
def test_sweep_refuses(argv, message, capsys, tmp_path):
    assert refused(capsys, "sweep", *argv, "--out", str(tmp_path / "new")).startswith(message)
    assert not list(tmp_path.iterdir())


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


def test_sweep_over_keys_that_need_each_other_and_whole_numbers(tmp_path):
    """Only the points are checked: a value may need that of another axis. Some keys take whole numbers alone."""
    axes = {"contact.formulation": ["nitsche"], "contact.gamma_0": [1, 2]}
    found = run_sweep(Scene(), tmp_path, model="cylinders", **axes)
    assert [result.scene.contact.gamma_0 for result in found] == [1.0, 2.0]
    for text in ("55,57", "55:59:3", "-3"):
        assert all(isinstance(value, int) for value in ranges.read("x", text))
    assert [type(value) for value in ranges.read("x", "0:1:3")] == [float] * 3
