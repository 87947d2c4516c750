r"""The friction of a drive over its period, and whether it is felt: quasi-static, by the closed form.

At each instant of a period the finger is at full slip under the attraction of that instant. It is that of the model
"cylinders" at the voltage of Eq. 3 that a ridge of its own air gap has then (:mod:`fingerpad.scene.drive`). Friction
and air gap are computed at :data:`POINTS` voltages, evenly in their square, and interpolated by monotone cubic curves.

**Detection**, relative to another drive, is by displacement thresholds of people over the frequency.
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
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fingerpad.model.cautions import examine, on_scene
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import find, solved
from fingerpad.scene import Scene
from fingerpad.scene.drive import REFERENCE, Drive
from fingerpad.scene.messages import SceneError
from fingerpad.scene.waveform import shape
from geometry.units import computed
from variational.attraction.circuit import GapCircuit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[Any]
POINTS = 11
"""Voltages at which friction is computed."""
_MARGIN = 0.7  # gaps of a charged ridge over that without voltage, at the least
_ITERATIONS, _TOLERANCE = 50, 1e-9  # of the air gap at an instant, relative
_ROUNDOFF = 1e-9  # of the mean or largest force: an amplitude that is roundoff
_COMPONENTS = 5  # largest of the spectrum that are printed
_QUASI_STATIC = 100.0  # Hz, above which inertia begins to matter
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


@dataclass(frozen=True)
class DrivenFriction:
    """What a drive does: arrays over one period, all of shape (samples,)."""

    scene: Scene
    time: Array
    """From the start of a period (s)."""
    voltage: Array
    """U (V)."""
    sigma_el: Array
    """Attraction (Pa) across the air gap of that instant."""
    f_t: Array
    """Friction force: in N on the whole finger where the scene has a ``force``, else in N/m."""
    frequency: Array
    """Frequencies (Hz) of the spectrum, multiples of that of the period, shape (components,)."""
    amplitude: Array
    """Amplitudes of the friction force there, in its unit, shape (components,)."""
    notes: tuple[str, ...]

    @property
    def unit(self) -> str:
        """Unit of the friction force."""
        return "N" if self.scene.force is not None else "N/m"

    def at(self, frequency: float) -> float:
        """Return the amplitude of the friction force at a frequency (Hz); 0 where the drive has none."""
        near = np.abs(self.frequency - frequency) < 1e-6 * frequency
        found = float(self.amplitude[near].sum())
        return found if found > _ROUNDOFF * float(self.f_t.mean()) else 0.0

    def __str__(self) -> str:
        """Return mean, extremes and the largest components."""
        f, u, wave = self.f_t, self.unit, self.scene.voltage
        base = getattr(wave, "frequency", None) or float(self.frequency[0])
        largest = [k for k in np.argsort(-self.amplitude)[:_COMPONENTS] if self.amplitude[k] > 1e-6 * f.mean()]
        parts = ", ".join(f"{self.amplitude[k]:.4g} {u} at {self.frequency[k]:.4g} Hz" for k in sorted(largest))
        lines = [
            f"Friction force at full slip over a period: mean {f.mean():.4g} {u}, from {f.min():.4g} to {f.max():.4g} "
            f"{u}",
            f"amplitude at the drive's frequency, {base:.4g} Hz: {self.at(base):.4g} {u}; at twice that, "
            f"{2 * base:.4g} Hz: {self.at(2 * base):.4g} {u}",
            f"largest components: {parts or 'none'}",
            *self.notes,
        ]
        return "\n".join(lines)

    def plot(self, path: str | Path | None = None) -> "Figure":
        """Draw U, attraction and friction over a period, and the spectrum of friction; write a picture if asked."""
        from fingerpad.results.pictures.curves import over_period  # Matplotlib

        return over_period(self, path)


def drive(scene: Scene) -> DrivenFriction:
    """Return what the drive of a scene does over its period, by the closed form in less than a second.

    Args:
        scene: press, charge and slide, whose ``voltage`` is a drive.

    Raises:
        SceneError: its voltage is a number, or the model "cylinders" has no answer.
    """
    given = scene.drive
    if given is None:
        raise SceneError(
            f"voltage is {scene.volts:g} V; it must be a drive, as in voltage = {{waveform = 'sine', amplitude = 200, "
            "frequency = 100}"
        )
    squares, friction, gaps = _curve(scene, given)
    gap: Array = np.full(len(given.voltages), gaps[0])
    for _ in range(_ITERATIONS):
        volts = given.instants(gap)
        before, gap = gap, _monotone(squares, gaps, volts**2)
        if np.all(np.abs(gap - before) <= _TOLERANCE * gap):
            break
    f_t = _monotone(squares, friction, volts**2)
    amplitude = 2 / len(f_t) * np.abs(np.fft.rfft(f_t))[1:]
    sigma = given.pressure(volts, gap)
    time = np.arange(len(f_t)) / len(f_t) / given.frequency
    least = float(gap[int(np.argmax(volts))])
    cautions = on_scene(scene, gaps=[("full slip", least, 0.0)])
    notes = [*map(str, examine("note", scene)), *(f"! {text}" for text in cautions)]
    if 2 * (given.wave.frequency or given.frequency) > _QUASI_STATIC:
        notes.append(
            f"! friction varies faster than {_QUASI_STATIC:g} Hz, where inertia of the skin begins to matter: "
            "amplitudes are quasi-static"
        )
    frequency = given.frequency * np.arange(1, len(amplitude) + 1)
    return DrivenFriction(scene, time, given.voltages, sigma, f_t, frequency, amplitude, tuple(notes))


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


def _curve(scene: Scene, given: Drive) -> tuple[Array, Array, Array]:
    """Return squares of voltages (V²), and there the friction force and the air gap of a ridge (m)."""
    model, context = find(Cylinders.name), RunContext()

    def at(voltage: float) -> tuple[float, float]:
        with computed():  # a part of a small amplitude may be less than a scene can have
            found = solved(scene.replace(voltage=voltage), model, context)
        state = found.full_slip
        assert state is not None
        whole = found.finger if scene.force is not None else None  # in the unit of the drive
        force = state.f_t if whole is None else float(whole.values("full_slip")["f_t"])
        return force, float(found.record["full_slip_d_eq"])

    still = at(0.0)
    most = given.largest(_MARGIN * still[1], still[1])
    squares = np.linspace(0.0, most**2, POINTS)
    values = np.array([still, *(at(float(np.sqrt(square))) for square in squares[1:])])
    return squares, np.array(values[:, 0]), np.array(values[:, 1])


def _monotone(x: Array, y: Array, at: Array) -> Array:
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(x, y)(np.clip(at, x[0], x[-1])))


# -- detection -------------------------------------------------------------------------------------------------
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
