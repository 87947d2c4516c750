"""Numbers with units as text: the same number as in SI, or refused in one sentence that names the unit wanted."""

from dataclasses import replace

import numpy as np
import pint
import pytest

from fingerpad.results.result import Result
from fingerpad.scene import Scene, SceneError
from fingerpad.scene import scene as scenes
from fingerpad.slices.estimate import with_newtons
from geometry import units
from geometry.units import QUANTITIES, to_si
from tests.measures import contact_state
from tests.small_finger import small
from variational.state import ContactState

DRIVE = "is a measure of a drive: write voltage = {waveform = 'sine', "


def value(scene: scenes.Scene, key: str) -> float:
    found = scene
    for part in key.split("."):
        found = getattr(found, part)
    return found


@pytest.mark.parametrize(
    ("key", "text", "number"),
    [
        ("f_ext", "50 N/m", 50.0),
        ("f_ext", "0.05 N/mm", 50.0),
        ("mesh.contact", "5 µm", 5e-6),
        ("contact.eps_n", "1500 MPa/mm", 1.5e12),
        ("voltage", "0.2 kV", 200.0),
        ("numerics.memory", "16 GB", 16e9),
        ("numerics.memory", "2 GiB", 2.0 * 2**30),
    ],
)
def test_text_is_the_number(key, text, number):
    """To the last bit: a text is converted in decimals and rounded once, as the number is by Python."""
    assert value(scenes.load(None, {key: text}), key) == number


@pytest.mark.parametrize(
    ("key", "text", "message"),
    [
        ("f_ext", "50", "it has no unit; it must be a number in N/m or a text such as '50 N/m'"),
        ("voltage", "120 Vrms", f"its unit is V, and rms {DRIVE}rms = '120 V', frequency = '100 Hz'}}"),
        (
            "f_ext",
            "50 V",
            "its unit is not a unit of force per length; it must be a number in N/m or a text such as '50 N/m'",
        ),
        ("mesh.contact", "5 xm", "its unit is not known; it must be a number in m or a text such as '5 m'"),
        (
            "numerics.memory",
            "16 rad",
            "its unit is not a unit of memory; it must be a number in B or a text such as '16 B'",
        ),
        ("f_ext", "0,5 N/m", "decimals have points: write '0.5 N/m'"),
        ("friction", "0.25 V", "it must be a number"),
    ],
)
def test_refused(key, text, message):
    with pytest.raises(SceneError) as error:
        scenes.load(None, {key: text})
    assert str(error.value) == f"{key} is '{text}'; {message}"


@pytest.mark.parametrize("unit", QUANTITIES)
def test_every_unit_of_a_parameter_is_known(unit):
    assert to_si(f"1.5 {unit}", unit) == 1.5


@pytest.mark.parametrize("form", ["", ".0f~P"])
def test_quantities_of_pint_keep_their_digits(form):
    """Whatever their format for printing is."""
    registry = pint.UnitRegistry()
    registry.formatter.default_format = form
    found = Scene(mesh={"contact": 12.7 * registry.um}, voltage=np.float64(0.1503) * registry.kV)
    assert (found.mesh.contact, found.voltage) == (pytest.approx(12.7e-6, rel=1e-15), pytest.approx(150.3, rel=1e-15))


@pytest.mark.parametrize(
    ("unit", "given"),
    [(unit, f"{prefix}{unit}") for unit in units._PLAIN for prefix in units._PREFIXES]
    + [("N/m", given) for given in ("N/m", "mN/mm", "kN/m", "N/mm")]
    + [("Pa/m", "kPa/mm"), ("m/s", "mm/s"), ("m/s", "m/ms")],
)
def test_plain_units_are_those_of_pint(unit, given, monkeypatch):
    """To the last bit, for numbers that are rounded."""
    numbers = ("0.3", "-75", "1.7e-3", "123.456")
    plain = [to_si(f"{number} {given}", unit) for number in numbers]
    assert units._power(given, unit) is not None
    monkeypatch.setattr(units, "_power", lambda *given: None)
    assert plain == [to_si(f"{number} {given}", unit) for number in numbers]


# -- what a program computes from numbers within the ranges ----------------------------------------------------------
SLICES = {"radius": 6e-3, "length": 8e-3}


def pressed(f_ext: float) -> ContactState:
    """Return a state of the press, its depth and its contact as Hertz's law has them."""
    forces = {"f_ext": f_ext, "f_contact": f_ext, "contact_length": 1e-5 * f_ext**0.5}
    return contact_state(load="press", bone_height=-1e-6 * f_ext**0.5, ridges_in_contact=1, **forces)


@pytest.mark.parametrize(("bound", "reached"), [(1e-3, 0.0009999999999983022), (5e3, 5000.000000000003)])
def test_run_at_a_bound_has_its_newtons(bound, reached):
    """Its last state has the force to the tolerance of Newton's method only, which may be beyond the bound."""
    scene = small(slices=SLICES).replace(f_ext=bound)
    press = (pressed(0.1 * bound), pressed(0.5 * bound), pressed(reached))
    charged = replace(press[-1], voltage=scene.voltage, f_electrostatic=0.1 * bound)
    found = with_newtons(Result(scene, "full", press[-1], charged, None, steps=press))
    assert found.notes == ()
    assert found.finger.traces["charged"].end[1] == reached
