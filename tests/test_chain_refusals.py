"""Sweeps of full slip refuse in one sentence what they do not have."""

import pytest

import fingerpad as fp
from fingerpad.scene import SceneError


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"accuracy": {"mu_app": 0.01}}, "accuracy is given"),
        ({"force": 0.1}, "force is 0.1"),
        ({"history": [{"name": "press", "f_ext": 1.0}]}, "history is given"),
        (
            {"materials": {"dermis": {"viscosity": {"preset": "fingerpad"}}}},
            "materials.dermis.viscosity is given, and a state needs the past of its layers; with states='full_slip' it",
        ),
        (
            {"friction": {"law": "Occlusion", "mu_dry": 0.2, "mu_wet": 0.8, "time": 0.5}},
            "friction has the law 'Occlusion', on whose memory full slip depends; with states='full_slip' it must have",
        ),
    ],
)
def test_other_scenes_are_refused(changes, message, tmp_path):
    with pytest.raises(SceneError, match=message):
        fp.sweep(fp.Scene(**changes), tmp_path, states="full_slip", **{"roughness.h_rms": [2e-6]})


def test_unknown_states_and_models_without_them_are_refused(tmp_path):
    with pytest.raises(SceneError, match="states is 'some'; it must be 'all' or 'full_slip'"):
        fp.sweep(out=tmp_path, states="some", voltage=[0])
    with pytest.raises(SceneError, match="full slip alone is of the model 'full'"):
        fp.sweep(out=tmp_path, states="full_slip", model="cylinders", voltage=[0])
