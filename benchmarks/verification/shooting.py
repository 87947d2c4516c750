r"""The widened tube's exact solutions: by shooting, and by quadrature where it is incompressible.

With r(R) the radius to which R moves, :math:`\lambda_r = r'`, :math:`\lambda_\theta = r / R` and
:math:`\lambda_z = 1`, equilibrium is

.. math:: \frac{dP_r}{dR} + \frac{P_r - P_\theta}{R} = 0, \qquad r(A) = a, \quad P_r(B) = 0

(Ogden, Non-linear Elastic Deformations, 1984, chapter 5). Differentiated by lambda_r and lambda_theta this is an
initial value problem for r and lambda_r, of which the second's value at A is shot for. An incompressible tube has
:math:`r^2 = R^2 + a^2 - A^2`, and with :math:`\lambda = r / R`, :math:`\hat W(\lambda) = W(1/\lambda, \lambda, 1)`

.. math:: p = \int_{\lambda_b}^{\lambda_a} \frac{\hat W'(\lambda)}{\lambda^2 - 1} \,d\lambda
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from benchmarks.verification import principal

Array = NDArray[np.float64]
A, B, AXIS = 1e-3, 2e-3, 4e-3  # m: inner and outer radius, height of the axis
SHEAR, ALPHA = 86.76e3, -14.53  # the stratum corneum's, in Pa and as printed


def pressure_of_incompressible(widened: float) -> float:
    """Return the inner pressure (Pa) at a / A, by quadrature."""
    a = -ALPHA
    outer = np.sqrt(1 + (widened**2 - 1) * (A / B) ** 2)

    def integrand(x: float) -> float:
        return 2 * SHEAR / a * (x ** (a - 1) - x ** (-a - 1)) / (x**2 - 1)

    return float(quad(integrand, outer, widened, epsabs=0, epsrel=1e-12)[0])


class Exact:
    """The compressible tube's radius and stress, by shooting."""

    def __init__(self, poisson: float, widened: float) -> None:
        """Find the radial stretch at the inner surface."""
        self.solid, self.inner = principal.skin("SC", SHEAR, ALPHA, poisson, -1), widened * A

        def outer_stress(start: float) -> float:
            r, stretch = self._integrate(start, (A, B)).y[:, -1]
            return self._stress(stretch, r / B)

        # No volume change, but for a tenth: the stress grows with the stretch.
        guess = 1 / widened
        self._start = brentq(outer_stress, 0.93 * guess, 1.1 * guess, xtol=1e-15, rtol=1e-14)
        self._out = self._integrate(self._start, (A, B))
        self._in = self._integrate(self._start, (A, 0.9 * A))  # chords of the inner circle are within it
        self.pressure = -self._stress(self._start, widened) / widened  # on the current area

    def _stress(self, radial: float, hoop: float) -> float:
        return float(principal.nominal(self.solid, (radial, hoop, 1.0))[0])

    def _slope(self, R: float, y: Array) -> list[float]:
        r, radial = y
        hoop = r / R
        P = principal.nominal(self.solid, (radial, hoop, 1.0))
        dP = principal.moduli(self.solid, (radial, hoop, 1.0))[0]
        return [radial, -(P[0] - P[1] + dP[1] * (radial - hoop)) / (R * dP[0])]

    def _integrate(self, start: float, span: tuple[float, float]):
        return solve_ivp(
            self._slope, span, [self.inner, start], method="DOP853", rtol=1e-12, atol=1e-16, dense_output=True
        )

    def radius(self, R: Array) -> Array:
        """Return r (m) at R (m) anywhere in the wall and a little within it."""
        return np.where(R < A, self._in.sol(np.minimum(R, A))[0], self._out.sol(np.maximum(R, A))[0])

    def __call__(self, x: Array) -> Array:
        """Return the displacement (m), shape (2, n), at points (m), shape (3, n)."""
        X = x[:2] - np.array([[0.0], [AXIS]])
        R = np.hypot(*X)
        return X * (self.radius(R) / R - 1)


@cache
def exact_tube(poisson: float, widened: float) -> Exact:
    """Return the solution, found once."""
    return Exact(poisson, widened)
