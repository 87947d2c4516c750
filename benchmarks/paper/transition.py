"""Fig. 8A: contact length over the tangential force, from normal contact to full slip."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper import scenes
from benchmarks.runs import computed
from fingerpad.results.pictures import style


def numbers(out: Path, jobs: int) -> dict[str, Any]:
    """Return tangential force (N/m) and contact length (m) of the accepted steps to full slip, by voltage (V)."""
    wanted = {voltage: scene for (force, voltage), scene in scenes.grid().items() if force == scenes.TRANSITION}
    paths = []
    for voltage, run in computed(wanted, out, jobs).items():
        rows = slice(run.charged, run.full_slip + 1)
        columns = {name: run.steps[name][rows].tolist() for name in ("f_t", "contact_length")}
        paths.append({"voltage": voltage} | columns)
    return {"f_ext": scenes.TRANSITION, "paths": paths}


def paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    """Draw the paths; a circle is full slip."""
    ax = figure.subplots()
    for path in numbers["paths"]:
        colour, f_t = style.voltage(path["voltage"]), np.array(path["f_t"])
        length = 1e3 * np.array(path["contact_length"])
        ax.plot(f_t, length, color=colour, marker=".", ms=4, label=f"{path['voltage']:g} V")
        ax.plot(f_t[-1:], length[-1:], "o", color=colour, ms=8, mfc="none")
    ax.set(xlabel="tangential force $f_T$ (N/m)", ylabel="contact length $L_R$ (mm)")
    ax.set_title(f"A  From stick to slip, {numbers['f_ext']:g} N/m; circles: full slip")
    ax.legend(title="voltage")
