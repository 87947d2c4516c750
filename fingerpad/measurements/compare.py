r"""Measurements and computed values row by row, with the friction coefficient of rows at 0 V, and their misfit.

At full slip Coulomb's law gives :math:`f_T = \mu_0 (f_{ext} + f_{el})`. Without voltage the measured friction is
:math:`\mu_0` itself, the mean over the rows at 0 V, and computed friction is scaled from the scene's coefficient to it.
*Assumption*: the attraction stays that of the scene's coefficient, on which the contact length depends a little. Errors
at 0 V are then zero on average by construction, so that these rows are left out of the misfit.
"""

import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from fingerpad.measurements import table as tables
from fingerpad.measurements.table import Measured
from fingerpad.report.sweep_page import Table
from fingerpad.report.write import read as content
from fingerpad.results.result import Result
from fingerpad.results.states import WORDS, before_sliding
from fingerpad.runs.sweep_results import Sweep
from fingerpad.scene.messages import SceneError, clip, ends, refuse_type, show
from fingerpad.scene.reading import flat

_COLUMNS = ("force", "voltage", "measured", "spread", "mu_0", "computed", "error", "difference", "relative_difference")
"""Columns of a comparison."""
Array = NDArray[np.float64]
Source = Result | Sweep | Table | str | Path
"""What values are taken from: a result, a sweep, or the folder of one."""
_SOURCES = "a result of fp.run, a sweep of fp.sweep, a folder of either, or a list of these"
_CLOSE = 0.01  # relative distance of a force beyond the known ones up to which their end stands for it
_SAME_CONDITION = 1e-6  # relative difference of conditions that are the same
_SAME_VALUE = 1e-4  # relative difference of values at the same conditions: beyond any tolerance of the solvers
_FREE = re.compile(  # keys in which runs may differ:
    r"(history\[\d+\]\.)?(f_ext|force|voltage)"  # the conditions of a measurement,
    r"|history\[\d+\]\.(bone_height|name)"  # the force by another control, and a word for it,
    r"|output\.(errors|each_load|receptors)|numerics\.memory"  # and what changes no value
)


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


def comparison(table: Measured, known: "Computed") -> pd.DataFrame:
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
    if len(values) > 1 and (name == "voltage" or not math.isclose(values.min(), values.max(), rel_tol=_CLOSE)):
        raise SceneError(f"{table} has no {name}, and the results have {len(values)}; add a column '{name} ({unit})'")
    return float(values.mean())


def _fitted(rows: pd.DataFrame, quantity: str, mu_0: float | None) -> tuple[pd.DataFrame, dict[str, float]]:
    """Return rows with differences, and the coefficient that they are fitted with; empty without one.

    Args:
        rows: with ``force``, ``voltage``, ``measured``, ``spread``, ``computed`` and ``error``.
        quantity: of the table; another one than friction has no coefficient.
        mu_0: friction coefficient of the results; None where it cannot be fitted.
    """
    still, charged, fit = rows[rows.voltage == 0], rows[(rows.voltage > 0) & (rows.computed > 0)], {}
    if mu_0 is not None and quantity.startswith("friction") and not still.empty and not charged.empty:
        mu = still.measured / (still.force if quantity == "friction force" else 1.0)
        fit = {"mu_0": float(mu.mean()), "spread": float(mu.std()), "rows": len(mu)}
        factor = fit["mu_0"] / mu_0
        rows = rows.assign(mu_0=fit["mu_0"], computed=rows.computed * factor, error=rows.error * factor)
    difference = rows.computed - rows.measured
    relative = difference / rows.measured.where(rows.measured > 0)
    return rows.assign(difference=difference, relative_difference=relative), fit


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


# -- computed values -------------------------------------------------------------------------------------------
class Computed:
    """A quantity at points of force and voltage, and between them; SI units.

    Between two forces it is taken as a power law, and as linear where it is 0 at one of them. Between two voltages it
    is taken as linear in U², as which attraction rises. Up to 1 % beyond the forces of a voltage the value at the last
    one is taken: the newtons of one f_ext differ a little between voltages.
    """

    def __init__(self, points: pd.DataFrame, mu_0: Any = None) -> None:
        """Take points and the friction coefficient of the results.

        Args:
            points: columns force, voltage, value (NaN where a run has no result) and error.
            mu_0: of Coulomb's law; another law, or no number, is none that can be fitted.
        """
        self.mu_0 = mu_0 if isinstance(mu_0, float) and mu_0 > 0 else None
        self.points = points.sort_values(["voltage", "force"], ignore_index=True)
        self._curves = [
            (float(voltage), curve.force.to_numpy(), curve[["value", "error"]].to_numpy(dtype=float))
            for voltage, curve in self.points.groupby("voltage")
        ]

    def at(self, force: Array, voltage: Array) -> tuple[Array, Array]:
        """Return values and their errors at pairs of force and voltage; NaN where they are not known.

        The errors are interpolated as the values are, and do not contain the error of the interpolation.
        """
        squares, found = np.array([u**2 for u, _, _ in self._curves]), np.empty((len(force), 2))
        for k, (f, u) in enumerate(zip(force, voltage, strict=True)):
            over = np.array([_over_force(f, forces, values) for _, forces, values in self._curves])
            found[k] = _between(u**2, squares, over)
        return found[:, 0], found[:, 1]

    def reach(self, force_unit: str) -> str:
        """Return in words which forces there are at which voltage."""
        each = (f"{forces[0]:g} to {forces[-1]:g} {force_unit} at {voltage:g} V" for voltage, forces, _ in self._curves)
        return clip(", ".join(each), 200)


def _over_force(force: float, known: Array, values: Array) -> Array:
    """Return the values, shape (columns,), at a force from those at known forces, shape (forces, columns)."""
    end = float(np.clip(force, known[0], known[-1]))
    x = end if math.isclose(force, end, rel_tol=_CLOSE) else force
    linear = _between(x, known, values)
    if not known[0] < x < known[-1] or np.isclose(known, x, rtol=_SAME_CONDITION, atol=0.0).any():
        return linear
    k = int(np.searchsorted(known, x))
    low, high = values[k - 1], values[k]
    with np.errstate(divide="ignore", invalid="ignore"):
        power = low * (high / low) ** (math.log(x / known[k - 1]) / math.log(known[k] / known[k - 1]))
    return np.where((low > 0) & (high > 0), power, linear)


def _between(x: float, known: Array, values: Array) -> Array:
    """Return the values at one of the known places up to roundoff, or linear between two of them; NaN beyond."""
    near = np.flatnonzero(np.isclose(known, x, rtol=_SAME_CONDITION, atol=0.0))
    if near.size:
        return np.asarray(values[near[0]])
    inside = known[0] < x < known[-1]
    return np.array([np.interp(x, known, column) if inside else math.nan for column in values.T])


def computed(source: Source | Sequence[Source], table: Measured) -> Computed:
    """Return the quantity of a table in runs or in a sweep.

    Raises:
        SceneError: the source is of another type, the quantity is not there, the runs differ in more than force and
            voltage, or two of them have other values at the same force and voltage.
    """
    found = list[Any]()
    many = isinstance(source, Sequence) and not isinstance(source, Sweep | str | bytes)
    sources: Any = source
    if not many:
        sources = [source]
    for each in sources:
        refuse_type("result", each, Source, _SOURCES)
        found += each if isinstance(each, Sweep) else [content(Path(each)) if isinstance(each, str | Path) else each]
    if not found:
        raise SceneError(f"result is empty; it must be {_SOURCES}")
    if sweep := next((each for each in found if isinstance(each, Table)), None):
        if len(found) > 1:
            raise SceneError(f"the sweep in {ends(sweep.folder)} is given with others; give one sweep, or runs")
        points, mu_0 = _of_sweep(sweep, table), sweep.parameters.get("friction")
    else:
        refuse_mixed(found)
        points, mu_0 = _of_runs(found, table), found[0].scene.friction
    if points.empty or points.value.isna().all():
        what = "state" if points.empty else "friction coefficient" if table.key == "mu_app" else table.quantity
        raise SceneError(f"the results have no {what} of {WORDS[table.state]}, which {table.name} has")
    return Computed(points, mu_0)


# -- runs ----------------------------------------------------------------------------------------------------
_Point = dict[str, Any]


def _of_runs(runs: Sequence[Result], table: Measured) -> pd.DataFrame:
    """Return the values of all runs; of one run the last state at a force and a voltage."""
    points = list[_Point]()
    for run in runs:
        for point in _of_finger(run, table) if table.whole else _section(run, table):
            if (same := next((each for each in points if _same(each, point)), None)) is not None:
                allowed = _SAME_VALUE * abs(same["value"]) + np.nansum([same["error"], point["error"]])
                if same["run"] is not run and abs(same["value"] - point["value"]) > allowed:
                    raise SceneError(
                        f"{table.quantity} is {same['value']:.6g} in {_folder(same['run'])} and {point['value']:.6g} "
                        f"in {_folder(run)}, both at {point['force']:.6g} {table.force_unit} and "
                        f"{point['voltage']:g} V; give one of them"
                    )
                points.remove(same)
            points.append(point)
    return pd.DataFrame(points, columns=["force", "voltage", "value", "error"])


def _same(one: _Point, other: _Point) -> bool:
    """Return whether two points have the same force and voltage up to roundoff."""
    return all(math.isclose(one[key], other[key], rel_tol=_SAME_CONDITION) for key in ("force", "voltage"))


def _section(run: Result, table: Measured) -> Iterator[_Point]:
    """Yield the values of the cross-section: of the whole press in the uncharged state, else of the named state.

    The named state stands in place of its step: it has errors, and may be of a finer mesh.
    """
    key, sign = ("bone_height", -1) if table.key == "depth" else (table.key, 1)
    named, states = run.named.get(table.state), []
    if table.state == "uncharged":
        states = [s for s in before_sliding(run.steps) if s.voltage == 0 and s.ridges_in_contact and s.f_ext > 0]
        states = [named if named is not None and named.step == s.step else s for s in states]
    for state in states or [s for s in (named,) if s is not None]:
        value, error = sign * float(getattr(state, key)), float(getattr(state.error, key, math.nan))
        yield {"force": state.f_ext, "voltage": abs(state.voltage), "value": value, "error": error, "run": run}


def _of_finger(run: Result, table: Measured) -> Iterator[_Point]:
    """Yield the value of the whole finger under the run's force."""
    finger, state = run.finger, table.state
    if finger is None:
        raise SceneError(
            f"the run has no newtons, which {table.name} has; run its scene, of press, charge and slide, with --force"
        )
    if state in finger.states:
        voltage = 0.0 if state == "uncharged" else abs(run.named[state].voltage)
        error = finger.error.get(state, {}).get(table.key, math.nan)
        value = finger.values(state)[table.key]
        yield {"force": finger.f_ext, "voltage": voltage, "value": value, "error": error, "run": run}


def refuse_mixed(runs: Sequence[Result]) -> None:
    """Refuse runs that differ in more than force and voltage: their values are no function of the two.

    Raises:
        SceneError: the first key that differs, its two values and the two folders.
    """
    first, *others = ({"model": run.model} | flat(run.scene.parameters()) for run in runs)
    for run, other in zip(runs[1:], others, strict=True):
        for key in dict.fromkeys([*first, *other]):
            if first.get(key) != other.get(key) and not _FREE.fullmatch(key):
                values = (each.get(key) for each in (first, other))
                one, two = ("not given" if value is None else clip(show(value), 40) for value in values)
                raise SceneError(
                    f"{key} is {one} in {_folder(runs[0])} and {two} in {_folder(run)}; "
                    "give runs that differ in force and voltage alone"
                )


def _folder(run: Result) -> str:
    """Return the folder of a run for a message."""
    return "a run" if run.folder is None else ends(min(str(run.folder), os.path.relpath(run.folder), key=len), 50)


# -- sweeps --------------------------------------------------------------------------------------------------
def _of_sweep(sweep: Table, table: Measured) -> pd.DataFrame:
    """Return the values in the table of a sweep."""
    keys, fixed = {"force": "force" if table.whole else "f_ext", "voltage": "voltage"}, sweep.parameters
    if not set(sweep.axes) <= set(keys.values()) <= {*sweep.axes, *fixed}:
        raise SceneError(
            f"the sweep in {ends(sweep.folder)} is over {', '.join(sweep.axes)}, and {table.name} has forces in "
            f"{table.force_unit}; give one over {keys['force']} and voltage alone, or runs"
        )
    rows = pd.DataFrame(sweep.rows)
    column = f"{table.state}_{'finger_' if table.whole else ''}{table.key}"
    if column not in rows:
        raise SceneError(
            f"the table of the sweep has no {table.quantity} of {WORDS[table.state]}, which {table.name} has; "
            "give one of its runs"
        )
    taken = {name: rows[key] if key in rows else fixed[key] for name, key in keys.items()}
    taken |= {"value": rows[column], "error": rows.get(f"{column}_error", math.nan)}
    try:
        points = pd.DataFrame(taken).astype(float)
    except (ValueError, TypeError) as error:
        raise SceneError(f"the table of the sweep in {ends(sweep.folder)} cannot be read: {error}") from None
    points["voltage"] = 0.0 if table.state == "uncharged" else points.voltage.abs()
    # Another run may have the value, at another voltage or sign of it.
    return points.sort_values("value", key=pd.isna, kind="stable").drop_duplicates(["force", "voltage"])
