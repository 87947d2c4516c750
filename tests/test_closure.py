"""Closures of one's own: what a run asks of them, and what is refused."""

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.runs import full
from fingerpad.runs.context import RunContext
from fingerpad.scene import from_data
from tests.measures import rows_of
from tests.runs import tables_alone
from tests.test_laws import SMALL, Held
from variational.roughness.bam import BearingArea
from variational.roughness.closure import AirGap, check
from variational.solvers.coupling import Coupling


class Shape(Held):
    def __call__(self, p_c):
        return AirGap(np.array([1e-6, 1e-6]))


class Telling(Held):
    def state(self, p_c, voltage):
        return repr(p_c)


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


@pytest.mark.slow
def test_notes_are_of_the_pressures_that_the_closure_gets(tmp_path):
    """Held air gaps make the forces the same whatever the length of Eq. 4 is; below them the skin is longer."""
    history = [{"name": "press", "f_ext": 1.0}, {"name": "charge", "voltage": 100.0}]
    data = {key: value for key, value in SMALL.items() if isinstance(value, dict)} | {"history": history}
    told = {}
    for length in ("pressure", "gap"):
        scene = from_data(data | {"contact": {"length": length}}).replace(roughness=Telling())
        with tables_alone():
            full.run(scene, RunContext(tmp_path / length, MPI.COMM_SELF))
        rows = [row for row in rows_of(tmp_path / length, "ridges") if float(row["p_c"]) > 0]
        told[length] = np.array([[float(row["p_c"]), float(row["note"])] for row in rows])
    np.testing.assert_array_equal(told["pressure"][:, 0], told["pressure"][:, 1])
    np.testing.assert_array_equal(told["gap"][:, 0], told["pressure"][:, 0])
    assert (told["gap"][:, 1] < 0.98 * told["gap"][:, 0]).all()
