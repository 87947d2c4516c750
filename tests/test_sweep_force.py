"""A sweep over the force on the whole finger: one run a scene, read at each force."""

import csv
import html
import json
import re
import shlex

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.cli import sweep as cli_sweep
from fingerpad.report.write import write
from fingerpad.runs import batch
from tests.small_finger import small

FORCES, VOLTAGES = (0.1, "200 mN", 0.5), (0.0, 200.0)
SMALL = {"output": {"receptors": False, "errors": False}, "slices": {"radius": 6e-3, "length": 8e-3}}


@pytest.fixture(scope="module")
def found(tmp_path_factory) -> fp.Sweep:
    out = tmp_path_factory.mktemp("force")
    return fp.sweep(fp.Scene(), out, model="cylinders", voltage=VOLTAGES, force=FORCES)


def test_each_point_is_the_run_under_its_force(found):
    """In the order of the axes; the sums up to what other points of the trace change, between which ridges come in."""
    assert found.axes == {"voltage": VOLTAGES, "force": (0.1, 0.2, 0.5)}
    for point, result in zip(found.points(), found, strict=True):
        alone = fp.run(fp.Scene(voltage=point["voltage"]), model="cylinders", force=point["force"])
        slip, other = (each.finger.values("full_slip") for each in (result, alone))
        assert result.finger.f_ext == pytest.approx(point["force"], rel=1e-9)
        assert slip["f_t"] == pytest.approx(other["f_t"], rel=1e-2)
    assert found.array("f_t").shape == (2, 3)
    assert found.array("f_t")[1, 2] == found[5].finger.values("full_slip")["f_t"]
    assert np.isnan(found.array("contact_area", "charged")[0]).all()  # without a voltage nothing is charged
    with pytest.raises(ValueError, match="quantity is 'contact_length'; it must be one of f_ext, mu_app"):
        found.array("contact_length")


def test_table_text_and_dataset_are_of_the_whole_finger(found):
    with (found.folder / "table.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert not [key for key in rows[0] if re.match(r"(slip|normal|uncharged)_(?!finger_)", key)]
    assert float(rows[4]["slip_finger_f_t"]) == found.array("f_t")[1, 1]
    title, heads, *lines = str(found).splitlines()
    assert title == "Whole finger, at full slip" and heads.split("   ")[1:4] == ["force (N)", " µ_app", "F_T (N)"]
    assert lines[4].split()[:2] == ["200", "0.2"] and float(lines[4].split()[3]) == pytest.approx(
        found.array("f_t")[1, 1], abs=5e-5
    )
    data = found.to_xarray()
    assert data["force"].attrs["units"] == "N" and data["finger_f_t"].dims == ("voltage", "force", "state")
    assert not [name for name in data if name.startswith("state_")]
    np.testing.assert_array_equal(data["finger_f_t"].sel(state="full_slip"), found.array("f_t"))


def test_report_has_newtons_and_says_how_to_repeat_it(found, tmp_path):
    page = write(found.folder).read_text(encoding="utf-8")
    mu = found.array("mu_app")
    assert f"µ<sub>app</sub> from {mu.min():.3f} to {mu.max():.3f}</h1>" in page
    assert "whole finger at full slip, over" in page and "friction force F_T (N)" in page
    assert "f_T (N/m)" not in page and "at full slip over the sweep" in page
    code = html.unescape(re.search(r"<pre><code>(.*?)</code>", page, re.DOTALL)[1])
    words = shlex.split(code)
    over = [words[k + 1] for k, word in enumerate(words) if word == "--over"]
    _, axes = cli_sweep.study(None, [], over)
    assert {key: tuple(map(float, values)) for key, values in axes.items()} == found.axes


def test_frictionless_finger_has_its_areas(tmp_path):
    """Without friction there is no full slip: the charged state is shown."""
    found = fp.sweep(fp.Scene(friction=0.0), tmp_path, model="cylinders", force=[0.2, 0.5])
    assert str(found).startswith("Whole finger, at charged normal contact")
    assert "µ_app" not in str(found) and "ridge contact area (mm²)" in str(found)
    assert "ridge contact area from" in write(tmp_path).read_text(encoding="utf-8")


def test_force_below_the_trace_fails_alone(tmp_path):
    """It says what to do; the others are there."""
    found = fp.sweep(fp.Scene(), tmp_path, model="cylinders", force=[1e-3, 0.2, 0.5])
    assert "give a larger force, or run this one by itself" in found[0].failure and found[0].finger is None
    assert [result.failure for result in found][1:] == ["", ""] and np.isfinite(found.array("f_t")[1:]).all()
    assert found[0].failure in str(found)


@pytest.mark.parametrize(
    ("axes", "words"),
    [
        (
            {"force": [0.1], "f_ext": [75.0]},
            "the sweep is over force, in N, and over f_ext, in N/m; give one of the two",
        ),
        ({"force": [0.1, "100 mN"]}, "each value must be there once"),
        ({"force": ["75 N/m"]}, "force is '75 N/m'"),
        ({"force": [500.0]}, "force is 500"),
        ({"force": 0.1}, "force of the sweep is 0.1; it must be a list, such as [0.1]"),
        ({"force": [0.1], "history[0].f_ext": [75.0]}, "history is given; a force in N is that of press, charge"),
    ],
)
def test_what_is_no_sweep_over_the_force(tmp_path, axes, words):
    scene = fp.Scene()
    if "history[0].f_ext" in axes:
        scene = fp.Scene(history=[{"name": "press", "f_ext": 75.0}])
    with pytest.raises(fp.SceneError) as refused:
        fp.sweep(scene, tmp_path / "out", model="cylinders", **axes)
    assert words in str(refused.value)


def test_command_and_measurements(tmp_path, capsys):
    """Newtons of a table beside those of a sweep; a power law between its forces."""
    out, table = tmp_path / "sweep", tmp_path / "mine.csv"
    words = ["sweep", "--over", "force=100,400 mN", "--over", "voltage=200", "--model", "cylinders", "--out", str(out)]
    assert main(words) == 0 and "Whole finger, at full slip" in capsys.readouterr().out
    table.write_text("# source: X 2020\nforce (mN), friction force (N)\n100, 0.09\n200, 0.15\n", encoding="utf-8")
    assert main(["compare-data", str(table), "--sweep", str(out), "--csv", str(tmp_path / "both.csv")]) == 0
    with (out / "table.csv").open(encoding="utf-8", newline="") as file:
        low, high = (float(row["slip_finger_f_t"]) for row in csv.DictReader(file))
    with (tmp_path / "both.csv").open(encoding="utf-8", newline="") as file:
        ours = [float(row["ours"]) for row in csv.DictReader(file)]
    assert ours == pytest.approx([low, np.sqrt(low * high)], rel=1e-9)


def test_option_of_a_run_is_told(capsys):
    assert main(["sweep", "--force", "0.5 N", "--over", "voltage=0"]) == 2
    assert "a sweep has it as values: --over force=" in capsys.readouterr().err


def test_key_is_of_force_and_scene_without_its_own():
    assert batch.key(fp.Scene(f_ext=20.0), 0.5) == batch.key(fp.Scene(), 0.5) != batch.key(fp.Scene(), 0.4)
    assert batch.key(fp.Scene(), 0.5) != batch.key(fp.Scene())


def test_traces_alone_are_no_result(tmp_path):
    """A run that was killed before its sums is run again."""
    scene = fp.Scene()
    place = tmp_path / batch.key(scene, 0.5)
    place.mkdir()
    for kept, done in (({"f_ext": 80.0}, False), ({"f_ext": 80.0, "asked": {}}, True), ({"failure": "x"}, True)):
        (place / "summary.json").write_text(json.dumps(kept), encoding="utf-8")
        assert (batch.result(scene, tmp_path, 0.5) is not None) is done


def test_full_model_is_run_once_for_all_forces(tmp_path, capfd):
    """The larger force is that of a run by itself; a second sweep runs nothing.

    Tolerance: with cells renumbered, which other processes have not, the trace may have other points.
    """
    forces, alone = ("1 mN", "2 mN"), fp.run(small(**SMALL), force="2 mN")
    found = fp.sweep(small(**SMALL), tmp_path, force=forces)
    assert [result.failure for result in found] == ["", ""]
    assert len(list((tmp_path / "full").glob("*/summary.json"))) == 1
    assert "to 0.002 N" in capfd.readouterr().out
    slips = [result.finger.values("full_slip") for result in found]
    assert slips[1]["f_t"] == pytest.approx(alone.finger.values("full_slip")["f_t"], rel=1e-3)
    under = alone.finger.under(forces[0])
    assert slips[0]["f_t"] == pytest.approx(under.values("full_slip")["f_t"], rel=1e-3)
    fp.sweep(small(**SMALL), tmp_path, force=forces)
    assert "done" not in capfd.readouterr().out
