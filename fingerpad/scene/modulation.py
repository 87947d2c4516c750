r"""Waves of amplitude 1, what modulates them, a carrier or bursts, and how large the modulated wave is.

With a carrier the wave is the envelope of a sine of higher frequency, with the depth m of ``modulation``:

.. math:: U(t) = U_0 + \hat U \, \frac{1 + m \, w(f t)}{1 + m} \sin 2 \pi f_c t

so that the amplitude is that of the peak. The attraction goes with the square: it follows the envelope, at f, and has
twice the carrier's frequency. A burst is a number of whole periods of the wave, and a pause at the offset.
"""

from typing import Annotated, Any

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import ArrayLike, NDArray
from pydantic import Strict

from fingerpad.scene.messages import show
from geometry.units import Finite, Table, within

HIGHEST = 1e6  # Hz
SQUARE_MEAN = {"sine": 0.5, "square": 1.0, "triangle": 1 / 3}
"""Mean square of each wave of amplitude 1."""
FASTEST_CARRIER = 2000.0
"""Largest number of a carrier's periods in one of the wave and its burst, of which samples are taken."""
_Count = Annotated[int, Strict(), Ge(1), Le(500)]


def shape(waveform: str, part: ArrayLike, parts: float = 1.0) -> NDArray[np.float64]:
    """Return a wave of amplitude 1, at a jump the value behind it; its quarters are the same to the last bit.

    Args:
        waveform: a name of :data:`SQUARE_MEAN`.
        part: place in time, in parts of the period.
        parts: of a period.
    """
    quarter, rest = np.divmod(part, parts / 4)
    rise = np.where(quarter % 2 == 0, rest, parts / 4 - rest) / (parts / 4)
    size = {"sine": np.sin(np.pi / 2 * rise), "square": np.ones_like(rise), "triangle": rise}[waveform]
    return np.where(quarter % 4 < 2, size, -size)


class Carrier(Table):
    """A sine of higher frequency, of which the wave is the envelope."""

    frequency: Annotated[Finite, within(1e-3, HIGHEST, "Hz")]
    """Frequency of the carrier (Hz), above that of the wave. It is taken at the nearest multiple of the frequency with
    which the drive repeats itself."""
    modulation: Annotated[Finite, within(1e-3, 1)] | None = None
    """Depth m of the modulation, from none to 1, the default: an envelope that closes. Not for a file, whose voltages
    have their carrier in them."""


class Burst(Table):
    """Whole periods of the wave, and a pause at the offset."""

    on: _Count
    """Number of periods of the wave."""
    off: _Count
    """Length of the pause, in periods of the wave."""


def refuse_carrier(wave: Any) -> None:
    """Refuse a carrier that is none of the wave.

    Args:
        wave: a waveform with a carrier.

    Raises:
        ValueError: in one sentence, with the waveform's keys.
    """
    carrier: Carrier = wave.carrier
    if wave.times is not None:
        if carrier.modulation is not None:
            raise ValueError(
                f"carrier.modulation is {show(carrier.modulation)} and waveform is 'file', whose voltages have their "
                "carrier in them; leave it out"
            )
        step = max(after - before for before, after in zip(wave.times, wave.times[1:], strict=False))
        if step * carrier.frequency > 0.5:
            raise ValueError(
                f"carrier.frequency is {show(carrier.frequency)} Hz and the file has times {step:.4g} s apart; they "
                f"must be at most {0.5 / carrier.frequency:.4g} s apart, two in a period (Nyquist)"
            )
        return
    if carrier.frequency <= wave.frequency:
        raise ValueError(
            f"carrier.frequency is {show(carrier.frequency)} Hz and frequency is {show(wave.frequency)} Hz; the "
            "carrier must have the higher one"
        )
    if carrier.frequency * wave.period > FASTEST_CARRIER:
        raise ValueError(
            f"carrier.frequency is {show(carrier.frequency)} Hz, {carrier.frequency * wave.period:.4g} periods in one "
            f"of the drive; there must be at most {FASTEST_CARRIER:g}"
        )


def square_mean(waveform: str, carrier: Carrier | None) -> float:
    """Return the mean square of a wave of amplitude 1, without offset and pauses."""
    mean = SQUARE_MEAN[waveform]
    if carrier is None:
        return mean
    depth = 1.0 if carrier.modulation is None else carrier.modulation
    return (1 + depth**2 * mean) / (1 + depth) ** 2 / 2
