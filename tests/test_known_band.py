"""The likely range of friction: parts by assumption, its law of friction, open ends, changes by full runs."""

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest

import fingerpad as fp
from benchmarks import harness
from fingerpad.reduced.closure_band import LAW, Slip, friction, laws_like, powers, with_band
from fingerpad.report import trust
from fingerpad.results.headline import known_in_words
from fingerpad.results.quantities import KNOWN
from tests.test_closures import Held
from variational.caution import Caution


@pytest.fixture(scope="module")
def result():
    return fp.run(fp.Scene(voltage=100.0), model="cylinders")


def parts(result):
    return {part["name"]: (part["low"], part["high"]) for part in result.known["parts"]}


def test_parts(result):
    """All that apply to a finger, the largest first; each has the result inside, and the band has each part."""
    found, mu = parts(result), result.headline.value
    assert set(found) == {"friction law", "rough contact", "tips", "roughness", "coating", "slices"}
    spans = [np.log(high / low) for low, high in found.values()]
    assert spans == sorted(spans, reverse=True)
    for low, high in found.values():
        assert result.known["low"] <= low <= mu <= high <= result.known["high"]


def test_sum_is_of_squares(result):
    mu, above = result.headline.value, [np.log(high) for _, high in parts(result).values()]
    whole = np.sqrt(sum((each - np.log(mu)) ** 2 for each in above))
    assert result.known["high"] == pytest.approx(mu * np.exp(whole), rel=1e-12)


def test_roughness_is_that_of_runs_with_it(result):
    """The ratio of its section in runs with h_rms 20 % smaller and larger, to its power, to roundoff; coatings too."""
    law, section = result.scene.roughness, result.full_slip.mu_app
    for name, changes in {
        "roughness": [{"roughness": replace(law, h_rms=factor * law.h_rms)} for factor in (1.2, 0.8)],
        "coating": [
            {"electric": {"d_i": f * result.scene.electric.d_i, "eps_sc": result.scene.electric.eps_sc / f}}
            for f in (1.2, 0.8)
        ],
    }.items():
        runs = [fp.run(result.scene.replace(**each), model="cylinders").full_slip.mu_app for each in changes]
        ratios = [(mu / section) ** power for mu, power in zip(runs, reversed(powers()[name]), strict=True)]
        assert parts(result)[name] == pytest.approx([result.headline.value * ratio for ratio in ratios], rel=1e-9)


@pytest.mark.parametrize("load", [{"force": "0.5 N"}, {"f_ext": 70.0}])
def test_band_is_of_the_headline(load):
    """The whole finger's, with or without a force in newtons; slices are a part where their error is known."""
    found = fp.run(fp.Scene(voltage=100.0, **load), model="cylinders")
    assert found.known["whole"] and "slices" in parts(found)
    assert found.known["mu_app"] == found.headline.value == found.finger.states["full_slip"].mu_app


def test_band_of_a_section_beside_a_finger_without_full_slip(result):
    """The sum of slices can end before full slip; headline and band are then of the middle section."""
    states = {name: state for name, state in result.finger.states.items() if name != "full_slip"}
    found = with_band(replace(result, finger=replace(result.finger, states=states)))
    assert found.known["mu_app"] == found.headline.value == found.full_slip.mu_app and not found.known["whole"]


def test_law_of_ones_own(result):
    """It has no roughness and no insulator to change, and no other closures."""
    found = with_band(replace(result, scene=result.scene.replace(roughness=Held()), record={})).known
    assert [part["name"] for part in found["parts"]] == ["friction law", "tips", "slices"]


@pytest.fixture(scope="module")
def adhering():
    """At 200 V ridges of closures with a field in contact adhere, beyond their tables of gaps."""
    return fp.run(fp.Scene(voltage=200.0), model="cylinders")


def test_adhering_closures_open_the_upper_end(adhering):
    """Band and part have none in files either; the part keeps the largest number of the others, that of a run."""
    found, (closure, *others) = json.loads(json.dumps(adhering.known)), adhering.known["parts"]
    above = [np.log(part["high"] / found["mu_app"]) for part in others]
    assert found["at_least"] == pytest.approx(found["mu_app"] * np.exp(np.sqrt(sum(each**2 for each in above))))
    assert (found["high"], closure["high"]) == (None, None) and all(part["high"] for part in others)
    assert list(closure["no_number"]) == ["boundary elements", "Persson's theory"]
    law = fp.Persson(adhering.scene.h_0, field_in_contact=False)
    largest = fp.run(adhering.scene.replace(roughness=law), model="cylinders").full_slip.mu_app
    ratio = adhering.known["mu_app"] / adhering.full_slip.mu_app
    assert closure["at_least"] == pytest.approx(ratio * largest, rel=1e-9)


def test_largest_number_that_is_an_upper_bound(result):
    """At 100 V it is that of boundary elements, by which attraction balances more than a tenth of the pressure."""
    closure = next(part for part in result.known["parts"] if part["name"] == "rough contact")
    law = fp.BoundaryElements(result.scene.h_0)
    run = fp.run(result.scene.replace(roughness=law), model="cylinders")
    share = float(law.balanced(run.record["full_slip_p_c"], 100.0))
    assert closure["upper_bounds"] == {"boundary elements": pytest.approx(share, rel=1e-9)} and share > 0.1
    words = f"The largest number, by boundary elements, is an upper bound: attraction balances {100 * share:.0f} %"
    assert words in known_in_words(result.known)
    small = fp.run(result.scene.replace(voltage=20.0), model="cylinders")  # which balances less than a tenth
    assert small.known["parts"][0]["name"] == "rough contact" and "upper_bounds" not in small.known["parts"][0]


def test_result_whose_own_closure_has_no_number(adhering):
    """Nothing is known of it, and no ratio to other closures is given."""
    own = fp.run(adhering.scene.replace(roughness={"law": "BoundaryElements"}), model="cylinders")
    assert (own.known["low"], own.known["high"], own.known["parts"]) == (None, None, []) and own.closures == {}
    why = "by the result's own closure ridges adhere at 200 V"
    sentence = f"Friction at full slip, {own.finger.f_ext:.4g} N and 200 V, is not known: {why}."
    assert str(own.headline) == sentence and np.isnan(own.headline.value)
    kind, words = trust.verdict(trust.findings(own))
    assert (kind, words) == (trust.BAD, f"Do not use these numbers as they are: friction is not known. B{why[1:]}.")
    assert not [each for each in trust.findings(adhering) if each.verdict == trust.BAD]
    cautions = replace(adhering, cautions=(Caution("a", "one"), Caution("b", "another")))
    assert trust.verdict(trust.findings(cautions))[1].startswith("Use with care: model and limit of validity. The")


@pytest.mark.parametrize(
    ("voltage", "why"), [(50.0, "the ridges' pressure is beyond the table"), (5e3, "ridges adhere at 5000 V")]
)
def test_reason_of_no_number(result, voltage, why):
    """A table can end under the load alone; under a huge voltage charged cylinders have no equilibrium."""
    law = fp.BoundaryElements(result.scene.h_0)
    slip = replace(result.full_slip, voltage=voltage, f_ext=5000.0)
    assert friction(result.scene, slip, law, None) == Slip(np.inf, why)


def test_text_and_files_have_it(result):
    ends = f"{result.known['low']:.2f} to {result.known['high']:.2f}"
    assert f"\n  Likely range {ends}.\n  With one assumption changed: rough contact " in str(result)
    again = fp.Result.from_xarray(result.to_xarray())
    assert again.known == result.known and KNOWN in again.record


# -- the likely range of friction: its law of friction, changes by full runs, and where there is none, with the reason
def cylinders(**keys):
    return fp.run(fp.Scene(**{"f_ext": 75.0, "voltage": 200.0} | keys), model="cylinders")


def ratios(result, name):
    """Return both ends of a part over the result."""
    (part,) = (each for each in result.known["parts"] if each["name"] == name)
    return part["low"] / result.known["mu_app"], part.get("at_least", part["high"]) / result.known["mu_app"]


@dataclass(frozen=True)
class Saturated(fp.Friction):
    mu_f: float
    most: float

    def limit(self, p):
        return self.mu_f * p / (1 + self.mu_f * p / self.most)


# -- the law of friction ---------------------------------------------------------------------------------------
@pytest.mark.parametrize("friction", [0.25, 0.6])
def test_shear_stress_has_the_friction_without_voltage(friction):
    """By two runs with the stress, the ratio under voltage over that without, to its power; to roundoff."""
    result, still = cylinders(friction=friction), cylinders(friction=friction, voltage=0.0).full_slip
    stress = still.f_t / still.contact_length
    law = fp.Derjaguin(mu_f=0.0, tau_0=stress * np.hypot(1, 1e3 * still.contact_length / still.f_contact))
    charged, bare = (cylinders(friction=law, voltage=voltage).full_slip.mu_app for voltage in (200.0, 0.0))
    assert bare == pytest.approx(friction, rel=1e-9)
    low, high = ratios(result, LAW)
    assert low == pytest.approx((charged / result.full_slip.mu_app) ** powers()[LAW][0], rel=1e-6)
    assert high == 1.0


def test_law_is_the_largest_part_below():
    """By full runs of the whole finger at 0.54 N, 0.583 becomes 0.334 ± 0.025, from 0.25 and 0.239 without voltage.

    The band is of the closed form's section, to the power that the full model's section has: within that error.
    """
    result = cylinders()
    of_runs = 0.334 / 0.239 / (0.583 / 0.25)
    assert ratios(result, LAW)[0] == pytest.approx(of_runs, rel=0.025 / 0.334)
    assert ratios(result, LAW)[0] == min(ratios(result, part["name"])[0] for part in result.known["parts"])
    assert 0.33 < result.known["low"] < 0.38


def test_a_shear_stress_changes_to_coulombs_law():
    """From the friction of one law to that of the other is the way back, where both have the same without voltage."""
    one = cylinders(friction=0.25)
    still = cylinders(friction=0.25, voltage=0.0).full_slip
    _, law = laws_like(fp.Coulomb(0.25), still.f_contact / still.contact_length)
    low, high = ratios(cylinders(friction=law), LAW)
    assert high == pytest.approx(1 / ratios(one, LAW)[0], rel=1e-6) and low == 1.0


@pytest.mark.parametrize(
    "friction", [fp.Derjaguin(mu_f=0.1, tau_0=6e3), Saturated(0.5, 30e3)], ids=["between", "of one's own"]
)
def test_law_between_the_two_changes_to_both(friction):
    low, high = ratios(cylinders(friction=friction), LAW)
    assert low < 0.99 and high > 1.01


# -- full runs -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["tips", "roughness", "coating", LAW])
def test_changes_at_the_load_of_full_runs_are_theirs(name):
    """At 75 N/m and 200 V the ratios are those of the runs in docs/assumptions.json, to 1e-3 of the closed form's."""
    full = harness.kept("assumptions").numbers["full"]
    rows = {
        "tips": ("geometry.ridge_profile=[1, 0.125]", "geometry.ridge_profile=[1, -0.125]"),
        "roughness": ("roughness.h_rms=3.72e-6", "roughness.h_rms=2.48e-6"),
        "coating": ("electric.d_i=1.2e-6 electric.eps_sc=1375", "electric.d_i=0.8e-6 electric.eps_sc=2062.5"),
    }
    if name == LAW:
        growth = full["shear 75"]["mu_app"] / full["shear 75, 0 V"]["mu_app"]
        expected = [growth / (full["reference"]["mu_app"] / 0.25), 1.0]
    else:
        expected = [full[each]["mu_app"] / full["reference"]["mu_app"] for each in rows[name]]
    assert ratios(cylinders(), name) == pytest.approx(expected, abs=1e-3)


# -- none, with the reason -------------------------------------------------------------------------------------
def test_no_friction_has_no_range_and_no_note():
    for keys in ({"friction": 0.0}, {"voltage": 0.0}):
        found = cylinders(**keys)
        assert found.known == found.closures == {} and not any("likely range" in note for note in found.notes)


@pytest.mark.parametrize(
    ("keys", "why"),
    [
        ({"history": [{"name": "press", "f_ext": 1.0}]}, "history is given"),
        ({"materials": {"dermis": {"viscosity": {"preset": "fingerpad"}}}}, "materials.dermis.viscosity is given"),
    ],
)
def test_reason_is_a_note(keys, why):
    """Of a scene that charged cylinders refuse; its result is that of another model."""
    result = cylinders()
    try:
        scene = fp.Scene(**keys)
    except fp.SceneError as error:
        pytest.skip(str(error))
    found = with_band(replace(result, scene=scene, record={}))
    assert found.notes[-1] == f"No likely range of µ_app is computed: {why}." and found.known == {}
