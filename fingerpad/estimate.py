r"""Discretisation error, knob by knob, from states solved again on finer meshes.

A knob is a set of element sizes, or the step size, that is halved at once. With values q on the mesh in use and
:math:`q_k` with knob k halved, an error of :math:`C_k h_k^p` each gives to first order

.. math:: q - q_{exact} = \sum_k \frac{q - q_k}{1 - 2^{-p_k}}, \qquad
          E = \sum_k \frac{|q - q_k|}{1 - 2^{-p_k}}

(the two-level estimate of Richardson's extrapolation; Roache 1994, doi 10.1115/1.2910291). E adds magnitudes: signs
that cancel on one mesh need not on the next. On very coarse meshes the knobs are not independent, since smaller facets
and slower growth both refine what is behind the contact, and E counts twice what either would mend.

One halving tells no order; p = 1 is then taken, the order of a contact's edge on a mesh that does not know where it
is, which doubles the difference. Once a knob has been halved again, the order is observed, and is believed between 1
and 2. A difference that came out accidentally small, or with the other sign, is not believed either: it counts as at
least a quarter of the one before it for each halving between the two, which is second order.

(A dual-weighted residual would need the adjoint of an active set and of two scales, and says nothing of a state in
which a ridge has jumped. A finer mesh sees all that, and one re-solved state costs some ten factorisations.)

Plain numbers only: no mesh, no solver.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

Values = Mapping[str, float]
_LOWEST, _HIGHEST = 1.0, 2.0  # orders that are believed


@dataclass
class Knob:
    """What halving one knob changed, from its first size on."""

    changes: list[tuple[int, dict[str, float]]] = field(default_factory=list)
    """How often the size in use had been halved, and by how much each quantity then changed at the next halving."""

    def see(self, halvings: int, coarse: Values, fine: Values) -> None:
        """Take note of values before and after the next halving."""
        self.changes.append((halvings, {name: fine[name] - coarse[name] for name in coarse if name in fine}))

    def order(self, name: str) -> float:
        """Return the order with which a quantity's error falls."""
        if len(self.changes) < 2:
            return _LOWEST
        (before, old), (now, _) = self.changes[-2:]
        change = self._believed(name)
        if change == 0:
            return _HIGHEST
        observed = np.log2(abs(old[name]) / change) / (now - before)
        return float(np.clip(observed, _LOWEST, _HIGHEST))

    def share(self, name: str) -> float:
        """Return the part of a quantity's error that is this knob's, in the quantity's unit."""
        return self._believed(name) / (1 - 2 ** -self.order(name))

    def _believed(self, name: str) -> float:
        now, last = self.changes[-1]
        change = abs(last[name])
        if len(self.changes) > 1:
            before, old = self.changes[-2]
            change = max(change, abs(old[name]) / 2 ** (_HIGHEST * (now - before)))
        return change


def errors(knobs: Mapping[str, Knob], names: Sequence[str]) -> dict[str, float]:
    """Return the estimated error E of each quantity, in its unit."""
    return {name: sum(knob.share(name) for knob in knobs.values() if name in knob.changes[-1][1]) for name in names}


def to_halve(knobs: Mapping[str, Knob], allowed: Values) -> list[str]:
    """Return the knobs to halve once more on the way to errors within what is allowed, by name.

    Of each quantity that is not within it, as few as will do by their orders, those with the largest shares first, and
    none that spends no more than its equal part. One halving at a time, since the order is that of small changes, and a
    mesh finer than need be costs more than one more round.

    Args:
        knobs: that can be halved, with what halving them changed.
        allowed: largest error of each quantity, in its unit.

    Returns:
        Empty if every error is within what is allowed.
    """
    found: set[str] = set()
    estimate = errors(knobs, list(allowed))
    for name, most in allowed.items():
        left = estimate[name]
        shares = {key: knob.share(name) for key, knob in knobs.items() if name in knob.changes[-1][1]}
        for key in sorted(shares, key=shares.__getitem__, reverse=True):
            if left <= most or shares[key] * len(shares) <= most:
                break
            left -= shares[key] * (1 - 2 ** -knobs[key].order(name))
            found.add(key)
    return sorted(found)
