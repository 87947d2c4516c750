"""The likely range of friction: its law of friction, changes by full runs, and where there is none, with the reason."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import fingerpad as fp
from benchmarks import harness
from fingerpad.reduced.closure_band import LAW, laws_like, powers, with_band


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


def test_drive_has_the_law_too():
    """Without losses a sine of 200 V rms attracts as 200 V do, so that all parts are the same."""
    drive = cylinders(voltage={"waveform": "sine", "rms": 200.0, "frequency": 1e3})
    assert ratios(drive, LAW) == pytest.approx(ratios(cylinders(), LAW), rel=1e-3)


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
