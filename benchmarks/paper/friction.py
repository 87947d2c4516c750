"""Figs. 6, 7 and 8: friction and contact length over force and voltage."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.paper.scenes import MAP, TRANSITION
from benchmarks.paper.statement import Statement, statement
from benchmarks.runs import Run
from fingerpad.io import style

Array = NDArray[np.float64]
Grid = Mapping[str, Array]
"""``f_ext`` (N/m), shape (forces,); ``voltage`` (V), shape (voltages,); the others have shape (forces, voltages)."""
COLUMNS = ("f_t", "contact_length", "ridges_in_contact")
_HIGH, _LOW = 200.0, 50.0  # V


def gather(runs: Mapping[tuple[float, float], Run]) -> dict[str, Array]:
    """Return the grid of all runs by force and voltage, before sliding (``normal_…``) and at full slip (``slip_…``)."""
    forces, voltages = (np.array(sorted(set(values))) for values in zip(*runs, strict=True))
    found = {"f_ext": forces, "voltage": voltages}
    for state in ("normal", "slip"):
        for name in COLUMNS:
            values = [[run.steps[name][getattr(run, state)] for u in voltages for run in [runs[f, u]]] for f in forces]
            found[f"{state}_{name}"] = np.array(values, dtype=float)
    return found


def rises(runs: Mapping[tuple[float, float], Run]) -> dict[str, float]:
    """Return by voltage in how many steps of the path to full slip at ``TRANSITION`` the contact length rises."""
    found = {}
    for (force, voltage), run in runs.items():
        if force == TRANSITION:
            lengths = run.steps["contact_length"][run.normal : run.slip + 1]
            found[f"{voltage:g}"] = float((np.diff(lengths) > 0).sum())
    return found


@dataclass(frozen=True)
class Reduction:
    """Share of contact length lost by sliding over the mean shear stress f_T / L_R, with a fit through the origin."""

    stress: Array  # Pa, shape (forces, voltages)
    lost: Array  # likewise
    slope: float  # 1/Pa
    r_squared: float


def reduction(grid: Grid) -> Reduction:
    """Fit the reduction of contact length over the mean shear stress."""
    stress = grid["slip_f_t"] / grid["slip_contact_length"]
    lost = 1 - grid["slip_contact_length"] / grid["normal_contact_length"]
    x, y = stress.ravel(), lost.ravel()
    slope = float(x @ y / (x @ x))
    left = float(((y - slope * x) ** 2).sum() / ((y - y.mean()) ** 2).sum())
    return Reduction(stress, lost, slope, 1 - left)


def paint(figure: Figure, grid: Grid) -> None:
    """Draw apparent friction over force, and the reduction of contact length over the mean shear stress."""
    left, right = figure.subplots(1, 2)
    found = reduction(grid)
    for k, voltage in enumerate(grid["voltage"]):
        look = {"color": style.voltage(voltage), "marker": "o", "ms": 4}
        left.plot(grid["f_ext"], grid["slip_f_t"][:, k] / grid["f_ext"], label=f"{voltage:g} V", **look)
        right.plot(found.stress[:, k] / 1e3, 100 * found.lost[:, k], ls="none", **look)
    x = np.array([0, found.stress.max()])
    fit = f"fit through the origin, R² = {found.r_squared:.2f}"
    right.plot(x / 1e3, 100 * found.slope * x, color=style.GREY, lw=2, zorder=0, label=fit)
    left.set(xlabel="external force $f_{ext}$ (N/m)", ylabel="apparent friction coefficient µ_app (–)", ylim=(0, None))
    left.set_title("A  Friction at full slip")
    right.set(xlabel="mean shear stress $f_T / L_R$ (kPa)", ylabel="contact length lost by sliding (%)")
    right.set_title("B  Loss of contact, all forces")
    left.legend()
    right.legend()


# -- statements ----------------------------------------------------------------------------------------
def statements(grid: Grid, rises: Mapping[str, float]) -> list[Statement]:
    """Return the statements; ``rises``: steps at ``TRANSITION`` in which contact length rises, by voltage (V)."""
    return [*_friction(grid), *_lengths(grid), *_reductions(grid, rises)]


def _column(grid: Grid, voltage: float) -> int:
    return int(np.flatnonzero(grid["voltage"] == voltage)[0])


def _row(grid: Grid, force: float) -> int:
    return int(np.flatnonzero(grid["f_ext"] == force)[0])


def _gain(grid: Grid, name: str, voltage: float) -> Array:
    """Return a quantity at a voltage over that without, by force."""
    return grid[name][:, _column(grid, voltage)] / grid[name][:, _column(grid, 0.0)]


def _range(values: Array, low: str = "low", high: str = "high") -> dict[str, float]:
    return {low: values.min(), high: values.max()}


def _friction(grid: Grid) -> list[Statement]:
    f = grid["f_ext"]
    ends = {"least": f[0], "most": f[-1]}
    gain, little = _gain(grid, "slip_f_t", _HIGH), _gain(grid, "slip_f_t", _LOW)
    mu_app = float(grid["slip_f_t"][_row(grid, MAP), _column(grid, _HIGH)] / MAP)
    off = abs(mu_app / 0.55 - 1)
    doubled, few, falls = gain > 2, little < 1.05, np.diff(gain) < 0
    rise = {"up_to": f[doubled].max(initial=0)} | _range(gain - 1)
    return [
        statement("mu_app", {"mu_app": mu_app}, off < 0.05, off < 0.2),
        statement("raise", _range(gain, "least", "largest"), doubled.all(), doubled.any(), **rise),
        statement("little", {"largest": little.max()}, few.all(), few.any(), **_range(little - 1)),
        statement("small forces", {"first": gain[0], "last": gain[-1]}, falls.all(), gain[0] > gain[-1], **ends),
    ]


def _lengths(grid: Grid) -> list[Statement]:
    normal, sliding = (_gain(grid, f"{state}_contact_length", _HIGH) for state in ("normal", "slip"))
    both, longest = np.concatenate([normal, sliding]), {"normal": normal.max(), "sliding": sliding.max()}
    ranges = _range(normal - 1, "normal_low", "normal_high") | _range(sliding - 1)
    columns = [_column(grid, u) for u in (0.0, _HIGH)]
    counts = {state: grid[f"{state}_ridges_in_contact"][:, columns] for state in ("normal", "slip")}
    means = {state: grid[f"{state}_contact_length"][:, columns] / counts[state] for state in counts}
    lost, change = counts["normal"] - counts["slip"], means["slip"] / means["normal"] - 1
    same, one_or_two = abs(change) < 0.05, (lost == 1) | (lost == 2)
    return [
        statement("longer", longest, both.max() > 1.2 and (both > 1).all(), both.max() > 1.2, **ranges),
        statement("average", _range(change, "least", "largest"), same.all(), same.mean() > 0.5),
        statement("fewer", _range(lost, "least", "largest"), one_or_two.all(), one_or_two.mean() > 0.5),
    ]


def _reductions(grid: Grid, rises: Mapping[str, float]) -> list[Statement]:
    found, f = reduction(grid), grid["f_ext"]
    ends = {"least": f[0], "most": f[-1]}
    most, r_squared = float(found.lost[_row(grid, TRANSITION)].max()), found.r_squared
    fit = {"slope": found.slope, "r_squared": r_squared}
    loss = found.lost[:, [_column(grid, u) for u in (0.0, _HIGH)]].mean(axis=1)
    waves = {f"rises_{u}": n for u, n in rises.items()}
    steps = ", ".join(f"{n:g} steps at {u} V" for u, n in rises.items())
    per_kpa, runs, falls = 1e3 * found.slope, found.stress.size, np.diff(loss) < 0
    return [
        statement("falls", {"at_120": most, "grid": found.lost.max()}, abs(most - 0.12) < 0.02, 0.06 < most < 0.18),
        statement("linear", fit, r_squared > 0.9, r_squared > 0.5, per_kpa=per_kpa, runs=runs),
        statement("wavy", waves, all(rises.values()), any(rises.values()), steps=steps),
        statement("area", {"first": loss[0], "last": loss[-1]}, falls.all(), loss[0] > loss[-1], **ends),
    ]
