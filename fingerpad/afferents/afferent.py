"""A class of mechanoreceptive afferents: what drives its units, and the spikes with which they answer.

A law of one's own is a class with two methods, and selectable by its name once it is an entry of
:data:`fingerpad.afferents.LAWS`::

    class Threshold(Afferent):
        name, site, longest_step = "Threshold", "merkel", 5e-3

        def stimulus(self, history):
            return history.stress

        def fire(self, stimulus):
            above = stimulus > 5e3  # Pa
            return above & ~np.roll(above, 1, axis=1)

A unit starts in the steady state of the first value of its stimulus.
"""

import reprlib
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
SITES = ("merkel", "meissner", "pacinian")
"""Kinds of sites."""
_STEP_TOLERANCE = 1e-9  # relative difference of two steps that are the same


@dataclass(frozen=True, eq=False)
class History:
    """Stimuli at the sites of a kind, at equal times; each of shape (units, samples)."""

    stress: Array
    """Compressive stress (Pa): minus the Cauchy stress normal to the screen."""
    sed: Array
    """Strain energy density (J/m^3 of reference volume)."""
    strain: Array
    """Strain along the surface of the skin, negative where it is compressed; NaN without a surface above the site."""


class Afferent(ABC):
    """A law of the spikes of a class of afferents.

    Attributes:
        name: of the law.
        site: of :data:`SITES`.
        longest_step: longest time (s) between two samples of a changing stimulus.
        step: time (s) between two samples of what :meth:`fire` is given.
        population: whether one unit answers to the mean over all sites.
    """

    name: ClassVar[str]
    site: ClassVar[str]
    longest_step: ClassVar[float]
    step: ClassVar[float] = 1e-4
    population: ClassVar[bool] = False

    @abstractmethod
    def stimulus(self, history: History) -> Array:
        """Return what drives the units, shape (units, samples), in the unit of :meth:`spikes`."""

    @abstractmethod
    def fire(self, stimulus: Array) -> NDArray[np.bool_]:
        """Return whether each unit fires at each sample, shape (units, samples).

        Args:
            stimulus: samples that are :attr:`step` apart, shape (units, samples).
        """

    def spikes(self, stimulus: ArrayLike, dt: float) -> Any:
        """Return spike times (s), the first sample at time 0.

        Args:
            stimulus: at equal times, shape (samples,) of one unit or (units, samples).
            dt: time between two samples (s). Between them the stimulus is straight.

        Returns:
            An array of one unit, a list of arrays of several.

        Raises:
            ValueError: the samples are no numbers, or too far apart for the class.
        """
        values, dt = _checked(stimulus, dt, self)
        fired = self.fire(_resampled(np.atleast_2d(values), dt, self.step))
        times = [self.step * np.flatnonzero(mine) for mine in fired]
        return times[0] if values.ndim == 1 else times


def _checked(stimulus: ArrayLike, dt: float, law: Afferent) -> tuple[Array, float]:
    """Return a stimulus and its step as numbers, for a law.

    Raises:
        ValueError: they are none, or the step is too long.
    """
    try:
        values, step = np.asarray(stimulus, dtype=float), float(dt)
    except (TypeError, ValueError):
        raise ValueError(f"the stimulus of {law.name} or its dt is no number; give arrays of numbers in SI") from None
    if not 0 < step < np.inf:
        raise ValueError(f"dt is {step:g}; it must be greater than 0 s")
    if values.ndim not in (1, 2) or values.shape[-1] < 2 or not np.isfinite(values).all():
        raise ValueError(
            f"the stimulus of {law.name} has the shape {values.shape}; it must have finite numbers along (samples,) or "
            "(units, samples), 2 samples at least"
        )
    if step > law.longest_step * (1 + _STEP_TOLERANCE):
        raise ValueError(f"dt is {step:g} s; {law.name} needs {law.longest_step:.3g} s or less between two samples")
    return values, step


def _resampled(values: Array, dt: float, step: float) -> Array:
    """Return a stimulus at times that are a step apart, straight between its samples.

    Args:
        values: shape (units, samples).
        dt: time between two samples (s).
        step: the new one (s).
    """
    if abs(dt - step) <= _STEP_TOLERANCE * step:
        return values
    place = np.arange(int((values.shape[1] - 1) * dt / step * (1 + _STEP_TOLERANCE)) + 1) * (step / dt)
    before = np.minimum(place.astype(int), values.shape[1] - 2)
    share = place - before
    return np.asarray(values[:, before] * (1 - share) + values[:, before + 1] * share)


def check_keys(law: Any, inputs: tuple[str, ...] = ()) -> None:
    """Refuse an input that a law does not have, and a gain that is not greater than 0.

    Args:
        law: with ``gain``, and ``input`` where it has several.
        inputs: what it can be.

    Raises:
        ValueError: the key, its value and what is allowed.
    """
    if inputs and law.input not in inputs:
        raise ValueError(f"input is {reprlib.repr(law.input)}; it must be {' or '.join(map(repr, inputs))}")
    if not (isinstance(law.gain, int | float) and 0 < law.gain < np.inf):
        raise ValueError(f"gain is {reprlib.repr(law.gain)}; it must be greater than 0")
