"""Runs beside tables of measurements: what of a run is compared, and which runs go together."""

from dataclasses import replace

import numpy as np
import pytest

from fingerpad.measurements.compare import comparison, computed, refuse_mixed
from fingerpad.measurements.table import read
from fingerpad.results.result import Result
from fingerpad.scene import Scene, SceneError
from fingerpad.slices.errors import MESH
from fingerpad.slices.finger import WholeFinger
from fingerpad.slices.total import Total
from tests.measures import contact_state
from variational.state import Errors


def state(step, f_ext, voltage=0.0, bone_x=0.0, **more):
    pressed = {"f_ext": f_ext, "f_contact": f_ext, "bone_height": -1e-5 * f_ext, "contact_length": 1e-4 * f_ext}
    return contact_state(step=step, voltage=voltage, bone_x=bone_x, **pressed | more)


def compared(runs, table):
    return comparison(table, computed(runs, table))


def ratio(runs, table):
    found = compared(runs, table)
    return found.computed.to_numpy() / found.measured.to_numpy()


def test_press_of_a_run_is_compared(table):
    """The states on the way down and no later ones; full slip is one state."""
    steps = (state(1, 10.0), state(2, 20.0), state(3, 20.0, 100.0), state(4, 20.0, 100.0, 1e-3, mu_app=0.4))
    run = Result(Scene(), "full", steps[1], steps[2], steps[3], steps=steps)
    pressed = read(table("# state: uncharged\nforce (N/m), depth (mm)\n15, 0.3\n"))
    assert compared(run, pressed).computed.tolist() == pytest.approx([1.5e-4])
    assert ratio(run, pressed) == pytest.approx([0.5])
    slip = read(table("friction (1)\n0.2\n"))
    assert ratio([run], slip) == pytest.approx([2.0])
    with pytest.raises(SceneError, match="have no state of full slip"):
        computed([Result(Scene(), "full", steps[1], None, None, steps=steps[:2])], slip)


def test_errors_of_named_states_are_carried(table):
    """Of the cross-section and of the whole finger; a step of the press has none, but for the named state's own."""
    steps = (state(1, 10.0), state(2, 20.0), state(4, 20.0, 100.0, 1e-3, mu_app=0.4))
    uncharged, slip = replace(steps[1], error=Errors(bone_height=2e-6)), replace(steps[2], error=Errors(mu_app=0.01))
    finger = WholeFinger({"full_slip": total(0.4, 8e-5)}, "test", {"full_slip": {MESH: {"contact_area": 3e-3}}})
    run = Result(Scene(), "full", uncharged, None, slip, steps=steps, finger=finger)
    for text, error in (
        ("# state: uncharged\nforce (N/m), depth (mm)\n20, 0.2\n10, 0.1\n", [2e-6, np.nan]),
        ("friction (1)\n0.2\n", [0.01]),
        ("contact area (mm^2)\n20\n", [3e-3 * finger.values("full_slip")["contact_area"]]),
        ("gross area (mm^2)\n20\n", [np.nan]),
    ):
        asked = read(table(text))
        np.testing.assert_array_equal(compared([run], asked).error, error)


def test_whole_finger_is_compared(table):
    """Newtons and mm² are of the runs' whole fingers, by force and voltage; a cross-section has none."""
    finger = [total(0.4, 8e-5), total(0.6, 1e-4)]
    slip = [state(4, 40.0, 100.0, mu_app=0.3), state(4, 60.0, 100.0, mu_app=0.3)]
    runs = [
        Result(Scene(), "full", None, None, s, finger=WholeFinger({"full_slip": f}, "test"))
        for s, f in zip(slip, finger, strict=True)
    ]
    area = read(table("force (mN), voltage (V), gross area (mm^2), spread (mm^2)\n500, 100, 45, 50\n"))
    assert area.whole and area.rows.iloc[0].to_dict() == pytest.approx(
        {"force": 0.5, "voltage": 100.0, "measured": 4.5e-5, "spread": 5e-5}
    )
    power = np.log(1e-4 / 8e-5) / np.log(0.6 / 0.4)
    assert ratio(runs, area) == pytest.approx([8e-5 * 1.25**power / 4.5e-5])
    friction = read(table("force (N), friction (1)\n0.4, 0.25\n"))
    assert ratio(runs[:1], friction) == pytest.approx([2.0])
    with pytest.raises(SceneError, match="the run has no newtons"):
        computed([Result(Scene(), "full", None, None, slip[0])], friction)


def total(force, area):
    """Return a whole finger of one slice, 1 mm thick, whose friction is half its force."""
    values = {"f_ext": force, "f_t": force / 2, "f_electrostatic": 0.0, "contact_length": area / 5, "gross_width": area}
    one = np.ones(1)
    return Total(1e-3, 0 * one, one, 1e-3 * one, force, {name: value * one for name, value in values.items()})


# -- runs together -------------------------------------------------------------------------------------------
def test_runs_of_other_models_and_screens_are_refused(tmp_path):
    """The model is no key of a scene."""
    runs = [Result(Scene(), model, None, None, None, folder=tmp_path / model) for model in ("full", "cylinders")]
    with pytest.raises(SceneError, match="model is 'full' in .*full and 'cylinders' in .*cylinders; give runs"):
        refuse_mixed(runs)
    runs = [Result(Scene(electric={"d_i": d_i}), "full", None, None, None) for d_i in (1e-6, 5e-6)]
    with pytest.raises(SceneError, match="electric.d_i is 1e-06 in a run and 5e-06 in a run; give runs that differ in"):
        refuse_mixed(runs)


def test_forces_on_the_finger_may_differ():
    """And be those at its centre; all else may not."""

    def under(force, **changes):
        return Result(Scene(force=force, **changes), "full", None, None, None)

    refuse_mixed([under(0.3, voltage=100), under(0.5, voltage=150), Result(Scene(), "full", *[None] * 3)])
    with pytest.raises(SceneError, match=r"friction is 0\.25 in a run and 0\.3 in a run"):
        refuse_mixed([under(0.3), under(0.5, friction=0.3)])
