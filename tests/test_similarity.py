"""The closed form of fingers similar to the default one, by dimensional analysis."""

import pytest

import fingerpad as fp
from fingerpad.reduced import cylinders
from fingerpad.reduced.default_finger import Similar, similar
from fingerpad.scene.fingers import SOFT
from geometry.parameters import Fingertip

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
