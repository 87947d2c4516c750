r"""The number kappa of the closed form's shear, fitted to the attraction of kept states, and what it changes.

:data:`fingerpad.reduced.cylinders.SHEAR` stiffens ridges by the shear stress beyond that of a friction coefficient of
0.25. The fit is by least squares of the logarithm of the attraction, over the states that make the error and whose
friction is stronger. The others, and all contact lengths, test it.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from benchmarks.loads.compared import PART, fits
from benchmarks.loads.scenes import Data, section
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene, SceneError

Array = NDArray[np.float64]
_MOST, _STEP = 40.0, 0.01  # of kappa


class Point(NamedTuple):
    """A state of the full model, without the error of its mesh."""

    scene: int
    """Place in the sequence."""
    values: Data
    """Of the scene by key."""
    state: Data


def points(kept: Iterable[Data]) -> list[Point]:
    """Return the states of kept scenes that both models have."""
    every = (Point(each["scene"], each["values"], state) for each in kept for state in each["states"])
    return [each for each in every if "f_electrostatic" in each.state and len(differences([each], 0.0))]


def differences(some: Iterable[Point], shear: float) -> Array:
    """Return logarithms of the full model over the closed form, of attraction and length; shape (points, 2).

    Points that the closed form refuses are left out.
    """
    found = []
    for each in some:
        f_ext = each.state["f_ext"]
        try:
            (own,) = cylinders.over_forces(section(each.values, f_ext), [f_ext], "full_slip", shear=shear)
        except SceneError:
            continue
        found.append([np.log(each.state[key] / getattr(own, key)) for key in ("f_electrostatic", "contact_length")])
    return np.array(found).reshape(-1, 2)


def fitted(some: Iterable[Point]) -> float:
    """Return kappa by the points that make the error."""
    known = Scene().friction
    own = [each for each in some if fits(each) and each.values["friction"] > known]

    def squares(shear: float) -> float:
        return float((differences(own, shear)[:, 0] ** 2).sum())

    return float(minimize_scalar(squares, bounds=(0.0, _MOST), method="bounded", options={"xatol": _STEP}).x)


class Spread(NamedTuple):
    """Errors of points with one kappa, in per cent of the closed form's value."""

    shear: float
    mean: float
    most: float
    """Of the attraction, covers :data:`benchmarks.loads.compared.PART` of the points."""
    length_mean: float
    length_most: float


def spread(some: Sequence[Point], shear: float) -> Spread:
    """Return the errors of points."""
    errors = 100 * np.expm1(differences(some, shear))
    mean, most = errors.mean(axis=0), np.quantile(abs(errors), PART, axis=0)
    return Spread(shear, float(mean[0]), float(most[0]), float(mean[1]), float(most[1]))
