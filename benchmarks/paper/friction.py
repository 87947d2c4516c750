"""Figs. 2 and 6 to 8: printed numbers and trends of friction, contact length and air gaps over force and voltage."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from benchmarks.limits import Limit
from benchmarks.paper.loads import COLUMNS, STATES, reduction
from benchmarks.paper.scenes import MAP, SECTION, TRANSITION
from benchmarks.paper.statement import HALF, Statement, statement
from benchmarks.runs import Run

Array = NDArray[np.float64]
Grid = Mapping[str, Array]
"""``f_ext`` (N/m), shape (forces,); ``voltage`` (V), shape (voltages,); ``gaps_range`` (m), the least and the largest
air gap of all runs with a voltage, shape (2,); the others have shape (forces, voltages)."""
_HIGH, _LOW = 200.0, 50.0  # V
_GAPS = (1.7e-6, 3e-6)  # m, the paper's range


def gather(runs: Mapping[tuple[float, float], Run]) -> dict[str, Array]:
    """Return the grid of all runs by force and voltage, before sliding (``charged_…``) and at ``full_slip_…``.

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


def mu_app(run: Run) -> float:
    """Return the apparent friction coefficient at full slip."""
    return float(run.steps["mu_app"][run.full_slip])


def _gaps(run: Run) -> Array:
    return np.concatenate([run.on_ridges(getattr(run, state), "d_eq")[1] for state in STATES])


def within(d_eq: Array) -> NDArray[np.bool_]:
    """Return which air gaps (m) are in the paper's range."""
    return (d_eq > _GAPS[0]) & (d_eq < _GAPS[1])


# -- statements ----------------------------------------------------------------------------------------
def statements(grid: Grid, mu_app: Limit) -> list[Statement]:
    """Return the statements.

    Args:
        grid: as gathered.
        mu_app: limit of fine meshes at ``MAP`` and 200 V.
    """
    return [_air_gaps(grid), *_friction(grid, mu_app), *_trends(grid), *_lengths(grid), _falls(grid), _linear(grid)]


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
    charged = grid["voltage"] > 0
    shares = grid["gaps_within"].sum(axis=0)[charged] / grid["gaps"].sum(axis=0)[charged]
    words = {"voltages": ", ".join(f"{u:g}" for u in grid["voltage"][charged])}
    words["shares"] = ", ".join(f"{100 * each:.0f}" for each in shares)
    return statement("gaps", numbers, most.all(), most.mean() >= HALF, **words)


def _friction(grid: Grid, limit: Limit) -> list[Statement]:
    f = grid["f_ext"]
    gain, little = _gain(grid, "full_slip_f_t", _HIGH), _gain(grid, "full_slip_f_t", _LOW)
    coarse = float(grid["full_slip_f_t"][_row(grid, MAP), _column(grid, _HIGH)] / MAP)
    off = abs(limit.value / 0.55 - 1)
    mu_app = {"mu_app": limit.value, "bar": limit.bar, "coarse": coarse}
    doubled, few = gain > 2, little < 1.05
    rise = {"up_to": f[doubled].max(initial=0)} | _range(gain - 1)
    small = {"up_to": f[~few].max(initial=0)} | _range(little - 1)
    quarter = (little - 1) / 4 < 0.05  # at half of that voltage, as U²
    return [
        statement("mu_app", mu_app, off < 0.05, off < 0.2, off=limit.value / 0.55 - 1, near=coarse / 0.55 - 1),
        statement("raise", _range(gain, "least", "largest"), doubled.all(), doubled.mean() >= HALF, **rise),
        statement("little", {"largest": little.max()}, few.all(), quarter.all(), **small),
    ]


def _trends(grid: Grid) -> list[Statement]:
    """Judge what the voltage raises, at all loads or at those of a figure: 5 % count."""
    f, gain = grid["f_ext"], _gain(grid, "full_slip_f_t", _HIGH)
    (row, voltage), names = (_row(grid, SECTION[0]), SECTION[1]), ("f_t", "contact_length")
    force, length = (float(_gain(grid, f"full_slip_{name}", voltage)[row]) for name in names)
    pressure = {"force": force - 1, "mean": force / length - 1}
    there, of = _row(grid, TRANSITION), ("charged_contact_length", "full_slip_contact_length", "full_slip_f_t")
    rises = {name: grid[name][there] / grid[name][there, 0] - 1 for name in of}
    raised = {name: rise[-1] for name, rise in rises.items()}
    longer = _gain(grid, "full_slip_contact_length", _HIGH)
    of_friction, every = (longer - 1) / (gain - 1), np.r_[longer, _gain(grid, "charged_contact_length", _HIGH)]
    lost = reduction(grid).lost[:, _column(grid, 0.0)]
    loss = {"there": lost[there], "more": (lost > 0.05).sum(), "of": lost.size} | _range(lost, "least", "most")
    falls, ends = np.diff(gain) < 0, {"least": f[0], "most": f[-1]}
    return [
        statement("pressure", pressure, pressure["mean"] > 0.05, at=SECTION[0], voltage=voltage),
        statement("raised", raised, all((rise[1:] > 0).all() for rise in rises.values()), at=TRANSITION),
        statement("small forces", {"first": gain[0], "last": gain[-1]}, falls.all(), gain[0] > gain[-1], **ends),
        statement("less", _range(of_friction), (of_friction < 0.5).all() and (every > 1.05).all(), every.max() > 1.05),
        statement("uncharged", loss, lost[there] > 0.05, (lost > 0.05).mean() >= HALF, at=TRANSITION),
    ]


def _lengths(grid: Grid) -> list[Statement]:
    gains = {state: _gain(grid, f"{state}_contact_length", _HIGH) for state in STATES}
    both = np.concatenate(list(gains.values()))
    within = (both > 1.2) & (both <= 1.4)
    counts = {"under": (both <= 1.2).sum(), "over": (both > 1.4).sum(), "within": within.sum(), "of": both.size}
    ranges = _range(gains["charged"] - 1, "normal_low", "normal_high") | _range(gains["full_slip"] - 1)
    before, after = (grid[f"{state}_ridges_in_contact"] for state in STATES)
    lost = (before - after)[:, [_column(grid, 0.0), _column(grid, _HIGH)]]
    one_or_two = (lost == 1) | (lost == 2)
    fewer = _range(lost, "least", "largest") | {"some": one_or_two.sum(), "of": one_or_two.size}
    return [
        statement("longer", counts, within.all(), within.mean() >= HALF, **ranges),
        statement("fewer", fewer, one_or_two.all(), one_or_two.mean() >= HALF, more=max(0.0, -lost.min())),
    ]


def _falls(grid: Grid) -> Statement:
    """Judge the loss of all runs: up to 12 % and no contact that grows; in part where most lose contact."""
    lost = reduction(grid).lost
    row, column = np.unravel_index(np.argmax(lost), lost.shape)
    second, most = np.sort(lost, axis=None)[-2:]
    plain, grown = lost[:, _column(grid, 0.0)].max(), (lost < 0).sum()
    loss = {"most": most, "second": second, "grown": grown, "of": lost.size, "plain": plain}
    ridges = (grid[f"{state}_ridges_in_contact"][row, column] for state in STATES)
    words = {"force": grid["f_ext"][row], "voltage": grid["voltage"][column], "fewer": -np.diff(list(ridges))[0]}
    whole = abs(most - 0.12) < 0.02 and grown == 0
    return statement("falls", loss, whole, (lost > 0).mean() >= HALF, **words)


def _linear(grid: Grid) -> Statement:
    found = reduction(grid)
    fit, per_kpa = {"slope": found.slope, "r_squared": found.r_squared}, 1e3 * found.slope
    by_voltage = (found.stress * found.lost).sum(axis=0) / (found.stress**2).sum(axis=0)
    words = {"per_kpa": per_kpa, "runs": found.lost.size, "first": 1e3 * by_voltage[0], "last": 1e3 * by_voltage[-1]}
    return statement("linear", fit, found.r_squared > 0.9, found.r_squared > HALF, **words)
