"""A sweep as one xarray dataset, and as ``sweep.nc`` beside its table: the swept keys are the coordinates."""

import json
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.io import dataset
from fingerpad.io.load_variables import loads
from fingerpad.io.states import STATES
from fingerpad.io.variables import Variables
from fingerpad.scene.keys import Key, every

if TYPE_CHECKING:
    import xarray

    from fingerpad.io.result import Result
    from fingerpad.runs.sweep_results import Sweep

FILE = "sweep.nc"


def of_sweep(sweep: "Sweep") -> "xarray.Dataset":
    """Return a sweep as a dataset.

    Args:
        sweep: with at least one point.

    Returns:
        The named states of every point along the swept keys and ``state``, as in the dataset of a run; likewise its
        loads, its sums over the whole finger and its sites in the named states, where a point has them; its failure and
        cost. The attributes are the parameters that all points share. SI units. A sweep over the force in newtons has
        sums over the whole finger alone, since its points share cross-sections.

    Raises:
        ImportError: xarray is not installed.
    """
    import xarray

    shape = [len(values) for values in sweep.axes.values()]
    axes = tuple(sweep.axes)
    points = [dataset.states(result.named) for result in sweep.results]
    found: Variables = {"state": points[0].pop("state")}
    for name, (dims, _, about) in points[0].items():
        if name != "state" and not sweep.whole:
            values = np.stack([point[name][1] for point in points])
            found[name] = (*axes, *dims), values.reshape(*shape, *values.shape[1:]), about
    found |= _more([_of_point(result, sweep.whole) for result in sweep.results], axes, shape)
    failures = np.array([result.failure for result in sweep.results], object).reshape(shape)
    found["failure"] = axes, failures, {"units": "1", "long_name": "reason of a failure, empty without one"}
    for name, words in (("wall_seconds", "elapsed time"), ("processor_seconds", "processor time of all ranks")):
        values = np.array([getattr(result.cost, name) for result in sweep.results], np.float64).reshape(shape)
        found[name] = axes, values, {"units": "s", "long_name": f"{words} of the point"}
    for key, along in sweep.axes.items():
        meant = described(key)
        unit, words = ("1", key) if meant is None else (meant.unit or "1", meant.meaning)
        found[key] = (key,), _coordinate(along), {"units": unit, "long_name": words}
    coords = {name: value for name, value in found.items() if name in (*axes, *dataset.COORDINATES)}
    data = {name: value for name, value in found.items() if name not in coords}
    return xarray.Dataset(data, coords, _shared(sweep))


def _of_point(result: "Result", whole: bool) -> Variables:
    """Return the newtons of a point; its loads and sites too, where they are of it alone."""
    sums = {name: each for name, each in dataset.finger(result.finger).items() if "slice" not in each[0]}
    if whole:
        return sums
    return (loads(result) if result.loads else {}) | sums | dataset.sites(result)


def _more(points: Sequence[Variables], axes: tuple[str, ...], shape: Sequence[int]) -> Variables:
    """Return variables of all points along the swept keys and their own dimensions; NaN where a point has no value.

    A place along a dimension that has a coordinate is that of its label: a load by name, a ridge by number.
    """
    labels: dict[str, list[Any]] = {}
    for point in points:
        for name in point.keys() & set(dataset.COORDINATES):
            mine = labels.setdefault(name, [])
            mine += [label for label in point[name][1].tolist() if label not in mine]
    if "ridge" in labels:
        labels["ridge"].sort()
    abouts = {name: (dims, about) for point in points for name, (dims, _, about) in point.items()}
    found: Variables = {}
    for name, (dims, about) in abouts.items():
        if name in labels:
            kind = object if isinstance(labels[name][0], str) else np.int32
            found[name] = dims, np.array(labels[name], kind), about
            continue
        sizes = [len(STATES) if dim == "state" else len(labels[dim]) for dim in dims]
        values = np.full((len(points), *sizes), np.nan)
        for k, point in enumerate(points):
            if name in point:
                at = [range(len(STATES)) if dim == "state" else _places(point[dim][1], labels[dim]) for dim in dims]
                values[k][np.ix_(*at)] = point[name][1]
        found[name] = (*axes, *dims), values.reshape(*shape, *sizes), about
    return found


def _places(mine: Any, labels: Sequence[Any]) -> list[int]:
    return [labels.index(label) for label in mine.tolist()]


def described(key: str) -> Key | None:
    """Return what is known of a dotted key of a scene; None of a table."""
    return next((each for each in every() if each.name == re.sub(r"\[\d+\]", "[]", key)), None)


def save(sweep: "Sweep") -> str:
    """Write ``sweep.nc`` into the folder of a sweep; return why not in one sentence, empty where it was written."""
    assert sweep.folder is not None
    return dataset.write(sweep.folder / FILE, lambda: of_sweep(sweep))


def _coordinate(values: Sequence[Any]) -> Any:
    """Return numbers as they are, and all else as text: names, switches, lists and tables."""
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        whole = all(isinstance(value, int) for value in values)
        return np.array(values, np.int32 if whole else np.float64)
    return np.array([value if isinstance(value, str) else json.dumps(value, default=str) for value in values], object)


def _shared(sweep: "Sweep") -> dict[str, Any]:
    """Return the attributes that all points have in common."""
    every_one = [dataset.attributes(result) for result in sweep.results]
    first = every_one[0]
    texts = [{key: json.dumps(value) for key, value in each.items()} for each in every_one]
    own = ("parameters", "provenance", "failure", "notes", "cautions")
    return {
        key: value for key, value in first.items() if key not in own and all(t.get(key) == texts[0][key] for t in texts)
    }
