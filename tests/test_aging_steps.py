"""How long a step may be where laws depend on time."""

import numpy as np
import pytest

from fingerpad.model.schedule import targets
from fingerpad.scene import Load
from variational.solvers.target import Control, Progress, Target, Way

TAU = 4e-3  # s


def longest(part: float = 0.0, **of_target: float) -> float:
    """Return the longest step (s) of a target after a part of it."""
    start = Progress(Control(), 0.0, 0.0, np.zeros(2), 0.0, 0)
    target = Target("load", **of_target)
    return Way(start, target).longest(part, TAU) * target.duration


def test_after_a_change_at_once():
    """A quarter of the time since then with the shortest time added."""
    assert longest(duration=1.0) == pytest.approx(TAU / 4)
    assert longest(0.1, duration=1.0) == pytest.approx((TAU + 0.1) / 4)


def test_between_samples():
    """Time since a change counts up to 1.5 shortest times: 0.625 of that time is the longest first step."""
    assert longest(duration=0.1, since=1e-3) == pytest.approx((TAU + 1e-3) / 4)
    assert longest(duration=0.1, since=10.0) == pytest.approx(0.625 * TAU)
    assert longest(0.5, duration=0.1, since=10.0) == pytest.approx((2.5 * TAU + 0.05) / 4)


def test_pieces_of_a_square():
    """Each jump of the voltage begins the time anew; pieces after it go on."""
    wave = {"waveform": "square", "amplitude": 50.0, "frequency": 10.0}
    found = targets(Load(name="wave", duration=0.2, voltage=wave), 0.0, 1.0)[1:]
    jumps = [k for k, each in enumerate(found) if each.duration == 0.0]
    assert len(jumps) >= 3
    time = since = 0.0
    for each in found:
        since = 0.0 if each.duration == 0.0 else since
        assert each.since == pytest.approx(since, abs=1e-12)
        time, since = time + each.duration, since + each.duration
    assert time == pytest.approx(0.2)
