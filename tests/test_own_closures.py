"""Closures of one's own: what a run asks of them, and what is refused."""

import numpy as np
import pytest

from tests.test_laws import Held
from variational.roughness.bam import BearingArea
from variational.roughness.closure import AirGap, check
from variational.solvers.coupling import Coupling


class Shape(Held):
    def __call__(self, p_c):
        return AirGap(np.array([1e-6, 1e-6]))


class Plain(Held):
    def __call__(self, p_c):
        return np.full_like(p_c, 1e-6)


class Failing(Held):
    def __call__(self, p_c):
        raise KeyError("no such pressure")


class Speechless(Held):
    def state(self, p_c, voltage):
        return None


@pytest.mark.parametrize(
    ("closure", "sentence"),
    [
        (Shape(), r"closure Shape returns air gaps of shape \(2,\) for pressures of shape"),
        (Plain(), "closure Plain returns ndarray; it must return an AirGap"),
        (Failing(), "closure Failing cannot be evaluated: .*no such pressure"),
        (Speechless(), "closure Speechless returns None as a ridge's state; it must be text"),
        (lambda p_c: p_c, "it must be a Closure, with p_c in and an AirGap out"),
        (Held(0.0), "an air gap of 0 m at a pressure of 0 Pa; it must be finite and greater than 0"),
    ],
)
def test_what_is_no_closure_is_refused(closure, sentence):
    with pytest.raises(ValueError, match=sentence):
        check(closure)
    with pytest.raises(ValueError, match=sentence):
        Coupling(None, None, closure)


def test_closures_of_the_package_are_closures():
    check(BearingArea(0.5e-6))
    check(Held())
    assert Held().state(1e4, 200.0) == ""
