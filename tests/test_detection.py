"""Friction over the period of a drive, its spectrum, and relative thresholds of detection."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.reduced import cylinders, detection
from fingerpad.reduced.detection import thresholds
from variational.attraction.circuit import GapCircuit

SINE = {"waveform": "sine", "amplitude": 200.0, "frequency": 30.0}
DRY = {"tissue": "dry", "leak": 300.0}
DRIVE = "voltage={waveform='sine', amplitude=200, frequency='30 Hz'}"


# -- friction over a period ------------------------------------------------------------------------------------------
def test_friction_at_instants_is_that_of_the_model():
    """Beside a solve at the voltage of each instant. Tolerance: of eleven points and monotone cubic curves."""
    found = fp.drive(fp.Scene(voltage=SINE))
    at = np.arange(0, 1024, 101)
    exact = [cylinders.solve(fp.Scene(voltage=float(found.voltage[k]))).full_slip.f_t for k in at]
    assert_allclose(found.f_t[at], exact, rtol=2e-4)


def test_friction_in_a_circuit_is_that_of_the_gap_at_each_instant():
    """A square through a leak: the ridge's gap is a solution of the voltage at that gap."""
    scene = fp.Scene(voltage=SINE | {"waveform": "square"}, electric=DRY)
    found = fp.drive(scene)
    for k in (10, 300, 1500):
        gap = scene.h_0 * 3
        for _ in range(20):
            across = scene.drive.across(gap)[k]
            other = cylinders.solve(fp.Scene(voltage=abs(float(across)) * (scene.h_0 + gap) / gap))
            gap = other.record["full_slip_d_eq"]
        assert found.f_t[k] == pytest.approx(other.full_slip.f_t, rel=2e-3)
        assert found.sigma_el[k] == pytest.approx(8.854e-12 / 2 * (across / gap) ** 2, rel=2e-3)


def test_offset_gives_both_frequencies_and_a_leak_takes_one():
    """Without losses f and 2 f are in the ratio 4 U_0 : U_1 where friction is as U², in small voltages."""
    small = {"waveform": "sine", "amplitude": 4.0, "offset": 3.0, "frequency": 30.0}
    found = fp.drive(fp.Scene(voltage=small))
    assert found.at(30.0) / found.at(60.0) == pytest.approx(4 * 3.0 / 4.0, rel=1e-2)
    assert fp.drive(fp.Scene(voltage=small, electric=DRY)).at(30.0) == 0


def test_whole_finger_is_in_newtons():
    """As the sum over slices of the constant voltage, where nothing changes over time."""
    square = {"waveform": "square", "amplitude": 150.0, "frequency": 30.0}
    found = fp.drive(fp.Scene(force=0.5, voltage=square))
    constant = fp.run(fp.Scene(force=0.5, voltage=150.0), model="cylinders").finger
    assert found.unit == "N"
    assert np.median(found.f_t) == pytest.approx(constant.values("full_slip")["f_t"], rel=1e-6)


# -- detection -------------------------------------------------------------------------------------------------------
def test_thresholds_are_the_published_ones():
    """At their frequencies; beyond them a power of the frequency."""
    assert_allclose(detection.threshold(detection.FREQUENCY), detection.DISPLACEMENT, rtol=1e-12)
    power = np.log(0.120 / 0.070) / np.log(350 / 300)
    assert detection.threshold(700.0) == pytest.approx(0.120 * 2**power)


def test_most_sensitive_component_decides():
    """Ten times the force at 20 Hz is felt less than that at 200 Hz."""
    t = np.arange(512) / 512
    found = detection.level(10 * np.sin(2 * np.pi * t) + np.sin(20 * np.pi * t), 20.0)
    assert found.frequency == 200.0 and not found.extrapolated
    assert found.value == pytest.approx(1 / 0.042)


@pytest.mark.parametrize("leak", [None, 300.0])
@pytest.mark.parametrize("frequency", [15.0, 60.0, 240.0])
def test_square_is_that_of_its_fourier_series(leak, frequency):
    """The force as products of the exact coefficients 2/(i pi k): the level has no error of samples in a jump.

    Tolerance: of the series, cut at k = 80001, and of the samples, each 0.3 % without a leak.
    """
    circuit, layers = GapCircuit("dry", leak), (1.6e-6, 1e-6, 3.9, 425e-6)
    k = np.arange(1, 80002, 2)
    half = 2 / (1j * np.pi * k) * circuit.gain(frequency * k, *layers)
    field, n = np.concatenate([half[::-1].conj(), half]), len(half)  # of k from -80001 to 80001
    force = {2 * m: 2 * abs(field[m:] @ field[m:][::-1]) for m in range(1, 12)}
    best = max(force, key=lambda m: force[m] / detection.threshold(m * frequency))
    found = detection.of_wave(circuit, "square", frequency, layers)
    assert n == 40001 and found.frequency == best * frequency
    assert found.value == pytest.approx(force[best] / detection.threshold(found.frequency), rel=6e-3)


def test_square_without_losses_is_never_felt():
    """Its attraction is constant: no threshold, and one friction over the period, that of the constant voltage."""
    scene = fp.Scene(voltage=SINE | {"waveform": "square"})
    assert [each.square_over_sine for each in thresholds(scene)] == [np.inf] * 6
    constant = cylinders.solve(fp.Scene(voltage=200.0)).full_slip.f_t
    assert_allclose(fp.drive(scene).f_t, constant, rtol=1e-9)


def test_thresholds_are_those_of_independent_code():
    """To two digits, of sines where the published thresholds reach. Tolerance: these are read differently."""
    found = thresholds(fp.Scene(electric=DRY))
    assert_allclose([each.sine for each in found[:4]], (6.1, 2.4, 1.2, 1.0), rtol=0.06)
    assert_allclose([each.square_over_sine for each in found], (0.26, 0.57, 1.08, 1.52, 2.15, 2.66), rtol=0.05)
    assert [each.extrapolated for each in found] == [False] * 4 + [True] * 2


# -- command ---------------------------------------------------------------------------------------------------------
def test_command(capsys, tmp_path):
    """It prints measures, friction and thresholds, and writes its files."""
    files = [tmp_path / name for name in ("drive.png", "thresholds.csv")]
    words = [text for pair in zip(("--plot", "--csv"), map(str, files), strict=True) for text in pair]
    assert main(["drive", "--set", DRIVE, "--set", "electric.leak=300", "--frequency", "30, 60 Hz", *words]) == 0
    out = capsys.readouterr().out
    for text in ("amplitude 200 V, peak to peak 400 V, rms 141.4 V", "mean attraction", "60 Hz", "230 to 410"):
        assert text in out
    assert all(file.stat().st_size for file in files)
    assert files[1].read_text(encoding="utf-8").splitlines()[0] == "frequency,sine,square_over_sine,square"


@pytest.mark.parametrize(
    ("words", "refusal"),
    [
        (["--frequency", "-5"], "--frequency is -5; it must be greater than 0"),
        (["--plot", "x.png"], "--plot is given and voltage is 200 V; it must be a drive"),
    ],
)
def test_command_refuses(words, refusal, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["drive", *words]) == 2
    assert capsys.readouterr().err.startswith(f"fingerpad: {refusal}")
