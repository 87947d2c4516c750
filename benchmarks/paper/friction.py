"""Figs. 2 and 6 to 8: friction, contact length and air gaps over force and voltage."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.limits import Limit
from benchmarks.paper.scenes import MAP, TRANSITION
from benchmarks.paper.statement import Statement, statement
from benchmarks.runs import Run
from fingerpad.io import style

Array = NDArray[np.float64]
Grid = Mapping[str, Array]
"""``f_ext`` (N/m), shape (forces,); ``voltage`` (V), shape (voltages,); ``gaps_range`` (m), the least and the largest
air gap of all runs with a voltage, shape (2,); the others have shape (forces, voltages)."""
COLUMNS = ("f_t", "contact_length", "ridges_in_contact")
STATES = ("normal", "slip")
_HIGH, _LOW = 200.0, 50.0  # V
_GAPS = (1.7e-6, 3e-6)  # m, the paper's range


def gather(runs: Mapping[tuple[float, float], Run]) -> dict[str, Array]:
    """Return the grid of all runs by force and voltage, before sliding (``normal_…``) and at full slip (``slip_…``).

    ``gaps`` counts the ridges in contact in both states, and ``gaps_within`` those with the paper's air gaps; there
    is no air gap without voltage.
    """
    forces, voltages = (np.array(sorted(set(values))) for values in zip(*runs, strict=True))
    found = {"f_ext": forces, "voltage": voltages}
    for state in STATES:
        for name in COLUMNS:
            values = [[run.steps[name][getattr(run, state)] for u in voltages for run in [runs[f, u]]] for f in forces]
            found[f"{state}_{name}"] = np.array(values, dtype=float)
    gaps = [[_gaps(runs[f, u]) if u > 0 else np.empty(0) for u in voltages] for f in forces]
    every = np.concatenate([d_eq for row in gaps for d_eq in row])
    found["gaps"] = np.array([[float(len(d_eq)) for d_eq in row] for row in gaps])
    found["gaps_within"] = np.array([[float(within(d_eq).sum()) for d_eq in row] for row in gaps])
    return found | {"gaps_range": np.array([every.min(), every.max()])}


def _gaps(run: Run) -> Array:
    return np.concatenate([run.on_ridges(getattr(run, state), "d_eq")[1] for state in STATES])


def within(d_eq: Array) -> NDArray[np.bool_]:
    """Return which air gaps (m) are in the paper's range."""
    return (d_eq > _GAPS[0]) & (d_eq < _GAPS[1])


def paths(runs: Mapping[tuple[float, float], Run]) -> dict[str, float]:
    """Return what happens on the paths to full slip at ``TRANSITION``, by voltage.

    ``rises``: steps in which the contact length rises; ``left``: ridges of the trailing half that leave the contact;
    ``new``: ridges of the leading half that come.
    """
    found = {}
    for (force, voltage), run in runs.items():
        if force == TRANSITION:
            lengths = run.steps["contact_length"][run.normal : run.slip + 1]
            before, after = (set(run.on_ridges(row, "p_c")[0]) for row in (run.normal, run.slip))
            found[f"rises_{voltage:g}"] = float((np.diff(lengths) > 0).sum())
            found[f"left_{voltage:g}"] = float(sum(ridge < 0 for ridge in before - after))
            found[f"new_{voltage:g}"] = float(sum(ridge > 0 for ridge in after - before))
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
def statements(grid: Grid, paths: Mapping[str, float], mu_app: Limit) -> list[Statement]:
    """Return the statements.

    Args:
        grid: as gathered.
        paths: on the way to full slip at ``TRANSITION``, by :func:`paths`.
        mu_app: limit of fine meshes at ``MAP`` and 200 V.
    """
    return [_air_gaps(grid), *_friction(grid, mu_app), *_lengths(grid), *_reductions(grid, paths)]


def _column(grid: Grid, voltage: float) -> int:
    return int(np.flatnonzero(grid["voltage"] == voltage)[0])


def _row(grid: Grid, force: float) -> int:
    return int(np.flatnonzero(grid["f_ext"] == force)[0])


def _gain(grid: Grid, name: str, voltage: float) -> Array:
    """Return a quantity at a voltage over that without, by force."""
    return grid[name][:, _column(grid, voltage)] / grid[name][:, _column(grid, 0.0)]


def _range(values: Array, low: str = "low", high: str = "high") -> dict[str, float]:
    return {low: values.min(), high: values.max()}


def _air_gaps(grid: Grid) -> Statement:
    """Judge all loads with a voltage: *mostly* is at more than half of their ridges."""
    loads = grid["gaps"] > 0
    most = grid["gaps_within"][loads] / grid["gaps"][loads] > 0.5
    share = grid["gaps_within"].sum() / grid["gaps"].sum()
    low, high = grid["gaps_range"]
    numbers = {"share": share, "least": low, "largest": high, "mostly": most.sum(), "loads": most.size}
    forces = grid["f_ext"][:, None] + 0 * grid["gaps"]
    return statement("gaps", numbers, share > 0.5, most.any(), up_to=forces[loads][most].max(initial=0))


def _friction(grid: Grid, limit: Limit) -> list[Statement]:
    f = grid["f_ext"]
    ends = {"least": f[0], "most": f[-1]}
    gain, little = _gain(grid, "slip_f_t", _HIGH), _gain(grid, "slip_f_t", _LOW)
    coarse = float(grid["slip_f_t"][_row(grid, MAP), _column(grid, _HIGH)] / MAP)
    off = abs(limit.value / 0.55 - 1)
    mu_app = {"mu_app": limit.value, "bar": limit.bar, "coarse": coarse}
    doubled, few, falls = gain > 2, little < 1.05, np.diff(gain) < 0
    rise = {"up_to": f[doubled].max(initial=0)} | _range(gain - 1)
    return [
        statement("mu_app", mu_app, off < 0.05, off < 0.2, off=limit.value / 0.55 - 1, near=coarse / 0.55 - 1),
        statement("raise", _range(gain, "least", "largest"), doubled.all(), doubled.any(), **rise),
        statement("little", {"largest": little.max()}, few.all(), few.any(), **_range(little - 1)),
        statement("small forces", {"first": gain[0], "last": gain[-1]}, falls.all(), gain[0] > gain[-1], **ends),
    ]


def _lengths(grid: Grid) -> list[Statement]:
    gains = {state: _gain(grid, f"{state}_contact_length", _HIGH) for state in STATES}
    both = np.concatenate(list(gains.values()))
    counts = {"normal": (gains["normal"] > 1.2).sum(), "slip": (gains["slip"] > 1.2).sum(), "of": len(gains["slip"])}
    ranges = _range(gains["normal"] - 1, "normal_low", "normal_high") | _range(gains["slip"] - 1)
    of_friction = (gains["slip"] - 1) / (_gain(grid, "slip_f_t", _HIGH) - 1)
    ridges = {state: grid[f"{state}_ridges_in_contact"] for state in STATES}
    average = {state: grid[f"{state}_contact_length"] / ridges[state] for state in STATES}
    low, high = _column(grid, 0.0), _column(grid, _HIGH)
    new = np.concatenate([n[:, high] > n[:, low] for n in ridges.values()])
    longer = np.concatenate([length[:, high] > length[:, low] for length in average.values()])
    sources = {"new": new.sum(), "longer": longer.sum(), "both": (new & longer).sum(), "of": new.size}
    lost = (ridges["normal"] - ridges["slip"])[:, [low, high]]
    change = (average["slip"] / average["normal"] - 1)[:, [low, high]]
    same, one_or_two = abs(change) < 0.05, (lost == 1) | (lost == 2)
    return [
        statement("less", _range(of_friction), (of_friction < 0.5).all() and (both > 1.05).all(), both.max() > 1.05),
        statement("longer", counts, (both > 1.2).all(), (both > 1.2).any(), **ranges),
        statement("new", sources, sources["both"] == new.size, sources["both"] > 0),
        statement("average", _range(change, "least", "largest"), same.all(), same.mean() > 0.5),
        statement("fewer", _range(lost, "least", "largest"), one_or_two.all(), one_or_two.mean() > 0.5),
    ]


def _reductions(grid: Grid, paths: Mapping[str, float]) -> list[Statement]:
    found, f = reduction(grid), grid["f_ext"]
    most, grown, r_squared = float(found.lost.max()), int((found.lost < 0).sum()), found.r_squared
    near, runs = abs(most - 0.12) < 0.02, found.lost.size
    fit, per_kpa = {"slope": found.slope, "r_squared": r_squared}, 1e3 * found.slope
    plain, charged = (found.lost[:, _column(grid, u)] for u in (0.0, _HIGH))
    loss = {"most": most, "grown": grown, "of": runs, "plain": plain.max()}
    more, small = charged - plain, f < np.median(f)
    area = _range(more[small], "small_low", "small_high") | _range(more[~small], "large_low", "large_high")
    words = {"up_to": f[small].max(), "least_small": f[0], "least_large": f[~small].min(), "most": f[-1]}
    kinds = {kind: [n for name, n in paths.items() if name.startswith(kind)] for kind in ("rises", "left", "new")}
    steps = {kind: ", ".join(f"{n:g}" for n in numbers) for kind, numbers in kinds.items()}
    voltages = ", ".join(name.removeprefix("rises_") for name in paths if name.startswith("rises_"))
    enhanced, larger = (more > 0).all(), more[small].mean() > more[~small].mean()
    return [
        statement("falls", loss, near and not grown, near),
        statement("linear", fit, r_squared > 0.9, r_squared > 0.5, per_kpa=per_kpa, runs=runs),
        statement("wavy", paths, all(map(all, kinds.values())), any(kinds["rises"]), voltages=voltages, **steps),
        statement("area", area, enhanced and more[small].min() > more[~small].max(), enhanced and larger, **words),
    ]
