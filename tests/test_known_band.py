"""The likely range of friction: parts by assumption, their sum, open ends, words and the picture of a report."""

import json
from dataclasses import replace

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.reduced.closure_band import Slip, friction, powers, with_band
from fingerpad.report import run_page, trust
from fingerpad.results.headline import known_in_words
from fingerpad.results.quantities import KNOWN
from tests.test_closure_band import Held
from variational.caution import Caution


def bars(result: fp.Result) -> str:
    """Return the bars of a result's band, as its report has them."""
    return run_page.bars_of(result).replace("\u00a0", " ")


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


def test_slices_of_unknown_error_are_named():
    """Under 0.1 N no finger in three dimensions was compared."""
    found = fp.run(fp.Scene(voltage=100.0, f_ext=10.0), model="cylinders")
    assert "slices" not in parts(found)
    assert known_in_words(found.known).endswith("\nNot in it: slices, whose error is not known at this force.")


def test_section_alone_has_its_band():
    """A finger that is too short for a sum has the band of its middle section."""
    found = fp.run(fp.Scene(voltage=100.0, slices={"length": 5e-3}), model="cylinders")
    assert found.finger is None and not found.known["whole"]
    assert found.known["mu_app"] == found.headline.value == found.full_slip.mu_app
    assert found.headline.known.startswith(f"Likely range {found.known['low']:.2f} to ")


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


def test_open_end_in_words_and_picture(adhering):
    kept, picture = adhering.known, bars(adhering)
    ends = f"rough contact {kept['mu_app']:.2f} to {kept['parts'][0]['at_least']:.2f}, friction law "
    of = "no upper end by two of three models of rough contact, in which ridges adhere at 200 V."
    first, second = adhering.headline.known.splitlines()
    assert first == f"Likely range {kept['low']:.2f} to {kept['at_least']:.2f}; {of}"
    assert second.startswith(f"With one assumption changed: {ends}")
    assert f"\n  {first}\n  {second}" in str(adhering)
    assert f">{kept['low']:.2f} to {kept['at_least']:.2f}<" in picture
    assert picture.count('class="open"') == 2, "arrows of band and closure"
    assert "An arrow is an open end. No number by boundary elements and Persson&#39;s theory: ridges adhere" in picture
    page = run_page.page(adhering)
    assert f"<b>Likely range {kept['low']:.2f} to {kept['at_least']:.2f}</b>; no upper end by two of three" in page


def test_largest_number_that_is_an_upper_bound(result):
    """At 100 V it is that of boundary elements, by which attraction balances more than a tenth of the pressure."""
    closure = next(part for part in result.known["parts"] if part["name"] == "rough contact")
    law = fp.BoundaryElements(result.scene.h_0)
    run = fp.run(result.scene.replace(roughness=law), model="cylinders")
    share = float(law.balanced(run.record["full_slip_p_c"], 100.0))
    assert closure["upper_bounds"] == {"boundary elements": pytest.approx(share, rel=1e-9)} and share > 0.1
    words = f"The largest number, by boundary elements, is an upper bound: attraction balances {100 * share:.0f} %"
    assert words in known_in_words(result.known) and words in bars(result)
    small = fp.run(result.scene.replace(voltage=20.0), model="cylinders")  # which balances less than a tenth
    assert small.known["parts"][0]["name"] == "rough contact" and "upper_bounds" not in small.known["parts"][0]


def test_result_whose_own_closure_has_no_number(adhering):
    """Nothing is known of it, and no ratio to other closures is given."""
    own = fp.run(adhering.scene.replace(roughness={"law": "BoundaryElements"}), model="cylinders")
    assert (own.known["low"], own.known["high"], own.known["parts"]) == (None, None, []) and own.closures == {}
    why = "by the result's own closure ridges adhere at 200 V"
    sentence = f"Friction at full slip, {own.finger.f_ext:.4g} N and 200 V, is not known: {why}."
    assert str(own.headline) == sentence and np.isnan(own.headline.value) and bars(own) == ""
    kind, words = trust.verdict(trust.findings(own))
    assert (kind, words) == (trust.BAD, f"Do not use these numbers as they are: friction is not known. B{why[1:]}.")
    assert not [each for each in trust.findings(adhering) if each.verdict == trust.BAD]
    cautions = replace(adhering, cautions=(Caution("a", "one"), Caution("b", "another")))
    assert trust.verdict(trust.findings(cautions))[1].startswith("Use with care: model and limit of validity. The")


def test_changed_coating_beyond_the_table():
    """A part of the result's own closure can be open as well."""
    found = fp.run(fp.Scene(voltage=150.0, roughness={"law": "BoundaryElements"}), model="cylinders").known
    coating = next(part for part in found["parts"] if part["name"] == "coating")
    assert coating["no_number"] == {"changed coating": "ridges adhere at 150 V"} and found["high"] is None
    assert "; no upper end with changed coating, where ridges adhere at 150 V.\n" in known_in_words(found)


@pytest.mark.parametrize(
    ("voltage", "why"), [(50.0, "the ridges' pressure is beyond the table"), (5e3, "ridges adhere at 5000 V")]
)
def test_reason_of_no_number(result, voltage, why):
    """A table can end under the load alone; under a huge voltage charged cylinders have no equilibrium."""
    law = fp.BoundaryElements(result.scene.h_0)
    slip = replace(result.full_slip, voltage=voltage, f_ext=5000.0)
    assert friction(result.scene, slip, law, None) == Slip(np.inf, why)


def test_text_files_and_picture_have_it(result):
    ends = f"{result.known['low']:.2f} to {result.known['high']:.2f}"
    assert f"\n  Likely range {ends}.\n  With one assumption changed: rough contact " in str(result)
    again = fp.Result.from_xarray(result.to_xarray())
    assert again.known == result.known and KNOWN in again.record
    picture = bars(result)
    names = ("solved to", "likely range", "rough contact", "friction law", "tips")
    assert all(f">{name}<" in picture for name in names)
    assert "of the whole finger (–)<" in picture and "µ_app of" not in picture, "its symbol is typeset"
