"""A quantity of ours as curves over force and voltage, and between them; no dolfinx."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
At = tuple[float, float]
"""Force and voltage."""
NEAR = 1e-6
"""Relative difference of conditions that count as the same."""
CLOSE = 0.01
"""The same of forces beyond a curve that its end stands for."""
_NAMED = 4  # voltages in a message


class Value(NamedTuple):
    """A quantity of ours at a force and a voltage; SI units."""

    value: float
    error: float = math.nan
    """Estimated discretisation error; NaN where none is known."""


class Curve(NamedTuple):
    """A quantity of ours over the force at a voltage (V), whose sign changes no force; SI units."""

    voltage: float
    force: Array
    """Increasing, shape (forces,)."""
    values: Array
    """Shape (forces,); NaN where a run has no result."""
    error: Array
    """Estimated discretisation errors, shape (forces,); NaN where none is known."""

    def inside(self, force: float) -> float:
        """Return a force; one up to 1 % beyond the curve is its end."""
        end = float(np.clip(force, self.force[0], self.force[-1]))
        return end if math.isclose(force, end, rel_tol=CLOSE) else force


@dataclass(frozen=True, eq=False)
class Ours:
    """A quantity of ours over force and voltage; SI units."""

    curves: tuple[Curve, ...]
    """By growing voltage."""

    @property
    def force(self) -> Array:
        """All forces, growing."""
        return np.unique(np.concatenate([curve.force for curve in self.curves]))

    @property
    def voltage(self) -> Array:
        """All voltages, growing."""
        return np.array([curve.voltage for curve in self.curves])

    def at(self, force: Array, voltage: Array) -> Array:
        """Return ours at pairs of force and voltage; NaN outside of ours.

        Between two forces ours is taken as a power law, and as linear where it is 0 at one of them. Between two
        voltages it is taken as linear in U², as which attraction rises. The sign of a voltage does not count. Up to 1 %
        beyond the forces of a voltage the value at the last one is taken: the newtons of one f_ext differ a little
        between voltages.
        """
        return self._through(force, voltage, [curve.values for curve in self.curves])

    def error(self, force: Array, voltage: Array) -> Array:
        """Return the discretisation errors of :meth:`at`, interpolated likewise; NaN where one is not known.

        They do not hold the error of the interpolation.
        """
        return self._through(force, voltage, [curve.error for curve in self.curves])

    def _through(self, force: Array, voltage: Array, values: Sequence[Array]) -> Array:
        found = []
        for f, u in zip(force, voltage, strict=True):
            over = [_over_force(c.inside(f), c.force, known) for c, known in zip(self.curves, values, strict=True)]
            found.append(_between(u**2, self.voltage**2, over))
        return np.array(found)

    def computed(self, force: Array, voltage: Array) -> NDArray[np.bool_]:
        """Return which pairs of force and voltage have a value that is not interpolated."""
        found = np.zeros(len(force), dtype=bool)
        for curve in self.curves:
            inside = np.array([curve.inside(f) for f in force])
            there = np.isclose(inside[:, None], curve.force, rtol=NEAR, atol=0.0).any(axis=1)
            found |= there & np.isclose(np.abs(voltage), curve.voltage, rtol=NEAR, atol=0.0)
        return found


def _over_force(x: float, known: Array, values: Array) -> float:
    """Return a value at one of the known forces up to roundoff, or between two of them; NaN beyond."""
    if not (known[0] < x < known[-1]) or np.isclose(known, x, rtol=NEAR, atol=0.0).any():
        return _between(x, known, values)
    k = int(np.searchsorted(known, x))
    ends, at = values[k - 1 : k + 1], known[k - 1 : k + 1]
    if not np.all(ends > 0):
        return _between(x, known, values)
    return float(np.exp(_between(np.log(x), np.log(at), np.log(ends))))


def _between(x: float, known: Array, values: Sequence[float] | Array) -> float:
    """Return a value at one of the known places up to roundoff, or between two of them; NaN beyond."""
    near = np.flatnonzero(np.isclose(known, x, rtol=NEAR, atol=0.0))
    if near.size:
        return float(values[near[0]])
    return float(np.interp(x, known, values)) if known[0] < x < known[-1] else math.nan


def reach(known: Ours, force_unit: str) -> str:
    """Return in words which forces and voltages ours has; the forces of each voltage where they differ."""
    ends = np.array([(curve.force[0], curve.force[-1]) for curve in known.curves])
    if np.allclose(ends, ends[0], rtol=NEAR, atol=0.0):
        return f"{_span(known.force, force_unit)}, {_span(known.voltage, 'V')}"
    each = [f"{_span(curve.force, force_unit)} at {curve.voltage:g} V" for curve in known.curves]
    more = f" and others at {len(each) - _NAMED} more voltages" if len(each) > _NAMED else ""
    return ", ".join(each[:_NAMED]) + more


def _span(axis: Array, unit: str) -> str:
    single = math.isclose(axis[0], axis[-1], rel_tol=NEAR)
    return f"{axis[0]:g} {unit}" if single else f"{axis[0]:g} to {axis[-1]:g} {unit}"
