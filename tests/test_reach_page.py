"""The page of which ridges touch: what full runs say, and that too few ridges are not passed over."""

import json

import pytest

from benchmarks import reach, traces
from fingerpad.runs.batch import key

NAME, SCENE = "5 N/m, 0 V, 10 µm", traces.trace(5.0, 0.0, 10e-6)


def keep(folder, last: int) -> None:
    """Leave a run in which a ridge touched and the next one did not."""
    place = folder / key(SCENE)
    place.mkdir()
    (place / "summary.json").write_text(json.dumps({"full_slip": True}), encoding="utf-8")
    rows = ["step,ridge,contact_length,state", f"1,{-last},1e-5,", f"1,{last + 1},0.0,", "2,0,2e-5,"]
    (place / "ridges.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


@pytest.mark.parametrize(("last", "code", "words"), [(3, 0, "are enough in each"), (4, 1, f"are too few in {NAME}")])
def test_ridges_meshed_against_ridges_touched(tmp_path, last, code, words):
    """The coarse finger said 2, so that 4 are meshed: ridge 4 must not touch. What is not run is not judged."""
    keep(tmp_path, last)
    said = {NAME: {"coarse": 2, "factorisations": 14, "unknowns": 4106}}
    (tmp_path / "reach.json").write_text(json.dumps(said), encoding="utf-8")
    assert reach.main(["--out", str(tmp_path), "--docs", str(tmp_path)]) == code
    page = (tmp_path / "reach.md").read_text(encoding="utf-8")
    assert words in page and f"| {NAME} | 4 | {last} |" in page


def test_scene_without_a_coarse_solution_is_named(tmp_path, monkeypatch):
    """And the others are judged all the same."""

    def lost(scene, comm):
        raise reach.coarse.NoCoarseSolution("it reaches the last of the ridges, 9")

    monkeypatch.setattr(reach.coarse, "solve", lost)
    keep(tmp_path, 3)
    assert reach.main(["--out", str(tmp_path), "--docs", str(tmp_path)]) == 0
    page = (tmp_path / "reach.md").read_text(encoding="utf-8")
    assert f"No coarse solution: {NAME} (it reaches the last of the ridges, 9)." in page
    other = {"another": {"coarse": 2, "touched": 3, "factorisations": 14, "unknowns": 4106}}
    words = f"No coarse solution: {NAME} (none)."
    assert words in reach.page({NAME: {"failure": "none"}} | other)
