r"""The gap as a part of a series circuit: screen, air gap with a leak, stratum corneum; impedances of a unit of area.

.. math:: Z_i = \frac{d_i}{i \omega \varepsilon_0 \varepsilon_i}, \qquad
          Y_g = \frac{i \omega \varepsilon_0}{g} + \frac{1}{R_{gap}}, \qquad Z_{sc} = \frac{d_{sc}}{\kappa(\omega)},
          \qquad H = \frac{E g}{U} = \frac{1}{1 + (Z_i + Z_{sc}) Y_g}

The body behind the stratum corneum is taken as a conductor. The attraction is :math:`\sigma_{el}(t) = \varepsilon_0
E(t)^2 / 2` at each instant (B. N. J. Persson and J. Guo 2019, arXiv 1908.01140; the signal of a charge that leaks
through the contact is theirs too). Without a leak and with a lossless stratum corneum
:math:`H = g / (g + h_0)` at every frequency: then :math:`\sigma_{el}` is Eq. 3 of Forsbach et al. 2023.

The voltage across the insulator of the screen is a high-pass: a constant voltage ends there, once the charge has leaked
through the gap. Toward high frequencies the stratum corneum takes a growing share. In between, the share of the gap has
a peak.

:math:`R_{gap}` is the one constant that no source gives. :func:`fit_leak` takes it from the frequency of that peak.
:data:`LEAKS` has presets with the range in which each is likely.

Air breaks down by the local field (:func:`variational.roughness.gaps.breakdown_voltage`).

**In time** the circuit is of resistors and capacitors, solved exactly for voltages with straight pieces.
A stratum corneum of Cole–Cole terms is a sum of Debye terms
(:meth:`~variational.attraction.dielectric.ColeCole.debye`), each a resistor and a capacitor in series. With the gap and
the insulator, the voltages v of the nodes obey

.. math:: C \dot v + G v = b \, \dot U, \qquad E g = v_1 - v_2,

C and G symmetric: node 1 lies between insulator and gap, node 2 between gap and skin, and each Debye term has a further
one. The generalised eigenvectors of G and C have decay rates :math:`\lambda_j \ge 0`, and split the network into modes:

.. math:: \dot q_j + \lambda_j q_j = \dot U, \qquad E g = \sum_j w_j q_j, \qquad
          H(\omega) = \sum_j \frac{w_j \, i \omega}{i \omega + \lambda_j}.

Over a straight piece of U each mode is an exponential, so that a step has no error of its own, however long it is. A
jump of U adds to every mode what U jumps by.
"""

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
import scipy  # its parts are imported where they are used first: to read a scene needs none
from numpy.typing import ArrayLike, NDArray

from variational.attraction.dielectric import TISSUES, VACUUM_PERMITTIVITY, ColeCole, Debye, Tissue

Complex = NDArray[np.complex128]
Array = NDArray[np.float64]
_LOSSLESS = "lossless"
_PEAKS = (1.0, 1e5)  # Hz, among which a peak is looked for
_LEAKS = (1e-3, 1e9)  # ohm m²
_NEGLIGIBLE = 1e-12  # weight of a mode that is left out, of the sum of all
_ZERO_RATE = 1e-14  # rate that is roundoff of none, of the largest one


class Leak(NamedTuple):
    """A leak through the gap."""

    value: float
    """Resistance of a unit of area (ohm m²)."""
    low: float
    """Least likely value (ohm m²)."""
    high: float
    """Largest likely value (ohm m²)."""
    source: str
    """Where it comes from, in words."""


LEAKS: dict[str, Leak] = {
    "sliding dry": Leak(300.0, 230.0, 410.0, "a peak at 250 Hz over gaps of 1.0 to 2.5 µm"),
    "resting": Leak(67.0, 30.0, 150.0, "an impedance 2 to 10 times lower than in sliding; their geometric mean"),
    "moist": Leak(30.0, 3.0, 100.0, "assumed: ten times less than dry skin; no source"),
}
"""Presets of the leak by name."""


@dataclass(frozen=True)
class GapCircuit:
    """Circuit of the gap; the default is lossless, Eq. 3 of the paper.

    Its methods take the layers in series: ``gap`` g (m), ``d_i`` and ``eps_i`` of the screen's insulator, ``d_sc`` of
    the stratum corneum (m).
    """

    tissue: str | Tissue = _LOSSLESS
    """``"lossless"``, ``"dry"``, ``"moist"``, or a :class:`~variational.attraction.dielectric.Tissue`."""
    leak: str | float | None = None
    """R_gap (ohm m²), a name of :data:`LEAKS`, or None for no leak."""
    eps_sc: float = 1650.0
    """Relative permittivity of lossless stratum corneum."""

    def __post_init__(self) -> None:
        """Refuse an unknown name and a leak that is not greater than 0.

        Raises:
            ValueError: in one sentence.
        """
        if isinstance(self.tissue, str) and self.tissue != _LOSSLESS and self.tissue not in TISSUES:
            names = ", ".join(map(repr, (_LOSSLESS, *TISSUES)))
            raise ValueError(f"tissue is {self.tissue!r}; it must be {names} or a Tissue")
        if isinstance(self.leak, str) and self.leak not in LEAKS:
            raise ValueError(f"leak is {self.leak!r}; it must be {', '.join(map(repr, LEAKS))}, or a number of ohm m²")
        if not (self.leak is None or isinstance(self.leak, str) or 0 < self.leak < np.inf):
            raise ValueError(f"leak is {self.leak!r}; it must be greater than 0 ohm m² and finite")

    @property
    def lossless(self) -> bool:
        """Whether the share of the gap is the same at every frequency, Eq. 3."""
        return self.leak is None and self.tissue == _LOSSLESS

    @property
    def resistance(self) -> float:
        """R_gap (ohm m²); infinite without a leak."""
        if self.leak is None:
            return np.inf
        return LEAKS[self.leak].value if isinstance(self.leak, str) else float(self.leak)

    @property
    def dielectric(self) -> Tissue:
        """The stratum corneum."""
        if isinstance(self.tissue, Tissue):
            return self.tissue
        return ColeCole(self.eps_sc) if self.tissue == _LOSSLESS else TISSUES[self.tissue]

    def gain(self, frequency: ArrayLike, gap: ArrayLike, d_i: float, eps_i: float, d_sc: float) -> Complex:
        """Return H = E g / U at frequencies (Hz) from 0 on and gaps (m), arrays that broadcast.

        At 0 Hz it is the limit: nothing is left across a gap that leaks, or behind which skin conducts nothing is lost.
        """
        f, g = np.broadcast_arrays(np.asarray(frequency, dtype=float), np.asarray(gap, dtype=float))
        still = f == 0
        s = 2j * np.pi * np.where(still, 1.0, f)
        kappa = self.dielectric.conductivity(np.where(still, 1.0, f))
        behind = d_i / (VACUUM_PERMITTIVITY * eps_i) + s * d_sc / kappa  # impedance times i omega
        found = 1 / (1 + behind * (VACUUM_PERMITTIVITY / g + 1 / self.resistance / s))
        if not still.any():
            return np.asarray(found)
        sigma = self.dielectric.conductivity(0.0).real
        eps_0 = float(self.dielectric.permittivity(1e-6).real) if sigma == 0 else np.inf
        constant = g / (g + d_i / eps_i + d_sc / eps_0) if self.leak is None else 0.0
        return np.where(still, constant, found)

    def share(self, frequency: ArrayLike, gap: ArrayLike, d_i: float, eps_i: float, d_sc: float) -> Array:
        """Return ``|E g / U|²``, by which the mean attraction of a sine goes, at frequencies (Hz) and gaps (m).

        Raises:
            ValueError: a frequency that is not greater than 0, or at which the tissue is not known; a gap that is not
                greater than 0.
        """
        for name, values, unit in (("frequency", frequency, "Hz"), ("gap", gap, "m")):
            least = float(np.min(values))
            if not least > 0:
                raise ValueError(f"{name} is {least:g} {unit}; it must be greater than 0")
        self.dielectric.refuse(frequency)
        return np.asarray(np.abs(self.gain(frequency, gap, d_i, eps_i, d_sc)) ** 2)

    def peak(self, gap: float, d_i: float, eps_i: float, d_sc: float) -> float:
        """Return the frequency (Hz) from 1 Hz to 100 kHz at which the share is largest; without a leak the lowest."""

        def less(logarithm: float) -> float:
            return -float(self.share(np.exp(logarithm), gap, d_i, eps_i, d_sc))

        grid = np.log(np.geomspace(*_PEAKS, 120))
        best = int(np.argmin([less(each) for each in grid]))
        if best in (0, len(grid) - 1):
            return float(np.exp(grid[best]))
        found = scipy.optimize.minimize_scalar(
            less, bounds=(grid[best - 1], grid[best + 1]), method="bounded", options={"xatol": 1e-9}
        )
        return float(np.exp(found.x))

    def response(
        self, voltages: ArrayLike, frequency: float, gap: float, d_i: float, eps_i: float, d_sc: float
    ) -> Array:
        """Return the voltage across the gap E g (V) over a period of a periodic drive, in the steady state.

        Args:
            voltages: of the drive at equal times over one period, the first at its start, shape (samples,) (V).
            frequency: of the period (Hz).
            gap: g (m).
            d_i: thickness of the screen's insulator (m).
            eps_i: its relative permittivity.
            d_sc: thickness of the stratum corneum (m).

        Raises:
            ValueError: as :meth:`share`.
        """
        u = np.asarray(voltages, dtype=float)
        self.share(frequency, gap, d_i, eps_i, d_sc)  # refuses what has no answer
        spectrum = np.fft.rfft(u)
        gains = self.gain(frequency * np.arange(len(spectrum)), gap, d_i, eps_i, d_sc)
        return np.asarray(np.fft.irfft(spectrum * gains, len(u)))


@cache
def fit_leak(peak: float, tissue: str | Tissue, gap: float, d_i: float, eps_i: float, d_sc: float) -> float:
    """Return R_gap (ohm m²) with which the share of the gap is largest at a frequency ``peak`` (Hz).

    Raises:
        ValueError: no leak has its peak there.
    """

    def beyond(logarithm: float) -> float:
        return float(np.log(GapCircuit(tissue, float(np.exp(logarithm))).peak(gap, d_i, eps_i, d_sc) / peak))

    low, high = (float(np.log(end)) for end in _LEAKS)
    if not (peak > 0 and beyond(low) > 0 > beyond(high)):
        raise ValueError(
            f"peak is {peak:g} Hz; no leak through a gap of {gap:g} m has its peak there behind this tissue"
        )
    return float(np.exp(scipy.optimize.brentq(beyond, low, high, xtol=1e-6)))


# -- in time ---------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Network:
    """Modes of a circuit of the gap."""

    rate: Array
    """Decay rates (1/s), shape (modes,)."""
    weight: Array
    """Weight of each mode in the voltage across the gap, shape (modes,)."""

    @classmethod
    def of(cls, circuit: GapCircuit, gap: float, d_i: float, eps_i: float, d_sc: float) -> "Network":
        """Return the modes of a circuit; lengths in m.

        Raises:
            ValueError: the tissue is a table, which has no equations in time.
        """
        terms = circuit.dielectric.debye()
        if terms is None:
            raise ValueError("tissue is a table, which has no equations in time; give 'lossless', 'dry' or 'moist'")
        capacitance, conductance, inlet = _assembled(circuit, terms, (gap, d_i / eps_i, d_sc))
        rate, vectors = scipy.linalg.eigh(conductance, capacitance)
        weight = (vectors[0] - vectors[1]) * (inlet * vectors[0])
        kept = np.abs(weight) > _NEGLIGIBLE * np.abs(weight).sum()
        rate = rate[kept]
        return cls(np.where(rate > _ZERO_RATE * rate.max(), rate, 0.0), weight[kept])

    def gain(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Return E g / U at frequencies (Hz) above 0, to compare with :meth:`GapCircuit.gain`."""
        s = 2j * np.pi * np.asarray(frequency, dtype=float)[..., None]
        return np.asarray((self.weight * s / (s + self.rate)).sum(axis=-1))

    def decay(self) -> float:
        """Return the time constant (s) of the mode that carries most of a step; infinite where nothing leaks."""
        rate = float(self.rate[int(np.argmax(np.abs(self.weight)))])
        return 1 / rate if rate > 0 else np.inf

    def response(self, times: ArrayLike, voltages: ArrayLike, start: ArrayLike = 0.0) -> Array:
        """Return the voltage across the gap E g (V) at times of a voltage with straight pieces.

        Args:
            times: never falling, shape (times,) (s); two that are equal are a jump.
            voltages: of the drive at these times (V). The first is switched on at the first time.
            start: the modes q (V) before that, shape (modes,); 0 for a gap without charge.
        """
        return self._modes_over_time(np.asarray(times, dtype=float), np.asarray(voltages, dtype=float), start)[0]

    def periodic(self, times: ArrayLike, voltages: ArrayLike) -> Array:
        """Return the voltage across the gap (V) over a period in the steady state, at its times.

        Args:
            times: as for :meth:`response`, from the start of a period to its end (s).
            voltages: at these times (V); where the last differs from the first, the period begins with a jump.
        """
        t, u = np.asarray(times, dtype=float), np.asarray(voltages, dtype=float)
        # With q at the end of a period: q = exp(-rate T) q + (what a period leaves that begins with q = 0 before it).
        held = self.rate > 0
        left = self._modes_over_time(t, u, -u[-1])[1]
        end = np.full_like(left, u[-1])  # capacitors in series, without charge of their own
        end[held] = left[held] / -np.expm1(-self.rate[held] * (t[-1] - t[0]))
        return self._modes_over_time(t, u, end - u[-1])[0]

    def _modes_over_time(self, t: Array, u: Array, start: ArrayLike) -> tuple[Array, Array]:
        """Return the voltage across the gap at all times, and the modes at the last; the drive is 0 V before."""
        q, found = np.asarray(start, dtype=float) + u[0], np.empty_like(t)
        q = q * np.ones_like(self.rate)
        found[0] = self.weight @ q
        for k in range(1, len(t)):
            step, rise = t[k] - t[k - 1], u[k] - u[k - 1]
            if step > 0:
                x = self.rate * step
                lasting = np.where(x > 1e-8, -np.expm1(-x) / np.where(x > 0, x, 1.0), 1 - x / 2)
                q = q * np.exp(-x) + rise * lasting
            else:
                q = q + rise
            found[k] = self.weight @ q
        return found, q


def _assembled(circuit: GapCircuit, tissue: Debye, layers: tuple[float, float, float]) -> tuple[Array, Array, float]:
    """Return C and G of the nodes over the permittivity of vacuum, and the capacitance of the insulator, over it too.

    Args:
        circuit: with the leak.
        tissue: of the stratum corneum.
        layers: gap, d_i / eps_i and d_sc (m).
    """
    gap, insulator, d_sc = layers
    nodes = 2 + len(tissue.delta)
    capacitance, conductance = np.zeros((nodes, nodes)), np.zeros((nodes, nodes))
    inlet, across = 1 / insulator, np.array([[1.0, -1.0], [-1.0, 1.0]])
    capacitance[:2, :2] += across / gap
    conductance[:2, :2] += across / circuit.resistance / VACUUM_PERMITTIVITY
    capacitance[0, 0] += inlet
    capacitance[1, 1] += tissue.eps_inf / d_sc
    conductance[1, 1] += tissue.sigma / d_sc / VACUUM_PERMITTIVITY
    for k, (delta, tau) in enumerate(zip(tissue.delta, tissue.tau, strict=True), start=2):
        capacitance[k, k] = delta / d_sc
        pair = np.ix_((1, k), (1, k))
        conductance[pair] += across * delta / d_sc / tau
    return capacitance, conductance, inlet
