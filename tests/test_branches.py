"""Forces of a trace of full slip."""

import numpy as np
import pytest

from fingerpad.runs import branches
from fingerpad.slices.traces import MARGIN


def test_roots_of_forces_are_evenly_apart_and_have_those_that_are_kept():
    """So are the indentations, about: under large forces no more ridges come down between two points."""
    top, light = 80.0, 80.0 * branches.LIGHT
    kept = (branches.KEPT * top, top / MARGIN)
    found = branches._forces(light, top, kept)
    assert set(kept) < set(found) and found[-1] == top
    steps = np.diff(np.sqrt([light, *found]))
    apart = (top**0.5 - light**0.5) / (branches.POINTS - 1)
    assert (steps > 0).all() and steps.max() < 1.5 * apart
    assert len(found) == pytest.approx(branches.POINTS, abs=2)
