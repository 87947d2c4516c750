"""The loads of a result as variables of a dataset."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fingerpad.io import columns
from fingerpad.io.columns import Column
from fingerpad.io.variables import Variables, array, described

if TYPE_CHECKING:
    from fingerpad.io.result import Result
    from fingerpad.io.states import LoadResult


def loads(result: "Result") -> Variables:
    """Return the results of the loads along ``load``."""
    names = array([load.name for load in result.loads])
    found: Variables = {"load": (("load",), names, described(columns.STEPS["load"]))}
    ends = [load.end.step for load in result.loads]
    found["load_last_step"] = ("load",), array(ends), described(Column("1", "last step of the load"))
    for name in ("full_slip_reached", "full_slip_held"):
        slip = Column("1", f"whether full slip was {name.rpartition('_')[2]} in the load")
        found[f"load_{name}"] = ("load",), array([getattr(load, name) for load in result.loads]), described(slip)
    for quantity in dict.fromkeys(name for load in result.loads for name in load.extremes):
        for end, words in (("min", "least"), ("max", "largest")):
            values = [getattr(load.extremes.get(quantity), end, math.nan) for load in result.loads]
            column = columns.STEPS[quantity]
            about = described(Column(column.unit, f"{words} value in the load: {column.meaning}"))
            found[f"load_{quantity}_{end}"] = ("load",), array(values), about
    return found | _over_time(result.loads)


def _over_time(loads: "Sequence[LoadResult]") -> Variables:
    """Return lengths, means and spectra of loads over time; NaN for the other loads, nothing where there are none."""
    passed = [load.over_time for load in loads]
    known = [each for each in passed if each is not None]
    if not known:
        return {}
    found: Variables = {}
    for name, words in (("start", "time at which the load begins"), ("seconds", "length of the load")):
        values = [math.nan if each is None else getattr(each, name) for each in passed]
        found[f"load_{name}"] = ("load",), array(values), described(Column("s", words))
    for quantity in known[0].mean:
        column = columns.STEPS[quantity]
        values = [math.nan if each is None else each.mean[quantity] for each in passed]
        about = described(Column(column.unit, f"mean over time in the load: {column.meaning}"))
        found[f"load_{quantity}_mean"] = ("load",), array(values), about
    harmonics = max(len(each.frequency) for each in known)
    if harmonics:
        number = Column("1", "multiple of the frequency of the waveform")
        found["harmonic"] = ("harmonic",), np.arange(1, harmonics + 1, dtype=np.int32), described(number)
        for name, column in columns.SPECTRUM.items():
            table = np.full((len(loads), harmonics), np.nan)
            for k, each in enumerate(passed):
                if each is not None and each.frequency:
                    table[k] = getattr(each, name)
            found[f"load_{name}"] = ("load", "harmonic"), table, described(column)
    return found
