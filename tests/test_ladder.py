"""The closed form: forces in balance, sources named, and refusals."""

import numpy as np
import pytest

from fingerpad.reduced import cylinders
from fingerpad.reduced.cylinder_errors import REGIONS
from fingerpad.scene import SceneError, from_data
from tests.test_laws import Held
from variational.contact.friction import Derjaguin


def scene(**data):
    return from_data(data)


# -- rung 1 ------------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def default():
    return cylinders.solve(scene())


@pytest.mark.parametrize("state", ["charged", "full_slip"])
def test_forces_balance(default, state):
    """The screen bears the load and the attraction: one subtraction, to roundoff of the scalar root."""
    s = default.named[state]
    assert s.f_contact - s.f_electrostatic == pytest.approx(75.0, rel=1e-9)


def nearest(key: str, value: float, friction: float) -> str:
    """Return the nearest range of a key among the regions over screens that have the friction coefficient."""
    regions = [r.ranges for r in REGIONS[1:] if r.ranges["friction"][0] <= friction <= r.ranges["friction"][1]]
    low, high = min((r[key] for r in regions), key=lambda ends: np.abs(np.log(np.array(ends) / value)).min())
    return f"{key} is {value:g} {'m' if '.' in key else 'N/m'}, and it is known for {low:g} to {high:g}"


def test_other_screen_than_the_runs_is_said():
    found = cylinders.solve(scene(friction=0.3, electric={"d_i": 2e-5}))
    assert any(nearest("electric.d_i", 2e-5, 0.3) in text.text for text in found.cautions)
    own = scene().replace(roughness=Held(), friction=Derjaguin(0.3, 1e3))
    (text,) = map(str, cylinders.solve(own).cautions)
    for table in ("friction", "roughness"):
        assert f"{table} is of another law, and it is known for that of the default scene" in text


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        ({"geometry": {"width": 19.123e-3}}, "the finger of this scene has no press yet"),
        ({"history": [{"name": "press", "f_ext": 5.0}]}, "history is given; the model 'cylinders'"),
    ],
)
def test_scene_it_does_not_know_is_refused(data, sentence):
    with pytest.raises(SceneError, match=sentence):
        cylinders.solve(scene(**data))


def test_closed_form_has_the_error_that_it_is_known_to(default):
    """Beside full runs, and none of a mesh, which it has not."""
    known = default.record["model_error"]
    for name, state in default.named.items():
        found = {key: error / abs(getattr(state, key)) for key, error in state.error.known().items()}
        assert {key: found[key] for key in known[name]} == pytest.approx(known[name], rel=1e-12)
    assert default.parts() == ("closed form",)
    assert any("no discretisation error" in note for note in default.notes)
