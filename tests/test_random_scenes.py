"""Random scenes of the stability page: how they are drawn, what is kept of their runs, and their table."""

import argparse
from pathlib import Path

import pytest

from benchmarks.harness import DOCS, kept
from benchmarks.stability import __main__ as keeping
from benchmarks.stability import page, scenes
from fingerpad.scene import Scene

STUCK = "step 26 (slide, 18.3 % done) found no equilibrium beyond f_ext 12.6 N/m, 296 V: DIVERGED_LOCAL_MIN; try more"
FINER = {"contact": 15e-6, "factorisations": 40, "newton_iterations": 90, "reason": STUCK}
WIDER = {"contact": 30e-6, "factorisations": 7, "newton_iterations": 20, "reason": "ridge 4 came near the screen"}


def summary(*restarts, contact=30e-6, **values):
    work = {"factorisations": 50, "newton_iterations": 100, "full_slip": True, "path_mesh": {"contact": contact}}
    return work | {"restarts": list(restarts)} | values


def rows(**changed):
    """Return a row of each scene and formulation, all at full slip, but what is changed of scene 1."""
    return [
        scenes.row(summary(**(changed if number == 1 else {}))) | {"number": number, "formulation": name}
        for number, name in scenes.scenes()
    ]


def test_scenes_are_within_their_ranges():
    default = Scene()
    for number in range(scenes.COUNT):
        data = scenes.drawn(number)
        assert 2 <= data["f_ext"] <= 200 and 0 <= data["voltage"] <= 300 and 0.05 <= data["friction"] <= 1
        for name, value in data["roughness"].items():
            assert 0.59 < value / getattr(default.roughness, name) < 1.41  # of three digits
        for layer in ("subcutis", "dermis", "viable_epidermis", "stratum_corneum"):
            usual = getattr(default.materials, layer).shear_modulus
            assert 0.69 < data["materials"][layer]["shear_modulus"] / usual < 1.31
    assert {scenes.drawn(number)["materials"]["exponent"] for number in range(2)} == {"printed", "abaqus"}


def test_scenes_are_repeatable_and_differ():
    assert scenes.drawn(3) == scenes.drawn(3) != scenes.drawn(4)


def test_formulations_get_the_same_scenes():
    """But for the table of the contact."""
    asked = scenes.scenes()
    assert len(asked) == scenes.COUNT * len(scenes.FORMULATIONS)
    for number in range(scenes.COUNT):
        plain = [asked[number, name].parameters() | {"contact": None} for name in scenes.FORMULATIONS]
        assert plain[0] == plain[1] == plain[2]


@pytest.mark.parametrize(
    ("found", "factorisations", "failure"),
    [
        (summary(), 50, ""),
        (summary(WIDER), 57, ""),
        (summary(FINER, contact=15e-6), 90, "slide: DIVERGED_LOCAL_MIN"),
        (summary(full_slip=False, failure=STUCK), 50, "slide: DIVERGED_LOCAL_MIN"),
        ({"failure": "TIME_LIMIT: more than 180 s"}, 0, "TIME_LIMIT"),
    ],
)
def test_row(found, factorisations, failure):
    """Restarts cost what they cost; what they are for is kept where they need smaller elements."""
    kept_row = scenes.row(found)
    assert (kept_row["factorisations"], kept_row["failure"]) == (factorisations, failure)
    assert kept_row["full_slip"] == found.get("full_slip", False)


def test_table_holds_each_outcome():
    text = page.scenes_table(rows(full_slip=False, failure=STUCK))
    assert text.count("✕ slide: DIVERGED_LOCAL_MIN, 50") == len(scenes.FORMULATIONS)
    assert text.count("● 50") == (scenes.COUNT - 1) * len(scenes.FORMULATIONS)
    assert f"19 of {scenes.COUNT}" in text and "not run" not in text
    assert page.scenes_table(rows()[: scenes.COUNT]).count("| not run | not run |") == scenes.COUNT
    assert page.full_slips(rows()[:5], "penalty") == f"5 of 5 ({scenes.COUNT - 5} not run)"
    assert "▲ 15 µm, 50" in page.scenes_table(rows(contact=15e-6))


def test_dearer_counts_scenes_that_both_reach():
    """The penalty fails in scene 1; of the others the augmented Lagrangian takes three times as much, here."""
    found = rows()
    for row in found:
        row["full_slip"] = (row["number"], row["formulation"]) != (1, "penalty")
        row["factorisations"] *= 3 if row["formulation"] == "augmented" else 1
    assert page.dearer(found, "augmented") == pytest.approx(3, rel=1e-14)


def test_part_keeps_the_map(tmp_path, monkeypatch):
    """Run alone, random scenes leave the map's numbers as they are."""
    (tmp_path / "stability.json").write_bytes((DOCS / "stability.json").read_bytes())
    before = kept("stability", tmp_path)

    def ran(asked: dict[str, Scene], args: argparse.Namespace, limit: float) -> dict[str, dict]:
        assert args.out == tmp_path / "out" and limit == scenes.LIMIT
        return {name: summary() for name in asked}

    monkeypatch.setattr(scenes, "run", ran)
    monkeypatch.setattr(page, "picture", lambda *given: "")
    assert keeping.main(["--part", "random", "--out", str(tmp_path / "out"), "--docs", str(tmp_path)]) == 0
    after = kept("stability", tmp_path)
    assert after.made == before.made and after.numbers["runs"] == before.numbers["runs"]
    assert {row["factorisations"] for row in after.numbers["random"]["runs"]} == {50}
    assert f"{scenes.COUNT} of {scenes.COUNT}" in Path(tmp_path / "stability.md").read_text(encoding="utf-8")
