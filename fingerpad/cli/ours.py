"""What a finished run or sweep has at the conditions of a measurement; no dolfinx."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from fingerpad.cli import one_scene
from fingerpad.cli.curves import CLOSE, NEAR, Array, At, Curve, Ours, Value
from fingerpad.cli.measured import Measured
from fingerpad.io.result import Result
from fingerpad.io.states import PREFIXES, WORDS, before_sliding
from fingerpad.report.source import Table
from fingerpad.report.source import read as folder_of
from fingerpad.runs.sweep_columns import FORCE
from fingerpad.scene.messages import SceneError, clip
from fingerpad.slices.finger import WholeFinger
from variational.state import ContactState

CONDITIONS = {"f_ext": "force", "voltage": "voltage"}
_SAME = 1e-4  # relative, of values at the same conditions: beyond any tolerance of the solvers


def read(folders: Sequence[Path], sweep: bool) -> list[Result] | Table:
    """Return the runs in folders, or the sweep in one.

    Raises:
        SceneError: it is not there, is of the other kind, or the runs differ in more than force and voltage.
    """
    runs: list[Result] = []
    for folder in folders:
        found = folder_of(folder)
        if isinstance(found, Table) != sweep:
            given, right = ("--run", "--sweep") if isinstance(found, Table) else ("--sweep", "--run")
            kind = "a sweep" if isinstance(found, Table) else "a run"
            raise SceneError(f"{given} {clip(str(folder), 80)} holds {kind}; give it by {right}")
        if isinstance(found, Table):
            return found
        runs.append(found)
    one_scene.refuse_mixed(runs)
    return runs


def ours(found: Sequence[Result] | Table, table: Measured) -> Ours:
    """Return the quantity of a table in runs or a sweep.

    Raises:
        SceneError: ours does not have it, or two runs have other values at the same force and voltage.
    """
    if isinstance(found, Table):
        return _of_sweep(found, table)
    points = _joined(found, table)
    if not points:
        raise SceneError(f"the run has no state {WORDS[table.state]}, of which {_name(table)} is; compare another run")
    return _curves(points, table)


def _joined(runs: Sequence[Result], table: Measured) -> dict[At, Value]:
    """Return the values of all runs by force and voltage; of one run the last state there.

    Raises:
        SceneError: two runs have other values at the same force and voltage.
    """
    points, of = dict[At, Value](), dict[At, Result]()
    for run in runs:
        for at, value in (_whole if table.whole else _section)(run, table):
            place = next((known for known in points if _same(known, at)), at)
            if of.get(place, run) is not run and not _agree(points[place], value):
                one, other = points[place].value, value.value
                raise SceneError(
                    f"{table.quantity} is {one:.6g} in {one_scene.folder(of[place])} and {other:.6g} in "
                    f"{one_scene.folder(run)}, both at {at[0]:.6g} {table.force_unit} and {at[1]:g} V; give one of them"
                )
            points[place], of[place] = value, run
    if table.whole:  # the run to the least force above has the trace with most points there
        for run in sorted(runs, key=lambda run: run.finger.f_ext if run.finger else 0.0):
            for at, value in _traced(run, table):
                if not any(_same(known, at) for known in points):
                    points[at] = value
    return points


def _same(one: At, other: At) -> bool:
    """Return whether two pairs of force and voltage are the same up to roundoff."""
    return all(math.isclose(a, b, rel_tol=NEAR) for a, b in zip(one, other, strict=True))


def _agree(one: Value, other: Value) -> bool:
    """Return whether two values of one quantity are the same up to the solvers' tolerances and their known errors."""
    most = _SAME * abs(one.value) + sum(each.error for each in (one, other) if not math.isnan(each.error))
    return abs(one.value - other.value) <= most


def _section(found: Result, table: Measured) -> Iterator[tuple[At, Value]]:
    """Yield force and voltage of each state of the cross-section, and the value there."""
    key = "bone_height" if table.key == "depth" else table.key
    for state in _states(found, table.state):
        value = float(getattr(state, key))
        error = float(getattr(state.error, key, math.nan))
        yield (state.f_ext, abs(state.voltage)), Value(-value if table.key == "depth" else value, error)


def _whole(found: Result, table: Measured) -> Iterator[tuple[At, Value]]:
    """Yield the same of the whole finger.

    Raises:
        SceneError: the run has none.
    """
    if found.finger is None:
        raise SceneError(
            f"the run has no newtons, which {_name(table)} has; run its scene, of press, charge and slide, with --force"
        )
    if table.state in found.finger.states:
        yield _of(found, found.finger, table)


def _traced(found: Result, table: Measured) -> Iterator[tuple[At, Value]]:
    """Yield the same under the forces of a table (N) that the traces of a run reach."""
    if found.finger is None or table.state not in found.finger.states or not found.finger.traces:
        return
    for force in dict.fromkeys(table.conditions.get("f_ext", ())):
        with suppress(SceneError):
            yield _of(found, found.finger.under(force), table)


def _of(found: Result, finger: WholeFinger, table: Measured) -> tuple[At, Value]:
    voltage = 0.0 if table.state == "uncharged" else abs(found.named[table.state].voltage)
    error = finger.error.get(table.state, {}).get(table.key, math.nan)
    return (finger.f_ext, voltage), Value(finger.values(table.state)[table.key], error)


def _states(found: Result, state: str) -> list[ContactState]:
    """Return the states of a run: the whole press of the uncharged one, else the named one.

    The named one stands in place of its step: it has errors, and may be of a finer mesh.
    """
    named = found.named.get(state)
    pressed = [s for s in before_sliding(found.steps) if s.voltage == 0 and s.ridges_in_contact and s.f_ext > 0]
    if state == "uncharged" and pressed:
        return [named if named is not None and named.step == each.step else each for each in pressed]
    return [] if named is None else [named]


def _of_sweep(found: Table, table: Measured) -> Ours:
    whole = FORCE in found.axes
    if whole is not table.whole:
        mine, other = ("N", "N/m") if table.whole else ("N/m", "N")
        raise SceneError(
            f"the sweep in {clip(str(found.folder), 80)} is over forces in {other}, and {_name(table)} has forces in "
            f"{mine}; sweep {FORCE if table.whole else 'f_ext'}, or give runs by --run"
        )
    keys = {FORCE if whole and key == "f_ext" else key: name for key, name in CONDITIONS.items()}
    others = [axis for axis in found.axes if axis not in keys]
    if others:
        raise SceneError(
            f"the sweep in {clip(str(found.folder), 80)} is over {others[0]}, which no measurement has; "
            f"give one over {' and '.join(keys)} alone"
        )
    column = f"{PREFIXES[table.state]}_{'finger_' if whole else ''}{table.key}"
    if column not in found.rows[0]:
        raise SceneError(
            f"the table of the sweep has no {table.quantity} of {WORDS[table.state]}, which {_name(table)} has; "
            "give one of its runs by --run"
        )
    fixed = found.parameters or {}
    if unknown := [name for key, name in keys.items() if key not in found.axes and key not in fixed]:
        raise SceneError(
            f"the sweep in {clip(str(found.folder), 80)} does not give its {unknown[0]}; "
            f"give one over {' and '.join(keys)}"
        )
    points = dict[At, Value]()
    try:
        for row in found.rows:
            force, voltage = (float(row[key] if key in found.axes else fixed[key]) for key in keys)
            at = force, 0.0 if table.state == "uncharged" else abs(voltage)
            if row[column] or at not in points:  # else another run has it, at another voltage or sign of it
                points[at] = Value(float(row[column] or "nan"), float(row.get(f"{column}_error") or "nan"))
    except (ValueError, KeyError, TypeError) as error:
        raise SceneError(f"the table of the sweep in {clip(str(found.folder), 80)} cannot be read: {error}") from None
    return _curves(points, table)


def _curves(points: dict[At, Value], table: Measured) -> Ours:
    if all(math.isnan(point.value) for point in points.values()):
        quantity = "friction coefficient" if table.key == "mu_app" else table.quantity
        raise SceneError(f"ours has no {quantity} of {WORDS[table.state]}, which {_name(table)} has")
    curves = []
    for voltage in sorted({u for _, u in points}):
        forces = sorted(f for f, u in points if u == voltage)
        values, errors = (np.array(column) for column in zip(*(points[f, voltage] for f in forces), strict=True))
        curves.append(Curve(voltage, np.array(forces), values, errors))
    return Ours(tuple(curves))


def conditions(table: Measured, known: Ours) -> tuple[Array, Array]:
    """Return force and voltage of each row of a table; those it does not have are ours, where ours has a single one.

    Forces that all lie within 1 % are a single one, their mean.

    Raises:
        SceneError: ours has several.
    """
    found = []
    for key, axis in (("f_ext", known.force), ("voltage", known.voltage)):
        if key == "f_ext" and math.isclose(axis[0], axis[-1], rel_tol=CLOSE):
            axis = np.array([axis.mean()])
        if key not in table.conditions and len(axis) > 1:
            name = CONDITIONS[key]
            unit = table.force_unit if name == "force" else "V"
            raise SceneError(f"{_name(table)} has no {name}, and ours has {len(axis)}; add a column '{name} ({unit})'")
        found.append(np.array(table.conditions.get(key, (axis[0],) * len(table.values))))
    return found[0], found[1]


def _name(table: Measured) -> str:
    return clip(str(table.file), 80)
