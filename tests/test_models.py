"""The comparison of models: numbers of an answer, errors against the full model, and the page."""

import numpy as np
import pytest

from benchmarks import harness, models
from fingerpad.reduced import cylinders
from fingerpad.scene import from_data


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
