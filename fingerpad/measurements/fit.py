r"""The friction coefficient of measured rows at 0 V, of each participant and of all, and the misfit that is left.

At full slip Coulomb's law gives :math:`f_T = \mu_0 (f_{ext} + f_{el})`. Without voltage the measured friction is
:math:`\mu_0` itself, the mean over the rows at 0 V, and computed friction is scaled from the scene's coefficient to it.
*Assumption*: the attraction stays that of the scene's coefficient, on which the contact length depends a little. Errors
at 0 V are then zero on average by construction, so that these rows are left out of the misfit.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from fingerpad.measurements.table import PERSON

ALL = "all together"


@dataclass(frozen=True)
class Fit:
    """The friction coefficient without voltage of a participant, or of all."""

    who: str
    """A participant, or :data:`ALL`."""
    mu_0: float
    """Mean over the rows at 0 V."""
    spread: float
    """Their standard deviation; NaN of one row."""
    rows: int
    """How many they are; 0 of a participant without any, who has the coefficient of all."""
    misfit: dict[str, float] = field(default_factory=dict)
    """Of :func:`misfit`, of the rows under voltage with this coefficient."""


def fits(rows: pd.DataFrame, quantity: str) -> list[Fit]:
    """Return the fit of each participant, then that of all; none without a row at 0 V beside others under voltage.

    Args:
        rows: with ``force``, ``voltage``, ``measured`` and ``computed`` (NaN where it is not known).
        quantity: of the table; another one than friction has no coefficient.
    """
    charged = (rows.voltage > 0) & (rows.computed > 0)
    if not quantity.startswith("friction") or not (rows.voltage == 0).any() or not charged.any():
        return []
    still = rows[rows.voltage == 0]
    mu = still.measured / (still.force if quantity == "friction force" else 1.0)
    every = _fit(ALL, mu)
    if PERSON not in rows:
        return [every]
    people = [_fit(str(who), mu[still[PERSON] == who]) for who in rows[PERSON].unique()]
    return [*(each if each.rows else Fit(each.who, every.mu_0, math.nan, 0) for each in people), every]


def _fit(who: str, mu: "pd.Series[float]") -> Fit:
    return Fit(who, float(mu.mean()) if len(mu) else math.nan, float(mu.std()) if len(mu) > 1 else math.nan, len(mu))


def fitted(rows: pd.DataFrame, quantity: str, mu_0: float | None) -> tuple[pd.DataFrame, list[Fit]]:
    """Return rows with the coefficients of their fits and with differences, and the fits with their misfits.

    Args:
        rows: as of :func:`fits`, with ``spread`` and ``error``.
        quantity: of the table.
        mu_0: friction coefficient of the results; None where it cannot be fitted.
    """
    found = fits(rows, quantity) if mu_0 else []
    if mu_0 is None or not found:
        return _scaled(rows, 1.0), []
    of = {each.who: each.mu_0 for each in found}
    own = rows[PERSON].map(of) if PERSON in rows else pd.Series(of[ALL], index=rows.index)
    charged, done = rows[rows.voltage > 0], list[Fit]()
    for each in found:
        mine = charged if each.who == ALL else charged[charged[PERSON] == each.who]
        done.append(replace(each, misfit=misfit(_scaled(mine, each.mu_0 / mu_0))))
    return _scaled(rows.assign(mu_0=own), own / mu_0), done


def _scaled(rows: pd.DataFrame, factor: "float | pd.Series[float]") -> pd.DataFrame:
    """Return rows with computed values and errors times a factor, and the differences."""
    rows = rows.assign(computed=rows.computed * factor, error=rows.error * factor)
    difference = rows.computed - rows.measured
    return rows.assign(difference=difference, relative_difference=difference / rows.measured.where(rows.measured > 0))


def misfit(rows: pd.DataFrame) -> dict[str, float]:
    """Return how far computed values are from measured ones, as ratios.

    Args:
        rows: of :func:`fingerpad.measurements.compare.compare`.

    Returns:
        ``ratio``: geometric mean of computed over measured; ``factor``: the largest factor between the two;
        ``shape_factor``: the same once the computed values are scaled by one factor; ``rows``: how many these are of,
        the others having no computed value, or one of the two being 0; ``spreads``: how many of these have a spread;
        ``within``: how many of those differ by no more than the spread plus the error. Empty without such rows.
    """
    used = rows[(rows.computed > 0) & (rows.measured > 0)]
    if used.empty:
        return {}
    log = np.log(used.computed / used.measured)
    with_spread = used[used.spread.notna()]
    near = with_spread.difference.abs() <= with_spread.spread + with_spread.error.fillna(0.0)
    ratios = {"ratio": log.mean(), "factor": log.abs().max(), "shape_factor": (log - log.mean()).abs().max()}
    counts = {"rows": len(used), "spreads": len(with_spread), "within": int(near.sum())}
    return {name: float(np.exp(value)) for name, value in ratios.items()} | counts
