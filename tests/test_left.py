"""How far a run is and what time is left of it, in a terminal, in a file, and in quiet."""

from dataclasses import fields

import pytest
from mpi4py import MPI

from fingerpad.cli import main
from fingerpad.io.console import Console
from fingerpad.io.left import Pace, between, left
from fingerpad.runs.batch import times_left
from variational.state import ContactState, StepRecord

PRESS = '[[history]]\nname = "press"\nbone_height = -50e-6\n\n[output]\nerrors = false\nreceptors = false\n'
MESH = "\n[mesh]\ncontact = 40e-6\nreceptor = 80e-6\ninterface = 150e-6\ngrowth = 0.8\n"


# -- time left -----------------------------------------------------------------------------------------
def test_time_left_is_what_was_expected_before_anything_is_done():
    """Within a factor of two, whatever time the set-up took."""
    assert left(80.0, 0.0, 0.0) == left(80.0, 30.0, 0.0) == (40.0, 160.0)


def test_pace_alone_counts_from_a_third_on():
    """Half done in 100 s leaves 100 s, whatever was expected."""
    low, high = left(3.0, 100.0, 0.5)
    assert (low, high) == left(3000.0, 100.0, 0.5)
    assert low * high == pytest.approx(100.0**2) and high / low == pytest.approx(2.0)


@pytest.mark.parametrize("part", [0.0, 0.1, 0.3, 0.6, 0.9, 0.99])
def test_range_holds_what_is_left_of_a_run_as_expected(part):
    low, high = left(100.0, 100.0 * part, part)
    assert low < 100.0 * (1 - part) < high


def test_part_is_counted_in_time():
    """Three loads of 20, 10 and 40 s, then an estimate of 30 s."""
    pace = Pace([20.0, 10.0, 40.0], 30.0, clock=lambda: 0.0)
    found = []
    for done in (0.0, 1 / 6, 1 / 3, 2 / 3, 5 / 6, 1.0):
        pace.on_path(done)
        found.append(pace.part)
    assert found == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.5, 0.7])
    pace.after_path(0.5)
    assert pace.part == pytest.approx(0.85)


def test_load_that_ends_with_full_slip_is_as_far_as_its_friction():
    """Not as far as its way, of which it needs a part alone."""
    pace = Pace([20.0, 80.0], 0.0, clock=lambda: 0.0)
    pace.on_path(0.5 + 0.1 / 2, slipped=0.75)
    assert pace.part == pytest.approx(0.8)


def test_time_left_is_not_known_before_a_waveform_has_its_pace():
    """Of 10 s that were expected for the waveform and 1 s for what follows it takes four times as long.

    Nothing is told before a tenth of both; at 20 % what is left is 0.8 of 44 s, within the factor of a pace.
    """
    now = [0.0]
    pace = Pace([10.0, 10.0], 1.0, lambda: now[0], unsure=1)
    for done, seconds in ((0.25, 5.0), (0.5, 10.0), (0.54, 13.2)):
        now[0] = seconds
        pace.on_path(done)
        assert pace.left() == "not known"
    now[0] = 10.0 + 0.2 * 44
    pace.on_path(0.5 + 0.22 / 2)
    low, _, high, unit = pace.left().split()
    assert unit == "s" and float(low) < 35.2 < float(high) < 2 * 35.2
    now[0] = 10.0 + 42.0
    pace.after_path(0.5)
    assert float(pace.left().split()[0]) < 2.0 < float(pace.left().split()[2]) < 4.0


@pytest.mark.parametrize(
    ("low", "high", "words"),
    [
        (9e-10, 1.4e-9, "less than 1 s"),
        (1.5, 6.0, "1.5 to 6 s"),
        (40.0, 160.0, "0.67 to 2.7 minutes"),
        (3600.0, 14400.0, "1 to 4 hours"),
    ],
)
def test_range_is_in_the_unit_of_the_longer_time(low, high, words):
    assert between(low, high) == words


def test_time_left_of_a_sweep_is_by_its_runs():
    """Six runs left, two at a time: from two rounds and a half of the shortest to three of the longest."""
    assert times_left([10.0, 30.0], 6, 2) == (25.0, 90.0)
    assert times_left([10.0], 1, 2) == (5.0, 12.5)


# -- console -------------------------------------------------------------------------------------------
def test_phase_is_a_line_in_a_file(capsys):
    """With the time left where it is known; capsys is no terminal."""
    console = Console(MPI.COMM_SELF)
    console.expect({"press": 60.0}, 30.0)
    console.phase("meshing")
    console.phase("estimating", 1.0)
    console.close()
    assert capsys.readouterr().out == "meshing\nestimating; time left: less than 1 s\n"


@pytest.mark.parametrize(("whole", "words"), [(True, "20 to 60 s"), (False, "20 to 60 s, path alone")])
def test_time_left_of_a_step_is_said_to_be_of_the_path_where_more_is_to_come(capsys, monkeypatch, whole, words):
    """With an accuracy, whose meshes are not known yet."""
    monkeypatch.setattr(Pace, "left", lambda pace: "20 to 60 s")
    console = Console(MPI.COMM_SELF)
    console.expect({"press": 60.0}, 0.0, whole=whole)
    work = {field.name: 0 for field in fields(StepRecord)}
    conditions = {"f_ext": 1.0, "voltage": 0.0, "f_contact": 1.0, "f_electrostatic": 0.0, "f_t": 0.0, "mu_app": 0.0}
    conditions |= {"bone_x": -0.0, "bone_height": -1e-12, "f_t": -1e-17, "mu_app": -1e-17}  # zeros have no sign
    console.step(
        ContactState(**conditions, load="press", contact_length=1e-3, ridges_in_contact=1, record=StepRecord(**work)),
        0.5,
    )
    console.close()
    out = capsys.readouterr().out
    assert out.endswith(f"  {words}\n") and "-0" not in out


@pytest.mark.parametrize("quiet", [False, True])
def test_run_in_quiet_prints_the_result_alone(tmp_path, write, capsys, quiet):
    """No step, no phase; the result as a table either way, once."""
    argv = ["run", str(write(PRESS + MESH)), "--out", str(tmp_path / "out"), *(["--quiet"] if quiet else [])]
    assert main(argv) == 0
    said = capsys.readouterr().out
    assert said.count("ridges in contact") == 1
    assert ("time left" in said, "meshing the finger" in said) == (not quiet, not quiet)
    assert said.endswith(f"Report: {tmp_path / 'out' / 'report.html'}\n") == (not quiet)
