"""Rapidly adapting units of type I (RA-I, FA-I), from a stress or a strain of the surface at a Meissner site.

The filter of the class has no static part: the unit answers to the rate of what it is given
(:class:`fingerpad.afferents.linear.RateUnit`). That is the compressive stress, taken as the indentation of a flat pin
with the same stress at the depth of the receptor (:data:`fingerpad.afferents.linear.INDENTATION`); or the compression
of the surface along the skin, taken as the shortening of one ridge. Afferents at the onset of slip follow the rate of
compressive strain of the surface, and compression more than stretch: Delhaye, Jarocka, Barrea, Thonnard, Edin, Lefèvre
(2021), doi 10.7554/eLife.64679, of which the abstract was read. Both gains are relative.

A vibration a little above the threshold gives one spike a cycle, one below it none:

>>> import numpy as np
>>> from fingerpad.afferents.linear import threshold
>>> time = 1e-4 * np.arange(20001)
>>> for f in (20, 40, 80):
...     stress = np.sin(2 * np.pi * f * time) * threshold("RA", f) / RA1().gain
...     print(f, [int((RA1().spikes(part * stress, 1e-4) > 1).sum()) for part in (0.98, 1.02)])
20 [0, 20]
40 [0, 40]
80 [0, 80]

A ramp in 100 ms to 20 kPa that is held gives spikes in the ramp alone; number, first and last (ms):

>>> spikes = RA1().spikes(np.interp(time, [0.1, 0.2], [0, 20e3]), 1e-4)
>>> print(len(spikes), (1e3 * spikes[[0, -1]]).round())
9 [101. 194.]
"""

from dataclasses import dataclass
from typing import Literal

from fingerpad.afferents.afferent import Array, History, check_keys
from fingerpad.afferents.linear import FILTERS, INDENTATION, RateUnit

RIDGE = 483e-6
"""Width of a ridge (m) of the default finger."""


@dataclass(frozen=True)
class RA1(RateUnit):
    """A rapidly adapting unit of type I."""

    input: Literal["stress", "strain"] = "stress"
    """Compressive stress (Pa), or compression of the surface along the skin."""
    gain: float = 0.0
    """Displacement (m) for a stress of 1 Pa or a compression of 1; 0 for that of the pin or the width of a ridge."""
    name, site, longest_step = "RA1", "meissner", 0.25 / FILTERS["RA1"].high
    per_volt, off = 200.0, 0.0151

    def __post_init__(self) -> None:
        """Take the gain of the input where none is given; refuse another input, and a gain that is negative."""
        if self.gain == 0:
            gain = INDENTATION[self.name] if self.input == "stress" else RIDGE
            object.__setattr__(self, "gain", gain)
        check_keys(self, ("stress", "strain"))

    def stimulus(self, history: History) -> Array:
        """Return the compressive stress (Pa), or the compression of the surface."""
        return history.stress if self.input == "stress" else -history.strain
