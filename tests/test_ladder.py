"""The closed form: forces in balance, sources named, fingers similar to the default one, and refusals."""

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.reduced import cylinders
from fingerpad.reduced.cylinder_errors import REGIONS
from fingerpad.reduced.default_finger import Similar, similar
from fingerpad.scene import SceneError, from_data
from fingerpad.scene.fingers import SOFT
from geometry.parameters import Fingertip
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
        ({"geometry": {"width": 19e-3}}, "geometry is not that of the default finger"),
        ({"materials": {"dermis": {"shear_modulus": 3e3}}}, "materials is not that of the default finger"),
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


# -- the closed form of fingers similar to the default one, by dimensional analysis ----------------------------------
SCALE, STIFFER = 0.9, 1.3
SHAPE = {name: SCALE * value for name, value in dict(Fingertip()).items() if isinstance(value, float)}
SKIN = {layer: {"shear_modulus": STIFFER * modulus} for layer, modulus in SOFT.items()}


def test_contact_is_scaled():
    """Its length by the lengths, at a force that is scaled by both; the bone's way likewise."""
    scene = fp.Scene(geometry=SHAPE, materials=SKIN, f_ext=60.0, voltage=0.0)
    assert similar(scene) == Similar(pytest.approx(SCALE), pytest.approx(STIFFER))
    default = fp.Scene(f_ext=60.0 / (SCALE * STIFFER), voltage=0.0)
    mine, known = (cylinders.solve(each).full_slip for each in (scene, default))
    assert mine.contact_length == pytest.approx(SCALE * known.contact_length, rel=1e-12)
    assert mine.ridges_in_contact == known.ridges_in_contact and mine.mu_app == pytest.approx(0.25, rel=1e-12)
    way = cylinders.indentation(60.0, "charged", similar(scene))
    assert way == pytest.approx(SCALE * cylinders.indentation(default.f_ext, "charged"), rel=1e-12)
    trace = cylinders.over_forces(scene, [60.0], "full_slip")[0]
    assert trace.contact_length == pytest.approx(mine.contact_length, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "table"),
    [
        ({"geometry": SHAPE | {"width": 0.0185}}, "geometry"),
        ({"geometry": SHAPE | {"ridge_count": 53}}, "geometry"),
        ({"materials": SKIN | {"dermis": {"shear_modulus": 2.55e3}}}, "materials"),
        ({"materials": SKIN | {"dermis": {"shear_modulus": STIFFER * 2.55e3, "alpha": 5.0}}}, "materials"),
        ({"materials": SKIN | {"dermis": {"law": "NeoHooke", "shear_modulus": 3e3}}}, "materials"),
        ({"finger": "callused"}, "geometry"),
    ],
)
def test_other_fingers_are_refused(changes, table):
    scene = fp.Scene(**changes)
    assert similar(scene) == table
    whose = f" of finger '{changes['finger']}'" if "finger" in changes else ""
    with pytest.raises(fp.SceneError, match=f"^{table}{whose} is not that of the default finger or of one similar"):
        cylinders.solve(scene)
