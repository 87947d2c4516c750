"""The comparison of models: numbers of an answer, errors against the full model, and the page."""

import numpy as np
import pytest

from benchmarks import harness, models
from fingerpad.reduced import cylinders
from fingerpad.runs.batch import key
from fingerpad.scene import from_data

BY = harness.Made("0", "abc", "2026-01-01")


def test_lengths_in_the_program_are_the_runs():
    """The lengths that `cylinders` interpolates are the kept full runs', to the four digits they are kept with."""
    known = harness.kept("models").numbers["scenes"]
    for state in ("charged", "full_slip"):
        for k, f in enumerate(cylinders.FORCES):
            run = known[models.name(f, 0.0)]["full"]["summary"]
            assert cylinders.LENGTHS[state][k] == pytest.approx(run[f"{state}_contact_length"], abs=0.5e-7)
            depth = cylinders.INDENTATIONS[state][k]
            assert depth == pytest.approx(-run[f"{state}_bone_height"], abs=0.5e-7)
            assert cylinders.RIDGES[state][k] == run[f"{state}_ridges_in_contact"]


def test_lengths_between_known_forces_are_a_power_law():
    """Halfway on logarithmic axes, between each force and the next; beyond the last as between the two before."""
    forces = cylinders.FORCES
    for k, between in enumerate(np.sqrt(np.array(forces[1:]) * np.array(forces[:-1]))):
        lengths = cylinders.LENGTHS["charged"][k : k + 2]
        assert cylinders._interpolate(between, cylinders.LENGTHS["charged"]) == pytest.approx(np.sqrt(np.prod(lengths)))
    ratio = cylinders.LENGTHS["charged"][1] / cylinders.LENGTHS["charged"][0]
    below = cylinders._interpolate(forces[0] ** 2 / forces[1], cylinders.LENGTHS["charged"])
    assert below == pytest.approx(cylinders.LENGTHS["charged"][0] / ratio)


def test_kept_answers_are_those_of_the_program():
    """The closed form answers as it did when the full runs were made, to roundoff of the scalar root."""
    known = harness.kept("models").numbers["scenes"][models.name(75.0, 200.0)]["cylinders"]["summary"]
    found = models.answer(cylinders.solve(from_data({"f_ext": 75.0, "voltage": 200.0})).to_dict())["summary"]
    assert found == pytest.approx(known, rel=1e-9)


def test_scenes_differ_and_their_mesh_is_given():
    """Forty scenes; all of one force share their mesh."""
    scenes = models.scenes()
    assert len(scenes) == len({key(scene) for scene in scenes.values()}) == 40
    assert all(scene.mesh.touching_half_arc is not None for scene in scenes.values())


def test_held_out_loads_are_none_of_the_others():
    """No model has a length of their forces; the mesh is that of the forty, and the kept ones are these."""
    found = models.held_out()
    assert not {scene.f_ext for scene in found.values()} & set(cylinders.FORCES)
    assert {scene.mesh.contact for scene in found.values()} == {models.SIZE}
    assert list(found) == list(harness.kept("models").numbers["held_out"])


def test_scenes_beyond_have_the_mesh_of_the_others():
    """Their changes are understood, and the contact size is that of the forty."""
    found = models.beyond()
    assert {scene.mesh.contact for scene in found.values()} == {models.SIZE}
    assert found["twice the voltage"].voltage == 400.0 and found[models.HALF_STEPS].numerics.step_scale == 0.5
    assert found["hardly compressible"].materials.dermis.poisson == 0.499


def answer(**values):
    return {
        "summary": {"full_slip": True} | values,
        "cost": {"seconds": 2.0, "factorisations": 3, "unknowns": 5},
    }


def test_errors_are_against_the_full_model():
    """Without an answer of either there is none."""
    found = {"cylinders": answer(full_slip_mu_app=0.5), "full": answer(full_slip_mu_app=0.4)}
    assert models.error(found, "cylinders", "full_slip_mu_app") == pytest.approx(0.25, rel=1e-12)
    assert models.error(found, "cylinders", "full_slip_f_t") is None
    assert models.error({"cylinders": found["cylinders"]}, "cylinders", "full_slip_mu_app") is None


def test_failure_is_kept_alone():
    assert models.answer({"failure": "TIME_LIMIT: not done", "full_slip": False}) == {"failure": "TIME_LIMIT: not done"}


def test_page(tmp_path):
    """One scene has no answer of the cylinders, and one no full slip."""
    values = {name: 1.0 for name in models.QUANTITIES}
    scenes = {
        models.name(75.0, 0.0): {"cylinders": answer(**values), "full": answer(**values)},
        models.name(75.0, 200.0): {
            "cylinders": answer(**values | {"full_slip_mu_app": 1.1}),
            "full": answer(**values) | {"summary": values | {"full_slip": False}},
        },
        models.name(5.0, 0.0): {"cylinders": {"failure": "lost"}, "full": answer(**values)},
    }
    lost = dict.fromkeys((*models._KEPT, "full_slip")) | {"failure": "TIME_LIMIT: not done"}
    half = lost | {"full_slip_mu_app": 0.25, "full_slip_ridges_in_contact": 7, "full_slip": True, "failure": None}
    beyond = {"twice the voltage": lost, models.HALF_STEPS: half}
    less = answer(**values | {"charged_f_electrostatic": 0.8})
    held = {"8.2 N/m, 153 V": {"cylinders": less, "full": answer(**values)}}
    harness.keep("models", {"scenes": scenes, "held_out": held, "beyond": beyond}, BY, tmp_path)
    text = models.draw(tmp_path).read_text(encoding="utf-8")
    assert "give µ_app within 10.0 %" in text and "No answer at 5 N/m, 0 V." in text
    assert "full slip in 3 of 4 scenes" in text
    assert "| `cylinders` | 8.2 N/m, 153 V | +0.0 | +0.0 | +0.0 | -20.0 |" in text
    assert "attraction is within 20.0 %" in text
    assert "| 75 | +0.0 | – | – | – | +10.0 |" in text
    assert "has 7 ridges, and µ_app is\n0.2500" in text
    assert "| 0.25 | 7 | – | – | yes |" in text
    assert "| – | – | – | – | TIME_LIMIT: not done |" in text
