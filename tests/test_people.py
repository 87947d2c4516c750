"""People as a band: spreads, scenes drawn from them, and the range of friction beside the closed form's scenes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import fingerpad as fp
from benchmarks.measured import findings
from fingerpad.reduced import people_band, press
from fingerpad.reduced.closure_band import closures, friction
from fingerpad.reduced.cylinders import over_forces
from fingerpad.reduced.people_band import Fingers, with_people
from fingerpad.scene.fingers import FINGERS
from fingerpad.scene.people import SPREADS, with_factors
from tests.test_closures import Held


@pytest.fixture(scope="module")
def result():
    return fp.run(fp.Scene(voltage=100.0), model="cylinders")


def quantiles(name, parts):
    """Return quantiles of a spread's factor by SciPy's truncated distributions."""
    spread, z = SPREADS[name], stats.truncnorm(-3, 3).ppf(parts)
    return np.exp(np.sqrt(np.log(1 + spread.cv**2)) * z) if spread.kind == "lognormal" else 1 + spread.cv * z


# -- draws -----------------------------------------------------------------------------------------------------
def test_draws_are_those_of_the_seed():
    """The first of more people are the same people. The numbers are those that this seed gave when it was written."""
    first, more = fp.people(3, 7), fp.people(8, 7)
    assert more[:3] == first and fp.people(3, 8) != first and fp.people(2) == fp.people(2, seed=0)
    assert [round(each.friction, 7) for each in first] == DRAWN


DRAWN = [0.2905218, 0.428062, 0.19609]


def test_factors_have_the_spreads():
    """Medians and coefficients of variation of 20000 people, to five standard errors; spreads are independent."""
    parts = np.random.default_rng(0).random((20_000, len(SPREADS)))
    found = np.array([spread.factor(column) for spread, column in zip(SPREADS.values(), parts.T, strict=True)])
    for factors, (name, spread) in zip(found, SPREADS.items(), strict=True):
        assert np.median(factors) == pytest.approx(1.0, abs=5 * 1.25 * spread.cv / 20_000**0.5)
        assert factors.std() / factors.mean() == pytest.approx(spread.cv, rel=0.06)  # cut off at three deviations
        assert np.quantile(factors, [0.05, 0.95]) == pytest.approx(quantiles(name, [0.05, 0.95]), rel=0.02)


def test_spreads_are_those_of_the_findings():
    """The middle of friction's; a modulus goes with the square of a speed. To the two digits that they are given in."""
    rows, _ = findings.read()
    speed, ridges = rows["stiffness_people"], rows["ridges_women"]
    assert SPREADS["friction"].cv == pytest.approx(np.mean(rows["friction_between"].bounds))
    assert SPREADS["stiffness"].cv == pytest.approx(2 * speed.spread / speed.bounds[0], abs=0.006)
    assert SPREADS["size"].cv == pytest.approx(ridges.spread / ridges.bounds[0], abs=0.006)


@pytest.mark.parametrize("finger", FINGERS)
def test_every_finger_has_people(finger):
    """All that a spread multiplies is that of the finger by name, times one factor."""
    middle, (one, _) = fp.Scene(finger=finger), fp.people(2, 3, finger=finger)
    factors = [x / y for x, y in zip(dict(one.geometry).values(), dict(middle.geometry).values(), strict=True)
               if isinstance(x, float)]  # fmt: skip
    assert np.ptp(factors) < 1e-12 and one.friction != middle.friction
    assert one.materials.dermis.shear_modulus / middle.materials.dermis.shear_modulus == pytest.approx(
        one.materials.subcutis.shear_modulus / middle.materials.subcutis.shear_modulus, rel=1e-12
    )


def test_a_law_is_multiplied_at_every_pressure():
    law, p = fp.Derjaguin(mu_f=0.1, tau_0=6e3), np.array([1e2, 1e4, 1e6])
    found = with_factors(fp.Scene(friction=law), {"friction": 2.0}).friction
    assert found.limit(p) == pytest.approx(2 * law.limit(p), rel=1e-12)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"n": 0}, "n is 0; it must be a whole number from 1 to 100000"),
        ({"seed": -1}, "seed is -1; it must be a whole number from 0"),
        ({"roughness": Held()}, "it must have an h_rms to differ between people"),
    ],
)
def test_refusals(keys, words):
    with pytest.raises(fp.SceneError, match=words):
        fp.people(**{"n": 2, "seed": 0} | keys)


# -- the range -------------------------------------------------------------------------------------------------
def test_one_spread_has_its_own_quantiles(result, monkeypatch):
    """Without voltage µ_app is the friction coefficient: the range is that of its factor, to the points' spacing."""
    name = "friction"
    monkeypatch.setattr(people_band, "SPREADS", {name: SPREADS[name]})
    found = with_people(fp.run(result.scene.replace(voltage=0.0), model="cylinders")).people
    assert [found["low"], found["high"]] == pytest.approx(0.25 * quantiles(name, [0.05, 0.95]), rel=2e-3)


@pytest.mark.parametrize(
    "keys",
    [{}, {"friction": fp.Derjaguin(mu_f=0.1, tau_0=6e3)}, {"finger": "fitted"}],
    ids=["Coulomb", "shear stress", "flat tips"],
)
def test_people_of_a_range_are_the_closed_form_s(keys):
    """The same people one by one as scenes, whose presses are those of similar fingers, to roundoff of its roots."""
    scene = fp.Scene(voltage=150.0, **keys)
    (slip,), parts = over_forces(scene, [75.0], "full_slip"), np.random.default_rng(1).random((12, len(SPREADS)))
    factors = {
        name: spread.factor(column).round(6) for (name, spread), column in zip(SPREADS.items(), parts.T, strict=True)
    }
    found = Fingers(scene, slip, None, False, factors).mu_app()
    for k, mu_app in enumerate(found):
        one = with_factors(scene, {name: each[k] for name, each in factors.items()})
        assert mu_app == pytest.approx(over_forces(one, [75.0], "full_slip")[0].mu_app, rel=1e-9)


def test_person_has_a_press_and_another_finger_has_none():
    """With one length or one layer changed alone it is no similar finger."""
    (person,) = fp.people(1, 0, finger="child")
    assert press.known(person).lengths["charged"][0] != press.known(fp.Scene(finger="child")).lengths["charged"][0]
    for changes in ({"geometry": {"ridge_wavelength": 2e-3}}, {"materials": {"subcutis": {"shear_modulus": 1e3}}}):
        assert press.known(person.replace(**changes)) is None


def test_a_force_in_newtons_is_the_same_for_all():
    """A finger of another size and stiffness: the ratio of the middle section is that of whole fingers.

    To 0.3 %, of a change of 4.5 %; under the same force per length it is 6.2 %.
    """
    scene, factors = fp.Scene(force="0.5 N", voltage=200.0), {"size": 1.2, "stiffness": 1.2}
    one = with_factors(scene, factors)
    whole = [fp.run(each, model="cylinders").finger.full_slip.mu_app for each in (one, scene)]
    (slip,) = over_forces(scene, [75.0], "full_slip")
    both = {name: np.array([factor, 1.0]) for name, factor in factors.items()}
    here, there = Fingers(scene, slip, None, True, both).mu_app()
    assert here / there == pytest.approx(whole[0] / whole[1], rel=3e-3)


def test_people_of_other_closures_have_their_numbers(result):
    """With the numbers and the missing ones that each closure has."""
    slip, one = replace(result.full_slip, voltage=200.0), {"size": np.ones(2)}
    laws = [*closures(result.scene.closure()).values()]
    expected = [friction(result.scene, slip, law, None).mu_app for law in laws]
    for law, mu_app in zip(laws, expected, strict=True):
        fingers = Fingers(result.scene.replace(roughness=law), slip, None, False, one)
        assert fingers.mu_app() == pytest.approx([mu_app] * 2, rel=1e-9)
    assert np.isinf(expected).any()


def test_text_report_and_files_have_the_range(result):
    found = result.people
    words = f"Likely range over people {found['low']:.2f} to {found['high']:.2f} (nine in ten)."
    assert f"\n  {words}\n" in str(result) and found["low"] < 0.5 * found["mu_app"]
    assert fp.Result.from_xarray(result.to_xarray()).people == found


def test_a_finger_without_a_range_has_the_reason(result):
    """Another finger, which has no press; with its contact without voltage there is a range."""
    other = replace(result, scene=result.scene.replace(geometry={"sc_thickness": 851e-6}), record={})
    assert "has no press yet" in with_people(other).people["why"]
    assert with_people(replace(other, uncharged=replace(result.full_slip, voltage=0.0))).people["high"] > 0.5


def test_adhering_people_open_the_upper_end(result):
    """A closure near adherence: more than one person in twenty has no number."""
    scene = fp.Scene(voltage=150.0, roughness={"law": "BoundaryElements"})
    found = fp.run(scene, model="cylinders")
    assert found.people["high"] is None and "no upper end" in str(found)
