"""Pacinian afferents (PC, RA-II) as one population, from the stress at one depth.

Their fields cover the fingertip, so one unit stands for all and answers to the mean over the sites. It has the filter
of its class (:class:`fingerpad.afferents.linear.RateUnit`) and one gain, that of a flat pin on the skin
(:data:`fingerpad.afferents.linear.INDENTATION`), which is relative.

A vibration a little above the threshold gives one spike a cycle, one below it none:

>>> import numpy as np
>>> from fingerpad.afferents.linear import threshold
>>> time = 1e-4 * np.arange(20001)
>>> for f in (100, 200, 250):
...     stress = np.sin(2 * np.pi * f * time) * threshold("PC", f) / PC().gain
...     print(f, [int((PC().spikes(part * stress, 1e-4) > 1).sum()) for part in (0.98, 1.02)])
100 [0, 100]
200 [0, 200]
250 [0, 250]
"""

from dataclasses import dataclass

from fingerpad.afferents.afferent import Array, History, check_keys
from fingerpad.afferents.linear import FILTERS, INDENTATION, RateUnit


@dataclass(frozen=True)
class PC(RateUnit):
    """The population of Pacinian afferents."""

    gain: float = INDENTATION["PC"]
    """Displacement (m) for a stress of 1 Pa."""
    name, site, longest_step, population = "PC", "pacinian", 0.25 / FILTERS["PC"].high, True
    per_volt, off = 300.0, 0.11

    def __post_init__(self) -> None:
        """Refuse a gain that is not greater than 0."""
        check_keys(self)

    def stimulus(self, history: History) -> Array:
        """Return the mean compressive stress over the sites (Pa), shape (1, samples)."""
        return history.stress.mean(axis=0, keepdims=True)
