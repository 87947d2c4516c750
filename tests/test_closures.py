"""Closures of rough contact in scenes: the band over them, height maps, ridges that adhere."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.optimize import brentq

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.model.cautions import adhering, on_states, sticking
from fingerpad.reduced import closure_band, cylinders
from fingerpad.reduced.closure_band import Slip, friction, laws_beside, with_band
from fingerpad.report import trust
from fingerpad.results.headline import band_in_words
from fingerpad.results.quantities import BAND
from fingerpad.scene import Scene, from_data, value_of
from variational.caution import Caution
from variational.roughness.spectrum import SelfAffine
from variational.state import RidgeStates


@dataclass(frozen=True)
class Held(fp.Closure):
    def __call__(self, p_c):
        return fp.AirGap(2e-6 + 0 * np.asarray(p_c, dtype=float))


@pytest.fixture(scope="module")
def result():
    return fp.run(fp.Scene(voltage=70.7), model="cylinders")


def test_band_is_that_of_runs_with_these_closures(result):
    """Each value is that of charged cylinders with that closure, to roundoff, its own among them."""
    kept = result.record[BAND]["mu_app"]
    assert kept["bearing area"] == pytest.approx(result.full_slip.mu_app, rel=1e-12)
    for words, law in closure_band.closures(result.scene.roughness).items():
        other = fp.run(result.scene.replace(roughness=law), model="cylinders")
        assert kept[words] == pytest.approx(other.full_slip.mu_app, rel=1e-9), words
    assert len(kept) == 5


def test_own_closure_is_in_the_band():
    """With boundary elements of another shortest wave the others have it too."""
    given = {"law": "BoundaryElements", "shortest_wave": 4e-6, "field_in_contact": False}
    found = fp.run(fp.Scene(voltage=100.0, roughness=given), model="cylinders")
    assert found.record[BAND]["mu_app"]["boundary elements, no field in contact"] == pytest.approx(
        found.full_slip.mu_app
    )


def test_text_and_files_have_the_band(result):
    text = str(result)
    band, ratio = result.headline.closures, result.headline.value / result.full_slip.mu_app
    low, high = (ratio * result.closures[name] for name in ("bearing area", "boundary elements"))
    assert band.startswith(f"By models of rough contact {low:.2f} (bearing area) to {high:.2f} (boundary elements). ")
    assert " The largest is an upper bound: attraction balances 24 % of" in band and f"\n  {band}\n" in text
    assert len(result.record[BAND]["upper_bounds"]) == 2 and band.count("largest") == 1
    again = fp.Result.from_xarray(result.to_xarray())
    assert again.closures == result.closures != {}


@pytest.mark.parametrize("volts", [200.0, 400.0])
def test_drive_has_the_voltage_of_each_air_gap(volts):
    """The circuit leaves more of a drive across a smaller gap, so that the ratio is that of runs with the drive.

    At 400 V from peak to peak ridges adhere by boundary elements, and there is no number.
    """
    drive = {"waveform": "sine", "peak_to_peak": volts, "frequency": 1e3}
    scene = fp.Scene(voltage=drive, electric={"tissue": "dry", "leak": "sliding dry"})
    result = fp.run(scene, model="cylinders")
    other = fp.run(scene.replace(roughness={"law": "BoundaryElements"}), model="cylinders")
    assert result.closures["bearing area"] == pytest.approx(result.full_slip.mu_app, rel=1e-12)
    if volts == 200.0:
        assert result.closures["boundary elements"] == pytest.approx(other.full_slip.mu_app, rel=1e-9)
        share = float(fp.BoundaryElements(scene.h_0).balanced(*charged(other)))
        assert result.record[BAND]["upper_bounds"]["boundary elements"] == pytest.approx(share, rel=1e-6)
    else:
        assert result.record[BAND]["no_number"]["boundary elements"] == "ridges adhere under the drive"


def charged(result):
    """Return the ridges' pressure (Pa), and the voltage (V) of a drive across their air gap."""
    p_c, d_eq = (result.record[f"full_slip_{name}"] for name in ("p_c", "d_eq"))
    return p_c, float(result.scene.drive.effective(d_eq))


def test_closure_beyond_its_table_has_no_number():
    """At 200 V ridges adhere by the closures with a field in contact; they are named, and the end is open."""
    found = fp.run(fp.Scene(voltage=200.0), model="cylinders")
    none = ["boundary elements", "Persson's theory"]
    assert [words for words, value in found.closures.items() if value is None] == none
    text, largest = str(found), max(filter(None, found.closures.values()))
    largest *= found.headline.value / found.full_slip.mu_app
    assert f"to {largest:.2f} (Persson's theory, no field in contact)." in text
    assert f" No number by {' and '.join(none)}: ridges adhere at 200 V." in text
    assert band_in_words({}) == ""


def test_no_band_with_a_law_of_ones_own():
    scene = from_data({"roughness": {"law": f"{Held.__module__}:Held"}})
    assert BAND not in fp.run(scene, model="cylinders").record


def test_closures_without_a_table(result):
    """A ratio of waves that the package has no table of leaves the other closures."""
    found = closure_band.closures(fp.Persson(0.5e-6, shortest_wave=20e-6))
    assert list(found) == ["bearing area", "Persson's theory", "Persson's theory, no field in contact"]


def test_closures_of_a_fitted_finger_have_its_air_gap():
    """2 µm where a ridge bears 18 kPa, within 1 %; a height that was given is that of all of them."""
    fitted = fp.Scene(finger="fitted")
    found = closure_band.closures(fitted.closure(), "fitted")
    assert len(found) == 5
    assert [float(law(18e3).d_eq) for law in found.values()] == pytest.approx([2e-6] * 5, rel=0.01)
    given = fitted.replace(roughness={"h_rms": 3e-6})
    assert {law.h_rms for law in closure_band.closures(given.closure(), "fitted").values()} == {3e-6}


# -- no number, with the reason ------------------------------------------------------------------------------------
def test_result_whose_own_closure_has_no_number():
    """At 200 V ridges adhere by it: nothing is known of friction, and no ratio to other closures is given."""
    adhering = fp.run(fp.Scene(voltage=200.0), model="cylinders")
    own = fp.run(adhering.scene.replace(roughness={"law": "BoundaryElements"}), model="cylinders")
    why = "by the result's own closure ridges adhere at 200 V"
    sentence = f"Friction at full slip, {own.finger.f_ext:.4g} N and 200 V, is not known: {why}."
    assert str(own.headline) == sentence and np.isnan(own.headline.value) and own.closures == {}
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


def test_no_friction_has_no_closures_and_no_note(result):
    for keys in ({"friction": 0.0}, {"voltage": 0.0}):
        found = fp.run(result.scene.replace(**keys), model="cylinders")
        assert found.closures == {} and not any("models of roughness" in note for note in found.notes)


def test_reason_is_a_note(result):
    """Of a scene that charged cylinders refuse; its result is that of another model."""
    scene = fp.Scene(history=[{"name": "press", "f_ext": 1.0}])
    found = with_band(replace(result, scene=scene, record={}))
    why = "No µ_app by other models of roughness is computed: history is given."
    assert found.notes[-1] == why and found.closures == {}


def test_other_laws_have_the_friction_without_voltage(result):
    """Coulomb's law and a shear stress, by runs of the section without voltage; to roundoff."""
    scene = result.scene.replace(friction=fp.Derjaguin(mu_f=0.1, tau_0=6e3))
    still = fp.run(scene.replace(voltage=0.0), model="cylinders").full_slip
    for law in laws_beside(scene, fp.run(scene, model="cylinders").full_slip):
        other = fp.run(scene.replace(friction=law, voltage=0.0), model="cylinders").full_slip
        assert other.mu_app == pytest.approx(still.mu_app, rel=1e-9)


# -- closures of rough contact in scenes, height maps, the command microscale and sweeps -----------------------------
@pytest.mark.parametrize("law", ["BoundaryElements", "Persson"])
def test_scene_and_back(law):
    scene = fp.Scene(roughness={"law": law, "h_rms": "2 um", "field_in_contact": False})
    assert isinstance(scene.roughness, getattr(fp, law)) and scene.roughness.h_rms == 2e-6
    assert scene.roughness.h_0 == scene.h_0
    assert fp.Scene(**scene.parameters()).roughness == scene.roughness


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"shortest_wave": 1e-6}, "roughness.shortest_wave is 1e-06 m; .* so take 1.563e-06 to 1.25e-05 m"),
        ({"hurst": 0.5}, "roughness.hurst is 0.5; tables of the package are for 0.6 to 0.9, and Persson has no such"),
        ({"p_floor": 1e6}, "roughness.p_floor is 1000000; it must be below the end of the table of gaps"),
    ],
)
def test_refused_in_a_scene(table, words, tmp_path, monkeypatch):
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path))
    with pytest.raises(fp.SceneError, match=words):
        fp.Scene(roughness={"law": "BoundaryElements"} | table)


def test_height_map_of_a_scene(tmp_path, monkeypatch):
    """The table of a map is that of the map as boundary elements have it; a map with non-square pixels is refused."""
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path))
    file = tmp_path / "skin.npy"
    np.save(file, SelfAffine(2.0, 0.8, 40.0, shortest=12.0).surface((48, 48), (100.0, 100.0), 1).heights)
    given = {"file": str(file), "unit": "um", "size": ["100 um", "100 um"]}
    scene = fp.Scene(roughness={"law": "BoundaryElements", "topography": given})
    law = scene.roughness
    assert law.surface and law.wavelength == pytest.approx(100e-6)
    assert fp.Scene(roughness={"law": "BearingArea", "topography": given}).roughness.h_rms == pytest.approx(law.h_rms)
    assert 0 < law(2e4).d_eq < law(5e3).d_eq
    with pytest.raises(fp.SceneError, match="roughness.topography: pixels of the map are .* needs square ones"):
        fp.Scene(roughness={"law": "BoundaryElements", "topography": given | {"size": ["100 um", "90 um"]}})


def test_result_is_read_where_the_table_is_not(tmp_path, monkeypatch):
    """A folder on another computer: numbers, band and report are in it; another run needs the map."""
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path / "here"))
    np.save(tmp_path / "skin.npy", np.outer(np.cos(np.arange(24)), np.cos(np.arange(24) / 2)))
    given = {"file": str(tmp_path / "skin.npy"), "unit": "um", "size": ["100 um", "100 um"]}
    scene = fp.Scene(voltage=50.0, roughness={"law": "BoundaryElements", "topography": given})
    made = fp.run(scene, model="cylinders", out=tmp_path / "run")
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path / "there"))
    found = fp.Result.load(tmp_path / "run")
    assert found.full_slip.mu_app == made.full_slip.mu_app and main(["report", str(tmp_path / "run")]) == 0
    with pytest.raises(fp.SceneError, match="roughness.surface is .* has no table of that name"):
        fp.run(found.scene.replace(voltage=60.0), model="cylinders")


def test_sweep_over_closures_is_of_one_surface():
    """Roughness that the scene gives stays, as when a run is given both; keys of another law alone go."""
    scene = fp.Scene(roughness={"h_rms": 1e-6, "gamma": 0.45}, voltage=50.0)
    laws = ["BoundaryElements", "Persson"]
    curve = fp.sweep(scene, model="cylinders", **{"roughness.law": laws})
    for law, found in zip(laws, curve, strict=True):
        alone = fp.run(scene.replace(roughness={"law": law, "h_rms": 1e-6}), model="cylinders")
        assert found.full_slip.mu_app == pytest.approx(alone.full_slip.mu_app, rel=1e-12)


def test_laws_of_friction_have_their_names():
    """Coulomb's as well, which a scene keeps as its coefficient."""
    scenes = [fp.Scene(friction=0.3), fp.Scene(friction=fp.Derjaguin(0.3, 5e3))]
    assert [value_of(scene, "friction.law") for scene in scenes] == ["Coulomb", "Derjaguin"]
    assert [value_of(scene, "friction.mu_f") for scene in scenes] == [0.3, 0.3]


# -- ridges that adhere without a load: what a failure says of them, by states of one's own making -------------------
EXACT = fp.BoundaryElements(0.514e-6)


def state(voltage: float, f_contact: list[float]):
    """A state of ridges -1 to 1, of which each is attracted by 1 N/m."""
    base = fp.run(fp.Scene(voltage=10.0), model="cylinders").full_slip
    f = np.array(f_contact)
    number, one = np.array([-1, 0, 1]), np.ones(3)
    ridges = RidgeStates(number, 1e-4 * (f > 0), f, 0 * f, one, f / 1e-4, 1e-6 * one)
    return replace(base, voltage=voltage, ridges=ridges)


def test_sticking_by_voltage():
    """From the closure's own voltage on, of either sign; below it, and of laws without one, nothing."""
    least = EXACT.sticking_voltage()
    assert (
        sticking(EXACT, -1.01 * least) == "by the closure BoundaryElements ridges adhere without a load from 90.5 V on"
    )
    assert sticking(EXACT, 0.99 * least) == sticking(Held(), 200.0) == sticking(None, 200.0) == ""
    assert "BearingArea" in sticking(fp.BearingArea(0.514e-6), 200.0)


def test_ridge_under_the_least_load_is_the_nearest():
    """A ridge that lifted off, with a contact force of zero, is none that adheres."""
    words = adhering(state(150.0, [30.0, 20.0, 0.0]), EXACT)
    assert words.startswith("ridge 0 is nearest to adhering without a load at 150 V: by the closure BoundaryElements")
    assert words.endswith("another roughness.law")
    assert adhering(state(150.0, [0.0, 0.0, 0.0]), EXACT).startswith("at 150 V by the closure")
    assert adhering(state(50.0, [3.0, 2.0, 0.9]), EXACT) == adhering(None, EXACT) == ""


def test_states_that_attraction_holds_are_counted():
    """Without a force or pulled, under a voltage, in contact: the last of them and its ridge are named."""
    pressed, pulled = state(150.0, [3.0, 2.0, 1.5]), replace(state(150.0, [3.0, 2.0, 0.9]), f_ext=-0.1)
    free, lifted = replace(pressed, f_ext=1e-9), replace(pulled, contact_length=0.0)
    (text,) = on_states([pressed, free, pulled, lifted], EXACT)[:1]
    assert str(text) == (
        "in 2 of 3 charged states the finger adheres without a load, most by ridge 1, at -0.1 N/m and 150 V; by "
        "the closure BoundaryElements ridges adhere without a load from 90.5 V on"
    )
    assert not any("without a load" in str(text) for text in on_states([pressed, replace(pulled, voltage=0.0)], EXACT))


def test_cylinders_without_an_equilibrium_say_it():
    """At 4 kV no pressure of the closure holds; one sentence names the closure and its voltage."""
    with pytest.raises(fp.SceneError, match="cylinders.*by the closure BoundaryElements ridges adhere without a load"):
        fp.run(fp.Scene(voltage=4000.0, roughness={"law": "BoundaryElements"}), model="cylinders")


# -- ridge tips of charged cylinders, against Hertz's contact under a weak voltage ---------------------------
FORCE, VOLTS, GAP = 75.0, 10.0, 2e-6


def attraction(radius: float, length: float, h_0: float) -> float:
    """Return the attraction (N/m) of a ridge in Hertz's contact, as far as its gap is within h_0 + 2 d_eq.

    Gap of a cylinder beside its contact: Johnson, Contact Mechanics, 1985, doi 10.1017/CBO9781139171731, sec. 4.2(c).
    """
    a = length / 2

    def gap(s: float) -> float:
        return a**2 / (2 * radius) * (s * np.sqrt(s**2 - 1) - np.arccosh(s))

    attracted = a * brentq(lambda s: gap(s) - (h_0 + 2 * GAP), 1, 10)
    return 8.8541878128e-12 * VOLTS**2 / 2 / (h_0 + GAP) ** 2 * 2 * attracted


def test_tips_attract_as_hertz_contact_does():
    """Tolerance: at 10 V the attraction is 0.2 % of the load and lengthens the contact by half of that."""
    scene = Scene(voltage=VOLTS, roughness=Held())
    (pressed,) = cylinders.over_forces(scene.replace(voltage=0.0), [FORCE], "charged")
    (found,) = cylinders.over_forces(scene, [FORCE], "charged")
    ridges, radius = pressed.ridges_in_contact, cylinders.tip_radius(scene.geometry)
    expected = ridges * attraction(radius, pressed.contact_length / ridges, scene.h_0)
    assert found.f_electrostatic == pytest.approx(expected, rel=2e-3)
