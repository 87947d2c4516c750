"""A viscous body at the door: how long its loads take, and refusals without."""

import pytest

import fingerpad as fp
import geometry

G, NU = 86.76e3, 0.48
RELAXED = fp.Ogden(G, -14.53, NU)
SKIN = fp.Viscoelastic(RELAXED, fp.QLV([0.2, 0.4], [0.02, 0.1]))
DEPTH = -30e-6  # m


def ridge(material, **more) -> fp.Body:
    return fp.Body(geometry.ridge(size=60e-6), material, **more)


def at_once() -> fp.Ogden:
    """Return the elastic solid that the viscous one is at once: its shear modulus over 1 - 0.6, its bulk modulus."""
    shear, bulk = G / 0.4, 2 * G * (1 + NU) / (3 * (1 - 2 * NU))
    return fp.Ogden(shear, -14.53, (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)))


@pytest.mark.slow
@pytest.mark.parametrize(("seconds", "elastic"), [(0.0, at_once()), ("10 s", RELAXED)])
def test_forces_are_those_of_elastic_bodies(seconds, elastic):
    """Pressed at once and after 100 times of the slowest branch. Tolerance: the solves', and exp(-100)."""
    body = ridge(SKIN).press(height=DEPTH, seconds=0).press(height=DEPTH, seconds=seconds)
    assert body.state.f_ext == pytest.approx(ridge(elastic).press(height=DEPTH).state.f_ext, rel=1e-6)
    assert body.state.time == (0.0 if seconds == 0.0 else 10.0)


@pytest.mark.parametrize(("material", "friction"), [(SKIN, 0.25), (RELAXED, fp.Occlusion(0.25, 0.5))])
def test_loads_without_a_time_are_refused(material, friction):
    """Of a viscous material, and of friction that grows over time; a load that is refused leaves no state."""
    body = ridge(material, friction=friction, roughness=fp.BearingArea(h_0=0.51e-6))
    loads = (
        lambda: body.press(4.0),
        lambda: body.press(height=DEPTH),
        body.lift,
        lambda: body.charge(100.0),
        lambda: body.slide(1e-3),
    )
    for load in loads:
        with pytest.raises(ValueError, match=r"^\w+ takes seconds, how long the load lasts, 0 for at once"):
            load()
    assert body.states == [] and body.state.load == "unloaded"
