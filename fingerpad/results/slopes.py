"""The slopes of a run's results by the numbers of its scene, as tables: what moves friction most comes first."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fingerpad.results.data import ResultData
from fingerpad.results.quantities import STEPS, Output
from fingerpad.results.states import STATES, WORDS
from fingerpad.scene.keys import by_name
from fingerpad.scene.messages import SceneError, clip, show

if TYPE_CHECKING:
    import xarray

SLOPES = "sensitivities"
"""Key of the slopes in a result's record."""


class Row(NamedTuple):
    """The slope of a quantity by one number of the scene; SI."""

    key: str
    value: float
    unit: str
    slope: float
    """Derivative; 0 by a number without effect."""
    scatter: float
    """By how much the derivative is another one at fixed points in contact, until the next one comes or goes."""
    elasticity: float
    """Per cent of the quantity for one per cent of the number."""
    lowest: float
    """Value of the number to which the same ridges touch, by straight extrapolation; minus infinity where they do so at
    all values that the key may have."""
    highest: float


def rows(result: ResultData, quantity: str = "mu_app", state: str = "") -> list[Row]:
    """Return the slopes of a quantity, the largest elasticities first.

    Args:
        result: of a run with ``output.sensitivities``.
        quantity: a quantity of a state.
        state: name of the state; by default the last of the named states that has slopes.

    Raises:
        SceneError: the run has no slopes, or none of this state or quantity; in one sentence.
    """
    name, found = _kept(result, state)
    if quantity not in found["slopes"]:
        raise SceneError(f"{clip(quantity)} has no sensitivities; quantities are {', '.join(found['slopes'])}")
    at, keys = getattr(result.named[name], quantity), by_name(type(result.scene))

    def row(key: str, slope: float) -> Row:
        value, scatter = found["values"][key], abs(slope - found["stairs"][quantity][key])
        down, up = (np.inf if end is None else end for end in found["ends"][key])
        elasticity, lowest, highest = slope * value / at if at else np.nan, value - down, value + up
        if key not in keys:
            return Row(key, value, "", slope, scatter, elasticity, lowest, highest)
        if (limits := keys[key].limits) is not None and limits.sides == 1:
            lowest = lowest if lowest >= limits.low else -np.inf  # no ridge comes or goes at a value that is allowed
            highest = highest if highest <= limits.high else np.inf
        return Row(key, value, keys[key].unit, slope, scatter, elasticity, lowest, highest)

    return sorted((row(*each) for each in found["slopes"][quantity].items()), key=lambda row: -abs(row.elasticity))


def left_out(result: ResultData, state: str = "") -> dict[str, str]:
    """Return the numbers without slopes and why, by dotted key; arguments and errors of :func:`rows`."""
    return dict(_kept(result, state)[1].get("left_out", {}))


def _kept(result: ResultData, state: str) -> tuple[str, dict[str, Any]]:
    """Return the name of a state and what the record has of it."""
    kept: dict[str, Any] = result.record.get(SLOPES, {})
    if not kept:
        wanted = result.scene.output.sensitivities
        why = "it has no full slip on its final mesh" if wanted else "run it with output.sensitivities=true"
        raise SceneError(f"the run has no sensitivities; {why}")
    name = state or next(each for each in reversed(STATES) if each in kept)
    if name not in kept:
        raise SceneError(f"state is {show(name)}; sensitivities are of {', '.join(kept)}")
    found = kept[name]
    if why := found.get("why"):
        raise SceneError(f"{WORDS[name]} has no sensitivities: {why}")
    return name, found


def dataset(result: ResultData, quantity: str = "mu_app", state: str = "") -> "xarray.Dataset":
    """Return :func:`rows` along the dimension ``number``, whose names are the keys of the scene."""
    import xarray  # brings pandas

    found = rows(result, quantity, state)
    words = {
        "value": "value of the number in the scene",
        "slope": f"derivative of {quantity}",
        "scatter": "change of the derivative where points in contact stay as they are",
        "elasticity": "per cent of the quantity for one per cent of the number",
        "lowest": "value down to which the same ridges touch, by straight extrapolation",
        "highest": "value up to which the same ridges touch, by straight extrapolation",
    }
    data = {
        name: ("number", [getattr(row, name) for row in found], {"long_name": text}) for name, text in words.items()
    }
    about = STEPS.get(quantity, Output(quantity, "")).about()
    units = ("number", [row.unit for row in found])
    return xarray.Dataset(data, {"number": [row.key for row in found], "unit": units}, {"quantity": quantity} | about)
