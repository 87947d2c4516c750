"""Measurements beside a quantity of finished runs or of a sweep, row by row, and their misfit; no dolfinx."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fingerpad.measurements import table as tables
from fingerpad.measurements.computed import CLOSE, Array, Computed, Source, computed
from fingerpad.measurements.fit import fitted, misfit
from fingerpad.measurements.table import PERSON, Measured
from fingerpad.scene.messages import SceneError

COLUMNS = ("force", "voltage", "measured", "spread", "mu_0", "computed", "error", "difference", "relative_difference")
"""Columns of a comparison, beside the participant."""


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
        ``difference`` (computed less measured) and ``relative_difference`` (of the measured value), and ``participant``
        where the table has it. Computed friction is that of the coefficient of the rows at 0 V, where there are such
        (:mod:`fingerpad.measurements.fit`), in a column ``mu_0``. Its ``attrs`` hold the quantity, the units, the
        source, the state, the heads of ignored columns, how many rows have a friction below 0 (``turned``), the
        coefficient of the results (``mu_0``), the ``fits`` and the ``misfit``.

    Raises:
        SceneError: the table or the results cannot be compared, in one sentence.
    """
    measured = tables.read(table, columns, state)
    return beside(measured, computed(result, measured))


def beside(table: Measured, known: Computed) -> pd.DataFrame:
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
    rows, found = fitted(rows, table.quantity, known.mu_0)
    file = table.path or table.name
    about: dict[str, Any] = {"source": file, **table.about, "table": file, "ignored": table.ignored}
    about |= {"state": table.state, "quantity": table.quantity, "unit": table.unit, "force_unit": table.force_unit}
    about |= {"turned": table.turned, "mu_0": known.mu_0, "fits": found}
    used = rows[rows.voltage > 0] if found else rows
    rows = rows[[name for name in (PERSON, *COLUMNS) if name in rows]]
    rows.attrs = about | {"misfit": misfit(used)}
    return rows


def _single(table: str, name: str, unit: str, values: Array) -> float:
    """Return the one force or voltage of results, for a table without it; forces within 1 % are one, their mean."""
    if len(values) > 1 and (name == "voltage" or not math.isclose(values.min(), values.max(), rel_tol=CLOSE)):
        raise SceneError(f"{table} has no {name}, and the results have {len(values)}; add a column '{name} ({unit})'")
    return float(values.mean())
