"""The chart of error over work, on made-up points."""

import pytest

from benchmarks import chart, errors, harness
from benchmarks.chart import AGAIN, ALL, QUANTITIES, REDUCED, Point
from benchmarks.errors import STATES
from benchmarks.limits import Limit

REFERENCE = dict.fromkeys(QUANTITIES, Limit(1.0, 0.001, None))
BY = harness.Made("0", "abc", "2026-01-01")


def point(label, work, seconds, error, family="growth"):
    costs = (dict.fromkeys(STATES, spent) for spent in (work, seconds))
    return Point(label, family, *costs, dict.fromkeys(QUANTITIES, error))


POINTS = [
    point("default", 2.0, 20.0, 0.02),
    point("cheap", 1.0, 30.0, 0.04),
    point("worse", 3.0, 10.0, 0.03),
    point("expensive", 4.0, 40.0, 0.001),
]


def drawn(docs, some, lost=()):
    """Return the page of some points."""
    reference = {name: vars(end) for name, end in REFERENCE.items()}
    numbers = {"reference": reference, "points": [vars(p) for p in some], "lost": list(lost)}
    harness.keep("chart", numbers, BY, docs)
    return chart.draw(docs).read_text(encoding="utf-8")


def test_front_has_no_run_that_another_one_beats():
    assert [p.label for p in chart.front(POINTS, "slip_f_t")] == ["cheap", "default", "expensive"]
    assert [p.label for p in chart.front(POINTS, ALL)] == ["cheap", "default", "expensive"]


def test_front_over_time_is_another():
    """The run that takes least time comes first, however many factorisations it needs."""
    assert [p.label for p in chart.front(POINTS, "slip_f_t", "seconds")] == ["worse", "default", "expensive"]


def test_run_without_its_time_is_in_the_chart_of_work_alone():
    more = [*POINTS, Point("old", "growth", dict.fromkeys(STATES, 0.5), {}, dict.fromkeys(QUANTITIES, 1e-5))]
    assert [p.label for p in chart.front(more, "slip_f_t")] == ["old"]
    assert [p.label for p in chart.front(more, "slip_f_t", "seconds")] == ["worse", "default", "expensive"]


@pytest.mark.parametrize("family", [AGAIN, REDUCED, chart.OTHER_MODEL])
def test_front_is_of_whole_paths_of_the_model(family):
    """States without a path and another penalty may come out near the limit, and are no part of it."""
    other = point("other", 0.5, 0.5, 1e-6, family)
    assert [p.label for p in chart.front([*POINTS, other], "slip_f_t")] == ["cheap", "default", "expensive"]


def test_table_names_the_cheapest_run_for_an_error(tmp_path):
    """5 % by the cheapest at half the default's work, 1 % and 0.2 % by the most expensive at twice it."""
    text = drawn(tmp_path, POINTS, ["40 µm: stuck"])
    row = next(line for line in text.splitlines() if line.startswith("| f_T"))
    assert row.split(" | ")[1:4] == ["cheap: 0.5", "expensive: 2", "expensive: 2"]
    assert "4 of 5 runs reached full slip" in text
    assert "Not reached: 40 µm: stuck" in text
    assert (tmp_path / "chart.png").exists()


def test_states_without_a_path_have_a_table_of_their_own(tmp_path):
    """With no entry for what they do not answer; one that costs nothing is the cheapest, at no place of the axis."""
    again = Point("again", AGAIN, dict.fromkeys(STATES, 0.2), dict.fromkeys(STATES, 0.2), {"slip_f_t": 1e-5})
    free = Point("cylinders", REDUCED, dict.fromkeys(STATES, 0.0), dict.fromkeys(STATES, 0.0), {"slip_f_t": 0.04})
    text = drawn(tmp_path, [*POINTS, again, free])
    assert "4 of 4 runs" in text
    assert "| f_T and µ_app, full slip | cylinders: 0 | again: 0.1 | again: 0.1 |" in text
    assert "| contact length, full slip | none | none | none |" in text


def test_every_scene_is_another():
    scenes = chart.scenes()
    assert len({str(scene.parameters()) for scene in scenes.values()}) == len(scenes)


def test_lost_runs_are_named():
    """With the reason; a run that reached full slip is not."""
    ends = {"P2-P1": {"full_slip": True}, "P2 reduced": {"full_slip": False}, "P3": {"failure": "no equilibrium"}}
    assert chart.lost(ends) == ["P2 reduced: no steady full slip by the end of the slide", "P3: no equilibrium"]


@pytest.fixture
def kept(tmp_path):
    """Numbers of the other studies: an accuracy, a reduced model, states solved again on two meshes."""

    def solve(contact, value):
        spent = {"unknowns": 10, "factorisations": 5, "processor_seconds": 2.0}
        return spent | {"mesh": {"contact": contact}, "values": dict.fromkeys(QUANTITIES, value)}

    again = {"path": solve(20e-6, 1.5), "levels": [solve(10e-6, 1.1), solve(5e-6, 1.01)]}
    run = {"work": 900.0, "seconds": 7.5, "values": {"slip_f_t": 1.1}}
    cost = {"factorisations": 3, "unknowns": 7, "seconds": 0.5}
    smooth = {"summary": {"slip_f_t": 0.9, "slip_contact_length": 1.2}, "cost": cost}
    scene = f"{errors.DEFAULT.f_ext:g} N/m, {errors.DEFAULT.voltage:g} V"
    harness.keep("errors", {"again": again}, BY, tmp_path)
    harness.keep("accuracy", {"runs": {"default scene; µ_app 1 %": run, "1: other; µ_app 1 %": run}}, BY, tmp_path)
    harness.keep("models", {"scenes": {scene: {"smooth": smooth, "full": smooth}}}, BY, tmp_path)
    return {p.label: p for p in chart.without_path(tmp_path, REFERENCE)}


def test_states_cost_their_path_and_coarser_meshes(kept):
    """Five factorisations of 10 unknowns on each of the meshes, the path among them; the last is off by 1 %."""
    found = [kept["again at 10 µm"], kept["again at 5 µm"]]
    assert [p.cost("slip_f_t", "work") for p in found] == [100, 150]
    assert [p.cost("slip_f_t", "seconds") for p in found] == [4, 6]
    assert found[1].error("slip_f_t") == found[1].error(ALL) == pytest.approx(0.01, rel=1e-12)


def test_requested_accuracy_costs_all_its_solves(kept):
    found = kept["µ_app 1 %"]
    assert (found.cost("slip_f_t", "work"), found.cost("slip_f_t", "seconds")) == (900, 7.5)
    assert "1: other" not in " ".join(kept)


def test_reduced_model_has_an_error_for_what_it_answers(kept):
    """No energy density, nor the contact before the voltage; the full run is no point of its own."""
    found = kept["smooth"]
    assert found.errors == pytest.approx({"slip_f_t": 0.1, "slip_contact_length": 0.2}, rel=1e-12)
    assert (found.cost("slip_f_t", "work"), found.cost("uncharged_contact_length", "work")) == (21, None)
    assert found.error(ALL) is None
    assert [p.label for p in kept.values() if p.family == REDUCED] == ["smooth"]


def test_default_without_its_time_is_named(tmp_path):
    untimed = [Point("default", "growth", POINTS[0].work, {}, POINTS[0].errors), *POINTS[1:]]
    with pytest.raises(ValueError, match="the processor time of the default scene is not known"):
        drawn(tmp_path, untimed)
