"""The band of friction over models of roughness: its numbers, its words, and where there is none."""

from dataclasses import dataclass

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.reduced import closure_band
from fingerpad.results.headline import band_in_words
from fingerpad.results.quantities import BAND
from fingerpad.scene import from_data


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
    ends = "0.28 (bearing area) to 0.41 (boundary elements)"
    assert f"By models of rough contact µ_app of the middle section is {ends} at full slip. " in text
    band = band_in_words(result.record[BAND])
    assert " The largest number, by boundary elements, is an upper bound: attraction balances 24 % of" in band
    assert len(result.record[BAND]["upper_bounds"]) == 2 and band.count("largest number") == 1
    assert f"\n  {band}\n" in text and band.endswith("Which one holds for a finger is open (docs/microscale.md).")
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
    assert f"to {largest:.2f} (Persson's theory, no field in contact) at full slip." in text
    assert f" No number by {' and '.join(none)}: ridges adhere at 200 V. " in text
    assert band_in_words({}) == ""


def test_no_band_with_a_law_of_ones_own():
    scene = from_data({"roughness": {"law": f"{Held.__module__}:Held"}})
    assert BAND not in fp.run(scene, model="cylinders").record


def test_closures_without_a_table(result):
    """A ratio of waves that the package has no table of leaves the other closures."""
    found = closure_band.closures(fp.Persson(0.5e-6, shortest_wave=20e-6))
    assert list(found) == ["bearing area", "Persson's theory", "Persson's theory, no field in contact"]
