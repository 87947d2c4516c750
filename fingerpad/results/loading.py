"""A result read back from its dataset: the reverse of :mod:`fingerpad.results.dataset`."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.results.data import Cost
from fingerpad.results.dataset import BY_RIDGE, CHANGED, FILE
from fingerpad.results.files import FORMAT, read_object
from fingerpad.results.quantities import CHANGES, SKIN, STABILITY, STEPS, Output
from fingerpad.results.states import STATES, load_results
from fingerpad.scene.law_code import foreign
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.parameters import Slices
from fingerpad.scene.reading import model_name
from fingerpad.scene.remarks import coefficient
from fingerpad.scene.scene import as_kept
from variational.caution import Caution
from variational.files import read as read_bytes
from variational.state import PATH, ContactState, Errors, Skin, StepRecord

if TYPE_CHECKING:
    import xarray

    from fingerpad.slices.finger import WholeFinger

Arrays = Mapping[str, NDArray[Any]]
"""Values of a dataset by variable."""


def read(folder: Path) -> "xarray.Dataset":
    """Return the dataset of the run in a folder.

    Raises:
        SceneError: there is none, or it is not whole.
    """
    import xarray  # brings pandas

    foreign(folder)
    name = clip(str(folder), 80)
    try:
        data = xarray.load_dataset(BytesIO(read_bytes(folder / FILE)), engine="scipy")
    except (FileNotFoundError, NotADirectoryError):
        raise SceneError(_without_result(folder)) from None
    except Exception as error:  # whatever a file that somebody else wrote makes its readers raise
        raise SceneError(f"run {name} cannot be read: {FILE} is not whole, or not of a run ({error})") from None
    if data.attrs.get("format") != FORMAT:
        raise SceneError(f"the run in {name} was written by another version of fingerpad; run it again")
    return data


def _without_result(folder: Path) -> str:
    """Return why there is no result in a folder, a sentence."""
    name = clip(str(folder), 80)
    try:
        return f"the run in {name} was refused and has no results: {read_object(folder / 'summary.json')['failure']}"
    except (OSError, ValueError, KeyError):
        return f"{name} is not a folder of a finished run"


def parts(data: "xarray.Dataset") -> dict[str, Any]:
    """Return the fields of the result of a dataset, but for its folder.

    Raises:
        SceneError: it is not of a result, or its parameters are no valid scene.
    """
    about, arrays = data.attrs, {str(name): variable.values for name, variable in data.variables.items()}
    try:
        for prefix in ("", "state_"):
            if (sed := arrays.pop(f"{prefix}meissner_sed", None)) is not None:
                arrays |= {f"{prefix}meissner_left": sed[..., 0], f"{prefix}meissner_right": sed[..., 1]}
        parameters, record = json.loads(about["parameters"]), json.loads(about.get("record", "{}"))
        outputs = tuple(Output(**each) for each in json.loads(about.get("outputs", "[]")))
        scene, own = as_kept(parameters), [each.name for each in outputs]
        if "laws" in parameters:  # objects of Python, of which only the names are kept
            record["parameters"] = parameters
        steps = tuple(_state(arrays, "", k, own) for k in range(len(arrays.get("step", ()))))
        there = {name: k for k, name in enumerate(STATES) if arrays["state_step"][k] >= 0}
        found: dict[str, Any] = {
            name: _named_state(arrays, there[name], own) if name in there else None for name in STATES
        }
        stable = dict(zip(arrays["load_last_step"], arrays["load_stable"], strict=True)) if steps else {}
        loads = load_results(
            steps, scene.loads(), lambda end: {0: False, 1: True}.get(stable.get(end.step, -1)), coefficient(scene)
        )
        found |= {"steps": steps, "loads": loads, "scene": scene, "record": record, "outputs": outputs}
        found |= {name: about.get(name, "") for name in ("failure", "interrupted")}
        found |= {"notes": _lines(about, "notes"), "cautions": _cautions(about)}
        found |= {"cost": Cost(**{each.name: _plain(about[each.name]) for each in fields(Cost)})}
        kept = json.loads(about["whole_finger"]) if "whole_finger" in about else None
        finger = None if kept is None else _finger(arrays, kept, outputs, scene.slices)
        return found | {"model": model_name(about["model"]), "finger": finger}
    except (KeyError, ValueError, TypeError, IndexError, AttributeError) as error:  # a SceneError is a ValueError
        if isinstance(error, SceneError):
            raise
        raise SceneError(f"its dataset is not of a run ({type(error).__name__}: {error})") from None


def _finger(arrays: Arrays, kept: Mapping[str, Any], outputs: Sequence[Output], shape: Slices) -> "WholeFinger":
    """Return the whole finger of a dataset.

    Args:
        arrays: values by variable.
        kept: what has no variable, its source and the errors of its section.
        outputs: that are computed from a state.
        shape: the finger along its axis.
    """
    from fingerpad.slices.finger import WholeFinger  # it takes names of this module's wing
    from fingerpad.slices.total import Total
    from fingerpad.slices.trace import Trace

    def columns(prefix: str, k: int) -> dict[str, NDArray[Any]]:
        rows = {key.removeprefix(prefix): _filled(each[k]) for key, each in arrays.items() if key.startswith(prefix)}
        return {key: row for key, row in rows.items() if len(row)}

    totals, traces = {}, {}
    for k, name in enumerate(STATES):
        if np.isnan(arrays["finger_centre"][k]):
            continue
        slices = columns("slice_", k)
        for follows in ("pressure", "real_over_gross"):
            slices.pop(follows, None)
        places = slices.pop("z"), slices.pop("thickness"), slices.pop("indentation")
        totals[name] = Total(arrays["finger_indentation"][k], *places, arrays["finger_centre"][k], slices)
        if trace := columns("trace_", k):
            ridges, depth = trace.pop("ridges", None), trace.pop("depth")
            own = tuple(each for each in outputs if each.name in trace)
            traces[name] = Trace(depth, trace, None if ridges is None else ridges.astype(int), own)
    return WholeFinger(totals, kept["source"], kept["carried"], traces, shape)


def _state(arrays: Arrays, prefix: str, k: int, own: Sequence[str]) -> ContactState:
    """Return the state at a place of the dimension whose variables begin with a prefix.

    Args:
        arrays: values by variable.
        prefix: ``state_`` of the named states; empty of the steps.
        k: the place.
        own: names of outputs that are computed from a state.
    """
    names = {name: "load_name" if prefix + name == "load" else prefix + name for name in (*STEPS, *own)}
    row = {name: _plain(arrays[there][k]) for name, there in names.items() if there in arrays}
    record = {each.name: row.pop(each.name) for each in fields(StepRecord) if each.name in row}
    more: dict[str, Any] = {"own": {name: row.pop(name) for name in own if name in row}}
    more |= {"record": StepRecord(**record)} if record else {}
    for group, (kind, start, attributes) in BY_RIDGE.items():
        columns = {attributes[name]: arrays.get(prefix + start + name) for name in attributes}
        first = next(iter(columns.values()))
        if first is not None and (there := np.isfinite(first[k])).any():
            values = {attribute: column[k][there] for attribute, column in columns.items()}  # type: ignore[index]
            values |= {"note": tuple(map(str, values["note"]))} if "note" in values else {}
            more[group] = kind(arrays["ridge"][there].astype(int), **values)
    if not prefix and "coupling_change" in arrays:
        more["changes"] = tuple(map(float, arrays["coupling_change"][k][np.isfinite(arrays["coupling_change"][k])]))
    return ContactState(**row, **more)


def _named_state(arrays: Arrays, k: int, own: Sequence[str]) -> ContactState:
    """Return a named state by its place, with its stability, errors and skin."""
    stable, least, gain = (arrays[f"state_{name}"][k] for name in STABILITY)
    more: dict[str, Any] = {"stable": None if stable < 0 else bool(stable)}
    more |= {name: None if np.isnan(value) else float(value) for name, value in (("lambda_min", least), ("gain", gain))}
    for kind in CHANGES:
        names = {key: f"state_{key}_{kind}" for key in (*CHANGED, *own)}
        more[kind] = Errors.of({key: float(arrays[name][k]) for key, name in names.items() if name in arrays})
    if "skin_ridge" in arrays and (facets := np.isfinite(arrays["skin_ridge"][k])).any():
        points = np.isfinite(arrays["skin_x"][k]).any(axis=0)
        values = {name: arrays[f"skin_{name}"][k][facets][:, points] for name in SKIN}
        more["skin"] = Skin(ridge=arrays["skin_ridge"][k][facets].astype(int), **values)
    return replace(_state(arrays, "state_", k, own), reached=str(arrays["state_reached"][k]) or PATH, **more)


def _lines(about: Mapping[str, Any], name: str) -> tuple[str, ...]:
    return tuple(filter(None, about.get(name, "").split("\n")))


def _cautions(about: Mapping[str, Any]) -> tuple[Caution, ...]:
    numbers = (None if np.isnan(each) else float(each) for each in np.atleast_1d(about.get("caution_numbers", ())))
    return tuple(map(Caution, _lines(about, "caution_codes"), _lines(about, "cautions"), numbers))


def _plain(value: Any) -> Any:
    """Return a value of an array as Python has it."""
    return value.item() if isinstance(value, np.generic) else value


def _filled(row: NDArray[Any]) -> NDArray[Any]:
    """Return a row without the missing values that fill it up."""
    known = np.flatnonzero(~np.isnan(row))
    return row[: known[-1] + 1] if len(known) else row[:0]
