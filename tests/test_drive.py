"""Drives in place of a voltage: how large they are, what attracts, refusals, and the full model."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from fingerpad.model import drive_loads
from fingerpad.model.cautions import examine
from fingerpad.reduced import cylinders
from fingerpad.scene.drive import REFERENCE, Drive, one_period
from tests.small_finger import SMALL
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
        {"waveform": "file", "times": [0.0, 1.0], "values": [-200.0, 200.0]},
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
FILE = {"waveform": "file", "times": [0.0, 0.01, 0.02], "values": [0.0, 100.0, 0.0]}
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
        (
            FILE | {"carrier": {"frequency": 60.0}},
            {},
            "voltage.carrier.frequency is 60 Hz and the record has",
        ),
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


# -- drives as the full model follows them: the voltage of Eq. 3 over time, and the share of each ridge's gap --------
WEAK = {"waveform": "sine", "amplitude": 100.0, "frequency": 50.0}


def scene(drive, duration: float = 0.2, **electric) -> fp.Scene:
    wave = {"name": "wave", "duration": duration, "voltage": drive}
    return fp.Scene(history=[{"name": "press", "f_ext": 1.0}, wave], electric=electric)


def over(found: fp.Scene):
    """Return times and voltages of the load as the full model follows it."""
    wave = drive_loads.loads(found)[1].wave
    return np.array(wave.times), np.array(wave.values)


def test_ends_in_the_steady_state():
    """Amplitude and phase of the last period are those of the circuit. Tolerance: of 48 straight pieces a period."""
    found = scene(WEAK, **DRY)
    t, v = over(found)
    gain = found.electric.circuit(425e-6).gain(50.0, REFERENCE, 1e-6, 3.9, 425e-6)
    last = t > 0.18
    exact = 100 * (found.h_0 + REFERENCE) / REFERENCE * np.imag(gain * np.exp(2j * np.pi * 50 * t[last]))
    assert_allclose(v[last], exact, atol=0.5)


def test_offset_leaks_away_in_the_load():
    """A square of small amplitude about 100 V: after 0.2 s nothing of its mean is left."""
    _, v = over(scene(WEAK | {"waveform": "square", "amplitude": 1.0, "offset": 100.0}, **DRY))
    assert v[:20].max() > 50 and abs(v[-40:]).max() < 2.1


def test_carrier_is_averaged():
    """The envelope over the root of two, from the start on: no losses, no offset. Tolerance: of the envelope's bend."""
    t, v = over(scene(WEAK | {"carrier": {"frequency": 5e3}}))
    assert_allclose(v, 100 / 2**0.5 * (1 + np.sin(2 * np.pi * 50 * t)) / 2, atol=0.3)


def test_burst_has_its_pauses():
    """Two periods of 20 ms and three without a voltage, which need no table; a square jumps at both of their ends."""
    for drive, jumps in ((WEAK, []), (WEAK | {"waveform": "square"}, [0.01, 0.02, 0.03, 0.04, 0.1, 0.11, 0.12])):
        burst = drive | {"burst": {"on": 2, "off": 3}}
        (wave,) = (load.wave for load in drive_loads.loads(scene(burst, 0.125)) if load.wave is not None)
        t, v = map(np.array, zip(*wave.samples(0.125, 1.0), strict=True))
        assert abs(v[(t > 0.0401) & (t < 0.0999)]).max() == 0 and v[t < 0.04].max() == pytest.approx(100.0)
        assert_allclose(t[1:][np.diff(t) == 0], jumps, rtol=1e-12)
        assert wave.between((0.05, 0.0), (0.06, 0.0), 0.055) == 0
        assert_allclose(_after(t, v, 0.1), _after(t, v, 0.0)[: len(_after(t, v, 0.1))], atol=1e-9)


def _after(t, v, begin: float):
    """Return the voltages up to 24 ms after a time."""
    return v[(t > begin + 1e-6) & (t < begin + 0.024)]


def test_mean_of_a_file_is_constant():
    """A triangle's root mean square, however often it repeats itself: its points are no steps."""
    file = {"waveform": "file", "times": [0.0, 1e-5, 3e-5, 4e-5], "values": [0.0, 100.0, -100.0, 0.0]}
    t, v = over(scene(file | {"repeat": True}, follows="mean"))
    assert list(t) == [0.0, 0.2]
    assert_allclose(v, 100 / 3**0.5, rtol=1e-5)


@pytest.mark.parametrize(
    ("history", "words"),
    [
        ([{"name": "charge", "voltage": 50.0}], "history[2].voltage and history[1].voltage are two voltages in a"),
        (
            [{"name": "other", "voltage": WEAK | {"frequency": 60.0}, "duration": 0.1}],
            "history[1].voltage and history[2].voltage are two voltages in a circuit with losses",
        ),
    ],
)
def test_two_voltages_are_refused(history, words):
    loads = [{"name": "press", "f_ext": 1.0}, *history, {"name": "wave", "duration": 0.1, "voltage": WEAK}]
    with pytest.raises(fp.SceneError) as refused:
        drive_loads.gap_factor(fp.Scene(history=loads, electric=DRY))
    assert str(refused.value).startswith(words)


def test_too_many_periods_are_refused():
    with pytest.raises(fp.SceneError, match="400 periods in 0.2 s, which need .* points and at most 2000"):
        drive_loads.loads(scene(WEAK | {"frequency": 2e3}, **DRY))


@pytest.mark.slow
def test_full_model_has_the_share_of_each_ridge():
    """A small finger, of which one ridge touches, beside the constant voltage that this ridge has.

    Its attraction is the same, but for 0.2 % of what its neighbours pull; the others' is by the square of their share,
    within 3 % of their height. The energy balance closes to the solves' tolerance.
    """
    small = fp.Scene.load(SMALL)
    drive = fp.run(small.replace(voltage=WEAK | {"amplitude": 200.0}, electric=DRY))
    ridges, wave = drive.full_slip.ridges, drive.scene.drive
    volts = wave.effective(ridges.d_eq)
    touching = int(np.argmax(ridges.f_contact))
    constant = fp.run(small.replace(voltage=float(volts[touching]))).full_slip.ridges
    ratio = ridges.f_electrostatic / constant.f_electrostatic
    assert ratio[touching] == pytest.approx(1.0, abs=2e-3)
    far = np.delete(np.arange(len(ratio)), touching)
    assert_allclose(ratio[far], (volts[far] / volts[touching]) ** 2, rtol=3e-2)
    assert np.all(ratio[far] < 0.9)
    last = drive.steps[-1].record
    assert abs(last.energy_released) <= last.released_error + 1e-9 * last.stored
