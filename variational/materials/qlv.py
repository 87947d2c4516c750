r"""Branches of a relaxation: parts of the modulus at once, and the times in which they relax.

.. math:: G(t) / G(0) = 1 - \sum_i g_i (1 - e^{-t / \tau_i}), \qquad
          \frac{G' + i G''}{G(0)} = 1 - \sum_i g_i + \sum_i g_i \frac{i \omega \tau_i}{1 + i \omega \tau_i}

A branch's weight over the long-time modulus is :math:`\beta_i = g_i / (1 - \sum_j g_j)`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class QLV:
    """Relaxation of the isochoric stress as a sum of exponentials."""

    moduli: tuple[float, ...]
    """Part of the modulus at once that each branch relaxes; below 1 in all."""
    times: tuple[float, ...]
    """Time (s) of each branch."""

    def __init__(self, moduli: Any, times: Any) -> None:
        """Take moduli and times, one each a branch.

        Raises:
            ValueError: there are none, or not as many of one as of the other; a modulus or a time that is not finite
                and positive; moduli that sum to 1 or more. In one sentence.
        """
        try:
            found = {name: tuple(map(float, each)) for name, each in (("moduli", moduli), ("times", times))}
        except (TypeError, ValueError):
            raise ValueError("moduli and times must be two lists of numbers, one of each for a branch") from None
        if not found["moduli"] or len(found["moduli"]) != len(found["times"]):
            raise ValueError(
                f"moduli has {len(found['moduli'])} entries and times {len(found['times'])}; there must be one of each "
                "for a branch, and at least one branch"
            )
        for name, values in found.items():
            for value in values:
                if not (np.isfinite(value) and value > 0):
                    raise ValueError(f"{name} has {value:g}; it must be finite and greater than 0")
            object.__setattr__(self, name, values)
        if not sum(self.moduli) < 1:
            raise ValueError(
                f"moduli sum to {sum(self.moduli):g}; they are parts of the modulus at once, so their sum must be "
                "below 1, or nothing of the material would last"
            )

    @property
    def weights(self) -> tuple[float, ...]:
        """Weight beta of each branch, over the long-time modulus."""
        left = 1 - sum(self.moduli)
        return tuple(g / left for g in self.moduli)

    def relaxation(self, t: Any) -> Array:
        """Return G(t) / G(0), the part of the stress that is left at times t (s) after a step of strain."""
        t = np.asarray(t, dtype=float)
        return np.asarray(
            1 - sum(g * -np.expm1(-t / tau) for g, tau in zip(self.moduli, self.times, strict=True)), dtype=float
        )

    def complex_modulus(self, frequency: Any) -> NDArray[np.complex128]:
        """Return (G' + i G'') / G(0) at frequencies (Hz)."""
        w = 2j * np.pi * np.asarray(frequency, dtype=float)
        branches = zip(self.moduli, self.times, strict=True)
        return np.asarray(1 - sum(self.moduli) + sum(g * w * tau / (1 + w * tau) for g, tau in branches))
