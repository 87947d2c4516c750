"""The assumptions: every changed finger can be built, and the page has the changes of the runs."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import harness, sensitivity
from fingerpad.runs.batch import key


def test_every_changed_finger_can_be_built():
    """And none is another's: each choice changes the scene's parameters."""
    scenes = sensitivity.scenes()
    assert len({key(scene) for scene in scenes.values()}) == len(scenes)
    assert len(scenes) == 1 + sum(len(ways) for ways in sensitivity.CHOICES.values())


def test_ridges_tip_has_the_curvature_of_its_name():
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
    """Friction and SED at full slip, length in normal contact, and its reduction by sliding in per cent."""
    run = SimpleNamespace(
        steps={"mu_app": np.array([0.0, 0.5, 0.6]), "contact_length": np.array([2e-3, 1.9e-3, 1.5e-3])},
        normal=0,
        slip=2,
        receptors={"ridge": np.array([-1, 0, 1]), "merkel_sed": np.arange(9.0).reshape(3, 3)},
    )
    assert sensitivity.values(run) == pytest.approx((0.6, 2.0, 25.0, 7.0), rel=1e-12)


def test_page(tmp_path):
    """Changes are per cent of the run compared with, of the reduction percentage points; the largest comes first."""
    default, fine = [0.5, 1.8, 10.0, 800.0], [0.5, 1.8, 10.0, 900.0]
    changes = [
        {"choice": "depth", "way": "10 µm", "values": [0.5, 1.8, 10.0, 990.0], "base": fine},
        {"choice": "µ0", "way": "0.2", "values": [0.4, 1.8, 8.0, 700.0], "base": default},
    ]
    mesh = {"contact": 1e-5, "receptor": 2e-5}
    numbers = {"default": default, "mesh": mesh, "changes": changes, "lost": ["h_rms − 20 %: stuck"]}
    harness.keep("sensitivity", numbers, harness.Made("0", "abc", "2026-01-01"), tmp_path)
    text = sensitivity.draw(tmp_path).read_text(encoding="utf-8")
    assert "depends most on these choices: µ0 (20.0 %), depth (0.0 %). It does not depend on depth." in text
    assert "Not reached: h_rms − 20 %: stuck" in text
    assert "| µ0 | 0.2 | -20.0 | +0.0 | -2.0 | -12.5 |" in text
    assert "| depth | 10 µm | +0.0 | +0.0 | +0.0 | +10.0 |" in text
