"""Blunter ridge tips of charged cylinders, against Hertz's contact under a weak voltage."""

import numpy as np
import pytest
from scipy.optimize import brentq

from fingerpad.reduced import cylinders
from fingerpad.reduced.closure_band import TIPS
from fingerpad.scene import Scene
from tests.test_closure_band import Held

FORCE, VOLTS, GAP = 75.0, 10.0, 2e-6


def attraction(radius: float, length: float, h_0: float) -> float:
    """Return the attraction (N/m) of a ridge in Hertz's contact, as far as its gap is within h_0 + 2 d_eq.

    Gap of a cylinder beside its contact: Johnson, Contact Mechanics, 1985, doi 10.1017/CBO9781139171731, sec. 4.2(c).
    """
    a = length / 2

    def gap(s: float) -> float:
        return a**2 / (2 * radius) * (s * np.sqrt(s**2 - 1) - np.arccosh(s))

    attracted = a * brentq(lambda s: gap(s) - (h_0 + 2 * GAP), 1, 10)
    return 8.8541878128e-12 * VOLTS**2 / 2 / (h_0 + GAP) ** 2 * 2 * attracted


@pytest.mark.parametrize("tips", [1.0, *TIPS])
def test_blunter_tips_attract_more(tips):
    """Their radius is larger by a factor, their length in contact by its root: a^2 = 4 f R / (pi E*), the same E*.

    Tolerance: at 10 V the attraction is 0.2 % of the load and lengthens the contact by half of that.
    """
    scene = Scene(voltage=VOLTS, roughness=Held())
    (pressed,) = cylinders.over_forces(scene.replace(voltage=0.0), [FORCE], "charged")
    (found,) = cylinders.over_forces(scene, [FORCE], "charged", tips=tips)
    ridges, radius = pressed.ridges_in_contact, tips * cylinders.tip_radius(scene.geometry)
    expected = ridges * attraction(radius, tips**0.5 * pressed.contact_length / ridges, scene.h_0)
    assert found.f_electrostatic == pytest.approx(expected, rel=2e-3)
