"""Figs. 6, 7 and 8: friction and contact length over force, voltage and tangential load."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper.scenes import MAP, TRANSITION, WIDTH
from benchmarks.paper.statement import Statement, verdict
from benchmarks.paper.style import VOLTAGE
from benchmarks.runs import Array, Run
from benchmarks.traces import FORCES, VOLTAGES

Grid = Mapping[tuple[float, float], Run]
_MM = 1e-3
_HIGH, _LOW = 200.0, 50.0  # V


@dataclass(frozen=True)
class Measured:
    """Somebody's friction: forces (N) of a finger ``WIDTH`` wide."""

    label: str
    force: Array
    voltage: Array
    friction: Array

    @classmethod
    def read(cls, path: Path) -> "Measured":
        """Read a CSV file with the columns ``force_N``, ``voltage_V`` and ``friction_N``.

        Raises:
            ValueError: a column is missing or holds no number.
        """
        try:
            table = np.genfromtxt(path, delimiter=",", names=True, dtype=float, encoding="utf-8")
            columns = [np.atleast_1d(table[name]) for name in ("force_N", "voltage_V", "friction_N")]
        except (ValueError, TypeError, IndexError) as error:
            raise ValueError(f"{path} must have the columns force_N, voltage_V and friction_N: {error}") from None
        if not all(np.isfinite(c).all() for c in columns):
            raise ValueError(f"{path} has a row without a number in force_N, voltage_V or friction_N")
        return cls(path.stem, *columns)


def _curve(grid: Grid, voltage: float, name: str, state: str) -> tuple[Array, Array]:
    """Return forces and a column of the steps in a state, ``normal`` or ``slip``, for the runs there are."""
    runs = [(f, grid[f, voltage]) for f in FORCES if (f, voltage) in grid]
    values = [run.steps[name][getattr(run, state)] for _, run in runs]
    return np.array([f for f, _ in runs]), np.array(values)


def figure_6(figure: Figure, grid: Grid, measured: Measured | None = None) -> None:
    """Tangential force and apparent friction at full slip over external force."""
    left, right = figure.subplots(1, 2)
    for voltage in VOLTAGES:
        colour, marker, dashes = VOLTAGE[voltage]
        f, f_t = _curve(grid, voltage, "f_t", "slip")
        look = {"color": colour, "marker": marker, "ls": dashes, "ms": 4}
        left.plot(f * WIDTH, f_t * WIDTH, label=f"{voltage:g} V", **look)
        right.plot(f * WIDTH, f_t / f, **look)
    if measured is not None:
        for voltage in np.unique(measured.voltage):
            mine = measured.voltage == voltage
            force, friction = measured.force[mine], measured.friction[mine]
            colour = VOLTAGE.get(float(voltage), ("#CC79A7", "", ""))[0]
            label = f"{measured.label}, {voltage:g} V"
            left.plot(force, friction, "*", ms=9, color=colour, mec="black", mew=0.5, label=label)
            right.plot(force, friction / force, "*", ms=9, color=colour, mec="black", mew=0.5)
    left.set(xlabel="external force $F_{ext}$ (N)", ylabel="tangential force $F_T$ (N)", title="A")
    right.set(xlabel="external force $F_{ext}$ (N)", ylabel="apparent friction µ_app (–)", title="B", ylim=(0, None))
    left.legend(title=f"full slip, {WIDTH * 1e3:g} mm wide")


def figure_7(figure: Figure, grid: Grid) -> None:
    """Contact length, ridges and average ridge contact length, normal and sliding, without and with voltage."""
    axes = figure.subplots(1, 3)
    for voltage in (0.0, _HIGH):
        colour = VOLTAGE[voltage][0]
        for state, dashes, marker, words in (("normal", "-", "o", "normal"), ("slip", "--", "v", "sliding")):
            f, length = _curve(grid, voltage, "contact_length", state)
            _, count = _curve(grid, voltage, "ridges_in_contact", state)
            look = {"color": colour, "ls": dashes, "marker": marker, "ms": 4, "label": f"{voltage:g} V, {words}"}
            for ax, values in zip(axes, (length / _MM, count, length / count * 1e6), strict=True):
                ax.plot(f, values, **look)
    names = ("A  contact length $L_R$ (mm)", "B  ridges in contact", "C  average ridge contact length (µm)")
    for ax, name in zip(axes, names, strict=True):
        ax.set(xlabel="external force $f_{ext}$ (N/m)", title=name)
    axes[0].legend()


def _path(run: Run) -> tuple[Array, Array]:
    """Return f_T and contact length from normal contact to full slip."""
    rows = slice(run.normal, run.slip + 1)
    return run.steps["f_t"][rows], run.steps["contact_length"][rows]


@dataclass(frozen=True)
class Reduction:
    """Reduction of contact length over mean shear stress at full slip, all runs, and its fit through the origin."""

    stress: Array
    reduction: Array
    voltage: Array
    slope: float
    """(1/Pa)"""
    r_squared: float


def reduction(grid: Grid) -> Reduction:
    """Fit the reduction of contact length by sliding, at one force and voltage each, over f_T / L_R."""
    stress, lost, voltages = [], [], []
    for (_, voltage), run in grid.items():
        f_t, length = _path(run)
        stress.append(f_t[-1] / length[-1])
        lost.append(1 - length[-1] / length[0])
        voltages.append(voltage)
    x, y = np.array(stress), np.array(lost)
    slope = float(x @ y / (x @ x))
    left = float(((y - slope * x) ** 2).sum() / ((y - y.mean()) ** 2).sum()) if len(y) > 1 else np.nan
    return Reduction(x, y, np.array(voltages), slope, 1 - left)


def figure_8(figure: Figure, grid: Grid) -> None:
    """Contact length from stick to slip, and its reduction over the mean shear stress."""
    left, right = figure.subplots(1, 2)
    for voltage in VOLTAGES:
        if (TRANSITION, voltage) not in grid:
            continue
        colour, marker, dashes = VOLTAGE[voltage]
        f_t, length = _path(grid[TRANSITION, voltage])
        left.plot(f_t, length / _MM, color=colour, ls=dashes, marker=marker, ms=3, label=f"{voltage:g} V")
        right.plot(f_t / length * 1e-3, 100 * (1 - length / length[0]), color=colour, ls=dashes, lw=0.8, alpha=0.7)
    found = reduction(grid)
    for voltage in VOLTAGES:
        mine = found.voltage == voltage
        colour, marker, _ = VOLTAGE[voltage]
        right.plot(found.stress[mine] * 1e-3, 100 * found.reduction[mine], marker, color=colour, ms=5, ls="none")
    x = np.array([0, found.stress.max()])
    right.plot(x * 1e-3, 100 * found.slope * x, color="0.4", lw=2, label=f"fit of all, R² = {found.r_squared:.2f}")
    left.set(xlabel="tangential force $f_T$ (N/m)", ylabel="contact length $L_R$ (mm)", title=f"A  {TRANSITION:g} N/m")
    right.set(
        xlabel="mean shear stress $f_T / L_R$ (kPa)",
        ylabel="reduction of contact length (%)",
        title=f"B  markers: full slip, all forces; lines: {TRANSITION:g} N/m",
    )
    left.legend()
    right.legend()


# -- statements ----------------------------------------------------------------------------------------
def _ratio(grid: Grid, name: str, state: str, high: float = _HIGH) -> tuple[Array, Array]:
    """Return forces, and what a voltage makes of a column relative to none."""
    f, with_voltage = _curve(grid, high, name, state)
    g, without = _curve(grid, 0.0, name, state)
    common = [k for k, force in enumerate(f) if force in g]
    return f[common], np.array([with_voltage[k] / without[list(g).index(f[k])] for k in common])


def _range(values: Array, unit: str = "", digits: int = 3) -> str:
    return f"{values.min():.{digits}g} to {values.max():.{digits}g}{unit}"


def _friction(grid: Grid) -> list[Statement]:
    f, gain = _ratio(grid, "f_t", "slip")
    _, little = _ratio(grid, "f_t", "slip", _LOW)
    mu_app = float(grid[MAP, _HIGH].steps["mu_app"][grid[MAP, _HIGH].slip])
    doubled = f[gain > 2]
    return [
        Statement(
            "6",
            "µ_app ≈ 0.55 at f_ext = 75 N/m with electroadhesion",
            f"{mu_app:.4f} at 200 V",
            {"mu_app": mu_app},
            verdict(abs(mu_app / 0.55 - 1) < 0.05, abs(mu_app / 0.55 - 1) < 0.2),
            "its figure gives no number to compare with at other forces",
        ),
        Statement(
            "6",
            "high voltage raises F_T and µ_app by more than 100 %",
            f"at 200 V by {_range(100 * (gain - 1), ' %')}; more than 100 % up to {doubled.max(initial=0):g} N/m",
            {"least": float(gain.min()), "largest": float(gain.max())},
            verdict(bool((gain > 2).all()), bool((gain > 2).any())),
            "the larger the force, the less the attraction adds",
        ),
        Statement(
            "6",
            "below 50 V hardly any effect",
            f"at 50 V F_T rises by {_range(100 * (little - 1), ' %', 2)}",
            {"largest": float(little.max())},
            verdict(bool((little < 1.05).all()), bool((little < 1.05).any())),
            "at the smallest forces more than 5 %",
        ),
        Statement(
            "6",
            "the effect is largest at small forces",
            f"F_T(200 V) / F_T(0 V) is {gain[0]:.3g} at {f[0]:g} N/m and {gain[-1]:.3g} at {f[-1]:g} N/m",
            {"first": float(gain[0]), "last": float(gain[-1])},
            verdict(bool((np.diff(gain) < 0).all()), bool(gain[0] > gain[-1])),
            "not monotonic",
        ),
    ]


def _lengths(grid: Grid) -> list[Statement]:
    normal, sliding = (_ratio(grid, "contact_length", state)[1] for state in ("normal", "slip"))
    both = np.concatenate([normal, sliding])
    fewer, average = [], []
    for voltage in (0.0, _HIGH):
        counts, means = [], []
        for state in ("normal", "slip"):
            _, count = _curve(grid, voltage, "ridges_in_contact", state)
            _, length = _curve(grid, voltage, "contact_length", state)
            counts.append(count)
            means.append(length / count)
        fewer += list(counts[0] - counts[1])
        average += list(means[1] / means[0] - 1)
    lost, change = np.array(fewer), np.array(average)
    return [
        Statement(
            "7",
            "ridge contact length up to more than 20 % larger at 200 V",
            f"normal by {_range(100 * (normal - 1), ' %')}, sliding by {_range(100 * (sliding - 1), ' %')}",
            {"normal": float(normal.max()), "sliding": float(sliding.max())},
            verdict(bool(both.max() > 1.2 and (both > 1).all()), bool(both.max() > 1.2)),
            "but not at every force",
        ),
        Statement(
            "7",
            "the average ridge contact length is almost the same, normal or sliding",
            f"in sliding it changes by {_range(100 * change, ' %', 2)}",
            {"least": float(change.min()), "largest": float(change.max())},
            verdict(bool((abs(change) < 0.05).all()), bool((abs(change) < 0.05).mean() > 0.5)),
            "where a ridge more or less is in contact its short length moves the average",
        ),
        Statement(
            "7",
            "one or two ridges fewer in contact in sliding",
            f"{lost.min():g} to {lost.max():g} fewer",
            {"least": float(lost.min()), "largest": float(lost.max())},
            verdict(bool(((lost == 1) | (lost == 2)).all()), bool(((lost == 1) | (lost == 2)).mean() > 0.5)),
            "not at every force and voltage",
        ),
    ]


def _reductions(grid: Grid) -> list[Statement]:
    found = reduction(grid)
    paths = {u: _path(grid[TRANSITION, u]) for u in VOLTAGES if (TRANSITION, u) in grid}
    at_full = {u: float(1 - length[-1] / length[0]) for u, (_, length) in paths.items()}
    most = max(at_full.values())
    wavy = {u: int((np.diff(length) > 0).sum()) for u, (_, length) in paths.items()}
    by_force = np.array([[1 - r[1][-1] / r[1][0] for u in (0.0, _HIGH) for r in (_path(grid[f, u]),)] for f in FORCES])
    loss = by_force.mean(axis=1)
    return [
        Statement(
            "8",
            "contact length falls with tangential load by up to 12 %",
            f"by up to {100 * most:.3g} % at {TRANSITION:g} N/m, {100 * found.reduction.max():.3g} % over the grid",
            {"at_120": most, "grid": float(found.reduction.max())},
            verdict(abs(most - 0.12) < 0.02, 0.06 < most < 0.18),
            "as the linear fit's slope, it depends on the ridges that leave",
        ),
        Statement(
            "8",
            "the reduction is about linear in f_T / L_R, whatever voltage and force",
            f"slope {1e5 * found.slope:.3g} % per kPa, R² = {found.r_squared:.2f} over {len(found.stress)} runs",
            {"slope": found.slope, "r_squared": found.r_squared},
            verdict(found.r_squared > 0.9, found.r_squared > 0.5),
            "ridges that come and go scatter it",
        ),
        Statement(
            "8",
            "the curves are wavy, because ridges come and go",
            f"contact length rises in between in {', '.join(f'{n} steps at {u:g} V' for u, n in wavy.items())}",
            {f"rises_{u:g}": float(n) for u, n in wavy.items()},
            verdict(all(wavy.values()), any(wavy.values())),
            "not at every voltage",
        ),
        Statement(
            "8",
            "the area lost is larger, in per cent, at small loads",
            f"{100 * loss[0]:.3g} % at {FORCES[0]:g} N/m, {100 * loss[-1]:.3g} % at {FORCES[-1]:g} N/m "
            "(mean of 0 and 200 V)",
            {"first": float(loss[0]), "last": float(loss[-1])},
            verdict(bool((np.diff(loss) < 0).all()), bool(loss[0] > loss[-1])),
            "it follows the mean shear stress, which is smaller at small loads",
        ),
    ]


def statements(grid: Grid) -> list[Statement]:
    """Return the statements on friction and contact; the whole grid must be there."""
    return [*_friction(grid), *_lengths(grid), *_reductions(grid)]
