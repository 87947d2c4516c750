"""Figs. 4 and 5: the bearing area model of the roughness, a closed form."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper import scenes
from fingerpad.results.pictures import style
from fingerpad.scene import Scene
from variational.roughness.bam import BearingArea

_SEPARATIONS = np.linspace(0, 8e-6, 161)  # m
_PRESSURES = (-10.0, 60.0)  # kPa, drawn


def air_gap(out: Path, jobs: int) -> dict[str, Any]:
    """Return Fig. 4's air gap (m) over the mean separation (m), Eq. 13."""
    bam = BearingArea(Scene().h_0)
    gap = bam.air_gap(_SEPARATIONS)
    return {"u_bar": _SEPARATIONS.tolist(), "d_eq": gap.tolist(), "limit": float(bam.air_gap(0.0))}


def pressure(out: Path, jobs: int) -> dict[str, Any]:
    """Return Fig. 5's external pressure (Pa) over the air gap (m) by voltage, Eq. 9."""
    bam = BearingArea(Scene().h_0)
    p_ext = [bam.external_pressure(_SEPARATIONS, voltage).tolist() for voltage in scenes.VOLTAGES]
    numbers = {"d_eq": bam.air_gap(_SEPARATIONS).tolist(), "voltage": list(scenes.VOLTAGES), "p_ext": p_ext}
    return numbers | {"eq_9": bam.threshold(), "eq_15": bam.threshold(approximate=True)}


def paint_air_gap(figure: Figure, numbers: Mapping[str, Any]) -> None:
    """Draw Fig. 4."""
    ax = figure.subplots()
    ax.plot(1e6 * np.array(numbers["u_bar"]), 1e6 * np.array(numbers["d_eq"]), color=style.BLUE)
    limit = 1e6 * numbers["limit"]
    ax.axhline(limit, color=style.GREY, ls="--", label=f"at zero separation: {limit:.3f} µm")
    ax.set(xlabel="mean interfacial separation ū (µm)", ylabel="equivalent air gap $d_{eq}$ (µm)", ylim=(0, None))
    ax.legend()


def paint_pressure(figure: Figure, numbers: Mapping[str, Any]) -> None:
    """Draw Fig. 5."""
    ax = figure.subplots()
    for voltage, p_ext in zip(numbers["voltage"], numbers["p_ext"], strict=True):
        look: dict[str, Any] = {"color": style.voltage(voltage), "label": f"{voltage:g} V"}
        ax.plot(1e6 * np.array(numbers["d_eq"]), 1e-3 * np.array(p_ext), **look)
    ax.axhline(0, color=style.BLACK, lw=0.8)
    ax.set(xlabel="equivalent air gap $d_{eq}$ (µm)", ylabel="external pressure $p_{ext}$ (kPa)", ylim=_PRESSURES)
    ax.set_title(f"Tension from {numbers['eq_9']:.0f} V on, by Eq. 15 from {numbers['eq_15']:.0f} V", fontsize=10)
    ax.legend(title="voltage")
