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

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fingerpad.afferents.afferent import Array
from fingerpad.scene.messages import SceneError, show

V_TH = 15e-3
"""Potential (V) at the threshold."""
ALIASES = {"SA": "SA1", "RA": "RA1"}
"""Further names of classes."""


@dataclass(frozen=True)
class LinearFilter:
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
    "SA1": LinearFilter((0.205,), 8, 10, 3800, 0.096, 100),
    "RA1": LinearFilter((0.2316, 0.00312), 60, 80, 44000),
    "PC": LinearFilter((0.0, 0.12782, 0.00111), 80, 220, 360),
}


def threshold(name: str, frequency: ArrayLike) -> Any:
    """Return the amplitude of the skin's displacement (m) at the threshold of a class, by its linear filter.

    Args:
        name: ``"SA1"``, ``"RA1"`` or ``"PC"``; ``"SA"`` and ``"RA"`` are the first two.
        frequency: of the displacement (Hz), of any shape.

    Raises:
        SceneError: there is no such class, or a frequency is not greater than 0.
    """
    known = ALIASES.get(name, name) if isinstance(name, str) else name
    if not (isinstance(known, str) and known in FILTERS):
        raise SceneError(f"the class is {show(name)}; it must be {' or '.join(map(repr, FILTERS))}")
    try:
        f = np.asarray(frequency, dtype=float)
    except (TypeError, ValueError):
        f = np.array(np.nan)
    if not ((f > 0) & np.isfinite(f)).all():
        raise SceneError(f"the frequency is {show(frequency)}; it must be greater than 0 Hz")
    found = FILTERS[known].threshold(f)
    return found if f.ndim else float(found)
