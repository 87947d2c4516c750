"""Fig. 2: pressure, elastic stress, shear and air gaps along the skin, in three states."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper import scenes
from benchmarks.runs import computed
from fingerpad.results.pictures import style

_STATES = {"charged": "A  Normal contact", "partial": "B  Partial slip", "full_slip": "C  Full slip"}
_ALONG = ("x", "p", "p_el", "t", "d_eq")


def numbers(out: Path, jobs: int) -> dict[str, Any]:
    """Return place (m), pressure, attraction, shear (Pa) and air gap (m) of the touching ridges; NaN between ridges.

    ``scale`` is the paper's f_ext / L_R (Pa), of each state.
    """
    run = computed({"section": scenes.grid()[scenes.SECTION]}, out, jobs)["section"]
    skin = run.arrays("surface")
    found: dict[str, Any] = {"f_ext": scenes.SECTION[0], "voltage": scenes.SECTION[1], "states": {}}
    for state in _STATES:
        under = np.nan_to_num(skin[f"{state}_p"]) > 0
        near = under | np.r_[under[1:], False] | np.r_[False, under[:-1]]  # with a point on either side
        columns = {name: skin[f"{state}_{name}"][near] for name in _ALONG}
        ends = np.flatnonzero(np.diff(skin[f"{state}_ridge"][near])) + 1
        parted = {name: np.insert(values, ends, np.nan) for name, values in columns.items()}
        found["states"][state] = {name: [float(f"{v:.6g}") for v in values] for name, values in parted.items()}
    found["scale"] = float(run.steps["f_ext"][run.charged] / run.steps["contact_length"][run.charged])
    return found


def paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    """Draw the stresses over f_ext / L_R, and the air gaps on a scale of their own."""
    axes = figure.subplots(len(_STATES), 1, sharex=True, sharey=True)
    for ax, (state, title) in zip(axes, _STATES.items(), strict=True):
        x, p, p_el, t, d_eq = (np.array(numbers["states"][state][name], dtype=float) for name in _ALONG)
        touches, other = np.where(p > 0, 1.0, np.nan), ax.twinx()
        x, scale = 1e3 * x, numbers["scale"]
        ax.plot(x, p / scale, color=style.BLACK, lw=1.2, label="contact pressure p")
        elastic = touches * (p - p_el) / scale
        ax.plot(x, elastic, color=style.BLUE, lw=1.2, ls="--", label=r"elastic stress p − $\sigma_{el}$")
        ax.plot(x, touches * t / scale, color=style.VERMILION, lw=1.2, label="shear")
        other.plot(x, 1e6 * touches * d_eq, color=style.GREEN, lw=2.5, label="air gap (right)")
        ax.axhline(0, color=style.GREY, lw=0.6)
        other.set(ylabel="air gap $d_{eq}$ (µm)", ylim=(0, 4))
        ax.set(ylabel="stress over $f_{ext}/L_R$ (–)", title=title)
    handles = [*axes[0].get_legend_handles_labels()[0], *other.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="outside upper center", ncols=4)
    axes[-1].set_xlabel(f"x (mm); {numbers['f_ext']:g} N/m, {numbers['voltage']:g} V; sliding to the right")
