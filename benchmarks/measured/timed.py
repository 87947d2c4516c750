"""Findings on time whose numbers are those of docs/viscosity.json (make viscosity): skin with the viscous preset."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from benchmarks import viscosity
from benchmarks.measured import rules
from benchmarks.measured.rules import HIT, RATIO, by_factor, by_form, by_share

Row = tuple[dict[str, float], str]


def _relaxation(known: Mapping[str, Any]) -> Row:
    """Judge the three times of the force at a held depth."""
    times = known["held"]["times"]
    factors = [found / measured for found, measured in zip(times, viscosity.TIMES, strict=True)]
    numbers = {f"time_{k}": 1e3 * time for k, time in enumerate(times)}
    return numbers, by_factor(min(factors), max(factors), 1.0, 1.0, RATIO)


def _speed(known: Mapping[str, Any]) -> Row:
    """Judge that friction follows a voltage with a delay, at first order, and sooner at the higher speed."""
    delays, fitted = [], []
    for speed in viscosity.SPEEDS:
        found = known["steps"][f"fingerpad at {1e3 * speed:g} mm/s"]
        time, rise = np.array(found["time"]), np.array(found["rise"])
        delays.append(float(np.interp(1 - np.exp(-1), np.maximum.accumulate(rise), time)))
        early = time <= 3 * found["way"] / speed
        fits = [rules.of_largest(form, time[early][1:], rise[early][1:]) for form in (rules.first_order, rules.ramp)]
        fitted.append([fit.misfit for fit in fits])
    misfits, others = zip(*fitted, strict=True)
    holds = [min(delays) > 0, delays[1] < delays[0], by_form(misfits, others) == HIT]
    names = {"slow": 1e3 * delays[0], "fast": 1e3 * delays[1], "misfit": max(misfits), "ramp": max(others)}
    return names, by_share(sum(holds) / len(holds))


ROWS: dict[str, Callable[[Mapping[str, Any]], Row]] = {"relaxation": _relaxation, "speed": _speed}
"""Computations of findings by name."""
