r"""How easily a drive is felt, relative to another one, by displacement thresholds of people over the frequency.

The most sensitive Fourier component of the friction force decides (Y. Vardar et al. 2016, "Effect of waveform in haptic
perception of electrovibration on touchscreens", doi 10.1007/978-3-319-42321-0_18, found the Pacinian channel to detect
it). With a_k the amplitude of the force at k times the frequency and A the displacement threshold, the level of a drive
is

.. math:: L = \max_k \frac{a_k}{A(k f)}, \qquad \frac{U_{th}}{U'_{th}} = \sqrt{L' / L},

since at the threshold the force goes with the square of the voltage. Ratios alone are given: of waveform to waveform,
and of a frequency to :data:`REFERENCE_FREQUENCY`. How a force moves the skin is taken as the same at every frequency.

The thresholds are curves of previous literature, digitised, ± 3 dB. Between them A is a power of the frequency; beyond
them it goes on with the power of the last two, which is marked as extrapolated.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fingerpad.scene.drive import REFERENCE
from fingerpad.scene.messages import SceneError
from fingerpad.scene.scene import Scene
from fingerpad.scene.waveform import shape
from variational.attraction.circuit import GapCircuit

Array = NDArray[Any]
_ROUNDOFF = 1e-9  # of the largest force: an amplitude that is roundoff
_FREQUENCY = (1e-3, 1e6)  # Hz, least and largest: those of a drive of a scene
FREQUENCIES = (15.0, 30.0, 60.0, 120.0, 240.0, 480.0)
"""Frequencies (Hz) of the table of relative thresholds."""
FREQUENCY = (2.0, 5.0, 10.0, 20.0, 40.0, 80.0, 100.0, 150.0, 200.0, 250.0, 300.0, 350.0)
"""Frequencies (Hz) of the thresholds."""
DISPLACEMENT = (24.3, 11.1, 5.34, 1.87, 0.496, 0.115, 0.079, 0.049, 0.042, 0.046, 0.070, 0.120)
"""Displacement thresholds (µm)."""
REFERENCE_FREQUENCY = 120.0
"""Frequency (Hz) of a sine to whose threshold others are relative."""
_SAMPLES = 1 << 14


@dataclass(frozen=True)
class Threshold:
    """Relative thresholds of detection at a frequency."""

    frequency: float
    """Of the drive (Hz)."""
    sine: float
    """Voltage at the threshold of a sine, over that of a sine of :data:`REFERENCE_FREQUENCY`."""
    square_over_sine: float
    extrapolated: bool
    """Whether a component that decides is beyond the known thresholds."""


def thresholds(scene: Scene, frequencies: Sequence[float] = FREQUENCIES) -> list[Threshold]:
    """Return relative thresholds of detection of a sine and a square, through the circuit of a scene.

    Args:
        scene: whose insulators and losses count.
        frequencies: of the drives (Hz).

    Raises:
        SceneError: a frequency that a drive of a scene cannot have, or at which the tissue is not known.
    """
    for f in frequencies:
        if not _FREQUENCY[0] <= f <= _FREQUENCY[1]:
            raise SceneError(f"frequency is {f:g} Hz; it must be from {_FREQUENCY[0]:g} to {_FREQUENCY[1]:g} Hz")
    electric, d_sc = scene.electric, scene.geometry.sc_thickness
    circuit, layers = electric.circuit(d_sc), (REFERENCE, electric.d_i, electric.eps_i, d_sc)
    try:
        reference = of_wave(circuit, "sine", REFERENCE_FREQUENCY, layers)
        found = []
        for f in frequencies:
            sine, square = (of_wave(circuit, wave, f, layers) for wave in ("sine", "square"))
            marked = sine.extrapolated or square.extrapolated
            found.append(Threshold(f, sine.relative_to(reference), square.relative_to(sine), marked))
    except ValueError as error:
        raise SceneError(str(error)) from None
    return found


def threshold(frequency: ArrayLike) -> Array:
    """Return the displacement threshold (µm) at frequencies (Hz) above 0, of their shape."""
    f, a = np.log(FREQUENCY), np.log(DISPLACEMENT)
    x = np.log(np.asarray(frequency, dtype=float))
    first, last = (a[1] - a[0]) / (f[1] - f[0]), (a[-1] - a[-2]) / (f[-1] - f[-2])
    beyond = np.where(x < f[0], first * (x - f[0]), np.where(x > f[-1], last * (x - f[-1]), 0.0))
    return np.asarray(np.exp(np.interp(x, f, a) + beyond))


@dataclass(frozen=True)
class Level:
    """How far a force is above what is felt, on a scale without a unit."""

    value: float
    frequency: float
    """Frequency (Hz) of the component that decides."""

    @property
    def extrapolated(self) -> bool:
        """Whether no threshold is known at that frequency."""
        return not FREQUENCY[0] <= self.frequency <= FREQUENCY[-1]

    def relative_to(self, other: "Level") -> float:
        """Return the voltage at the threshold over that of another drive; infinite for a constant force."""
        return float(np.sqrt(other.value / self.value)) if self.value else np.inf


def level(force: ArrayLike, frequency: float) -> Level:
    """Return the level of a periodic force.

    Args:
        force: at equal times over a period, shape (samples,), in any unit.
        frequency: of the period (Hz).
    """
    values = np.asarray(force, dtype=float)
    amplitude = 2 / len(values) * np.abs(np.fft.rfft(values))[1:]
    amplitude[amplitude < _ROUNDOFF * np.abs(values).max()] = 0.0
    at = frequency * np.arange(1, len(amplitude) + 1)
    levels = amplitude / threshold(at)
    k = int(np.argmax(levels))
    return Level(float(levels[k]), float(at[k]))


def of_wave(circuit: GapCircuit, wave: str, frequency: float, layers: tuple[float, float, float, float]) -> Level:
    """Return the level of a wave of 1 V through a circuit, for a force as the square of the field.

    Args:
        circuit: of the gap.
        wave: as for :func:`fingerpad.scene.waveform.shape`.
        frequency: of the wave (Hz).
        layers: gap (m), d_i (m), eps_i, d_sc (m).

    Raises:
        ValueError: the frequency is not greater than 0, or the tissue is not known there.
    """
    period = shape(wave, np.arange(_SAMPLES), _SAMPLES)
    return level(circuit.response(period, frequency, *layers) ** 2, frequency)
