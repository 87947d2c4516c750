"""The columns of a sweep's table: of each point its named states, its newtons and its loads over time.

A load over time, such as a drive waveform, has no named state: ``load_NAME_mu_app_max`` is the largest coefficient in
it, ``load_NAME_f_t_amplitude`` the largest amplitude in the spectrum of friction and ``load_NAME_f_t_frequency`` the
frequency of that. Under a force on the whole finger there are columns of that alone.
"""

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fingerpad.results import dataset
from fingerpad.results.headline import SECTION, WHOLE
from fingerpad.results.quantities import FINGER, FRICTION, QUANTITIES, SWEPT, Output, in_table
from fingerpad.results.states import STATES, LoadResult
from fingerpad.scene import Scene
from fingerpad.scene.keys import Key, by_name
from fingerpad.slices.finger import WholeFinger

if TYPE_CHECKING:
    from fingerpad.results.result import Result

OTHER = "full_slip_other"
"""Beginning of the columns of a second state of full slip, where there are two."""
LOAD = "load"
"""Beginning of the columns of a load over time."""
FORCE = "full_slip_finger_f_ext"
"""Column of the force on the whole finger at full slip."""
_IN_TIME = in_table("short")
_ENDS = {"min": "least", "max": "largest", "mean": "mean"}


def row(result: "Result") -> dict[str, Any]:
    """Return the values of a point in SI units by column, and its failure."""
    if result.whole:
        return (_newtons(result.finger) if result.finger is not None else {}) | {"failure": result.failure}
    values, keys = dataset.values(result), (*SWEPT, *(each.name for each in result.outputs if "sweep" in each.tables))
    alone = "reached" in result.record  # full slip without a path
    names = [f"{state}_{key}" for state in (STATES[-1:] if alone else STATES) for key in keys]
    cells = {key: values.get(key) for name in names for key in (name, f"{name}_error") if key in values}
    if alone:
        cells["full_slip_reached"] = result.record["reached"]
    cells |= {f"{OTHER}_{key}": value for key, value in result.record.get(OTHER, {}).items()}
    if result.finger is not None:
        cells |= _newtons(result.finger)
    for load in result.loads:
        cells |= _in_time(load)
    return cells | {"failure": result.failure}


def _newtons(finger: WholeFinger) -> dict[str, float]:
    found: dict[str, float] = {}
    for state in finger.states:
        values, error = finger.values(state), finger.error.get(state, {})
        own = (key for key in finger.quantities if key not in FINGER and key in values)
        for key in (*in_table("file", FINGER), *own):
            if key in FRICTION and state != "full_slip":
                continue
            name = _of_finger(state, key)
            found |= {name: values[key]} | ({f"{name}_error": error[key]} if key in error else {})
    return found


def _in_time(load: LoadResult) -> dict[str, float]:
    passed, found = load.over_time, dict[str, float]()
    if passed is None:
        return found
    for key in _IN_TIME:
        ends = load.extremes.get(key)
        if ends is not None:
            values = {"min": ends.min, "max": ends.max, "mean": passed.mean[key]}
            found |= {f"{LOAD}_{load.name}_{key}_{end}": values[end] for end in _ENDS}
    if passed.periods:
        most, frequency = max(zip(passed.f_t_amplitude, passed.frequency, strict=True))
        name = f"{LOAD}_{load.name}_f_t"
        found |= {f"{name}_amplitude": most, f"{name}_frequency": frequency}
    return found


def shown(columns: Iterable[str], whole: bool, outputs: Iterable[Output] = ()) -> tuple[str, dict[str, Output]]:
    """Return a named state, and the columns of it that a table shows.

    Args:
        columns: of the sweep.
        whole: whether forces are those on the whole finger.
        outputs: of the sweep, that are computed from a state.

    Returns:
        Full slip. Without friction a whole finger has none, and it is the last state before. Without a force in newtons
        the whole finger comes first where it is known, and the middle section second.
    """
    there, outputs = set(columns), [each for each in outputs if "sweep" in each.tables]
    if not whole:
        summed = _of_finger("full_slip", "mu_app") in there
        section, finger = dict(SWEPT), dict[str, Output]()
        if summed:
            section = {key: _of_section(each) for key, each in in_table("short").items()}
            finger = in_table("first", FINGER) | {each.name: each.whole for each in outputs if each.sum}
        section |= {each.name: _of_section(each) if summed and each.sum else each for each in outputs}
        found = {_of_finger("full_slip", key): each for key, each in finger.items()}
        return "full_slip", found | {f"full_slip_{key}": each for key, each in section.items()}
    state = next((name for name in reversed(STATES) if _of_finger(name, "contact_area") in there), "full_slip")
    keys = [key for key in in_table("sweep", FINGER) if state == "full_slip" or key not in FRICTION]
    own = {_of_finger(state, each.name): each.whole for each in outputs if each.sum}
    return state, {_of_finger(state, key): FINGER[key] for key in keys} | own


def of_finger(column: str) -> bool:
    """Return whether a column is of the whole finger."""
    return "_finger_" in column


def description(columns: Iterable[str]) -> str:
    """Return in words what the columns of a table are of."""
    kinds = {of_finger(column) for column in columns}
    return f"{WHOLE}, and {SECTION} per metre of finger" if len(kinds) > 1 else WHOLE if True in kinds else SECTION


def _of_section(quantity: Output) -> Output:
    """Return a quantity of the middle section, so called beside one of the whole finger."""
    return replace(quantity, words=f"{quantity.symbol} of section")


def _of_finger(state: str, key: str) -> str:
    """Return the column of a quantity of the whole finger."""
    return f"{state}_finger_{key}"


def loads(columns: Iterable[str]) -> list[str]:
    """Return the names of the loads over time that columns are of, in order."""
    found = (re.fullmatch(rf"{LOAD}_(.+)_contact_length_mean", column) for column in columns)
    return [match[1] for match in found if match]


def in_time(name: str, columns: Iterable[str]) -> dict[str, str]:
    """Return the columns of a load over time that are printed, in words with units.

    Args:
        name: of the load.
        columns: of the table.
    """
    words, there = dict[str, str](), set(columns)
    friction = "mu_app" if f"{LOAD}_{name}_mu_app_mean" in there else "f_t"
    for key in (friction, "contact_length"):
        quantity = QUANTITIES[key]
        words |= {f"{key}_{end}": f"{word} {quantity.head}" for end, word in _ENDS.items()}
    words |= {"f_t_amplitude": "amplitude of f_T (N/m)", "f_t_frequency": "at (Hz)"}
    return {column: word for key, word in words.items() if (column := f"{LOAD}_{name}_{key}") in there}


def _cell(column: str, value: float | None) -> str:
    """Return a value in SI of a load's column as it is printed."""
    if value is None or math.isnan(value):
        return "–"
    key = next((key for key in _IN_TIME if re.search(rf"_{key}_(min|max|mean|amplitude)$", column)), None)
    return f"{value:.4g}" if key is None else QUANTITIES[key].shown(value)


def tables(rows: Sequence[Mapping[str, Any]], axes: Mapping[str, str]) -> Iterator[tuple[str, list[list[str]]]]:
    """Yield the name of each load over time, and its table with heads, a line a point.

    Args:
        rows: of all points.
        axes: heads of the swept keys by key.
    """
    columns = list(dict.fromkeys(column for each in rows for column in each))
    for name in loads(columns):
        shown = in_time(name, columns)
        lines = [[*axes.values(), *shown.values()]]
        for each in rows:
            values = [_cell(column, each.get(column)) for column in shown]
            lines.append([*(printed(each[key]) for key in axes), *values])
        yield name, lines


def printed(value: Any) -> str:
    """Return the value of a swept key as it is printed."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, int | float) else str(value)


def head_of(key: str, kind: str = "head") -> str:
    """Return what a table calls a key of a scene, with its unit.

    Args:
        key: a dotted key.
        kind: ``"head"``, by the symbol of a quantity, or ``"title"``, by its words.
    """
    if key in QUANTITIES:
        return str(getattr(QUANTITIES[key], kind))
    meant = described(key)
    return f"{key} ({meant.unit})" if meant is not None and meant.unit else key


def described(key: str) -> Key | None:
    """Return what is known of a dotted key of a scene; None of a table."""
    return by_name(Scene).get(re.sub(r"\[\d+\]", "[]", key))
