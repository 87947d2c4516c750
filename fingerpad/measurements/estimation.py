r"""Least squares with people: values common to all, their spread between people, and the evidence for a model.

Rows have the logarithms y of what was measured. Person p has the parameters :math:`\theta + b_p` (logarithms too), with
:math:`b_p` normal about 0 with the variances :math:`\Omega = diag(\omega^2)`. To first order in :math:`b_p`, with the
Jacobian J at :math:`\theta`, the rows of a person are normal:

.. math:: y_p \sim N(f_p(\theta),\; V_p), \qquad V_p = J_p \Omega J_p^T + \sigma^2 S_p ,

with the rows' own variances S (the first-order method, Sheiner and Beal 1980, doi 10.1007/BF01060053; of the linear
model Laird and Ware 1982, doi 10.2307/2529876). :math:`\theta` minimises the whitened squares and those of a normal
prior, by :func:`scipy.optimize.least_squares`. Then :math:`\Omega` and, where it is not known, :math:`\sigma` maximise
the restricted likelihood, and the two are repeated. The evidence is Akaike's criterion for few rows,

.. math:: AICc = -2 \ln L + 2 K + \frac{2 K (K + 1)}{n - K - 1}

of the whole likelihood, K parameters and variances, and n rows (Hurvich and Tsai 1989, doi 10.1093/biomet/76.2.297).
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy  # its parts are imported where they are used first
from numpy.typing import NDArray

Array = NDArray[np.float64]
FEW = 3
"""Number of people from which on a spread between them is estimated."""
_STEP = 1e-4  # of a logarithm, for derivatives
_FIRST = 0.3  # standard deviation of rows, and between people, of the first round
_ROUNDS, _SAME = 12, 0.01  # of parameters and variances in turn; of -2 ln L, what changes no conclusion
_ENDS = {"ftol": 1e-5, "xtol": 1e-5, "gtol": 1e-8, "max_nfev": 12}
_SPREADS = (1e-4, 3.0)  # least and largest standard deviation of a logarithm
_LEVEL = 0.95


@dataclass(frozen=True, eq=False)
class Data:
    """Rows, and what is known of parameters beforehand; logarithms.

    Args:
        y: shape (rows,).
        spread: standard deviation of each row; all 1 where they are not ``known`` and their one scale is estimated.
        people: rows of each person; those of all where there are none.
        centre: mean of the prior, shape (parameters,), whose standard deviation is ``width``.
        bounds: of the parameters.
    """

    y: Array
    spread: Array
    known: bool
    people: Sequence[NDArray[np.intp]]
    centre: Array
    width: float
    bounds: tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Estimate:
    """Parameters, their variances and the rows at them."""

    data: Data
    theta: Array
    fitted: Array
    jacobian: Array
    omega: Array
    """Standard deviations between people, shape (parameters,); 0 where none is estimated."""
    sigma: float
    """Factor on the spreads of rows."""

    def _of_people(self, omega: Array, sigma: float) -> Iterator[tuple[NDArray[np.intp], Array, Array]]:
        """Yield of each person rows, the Cholesky factor of V, and Jacobian and residual side by side."""
        for rows in self.data.people:
            j = self.jacobian[rows]
            v = j * omega @ (j * omega).T + np.diag((sigma * self.data.spread[rows]) ** 2)
            yield rows, np.linalg.cholesky(v), np.column_stack([j, (self.data.y - self.fitted)[rows]])  # type: ignore[misc]

    def white(self, values: Array) -> Array:
        """Return values of the rows, shape (rows, …), whitened: with the variance 1, person by person."""
        out = np.empty_like(values)
        for rows, factor, _ in self._of_people(self.omega, self.sigma):
            out[rows] = scipy.linalg.solve_triangular(factor, values[rows], lower=True)
        return out

    @cached_property
    def _products(self) -> Array:
        """Products of Jacobian and residual over spreads, of each person, shape (people, parameters + 1, same)."""
        both = np.column_stack([self.jacobian, self.data.y - self.fitted]) / self.data.spread[:, None]
        return np.array([both[rows].T @ both[rows] for rows in self.data.people])

    def deviance(self, omega: Array, sigma: float, restricted: bool) -> float:
        r"""Return -2 ln L of these variances at the best linear parameters; restricted, or of the whole likelihood.

        By :math:`J^T V^{-1} = (\sigma^2 I + A \Omega)^{-1} J^T S^{-1}` with :math:`A = J^T S^{-1} J` of each person.
        """
        pull, products, n = (self.data.centre - self.theta) / self.data.width**2, self._products, len(self.data.y)
        inner = np.eye(len(pull)) + products[:, :-1, :-1] * omega**2 / sigma**2
        solved = np.linalg.solve(inner, products[:, :-1]) / sigma**2
        m = np.eye(len(pull)) / self.data.width**2 + solved[..., :-1].sum(axis=0)
        g = pull + solved[..., -1].sum(axis=0)
        shifts = (products[:, :-1, -1] * omega**2 * solved[..., -1]).sum(axis=1)
        squares = (products[:, -1, -1] - shifts) / sigma**2
        total = float(pull @ pull) * self.data.width**2 + float((squares + np.linalg.slogdet(inner)[1]).sum())
        total += n * math.log(2 * math.pi * sigma**2) + 2 * float(np.log(self.data.spread).sum())
        return total - float(g @ np.linalg.solve(m, g)) + restricted * float(np.linalg.slogdet(m)[1])

    def variances(self, restricted: bool = True) -> tuple[Array, float, float]:
        """Return the standard deviations between people and the factor on spreads of least deviance, and that."""
        many, known = self.omega.any(), self.data.known
        start = np.log([*(self.omega if many else []), *([] if known else [self.sigma])])

        def split(x: Array) -> tuple[Array, float]:
            return np.exp(x[: len(self.theta)]) if many else self.omega, self.sigma if known else math.exp(x[-1])

        if not len(start):
            return self.omega, self.sigma, self.deviance(self.omega, self.sigma, restricted)
        bounds = [tuple(np.log(_SPREADS))] * len(start)
        best = scipy.optimize.minimize(
            lambda x: self.deviance(*split(x), restricted), start, method="L-BFGS-B", bounds=bounds
        )
        return (*split(best.x), float(best.fun))

    @property
    def freedom(self) -> float:
        """Degrees of freedom of Student's t: people less one, else rows less parameters; none of known spreads."""
        if self.omega.any():
            return len(self.data.people) - 1
        return np.inf if self.data.known else max(len(self.data.y) - len(self.theta), 1)

    @property
    def quantile(self) -> float:
        """Half width of the 95 % region over the standard error."""
        return float(scipy.stats.t.ppf((1 + _LEVEL) / 2, self.freedom))

    @cached_property
    def covariance(self) -> Array:
        """Of the parameters, shape (parameters, parameters)."""
        j = self.white(self.jacobian)
        return np.linalg.inv(j.T @ j + np.eye(len(self.theta)) / self.data.width**2)

    @cached_property
    def directions(self) -> tuple[Array, Array]:
        """Standard errors of combinations of parameters by the rows alone, the best known first, and their vectors."""
        _, values, vectors = np.linalg.svd(self.white(self.jacobian), full_matrices=True)
        every = np.concatenate([values, np.zeros(len(self.theta) - len(values))])
        return 1 / np.maximum(every, 1e-300), vectors

    @cached_property
    def shifts(self) -> list[tuple[Array, Array]]:
        """Of each person the expected difference b from the common parameters, and the covariance of their sum."""
        found = []
        for rows, factor, both in self._of_people(self.omega, self.sigma):
            own = np.diag(self.omega**2) @ self.jacobian[rows].T @ scipy.linalg.cho_solve((factor, True), both)
            left = np.eye(len(self.theta)) - own[:, :-1]
            found.append((own[:, -1], left @ self.covariance @ left.T + left @ np.diag(self.omega**2)))
        return found

    def predicted(self, values: Array, jacobian: Array, spread: Array, person: int | None) -> tuple[Array, Array]:
        """Return logarithms of new rows and their standard deviations.

        Args:
            values: of the model at the common parameters, shape (rows,).
            jacobian: there.
            spread: of the rows, by which ``sigma`` is multiplied.
            person: number of a person whose rows were fitted; None of another one, who adds the spread between people.
        """
        shift, of_both = 0.0 * self.theta, self.covariance + np.diag(self.omega**2)
        if person is not None:
            shift, of_both = self.shifts[person]
        variance = np.einsum("ik,kl,il->i", jacobian, of_both, jacobian) + (self.sigma * spread) ** 2
        return values + jacobian @ shift, np.sqrt(variance)

    @cached_property
    def criterion(self) -> float:
        """AICc, see above; infinite where there are too few rows."""
        count = len(self.theta) + np.count_nonzero(self.omega) + (not self.data.known)
        left = len(self.data.y) - count - 1
        return self.variances(restricted=False)[-1] + (2 * count * (1 + (count + 1) / left) if left > 0 else np.inf)


def slopes(model: Callable[[Array], Array], theta: Array, here: Array) -> Array:
    """Return the Jacobian of a model, whose value at the parameters is ``here``, by differences.

    Raises:
        ValueError: the model has no value on either side.
    """
    columns: list[NDArray[np.floating]] = []
    for unit in np.eye(len(theta)):
        beside = ((step, model(theta + step * unit)) for step in (_STEP, -_STEP))
        found = next(((values - here) / step for step, values in beside if np.isfinite(values).all()), None)
        if found is None:
            raise ValueError(f"parameter {len(columns)} has no value on either side")
        columns.append(found)
    return np.column_stack(columns)


def estimate(model: Callable[[Array], Array], start: Array, data: Data) -> Estimate:
    """Return the parameters of a model and their variances.

    Args:
        model: returns the logarithms of the rows at parameters; NaN where it has no answer.
        start: parameters at which it has one.
        data: the rows.

    Raises:
        ValueError: the model has no answer beside the start.
    """
    many, values, jacobians = len(data.people) >= FEW, dict[bytes, Array](), dict[bytes, Array]()

    def at(x: Array) -> Array:
        return values[x.tobytes()] if x.tobytes() in values else values.setdefault(x.tobytes(), model(x))

    def slope(x: Array) -> Array:
        key = x.tobytes()
        return jacobians[key] if key in jacobians else jacobians.setdefault(key, slopes(model, x, at(x)))

    scale = 1.0 if data.known else _FIRST
    found = Estimate(data, start, at(start), slope(start), np.full_like(start, _FIRST * many), scale)
    pull, deviance = np.eye(len(start)) / data.width, np.inf
    for _ in range(_ROUNDS):
        before = found
        solved = scipy.optimize.least_squares(
            lambda x, by=before: np.concatenate([by.white(at(x) - data.y), pull @ (x - data.centre)]),
            before.theta,
            lambda x, by=before: np.vstack([by.white(slope(x)), pull]),
            bounds=data.bounds,
            **_ENDS,
        )
        found = Estimate(data, solved.x, at(solved.x), slope(solved.x), before.omega, before.sigma)
        omega, sigma, now = found.variances()
        found = replace(found, omega=omega, sigma=sigma)
        if deviance - now < _SAME:
            break
        deviance = now
    return found
