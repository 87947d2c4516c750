r"""The circuit of the gap in time: resistors and capacitors, solved exactly for voltages with straight pieces.

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

import numpy as np
import scipy  # its parts are imported where they are used first: to read a scene needs none
from numpy.typing import ArrayLike, NDArray

from variational.attraction.circuit import GapCircuit
from variational.attraction.dielectric import VACUUM_PERMITTIVITY, Debye

Array = NDArray[np.float64]
_NEGLIGIBLE = 1e-12  # weight of a mode that is left out, of the sum of all
_ZERO_RATE = 1e-14  # rate that is roundoff of none, of the largest one


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
