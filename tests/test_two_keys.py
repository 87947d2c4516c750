"""A quantity over two keys by the closed form: ``fingerpad estimate --over KEY --over KEY``, its table and picture."""

import shlex
from dataclasses import replace

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.cli import estimate_map, main
from fingerpad.reduced import cylinder_errors
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.results.quantities import FINGER
from fingerpad.runs.closed_form import ClosedForm
from fingerpad.runs.two_keys import two_keys
from tests.commands import refused
from tests.measures import rows_of

SMALL = {"voltage": [0.0, 100.0, 200.0], "electric.d_i": ["0.5 um", "2 um"]}


def test_map_is_the_closed_form_of_the_whole_finger():
    """The same function as of ``fingerpad solve``, so that the numbers are the same."""
    found = two_keys(fp.Scene(force=0.5), SMALL)
    assert found.keys == ([0.0, 100.0, 200.0], [0.5e-6, 2e-6]) and found.target.whole
    one = fp.Scene(force=0.5, voltage=200.0, electric={"d_i": 2e-6})
    assert found.values[2, 1] == ClosedForm(Cylinders()).value(one, FINGER["mu_app"], True)
    assert found.values[0] == pytest.approx(0.25, rel=1e-9)


def test_line_is_where_the_target_is_reached():
    """The map is one-sided of the target on either side of the value that a search finds."""
    found = two_keys(fp.Scene(force=0.5), SMALL, "mu_app=2x")
    (root,) = fp.solve(fp.Scene(force=0.5, electric={"d_i": 2e-6}), "mu_app=2x").values
    assert [bool(x > 2) for x in found.reached[:, 1]] == [u > root for u in found.keys[0]]


def test_section_is_mapped_where_its_force_is_varied():
    """Over f_ext the quantities are those of the section, whose error is known at the loads of full runs."""
    found = two_keys(fp.Scene(), {"voltage": [200.0, 400.0], "f_ext": [25.0, 75.0]})
    assert "The error of the section is known at 2 of 4 points." in estimate_map.text(found)
    assert not found.target.whole and found.known.tolist() == [[True, True], [False, False]]
    one = fp.run(fp.Scene(f_ext=25.0, voltage=200.0), model="cylinders").full_slip
    assert found.values[0, 0] == pytest.approx(one.mu_app, rel=1e-12)


def test_error_is_known_up_to_the_limit_of_the_attraction(monkeypatch):
    """Some 4 times the force at 0.05 N and 200 V, beyond a limit of 3; the other places have less."""
    region = cylinder_errors.REGIONS[0]
    limited = replace(region, ranges={**region.ranges, cylinder_errors.PULL: (0.0, 3.0)})
    over = {"voltage": [100.0, 200.0], "force": [0.05, 0.5]}
    for regions, known in (((region,), [[True, True]] * 2), ((limited,), [[True, True], [False, True]])):
        monkeypatch.setattr(cylinder_errors, "REGIONS", regions)
        found = two_keys(fp.Scene(), over)
        assert found.known.tolist() == known
    assert "The error of the whole finger is known at 3 of 4 points." in estimate_map.text(found)


def test_error_is_that_of_the_quantity():
    """No full run has tested the indentation of the closed form."""
    assert not two_keys(fp.Scene(), {"voltage": [0.0, 100.0], "force": [0.1, 0.5]}, "indentation=0.5 mm").known.any()


def test_places_without_an_answer_are_left_out():
    """5 kV are beyond any contact."""
    found = two_keys(fp.Scene(force=0.5), {"voltage": [100.0, 5000.0], "friction": [0.2, 0.4]})
    assert np.isnan(found.values).tolist() == [[False, False], [True, True]] and len(found.lost) == 2
    assert all("voltage 5000 V and friction" in each for each in found.lost)


def test_command_writes_table_and_picture(tmp_path, capsys):
    words = "estimate --over voltage=0:200:3 --over electric.d_i='0.5,2 um' --force 0.5 --target mu_app=2x"
    files = ["--csv", str(tmp_path / "map.csv"), "--plot", str(tmp_path / "map.png")]
    for _ in range(2):  # its own files are replaced
        assert main([*shlex.split(words), *files]) == 0
    out = capsys.readouterr().out
    assert out.startswith("Apparent friction µ_app of the whole finger at full slip by a closed form, 0.5 N; voltage")
    rows = rows_of(tmp_path, "map")
    assert list(rows[0]) == ["error_known", "voltage", "electric.d_i", "mu_app"] and len(rows) == 6
    assert f"{float(rows[-1]['mu_app']):.4f}" in out.splitlines()[5]
    assert (tmp_path / "map.png").stat().st_size > 10_000


@pytest.mark.parametrize(("target", "said"), [("mu_app=900", True), ("mu_app=2x", False)])
def test_target_that_is_not_reached_is_said(capsys, tmp_path, target, said):
    words = f"estimate --over voltage=0:200:3 --over friction=0.2,0.3 --target {target} --plot {tmp_path / 'map.png'}"
    assert main(shlex.split(words)) == 0
    out, err = capsys.readouterr()
    assert ("mu_app = 900 is not reached at any point." in out) == said and not err


def test_progress_goes_through_every_point():
    """As a bar counts them, in the order of the table."""
    seen = []
    two_keys(fp.Scene(force=0.5), SMALL, watch=lambda points: (seen.append(each) or each for each in points))
    assert seen == [(j, k) for j in range(3) for k in range(2)]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("--over voltage --over f_ext --force 0.5", "--force is given, and --over varies the other force; give one of"),
        ("--over voltage --over voltage", "--over voltage is given twice; a map is over two different keys"),
        ("--over voltage", "--over is given 1 time; a map is over two keys"),
        ("--over voltage --over friction --over force", "--over is given 3 times; a map is over two keys"),
        ("--over voltage --over zebra", "zebra is not a key of a scene"),
        ("--over f_ext --over force", "f_ext and force are both varied; give one of the two"),
        ("--over voltage --over friction --voltage 5", "--over voltage is given and --voltage too"),
        ("--over voltage --over friction --force 0.1,0.2", "--force has 2 values beside --over; give one value"),
        ("--over voltage= --over friction", "--over is 'voltage='; write it as --over voltage or"),
        ("--over voltage=5 --over friction", "voltage has one value; a map needs at least two"),
        ("--over voltage=9:0:3 --over friction", "the range of voltage is 9 to 0; the last value must be above"),
        ("--over voltage=1,5,3,9 --over friction", "the values of voltage do not grow; give each once"),
        ("--over voltage --over geometry.ridge_count", "it must be a key of one number that may have a fraction"),
        ("--over voltage --over friction --target mu=2", "mu is not a quantity of a target"),
        ("--over f_ext --over voltage --target 'F_T=1 N'", "F_T is a quantity of the whole finger, and the map is of"),
        ("--over voltage --over force=-1,1", "force is -1 N"),
        ("--target mu_app=2x", "--target is given without --over"),
        ("--over voltage=0:200:101 --over friction=0.1:1:100", "the map has 10100 points; at most 10000 are allowed"),
        ("--voltage 0:200:101 --force 0.1:1:100", "the table has 10100 points; at most 10000 are allowed"),
        ("--voltage 0:1e400:3", "--voltage is 0:1e400:3; each value must be a finite number"),
        ("--force 0.1,1e400", "--force is 0.1,1e400; each value must be a finite number"),
        ("--voltage 1e308,1e308kV", "voltage is '1e+308 kV'; it must be a finite number"),
    ],
)
def test_impossible_maps_are_refused_in_one_sentence(capsys, line, words):
    said = refused(capsys, "estimate", *shlex.split(line))
    assert words in said and said.count("\n") == 1
