"""The page of the traces: what has been run, what arrived, what failed."""

import json

import pytest

from benchmarks import traces
from fingerpad.runs.batch import key


def keep(folder, scene, **values):
    """Leave the summary of a run that reached full slip, but for ``values``."""
    summary = {
        "full_slip": True,
        "slip_mu_app": 0.5,
        "jumps": 2,
        "cutbacks": 1,
        "factorisations": 300,
        "imbalance": 1e-9,
        "penetration": 8e-8,
        "parameters": {},
    } | values
    (folder / key(scene)).mkdir()
    (folder / key(scene) / "summary.json").write_text(json.dumps(summary), encoding="utf-8")


def test_grid_is_the_one_asked_for():
    sizes = {name: len(traces.GROUPS[name]()) for name in ("grid", "fine")}
    assert sizes == {"grid": 40, "fine": 6}


def test_scenes_differ():
    """No two scenes of all groups share a folder."""
    scenes = [scene for group in traces.GROUPS.values() for scene in group().values()]
    assert len({key(scene) for scene in scenes}) == len(scenes)


def test_mesh_is_given():
    """All traces of one force share their mesh, which no coarse solve decides, and keep their keys."""
    scenes = [scene for group in traces.GROUPS.values() for scene in group().values()]
    assert all(scene.mesh.touching_half_arc is not None for scene in scenes)


def test_page_counts_what_arrived(tmp_path):
    keep(tmp_path, traces.trace(75.0, 200.0, 10e-6))
    keep(tmp_path, traces.trace(5.0, 200.0, 10e-6), full_slip=False, slip_mu_app=None, failure="step 9: stuck")
    page = traces.page(tmp_path)
    assert "1 of 40 traces reach full slip (2 run)" in page
    assert "0.5000 (2 j, 1 c, 300 f)" in page
    assert "| 5 | not run | not run | not run | not run | **!** 2 j, 1 c, 300 f |" in page


def test_page_says_why_a_corner_failed(tmp_path):
    keep(tmp_path, traces.corners()["400 V at 10 N/m"], full_slip=False, failure="step 9: stuck")
    assert "| 400 V at 10 N/m | **!** 2 j, 1 c, 300 f | step 9: stuck |" in traces.page(tmp_path)


@pytest.mark.parametrize(("failure", "code"), [({}, 0), ({"failure": "TIME_LIMIT: not done"}, 1)])
def test_exit_code(tmp_path, monkeypatch, failure, code):
    monkeypatch.setattr(traces, "sweep", lambda scenes, out, jobs: dict.fromkeys(scenes, failure))
    assert traces.main(["--only", "fine", "--out", str(tmp_path), "--docs", str(tmp_path)]) == code
    assert (tmp_path / "traces.md").exists()
