r"""A filtered integrate-and-fire unit, whose thirteen parameters are those of a user's own file.

The stress s at the receptor (MPa, positive in compression) and a dynamic input d pass a causal Butterworth low-pass of
order 3 with the cut-off 10 p0 Hz. With a_n = d_{n+1} - d_n and samples 0.2 ms apart,

.. math:: I = p_1 \langle s\rangle + p_2 \langle -s\rangle + p_3 \langle d\rangle + p_4 \langle -d\rangle
    + p_5 \langle a\rangle + p_6 \langle -a\rangle, \qquad I \leftarrow \frac{p_7 I}{p_7 + |I|} \text{ if } p_7 > 0,

.. math:: V_n = V_{n-1} - V_{n-1} / p_9 + I_n + h_k

with the current h_k = p10 b1(k) + p11 b2(k), k samples after the last spike. A unit fires where V > 1 more than 5
samples after the last spike; V is then 0. p8 is the size of the noise, off by default; the delay p12 is left out.
Saal, Delhaye, Rayhaun, Bensmaia (2017), doi 10.1073/pnas.1704856114.

d of a pin is (dP/dt) / (2 a z^2), far from it (pi / 3 a) ds/dt: the gain here. Thresholds are up to 30 times too high.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fingerpad.afferents.afferent import Afferent, Array, History
from fingerpad.afferents.pin import RADIUS

_MPA, _PER_MM = 1e-6, 1e-3  # over Pa, over 1/m
_SAMPLES, _SILENT = 190, 5  # of the current after a spike; samples after it without another


def _after_spike() -> Array:
    """Return the two parts b1 and b2 of the current after a spike, shape (2, samples)."""
    k, slope = np.arange(_SAMPLES), 0.75 * np.pi / np.log(3)
    first = np.minimum(np.pi, slope * np.log((k + 5) / 5))
    second = np.clip(slope * np.log((k + 5) / 45), -np.pi, np.pi)
    return np.asarray((1 + np.cos([first, second])) / 2)


@dataclass(frozen=True)
class FilteredUnit(Afferent):
    """A unit of thirteen parameters; see :func:`fingerpad.afferents.unit_files.read_units`."""

    parameters: tuple[float, ...]
    site: str = "merkel"  # type: ignore[misc]
    dynamic_gain: float = np.pi / (3 * RADIUS)  # 1/m, dynamic input over the rate of the stress
    noise: int | None = None  # seed of the noise; None without noise
    name, step, longest_step = "FilteredUnit", 2e-4, 2.5e-3

    def stimulus(self, history: History) -> Array:
        """Return the compressive stress (Pa)."""
        return history.stress

    def current(self, stress: Array) -> Array:
        """Return the current of each sample but that after a spike, shape (units, samples)."""
        import scipy.signal

        p = self.parameters
        b = scipy.signal.butter(3, 10 * p[0], fs=1 / self.step)
        given = (stress - stress[:, :1], _PER_MM * self.dynamic_gain * np.gradient(stress, self.step, axis=1))
        s, d = (scipy.signal.lfilter(*b, _MPA * each, axis=1) for each in given)
        s += _MPA * stress[:, :1]
        a = np.diff(d, axis=1, append=d[:, -1:])
        parts = [part for each in (s, d, a) for part in (np.maximum(each, 0), np.maximum(-each, 0))]
        found = sum(weight * part for weight, part in zip(p[1:7], parts, strict=True))
        if self.noise is not None:
            found = found + p[8] * np.random.default_rng(self.noise).standard_normal(stress.shape)
        return np.asarray(p[7] * found / (p[7] + np.abs(found)) if p[7] > 0 else found)

    def fire(self, stimulus: Array) -> NDArray[np.bool_]:
        """Return whether each unit fires at each sample."""
        currents = np.ascontiguousarray(self.current(stimulus).T)
        after = np.append(np.array(self.parameters[10:12]) @ _after_spike(), 0.0)
        fired, since = np.zeros(currents.shape, bool), np.full(len(stimulus), _SAMPLES)
        steady = self.parameters[9] * replace(self, noise=None).current(stimulus[:, [0, 0]])[:, 0]
        v = steady * (steady <= 1)  # just after a spike where it fires steadily
        for n in range(len(currents) - 1):  # a spike in this sample is at its end
            v += currents[n] + after[since] - v / self.parameters[9]
            since = np.minimum(since + 1, _SAMPLES)
            fired[n + 1] = (v > 1) & (since > _SILENT)
            v[fired[n + 1]], since[fired[n + 1]] = 0.0, 0
        return fired.T
