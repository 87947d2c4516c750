r"""Measurements and computed values row by row, with the friction coefficient of rows at 0 V, and their misfit.

At full slip Coulomb's law gives :math:`f_T = \mu_0 (f_{ext} + f_{el})`. Without voltage the measured friction is
:math:`\mu_0` itself, the mean over the rows at 0 V, and computed friction is scaled from the scene's coefficient to it.
*Assumption*: the attraction stays that of the scene's coefficient, on which the contact length depends a little. Errors
at 0 V are then zero on average by construction, so that these rows are left out of the misfit.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fingerpad.measurements import table as tables
from fingerpad.measurements.computed import CLOSE, Array, Computed, Source, computed
from fingerpad.measurements.table import Measured
from fingerpad.scene.messages import SceneError

_COLUMNS = ("force", "voltage", "measured", "spread", "mu_0", "computed", "error", "difference", "relative_difference")
"""Columns of a comparison."""


def compare(
    table: str | Path | pd.DataFrame,
    result: Source | Sequence[Source],
    columns: Mapping[str, str | None] | None = None,
    state: str | None = None,
) -> pd.DataFrame:
    """Return a table of measurements with the computed values at the same forces and voltages.

    Args:
        table: a CSV file or a DataFrame (:mod:`fingerpad.measurements.table`).
        result: a result, several, a sweep, or folders of them.
        columns: names of this program by heads of the table: ``{"Fn": "force (N)", "CoF": "friction (1)"}``; an empty
            name leaves a column out.
        state: ``"uncharged"``, ``"charged"`` or ``"full slip"``; by default that of the table, else full slip.

    Returns:
        A row for each row of the table, in SI units, NaN where a value is not known: ``force``, ``voltage``,
        ``measured``, ``spread``, ``computed``, ``error`` (whole known error of the computed value),
        ``difference`` (computed less measured) and ``relative_difference`` (of the measured value). Computed friction
        is that of the coefficient of the rows at 0 V, where there are such, in a column ``mu_0``. Its ``attrs`` hold
        the quantity, the units, the source, the state, the heads of ignored columns, the number of rows with a friction
        below 0 (``turned``), the coefficient of the results (``mu_0``), the ``misfit``, and ``fit``: the coefficient
        ``mu_0``, the standard deviation ``spread`` and the number of ``rows`` at 0 V.

    Raises:
        SceneError: the table or the results cannot be compared, in one sentence.
    """
    measured = tables.read(table, columns, state)
    return comparison(measured, computed(result, measured))


def comparison(table: Measured, known: Computed) -> pd.DataFrame:
    """Return the rows of :func:`compare`.

    Raises:
        SceneError: no row of the table is within the forces and voltages of the results, or the value is 0 in all.
    """
    rows = table.rows.copy()
    for name, unit in (("force", table.force_unit), ("voltage", "V")):
        if name not in rows:
            rows[name] = _single(table.name, name, unit, known.points[name].unique())
    rows["computed"], rows["error"] = known.at(rows.force.to_numpy(), rows.voltage.to_numpy())
    none = int(rows.computed.isna().sum())
    if none == len(rows):
        raise SceneError(f"no row of {table.name} is within the results, which have {known.reach(table.force_unit)}")
    if not (rows.computed > 0).any():
        beyond = f", and {none} of them are not within the results" if none else ""
        raise SceneError(f"no {table.quantity} above 0 is computed in the {len(rows)} rows of {table.name}{beyond}")
    rows, fit = _fitted(rows, table.quantity, known.mu_0)
    file = table.path or table.name
    about: dict[str, Any] = {"source": file, **table.about, "table": file, "ignored": table.ignored}
    about |= {"state": table.state, "quantity": table.quantity, "unit": table.unit, "force_unit": table.force_unit}
    used = rows[rows.voltage > 0] if fit else rows
    about |= {"turned": table.turned, "mu_0": known.mu_0, "fit": fit, "misfit": misfit(used)}
    rows = rows[[name for name in _COLUMNS if name in rows]]
    rows.attrs = about
    return rows


def _single(table: str, name: str, unit: str, values: Array) -> float:
    """Return the one force or voltage of results, for a table without it; forces within 1 % are one, their mean."""
    if len(values) > 1 and (name == "voltage" or not math.isclose(values.min(), values.max(), rel_tol=CLOSE)):
        raise SceneError(f"{table} has no {name}, and the results have {len(values)}; add a column '{name} ({unit})'")
    return float(values.mean())


def _fitted(rows: pd.DataFrame, quantity: str, mu_0: float | None) -> tuple[pd.DataFrame, dict[str, float]]:
    """Return rows with differences, and the coefficient that they are fitted with; empty without one.

    Args:
        rows: with ``force``, ``voltage``, ``measured``, ``spread``, ``computed`` and ``error``.
        quantity: of the table; another one than friction has no coefficient.
        mu_0: friction coefficient of the results; None where it cannot be fitted.
    """
    still, charged = rows[rows.voltage == 0], rows[(rows.voltage > 0) & (rows.computed > 0)]
    if mu_0 is None or not quantity.startswith("friction") or still.empty or charged.empty:
        return _scaled(rows, 1.0), {}
    mu = still.measured / (still.force if quantity == "friction force" else 1.0)
    fit = {"mu_0": float(mu.mean()), "spread": float(mu.std()), "rows": len(mu)}
    return _scaled(rows.assign(mu_0=fit["mu_0"]), fit["mu_0"] / mu_0), fit


def _scaled(rows: pd.DataFrame, factor: float) -> pd.DataFrame:
    """Return rows with computed values and errors times a factor, and the differences."""
    rows = rows.assign(computed=rows.computed * factor, error=rows.error * factor)
    difference = rows.computed - rows.measured
    return rows.assign(difference=difference, relative_difference=difference / rows.measured.where(rows.measured > 0))


def misfit(rows: pd.DataFrame) -> dict[str, float]:
    """Return the distance of computed values from measured ones, as ratios.

    Args:
        rows: of :func:`compare`.

    Returns:
        ``ratio``: geometric mean of computed over measured; ``factor``: the largest factor between the two;
        ``shape_factor``: the same once the computed values are scaled by one factor; ``rows``: number of these, without
        those where one of the two is not known or 0; ``spreads``: number of these that have a spread; ``within``:
        number of those that differ by no more than the spread plus the error. Empty without such rows.
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
