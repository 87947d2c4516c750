"""The outline of the smooth finger: the mean line of the ridges, as far from the bone as they are."""

import numpy as np
import pytest

from fingerpad.reduced import ridge_cell, smooth
from geometry.parameters import Fingertip
from geometry.profiles import Profiles


@pytest.mark.parametrize("profile", [(-1.0,), (1.0, -0.6)])
def test_mean_line_where_the_crest_is_beside_the_middle(profile):
    """The bone is as far from the smooth outline as from the mean line, which crests beside the middle lower."""
    finger = Fingertip(ridge_profile=profile)
    ridged, flat = Profiles(finger), smooth.smoothed(finger)
    mean = ridge_cell.mean_depth(finger)
    lowest = ridged.point(0.0, mean)[1]
    assert lowest == pytest.approx(mean - ridged.lowered, rel=1e-9) and ridged.lowered > 1e-7
    assert flat.bone_centre == pytest.approx(finger.bone_centre - lowest, rel=1e-12)


def test_smooth_outline_is_the_mean_line():
    """Lowered to the screen it lies half an amplitude inside the tips, as far from the bone as before.

    Tolerance: the ellipse whose axes are shorter by as much is the offset curve to second order of 50 um over 14 mm.
    """
    finger = Fingertip()
    ridged, flat = Profiles(finger), Profiles(smooth.smoothed(finger))
    assert ridge_cell.mean_depth(finger) == pytest.approx(50e-6, rel=1e-9)
    s = np.linspace(-4e-3, 4e-3, 9)
    mean_line = ridged.point(s, 50e-6) - [0, 50e-6]
    nearest = [np.hypot(*(flat.point(np.linspace(-5e-3, 5e-3, 20001), 0.0) - p).T).min() for p in mean_line]
    assert max(nearest) < 0.5e-6
    assert finger.bone_centre - smooth.smoothed(finger).bone_centre == pytest.approx(50e-6, rel=1e-9)
