"""The columns of a sweep's table: of each point its named states, its newtons and its loads over time.

A load over time, such as a drive waveform, has no named state: ``load_NAME_mu_app_max`` is the largest coefficient in
it, ``load_NAME_f_t_amplitude`` the largest amplitude in the spectrum of friction and ``load_NAME_f_t_frequency`` the
frequency of that. Under a force on the whole finger there are columns of that alone.
"""

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

LOAD = "load"
"""Beginning of the columns of a load over time."""
FORCE = "full_slip_finger_f_ext"
"""Column of the force on the whole finger at full slip."""
_ENDS = {"min": "least", "max": "largest", "mean": "mean"}


def row(result: "Result") -> dict[str, Any]:
    """Return the values of a point in SI units by column, and its failure."""
    newtons = {} if result.finger is None else _newtons(result.finger)
    if result.whole:
        return newtons | {"failure": result.failure}
    alone = "reached" in result.record  # full slip without a path
    keys = (*SWEPT, *(each.name for each in result.outputs if "sweep" in each.tables))
    names = (f"{state}_{key}" for state in (STATES[-1:] if alone else STATES) for key in keys)
    cells = _with_errors(names, dataset.values(result))
    if alone:
        cells["full_slip_reached"] = result.record["reached"]
    cells |= newtons
    for load in result.loads:
        cells |= _in_time(load)
    return cells | {"failure": result.failure}


def _with_errors(names: Iterable[str], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that are there, each followed by its error."""
    return {key: values[key] for name in names for key in (name, f"{name}_error") if key in values}


def _newtons(finger: WholeFinger) -> dict[str, float]:
    keys = (*in_table("file", FINGER), *(key for key in finger.quantities if key not in FINGER))
    of_state = ((state, key) for state in finger.states for key in keys)
    names = (_of_finger(state, key) for state, key in of_state if state == "full_slip" or key not in FRICTION)
    return _with_errors(names, finger.flat())


def _in_time(load: LoadResult) -> dict[str, float]:
    passed, found = load.over_time, dict[str, float]()
    if passed is None:
        return found
    for key in in_table("short"):
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
    sums = {each.name: each.whole for each in outputs if each.sum}
    if whole:
        state = next((name for name in reversed(STATES) if _of_finger(name, "contact_area") in there), "full_slip")
        finger = in_table("sweep", FINGER) | sums
        slips = state == "full_slip"
        return state, {_of_finger(state, key): each for key, each in finger.items() if slips or key not in FRICTION}
    section = SWEPT | {each.name: each for each in outputs}
    if _of_finger("full_slip", "mu_app") not in there:
        return "full_slip", {f"full_slip_{key}": each for key, each in section.items()}
    finger = {_of_finger("full_slip", key): each for key, each in (in_table("first", FINGER) | sums).items()}
    section = in_table("short") | {each.name: each for each in outputs}
    beside = {key: replace(each, words=f"{each.symbol} of section") for key, each in section.items()}
    beside |= {each.name: each for each in outputs if not each.sum}
    return "full_slip", finger | {f"full_slip_{key}": each for key, each in beside.items()}


def of_finger(column: str) -> bool:
    """Return whether a column is of the whole finger."""
    return "_finger_" in column


def description(columns: Iterable[str]) -> str:
    """Return in words what the columns of a table are of."""
    kinds = {of_finger(column) for column in columns}
    return f"{WHOLE}, and {SECTION} per metre of finger" if len(kinds) > 1 else WHOLE if True in kinds else SECTION


def _of_finger(state: str, key: str) -> str:
    """Return the column of a quantity of the whole finger."""
    return f"{state}_finger_{key}"


def loads(columns: Iterable[str]) -> list[str]:
    """Return the names of the loads over time that columns are of, in order."""
    found = (re.fullmatch(rf"{LOAD}_(.+)_contact_length_mean", column) for column in columns)
    return [match[1] for match in found if match]


def in_time(name: str, columns: Iterable[str]) -> dict[str, Output]:
    """Return the columns of a load over time, by its name, that are printed of those of a table."""
    found, there = dict[str, Output](), set(columns)
    friction = "mu_app" if f"{LOAD}_{name}_mu_app_mean" in there else "f_t"
    for key in (friction, "contact_length"):
        of = QUANTITIES[key]
        found |= {f"{key}_{end}": replace(of, words=f"{word} {of.symbol}") for end, word in _ENDS.items()}
    found["f_t_amplitude"] = replace(QUANTITIES["f_t"], words="amplitude of f_T")
    found["f_t_frequency"] = Output("frequency", "Hz", words="at", digits=1)
    return {column: each for key, each in found.items() if (column := f"{LOAD}_{name}_{key}") in there}


def tables(rows: Sequence[Mapping[str, Any]], axes: Mapping[str, str]) -> Iterator[tuple[str, list[list[str]]]]:
    """Yield the name of each load over time, and its table with heads, a line a point.

    Args:
        rows: of all points.
        axes: heads of the swept keys by key.
    """
    columns = list(dict.fromkeys(column for each in rows for column in each))
    for name in loads(columns):
        shown = in_time(name, columns)
        heads = [*axes.values(), *(of.title for of in shown.values())]
        keys = ([printed(each[key]) for key in axes] for each in rows)
        cells = ([of.shown(each.get(column)) for column, of in shown.items()] for each in rows)
        yield name, [heads, *(first + line for first, line in zip(keys, cells, strict=True))]


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
