r"""A linear filter for each class of afferents, from the displacement of the skin to a potential, in closed form.

.. math:: H(s) = \frac{\sum_{i \le N} K_i s^i}{s + \omega_l} \Big[\frac{\omega_h}{s + \omega_h}\Big]^{N+1}
    + K_u \frac{\omega}{s + \omega}, \qquad A(f) = \frac{V_{th}}{A_s |H(2 \pi i f)|}

with V_th = 15 mV. A is the amplitude of a displacement at the threshold. Ouyang, Wu, Shao, Chen, Bisley (2021), doi
10.1109/TBME.2020.3007397; the constants are those of a public implementation of its authors.

Thresholds (µm) at 10, 40, 100 and 250 Hz:

>>> for name in FILTERS:
...     print(name, [float(f"{1e6 * threshold(name, f):.4g}") for f in (10, 40, 100, 250)])
SA1 [24.38, 46.95, 58.98, 111.0]
RA1 [6.995, 1.05, 0.8262, 2.524]
PC [36.87, 1.289, 0.1744, 0.08364]
"""

import reprlib
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fingerpad.afferents.afferent import Afferent, Array

V_TH = 15e-3
"""Potential (V) at the threshold."""
V_MOST = 0.999
"""Potential (V) beyond the threshold at which the rate is at its largest."""
ALIASES = {"SA": "SA1", "RA": "RA1"}
"""Further names of classes."""

INDENTATION = {"RA1": 7.706184900877857e-08, "PC": 1.0149760880828562e-07}
r"""Indentation (m) of a flat pin of radius a = 1 mm for a stress of 1 Pa at the depth z of a class.

.. math:: \sigma = \frac{E y}{\pi a (1 - \nu^2)} \, \frac{1 + 3 (z/a)^2}{(1 + (z/a)^2)^2}

on the axis, I. N. Sneddon (1946), Proc. Camb. Phil. Soc. 42, 29, with E = 0.05 MPa, nu = 0.4, and z of 1.6 and 2 mm,
which were fitted by Saal et al. (2017), doi 10.1073/pnas.1704856114, and are no anatomy.
"""


@dataclass(frozen=True)
class _LinearFilter:
    """The filter of a class."""

    k: tuple[float, ...]
    low: float
    """Frequency (Hz) of omega_l."""
    high: float
    """Frequency (Hz) of omega_h."""
    gain: float
    """A_s (V/m)."""
    k_u: float = 0.0
    f_u: float = 0.0
    """Frequency (Hz) of omega, where K_u is not 0."""

    def threshold(self, frequency: ArrayLike) -> Any:
        """Return the amplitude of a displacement (m) at the threshold, at a frequency (Hz)."""
        s = 2j * np.pi * np.asarray(frequency, dtype=float)
        low, high, static = (2 * np.pi * f for f in (self.low, self.high, self.f_u))
        band = sum(k * s ** (i + 1) for i, k in enumerate(self.k)) / (s + low)
        response = band * (high / (s + high)) ** (len(self.k) + 1)
        response += self.k_u * static / (s + static) if self.k_u else 0
        return V_TH / (self.gain * np.abs(response))

    def potential(self, displacement: Array, dt: float) -> Array:
        """Return the potential (V) under displacements (m) at equal times, shape (…, samples); by Tustin's rule."""
        import scipy.signal

        low, high, static = (2 * np.pi * f for f in (self.low, self.high, self.f_u))
        zeros = np.roots([*self.k[::-1], 0.0])  # of the highest power that is not 0
        lead = next(k for k in self.k[::-1] if k)
        poles = [-low, *[-high] * (len(self.k) + 1)]
        band = scipy.signal.bilinear_zpk(zeros, poles, lead * high ** (len(self.k) + 1), 1 / dt)
        start = displacement[..., :1]
        found = scipy.signal.sosfilt(scipy.signal.zpk2sos(*band), displacement - start, axis=-1)
        if self.k_u:
            one = scipy.signal.bilinear_zpk([], [-static], self.k_u * static, 1 / dt)
            found = found + scipy.signal.sosfilt(scipy.signal.zpk2sos(*one), displacement - start, axis=-1)
        return np.asarray(self.gain * (found + self.k_u * start))


FILTERS = {
    "SA1": _LinearFilter((0.205,), 8, 10, 3800, 0.096, 100),
    "RA1": _LinearFilter((0.2316, 0.00312), 60, 80, 44000),
    "PC": _LinearFilter((0.0, 0.12782, 0.00111), 80, 220, 360),
}


class RateUnit(Afferent):
    r"""A unit that fires where its potential V passes the threshold, and above it at the rate f.

    .. math:: V = A_s (\langle q \rangle + c \langle -q \rangle), \qquad f = K_f \min(V - V_{th}, V_{most})

    with the output q of the linear filter of its class. So a vibration just above the threshold gives one spike a
    cycle. Without noise. Ouyang, Wu, Shao, Wu, Cao (2019), doi 10.3389/fninf.2019.00027: its public implementation has
    c, K_f and V_most, and samples V every 4 ms, which is left out here. One gain a class turns a stress or a strain
    into a displacement of the skin, so thresholds in Pa are relative.

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
        phase = np.cumsum(self.per_volt * self.step * np.clip(v - V_TH, 0, V_MOST), axis=1)
        since = phase - np.maximum.accumulate(np.where(begins, phase, 0), axis=1)
        count = np.where(above, 1 + np.floor(since), 0)
        return np.asarray(np.diff(count, axis=1, prepend=count[:, :1]) > 0)


def threshold(name: str, frequency: ArrayLike) -> Any:
    """Return the amplitude of the skin's displacement (m) at the threshold of a class, by its linear filter.

    Args:
        name: ``"SA1"``, ``"RA1"`` or ``"PC"``; ``"SA"`` and ``"RA"`` are the first two.
        frequency: of the displacement (Hz), of any shape.

    Raises:
        ValueError: there is no such class, or a frequency is not greater than 0.
    """
    known = ALIASES.get(name, name) if isinstance(name, str) else name
    if not (isinstance(known, str) and known in FILTERS):
        raise ValueError(f"the class is {reprlib.repr(name)}; it must be {' or '.join(map(repr, FILTERS))}")
    try:
        f = np.asarray(frequency, dtype=float)
    except (TypeError, ValueError):
        f = np.array(np.nan)
    if not ((f > 0) & np.isfinite(f)).all():
        raise ValueError(f"the frequency is {reprlib.repr(frequency)}; it must be greater than 0 Hz")
    found = FILTERS[known].threshold(f)
    return found if f.ndim else float(found)
