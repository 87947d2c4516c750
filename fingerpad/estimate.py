r"""Discretisation error, knob by knob, from states solved again on other meshes.

A knob is a set of element sizes, or the step size, that is halved at once. Knobs are halved one at a time and never
two in one solve, so that each change of a quantity q is one knob's: :math:`\Delta_k`, from twice the size in use to
the size in use. An error of :math:`C_k h_k^{p_k}` each gives to first order

.. math:: q - q_{exact} = \sum_k \frac{q(2 h_k) - q(h_k)}{2^{p_k} - 1}, \qquad
          E = \sum_k \frac{|\Delta_k|}{2^{p_k} - 1}

(Richardson's extrapolation as an estimate; Roache 1994, doi 10.1115/1.2910291). E adds magnitudes: signs that cancel on
one mesh need not on the next. It is of the finest mesh solved on: what shows the error also lowers it.

One halving tells no order; p = 1 is then taken, the order of a contact's edge on a mesh that does not know where it
is: the error left is as large as the last change. Energy densities, at sites deep in the skin that hardly see the edge,
have p = 2, that of the strains of quadratic elements. Once a knob has been halved again, the order is observed, and is
believed between 1 and 2. A difference that came out accidentally small, or with the other sign, is not believed either:
it counts as at least a quarter of the one before it, which is second order.

(A dual-weighted residual would need the adjoint of an active set and of two scales, and says nothing of a state in
which a ridge has jumped. Another mesh sees all that, and one re-solved state costs some ten factorisations.)

Plain numbers only: no mesh, no solver.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

Values = Mapping[str, float]
_LOWEST, _HIGHEST = 1.0, 2.0  # orders that are believed
_DENSITY = "_sed_"  # in the names of energy densities


@dataclass
class Knob:
    """What halving one knob changed, from its first size to the one in use."""

    changes: list[dict[str, float]] = field(default_factory=list)
    """By how much each quantity changed, at each halving."""

    def see(self, coarse: Values, fine: Values) -> None:
        """Take note of values before and after the next halving."""
        self.changes.append({name: fine[name] - coarse[name] for name in coarse if name in fine})

    def acts_on(self, name: str) -> bool:
        """Return whether the knob has a part in a quantity's error."""
        return name in self.changes[-1]

    def order(self, name: str) -> float:
        """Return the order with which a quantity's error falls."""
        if len(self.changes) < 2:
            return _HIGHEST if _DENSITY in name else _LOWEST
        change = self._believed(name)
        if change == 0:
            return _HIGHEST
        return float(np.clip(np.log2(abs(self.changes[-2][name]) / change), _LOWEST, _HIGHEST))

    def share(self, name: str) -> float:
        """Return the part of a quantity's error, at the size in use, that is this knob's; in the quantity's unit."""
        return self._believed(name) / (2 ** self.order(name) - 1)

    def _believed(self, name: str) -> float:
        change = abs(self.changes[-1][name])
        if len(self.changes) > 1:
            change = max(change, abs(self.changes[-2][name]) / 2**_HIGHEST)
        return change


def errors(knobs: Mapping[str, Knob], names: Sequence[str]) -> dict[str, float]:
    """Return the estimated error E of each quantity, in its unit."""
    return {name: sum(knob.share(name) for knob in knobs.values() if knob.acts_on(name)) for name in names}


def to_halve(knobs: Mapping[str, Knob], allowed: Values) -> list[str]:
    """Return the knobs to halve once more on the way to errors within what is allowed, by name.

    Of each quantity that is not within it, as few as will do by their orders, those with the largest shares first, and
    none that spends no more than its equal part. One halving at a time, since the order is that of small changes, and a
    mesh finer than need be costs more than one more round.

    Args:
        knobs: that can be halved, with what halving them changed.
        allowed: largest error of each quantity, in its unit.

    Returns:
        In the order of ``knobs``; empty if every error is within what is allowed.
    """
    found: set[str] = set()
    estimate = errors(knobs, list(allowed))
    for name, most in allowed.items():
        left = estimate[name]
        shares = {key: knob.share(name) for key, knob in knobs.items() if knob.acts_on(name)}
        for key in sorted(shares, key=shares.__getitem__, reverse=True):
            if left <= most or shares[key] * len(shares) <= most:
                break
            left -= shares[key] * (1 - 2 ** -knobs[key].order(name))
            found.add(key)
    return [key for key in knobs if key in found]
