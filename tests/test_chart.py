"""The chart of error over work, on made-up points."""

from benchmarks import chart, harness
from benchmarks.chart import ALL, QUANTITIES, Point
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
    assert [p.label for p in chart.front(POINTS, "full_slip_f_t")] == ["cheap", "default", "expensive"]
    assert [p.label for p in chart.front(POINTS, ALL)] == ["cheap", "default", "expensive"]


def test_places_on_the_fronts():
    """A run that is on none has no row; others have their places, from cheap to expensive."""
    lines = chart.fronts(POINTS).splitlines()
    assert [line.split(" | ")[0].lstrip("| ") for line in lines[2:]] == ["cheap", "default", "expensive"]
    assert [line.split(" | ")[1] for line in lines[2:]] == ["1", "2", "3"]


def test_front_over_time_is_another():
    """The run that takes least time comes first, however many factorisations it needs."""
    assert [p.label for p in chart.front(POINTS, "full_slip_f_t", "seconds")] == ["worse", "default", "expensive"]


def test_run_without_its_time_is_in_the_chart_of_work_alone():
    more = [*POINTS, Point("old", "growth", dict.fromkeys(STATES, 0.5), {}, dict.fromkeys(QUANTITIES, 1e-5))]
    assert [p.label for p in chart.front(more, "full_slip_f_t")] == ["old"]
    assert [p.label for p in chart.front(more, "full_slip_f_t", "seconds")] == ["worse", "default", "expensive"]


def test_front_is_of_the_defaults_contact():
    """Another penalty may come out near the limit, and is no part of it."""
    other = point("other", 0.5, 0.5, 1e-6, chart.OTHER_MODEL)
    assert [p.label for p in chart.front([*POINTS, other], "full_slip_f_t")] == ["cheap", "default", "expensive"]


def test_table_names_the_cheapest_run_for_an_error(tmp_path):
    """5 % by the cheapest at half the default's work, 1 % and 0.2 % by the most expensive at twice it."""
    text = drawn(tmp_path, POINTS, ["40 µm: stuck"])
    row = next(line for line in text.splitlines() if line.startswith("| f_T"))
    assert row.split(" | ")[1:4] == ["cheap: 0.5", "expensive: 2", "expensive: 2"]
    assert "4 of 5 runs reached full slip" in text
    assert "Not reached: 40 µm: stuck" in text
    assert (tmp_path / "chart.png").exists()


def test_every_scene_is_another():
    scenes = chart.scenes()
    assert len({str(scene.parameters()) for scene in scenes.values()}) == len(scenes)


def test_lost_runs_are_named():
    """With the reason; a run that reached full slip is not."""
    ends = {"P2-P1": {"full_slip": True}, "P2 reduced": {"full_slip": False}, "P3": {"failure": "no equilibrium"}}
    assert chart.failed(ends) == ["P2 reduced: no steady full slip by the end of the slide", "P3: no equilibrium"]
