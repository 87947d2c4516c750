"""The chart of error over work, on points that are made up."""

import json

import pytest

from benchmarks import chart, errors, points
from benchmarks.convergence import Limit
from benchmarks.points import AGAIN, QUANTITIES, STATES, Point
from fingerpad.runs.batch import key


def point(label, work, seconds, error):
    costs = (dict.fromkeys(STATES, spent) for spent in (work, seconds))
    return Point(label, "growth", *costs, dict.fromkeys([*QUANTITIES, points.ALL], error))


POINTS = [
    point("default", 2.0, 20.0, 0.02),
    point("cheap", 1.0, 30.0, 0.04),
    point("worse", 3.0, 10.0, 0.03),
    point("dear", 4.0, 40.0, 0.001),
]


def test_front_is_what_nothing_beats():
    """What is dearer and no better is not on it."""
    assert [p.label for p in chart.front(POINTS, "slip_f_t")] == ["cheap", "default", "dear"]


def test_front_over_time_is_another():
    """What takes least time comes first, however many factorisations it needs."""
    assert [p.label for p in chart.front(POINTS, "slip_f_t", "seconds")] == ["worse", "default", "dear"]


def test_run_without_its_time_is_in_the_chart_of_work_alone():
    more = [*POINTS, Point("old", "growth", dict.fromkeys(STATES, 0.5), {}, dict.fromkeys(QUANTITIES, 1e-5))]
    assert [p.label for p in chart.front(more, "slip_f_t")] == ["old"]
    assert [p.label for p in chart.front(more, "slip_f_t", "seconds")] == ["worse", "default", "dear"]


def test_table_names_the_cheapest_run_that_will_do(tmp_path):
    """5 % by the cheapest at half the default's work, 1 % and 0.2 % by the dearest at twice it."""
    chart.write(POINTS, 9, dict.fromkeys(QUANTITIES, Limit(1.0, 0.001, None)), tmp_path, ["40 µm: stuck"])
    text = (tmp_path / "chart.md").read_text(encoding="utf-8")
    row = next(line for line in text.splitlines() if line.startswith("| f_T"))
    assert row.split(" | ")[2:5] == ["cheap: 0.5", "dear: 2", "dear: 2"]
    assert "4 of 9 runs" in text
    assert "Not there: 40 µm: stuck." in text


def test_states_without_a_path_are_no_part_of_the_front(tmp_path):
    """They have a table of their own, and no column of what they do not say."""
    again = Point("again", AGAIN, dict.fromkeys(STATES, 0.2), dict.fromkeys(STATES, 0.2), {"slip_f_t": 1e-5})
    assert [p.label for p in chart.front([*POINTS, again], "slip_f_t")] == ["cheap", "default", "dear"]
    chart.write([*POINTS, again], 4, dict.fromkeys(QUANTITIES, Limit(1.0, 0.001, None)), tmp_path)
    text = (tmp_path / "chart.md").read_text(encoding="utf-8")
    assert "4 of 4 runs" in text
    assert "| f_T and µ_app, full slip | again: 0.1 | again: 0.1 | again: 0.1 |" in text
    assert "| contact length, full slip | none | none | none |" in text


def test_another_penalty_is_no_part_of_the_front():
    """It may come out near the reference by an accident of signs."""
    soft = Point("soft", chart.OTHER_MODEL, POINTS[1].work, POINTS[1].seconds, dict.fromkeys(QUANTITIES, 1e-6))
    assert [p.label for p in chart.front([*POINTS, soft], "slip_f_t")] == ["cheap", "default", "dear"]


def test_every_scene_is_another():
    scenes = chart.scenes()
    assert len({str(scene.parameters()) for scene in scenes.values()}) == len(scenes)


def test_run_that_was_lost_is_named(tmp_path):
    """With its reason, or that it was not run; what reached full slip is not."""
    ends = {"P2-P1": {"full_slip": True}, "P2 reduced": {"full_slip": False}, "P3": {"failure": "no equilibrium"}}
    for label, summary in ends.items():
        folder = tmp_path / key(points.scenes()["element", label])
        folder.mkdir()
        (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    missing = points.missing(tmp_path)
    assert len(missing) == len(points.scenes()) - 1
    assert "P2 reduced: no steady full slip by the end of the slide" in missing
    assert "P3: no equilibrium" in missing
    assert "P1: not run" in missing
    assert not any(words.startswith("P2-P1") for words in missing)


def test_states_cost_their_path_and_coarser_meshes(tmp_path):
    """Five factorisations of 10 unknowns on each of the meshes, the path among them; the last is off by 1 %."""
    reference = dict.fromkeys(QUANTITIES, Limit(1.0, 0.001, None))

    def level(contact, value):
        spent = {"unknowns": 10, "factorisations": 5, "processor_seconds": 2.0}
        return spent | {"mesh": {"contact": contact}, "values": dict.fromkeys(QUANTITIES, value)}

    told = {"path": level(20e-6, 1.5), "levels": [level(10e-6, 1.1), level(5e-6, 1.01)]}
    folder = errors.folder_of_limits(tmp_path / "traces")
    folder.mkdir()
    (folder / f"{key(errors.DEFAULT)}-{errors.LEVELS}.json").write_text(json.dumps(told), encoding="utf-8")
    found = points.collect(tmp_path / "traces", tmp_path, reference)
    assert [p.label for p in found] == ["again at 10 µm", "again at 5 µm"]
    assert [p.cost("slip_f_t", "work") for p in found] == [100, 150]
    assert [p.cost("slip_f_t", "seconds") for p in found] == [4, 6]
    assert found[1].errors["slip_f_t"] == found[1].errors[points.ALL] == pytest.approx(0.01, rel=1e-12)


def test_accuracy_asked_for_costs_all_that_was_solved(tmp_path):
    """Its 700 factorisations times unknowns, and those of a coarser start that was lost, 20 of 10."""
    scene = next(iter(points.accuracy.of_default().values()))
    folder = tmp_path / "traces" / key(scene)
    folder.mkdir(parents=True)
    spent = {"unknowns_times_factorisations": 700, "processor_seconds": 6.0}
    said = {"accuracy": spent | {"quantities": {"slip_f_t": {"value": 1.1}}}}
    lost = {"restarts": [{"unknowns": 10, "factorisations": 20, "processor_seconds": 1.5}]}
    (folder / "summary.json").write_text(json.dumps(said | lost), encoding="utf-8")
    reference = dict.fromkeys(QUANTITIES, Limit(1.0, 0.001, None))
    (found,) = points.collect(tmp_path / "traces", tmp_path, reference)
    assert (found.cost("slip_f_t", "work"), found.cost("slip_f_t", "seconds")) == (900, 7.5)


def test_rung_has_an_error_where_it_says_something(tmp_path):
    """No energy density, nor the contact before the voltage."""
    cost = {"factorisations": 3, "unknowns": 7, "seconds": 0.5}
    said = {"75 N/m, 200 V": {"2": {"summary": {"slip_f_t": 0.9, "slip_contact_length": 1.2}, "cost": cost}}}
    (tmp_path / "ladder.json").write_text(json.dumps(said), encoding="utf-8")
    (found,) = points.collect(tmp_path / "traces", tmp_path, dict.fromkeys(QUANTITIES, Limit(1.0, 0.001, None)))
    assert found.label == "rung 2"
    assert found.errors == pytest.approx({"slip_f_t": 0.1, "slip_contact_length": 0.2}, rel=1e-12)
    assert (found.cost("slip_f_t", "work"), found.cost("press_contact_length", "work")) == (21, None)


def test_rung_that_costs_nothing_is_drawn_and_told(tmp_path):
    """No place on a logarithmic axis, but the cheapest in the table."""
    first = Point(points.RUNG_1, points.LADDER, *[dict.fromkeys(STATES, 0.0)] * 2, {"slip_f_t": 0.04})
    chart.write([*POINTS, first], 4, dict.fromkeys(QUANTITIES, Limit(1.0, 0.001, None)), tmp_path)
    assert "| f_T and µ_app, full slip | rung 1: 0 | none | none |" in (tmp_path / "chart.md").read_text(
        encoding="utf-8"
    )
    assert "rung 1" in (tmp_path / "chart.json").read_text(encoding="utf-8")


def test_default_without_its_time_is_named(tmp_path):
    untimed = [Point("default", "growth", POINTS[0].work, {}, POINTS[0].errors), *POINTS[1:]]
    with pytest.raises(ValueError, match="what the default scene took in processor time is not known"):
        chart.write(untimed, 4, dict.fromkeys(QUANTITIES, Limit(1.0, 0.001, None)), tmp_path)
