"""The known error of the reduced models: that of the kept runs, printed with its name, and not told where unknown."""

import numpy as np
import pytest

from benchmarks import harness, models
from fingerpad.reduced import cylinder_errors, cylinders
from fingerpad.scene import Scene, from_data
from tests.commands import kept
from variational.contact.friction import Derjaguin


def test_known_error_is_that_of_the_kept_runs():
    """The figures printed are the largest differences from the full runs in docs/models.json, rounded up to 0.1 %."""
    numbers = kept("models.json")
    runs = numbers["scenes"] | numbers["held_out"]
    region = cylinder_errors.REGIONS[0]
    assert len(runs) == region.runs and len(numbers["held_out"]) == 4
    points = [tuple(float(part.split()[0]) for part in name.split(",")) for name in runs]
    ends = [(min(each), max(each)) for each in zip(*points, strict=True)]
    assert region.ranges == dict(zip(("f_ext", "voltage"), ends, strict=True))
    assert set(region.errors) == {"full_slip", "charged"}
    for state, bands in region.errors.items():
        for key, largest in bands.items():
            name = f"{state}_{key}"
            pairs = [(each["cylinders"]["summary"][name], each["full"]["summary"][name]) for each in runs.values()]
            worst = max(abs(ours / full - 1) for ours, full in pairs if full)
            assert worst <= largest < worst + 1e-3, name


def test_band_is_named_where_the_runs_are():
    """Every quantity that has one, normal contact too."""
    scene = from_data({"f_ext": 42.0, "voltage": -120.0})
    words, region = cylinder_errors.in_words(cylinder_errors.errors(scene)), cylinder_errors.find(scene)
    assert region is not None
    for bands in region.errors.values():
        for error in bands.values():
            assert f" {100 * error:.1f} %" in words
    assert "in charged normal contact" in words
    assert cylinder_errors.runs(region) == "44 full runs at f_ext 5 to 150 N/m, voltage 0 to 200 V"


def test_ends_of_a_range_belong_to_it():
    """The next number beyond roundoff does not, and the caution names the key, its value and the range."""
    for key, end, beyond in (("f_ext", 5.0, 4.999), ("f_ext", 150.0, 150.01), ("voltage", -200.0, -200.1)):
        assert cylinder_errors.errors(from_data({key: end})) and not cylinder_errors.outside(from_data({key: end}))
        (found,) = cylinder_errors.outside(from_data({key: beyond}))
        assert found.key == key and found.value.startswith(f"{beyond:g} ")
        assert str(found) in cylinder_errors.cautions(from_data({key: beyond}))[0]


@pytest.mark.parametrize(
    "scene",
    [
        from_data({"f_ext": 151.0}),
        from_data({"voltage": 201.0}),
        from_data({"friction": 0.26}),
        from_data({"electric": {"d_i": 2e-6}}),
        from_data({"geometry": {"ridge_count": 21}}),
        from_data({"contact": {"eps_n": 2e12}}),
        from_data({"roughness": {"h_rms": 4e-6}}),
        from_data({"materials": {"dermis": {"poisson": 0.49}}}),
        Scene(friction=Derjaguin(0.25, 1e3)),
    ],
    ids=str,
)
def test_no_band_where_no_run_is(scene):
    """Beyond the loads, and with anything else than those runs have; a caution names it."""
    assert cylinder_errors.errors(scene) == {} and len(cylinder_errors.cautions(scene)) == 1
    (key,) = (each.key for each in cylinder_errors.outside(scene) if not each.key.startswith("friction."))
    assert scene.parameters()[key.partition(".")[0]] != Scene().parameters()[key.partition(".")[0]]


# -- the kept runs ---------------------------------------------------------------------------------------------------
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


def test_program_of_the_page_prints_what_the_model_has():
    """So that the lengths and the known errors can be put there when the runs are made anew."""
    lines = models.in_the_program(harness.kept("models").numbers).splitlines()
    for state, lengths in cylinders.LENGTHS.items():
        assert f"LENGTHS {state}: {', '.join(f'{1e3 * each:.4f}e-3' for each in lengths)}" in lines
        assert f"RIDGES {state}: {', '.join(map(str, cylinders.RIDGES[state]))}" in lines
    for state, bands in cylinder_errors.REGIONS[0].errors.items():
        assert all(f"KNOWN_ERROR {state}_{key}: {each:.3f}" in lines for key, each in bands.items())


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
