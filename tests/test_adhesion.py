"""Ridges that adhere without a load: what a failure says of them, by states of one's own making."""

from dataclasses import replace

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.model.adhesion import adhering, sticking
from tests.test_closure_band import Held
from variational.state import RidgeStates

EXACT = fp.BoundaryElements(0.514e-6)


def state(voltage: float, f_contact: list[float]):
    """A state of ridges -1 to 1, of which each is attracted by 1 N/m."""
    base = fp.run(fp.Scene(voltage=10.0), model="cylinders").full_slip
    f = np.array(f_contact)
    number, one = np.array([-1, 0, 1]), np.ones(3)
    ridges = RidgeStates(number, 1e-4 * (f > 0), f, 0 * f, one, f / 1e-4, 1e-6 * one)
    return replace(base, voltage=voltage, ridges=ridges)


def test_sticking_by_voltage():
    """From the closure's own voltage on, of either sign; below it, and of laws without one, nothing."""
    least = EXACT.sticking_voltage()
    assert (
        sticking(EXACT, -1.01 * least) == "by the closure BoundaryElements ridges adhere without a load from 90.5 V on"
    )
    assert sticking(EXACT, 0.99 * least) == sticking(Held(), 200.0) == sticking(None, 200.0) == ""
    assert "BearingArea" in sticking(fp.BearingArea(0.514e-6), 200.0)


def test_ridge_that_adheres_is_named():
    words = adhering(state(150.0, [3.0, 2.0, 0.9]), EXACT)
    assert words.startswith("ridge 1 adheres without a load at 150 V: by the closure BoundaryElements ridges adhere")


def test_ridges_under_a_load_are_not_named():
    """A ridge that lifted off, with a contact force of zero, is none that adheres."""
    words = adhering(state(150.0, [3.0, 2.0, 0.0]), EXACT)
    assert words.startswith("at 150 V by the closure") and words.endswith("another roughness.law")
    assert adhering(state(50.0, [3.0, 2.0, 0.9]), EXACT) == adhering(None, EXACT) == ""


def test_cylinders_without_an_equilibrium_say_it():
    """At 4 kV no pressure of the closure holds; one sentence names the closure and its voltage."""
    with pytest.raises(fp.SceneError, match="cylinders.*by the closure BoundaryElements ridges adhere without a load"):
        fp.run(fp.Scene(voltage=4000.0, roughness={"law": "BoundaryElements"}), model="cylinders")
