r"""Spikes from a potential: one where it passes the threshold, more at a rate that goes with what is above it.

.. math:: V = A_s (\langle q \rangle + c \langle -q \rangle), \qquad f = K_f \min(V - V_{th}, V_{most})

with the output q of the linear filter of the class (:mod:`fingerpad.afferents.linear`). While V is above V_th = 15 mV
a unit fires at the rate f; the first spike is that of passing it. So a vibration just above the threshold gives one
spike a cycle. Without noise.

Ouyang, Wu, Shao, Wu, Cao (2019), doi 10.3389/fninf.2019.00027: its public implementation has c, K_f and V_most, and
samples V every 4 ms, which is left out here. The displacement of the skin is found from a stress or a strain by one
gain a class, so thresholds in Pa are relative.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from fingerpad.afferents.afferent import Afferent, Array
from fingerpad.afferents.linear import FILTERS, V_TH

V_MOST = 0.999
"""Potential (V) beyond the threshold at which the rate is at its largest."""


class RateUnit(Afferent):
    """A unit of a linear filter whose rate goes with the potential.

    Attributes:
        gain: displacement of the skin (m) that stands for a stimulus of 1.
        per_volt: K_f, rate over the potential (1/(s V)).
        off: c, weight of the filter's negative output.
    """

    gain: float
    per_volt: ClassVar[float]
    off: ClassVar[float]

    def fire(self, stimulus: Array) -> NDArray[np.bool_]:
        """Return whether each unit fires at each sample."""
        v = FILTERS[self.name].potential(self.gain * stimulus, self.step)
        v = np.where(v > 0, v, -self.off * v)
        above = v > V_TH
        begins = above & ~np.roll(above, 1, axis=1)
        begins[:, 0] = False
        step = self.per_volt * self.step * np.clip(v - V_TH, 0, V_MOST)
        phase = np.cumsum(step, axis=1)
        since = phase - np.maximum.accumulate(np.where(begins, phase, 0), axis=1)
        count = np.where(above, 1 + np.floor(since), 0)
        return np.asarray(np.diff(count, axis=1, prepend=count[:, :1]) > 0)
