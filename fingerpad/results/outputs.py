"""Outputs that are computed from a state: those of the package and of a user, checked, and their values."""

import math
from collections.abc import Iterable, MutableMapping
from dataclasses import fields, replace
from typing import Any

from fingerpad.results import quantities
from fingerpad.results.quantities import FINGER, SLICES, SUMS, TABLES, Output
from fingerpad.scene.messages import SceneError, show
from variational.state import ContactState, StepRecord

_OF_FINGER = {*FINGER, *SLICES, "centre", "carried", "slices", "trace"}


def checked(outputs: Any) -> tuple[Output, ...]:
    """Return outputs of the package and of a user.

    Args:
        outputs: of the user.

    Raises:
        SceneError: one is no output, or has a name that a state has.
    """
    given = list(outputs) if isinstance(outputs, Iterable) else [outputs]
    if isinstance(outputs, Output) or not all(isinstance(each, Output) for each in given):
        raise SceneError(f"outputs is {show(outputs)}; it must be a list of fingerpad.Output")
    names = {f.name for each in (ContactState, StepRecord) for f in fields(each)} | set(dir(ContactState))
    every = tuple(dict.fromkeys((*quantities.OUTPUTS, *given)))
    for each in every:
        if not (isinstance(each.name, str) and each.name.isidentifier()) or each.name in names:
            raise SceneError(f"an output is called {show(each.name)}; it must have a name of its own, such as 'p_mean'")
        if not isinstance(each.unit, str) or not callable(each.compute):
            raise SceneError(f"the output {each.name} must have a unit, such as 'kPa', and a function of a state")
        if each.sum not in ("", "slices"):
            raise SceneError(f"the output {each.name} has sum = {show(each.sum)}; it must be 'slices', or left out")
        if not TABLES >= each.tables:
            unknown = show(sorted(each.tables - TABLES)[0])
            raise SceneError(f"the output {each.name} has the table {unknown}; tables are {', '.join(sorted(TABLES))}")
        if each.sum and each.si not in SUMS:
            units = f"the unit {show(each.unit)}; it must be one per metre of finger: {', '.join(SUMS)}"
            raise SceneError(f"the output {each.name} has sum = 'slices' and {units}")
        if each.sum and each.name in _OF_FINGER:
            raise SceneError(f"an output is called {show(each.name)}, as a quantity of the whole finger; rename it")
        names.add(each.name)
    return every


def valued(
    state: ContactState, outputs: Iterable[Output], lost: MutableMapping[str, str] | None = None
) -> ContactState:
    """Return a state with the values of outputs.

    Args:
        state: the state.
        outputs: what is computed from it.
        lost: takes by name why an output has no value, which is NaN then; without it that is an error. A state
            between those of a trace keeps the value that was interpolated.

    Raises:
        SceneError: an output cannot be computed.
    """

    def value(each: Output) -> float:
        try:
            return each.of(state)
        except SceneError as error:
            if each.sum and each.name in state.own:
                return state.own[each.name]
            if lost is None:
                raise
            lost.setdefault(each.name, str(error))
            return math.nan

    return replace(state, own={**state.own, **{each.name: value(each) for each in outputs if each.compute}})
