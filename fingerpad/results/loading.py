"""A result read back from its dataset: the reverse of :mod:`fingerpad.results.dataset`."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.results import quantities
from fingerpad.results.dataset import CHANGED, FILE, OF_RIDGES
from fingerpad.results.files import FORMAT, read_object
from fingerpad.results.quantities import RIDGES, SKIN, STEPS, STIMULI, Output
from fingerpad.results.states import STATES, LoadResult, load_results
from fingerpad.scene.law_code import foreign
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.parameters import Slices
from fingerpad.scene.reading import model_name
from fingerpad.scene.remarks import coefficient
from fingerpad.scene.scene import Scene, as_kept
from variational.caution import Caution
from variational.files import read as read_bytes
from variational.state import PATH, ContactState, Errors, RidgeStates, Sites, Skin, StepRecord, Stimuli

if TYPE_CHECKING:
    import xarray

    from fingerpad.slices.finger import WholeFinger


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


def parts(data: "xarray.Dataset", cost: type) -> dict[str, Any]:
    """Return the fields of the result of a dataset, but for its folder.

    Args:
        data: the dataset.
        cost: the class of its costs.

    Raises:
        SceneError: it is not of a result, or its parameters are no valid scene.
    """
    about = data.attrs
    try:
        parameters, record = json.loads(about["parameters"]), json.loads(about.get("record", "{}"))
        outputs = tuple(Output(**each) for each in json.loads(about.get("outputs", "[]")))
        scene = as_kept(parameters)
        if "laws" in parameters:  # objects of Python, of which only the names are kept
            record["parameters"] = parameters
        steps, named = _states(data, [each.name for each in outputs])
        stable = [None if k < 0 else bool(k) for k in data["load_stable"].values] if steps else []
        found = {name: named.get(name) for name in STATES} | {"scene": scene, "model": model_name(about["model"])}
        found |= {name: about.get(name, "") for name in ("failure", "interrupted")}
        found |= {"notes": _lines(about, "notes"), "cautions": _cautions(about)}
        found["cost"] = cost(**{each.name: _plain(about[each.name]) for each in fields(cost)})
        found |= {"steps": steps, "loads": loads_of(scene, steps, stable), "record": record, "outputs": outputs}
        return found | {"finger": _finger(data, outputs, scene.slices)}
    except (KeyError, ValueError, TypeError, IndexError, AttributeError) as error:  # a SceneError is a ValueError
        if isinstance(error, SceneError):
            raise
        raise SceneError(f"its dataset is not of a run ({type(error).__name__}: {error})") from None


def loads_of(scene: Scene, steps: Sequence[ContactState], stable: Sequence[bool | None]) -> tuple[LoadResult, ...]:
    """Return the result of each load, with the stability of its end as far as that is known."""
    known = (*stable, *[None] * (len(scene.loads()) + 1))
    return tuple(load_results(steps, scene.loads(), lambda k, end: known[k], coefficient(scene)))


def _states(data: "xarray.Dataset", own: Sequence[str]) -> tuple[tuple[ContactState, ...], dict[str, ContactState]]:
    """Return the steps and the named states of a dataset.

    Args:
        data: of a result.
        own: names of outputs that are computed from a state.
    """
    arrays = {str(name): variable.values for name, variable in data.variables.items()}
    steps = tuple(_state(arrays, "", k, own) for k in range(len(arrays.get("step", ()))))
    there = [(k, name) for k, name in enumerate(STATES) if arrays["state_step"][k] >= 0]
    return steps, {name: _named_state(arrays, k, own) for k, name in there}


def _finger(data: "xarray.Dataset", outputs: Sequence[Output], shape: Slices) -> "WholeFinger | None":
    """Return the whole finger of a dataset; None without one.

    Args:
        data: of a result.
        outputs: that are computed from a state.
        shape: the finger along its axis.
    """
    from fingerpad.slices.finger import WholeFinger  # it takes names of this module's wing
    from fingerpad.slices.total import Total
    from fingerpad.slices.trace import Trace

    if "finger" not in data.attrs:
        return None
    totals, traces, kept = {}, {}, json.loads(data.attrs["finger"])
    arrays = {str(name): variable.values for name, variable in data.variables.items()}
    for k, name in enumerate(STATES):
        if np.isnan(arrays["finger_centre"][k]):
            continue
        slices = {key.removeprefix("slice_"): _filled(each[k]) for key, each in arrays.items() if key[:6] == "slice_"}
        slices = {key: each for key, each in slices.items() if len(each) and key != "pressure"}
        places = slices.pop("z"), slices.pop("thickness"), slices.pop("indentation")
        totals[name] = Total(arrays["finger_indentation"][k], *places, arrays["finger_centre"][k], slices)
        columns = {key.removeprefix("trace_"): _filled(each[k]) for key, each in arrays.items() if key[:6] == "trace_"}
        columns = {key: each for key, each in columns.items() if len(each)}
        if columns:
            ridges = columns.pop("ridges", None)
            depth = columns.pop("depth")
            own = tuple(each for each in outputs if each.name in columns)
            traces[name] = Trace(depth, columns, None if ridges is None else ridges.astype(int), own)
    return WholeFinger(totals, kept["source"], kept["carried"], traces, shape)


def _state(arrays: Mapping[str, NDArray[Any]], prefix: str, k: int, own: Sequence[str]) -> ContactState:
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
    number = arrays.get("ridge", np.arange(0))
    if f"{prefix}ridge_contact_length" in arrays:
        columns = {OF_RIDGES[name]: arrays[f"{prefix}ridge_{name}"][k] for name in RIDGES}
        there = np.isfinite(columns["length"])
        values = {name: column[there] for name, column in columns.items()}
        more["ridges"] = RidgeStates(number[there].astype(int), **values | {"note": tuple(map(str, values["note"]))})
    if f"{prefix}merkel_sed" in arrays and (there := np.isfinite(arrays[f"{prefix}merkel_sed"][k])).any():
        left, right = arrays[f"{prefix}meissner_sed"][k][there].T
        more["sites"] = Sites(number[there].astype(int), arrays[f"{prefix}merkel_sed"][k][there], left, right)
    if f"{prefix}merkel_stress" in arrays:
        there = np.isfinite(arrays[f"{prefix}merkel_stress"][k])
        values = {name: arrays[f"{prefix}{name}"][k][there] for name in STIMULI}
        more["stimuli"] = Stimuli(number[there].astype(int), **values) if there.any() else None
    if not prefix and "coupling_change" in arrays:
        more["changes"] = tuple(map(float, arrays["coupling_change"][k][np.isfinite(arrays["coupling_change"][k])]))
    return ContactState(**row, **more)


def _named_state(arrays: Mapping[str, NDArray[Any]], k: int, own: Sequence[str]) -> ContactState:
    """Return a named state by its place, with its stability, errors and skin."""
    stable, least, gain = (arrays[f"state_{name}"][k] for name in quantities.STABILITY)
    more: dict[str, Any] = {"stable": None if stable < 0 else bool(stable)}
    more |= {name: None if np.isnan(value) else float(value) for name, value in (("lambda_min", least), ("gain", gain))}
    for kind in quantities.CHANGES:
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
