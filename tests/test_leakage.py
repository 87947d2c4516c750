"""A real finger leaks charge: one note on constant voltages and one caution on offsets, wherever results come out."""

import tomllib

import pytest

import fingerpad as fp
from fingerpad.calculator.page import page
from fingerpad.cli import compare, main
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene, from_data
from fingerpad.scene.remarks import LEAKAGE, leakage, remarks
from tests.small_finger import SMALL

PRESS = {"name": "press", "f_ext": 1.0}


def under(voltage, *before) -> Scene:
    wave = {"name": "wave", "duration": 0.1, "voltage": voltage}
    return from_data({"history": [PRESS, *before, wave]})


def sine(**keys) -> dict:
    return {"waveform": "sine", "amplitude": 120.0, "frequency": 20.0} | keys


def table(*voltages: float) -> dict:
    return {"waveform": "file", "times": [0.0, *([0.02] if len(voltages) > 2 else []), 0.1], "voltages": list(voltages)}


# -- what it is of -----------------------------------------------------------------------------------------
def test_constant_voltage_has_the_note_alone():
    """It may be the effective value of an alternating one: no caution, and nothing at 0 V."""
    assert leakage(Scene()) == [LEAKAGE] and remarks(Scene()) == []
    assert leakage(from_data({"voltage": 0.0})) == []


@pytest.mark.parametrize(
    ("voltage", "mean"),
    [
        (sine(offset=200.0), 200.0),
        (sine(offset=-30.0), -30.0),
        (table(-50.0, 50.0), 0.0),
        (table(0.0, 100.0), 50.0),
        (table(100.0, 100.0, 0.0), 60.0),
        (sine(), 0.0),
        (sine(offset=1.0), 0.0),
    ],
)
def test_waveform_with_a_mean_has_a_caution_that_names_it(voltage, mean):
    """In place of the note, also where a load before is at a constant voltage."""
    scene = under(voltage, {"name": "charge", "voltage": 50.0})
    found = remarks(scene)
    assert [f"has a mean of {mean:g} V, which leaks away" in text for text in found] == [True] * (mean != 0)
    assert leakage(scene) == ([] if mean else [LEAKAGE])


# -- doors -------------------------------------------------------------------------------------------------
def test_a_result_has_it_once():
    """Here the closed form; beside other models it is no line of each."""
    found = cylinders.solve(Scene())
    assert found.notes.count(LEAKAGE) == 1 and str(found).count(LEAKAGE) == 1
    assert compare.table([found, found]).count(LEAKAGE) == 1
    assert LEAKAGE not in str(cylinders.solve(from_data({"voltage": 0.0})))


@pytest.mark.mpi
def test_a_full_run_has_it_once():
    """Of a press and a charge in the air, on a coarse mesh."""
    loads = [{"name": "press", "bone_height": -1e-6}, {"name": "charge", "voltage": 20.0}]
    mesh = {"contact": 60e-6, "receptor": 100e-6, "interface": 200e-6, "growth": 0.9}
    lean = {"errors": False, "receptors": False, "each_load": False}
    geometry = from_data(tomllib.loads(SMALL.read_text(encoding="utf-8"))).geometry.model_dump(exclude_none=True)
    found = fp.run(from_data({"geometry": geometry, "history": loads, "mesh": mesh, "output": lean}))
    assert found.notes.count(LEAKAGE) == 1


def test_calculator_and_commands_have_it_once(capsys, tmp_path):
    assert page().count(LEAKAGE) == 1
    assert main(["estimate"]) == 0
    assert main(["check", str(SMALL), "--out", str(tmp_path), "--set", "mesh.contact=60e-6"]) == 0
    assert capsys.readouterr().out.count(LEAKAGE) == 2
