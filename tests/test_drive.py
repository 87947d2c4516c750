"""Drives in place of a voltage: one measure of how large they are, what attracts, and what is refused."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from fingerpad.model.cautions import examine
from fingerpad.reduced import cylinders
from fingerpad.scene.drive import Drive, one_period
from variational.attraction.circuit import GapCircuit

SINE = {"waveform": "sine", "amplitude": 200.0, "frequency": 100.0}
DRY = {"tissue": "dry", "leak": 300.0}


def driven(drive: dict, **electric) -> Drive:
    found = fp.Scene(voltage=drive, electric=electric).drive
    assert found is not None
    return found


# -- how large it is -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("kind", "rms"), [("sine", 0.5**0.5), ("square", 1.0), ("triangle", 3**-0.5)])
@pytest.mark.parametrize("measure", ["amplitude", "peak_to_peak", "rms"])
def test_every_measure_is_of_the_same_drive(kind, rms, measure):
    """Of an amplitude of 120 V. Tolerance: of the square's two samples at its jumps, and of the triangle's mean."""
    given = {"amplitude": 120.0, "peak_to_peak": 240.0, "rms": 120.0 * rms}[measure]
    found = driven({"waveform": kind, measure: given, "frequency": 50.0}).measures()
    assert_allclose((found.amplitude, found.peak_to_peak), (120.0, 240.0), rtol=1e-12)
    assert found.rms == pytest.approx(120.0 * rms, rel=3e-4)
    assert found.mean == 0


def test_carrier_is_within_its_envelope():
    """The rms that is given is that of the samples; the peaks of both differ by a twentieth of a period."""
    for depth in (0.3, 1.0):
        carrier = {"frequency": 2e3, "modulation": depth}
        found = driven({"waveform": "sine", "rms": 70.0, "frequency": 100.0, "carrier": carrier}).measures()
        assert found.rms == pytest.approx(70.0, rel=1e-9)
        drive = {"waveform": "triangle", "amplitude": 70.0, "frequency": 100.0, "carrier": carrier}
        assert driven(drive).measures().amplitude == pytest.approx(70.0, rel=4e-2)


def test_burst_repeats_itself_with_its_pause():
    """Three periods of five: the mean square is three fifths, and the frequency a fifth."""
    found = driven(SINE | {"burst": {"on": 3, "off": 2}})
    assert found.frequency == pytest.approx(20.0)
    assert np.mean(found.voltages**2) == pytest.approx(0.6 * 200**2 / 2, rel=1e-3)
    assert found.reference == pytest.approx(200 * 0.3**0.5, rel=1e-3)


# -- what attracts ---------------------------------------------------------------------------------------------------
def test_lossless_drive_is_its_rms():
    """Every model has the result of the constant voltage."""
    drive = fp.run(fp.Scene(voltage={"waveform": "sine", "rms": 150.0, "frequency": 250.0}), model="cylinders")
    constant = fp.run(fp.Scene(voltage=150.0), model="cylinders")
    assert drive.full_slip.f_t == pytest.approx(constant.full_slip.f_t, rel=1e-12)
    assert drive.full_slip.voltage == pytest.approx(150.0)


@pytest.mark.parametrize("state", ["charged", "full_slip"])
def test_ridge_has_the_share_of_its_own_gap(state):
    """The attraction of a ridge in a circuit is that of the constant voltage by the share at its d_eq.

    Tolerance: the voltage is interpolated between gaps that differ by a tenth.
    """
    scene = fp.Scene(voltage=SINE, electric=DRY)
    found = cylinders.solve(scene)
    gap = found.record[f"{state}_d_eq"]
    share = GapCircuit("dry", 300.0).share(100.0, gap, 1e-6, 3.9, 425e-6)
    constant = float(np.sqrt(200**2 / 2 * share)) * (scene.h_0 + gap) / gap
    other = cylinders.solve(fp.Scene(voltage=constant))
    assert found.named[state].f_electrostatic == pytest.approx(other.named[state].f_electrostatic, rel=2e-4)


def test_offset_without_a_leak_has_a_caution():
    scene = fp.Scene(voltage=SINE | {"offset": 50.0})
    assert ["has a mean of 50 V, which leaks away" in text.text for text in examine("scene", scene)] == [True]
    assert examine("scene", scene.replace(electric=DRY)) == []


def test_scene_of_a_drive_survives_its_files():
    """Parameters of a scene give it again."""
    drive = SINE | {"carrier": {"frequency": 5e3}, "burst": {"on": 5, "off": 5}, "offset": -3.0}
    scene = fp.Scene(voltage=drive, electric={"leak": {"peak": "250 Hz"}, "tissue": "dry"})
    assert fp.Scene(**scene.parameters()) == scene
    assert scene.replace(voltage=100.0).drive is None


@pytest.mark.parametrize(
    "drive",
    [
        SINE | {"waveform": "square"},
        SINE | {"waveform": "square", "burst": {"on": 2, "off": 2}},
        {"waveform": "file", "times": [0.0, 1.0], "voltages": [-200.0, 200.0]},
    ],
    ids=["square", "burst", "sawtooth"],
)
def test_no_sample_lies_inside_a_jump(drive):
    """Of 400 V, or 200 V into a pause: only the voltages of both sides are there, and the sawtooth never stops."""
    u = one_period(fp.Scene(voltage=drive).voltage)
    if drive["waveform"] == "file":
        assert u[0] == -200 and np.ptp(np.diff(u)) < 1e-9
    else:
        assert set(u) == ({-200.0, 200.0} | ({0.0} if "burst" in drive else set()))
        assert u.sum() == 0 and u[0] == 200


# -- refusals --------------------------------------------------------------------------------------------------------
FILE = {"waveform": "file", "times": [0.0, 0.01, 0.02], "voltages": [0.0, 100.0, 0.0]}
TABLE = {"frequency": [10.0, 1e3], "eps": [2e3, 1e3], "sigma": [1e-4, 1e-3]}


@pytest.mark.parametrize(
    ("drive", "electric", "words"),
    [
        (SINE | {"rms": 100.0}, {}, "voltage.amplitude is 200 and voltage.rms is 100; give one of voltage.amplitude"),
        ({"waveform": "sine", "frequency": 10.0}, {}, "voltage.amplitude is missing; voltage.waveform is 'sine'"),
        (SINE | {"frequency": 0.0}, {}, "voltage.frequency is 0 Hz; it must be from 0.001 to 1e+06 Hz"),
        (SINE | {"frequency": 2e3}, {"tissue": TABLE}, "voltage.frequency is 2000 Hz; the table of the tissue has 10"),
        (SINE | {"offset": 600.0}, {}, "voltage.offset is 600 V, beyond breakdown of air in a gap of any width; it"),
        (
            SINE | {"carrier": {"frequency": 50.0}},
            {},
            "voltage.carrier.frequency is 50 Hz and voltage",
        ),
        (
            SINE | {"carrier": {"frequency": 1e6}},
            {},
            "voltage.carrier.frequency is 1000000 Hz, 1e+04 periods in one",
        ),
        (FILE | {"carrier": {"frequency": 20.0, "modulation": 1.0}}, {}, "voltage.carrier.modulation is 1 and voltage"),
        (FILE | {"burst": {"on": 1, "off": 1}}, {}, "voltage.burst is given and voltage.waveform is 'file', which has"),
        (SINE | {"burst": {"on": 0, "off": 1}}, {}, "voltage.burst.on is 0; it must be at least 1"),
        (
            SINE,
            {"tissue": TABLE | {"frequency": [1e3, 10.0]}},
            "electric.tissue.frequency is 1000 and then 10 Hz",
        ),
        (SINE, {"leak": 0.0}, "electric.leak is 0 ohm m^2; it must be from 0.001 to 1e+09 ohm m^2"),
        (0.0, {"leak": {"peak": 100.0}}, "electric.leak.peak is 100 Hz; no leak through a gap of 1.6e-06 m has its"),
    ],
)
def test_drive_is_refused(drive, electric, words):
    """One sentence that begins with the key."""
    with pytest.raises(fp.SceneError) as refused:
        fp.Scene(voltage=drive, electric=electric)
    assert str(refused.value).startswith(words)
