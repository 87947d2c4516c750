r"""The friction of a drive over its period: quasi-static, by the closed form.

At each instant of a period the finger is at full slip under the attraction of that instant. It is that of the model
"cylinders" at the voltage of Eq. 3 that a ridge of its own air gap has then (:mod:`fingerpad.scene.drive`). Friction
and air gap are computed at :data:`POINTS` voltages, evenly in their square, and interpolated by monotone cubic curves.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.model.cautions import examine, on_scene
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import find, solved
from fingerpad.scene import Scene
from fingerpad.scene.drive import Drive
from fingerpad.scene.messages import SceneError
from geometry.units import computed

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
