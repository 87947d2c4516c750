"""Ridges that were not expected to touch are woken when they might, and the run is the one that had them all along."""

import csv

import pytest
from mpi4py import MPI

from fingerpad.run import run
from fingerpad.scene import from_data
from fingerpad.zone import Zone
from geometry import fingertip

MESH = {"contact": 30e-6, "receptor": 80e-6, "interface": 150e-6, "growth": 0.8}
WAVELENGTH = 483e-6


def press(folder, half_arc: float) -> dict:
    """Press a finger until three ridges are in contact and some more, as the mesh lets them."""
    history = [{"name": "press", "bone_height": -50e-6}]
    return run(from_data({"mesh": MESH | {"touching_half_arc": half_arc}, "history": history}), folder, MPI.COMM_WORLD)


def columns(folder, name: str) -> list[dict[str, str]]:
    with (folder / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def woken(tmp_path_factory):
    """A run whose finger can touch with three ridges at first."""
    folder = tmp_path_factory.mktemp("woken")
    return folder, press(folder, 0.6e-3)


def test_ridges_are_woken_and_the_run_says_so(woken):
    folder, summary = woken
    assert "failure" not in summary
    (wake,) = summary["woken"]
    assert wake["load"] == "press" and wake["factorisations"] > 0
    assert wake["reason"] in ("ridge 1, the last one that is meshed to touch, is in contact",
                              "ridge -1, the last one that is meshed to touch, is in contact")  # fmt: skip
    assert wake["touching_half_arc"] == pytest.approx(3 * WAVELENGTH, rel=1e-12)
    log = (folder / "run.log").read_text(encoding="utf-8")
    assert f"{wake['reason']}; all loads again with mesh.touching_half_arc 0.001449 m" in log


def test_woken_run_is_the_one_that_had_the_ridges(woken, tmp_path):
    """Step for step and digit for digit; nothing is left of the steps before."""
    folder, summary = woken
    straight = press(tmp_path, summary["woken"][0]["touching_half_arc"])
    assert straight["woken"] == [] and straight["factorisations"] == summary["factorisations"]
    for name in ("steps", "ridges", "receptors", "coupling"):
        assert columns(folder, name) == columns(tmp_path, name), name


def test_woken_run_says_what_it_was_asked(woken):
    """The parameters are the scene's: run again they wake again."""
    assert woken[1]["parameters"]["mesh"]["touching_half_arc"] == 0.6e-3


@pytest.mark.parametrize(("half_arc", "more"), [(0.6e-3, 2), (5e-3, 2), (6.5e-3, 3), (13e-3, None)])
def test_how_many_are_woken(half_arc, more):
    """Two on either side, a quarter of many, none where all can touch."""
    scene = from_data({"mesh": {"touching_half_arc": half_arc}})
    zone = Zone.__new__(Zone)
    zone._scene = scene
    wider = zone._wider()
    if more is None:
        assert wider is None
        return
    before, after = (fingertip.touching_ridges(s.geometry, s.mesh)[-1] for s in (scene, wider))
    assert after - before == more
