"""Ranges are for what a person types: what a program computes from numbers within them is taken as it is."""

import json
from dataclasses import replace

import pytest

from fingerpad.results.result import Result
from fingerpad.scene import SceneError, as_kept
from fingerpad.slices.estimate import with_newtons
from fingerpad.slices.traces import history
from geometry.units import computed
from tests.small_finger import small
from variational.state import ContactState

SLICES = {"radius": 6e-3, "length": 8e-3}


def pressed(f_ext: float) -> ContactState:
    """Return a state of the press, its depth and its contact as Hertz's law has them."""
    return ContactState(
        load="press",
        f_ext=f_ext,
        voltage=0.0,
        bone_height=-1e-6 * f_ext**0.5,
        f_t=0.0,
        mu_app=0.0,
        f_contact=f_ext,
        f_electrostatic=0.0,
        ridges_in_contact=1,
        contact_length=1e-5 * f_ext**0.5,
    )


@pytest.mark.parametrize(("bound", "reached"), [(1e-3, 0.0009999999999983022), (5e3, 5000.000000000003)])
def test_run_at_a_bound_has_its_newtons(bound, reached):
    """Its last state has the force to the tolerance of Newton's method only, which may be beyond the bound."""
    scene = small(slices=SLICES).replace(f_ext=bound)
    press = (pressed(0.1 * bound), pressed(0.5 * bound), pressed(reached))
    charged = replace(press[-1], voltage=scene.voltage, f_electrostatic=0.1 * bound)
    found = with_newtons(Result(scene, "full", press[-1], charged, None, steps=press))
    assert found.notes == ()
    assert found.finger.traces["charged"].end[1] == reached


@pytest.mark.parametrize("slide", [1e-9, 0.1])
def test_trace_of_a_slide_at_a_bound_can_be_run_and_read(slide):
    """Its loads move the bone by a quarter of slide_length and by twice of it."""
    trace = history(small(slide_length=slide), "full_slip", 1.0)
    assert [load.bone_x for load in trace.loads()[2:]] == [slide / 4, slide, 2 * slide]
    assert as_kept(json.loads(json.dumps(trace.parameters()))) == trace


def test_what_is_typed_is_refused_after_all():
    """Beside a computed number, and after an error in its place."""
    with pytest.raises(ZeroDivisionError), computed():
        assert small().replace(f_ext=1e-4).f_ext == 1e-4
        raise ZeroDivisionError
    with pytest.raises(SceneError, match=r"f_ext is 0.0001 N/m; it must be from 0.001 to 5000 N/m"):
        small().replace(f_ext=1e-4)
