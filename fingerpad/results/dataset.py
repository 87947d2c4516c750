"""A result as one xarray dataset, as ``result.nc`` has it, and back: the one file that a result is read from.

Its variables are those of :mod:`fingerpad.results.quantities`, each with ``units`` and ``long_name``, in SI units. Its
attributes are the parameters of the scene, the costs and, as JSON, all else. The file is NetCDF 3 with 64-bit offsets,
by SciPy: every program for NetCDF reads it, and it loads no HDF5 beside that of dolfinx.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.results import files
from fingerpad.results.data import ResultData
from fingerpad.results.quantities import (
    CHANGES,
    CONDITIONS,
    RESULTS,
    RIDGES,
    SITES,
    SKIN,
    SLICES,
    SPECTRUM,
    STABILITY,
    STEPS,
    STIMULI,
    Output,
)
from fingerpad.results.states import STATES, UNLOADED
from fingerpad.scene.reading import flat
from variational.state import PATH, ContactState, Errors, RidgeStates, Sites, Stimuli

if TYPE_CHECKING:
    import xarray

    from fingerpad.slices.finger import WholeFinger

FILE = "result.nc"
COORDINATES = ("step", "load", "state", "ridge", "side", "iteration", "harmonic")
Variables = dict[str, tuple[tuple[str, ...], Any, dict[str, str]]]
"""Dimensions, values, and attributes by name."""
OF_RIDGES = {name: "length" if name == "contact_length" else name for name in RIDGES}
OF_SITES = dict(zip(SITES, [each.name for each in fields(Sites)][1:], strict=True))
"""Attribute of :class:`RidgeStates`, and of :class:`Sites`, by quantity."""
BY_RIDGE: dict[str, tuple[type[Any], str, dict[str, str]]] = {
    "ridges": (RidgeStates, "ridge_", OF_RIDGES),
    "sites": (Sites, "", OF_SITES),
    "stimuli": (Stimuli, "", {name: name for name in STIMULI}),
}
"""By attribute of a state: class, begin of the names of its variables, and attributes by quantity."""
CHANGED = tuple(field.name for field in fields(Errors) if field.name != "own")


def dataset(result: ResultData) -> "xarray.Dataset":
    """Return a result of any model as a dataset; ``docs/results.md`` lists its dimensions.

    Returns:
        The dataset, in SI units; NaN where a state has no value.
    """
    import xarray  # brings pandas: a second that reading numbers does not need

    found = variables(result)
    coords = {name: value for name, value in found.items() if name in COORDINATES}
    data = {name: value for name, value in found.items() if name not in COORDINATES}
    return xarray.Dataset(data, coords, attributes(result))


def variables(result: ResultData) -> Variables:
    """Return the variables and coordinates of a result."""
    named = [result.named.get(name) for name in STATES]
    every = [*result.steps, *filter(None, named)]
    numbers = sorted({int(j) for s in every for each in (s.ridges, s.sites) if each is not None for j in each.number})
    known = STEPS | {each.name: each for each in result.outputs}
    found: Variables = {"state": (("state",), np.array(STATES, object), _about("named state"))}
    found |= _of_states(named, "state", "state_", known, numbers) | _verdicts(named, known)
    if result.steps:
        found |= _of_states(result.steps, "step", "", known, numbers)
        found |= _coupling(result.steps) | _loads(result, known)
    if numbers:
        found["ridge"] = ("ridge",), np.array(numbers, np.int32), _about("number of the ridge, 0 central")
    if any("side" in dims for dims, _, _ in found.values()):
        found["side"] = ("side",), np.array(["left", "right"], object), _about("side of the ridge")
    return found | _skin(result.named) | _finger(result.finger)


def content(data: "xarray.Dataset") -> bytes:
    """Return the content of a file of NetCDF 3."""
    return bytes(data.to_netcdf(engine="scipy", format="NETCDF3_64BIT"))


def attributes(result: ResultData) -> dict[str, Any]:
    """Return the attributes of a dataset: model, costs, every parameter by its dotted key, and all else as JSON."""
    parameters = result.parameters
    found: dict[str, Any] = {"title": "fingerpad: a fingertip on a touchscreen", "format": files.FORMAT}
    found |= {"model": result.model, **asdict(result.cost)}
    found |= {name: text for name in ("failure", "interrupted") if (text := getattr(result, name))}
    found |= {
        name: "\n".join(map(str, getattr(result, name))) for name in ("notes", "cautions") if getattr(result, name)
    }
    if result.cautions:
        found["caution_codes"] = "\n".join(each.code for each in result.cautions)
        found["caution_numbers"] = [np.nan if each.number is None else float(each.number) for each in result.cautions]
    found |= {"record": json.dumps(result.record)} if result.record else {}
    found |= {"outputs": json.dumps([each.to_dict() for each in result.outputs])} if result.outputs else {}
    if result.finger is not None:
        found |= {"whole_finger": json.dumps({"source": result.finger.source, "carried": result.finger.carried})}
    given = {key: _attribute(value) for key, value in flat(parameters).items() if value is not None}
    return found | {"parameters": json.dumps(parameters)} | given


def _attribute(value: Any) -> Any:
    """Return a parameter as NetCDF can hold it: a number, a text or a list of numbers; all else as JSON."""
    numbers = value if isinstance(value, list) else [value]
    plain = all(type(each) is float or (type(each) is int and abs(each) < 2**31) for each in numbers)
    return value if isinstance(value, str) or (numbers and plain) else json.dumps(value)


def _about(meaning: str, unit: str = "1") -> dict[str, str]:
    return {"units": unit, "long_name": meaning}


def filled(shape: Sequence[int], kind: np.dtype[Any]) -> NDArray[Any]:
    """Return an array of values that are missing: NaN, an empty text, and -1 of whole numbers and switches."""
    if kind.kind in "OUS":
        return np.full(shape, "", object)
    return np.full(shape, np.nan) if kind.kind == "f" else np.full(shape, -1, np.int32)


def _column(values: Sequence[Any], example: Any = math.nan) -> NDArray[Any]:
    """Return values as NetCDF can hold them, missing where one is None; an example is of their kind."""
    known = np.array([example if value is None else value for value in values])
    known = known.astype({"i": np.int32, "U": object}.get(known.dtype.kind, known.dtype))
    there = np.array([value is not None for value in values])
    if there.all():
        return known
    found = filled([len(values)], known.dtype)
    found[there] = known[there]
    return found


def _padded(rows: Sequence[Any]) -> NDArray[np.float64]:
    """Return arrays, of which some are None, as one along a further first axis; NaN beyond the end of each."""
    given = {k: np.asarray(row) for k, row in enumerate(rows) if row is not None}
    shape = [max(each.shape[axis] for each in given.values()) for axis in range(next(iter(given.values())).ndim)]
    found = np.full([len(rows), *shape], np.nan)
    for k, each in given.items():
        found[k][tuple(map(slice, each.shape))] = each
    return found


# -- writing -----------------------------------------------------------------------------------------------
def _of_states(
    states: Sequence[ContactState | None], dim: str, prefix: str, known: Mapping[str, Output], numbers: Sequence[int]
) -> Variables:
    """Return all of states along a dimension, ridges and receptor sites too; missing where there is no state."""
    rows = [None if state is None else state.row() for state in states]
    first = next(filter(None, rows), UNLOADED.row() | {name: math.nan for name in known if name not in STEPS})
    found: Variables = {}
    for name, example in first.items():
        values = _column([None if row is None else row.get(name, math.nan) for row in rows], example)
        about = known.get(name, Output(name, "")).about()
        found["load_name" if prefix + name == "load" else prefix + name] = (dim,), values, about
    place = {number: k for k, number in enumerate(numbers)}
    for group, (_, start, attributes) in BY_RIDGE.items():
        given = [(k, each) for k, state in enumerate(states) if (each := getattr(state, group, None)) is not None]
        for name, attribute in attributes.items() if given else ():
            values = filled([len(states), len(numbers)], np.dtype("O" if name == "note" else "f8"))
            for k, each in given:
                if len(mine := getattr(each, attribute)):
                    values[k, [place[int(j)] for j in each.number]] = mine
            found[prefix + start + name] = (dim, "ridge"), values, (RIDGES | SITES | STIMULI)[name].about()
    if f"{prefix}meissner_left" in found:
        (dims, left, _), (_, right, _) = (found.pop(f"{prefix}meissner_{side}") for side in ("left", "right"))
        about = SITES["merkel_sed"].about() | {"long_name": "strain energy density at the Meissner sites of the ridge"}
        found[f"{prefix}meissner_sed"] = (*dims, "side"), np.stack([left, right], axis=-1), about
    return found


def _verdicts(named: Sequence[ContactState | None], known: Mapping[str, Output]) -> Variables:
    """Return stability, errors and changes of the named states; of outputs of one's own where they are known."""
    found: Variables = {}
    for name, output in STABILITY.items():
        kind = int if name == "stable" else float
        given = [None if (each := getattr(state, name, None)) is None else kind(each) for state in named]
        found[f"state_{name}"] = ("state",), _column(given, kind()), output.about()
    about = _about("how the state was reached, by its path or from another state")
    found["state_reached"] = ("state",), _column([getattr(state, "reached", None) for state in named], ""), about
    for change, words in CHANGES.items():
        every = [getattr(state, change, None) for state in named]
        own = dict.fromkeys(key for each in every if each for key in each.own if key in known)  # after their errors
        for key in (*CHANGED, *own):
            changes = [getattr(each, key, None) for each in every]
            found[f"state_{key}_{change}"] = ("state",), _column(changes), known[key].about(f"{words} of the ")
    return found


def _coupling(steps: Sequence[ContactState]) -> Variables:
    """Return the changes of the coupling iterations along ``step`` and ``iteration``; nothing without any."""
    values = _padded([state.changes for state in steps])
    if not values.shape[1]:
        return {}
    numbers = np.arange(1, values.shape[1] + 1, dtype=np.int32)
    words = "relative change of the air gaps in the coupling iteration"
    return {
        "iteration": (("iteration",), numbers, _about("number of the coupling iteration")),
        "coupling_change": (("step", "iteration"), values, _about(words)),
    }


def _loads(result: ResultData, known: Mapping[str, Output]) -> Variables:
    """Return the results of the loads along ``load``; lengths, means and spectra are NaN where a load takes no time."""
    loads, passed = result.loads, [load.over_time for load in result.loads]
    found: Variables = {}

    def add(name: str, values: Sequence[Any], about: dict[str, str], example: Any = math.nan) -> None:
        found[name] = ("load",), _column(values, example), about

    add("load", [load.name for load in loads], STEPS["load"].about())
    add("load_last_step", [load.end.step for load in loads], _about("last step of the load"))
    for word in ("reached", "held"):
        values = [getattr(load, f"full_slip_{word}") for load in loads]
        add(f"load_full_slip_{word}", values, _about(f"whether full slip was {word} in the load"))
    stable = [None if load.stable is None else int(load.stable) for load in loads]
    add("load_stable", stable, _about("whether the state at the end of the load is stable; -1 where not examined"), 0)
    for name in dict.fromkeys(name for load in loads for name in load.extremes):
        for end, words in (("min", "least"), ("max", "largest")):
            values = [getattr(load.extremes.get(name), end, math.nan) for load in loads]
            add(f"load_{name}_{end}", values, known[name].about(f"{words} value in the load: "))
    if not any(passed):
        return found
    for name, words in (("start", "time at which the load begins"), ("seconds", "length of the load")):
        add(f"load_{name}", [getattr(each, name, None) for each in passed], _about(words, "s"))
    for name in next(filter(None, passed)).mean:
        values = [None if each is None else each.mean[name] for each in passed]
        add(f"load_{name}_mean", values, known[name].about("mean over time in the load: "))
    for name, output in SPECTRUM.items():
        table = _padded([None if each is None else getattr(each, name) for each in passed])
        if table.shape[1]:
            numbers = np.arange(1, table.shape[1] + 1, dtype=np.int32)
            found["harmonic"] = ("harmonic",), numbers, _about("multiple of the frequency of the waveform")
            found[f"load_{name}"] = ("load", "harmonic"), table, output.about()
    return found


def _skin(named: Mapping[str, ContactState]) -> Variables:
    """Return the skin along ``state``, ``facet`` and ``point``; NaN beyond the facets of a state's mesh."""
    skins = [named[name].skin if name in named else None for name in STATES]
    if not any(skins):
        return {}
    dims, number = ("state", "facet", "point"), _about("number of the ridge of the facet")
    found: Variables = {
        f"skin_{name}": (dims, _padded([getattr(skin, name, None) for skin in skins]), output.about())
        for name, output in SKIN.items()
    }
    return found | {"skin_ridge": (dims[:2], _padded([getattr(skin, "ridge", None) for skin in skins]), number)}


def _finger(whole: "WholeFinger | None") -> Variables:
    """Return the whole finger along ``state``, and its slices along ``state`` and ``slice``; NaN if missing."""
    if whole is None:
        return {}
    totals = [whole.states.get(name) for name in STATES]
    found: Variables = {}
    own = {each.name: each for trace in whole.traces.values() for each in trace.own}
    for name, output in whole.quantities.items():
        values = [None if total is None else total.values.get(name) for total in totals]
        errors = [whole.error.get(state, {}).get(name) for state in STATES]
        found[f"finger_{name}"] = ("state",), _column(values), output.about()
        found[f"finger_{name}_error"] = ("state",), _column(errors), output.about("estimated error of the ")
    for name, output in (SLICES | own).items():
        along = [None if total is None else total.slices().get(name) for total in totals]
        if any(each is not None for each in along):
            found[f"slice_{name}"] = ("state", "slice"), _padded(along), output.about()
    centres = [None if total is None else total.centre for total in totals]
    words = "external normal force of the slice that is indented most per metre of finger"
    found["finger_centre"] = ("state",), _column(centres), _about(words, "N/m")
    return found | _traces(whole)


def _traces(whole: "WholeFinger") -> Variables:
    """Return the traces of the cross-section along ``state`` and ``trace``."""
    traces = [whole.traces.get(name) for name in STATES]
    columns = dict.fromkeys(name for trace in traces if trace is not None for name in trace.columns)
    own = {each.name: each for trace in whole.traces.values() for each in trace.own}
    found: Variables = {}
    for name in ("depth", *columns, "ridges"):
        rows = [None if t is None else t.columns.get(name, getattr(t, name, None)) for t in traces]
        if any(row is not None for row in rows):
            about = (SLICES | own).get(name, SLICES["indentation"] if name == "depth" else STEPS["ridges_in_contact"])
            found[f"trace_{name}"] = ("state", "trace"), _padded(rows), about.about("of a trace: ")
    return found


# -- one flat record --------------------------------------------------------------------------------------
def values(result: ResultData) -> dict[str, Any]:
    """Return what is known of the named states, flat: ``full_slip_mu_app``; None where a state is missing."""
    found: dict[str, Any] = {}
    names = (*CONDITIONS, *RESULTS, *STABILITY, *(each.name for each in result.outputs))
    for name in STATES:
        state = result.named.get(name)
        found |= {f"{name}_{key}": None if state is None else getattr(state, key) for key in names}
        for kind in CHANGES if state is not None else ():
            found |= {f"{name}_{key}_{kind}": value for key, value in getattr(state, kind).known().items()}
    return {key: None if value != value else value for key, value in found.items()}


def summary(result: ResultData) -> dict[str, Any]:
    """Return a result without its headline as ``summary.json`` has it."""
    reached = (*result.named.values(), *result.steps)
    last = reached[-1] if reached else None
    found: dict[str, Any] = {"format": files.FORMAT, "model": result.model, "full_slip": result.full_slip is not None}
    found |= {key: 0.0 if last is None else getattr(last, key) for key in ("f_ext", "voltage")}
    found |= asdict(result.cost) | values(result) | ({} if result.finger is None else result.finger.flat())
    found |= {f"{name}_reached": each.reached for name, each in result.named.items() if each.reached != PATH}
    found |= {"parameters": result.scene.parameters()} | result.record
    found |= {name: text for name in ("failure", "interrupted") if (text := getattr(result, name))}
    found |= {name: list(map(str, kept)) for name in ("notes", "cautions") if (kept := getattr(result, name))}
    return found | ({"caution_codes": [each.code for each in result.cautions]} if result.cautions else {})
