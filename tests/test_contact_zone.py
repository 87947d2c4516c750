"""Where omitted ridges may touch the run goes on with them, and ends as the run that had them all along."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.model import options
from fingerpad.model.checks import FingerExceeded
from fingerpad.model.options import by_rule
from fingerpad.model.simulation import Simulation
from fingerpad.runs import full as run_module
from fingerpad.scene import from_data
from geometry.sizing import touching_ridges
from tests.measures import rows_of
from tests.runs import path_of, run
from tests.test_resume import scene
from variational.solvers.stability import Stability, StabilityCheck

pytestmark = pytest.mark.slow
MESH = {"contact": 30e-6, "receptor": 80e-6, "interface": 150e-6, "growth": 0.8}
WAVELENGTH = 483e-6


def press(folder, half_arc: float) -> dict:
    """Press a finger until three ridges are in contact and some more, as the mesh lets them."""
    history = [{"name": "press", "bone_height": -50e-6}]
    few = {"geometry": {"ridge_count": 11}, "output": {"errors": False}}
    scene = from_data({"mesh": MESH | {"touching_half_arc": half_arc}, "history": history} | few)
    return run(scene, folder, MPI.COMM_WORLD)


def columns(folder, name: str) -> list[dict[str, str]]:
    """Return a table's rows, without a word of what they took."""
    return [{k: v for k, v in row.items() if k != "processor_seconds"} for row in rows_of(folder, name)]


def test_press_goes_on_with_more_ridges(tmp_path):
    """No step is taken twice, and the force is that of the wider mesh: what friction kept is interpolated, to 0.1 %."""
    wider, straight = (press(tmp_path / name, arc) for name, arc in (("wider", 0.6e-3), ("straight", 1.4e-3)))
    assert wider["restarts"] == [] and "the path goes on with" in (tmp_path / "wider" / "run.log").read_text()
    rows = rows_of(tmp_path / "wider", "steps")
    assert [int(row["step"]) for row in rows] == list(range(1, len(rows) + 1))
    assert wider["unknowns"] == straight["unknowns"]
    assert float(rows[-1]["f_ext"]) == pytest.approx(
        float(rows_of(tmp_path / "straight", "steps")[-1]["f_ext"]), rel=1e-3
    )
    assert wider["factorisations"] < 2 * straight["factorisations"]


def test_slide_goes_on_with_more_ridges(tmp_path):
    """Full slip does not depend on the path: the same to the solves' tolerance, whose air gaps are good to 1e-6."""
    wider, straight = (fp.run(scene("more ridges", mesh={"touching_half_arc": arc})) for arc in (0.1e-3, 1.0e-3))
    assert wider.record["restarts"] == [] and wider.record["path_mesh"]["touching_half_arc"] > 0.1e-3
    assert wider.full_slip.f_t == pytest.approx(straight.full_slip.f_t, rel=1e-6)


# -- skin beyond the last ridge ----------------------------------------------------------------------------
def brought_near(half_arc: float, clearance: float) -> Simulation:
    """Return a finger that touches nowhere, rolled onto its side so that ridge 6 is lowest, at a height (m)."""
    scene = from_data({"mesh": MESH | {"touching_half_arc": half_arc}, "geometry": {"ridge_count": 15}})
    simulation = path_of(scene)
    problem, (tip, before) = (
        simulation.finger.problem,
        simulation.finger.profiles.point(np.array([6.0, 5.99]) * WAVELENGTH, 0.0),
    )
    slope = -np.arctan2(*(tip - before)[::-1])
    turn = np.array([[np.cos(slope), -np.sin(slope)], [np.sin(slope), np.cos(slope)]])
    problem.w.interpolate(lambda x: turn @ (x[:2] - tip[:, None]) + [[tip[0]], [clearance]] - x[:2])
    return simulation


def check(simulation: Simulation) -> tuple[int, str] | None:
    return simulation._zone.check(simulation.finger.observer.ridge_loads())


def test_skin_that_comes_near_asks_for_a_restart():
    """Ridge 6 is at 8 um, where the voltage reaches, and none of the ridges meshed to touch does."""
    simulation = brought_near(4 * WAVELENGTH, 8e-6)
    assert not simulation.finger.observer.ridge_loads().length.any()
    wider = check(simulation)
    assert wider == (6, "skin beyond the ridges that are meshed to touch is at a height of 8e-06 m")


@pytest.mark.parametrize(("clearance", "exceeded"), [(8e-6, False), (-1e-6, True)])
def test_skin_beyond_all_ridges_may_come_near_but_not_touch(clearance, exceeded):
    """There are no more ridges to add: 15 can touch, and skin between their tips is the lowest here."""
    simulation = brought_near(7 * WAVELENGTH, 1e-3)
    simulation._zone._lowest_outside = lambda: clearance
    if not exceeded:
        assert check(simulation) is None
        return
    with pytest.raises(FingerExceeded, match="the finger has no more ridges"):
        check(simulation)


# -- the other half ----------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def half(tmp_path_factory):
    """A finger pressed alone, whose half is said not to be stable; nothing is said of the whole."""
    folder, check = tmp_path_factory.mktemp("half"), StabilityCheck.check

    def unstable(self):
        return Stability(-1.0, True) if self.solver.equations.antisymmetric_rows() is not None else check(self)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(StabilityCheck, "check", unstable)
        return folder, press(folder, 1.3e-3)


def test_finger_made_whole_is_the_one_that_was_whole(half, tmp_path, monkeypatch):
    """Step for step and digit for digit."""
    folder, summary = half
    monkeypatch.setattr(run_module, "plan", lambda scene: replace(options.plan(scene), both_halves=True))
    assert press(tmp_path, 1.3e-3)["unknowns"] == summary["unknowns"]
    for name in ("steps", "ridges", "receptors", "coupling"):
        assert columns(folder, name) == columns(tmp_path, name), name


# -- which ridges are meshed to touch --------------------------------------------------------------------------------
PRESS = {"name": "press", "bone_height": -50e-6}
RUNS = json.loads((Path(__file__).parent / "reach.json").read_text(encoding="utf-8"))
"""The last ridge, on either side, that is in contact in any step of a full run, by scene."""


def last_ridge(data: dict) -> int:
    """Return the last ridge that is meshed to touch in a scene."""
    scene = by_rule(from_data(data))
    return touching_ridges(scene.geometry, scene.mesh)[-1]


# -- the rule ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", RUNS)
def test_ridges_are_enough_for_what_full_runs_touch(name):
    """The last ridge that is meshed to touch must not touch, or the run starts again with more."""
    assert last_ridge(RUNS[name]["scene"]) > RUNS[name]["touched"]


@pytest.mark.parametrize(
    ("data", "last"),
    [
        ({"f_ext": 75.0}, 10),
        ({"f_ext": 150.0}, 13),
        ({"friction": 1.0}, 16),
        ({"history": [{"name": "retract", "bone_height": 0.3e-3}]}, 2),
        ({"geometry": {"ridge_wavelength": 483e-6 / 2, "ridge_count": 61}}, 20),
        ({"history": [PRESS]}, 3),
        ({"geometry": {"ridge_count": 1}}, 0),
    ],
)
def test_rule_of_thumb(data, last):
    """More ridges under a larger force, depth or friction, never fewer than two of those there are."""
    assert last_ridge(data) == last
