"""Findings over time, with keys that the default finger leaves out: the viscous preset "fingerpad" in all soft layers.

Force over time and friction after a step of the voltage are those of docs/viscosity.json. A press that is held for 20 s
is run here.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import viscosity
from benchmarks.measured import fingers, rules
from benchmarks.measured.rules import HIT, RATIO, by_factor, by_form, by_share
from benchmarks.runs import Run
from fingerpad.scene import Scene

Array = NDArray[np.float64]
Row = tuple[dict[str, float], str]
GROWS = 20.0  # s, for which the real contact on glass was seen to grow
GROWN = 0.95  # of the growth in that time


def scene() -> Scene:
    """Return a viscous finger that is pressed at once and held by its force."""
    press = {"name": "press", "f_ext": fingers.FORCE}
    layers = {name: {"viscosity": {"preset": "fingerpad"}} for name in viscosity.SOFT}
    history = [press, press | {"name": "hold", "duration": GROWS}]
    return fingers.pressed(fingers.SIZES[-1], {"materials": layers, "history": history})


def held(out: Path) -> dict[str, list[float]]:
    """Return contact length (m) over time (s) of the finger that is held, from its run in a folder."""
    steps = Run(scene(), out).steps
    last = int(np.flatnonzero(steps["load"] == "press")[-1])
    return {"time": list(steps["time"][last:]), "length": list(steps["contact_length"][last:])}


def _time(held: Mapping[str, list[float]]) -> Row:
    """Judge for how long the contact grows."""
    time, length = (np.array(held[name]) for name in ("time", "length"))
    grown = (length - length[0]) / (length[-1] - length[0])
    until = float(np.interp(GROWN, np.maximum.accumulate(grown), time))
    numbers = {"growth": float(length[-1] / length[0] - 1), "until": until, "seconds": float(time[-1])}
    return numbers, by_factor(until, until, GROWS, GROWS, RATIO)


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


def of_time(known: Mapping[str, Any], held: Mapping[str, list[float]]) -> dict[str, Row]:
    """Return the rows of time, which the default scene does not have.

    Args:
        known: numbers of docs/viscosity.json.
        held: what :func:`held` returns.
    """
    return {"time": _time(held), "relaxation": _relaxation(known), "speed": _speed(known)}
