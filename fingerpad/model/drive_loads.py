r"""The loads of drives in the full model: voltages of Eq. 3, and the factor by which a ridge's gap scales them.

The full model has the law of Eq. 3 alone. A drive in a circuit with losses, on a carrier or in bursts becomes the
voltage V of Eq. 3 that attracts as much (:mod:`fingerpad.scene.drive`), over time at a gap of
:data:`~fingerpad.scene.drive.REFERENCE`. On a ridge of another gap d_eq, V is multiplied by the ratio of the two root
mean squares, frozen with d_eq in each solve. The phase of the drive is that at the reference gap on every ridge.

A load begins with the drive switched on across a gap without charge, by the equations of the circuit in time. Where
these are not known, of a table of a tissue or of a carrier, it begins in the steady state.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fingerpad.scene import Load, Scene
from fingerpad.scene.controls import CarriedWaveform, VoltageWaveform
from fingerpad.scene.drive import GAPS, REFERENCE, Drive, drive_of
from fingerpad.scene.loads import ways
from fingerpad.scene.messages import SceneError
from fingerpad.scene.wavefile import POINTS
from geometry.units import computed
from variational.attraction.circuit import Network

Array = NDArray[np.float64]
_FEWEST_POINTS, _MOST_POINTS = 12, 48  # points of a period of the wave
_JUMP = 1e-6  # of a period, which a jump takes


@dataclass(frozen=True)
class GapFactor:
    """Voltage of Eq. 3 at air gaps, over that at the reference gap: of one drive, however large it is."""

    ratios: tuple[float, ...]
    """At :data:`~fingerpad.scene.drive.GAPS`; between them straight in the logarithm of the gap."""

    def __call__(self, gap: ArrayLike) -> Array:
        """Return the factor at air gaps (m), of their shape."""
        return np.asarray(np.interp(np.log(np.asarray(gap, dtype=float)), np.log(GAPS), self.ratios))

    def toward(self, other: "GapFactor", part: float) -> "GapFactor":
        """Return the factor at a part of the way to another one, from 0 to 1."""
        return GapFactor(tuple((1 - part) * a + part * b for a, b in zip(self.ratios, other.ratios, strict=True)))


EQUAL = GapFactor((1.0,) * len(GAPS))
"""That of a voltage without losses: 1 at every gap."""


def gap_factor(scene: Scene) -> GapFactor | None:
    """Return the factor of each gap; None where the voltage does not depend on it.

    Raises:
        SceneError: several drives, or a drive and a constant voltage, behind a circuit with losses.
    """
    drives, d_sc = scene.drives(), scene.geometry.sc_thickness
    if not drives or scene.electric.circuit(d_sc).lossless:
        return None
    levels = [f"history[{k}].voltage" for k, load in enumerate(scene.history or ()) if load.level]
    if levels or len(set(drives.values())) > 1:
        one, other = [*drives, *levels][:2]
        raise SceneError(
            f"{one} and {other} are two voltages in a circuit with losses, where each ridge has the share of one "
            "drive; give one drive and 0 V"
        )
    drive = drive_of(next(iter(drives.values())), scene.electric, d_sc)
    # drives that differ in their amplitude alone have one factor, but for roundoff
    return GapFactor(tuple(float(f"{ratio:.12g}") for ratio in drive.effective(GAPS) / drive.reference))


def loads(scene: Scene) -> tuple[Load, ...]:
    """Return the loads of a scene with the voltages that the full model follows.

    Raises:
        SceneError: a drive has too many periods in its load.
    """
    found = list(scene.loads())
    for k, (key, load, way) in enumerate(ways(found)):
        wave, mean = load.drive, scene.electric.follows == "mean"
        if wave is None:
            continue
        drive = drive_of(wave, scene.electric, scene.geometry.sc_thickness)
        if not mean and drive.circuit.lossless and wave.carrier is None:
            continue
        seconds = load.seconds(way or 0.0)
        times, volts = ([0.0, seconds], 2 * [drive.reference]) if mean else _over_time(drive, seconds)
        if len(times) > POINTS:
            raise SceneError(
                f"{key}.voltage has {seconds / wave.period:.4g} periods in {seconds:g} s, which need {len(times)} "
                f"points and at most {POINTS} are possible; take a shorter load, or electric.follows = 'mean'"
            )
        found[k] = load.model_copy(update={"voltage": _table(times, volts, wave.period)})
    return tuple(found)


def _over_time(drive: Drive, seconds: float) -> tuple[Array, Array]:
    """Return times (s) of a load and the voltage (V) of Eq. 3 at the reference gap, straight between them.

    Args:
        drive: the drive.
        seconds: length of the load (s).
    """
    wave = drive.wave
    factor = (drive.h_0 + REFERENCE) / REFERENCE
    count = int(np.clip(POINTS / max(seconds * (wave.frequency or 0.0), 1.0), _FEWEST_POINTS, _MOST_POINTS))
    if wave.carrier is None and drive.circuit.dielectric.debye() is not None:
        t, u = (np.array(each) for each in zip(*wave.samples(seconds, 24 / count), strict=True))
        network = Network.of(drive.circuit, REFERENCE, *drive.layers)
        return t, factor * network.response(t, u)
    square = (factor * drive.across(REFERENCE)) ** 2
    if wave.carrier is not None:
        carried = round(wave.carrier.frequency * wave.period)
        spectrum = np.fft.rfft(square)  # the mean over one period of the carrier around each instant
        square = np.fft.irfft(spectrum * np.sinc(np.arange(len(spectrum)) / carried), len(square))
    periods = round(wave.period * (wave.frequency or 1 / wave.period))
    n = min(count * periods, len(square))
    t = np.arange(int(np.ceil(seconds / wave.period * n)) + 1) / n * wave.period
    t[-1] = seconds
    place = t / wave.period % 1.0 * len(square)
    found = np.interp(place, np.arange(len(square) + 1), np.append(square, square[0]))
    return t, np.sqrt(np.maximum(found, 0.0))


def _table(times: ArrayLike, volts: ArrayLike, period: float) -> CarriedWaveform:
    """Return a waveform of a table; jumps take a short time."""
    given: Array = np.asarray(times, dtype=np.float64)
    t = [float(each) for each in given]
    for k in range(1, len(t)):
        if given[k] - given[k - 1] < _JUMP * period:
            t[k] = t[k - 1] + _JUMP * period
    with computed():
        return VoltageWaveform(waveform="file", times=tuple(t), values=tuple(map(float, np.asarray(volts))))
