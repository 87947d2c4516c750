r"""Slowly adapting units of type I (SA-I), from the compressive stress at a Merkel site.

The stress drives a current (pA) of four branches, clipped at 0 and added; three decay and one stays:

.. math:: I = \sum_i \Big\langle k_i \int e^{-(t-t')/\tau_i} \, d\sigma(t') \Big\rangle.

It charges heminodes of m = 8, 5, 3 and 1 Merkel cells, C dV/dt = m I - V / R, from the steady state of the first
stress. The first over 30 mV fires, and all are reset to 0. V is proportional to m: the largest is always the first, and
it alone is followed. Intervals are 1 ms at least. Without noise. In a step of 0.1 ms I is that at its end, V exact.

Lesniak et al. (2014), doi 10.7554/eLife.01488; Gerling et al. (2018), doi 10.1371/journal.pcbi.1006264: the mouse's
hairy skin; constants of a public implementation. Their skin relaxes: in an elastic one the unit adapts less.

A ramp from 100 to 200 ms to a stress that is then held, in kPa, number of spikes and first ones in ms:

>>> import numpy as np
>>> time = 1e-4 * np.arange(50001)
>>> for held in (5, 10, 20):
...     found = 1e3 * SA1().spikes(1e3 * np.interp(time, [0.1, 0.2], [0, held]), 1e-4)
...     print(held, len(found), found[:6].round(1))
5 1 [261.7]
10 6 [181.1 227.9 291.1 373.2 486.5 658.6]
20 33 [151.  176.7 197.2 218.5 244.  272.1]

At 20 kPa, the largest rate and that of the mean interval from 2.1 to 4.6 s (1/s):

>>> late = np.diff(found[(found > 2100) & (found < 4600)]).mean()
>>> print(f"{1e3 / np.diff(found).min():.1f} {1e3 / late:.1f}")
48.8 3.6
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fingerpad.afferents.afferent import Afferent, Array, History, check_keys

TAU, K = (8e-3, 0.2, 1.7446, np.inf), (0.74, 0.2088, 0.07, 0.0312)
CELLS, C, R, V_MOST = 8, 30e-12, 5e9, 30e-3
"""Decay times of the branches (s) and their currents over the stress (pA/kPa); Merkel cells of the largest heminode;
capacity (F), resistance (ohm) and threshold (V)."""
_LEAST, _PER_KPA = 1e-3, 1e-15  # s, interval; A/Pa of 1 pA/kPa


@dataclass(frozen=True)
class SA1(Afferent):
    """A slowly adapting unit of type I; its input is compressive stress, or strain energy density."""

    input: Literal["stress", "sed"] = "stress"
    gain: float = 1.0
    """Factor of the input, which is relative to the fit of the compressive stress in the mouse's skin."""
    name, site, longest_step = "SA1", "merkel", np.pi / 2 * TAU[0]

    def __post_init__(self) -> None:
        """Refuse another input, and a gain that is not greater than 0."""
        check_keys(self, ("stress", "sed"))

    def stimulus(self, history: History) -> Array:
        """Return the compressive stress or the strain energy density (Pa)."""
        return history.stress if self.input == "stress" else history.sed

    def fire(self, stimulus: Array) -> NDArray[np.bool_]:
        """Return whether each unit fires at each sample."""
        import scipy.signal

        stress = self.gain * stimulus
        change = np.diff(stress, axis=1, prepend=stress[:, :1])
        current = K[-1] * np.maximum(stress, 0)
        for tau, k in zip(TAU[:-1], K[:-1], strict=True):
            current += k * np.maximum(scipy.signal.lfilter([1], [1, -np.exp(-self.step / tau)], change), 0)
        decay, wait = np.exp(-self.step / (R * C)), round(_LEAST / self.step)
        charge = np.ascontiguousarray((1 - decay) * R * CELLS * _PER_KPA * current.T)
        fired, v = np.zeros(charge.shape, bool), (steady := charge[0] / (1 - decay)) * (steady <= V_MOST)
        for n in range(1, len(charge)):
            v = decay * v + charge[n]
            fired[n] = (v > V_MOST) & ~fired[max(n - wait + 1, 0) : n].any(axis=0)
            v[fired[n]] = 0
        return fired.T
