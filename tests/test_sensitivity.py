"""The open choices: every changed finger can be built, and what is drawn is what was run."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import sensitivity
from benchmarks.sensitivity import Change
from fingerpad.runs.batch import key


def test_every_changed_finger_can_be_built():
    """And none is another's: each choice changes the scene's parameters."""
    scenes = sensitivity.scenes(10e-6)
    assert len({key(scene) for scene in scenes.values()}) == len(scenes)
    assert len(scenes) == 1 + sum(len(ways) for ways in sensitivity.CHOICES.values())


def test_ridges_tip_is_as_curved_as_said():
    """Second differences of the profile at the tip, over the sinusoid's. Tolerance: of order of their step squared."""
    from geometry.parameters import Fingertip
    from geometry.profiles import Profiles

    def curvature(coefficients):
        profiles = Profiles(Fingertip(ridge_profile=coefficients))
        step = 1e-6
        return float(profiles.skin(step) + profiles.skin(-step) - 2 * profiles.skin(0.0)) / step**2

    plain = curvature((1.0,))
    assert curvature((1.0, -0.125)) / plain == pytest.approx(0.5, rel=1e-3)
    assert curvature((1.0, 0.125)) / plain == pytest.approx(1.5, rel=1e-3)


def test_values_of_a_run():
    """Friction and SED at full slip, length in normal contact, and what sliding takes of it in per cent."""
    run = SimpleNamespace(
        steps={"mu_app": np.array([0.0, 0.5, 0.6]), "contact_length": np.array([2e-3, 1.9e-3, 1.5e-3])},
        normal=0,
        slip=2,
        receptors={"ridge": np.array([-1, 0, 1]), "merkel_sed": np.arange(9.0).reshape(3, 3)},
    )
    assert sensitivity.values(run) == pytest.approx((0.6, 2.0, 25.0, 7.0), rel=1e-12)


def test_page(tmp_path):
    default = Change("default", "", (0.5, 1.8, 10.0, 800.0))
    changes = [default, Change("µ0", "0.2", (0.4, 1.8, 8.0, 700.0)), Change("h_rms", "+ 20 %", (0.45, 1.8, 9.0, 790.0))]
    sensitivity.write(changes, ["h_rms − 20 %: stuck"], 27, 10e-6, tmp_path)
    text = (tmp_path / "sensitivity.md").read_text(encoding="utf-8")
    assert "3 of 27 runs" in text
    assert "Not reached: h_rms − 20 %: stuck." in text
    assert "| µ0 | 0.2 | 0.4 | 1.8 | 8 | 700 |" in text
    assert (tmp_path / "sensitivity.png").exists()
    sensitivity.write(changes[1:], [], 27, 10e-6, tmp_path)
    assert "png" not in (tmp_path / "sensitivity.md").read_text(encoding="utf-8")
