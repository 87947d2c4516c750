"""Figs. 6 to 8B: friction and contact length over force and voltage."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from benchmarks.paper import scenes
from benchmarks.runs import computed, known
from fingerpad.results.pictures import style
from fingerpad.scene import Scene

Array = NDArray[np.float64]
Numbers = Mapping[str, Any]
"""``f_ext`` (N/m), shape (forces,), ``voltage`` (V), shape (voltages,), and names of a state and a column as
``full_slip_f_t``, in SI, shape (forces, voltages)."""
STATES = ("charged", "full_slip")
COLUMNS = ("f_t", "contact_length", "ridges_in_contact")
WIDTH = 0.020  # m, of the finger along its axis, with which the paper turns N/m into N
_STATES = {"charged": ("normal contact", "--", "o"), "full_slip": ("sliding", "-", "s")}


def friction(out: Path, jobs: int) -> dict[str, Any]:
    """Return Fig. 6's friction force: of paths where all of them are there, and else of states of full slip."""
    if all(known(scene, out) for scene in scenes.grid().values()):
        return over_loads(out, jobs)
    from fingerpad.runs.sweep import sweep

    scene = Scene(output={"errors": False, "receptors": False})
    found = sweep(scene, out / "full_slip", jobs=jobs, states="full_slip", f_ext=scenes.FORCES, voltage=scenes.VOLTAGES)
    forces = {(each.scene.f_ext, each.scene.volts): each.full_slip.f_t for each in found.results if each.full_slip}
    f_t = [[forces.get((f, u)) for u in scenes.VOLTAGES] for f in scenes.FORCES]
    return {"f_ext": scenes.FORCES, "voltage": scenes.VOLTAGES, "full_slip_f_t": f_t}


def lengths(out: Path, jobs: int) -> dict[str, Any]:
    """Return Fig. 7's contact lengths and ridges, without voltage and at the highest."""
    return over_loads(out, jobs, (min(scenes.VOLTAGES), max(scenes.VOLTAGES)))


def over_loads(out: Path, jobs: int, voltages: Iterable[float] = scenes.VOLTAGES) -> dict[str, Any]:
    """Return the columns before sliding and at full slip, of the paths to all forces at some voltages."""
    chosen = tuple(voltages)
    pairs = {pair: scene for pair, scene in scenes.grid().items() if pair[1] in chosen}
    runs = computed(pairs, out, jobs)
    found: dict[str, Any] = {"f_ext": scenes.FORCES, "voltage": chosen}
    for state in STATES:
        for name in COLUMNS:
            key = f"{state}_{name}"
            found[key] = [[float(runs[f, u].summary[key]) for u in chosen] for f in scenes.FORCES]
    return found


# -- pictures ------------------------------------------------------------------------------------------
def paint_friction(figure: Figure, numbers: Numbers) -> None:
    """Draw Fig. 6: friction force and apparent friction over the force."""
    left, right = figure.subplots(1, 2)
    f_ext, f_t = np.array(numbers["f_ext"]), np.array(numbers["full_slip_f_t"], dtype=float)
    for k, voltage in enumerate(numbers["voltage"]):
        look: dict[str, Any] = {"color": style.voltage(voltage), "marker": "o", "ms": 4, "label": f"{voltage:g} V"}
        left.plot(WIDTH * f_ext, WIDTH * f_t[:, k], **look)
        right.plot(WIDTH * f_ext, f_t[:, k] / f_ext, **look)
    force = f"external force $F_{{ext}}$ (N), for 20 mm; 1 N: {1 / WIDTH:g} N/m"
    left.set(xlabel=force, ylabel="friction force $F_T$ (N), for 20 mm", ylim=(0, None))
    right.set(xlabel=force, ylabel="apparent friction µ_app (–)", ylim=(0, None))
    left.set_title("A  Friction force at full slip")
    right.set_title("B  Apparent friction coefficient")
    right.legend(title="voltage")


def paint_lengths(figure: Figure, numbers: Numbers) -> None:
    """Draw Fig. 7: contact length, number of ridges and length of each, in normal contact and in sliding."""
    axes = figure.subplots(1, 3)
    f_ext, voltages = np.array(numbers["f_ext"]), list(numbers["voltage"])
    for voltage in (min(voltages), max(voltages)):
        k = voltages.index(voltage)
        for state, (words, line, marker) in _STATES.items():
            length, ridges = (np.array(numbers[f"{state}_{name}"], dtype=float)[:, k] for name in COLUMNS[1:])
            look = {"color": style.voltage(voltage), "ls": line, "marker": marker, "ms": 4}
            for ax, values in zip(axes, (1e3 * length, ridges, 1e6 * length / ridges), strict=True):
                ax.plot(f_ext, values, **look, label=f"{words}, {voltage:g} V")
    titles = ("A  All ridges", "B  Ridges in contact", "C  Average ridge")
    labels = ("contact length $L_R$ (mm)", "ridges in contact (–)", "contact length of a ridge (µm)")
    for ax, title, label in zip(axes, titles, labels, strict=True):
        ax.set(xlabel="external force $f_{ext}$ (N/m)", ylabel=label, ylim=(0, None), title=title)
    style.count(axes[1].yaxis)
    axes[1].legend(fontsize=8)


@dataclass(frozen=True)
class Reduction:
    """Share of contact length lost by sliding over the mean shear stress f_T / L_R, with a fit through the origin."""

    stress: Array  # Pa, shape (forces, voltages)
    lost: Array  # likewise
    slope: float  # 1/Pa
    r_squared: float


def reduction(numbers: Mapping[str, ArrayLike]) -> Reduction:
    """Fit the reduction of contact length over the mean shear stress."""
    f_t, after, before = (
        np.array(numbers[name], dtype=float)
        for name in ("full_slip_f_t", "full_slip_contact_length", "charged_contact_length")
    )
    stress, lost = f_t / after, 1 - after / before
    x, y = stress.ravel(), lost.ravel()
    slope = float(x @ y / (x @ x))
    left = float(((y - slope * x) ** 2).sum() / ((y - y.mean()) ** 2).sum())
    return Reduction(stress, lost, slope, 1 - left)


def paint_reduction(figure: Figure, numbers: Numbers) -> None:
    """Draw Fig. 8B: the reduction of contact length over the mean shear stress."""
    ax, found = figure.subplots(), reduction(numbers)
    for k, voltage in enumerate(numbers["voltage"]):
        look: dict[str, Any] = {"color": style.voltage(voltage), "marker": "o", "ms": 4, "label": f"{voltage:g} V"}
        ax.plot(found.stress[:, k] / 1e3, 100 * found.lost[:, k], ls="none", **look)
    x = np.array([0, found.stress.max()])
    words = f"fit through the origin,\nR² = {found.r_squared:.2f}"
    ax.plot(x / 1e3, 100 * found.slope * x, color=style.GREY, lw=2, zorder=0, label=words)
    ax.axhline(0, color=style.BLACK, lw=0.8)
    ax.set(xlabel="mean shear stress $f_T / L_R$ (kPa)", ylabel="contact length lost by sliding (%)")
    ax.set_title("B  Reduction of contact length")
    ax.legend()
