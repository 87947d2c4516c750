"""Results over a grid of values: as a sequence, as arrays, as a table and as text."""

import csv
import io
import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from fingerpad import notebook
from fingerpad.results import dataset
from fingerpad.results.files import replace
from fingerpad.results.quantities import CONDITIONS, FINGER, PEOPLE, PER_LENGTH, RESULTS, Output, plus_minus_of
from fingerpad.results.states import STATES, WORDS
from fingerpad.runs import post
from fingerpad.runs.sweep_columns import described, description, head_of, of_finger, printed, row, shown, tables
from fingerpad.scene.reading import flat
from fingerpad.scene.remarks import drive_in_short, other_under_a_drive
from fingerpad.slices.errors import remarks

if TYPE_CHECKING:
    import xarray

    from fingerpad.results.result import Result

FILE = "sweep.nc"
_OF_POINT = {"state", "load", "harmonic", "ridge", "side"}  # dimensions of a point; steps and skin are in its folder


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """Results over a grid of values; a sequence of them, the last axis fastest."""

    axes: dict[str, tuple[Any, ...]]
    """Values by key, in SI."""
    results: tuple["Result", ...]
    folder: Path | None
    """Of the results, each in a folder of its own, of ``table.csv`` and of ``sweep.nc``, an absolute path."""
    notes: tuple[str, ...] = ()
    """Remarks on the files of the sweep."""

    def __post_init__(self) -> None:
        """Keep the folder where the program may go to another one."""
        if self.folder is not None:
            object.__setattr__(self, "folder", self.folder.absolute())

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.results)

    def __iter__(self) -> Iterator["Result"]:
        """Return the results in order."""
        return (self[k] for k in range(len(self)))

    @overload
    def __getitem__(self, k: int) -> "Result": ...
    @overload
    def __getitem__(self, k: slice) -> tuple["Result", ...]: ...
    def __getitem__(self, k: int | slice) -> "Result | tuple[Result, ...]":
        """Return a result by its place, with the bands of its friction, which points by a closed form have from here.

        The bands take as long as the point itself, and no table of a sweep has them. A slice is a tuple of results.
        """
        if isinstance(k, slice):
            return tuple(self[place] for place in range(len(self))[k])
        result = self.results[k]
        return result if PEOPLE in result.record else post.applied(result, [post.BANDS, post.PEOPLE])

    @property
    def whole(self) -> bool:
        """Whether forces are those on the whole finger; results have their ``finger`` under it."""
        return any(result.whole for result in self.results)

    @property
    def outputs(self) -> tuple[Output, ...]:
        """Outputs of the results that are computed from a state."""
        return tuple(dict.fromkeys(each for result in self.results for each in result.outputs))

    def points(self) -> list[dict[str, Any]]:
        """Return the values of the axes at each point, in order."""
        return [dict(zip(self.axes, values, strict=True)) for values in itertools.product(*self.axes.values())]

    def array(self, quantity: str, state: str = "full_slip") -> NDArray[np.float64]:
        """Return a quantity of a named state over the grid, NaN where it is not known.

        Args:
            quantity: a name of :class:`variational.state.ContactState`, such as ``"mu_app"``; of a sweep over the force
                in newtons a name of :data:`fingerpad.results.quantities.FINGER`, such as ``"f_t"`` in N.
            state: a name of :data:`fingerpad.results.states.STATES`.

        Returns:
            Shape (values of the first axis, values of the second, …), SI units.

        Raises:
            ValueError: no such quantity or state.
        """
        if state not in STATES:
            raise ValueError(f"state is {state!r}; it must be one of {', '.join(STATES)}")
        own = (each.name for each in self.outputs)
        given = [key for key in CONDITIONS if key not in ("step", "load")]
        known = (*(FINGER if self.whole else (*given, *RESULTS)), *own)
        if quantity not in known:
            raise ValueError(f"quantity is {quantity!r}; it must be one of {', '.join(known)}")
        if self.whole:
            fingers = [result.finger for result in self.results]
            found = [{} if f is None or state not in f.states else f.values(state) for f in fingers]
            values = [each.get(quantity, np.nan) for each in found]
        else:
            values = [float(getattr(getattr(result, state), quantity, np.nan)) for result in self.results]
        return np.array(values).reshape([len(values) for values in self.axes.values()])

    def rows(self) -> list[dict[str, Any]]:
        """Return a flat row for each point in SI units: axes, :mod:`~fingerpad.runs.sweep_columns`, and failure."""
        return [point | row(result) for point, result in zip(self.points(), self.results, strict=True)]

    def cautions(self) -> list[str]:
        """Return why numbers may be further off than their errors say, each with how many points it is of.

        Where the numbers in a caution differ from point to point, they are those of the first one, and it says so.
        """
        found = dict[str, list[str]]()
        for result in self.results:
            for form, text in {each.form: each.text for each in result.cautions}.items():
                found.setdefault(form, []).append(text)
        return [
            f"{texts[0]} ({len(texts)} of {len(self)} points{', numbers of the first' * (len(set(texts)) > 1)})"
            for texts in found.values()
        ]

    def to_xarray(self) -> "xarray.Dataset":
        """Return the sweep as one dataset with units, as ``sweep.nc`` has it.

        It has the named states of every point along the swept keys and ``state``, as in the dataset of a run; loads,
        ridges, sites and sums over the whole finger, where a point has them; its failure and cost. Attributes are the
        parameters that all points share. Under a force on the whole finger there are sums over it alone.
        """
        import xarray  # brings pandas

        return xarray.Dataset(_variables(self), attrs=_shared(self))

    def save(self) -> str:
        """Write ``sweep.nc`` into the folder; return why not in one sentence, empty where it was written."""
        assert self.folder is not None
        try:
            replace(self.folder / FILE, dataset.content(self.to_xarray()))
        except OSError as error:
            return f"{FILE} was not written: {error.strerror or error}; all other files are complete"
        return ""

    def table(self) -> list[dict[str, Any]]:
        """Return the rows with the same columns in each, ``failure`` last; None where a point has no value."""
        rows = self.rows()
        columns = sorted(dict.fromkeys(key for row in rows for key in row), key="failure".__eq__)
        return [{key: _plain(row.get(key)) for key in columns} for row in rows]

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as a table."""
        rows, text = self.table(), io.StringIO()
        table = csv.DictWriter(text, list(rows[0]))
        table.writeheader()
        table.writerows(rows)
        replace(Path(path), text.getvalue())

    def __str__(self) -> str:
        """Return full slip over the axes, and loads over time, as tables with units; ± whole known errors.

        The first columns are of the whole finger, where it is known, and those of the middle section follow.
        """
        found, notes = self._printed()
        lines = [line for title, table in found for line in (title, *_aligned(table))]
        return "\n".join([*lines, *notes, *(f"! {caution}" for caution in self.cautions()), *self.notes])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook, with remarks to unfold."""
        (title, first), *more = ((title, notebook.table(table[0], table[1:])) for title, table in self._printed()[0])
        cautions = notebook.lines(f"! {caution}" for caution in self.cautions())
        remarks = notebook.folded("Remarks", [*self._printed()[1], *self.notes])
        return notebook.page(title, first, *(notebook.page(*each) for each in more), cautions, remarks)

    def _printed(self) -> tuple[list[tuple[str, list[list[str]]]], list[str]]:
        """Return the tables with their titles, and the remarks on their columns."""
        rows, axes = self.rows(), {key: head_of(key) for key in self.axes}
        state, columns = shown((column for each in rows for column in each), self.whole, self.outputs)
        table = [[*axes.values(), *(each.head for each in columns.values())]]
        for each, result in zip(rows, self.results, strict=True):
            first = [printed(each[key]) for key in axes]
            values = {column: each.get(column) for column in columns}
            if not any(values.values()):
                table.append([*first, result.failure or f"no {WORDS[state]}"])
                continue
            errors = {column: each.get(f"{column}_error") for column in columns}
            cells = [of.shown(values[column], errors[column]) for column, of in columns.items()]
            table.append([*first, *cells])
        of = description(columns)
        scenes = [result.scene for result in self.results]
        found = [(f"{of[0].upper()}{of[1:]}, at {WORDS[state]}, under {drive_in_short(scenes)}", table)]
        found += [(f"Over time, in the load {name}", over_time) for name, over_time in tables(rows, axes)]
        forces = {each.finger.f_ext for each in self.results if each.finger is not None}
        known = remarks(forces, {column.rpartition("finger_")[2] for column in columns})
        known = [*self._plus_minus(columns, rows), *known, *other_under_a_drive(scenes)]
        return found, [*known, *([] if any(map(of_finger, columns)) else [PER_LENGTH])]

    def _plus_minus(self, columns: Mapping[str, Output], rows: Sequence[Mapping[str, Any]]) -> list[str]:
        """Return what the ± of a table's columns is of, a sentence; none without a ±."""
        shown = {of_finger(column) for column in columns for each in rows if each.get(f"{column}_error")}
        fingers = [each.finger.parts() for each in self.results if each.finger is not None and True in shown]
        sections = [each.parts() for each in self.results if False in shown]
        return [plus_minus_of(itertools.chain(*fingers, *sections))] if shown else []


def _plain(value: Any) -> Any:
    """Return a number, a switch or a text of Python; anything else as text."""
    value = value.item() if isinstance(value, np.generic) else value
    return value if value is None or isinstance(value, bool | int | float | str) else str(value)


def _aligned(table: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a table; a line that is cut short ends in words."""
    whole = [line for line in table if len(line) == len(table[0])]
    widths = [max(map(len, column)) for column in zip(*whole, strict=True)]
    return ["   ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=False)) for line in table]


def _variables(sweep: Sweep) -> dataset.Variables:
    """Return the variables of a sweep with at least one point."""
    axes, shape = tuple(sweep.axes), [len(values) for values in sweep.axes.values()]
    found = _stacked([_of_point(result, sweep.whole) for result in sweep.results], axes, shape)
    failures = np.array([result.failure for result in sweep.results], object).reshape(shape)
    found["failure"] = axes, failures, {"units": "1", "long_name": "reason of a failure, empty without one"}
    for name, words in (("wall_seconds", "elapsed time"), ("processor_seconds", "processor time of all ranks")):
        seconds = np.array([getattr(result.cost, name) for result in sweep.results], np.float64).reshape(shape)
        found[name] = axes, seconds, {"units": "s", "long_name": f"{words} of the point"}
    for key, along in sweep.axes.items():
        meant = described(key)
        unit, words = ("1", key) if meant is None else (meant.unit or "1", meant.meaning)
        found[key] = (key,), _coordinate(along), {"units": unit, "long_name": words}
    return found


def _stacked(points: Sequence[dataset.Variables], axes: tuple[str, ...], shape: Sequence[int]) -> dataset.Variables:
    """Return variables of all points along the swept keys and their own dimensions; missing where a point has none."""
    labels: dict[str, list[Any]] = {}
    for point in points:
        for name in point.keys() & set(dataset.COORDINATES):
            mine = labels.setdefault(name, [])
            mine += [label for label in point[name][1].tolist() if label not in mine]
    labels.get("ridge", []).sort()
    found: dataset.Variables = {}
    for name in dict.fromkeys(name for point in points for name in point):
        dims, first, about = next(point[name] for point in points if name in point)
        if name in labels:
            found[name] = dims, np.array(labels[name], first.dtype), about
            continue
        values = dataset.filled([len(points), *(len(labels[dim]) for dim in dims)], first.dtype)
        for k, point in enumerate(points):
            if name in point:  # each place is that of its label: a load by name, a ridge by number
                at = [[labels[dim].index(label) for label in point[dim][1].tolist()] for dim in dims]
                values[k][np.ix_(*at)] = point[name][1]
        found[name] = (*axes, *dims), values.reshape(*shape, *values.shape[1:]), about
    return found


def _of_point(result: "Result", whole: bool) -> dataset.Variables:
    """Return the variables of a point; of one of several forces of a run the sums over the whole finger alone."""
    every = {name: each for name, each in dataset.variables(result).items() if _OF_POINT.issuperset(each[0])}
    return {name: each for name, each in every.items() if not whole or name == "state" or name.startswith("finger_")}


def _coordinate(values: Sequence[Any]) -> Any:
    """Return numbers as they are, and all else as text: names, switches, lists and tables."""
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        whole = all(isinstance(value, int) for value in values)
        return np.array(values, np.int32 if whole else np.float64)
    return np.array([value if isinstance(value, str) else json.dumps(value, default=str) for value in values], object)


def _shared(sweep: Sweep) -> dict[str, Any]:
    """Return the attributes that all points have in common."""
    every = [dataset.attributes(result) for result in sweep.results]
    texts = [{key: json.dumps(value) for key, value in each.items()} for each in every]
    keys = {"title", "model", *flat(sweep.results[0].parameters)}
    return {k: value for k, value in every[0].items() if k in keys and all(t.get(k) == texts[0][k] for t in texts)}
