"""Drives as the full model follows them: the voltage of Eq. 3 over time, and the share of each ridge's gap."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from fingerpad.model import drive_loads
from fingerpad.scene.drive import REFERENCE
from tests.small_finger import SMALL

SINE = {"waveform": "sine", "amplitude": 100.0, "frequency": 50.0}
DRY = {"tissue": "dry", "leak": 300.0}


def scene(drive, duration: float = 0.2, **electric) -> fp.Scene:
    wave = {"name": "wave", "duration": duration, "voltage": drive}
    return fp.Scene(history=[{"name": "press", "f_ext": 1.0}, wave], electric=electric)


def over(found: fp.Scene):
    """Return times and voltages of the load as the full model follows it."""
    wave = drive_loads.loads(found)[1].wave
    return np.array(wave.times), np.array(wave.voltages)


def test_ends_in_the_steady_state():
    """Amplitude and phase of the last period are those of the circuit. Tolerance: of 48 straight pieces a period."""
    found = scene(SINE, **DRY)
    t, v = over(found)
    gain = found.electric.circuit(425e-6).gain(50.0, REFERENCE, 1e-6, 3.9, 425e-6)
    last = t > 0.18
    exact = 100 * (found.h_0 + REFERENCE) / REFERENCE * np.imag(gain * np.exp(2j * np.pi * 50 * t[last]))
    assert_allclose(v[last], exact, atol=0.5)


def test_offset_leaks_away_in_the_load():
    """A square of small amplitude about 100 V: after 0.2 s nothing of its mean is left."""
    _, v = over(scene(SINE | {"waveform": "square", "amplitude": 1.0, "offset": 100.0}, **DRY))
    assert v[:20].max() > 50 and abs(v[-40:]).max() < 2.1


def test_carrier_is_averaged():
    """The envelope over the root of two, from the start on: no losses, no offset. Tolerance: of the envelope's bend."""
    t, v = over(scene(SINE | {"carrier": {"frequency": 5e3}}))
    assert_allclose(v, 100 / 2**0.5 * (1 + np.sin(2 * np.pi * 50 * t)) / 2, atol=0.3)


def test_burst_has_its_pauses():
    """Two periods of 20 ms and three without a voltage, which need no table; a square jumps at both of their ends."""
    for drive, jumps in ((SINE, []), (SINE | {"waveform": "square"}, [0.01, 0.02, 0.03, 0.04, 0.1, 0.11, 0.12])):
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
    file = {"waveform": "file", "times": [0.0, 1e-5, 3e-5, 4e-5], "voltages": [0.0, 100.0, -100.0, 0.0]}
    t, v = over(scene(file | {"repeat": True}, follows="mean"))
    assert list(t) == [0.0, 0.2]
    assert_allclose(v, 100 / 3**0.5, rtol=1e-5)


@pytest.mark.parametrize(
    ("history", "words"),
    [
        ([{"name": "charge", "voltage": 50.0}], "history[2].voltage and history[1].voltage are two voltages in a"),
        (
            [{"name": "other", "voltage": SINE | {"frequency": 60.0}, "duration": 0.1}],
            "history[1].voltage and history[2].voltage are two voltages in a circuit with losses",
        ),
    ],
)
def test_two_voltages_are_refused(history, words):
    loads = [{"name": "press", "f_ext": 1.0}, *history, {"name": "wave", "duration": 0.1, "voltage": SINE}]
    with pytest.raises(fp.SceneError) as refused:
        drive_loads.gap_factor(fp.Scene(history=loads, electric=DRY))
    assert str(refused.value).startswith(words)


def test_too_many_periods_are_refused():
    with pytest.raises(fp.SceneError, match="400 periods in 0.2 s, which need .* points and at most 2000"):
        drive_loads.loads(scene(SINE | {"frequency": 2e3}, **DRY))


@pytest.mark.slow
def test_full_model_has_the_share_of_each_ridge():
    """A small finger, of which one ridge touches, beside the constant voltage that this ridge has.

    Its attraction is the same, but for 0.2 % of what its neighbours pull; the others' is by the square of their share,
    within 3 % of their height. The energy balance closes to the solves' tolerance.
    """
    small = fp.Scene.load(SMALL)
    drive = fp.run(small.replace(voltage=SINE | {"amplitude": 200.0}, electric=DRY))
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
