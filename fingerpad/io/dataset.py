"""A result as one xarray dataset, and as ``result.nc`` beside the tables.

The dataset holds what the tables hold, with the same names, values and SI units; every variable has ``units`` and
``long_name``. The file is NetCDF 3 with 64-bit offsets, by SciPy: every program for NetCDF reads it, and it loads no
HDF5 beside that of dolfinx.
"""

import csv
import json
import math
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.io import netcdf_file

from fingerpad.io import columns
from fingerpad.io.columns import Column
from fingerpad.io.files import replace
from fingerpad.io.load_variables import loads
from fingerpad.io.states import STATES
from fingerpad.io.variables import Variable, Variables, array, described
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.reading import flat
from variational.state import ContactState, Errors, Skin

if TYPE_CHECKING:
    import xarray

    from fingerpad.io.result import Result
    from fingerpad.slices.finger import WholeFinger

FILE = "result.nc"
COORDINATES = ("step", "load", "state", "ridge", "side", "iteration", "harmonic")
Row = Mapping[str, Any]
_MISSING = -1  # of whole numbers of a state that is not there
_RIDGE_TABLES = ("ridges", "ridges_final", "receptors", "receptors_final")


def dataset(result: "Result") -> "xarray.Dataset":
    """Return a result as a dataset; ``docs/results.md`` lists its dimensions.

    Args:
        result: of any model. Values by ridge and site are read from its folder, where it has one.

    Returns:
        The dataset, in SI units; NaN where a table has no value.

    Raises:
        OSError: a table of the folder cannot be read.
        ImportError: xarray is not installed.
    """
    import xarray  # brings pandas: a second that reading numbers does not need

    found = states(result.named)
    if result.steps:
        tables = {name: _table(result, name) for name in (*_RIDGE_TABLES, "coupling")}
        steps = [state.step for state in result.steps]
        numbers = sorted({int(row["ridge"]) for name in _RIDGE_TABLES for row in tables[name]})
        found |= _steps(result.steps) | loads(result)
        found["ridge"] = _ridges(numbers)
        for end, dim, key, labels in (("", "step", "step", steps), ("_final", "state", "of", list(STATES))):
            found |= _by_ridge(tables[f"ridges{end}"], (dim, key, labels), numbers, f"ridge{end}_", columns.RIDGES)
            found |= _sites(tables[f"receptors{end}"], (dim, key, labels), numbers, end.removeprefix("_"))
        found |= _coupling(tables["coupling"], steps)
    found |= _skin(result.named) | finger(result.finger)
    coords = {name: value for name, value in found.items() if name in COORDINATES}
    data = {name: value for name, value in found.items() if name not in COORDINATES}
    return xarray.Dataset(data, coords, attributes(result))


def save(result: "Result") -> str:
    """Write ``result.nc`` into the folder of a result; on one rank.

    Returns:
        Why the file was not written, in one sentence; empty where it was.
    """
    assert result.folder is not None
    return write(result.folder / FILE, lambda: dataset(result))


def skins(folder: Path) -> dict[str, Skin]:
    """Return the skin of the named states that ``result.nc`` of a folder holds; none where it cannot be read."""
    try:
        with netcdf_file(folder / FILE, mmap=False) as file:
            if "skin_ridge" not in file.variables:
                return {}
            ridge, *values = (np.array(file.variables[f"skin_{name}"][:]) for name in ("ridge", *columns.SKIN))
    except (OSError, ValueError, TypeError, KeyError, IndexError):  # no file, or not a whole one
        return {}
    found = {}
    for name, numbers, *parts in zip(STATES, ridge, *values, strict=True):
        facets = np.isfinite(numbers)
        points = np.isfinite(parts[0]).any(axis=0)
        if facets.any():
            arrays = {key: part[facets][:, points] for key, part in zip(columns.SKIN, parts, strict=True)}
            found[name] = Skin(ridge=numbers[facets].astype(int), **arrays)
    return found


def write(file: Path, make: "Callable[[], xarray.Dataset]") -> str:
    """Write a dataset; what was there stays until all of it is written; return as of :func:`save`.

    Args:
        file: the path.
        make: makes the dataset; its errors count as those of writing.
    """
    try:
        data = make().to_netcdf(engine="scipy", format="NETCDF3_64BIT")
        replace(file, bytes(data))
    except ImportError as error:
        return f"{file.name} was not written: {error}; pip install xarray"
    except OSError as error:
        return f"{file.name} was not written: {error.strerror or error}; all other files are complete"
    except (ValueError, TypeError, KeyError) as error:  # of what NetCDF cannot hold
        return f"{file.name} was not written: NetCDF cannot hold it ({error}); all other files are complete"
    return ""


def attributes(result: "Result") -> dict[str, Any]:
    """Return the attributes of a dataset: model, versions, and every parameter by its dotted key and as JSON."""
    parameters = result.record.get("parameters") or result.scene.parameters()  # the former with laws that are not read
    found: dict[str, Any] = {"title": "fingerpad: a fingertip on a touchscreen", "model": result.model}
    found |= {name: text for name in ("failure", "interrupted") if (text := getattr(result, name))}
    for name in ("notes", "cautions"):
        found |= {name: "\n".join(getattr(result, name))} if getattr(result, name) else {}
    versions = result.record.get("provenance", {})
    found |= {"provenance": json.dumps(versions, default=str)} if versions else {}
    given = {key: _attribute(value) for key, value in flat(parameters).items() if value is not None}
    return found | {"parameters": json.dumps(parameters)} | given


def _attribute(value: Any) -> Any:
    """Return a parameter as NetCDF can hold it: a number, a text or a list of numbers; all else as JSON."""
    numbers = value if isinstance(value, list) else [value]
    plain = all(type(each) is float or (type(each) is int and abs(each) < 2**31) for each in numbers)
    return value if isinstance(value, str) or (numbers and plain) else json.dumps(value)


def states(named: Mapping[str, ContactState]) -> Variables:
    """Return the named states along ``state``; NaN, or -1 of a whole number, where a state is missing."""
    found: Variables = {"state": (("state",), np.array(STATES, object), described(Column("1", "named state")))}
    for name, column in (columns.STATES | columns.STABILITY).items():
        whole = name in ("step", "ridges_in_contact", "stable")
        values = [_number(getattr(named[key], name) if key in named else None, whole) for key in STATES]
        found[f"state_{name}"] = ("state",), np.array(values, np.int32 if whole else np.float64), described(column)
    for kind, words in columns.CHANGES.items():
        for field in fields(Errors):
            values = [getattr(getattr(named[key], kind), field.name) if key in named else math.nan for key in STATES]
            column = columns.STEPS[field.name]
            about = described(Column(column.unit, f"{words} of the {column.meaning}"))
            found[f"state_{field.name}_{kind}"] = ("state",), np.array(values, np.float64), about
    return found


def _number(value: Any, whole: bool) -> float:
    return (_MISSING if whole else math.nan) if value is None else value


def _steps(steps: Sequence[ContactState]) -> Variables:
    """Return the columns of ``steps.csv`` along ``step``; the name of the load is ``load_name``."""
    found: Variables = {}
    rows = [state.row() for state in steps]
    for name in rows[0]:
        values = [row[name] for row in rows]
        found["load_name" if name == "load" else name] = ("step",), array(values), described(columns.STEPS[name])
    return found


Axis = tuple[str, str, Sequence[Hashable]]
"""A dimension, the column of a table that names its places, and the places in order."""


def _by_ridge(
    rows: Sequence[Row], axis: Axis, numbers: Sequence[int], prefix: str, known: Mapping[str, Column]
) -> Variables:
    """Return columns of a table of ridges along a dimension and ``ridge``; nothing without a row."""
    if not rows:
        return {}
    dim, key, labels = axis
    rank, place = {str(label): k for k, label in enumerate(labels)}, {number: k for k, number in enumerate(numbers)}
    found: Variables = {}
    for name, column in known.items():
        text = name == "state"
        values = np.full((len(labels), len(numbers)), "" if text else np.nan, object if text else np.float64)
        for row in rows:
            where = rank[str(row[key])], place[int(row["ridge"])]
            values[where] = row[name] if text else float(row[name])
        found[f"{prefix}{'note' if text else name}"] = (dim, "ridge"), values, described(column)
    return found


def _sites(rows: Sequence[Row], axis: Axis, numbers: Sequence[int], end: str) -> Variables:
    """Return the energy densities at Merkel sites, one a ridge, and at Meissner sites, one on each ``side``."""
    flat = _by_ridge(rows, axis, numbers, "", columns.RECEPTORS)
    if not flat:
        return {}
    end = f"_{end}" if end else ""
    dims, left, about = flat["meissner_left"]
    both = np.stack([left, flat["meissner_right"][1]], axis=-1)
    about = about | {"long_name": "strain energy density at the Meissner sites of the ridge, per reference volume"}
    sides = ("side",), np.array(["left", "right"], object), described(Column("1", "side of the ridge"))
    return {f"merkel{end}_sed": flat["merkel_sed"], f"meissner{end}_sed": ((*dims, "side"), both, about), "side": sides}


def sites(result: "Result") -> Variables:
    """Return the energy densities at the sites in the named states, of a result in a folder; nothing without any."""
    rows: list[Row] = [*_table(result, "receptors_final")]  # on the final mesh, with an accuracy asked for
    if not rows:
        steps = [(name, str(state.step)) for name, state in result.named.items()]  # at 0 V two names are of one step
        all_steps = _table(result, "receptors")
        rows = [{**row, "of": name} for name, step in steps for row in all_steps if row["step"] == step]
    rows = [row for row in rows if None not in row.values()]  # the last may be cut short
    numbers = sorted({int(row["ridge"]) for row in rows})
    return {"ridge": _ridges(numbers)} | _sites(rows, ("state", "of", list(STATES)), numbers, "") if rows else {}


def _ridges(numbers: Sequence[int]) -> Variable:
    return ("ridge",), np.array(numbers, np.int32), described(Column("1", "number of the ridge, 0 central"))


def _coupling(rows: Sequence[Row], steps: Sequence[int]) -> Variables:
    """Return the columns of ``coupling.csv`` along ``step`` and ``iteration``."""
    if not rows:
        return {}
    place = {step: k for k, step in enumerate(steps)}
    count = max(int(row["iteration"]) for row in rows)
    values = np.full((len(steps), count), np.nan)
    for row in rows:
        values[place[int(row["step"])], int(row["iteration"]) - 1] = float(row["change"])
    change = Column("1", "relative change of the air gaps in the coupling iteration")
    numbers = np.arange(1, count + 1, dtype=np.int32)
    return {
        "iteration": (("iteration",), numbers, described(Column("1", "number of the coupling iteration"))),
        "coupling_change": (("step", "iteration"), values, described(change)),
    }


def _skin(named: Mapping[str, ContactState]) -> Variables:
    """Return the skin along ``state``, ``facet`` and ``point``; NaN beyond the facets of a state's mesh."""
    skins = {name: state.skin for name, state in named.items() if state.skin is not None}
    if not skins:
        return {}
    facets, points = (max(skin.x.shape[k] for skin in skins.values()) for k in (0, 1))
    found: Variables = {}
    for name, column in columns.SKIN.items():
        values = np.full((len(STATES), facets, points), np.nan)
        for key, skin in skins.items():
            values[STATES.index(key), : skin.x.shape[0], : skin.x.shape[1]] = getattr(skin, name)
        found[f"skin_{name}"] = ("state", "facet", "point"), values, described(column)
    ridge = np.full((len(STATES), facets), np.nan)
    for key, skin in skins.items():
        ridge[STATES.index(key), : len(skin.ridge)] = skin.ridge
    found["skin_ridge"] = ("state", "facet"), ridge, described(Column("1", "number of the ridge of the facet"))
    return found


def finger(whole: "WholeFinger | None") -> Variables:
    """Return the whole finger along ``state``, and its slices along ``state`` and ``slice``; NaN if missing."""
    if whole is None:
        return {}
    count = max(len(total.z) for total in whole.states.values())
    sums = {name: np.full(len(STATES), np.nan) for key in columns.FINGER for name in (key, f"{key}_error")}
    slices = {name: np.full((len(STATES), count), np.nan) for name in columns.SLICES}
    for state, total in whole.states.items():
        for name, value in whole.values(state).items():
            sums[name][STATES.index(state)] = value
        for name, value in whole.error[state].items():
            sums[f"{name}_error"][STATES.index(state)] = value
        for name, along in total.slices().items():
            slices[name][STATES.index(state), : len(along)] = along
    found: Variables = {}
    for name, column in columns.FINGER.items():
        found[f"finger_{name}"] = ("state",), sums[name], described(column)
        about = described(Column(column.unit, f"estimated error of the {column.meaning}"))
        found[f"finger_{name}_error"] = ("state",), sums[f"{name}_error"], about
    for name, column in columns.SLICES.items():
        found[f"slice_{name}"] = ("state", "slice"), slices[name], described(column)
    return found


def _table(result: "Result", name: str) -> list[dict[str, Any]]:
    """Return a table of the folder, or without one the ridges in contact that the steps have; empty if missing."""
    if result.folder is not None:
        try:
            with (result.folder / f"{name}.csv").open(encoding="utf-8", newline="") as file:
                return list(csv.DictReader(file))
        except FileNotFoundError:
            return []
        except (csv.Error, UnicodeDecodeError) as error:
            raise SceneError(f"{name}.csv in {clip(str(result.folder), 80)} cannot be read: {error}") from None
    return list(_in_memory(result.steps)) if name == "ridges" else []


def _in_memory(steps: Iterable[ContactState]) -> Iterable[dict[str, Any]]:
    for step in steps:
        if step.ridges is not None:
            for k in np.flatnonzero(step.ridges.length > 0):
                values = {name: getattr(step.ridges, name)[k] for name in ("f_contact", "f_friction", "p_c", "d_eq")}
                values |= {"contact_length": step.ridges.length[k], "f_electrostatic": step.ridges.f_electrostatic[k]}
                yield values | {"step": step.step, "ridge": step.ridges.number[k], "state": ""}
