"""The chart of error over work, on made-up points."""

from benchmarks import chart
from benchmarks.chart import ALL, QUANTITIES, Point
from benchmarks.errors import STATES


def point(label, work, seconds, error, family="growth"):
    costs = (dict.fromkeys(STATES, spent) for spent in (work, seconds))
    return Point(label, family, *costs, dict.fromkeys(QUANTITIES, error))


POINTS = [
    point("default", 2.0, 20.0, 0.02),
    point("cheap", 1.0, 30.0, 0.04),
    point("worse", 3.0, 10.0, 0.03),
    point("expensive", 4.0, 40.0, 0.001),
]


def test_front_has_no_run_that_another_one_beats():
    assert [p.label for p in chart.front(POINTS, "full_slip_f_t")] == ["cheap", "default", "expensive"]
    assert [p.label for p in chart.front(POINTS, ALL)] == ["cheap", "default", "expensive"]
