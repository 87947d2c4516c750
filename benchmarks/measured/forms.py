"""Two forms of a curve beside each other, with two parameters each: the measured one, and another."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

Array = NDArray[np.float64]
Form = Callable[[Array, float], Array]
"""A curve over x with one parameter, of any scale."""


class Fit(NamedTuple):
    """A form fitted to a curve: its parameter and the rms of what is left."""

    parameter: float
    misfit: float


def exponential(x: Array, b: float) -> Array:
    """Return exp(b x / x_max) - 1."""
    return np.asarray(np.expm1(b * x / x.max()))


def power(x: Array, n: float) -> Array:
    """Return (x / x_max)^n."""
    return np.asarray((x / x.max()) ** n)


def line(x: Array, start: float) -> Array:
    """Return a straight line that begins with a share of its last value."""
    return np.asarray(start + (1 - start) * x / x.max())


def paraboloid(x: Array, a: float) -> Array:
    """Return 1 - (x / a)², with a half width in units of the largest |x|; 0 outside."""
    return np.asarray(np.clip(1 - (x / (a * np.abs(x).max())) ** 2, 0, None))


def ellipse(x: Array, a: float) -> Array:
    """Return half an ellipse, Hertz's pressure; arguments as of :func:`paraboloid`."""
    return np.asarray(np.sqrt(paraboloid(x, a)))


_WIDTHS = (1.0, 10.0)
BOUNDS: dict[Form, tuple[float, float]] = {
    exponential: (1e-3, 50.0),
    power: (0.05, 10.0),
    line: (0.0, 0.99),
    paraboloid: _WIDTHS,
    ellipse: _WIDTHS,
}
"""Where the parameter of each form is looked for."""


def of_each(form: Form, x: Array, y: Array) -> Fit:
    """Fit a form by logarithms; the misfit is that of each value."""

    def rest(parameter: float) -> float:
        return float(np.std(np.log(y) - np.log(form(x, parameter))))

    return _least(rest, form)


def of_largest(form: Form, x: Array, y: Array) -> Fit:
    """Fit a form by least squares; the misfit is over the largest value."""

    def rest(parameter: float) -> float:
        curve = form(x, parameter)
        return float(np.sqrt(np.mean((y - scale(curve, y) * curve) ** 2)) / y.max())

    return _least(rest, form)


def scale(curve: Array, y: Array) -> float:
    """Return the factor by which a curve is closest to ``y``."""
    return float(curve @ y / (curve @ curve))


def _least(rest: Callable[[float], float], form: Form) -> Fit:
    found = minimize_scalar(rest, bounds=BOUNDS[form], method="bounded", options={"xatol": 1e-9})
    return Fit(float(found.x), float(found.fun))
