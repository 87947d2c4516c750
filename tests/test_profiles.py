"""The fingertip's curves against Table 1 and plane geometry."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.parameters import Fingertip
from geometry.profiles import Profiles

UM, MM = 1e-6, 1e-3
WAVE = Fingertip().ridge_wavelength
HALF_DEPTH = 50 * UM  # the mean of the skin lies that deep below the tips


def dense(profiles, depth, count=400001):
    """Return many points of one curve between the nail's edges; shape (count, 2)."""
    s = np.linspace(-profiles.nail_arc, profiles.nail_arc, count)
    return profiles.point(s, depth(s))


def test_arc_length(profiles):
    """Points one wavelength apart in s are so along the outline.

    Tolerance: chords of a thousandth of it and the interpolation in a table of arc lengths leave 4e-9.
    """
    s = np.linspace(20 * WAVE, 21 * WAVE, 1001)
    steps = np.linalg.norm(np.diff(profiles.point(s), axis=0), axis=1)
    assert steps.sum() == pytest.approx(WAVE, rel=2e-8)


@pytest.mark.parametrize("theta", [0.0, 0.3, np.pi / 2, 2.0, np.pi, -2.5])
def test_depths(profiles, theta):
    """The formulas of the three interfaces, below the outline's mean. Tolerance: roundoff."""
    s = np.array(theta / (2 * np.pi) * WAVE)
    ve_d = 450 + (225 if abs(theta) <= np.pi / 2 else 75) * (1 + np.cos(2 * theta))
    assert profiles.skin(s) - HALF_DEPTH == pytest.approx(-50 * UM * np.cos(theta), abs=1e-17)
    assert profiles.sc_ve(s) - HALF_DEPTH == pytest.approx((425 - 50 * np.cos(theta)) * UM, rel=1e-12, abs=0)
    assert profiles.ve_d(s) - HALF_DEPTH == pytest.approx(ve_d * UM, rel=1e-12, abs=0)
    assert profiles.d_sub(s) - HALF_DEPTH == pytest.approx(2000 * UM, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("profile", "crests"),
    [
        ((1.0, -0.6), (-0.18159912, 0.18159912)),
        ((-1.0,), (-0.5, 0.5)),
        ((0.0, -1.0), (-0.25, 0.25)),
        ((3.0, -0.5), (0,)),
    ],
)
def test_lowest_point_is_on_the_screen_wherever_the_crest_is(profile, crests):
    """Crests are where the profile's derivative vanishes; the lowest of them touches the screen, none is beyond.

    cos t - 0.6 cos 2t has its maxima where cos t = 1 / 2.4. Tolerance: points 25 nm apart on a tip of some 100 um; the
    table of arc lengths.
    """
    profiles = Profiles(Fingertip(ridge_profile=profile))
    assert np.array(profiles.crests) == pytest.approx(np.array(crests) * WAVE, abs=1e-7 * WAVE)
    skin = dense(profiles, profiles.skin)
    assert skin[:, 1].min() == pytest.approx(0, abs=1e-10)
    s = np.linspace(0, WAVE, 20001)
    assert np.ptp(profiles.skin(s)) == pytest.approx(100 * UM, rel=1e-6)
    assert profiles.skin(s).min() == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("sites", "places", "deep", "above", "below"),
    [("merkel_sites", [0.0], 880, "sc_ve", "ve_d"), ("meissner_sites", [-0.25, 0.25], 470, "ve_d", "d_sub")],
)
def test_sites_are_in_their_layers(profiles, sites, places, deep, above, below):
    """Merkel: one a ridge, 20 um above the intermediate ridge's tip and below the SC.

    Meissner: two a ridge, 20 um below the tops of the papillae and above the subcutis. Tolerance: roundoff of
    centimetres.
    """
    s = ((np.array(profiles.ridges)[:, None] + places) * WAVE).ravel()
    depth = np.full(55 * len(places), HALF_DEPTH + deep * UM)
    assert_allclose(getattr(profiles, sites)(), profiles.point(s, depth), rtol=0, atol=1e-15)
    assert (getattr(profiles, above)(s) < depth).all()
    assert (depth < getattr(profiles, below)(s)).all()
