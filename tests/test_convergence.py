"""Limits of sequences whose limit is known."""

import numpy as np
import pytest

from benchmarks.limits import limit

SIZES = 0.5 ** np.arange(4)


@pytest.mark.parametrize("order", [0.6, 1.0, 1.5, 2.0])
def test_power_law(order):
    """A single power of the size is found exactly. Tolerance: roundoff of differences, 1e-14 of numbers about 2."""
    found = limit(list(2 - 0.3 * SIZES**order))
    assert found.order == pytest.approx(order, rel=1e-12)
    assert found.value == pytest.approx(2, rel=1e-14, abs=0)
    assert found.bar == pytest.approx(1.25 * 0.3 * SIZES[-1] ** order, rel=1e-12, abs=0)


def test_bar_covers_a_second_power():
    """Of two powers of one sign the lower order is underestimated by the finest meshes' changes, and the bar holds."""
    found = limit(list(1 + 0.1 * SIZES + 0.2 * SIZES**2))
    assert abs(found.value - 1) < found.bar


def test_swings_that_shrink():
    """Three times the last change, here of a value that swings about 1 with half the distance each time. Roundoff."""
    found = limit([1.4, 0.8, 1.1, 0.95])
    assert found.order is None
    assert (found.value, found.bar) == (0.95, pytest.approx(3 * 0.15, rel=1e-14))


@pytest.mark.parametrize(
    "values", [[1.0, 1.05, 1.2, 1.05], [1.0, 1.1, 1.2, 1.3], [1.0, 1.1, 1.2, 1.28], [1.0, 1.0, 1.1, 1.1]]
)
def test_no_order(values):
    """Changes that swing as far as before, hardly shrink, or vanish: three times the largest of the last two.

    Tolerance: roundoff.
    """
    found = limit(values)
    assert found.order is None
    assert found.value == values[-1]
    changes = abs(values[-1] - values[-2]), abs(values[-2] - values[-3])
    assert found.bar == pytest.approx(3 * max(changes), rel=1e-14, abs=0)


def test_accident_is_no_order():
    """A last change that happens to be small does not claim an accuracy of 2^-10: the bar is that of order 2.

    Tolerance: roundoff of the changes, 1e-4 of numbers about 1 in the order.
    """
    found = limit([1.0, 1.1024, 1.1025])
    assert found.order == pytest.approx(10, rel=1e-11)
    assert found.value == pytest.approx(1.1025 + 1e-4 / 3, rel=1e-14, abs=0)
    assert found.bar == pytest.approx(1.25 * 0.1024 / 12, rel=1e-12, abs=0)


def test_bar_covers_a_higher_order():
    found = limit(list(2 - 0.3 * SIZES**3))
    assert abs(found.value - 2) < found.bar


def test_two_values_are_too_few():
    with pytest.raises(ValueError, match="2 values"):
        limit([1.0, 1.1])
