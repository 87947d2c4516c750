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


def test_table_names_the_cheapest_run_for_an_error(tmp_path):
    """5 % by the cheapest at half the default's work, 1 % and 0.2 % by the most expensive at twice it."""
    text = drawn(tmp_path, POINTS, ["40 µm: stuck"])
    row = next(line for line in text.splitlines() if line.startswith("| f_T"))
    assert row.split(" | ")[1:4] == ["cheap: 0.5", "expensive: 2", "expensive: 2"]
    assert "4 of 5 runs reached full slip" in text
    assert "Not reached: 40 µm: stuck" in text
    assert (tmp_path / "chart.png").exists()
