"""Ridges that adhere without a load: what a failure says of them, by states of one's own making."""

from dataclasses import replace

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.model.cautions import adhering, on_states, sticking
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


def test_ridge_under_the_least_load_is_the_nearest():
    """A ridge that lifted off, with a contact force of zero, is none that adheres."""
    words = adhering(state(150.0, [30.0, 20.0, 0.0]), EXACT)
    assert words.startswith("ridge 0 is nearest to adhering without a load at 150 V: by the closure BoundaryElements")
    assert words.endswith("another roughness.law")
    assert adhering(state(150.0, [0.0, 0.0, 0.0]), EXACT).startswith("at 150 V by the closure")
    assert adhering(state(50.0, [3.0, 2.0, 0.9]), EXACT) == adhering(None, EXACT) == ""


def test_states_that_attraction_holds_are_counted():
    """Without a force or pulled, under a voltage, in contact: the last of them and its ridge are named."""
    pressed, pulled = state(150.0, [3.0, 2.0, 1.5]), replace(state(150.0, [3.0, 2.0, 0.9]), f_ext=-0.1)
    free, lifted = replace(pressed, f_ext=1e-9), replace(pulled, contact_length=0.0)
    (text,) = on_states([pressed, free, pulled, lifted], EXACT)[:1]
    assert str(text) == (
        "in 2 of 3 charged states the finger adheres without a load, most by ridge 1, at -0.1 N/m and 150 V; by "
        "the closure BoundaryElements ridges adhere without a load from 90.5 V on"
    )
    assert not any("without a load" in str(text) for text in on_states([pressed, replace(pulled, voltage=0.0)], EXACT))


def test_cylinders_without_an_equilibrium_say_it():
    """At 4 kV no pressure of the closure holds; one sentence names the closure and its voltage."""
    with pytest.raises(fp.SceneError, match="cylinders.*by the closure BoundaryElements ridges adhere without a load"):
        fp.run(fp.Scene(voltage=4000.0, roughness={"law": "BoundaryElements"}), model="cylinders")
