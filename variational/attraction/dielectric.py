r"""Dielectrics between finger and electrode: stratum corneum that conducts, by Cole–Cole terms or a measured table.

.. math:: \tilde\varepsilon = \varepsilon_\infty + \sum_k \frac{\Delta_k}{1 + (i \omega \tau_k)^{1 - \alpha_k}}
          + \frac{\sigma}{i \omega \varepsilon_0}, \qquad \kappa = i \omega \varepsilon_0 \tilde\varepsilon

The complex conductivity :math:`\kappa` (S/m) is finite at every frequency. Form and constants: S. Gabriel, R. W. Lau
and C. Gabriel 1996, Phys. Med. Biol. 41, 2271, doi 10.1088/0031-9155/41/11/003. They are of skin of the forearm and of
whole skin, dry and wetted; the stratum corneum of a fingertip was not among the samples. *Assumption*: it has the same.

**In time.** A term with :math:`\alpha \ne 0` is of fractional order. It is the same as a continuous spectrum of Debye
terms (K. S. Cole and R. H. Cole 1941, J. Chem. Phys. 9, 341, doi 10.1063/1.1750906), with :math:`s = \ln \tau' / \tau`:

.. math:: \frac{1}{1 + (i \omega \tau)^{1 - \alpha}} = \int_{-\infty}^\infty
          \frac{\sin \alpha \pi}{2 \pi (\cosh((1 - \alpha) s) - \cos \alpha \pi)} \; \frac{ds}{1 + i \omega \tau e^s}

The integrand is analytic for :math:`|\mathrm{Im}\, s| < d`, the smaller of :math:`\alpha \pi / (1 - \alpha)` and
:math:`\pi / 2`. The trapezoidal rule of step h therefore errs by some :math:`e^{-2 \pi d / h}` (L. N. Trefethen and
J. A. C. Weideman 2014, SIAM Rev. 56, 385, doi 10.1137/130932132), and the ends that are cut off by
:math:`e^{-(1 - \alpha) |s|}`. :meth:`ColeCole.debye` chooses both so that each is 1e-9 of the term.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Complex = NDArray[np.complex128]
Array = NDArray[np.float64]
_SPECTRUM_ERROR = 1e-9
"""Relative error of a fractional term by its sum of Debye terms, of the rule and of each end."""
_FASTEST = 1e-11  # s: a Debye term that relaxes faster counts as instantaneous, an error of 6e-5 of it at 1 MHz


VACUUM_PERMITTIVITY = 8.854e-12  # F/m, Table 3


def insulator_thickness(d_sc: float, eps_sc: float, d_i: float, eps_i: float) -> float:
    """Return h_0 (m), the effective insulator thickness of stratum corneum and screen coating, both lossless."""
    return d_sc / eps_sc + d_i / eps_i


class Debye(NamedTuple):
    """A tissue as a sum of Debye terms."""

    eps_inf: float
    """Instantaneous relative permittivity."""
    delta: Array
    """Strength of each term, shape (terms,)."""
    tau: Array
    """Relaxation time of each term (s), shape (terms,)."""
    sigma: float
    """Conductivity (S/m)."""


class Tissue(ABC):
    """A dielectric over the frequency."""

    @abstractmethod
    def conductivity(self, frequency: ArrayLike) -> Complex:
        """Return the complex conductivity kappa (S/m) at frequencies (Hz), 0 or more, of their shape."""

    def permittivity(self, frequency: ArrayLike) -> Complex:
        """Return the complex relative permittivity at frequencies (Hz) above 0, of their shape."""
        omega = 2 * np.pi * np.asarray(frequency, dtype=float)
        return np.asarray(self.conductivity(frequency) / (1j * omega * VACUUM_PERMITTIVITY))

    def refuse(self, frequency: ArrayLike) -> None:
        """Refuse a frequency (Hz) at which the tissue is not known, by ``ValueError``; by default none is."""
        return

    def debye(self) -> Debye | None:
        """Return the tissue as Debye terms, for a history in time; None where it has no equations in time."""
        return None


@dataclass(frozen=True)
class ColeCole(Tissue):
    """Cole–Cole terms and a conductivity; without terms a lossless dielectric."""

    eps_inf: float
    """Permittivity above all relaxations."""
    terms: tuple[tuple[float, float, float], ...] = ()
    """Strength, relaxation time (s) and exponent alpha of each term, alpha from 0 to below 1."""
    sigma: float = 0.0
    """Conductivity of ions (S/m)."""

    def conductivity(self, frequency: ArrayLike) -> Complex:
        """Return the complex conductivity kappa (S/m) at frequencies (Hz), of their shape."""
        s = 2j * np.pi * np.asarray(frequency, dtype=float)
        found = np.full(s.shape, self.eps_inf, dtype=complex)
        for delta, tau, alpha in self.terms:
            found += delta / (1 + (s * tau) ** (1 - alpha))
        return np.asarray(s * VACUUM_PERMITTIVITY * found + self.sigma)

    def debye(self) -> Debye:
        """Return the tissue as Debye terms, for a history in time; see the head of this module for their error."""
        spectra = [np.empty((2, 0)), *(_spectrum(*each) for each in self.terms)]
        strength, time = np.concatenate(spectra, axis=1)
        slow = time >= _FASTEST
        return Debye(self.eps_inf + float(strength[~slow].sum()), strength[slow], time[slow], self.sigma)


def _spectrum(delta: float, tau: float, alpha: float) -> Array:
    """Return strengths and times (s) of the Debye terms of a Cole–Cole term, shape (2, terms)."""
    if alpha == 0:
        return np.array([[delta], [tau]])
    beta, error = 1 - alpha, -np.log(_SPECTRUM_ERROR)
    step = 2 * np.pi * min(np.pi * alpha / beta, np.pi / 2) / error
    count = int(np.ceil(error / beta / step))
    s = step * np.arange(-count, count + 1)
    density = np.sin(alpha * np.pi) / (2 * np.pi * (np.cosh(beta * s) - np.cos(alpha * np.pi)))
    return np.array([delta * step * density, tau * np.exp(s)])


@dataclass(frozen=True)
class TabledTissue(Tissue):
    """A measured table, straight between its points over the logarithm of the frequency.

    Overtones of a drive beyond the table have its last values. They are small there; a drive's own frequency beyond the
    table is refused.
    """

    frequency: tuple[float, ...]
    """Frequencies (Hz), growing."""
    eps: tuple[float, ...]
    """Relative permittivity at each."""
    sigma: tuple[float, ...]
    """Conductivity at each (S/m)."""

    def __post_init__(self) -> None:
        """Refuse a table that is none.

        Raises:
            ValueError: in one sentence, which begins with the column.
        """
        for name in ("eps", "sigma"):
            if len(getattr(self, name)) != len(self.frequency):
                raise ValueError(
                    f"{name} has {len(getattr(self, name))} values and frequency has {len(self.frequency)}; each "
                    "frequency needs one"
                )
        if len(self.frequency) < 2:
            raise ValueError(f"frequency has {len(self.frequency)} values; there must be two at least")
        for before, after in zip(self.frequency, self.frequency[1:], strict=False):
            if not 0 < before < after < np.inf:
                raise ValueError(
                    f"frequency is {before:g} and then {after:g} Hz; each must be greater than 0 and than the one "
                    "before"
                )
        _refuse(self.eps, "eps", 1.0)
        _refuse(self.sigma, "sigma", 0.0)

    def refuse(self, frequency: ArrayLike) -> None:
        """Refuse a frequency (Hz) beyond the table.

        Raises:
            ValueError: in one sentence.
        """
        asked = np.ravel(np.asarray(frequency, dtype=float))
        low, high = self.frequency[0], self.frequency[-1]
        outside = asked[(asked < low) | (asked > high)]
        if outside.size:
            raise ValueError(f"frequency is {outside[0]:g} Hz; the table of the tissue has {low:g} to {high:g} Hz")

    def conductivity(self, frequency: ArrayLike) -> Complex:
        """Return the complex conductivity kappa (S/m) at frequencies (Hz), of their shape."""
        f = np.asarray(frequency, dtype=float)
        at, known = np.log(np.maximum(f, self.frequency[0])), np.log(self.frequency)
        eps, sigma = (np.interp(at, known, values) for values in (self.eps, self.sigma))
        return np.asarray(2j * np.pi * f * VACUUM_PERMITTIVITY * eps + sigma)


def _refuse(values: Sequence[float], name: str, least: float) -> None:
    for value in values:
        if not least <= value < np.inf:
            raise ValueError(f"{name} is {value:g}; it must be finite and {least:g} or more")


DRY = ColeCole(4.0, ((32.0, 7.23e-12, 0.0), (1100.0, 32.48e-9, 0.2)), 2e-4)
"""Dry skin: 38.007 and 1.464 S/m at 2.45 GHz."""
MOIST = ColeCole(
    4.0,
    ((39.0, 7.958e-12, 0.1), (280.0, 79.577e-9, 0.0), (3e4, 1.592e-6, 0.16), (3e4, 1.592e-3, 0.2)),
    4e-4,
)
"""Wet skin: 42.853 and 1.592 S/m at 2.45 GHz. The times have one digit more than 1 ps; with 7.96 ps and 79.58 ns the
conductivity is 1.593 S/m."""
TISSUES: dict[str, ColeCole] = {"dry": DRY, "moist": MOIST}
"""Tissues by name; ``"lossless"`` besides is the paper's, of one permittivity."""
