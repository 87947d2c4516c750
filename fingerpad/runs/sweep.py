"""A scene over values of some of its keys: every combination, as one table, kept on disk and taken up again."""

import csv
import itertools
import os
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import replace as replace_fields
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.installed import source, version
from fingerpad.io import terminal
from fingerpad.io.files import replace, replace_json
from fingerpad.io.folder import check_folder
from fingerpad.io.quantities import PER_LENGTH, QUANTITIES, cell
from fingerpad.io.result import Result
from fingerpad.io.states import STATES
from fingerpad.model.check import check
from fingerpad.report.write import attempt
from fingerpad.runs import sweep_dataset
from fingerpad.runs.solve import MODELS, checked, solved
from fingerpad.runs.sweep_columns import SHOWN, newtons_of, printed, row, tables
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.messages import clip, show
from fingerpad.scene.reading import plain, put
from variational.state import CONDITIONS, RESULTS

if TYPE_CHECKING:
    import xarray

FILES = ("table.csv", sweep_dataset.FILE, "report.html", "sweep.json")
"""What a sweep writes into its folder beside its points."""
_MOST = 10_000  # points
_LIMIT = 4 * 3600.0  # s of processor time for one point


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """Results over a grid of values; a sequence of them, the last axis fastest."""

    axes: dict[str, tuple[Any, ...]]
    """Values by key, in SI."""
    results: tuple[Result, ...]
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

    def __iter__(self) -> Iterator[Result]:
        """Return the results in order."""
        return iter(self.results)

    def __getitem__(self, k: int) -> Result:
        """Return a result by its place."""
        return self.results[k]

    def points(self) -> list[dict[str, Any]]:
        """Return the values of the axes at each point, in order."""
        return [dict(zip(self.axes, values, strict=True)) for values in itertools.product(*self.axes.values())]

    def array(self, quantity: str, state: str = "full_slip") -> NDArray[np.float64]:
        """Return a quantity of a named state over the grid, NaN where it is not known.

        Args:
            quantity: a name of :class:`variational.state.ContactState`, such as ``"mu_app"``.
            state: a name of :data:`fingerpad.io.states.STATES`.

        Returns:
            Shape (values of the first axis, values of the second, …), SI units.

        Raises:
            ValueError: no such quantity or state.
        """
        if state not in STATES:
            raise ValueError(f"state is {state!r}; it must be one of {', '.join(STATES)}")
        if quantity not in (*CONDITIONS[2:], *RESULTS):
            raise ValueError(f"quantity is {quantity!r}; it must be one of {', '.join((*CONDITIONS[2:], *RESULTS))}")
        found = [result.named.get(state) for result in self.results]
        values = [np.nan if each is None else float(getattr(each, quantity)) for each in found]
        return np.array(values).reshape([len(values) for values in self.axes.values()])

    def rows(self) -> list[dict[str, Any]]:
        """Return a flat row for each point in SI units: axes, :mod:`~fingerpad.runs.sweep_columns`, and failure."""
        return [point | row(result) for point, result in zip(self.points(), self.results, strict=True)]

    def cautions(self) -> list[str]:
        """Return why numbers may be further off than their errors say, each with how many points it is of.

        The numbers in a caution are those of the first point that has it.
        """
        first, count = dict[str, str](), Counter[str]()
        for result in self.results:
            mine = {_alike(text): text for text in result.cautions}
            for alike, text in mine.items():
                first.setdefault(alike, text)
            count.update(mine.keys())
        return [f"{first[alike]} ({number} of {len(self)} points)" for alike, number in count.items()]

    def to_xarray(self) -> "xarray.Dataset":
        """Return the named states along the swept keys as one dataset with units, as ``sweep.nc`` has it.

        Raises:
            ImportError: xarray is not installed.
        """
        return sweep_dataset.of_sweep(self)

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as a table."""
        rows = self.rows()
        columns = list(dict.fromkeys(key for row in rows for key in row))
        columns.sort(key="failure".__eq__)  # last
        lines = _Lines()
        table = csv.DictWriter(lines, columns)
        table.writeheader()
        table.writerows(rows)
        replace(Path(path), "".join(lines))

    def __str__(self) -> str:
        """Return full slip over the axes, and loads over time, as tables with units; ± estimated discretisation errors.

        The last column is friction of the whole finger, where it is known.
        """
        axes = {key: _head(key) for key in self.axes}
        newtons = any(result.finger is not None for result in self.results)
        heads = [*axes.values(), *(_head(key) for key in SHOWN), *(["F_T (N)"] if newtons else [])]
        table = [heads]
        for values, result in zip(self.points(), self.results, strict=True):
            first = [printed(value) for value in values.values()]
            state = result.full_slip
            if state is None:
                table.append([*first, result.failure or "no full slip"])
                continue
            cells = [cell(key, getattr(state, key), getattr(state.error, key, np.nan)) for key in SHOWN]
            table.append([*first, *cells, *([newtons_of(result)] if newtons else [])])
        lines = ["At full slip", *_aligned(table)]
        for name, over_time in tables(self.rows(), axes):
            lines += [f"Over time, in the load {name}", *_aligned(over_time)]
        return "\n".join([*lines, PER_LENGTH, *(f"! {caution}" for caution in self.cautions()), *self.notes])

    __repr__ = __str__


def _aligned(table: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a table; a line that is cut short ends in words."""
    whole = [line for line in table if len(line) == len(table[0])]
    widths = [max(map(len, column)) for column in zip(*whole, strict=True)]
    return ["   ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=False)) for line in table]


def _alike(caution: str) -> str:
    """Return a caution without its numbers, which differ from point to point."""
    return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?(, (?=\d))?", "", caution)


class _Lines(list[str]):
    """Takes the lines of a table."""

    def write(self, line: str) -> None:
        """Add a line."""
        self.append(line)


def _head(key: str) -> str:
    if key not in QUANTITIES:
        meant = sweep_dataset.described(key)
        return key if meant is None or not meant.unit else f"{key} ({meant.unit})"
    quantity = QUANTITIES[key]
    unit = f" ({quantity.unit})" if quantity.unit else ""
    return f"{quantity.words.split()[-1] if key != 'ridges_in_contact' else 'ridges'}{unit}"


def sweep(
    scene: Scene | None = None,
    out: str | Path = "results/sweep",
    *,
    jobs: int = 1,
    model: str = "full",
    quiet: bool = False,
    **axes: Sequence[Any],
) -> Sweep:
    """Return what a model answers to a scene over values of some of its keys.

    Each point is run in a process of its own. Its results are kept in ``out``, and the same sweep, or another one that
    shares points with it, computes only those that are missing. A point that fails has its ``failure`` in the table,
    and the others go on.

    Args:
        scene: the scene; by default press, charge and slide of the default finger.
        out: folder of the results, of ``table.csv`` and of ``report.html``.
        jobs: points that are run at a time.
        model: as of :func:`fingerpad.runs.solve.run`.
        quiet: whether to print no line for each point, and show no progress bar.
        **axes: values by key: ``voltage=[0, 100, 200]``, or ``**{"roughness.h_rms": [2e-6, 3e-6]}``.

    Raises:
        SceneError: a key or a value that a scene cannot have, no values, a scene with laws of its own, which other
            processes cannot be given, more than one rank of MPI, or a folder that holds a run.
        KeyboardInterrupt: Ctrl-C, after the present step of each running point; the same sweep goes on from there.
        SystemExit: SIGTERM or SIGHUP, likewise.
    """
    scene = checked(scene)
    if terminal.ranks() > 1:
        raise SceneError("a sweep runs its points in processes of its own; start it without mpirun, and use jobs")
    if not isinstance(jobs, Integral) or jobs < 1:
        raise SceneError(f"jobs is {show(jobs)}; it must be a whole number, at least 1")
    if not isinstance(out, str | os.PathLike):
        raise SceneError(f"out is {show(out)}; it must be the path of a folder")
    if model not in MODELS:
        raise SceneError(f"model is {show(model)}; it must be {' or '.join(map(repr, MODELS))}")
    scenes = _scenes(scene, axes)
    values = _values(scenes, axes)
    folder = Path(out)
    _claim(folder)
    if model == "cylinders":
        found = [_closed(each) for each in scenes]
    else:
        points = [dict(zip(values, point, strict=True)) for point in itertools.product(*values.values())]
        found = _in_processes(scenes, points, folder, jobs, model, quiet)
    done = Sweep(values, tuple(found), folder)
    for name in FILES[1:]:  # else that of an earlier sweep may stay beside this one's table
        (folder / name).unlink(missing_ok=True)
    asked = {"version": version(), "model": model, "parameters": scene.parameters()}
    replace_json(folder / FILES[-1], asked | {"cautions": done.cautions()})
    done.to_csv(folder / FILES[0])
    notes = tuple(filter(None, (sweep_dataset.save(done), _older(done, folder / model))))
    attempt(folder)
    return replace_fields(done, notes=notes)


def _older(done: Sweep, folder: Path) -> str:
    """Return a note on points that another state of the program has computed; empty without one."""
    kept = (each.record.get("provenance", {}).get("versions", {}) for each in done)
    found = [versions["source"] for versions in kept if "source" in versions]
    count = len(found) - found.count(source())
    if not count:
        return ""
    return f"{count} of {len(done)} points are of another state of the program; delete {folder} to compute them again."


def _claim(folder: Path) -> None:
    """Make the folder; refuse one that cannot be one, or holds a run."""
    check_folder(folder, "out")
    run = next((name for name in ("scene.json", "summary.json", "steps.csv") if (folder / name).exists()), None)
    if run is not None:
        raise SceneError(f"out {clip(str(folder), 80)} holds the results of a run ({run}); choose another folder")
    folder.mkdir(parents=True, exist_ok=True)


def _scenes(scene: Scene, axes: Mapping[str, Sequence[Any]]) -> list[Scene]:
    """Return the scenes of all points, checked."""
    if not axes:
        raise SceneError("the sweep has no axis; give values of at least one key, such as voltage=[0, 100, 200]")
    for key, values in axes.items():
        single = isinstance(values, str) or not isinstance(values, Sequence | Mapping)
        if single and np.ndim(getattr(values, "magnitude", values)) == 0:
            given = show(plain(values))
            raise SceneError(f"{key} of the sweep is {given}; it must be a list, such as [{given}]")
        listed = isinstance(values, Sequence | np.ndarray) and len(values)
        if not listed or any(np.iterable(value) and not isinstance(value, str | Mapping) for value in values):
            raise SceneError(
                f"{key} of the sweep is {show(values)}; it must be a list of at least one value, none a list"
            )
    if scene.parameters().get("laws", {}).keys() - {"mesh"}:
        raise SceneError(
            "the scene has laws of its own, which the processes of a sweep cannot be given; call run for each point"
        )
    count = int(np.prod([len(values) for values in axes.values()]))
    if count > _MOST:
        raise SceneError(f"the sweep has {count} points; at most {_MOST} are allowed")
    return [_with(scene, dict(zip(axes, point, strict=True))) for point in itertools.product(*axes.values())]


def _values(scenes: Sequence[Scene], axes: Mapping[str, Sequence[Any]]) -> dict[str, tuple[Any, ...]]:
    """Return the values of each axis in SI, from the scenes of the grid, the last axis fastest."""
    found, apart = {}, len(scenes)  # points from one value of an axis to the next
    for key, values in axes.items():
        apart //= len(values)
        found[key] = tuple(_at(scenes[k * apart], key) for k in range(len(values)))
        if len(set(map(repr, found[key]))) < len(values):
            raise SceneError(f"{key} of the sweep is {show(values)}; each value must be there once")
    return found


def _with(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """Return the scene with other values by dotted key, as :meth:`Scene.replace` does."""
    data: dict[str, Any] = {}
    for key, value in sorted(changes.items(), key=lambda change: "[" not in change[0]):  # whole lists first
        table = re.split(r"[.\[]", key, maxsplit=1)[0]
        if "[" in key and table not in data:  # an entry of a list, of which the others stay
            data[table] = scene.parameters().get(table)
        put(data, key, plain(value))
    return scene.replace(**data)


def _at(scene: Scene, key: str) -> Any:
    """Return the value of a dotted key in SI."""
    value: Any = scene
    for part, place in re.findall(r"(\w+)|\[(\d+)\]", key):
        value = getattr(value, part) if part else value[int(place)]
    return value


def _closed(scene: Scene) -> Result:
    try:
        return solved(scene, "cylinders")
    except SceneError as error:
        return Result(scene, "cylinders", None, None, None, failure=str(error))


def _in_processes(
    scenes: Sequence[Scene], points: Sequence[Mapping[str, Any]], folder: Path, jobs: int, model: str, quiet: bool
) -> list[Result]:
    """Return the results of scenes, those that can be run in processes of their own, kept by their parameters."""
    from fingerpad.runs import batch

    place = folder / model
    refused, named = {}, {}
    for scene, point in zip(scenes, points, strict=True):
        words = ", ".join(f"{key} {show(value)}" for key, value in point.items())
        try:
            check(scene)
            named[f"{words} ({batch.key(scene)})"] = scene
        except SceneError as error:
            refused[batch.key(scene)] = Result(scene, model, None, None, None, failure=str(error))
    found = batch.sweep(named, place, jobs, _LIMIT, model, quiet)
    results = dict(refused)
    for name, scene in named.items():
        summary, key = found[name], batch.key(scene)
        if set(summary) == {"failure"}:
            results[key] = Result(scene, model, None, None, None, failure=summary["failure"])
        else:
            results[key] = Result.load(place / key)
    return [results[batch.key(scene)] for scene in scenes]
