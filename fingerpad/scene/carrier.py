r"""A voltage over time, which may be the envelope of a carrier.

With a carrier the wave is the envelope of a sine of higher frequency, with the depth m of ``modulation``, so that the
amplitude is that of the peak:

.. math:: U(t) = U_0 + \hat U \, \frac{1 + m \, w(f t)}{1 + m} \sin 2 \pi f_c t
"""

from itertools import pairwise
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from fingerpad.scene.messages import show
from fingerpad.scene.waveform import Frequency, Waveform, shape
from geometry.units import Finite, Table, within

Array = NDArray[np.float64]
_MOST_CARRIED = 2000.0  # periods of a carrier in one of the wave and its burst


class Carrier(Table):
    """A sine of higher frequency, of which the wave is the envelope."""

    frequency: Frequency
    """Frequency of the carrier (Hz), above that of the wave. It is taken at the nearest multiple of the frequency with
    which the drive repeats itself."""
    modulation: Annotated[Finite, within(1e-3, 1)] | None = None
    """Depth m of the modulation, from none to 1, the default: an envelope that closes. Not for a file, whose voltages
    have their carrier in them."""

    @property
    def depth(self) -> float:
        """Depth m of the modulation."""
        return self.modulation or 1.0


class CarriedWaveform(Waveform):
    """A voltage over time, in place of a number; see :mod:`fingerpad.scene.waveform`."""

    carrier: Carrier | None = None
    """A sine of higher frequency, of which the wave is the envelope; see :mod:`fingerpad.scene.carrier`."""

    @model_validator(mode="after")
    def _consistent_carrier(self) -> "CarriedWaveform":
        if self.carrier is None:
            return self
        frequency = self.carrier.frequency
        if self.times is not None:
            self._refuse_carrier_of_file(self.carrier)
        elif frequency <= (self.frequency or 0.0):
            both = f"carrier.frequency is {show(frequency)} Hz and frequency is {show(self.frequency)} Hz"
            raise ValueError(f"{both}; the carrier must have the higher one")
        elif (periods := frequency * self.period) > _MOST_CARRIED:
            words = f"carrier.frequency is {show(frequency)} Hz, {periods:.4g} periods in one of the drive"
            raise ValueError(f"{words}; there must be at most {_MOST_CARRIED:g}")
        return self

    def _refuse_carrier_of_file(self, carrier: Carrier) -> None:
        if carrier.modulation is not None:
            raise ValueError(
                f"carrier.modulation is {show(carrier.modulation)} and waveform is 'file', whose voltages have their "
                "carrier in them; leave it out"
            )
        step = max(after - before for before, after in pairwise(self.times or ()))
        if step * carrier.frequency > 0.5:
            raise ValueError(
                f"carrier.frequency is {show(carrier.frequency)} Hz and the file has times {step:.4g} s apart; they "
                f"must be at most {0.5 / carrier.frequency:.4g} s apart, two in a period (Nyquist)"
            )

    def _square_mean(self) -> float:
        mean = super()._square_mean()
        if self.carrier is None:
            return mean
        return (1 + self.carrier.depth**2 * mean) / (1 + self.carrier.depth) ** 2 / 2

    def _carried(self, found: Array, part: Array, parts: float) -> Array:
        if self.carrier is None:
            return found
        carried, depth = part * round(self.carrier.frequency * self.period), self.carrier.depth
        return (1 + depth * found) / (1 + depth) * shape("sine", carried, parts)

    def _carried_in_words(self) -> str:
        return "" if self.carrier is None else f" on a carrier of {self.carrier.frequency:g} Hz"
