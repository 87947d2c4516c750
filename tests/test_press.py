"""A finger's press is made once, kept, and used again; and the tips of its ridges, which need not be cylinders."""

import json

import numpy as np
import pytest
from scipy.integrate import quad

import fingerpad as fp
from benchmarks.presses import REDUCED, regions
from fingerpad.reduced import press
from fingerpad.reduced.cylinder_errors import find
from fingerpad.reduced.cylinders import over_forces
from fingerpad.reduced.press import Press
from fingerpad.runs import press as making
from fingerpad.scene.fingers import FINGERS
from tests.commands import kept
from tests.small_finger import NINE
from variational.attraction.tip import Power, Round, kernel

FLAT = {"ridge_profile": [1.0, -0.5, 1 / 7, -1 / 56]}
"""-sin(t/2)^8."""
LENGTHS = {"charged": (1e-3, 3e-3, 6e-3)}
OWN = Press.of({"forces": (2, 20, 200), "lengths": LENGTHS, "ridges": {"charged": (5, 15, 23)},
                "indentations": {"charged": (2e-4, 7e-4, 2e-3)}})  # fmt: skip


# -- the tips ----------------------------------------------------------------------------------------------------
def test_power_of_two_is_a_cylinder():
    """Force, gap and derivatives, to roundoff of the quadrature."""
    radius, f = 118e-6, np.array([0.1, 4.0])
    a_0, modulus = np.array([20e-6, 60e-6]), np.array([3e5, 5e5])
    tip = Power(np.array([2.0, 2.0]), np.pi * a_0**2 / (4 * radius), a_0)
    assert tip.modulus(f, 1e-4) == pytest.approx(Round(radius).modulus(f, 1e-4), rel=1e-12)
    assert tip.alone(modulus, f) == pytest.approx(Round(radius).alone(modulus, f), rel=1e-12)
    beyond = np.array([0.3, 4.0])
    root, angle = np.sqrt(beyond * (2 + beyond)), np.arccosh(1 + beyond)
    for one, other in zip(tip.gap(a_0, beyond, root, angle), Round(radius).gap(a_0, beyond, root, angle), strict=True):
        assert one == pytest.approx(other, rel=1e-9)


def test_gap_beside_a_flat_tip_is_that_of_its_punches():
    """The integral over the row of punches, by quadrature."""
    p, a, m = 6.5, 100e-6, 1.7
    tip = Power(np.array([p]), np.array([8e-6]), np.array([90e-6]))
    found = tip.gap(np.array([a]), np.array([m - 1]), np.array([np.sqrt(m**2 - 1)]), np.array([np.arccosh(m)]))[0][0]
    grows = 8e-6 * p / 90e-6
    expected = quad(lambda b: 2 / np.pi * grows * (b / 90e-6) ** (p - 1) * np.arccosh(m * a / b), a, m * a)[0]
    assert found == pytest.approx(expected, rel=1e-6)


def test_kernel_of_a_profile():
    """The integral of the theory, and its logarithmic slope; of a small contact of a sinusoid that of its crest."""
    wave, heights, a = 483e-6, np.array([30e-6, -7e-6, 1e-6]), np.array([80e-6])
    q = 2 * np.pi / wave * np.arange(1, 4)

    def k(half):
        return quad(lambda t: half * np.sin(t) * (heights * q * np.sin(q * half * np.sin(t))).sum(), 0, np.pi / 2)[0]

    depth, power = kernel(heights, wave, a)
    assert depth[0] == pytest.approx(k(80e-6), rel=1e-9)
    assert power[0] == pytest.approx(np.log(k(80.1e-6) / k(79.9e-6)) / np.log(80.1 / 79.9), rel=1e-5)
    depth, power = kernel([50e-6], wave, np.array([1e-6]))
    assert (depth[0], power[0]) == pytest.approx((np.pi * 1e-12 * 50e-6 * q[0] ** 2 / 4, 2.0), rel=1e-3)


# -- the press ---------------------------------------------------------------------------------------------------
@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache, and a press that is made at once."""
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path))
    monkeypatch.setattr(making, "made", lambda scene: calls.append(scene) or OWN)
    press._found.cache_clear()
    calls = list[fp.Scene]()
    yield calls
    press._found.cache_clear()


def test_press_is_made_once_and_kept(cache, capsys):
    """For every friction, voltage and roughness, and by the model; another finger has another press."""
    scene = fp.Scene(geometry=FLAT, f_ext=50.0)
    with pytest.raises(fp.SceneError, match="^the finger of this scene has no press yet, .*; fp.press.scene. makes it"):
        over_forces(scene, [50.0], "full_slip")
    first = fp.run(scene, model="cylinders", voltage=100.0)
    assert "one press of this finger is made" in capsys.readouterr().err and press.file_of(scene).exists()
    press._found.cache_clear()
    other = scene.replace(friction=0.4, roughness={"h_rms": 4e-6}, electric={"d_i": 2e-6})
    assert press.known(other) == OWN == fp.press(other) and len(cache) == 1
    (again,) = over_forces(scene.replace(voltage=100.0), [50.0], "full_slip")
    assert again.mu_app == pytest.approx(first.full_slip.mu_app, rel=1e-12)
    assert press.name(scene.replace(materials={"subcutis": {"shear_modulus": 5e3}})) != press.name(scene)


def test_forces_of_flat_tips_balance():
    """Without voltage the contact is that of the press; with one the screen bears load and attraction."""
    scene = fp.Scene(geometry=FLAT, voltage=0.0)
    (still,) = over_forces(scene, [50.0], "charged", OWN)
    assert still.contact_length == pytest.approx(OWN.length(50.0, "charged"), rel=1e-9)
    (found,) = over_forces(scene.replace(voltage=150.0), [50.0], "full_slip", OWN)
    assert found.f_contact == pytest.approx(50.0 + found.f_electrostatic, rel=1e-9)
    assert found.contact_length > (1 - found.f_t**2 / (50.0 * press.ROLL)) * OWN.length(50.0, "charged")


def test_friction_rolls_ridges_off():
    """The contact that is left is the press's without f_T^2 / (f F) of it, beside roundoff of the ridges' number."""
    friction = {"law": "Derjaguin", "mu_f": 0.0, "tau_0": 10e3}
    scene = fp.Scene(geometry=FLAT, voltage=0.0, friction=friction)
    (found,) = over_forces(scene, [50.0], "full_slip", OWN)
    left = 1 - found.f_t**2 / (50.0 * press.ROLL)
    stiffer = 0.95  # of ridges by their shear, at least
    assert stiffer * left < found.contact_length / OWN.length(50.0, "charged") < left < 0.95


@pytest.mark.parametrize("name", FINGERS)
def test_package_has_the_press_of_each_finger(name):
    assert press.name(fp.Scene(finger=name)) in press.shipped()


@pytest.mark.slow
def test_press_of_a_small_finger(cache, monkeypatch):
    """Contact and indentation grow with the force, and ridges touch in pairs about the middle one."""
    monkeypatch.undo()
    monkeypatch.setattr(making, "FORCES", (0.5, 1.0, 1.5, 2.0))
    found = making.made(fp.Scene(geometry=NINE["geometry"]))
    assert found.forces == (0.5, 1.0, 1.5, 2.0)
    for values in (found.lengths["charged"], found.indentations["charged"]):
        assert np.all(np.diff(values) > 0)
    assert found.ridges["charged"][-1] > 1 and all(count % 2 for count in found.ridges["charged"])


# -- the fingers whose error is known ------------------------------------------------------------------------------
def test_errors_of_fingers_are_those_of_the_kept_states():
    """And a result has them, in their range: of the whole finger none, which was not compared."""
    numbers = kept("presses.json")
    assert json.loads((REDUCED / "finger_errors.json").read_text(encoding="utf-8")) == json.loads(
        json.dumps(regions(numbers))
    )
    for finger, states in numbers.items():
        scene = fp.Scene(finger=finger, f_ext=states[-1]["f_ext"], voltage=100.0)
        found = fp.run(scene, model="cylinders")
        assert found.full_slip.error.mu_app > 0, finger
        assert not find(scene.replace(friction=0.9), 1.0) and not find(scene.replace(f_ext=300.0), 1.0)
