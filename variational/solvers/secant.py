r"""Newton's method for the air gaps, a secant of each ridge by itself.

With :math:`r(d) = d_{eq}(p_c(d)) - d` over a ridge's air gap d,

.. math:: d \leftarrow d + \frac{r}{1 - g}, \qquad g = \frac{d}{dd} d_{eq}(p_c(d))

The screen bears a change of the attraction mostly where it acts, so a ridge hardly depends on the others' air gaps. The
secant needs a few iterations where the gain g is -3 or 0.99 and the plain loop, d + r, diverges or needs hundreds.

It is not let converge where g > 1. There the micro layer is unstable: a gap that opens a little opens on. On a flat
ridge, :math:`g = d_{eq}'(p_c) \, \sigma_{el}'(d)` whatever the body and its loads: no control of the bone's height or
force makes such a state stable. (On a round one the contact's length follows the attraction too.) g = 1 is the ridge's
fold; past it the iteration leaves in the direction of r, by ten times r and, as long as the gain stays there, by a
hundred and a thousand times, never more than half of d, for another state of the ridge: down on the screen, or up to
where d_eq is held. A ridge that is on its way up is soon given the air gap d_eq is held at (:meth:`Secants.step`); it
comes back if it still touches then.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_AMPLIFIED = np.array([10.0, 10.0, 100.0, 1e3])  # largest 1 / (1 - gain) after so many secants that asked for ten
_SEEN = 1e-6  # of d: what a secant is drawn over, far above the error that a solve leaves, and
_LEADS = 0.1  # of the largest move: else it is the other ridges' air gaps that moved this one's pressure
_FIRST = 0.01  # of d: how far the first step may go beyond r, whose gain is that of another load
_OPENING = 0.05  # of d: r of a ridge that lets go, and
_OPENED, _OPENS = 1.3, 1.02  # its air gap over that at the loop's start; the same of one that may let go
_GAIN_OPENS = 0.9  # gain of a ridge that may
_DOWN, _UP = 1 / 3, 1 / 2  # of d: longest step
_JUMP = 0.1  # of d: how far a ridge past its fold goes at least


class Secants:
    """One loop over all ridges; arrays have shape (ridges,).

    Attributes:
        gain: last secant of each ridge that moved its air gap; NaN where none did yet.
        closing: whether a ridge comes down on the screen, farther than one step goes.
    """

    def __init__(self, d: Array, gain: Array, free: float) -> None:
        """Start a loop.

        Args:
            d: air gaps (m).
            gain: with which an earlier loop ended.
            free: air gap (m) of a ridge without contact.
        """
        self._free = free
        self._opened: NDArray[np.bool_] = np.zeros(len(d), dtype=bool)  # whether a ridge was given that
        self.gain = gain.copy()
        self._start, self._d, self._r = d, d, np.zeros_like(d)
        self._has_stepped, self.closing = False, False
        self._past: NDArray[np.bool_] = np.zeros(len(d), dtype=bool)  # whether a gain reached one
        self._steep: NDArray[Any] = np.zeros(len(d), dtype=np.int64)  # secants in a row near a gain of one or above

    def record(self, d: Array, r: Array) -> None:
        """Record the change ``r`` (m) that the closure makes to air gaps ``d`` (m)."""
        if self._has_stepped:
            moved = d - self._d
            part = np.abs(moved) / d
            seen = part > max(_SEEN, _LEADS * float(part.max()))
            secant = 1 + np.divide(r - self._r, moved, out=np.zeros_like(r), where=moved != 0)
            self.gain = np.where(seen, secant, self.gain)
            near = self.gain > 1 - 1 / _AMPLIFIED[0]
            self._steep = np.where(seen, np.where(near, self._steep + 1, 0), self._steep)
            self._past |= seen & (self.gain >= 1)
        self._d, self._r = d, r

    def settled(self, tolerance: float) -> bool:
        """Return whether the relative error, r / (1 - gain), is within a tolerance; gains count up to 0.99."""
        return bool((np.abs(self._r) * self._amplification(2) <= tolerance * self._d).all())

    def step(self) -> Array:
        """Return the next air gaps (m); a ridge past its fold whose air gap opens gets that of one without contact."""
        first = np.maximum(np.abs(self._r), _FIRST * self._d)
        most = np.inf if self._has_stepped else first
        step = np.clip(self._r * self._amplification(self._steep), -most, most)
        self._has_stepped = True
        lets_go = (self.gain >= 1) & (self._r > _OPENING * self._d) & (self._d > _OPENED * self._start)
        self.closing = bool((step < -_DOWN * self._d).any())
        return self._open(self._d + np.clip(step, -_DOWN * self._d, _UP * self._d), lets_go)

    def leaving(self, d: Array) -> NDArray[np.bool_]:
        """Return the ridge, if any, that lets go when the skin finds no equilibrium at air gaps ``d`` (m).

        It is the one whose air gap opened most in this loop. There is none while another ridge comes down.
        """
        opened = np.where(self._r > 0, d / self._start, 0.0)
        near = (opened > _OPENS) | (np.nan_to_num(self.gain) > _GAIN_OPENS) & (self._r > 0)
        alone = bool((d > self._start / _OPENED).all()) and bool(near.any())
        most = np.arange(len(opened)) == int(np.argmax(np.where(near, opened, 0.0)))
        return most & alone & ~self._opened & (d < self._free)

    def without_leaving(self, d: Array) -> Array:
        """Return air gaps (m) with that of one without contact for the ridge that is :meth:`leaving`."""
        return self._open(d, self.leaving(d))

    def _open(self, d: Array, ridges: NDArray[np.bool_]) -> Array:
        """Return air gaps (m) with that of a ridge without contact, where it is wider, for some; once a loop each."""
        ridges = ridges & ~self._opened & (d < self._free)
        self._opened |= ridges
        return np.where(ridges, self._free, d)

    def jumped(self) -> NDArray[np.bool_]:
        """Return which ridges went past a fold: their gain was above one and their air gap changed by far."""
        past = self._past | self._opened
        return past & (np.abs(self._d - self._start) > _JUMP * self._start)

    def _amplification(self, steep: NDArray[Any] | int) -> Array:
        """Return 1 / (1 - gain), bounded where the gain is near one or above; no gain known counts as none."""
        most = _AMPLIFIED[np.minimum(steep, len(_AMPLIFIED) - 1)]
        return np.asarray(1 / (1 - np.minimum(np.nan_to_num(self.gain), 1 - 1 / most)))
