"""The known error of the reduced models: that of the kept runs, printed with its name, and not told where unknown."""

import numpy as np
import pytest

from benchmarks import harness, models, newtons
from fingerpad.reduced import cylinder_errors, cylinders, press
from fingerpad.scene import Scene, from_data, with_values
from tests.commands import kept
from variational.contact.friction import Derjaguin

OWN = press.of(Scene())
"""The default finger's."""


def test_known_error_is_that_of_the_kept_runs():
    """The figures are the largest differences of docs/models.json, over the printed value, rounded up to 0.1 %."""
    numbers = kept("models.json")
    runs = numbers["scenes"] | numbers["held_out"]
    region = cylinder_errors.REGIONS[0]
    assert len(runs) == region.runs and len(numbers["held_out"]) == 4
    points = [tuple(float(part.split()[0]) for part in name.split(",")) for name in runs]
    ends = [(min(each), max(each)) for each in zip(*points, strict=True)]
    assert [region.ranges[key] for key in ("f_ext", "voltage")] == ends
    assert set(region.errors) == {"full_slip", "charged", cylinder_errors.WHOLE}
    contact = [each["full"]["summary"]["full_slip_f_contact"] for each in runs.values()]
    pulls = [force / f_ext for force, (f_ext, _) in zip(contact, points, strict=True)]
    assert region.ranges[cylinder_errors.PULL][1] == pytest.approx(max(pulls) - 1, rel=0.05)
    for state in ("full_slip", "charged"):
        bands = region.errors[state]
        for key, largest in bands.items():
            name = f"{state}_{key}"
            pairs = [(each["cylinders"]["summary"][name], each["full"]["summary"][name]) for each in runs.values()]
            worst = max(abs(full / ours - 1) for ours, full in pairs if ours)
            assert worst <= largest < worst + 1e-3, name


def test_known_error_of_a_whole_finger_is_that_of_the_kept_runs():
    """Of sums over traces of both models, rounded up to 0.1 %; the range of the force is that of the sums."""
    region, known = cylinder_errors.REGIONS[0], newtons.closed_form(kept("models.json")["scenes"])
    assert region.errors[cylinder_errors.WHOLE] == pytest.approx(known, abs=1e-9)
    assert region.ranges["force"] == (newtons.OF_CLOSED_FORM[0], newtons.OF_CLOSED_FORM[-1])


def test_band_is_named_where_the_runs_are():
    """Every quantity that has one, normal contact too, and friction by the share of the attraction."""
    scene = from_data({"f_ext": 42.0, "voltage": -120.0})
    result, region = cylinders.solve(scene), cylinder_errors.find(scene)
    known, slip = result.record["model_error"], result.full_slip
    words = cylinder_errors.in_words(known)
    assert region is not None and slip is not None
    share = region.errors["full_slip"]["f_electrostatic"] * slip.f_electrostatic / slip.f_contact
    assert known["full_slip"]["mu_app"] == pytest.approx(share, rel=1e-12)
    for bands in known.values():
        for error in bands.values():
            assert f" {100 * error:.1f} %" in words
    assert "in charged normal contact" in words


def test_ends_of_a_range_belong_to_it():
    """The next number beyond roundoff does not, and the caution names the key, its value and the range."""
    for region in cylinder_errors.REGIONS:
        inside = {key: high for key, (_, high) in region.ranges.items() if key not in ("force", cylinder_errors.PULL)}
        for key, (low, high) in region.ranges.items():
            if key == cylinder_errors.PULL:
                continue
            load = {"f_ext": None} if key == "force" else {}
            for end, beyond in ((low, low * 0.999), (high, high * 1.001)):
                if end == 0:
                    continue
                scenes = [
                    with_values(Scene(), {name: value for name, value in (inside | load | {key: at}).items() if value})
                    for at in (end, beyond)
                ]
                assert region.ranges[key] and cylinder_errors.find(scenes[0]) is not None
                nearest = cylinder_errors.outside(scenes[1])
                assert nearest or cylinder_errors.find(scenes[1]) is not region


def test_caution_names_the_end_of_the_widest_region():
    """Of those with the default friction coefficient, by its voltage and by the attraction that the result has."""
    fits = [each for each in cylinder_errors.REGIONS[1:] if cylinder_errors.within(0.25, each.ranges["friction"])]
    wide = max(fits or cylinder_errors.REGIONS[:1], key=lambda each: each.ranges[cylinder_errors.PULL][1])
    voltage, pull = wide.ranges["voltage"][1], wide.ranges[cylinder_errors.PULL][1]
    scene = from_data({"voltage": round(voltage) + 1})
    (found,) = cylinder_errors.outside(scene, 1.0)
    assert (found.key, found.value, found.known) == ("voltage", f"{scene.voltage:g} V", f"0 to {voltage:g} V")
    assert str(found) in str(cylinder_errors.cautions(scene, 1.0)[0]) and not cylinder_errors.outside(Scene(), pull)
    most = max(each.ranges[cylinder_errors.PULL][1] for each in cylinder_errors.REGIONS)
    (found,) = cylinder_errors.outside(Scene(), most + 0.1)
    assert found.key == cylinder_errors.PULL and found.known == f"0 to {pull:g}"


@pytest.mark.parametrize(
    "scene",
    [
        from_data({"f_ext": 451.0}),
        from_data({"voltage": 401.0}),
        from_data({"friction": 1.01}),
        from_data({"geometry": {"ridge_count": 21}}),
        from_data({"roughness": {"h_rms": 4e-6}}),
        Scene(friction=Derjaguin(0.25, 1e3)),
    ],
    ids=str,
)
def test_no_band_where_no_run_is(scene):
    """Beyond the loads, and with anything else than those runs have; a caution names it."""
    assert cylinder_errors.find(scene) is None and len(cylinder_errors.cautions(scene)) == 1
    (key,) = (each.key for each in cylinder_errors.outside(scene) if not each.key.startswith("friction."))
    assert scene.parameters()[key.partition(".")[0]] != Scene().parameters()[key.partition(".")[0]]


def test_losses_of_a_drive_count_under_a_drive_alone():
    """A constant voltage attracts by Eq. 3 whatever tissue and leak are, and its error is that of the default scene."""
    losses = {"electric": {"tissue": "dry", "leak": "sliding dry", "follows": "mean"}}
    drive = {"voltage": {"waveform": "sine", "rms": 150.0, "frequency": 100.0}}
    assert cylinder_errors.cautions(from_data(losses)) == []
    (text,) = map(str, cylinder_errors.cautions(from_data(losses | drive)))
    assert "electric" in text


# -- the kept runs ---------------------------------------------------------------------------------------------------
def test_lengths_in_the_program_are_the_runs():
    """The lengths that `cylinders` interpolates are the kept full runs', to the four digits they are kept with."""
    known = harness.kept("models").numbers["scenes"]
    for state in ("charged", "full_slip"):
        for k, f in enumerate(models.FORCES):
            run = known[models.name(f, 0.0)]["full"]["summary"]
            assert OWN.lengths[state][k] == pytest.approx(run[f"{state}_contact_length"], abs=0.5e-7)
            depth = OWN.indentations[state][k]
            assert depth == pytest.approx(-run[f"{state}_bone_height"], abs=0.5e-7)
            assert OWN.ridges[state][k] == run[f"{state}_ridges_in_contact"]


def test_lengths_between_known_forces_are_a_power_law():
    """Halfway on logarithmic axes, between each force and the next; beyond the last as between the two before."""
    forces, known = OWN.forces, OWN.lengths["charged"]
    for k, between in enumerate(np.sqrt(np.array(forces[1:]) * np.array(forces[:-1]))):
        lengths = known[k : k + 2]
        assert OWN.length(between, "charged") == pytest.approx(np.sqrt(np.prod(lengths)))
    ratio = known[1] / known[0]
    below = OWN.length(forces[0] ** 2 / forces[1], "charged")
    assert below == pytest.approx(known[0] / ratio)


def test_kept_answers_are_those_of_the_program():
    """The closed form answers as it did when the full runs were made, to roundoff of the scalar root."""
    known = harness.kept("models").numbers["scenes"][models.name(75.0, 200.0)]["cylinders"]["summary"]
    found = models.answer(cylinders.solve(from_data({"f_ext": 75.0, "voltage": 200.0})).to_dict())["summary"]
    assert found == pytest.approx(known, rel=1e-9)
