"""Figs. 2 and 6 to 8: friction, contact length and air gaps over force and voltage."""

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
    is no air gap without voltage. ``moved`` counts the ridges that come or leave in sliding.
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
    found["moved"] = np.array([[_moved(runs[f, u]) for u in voltages] for f in forces])
    return found | {"gaps_range": np.array([every.min(), every.max()])}


def mu_app(run: Run) -> float:
    """Return the apparent friction coefficient at full slip."""
    return float(run.steps["mu_app"][run.full_slip])


def _ridges(run: Run) -> list[set[float]]:
    return [set(run.on_ridges(getattr(run, state), "p_c")[0]) for state in STATES]


def _moved(run: Run) -> float:
    before, after = _ridges(run)
    return float(len(before ^ after))


def _gaps(run: Run) -> Array:
    return np.concatenate([run.on_ridges(getattr(run, state), "d_eq")[1] for state in STATES])


def within(d_eq: Array) -> NDArray[np.bool_]:
    """Return which air gaps (m) are in the paper's range."""
    return (d_eq > _GAPS[0]) & (d_eq < _GAPS[1])


def paths(runs: Mapping[tuple[float, float], Run]) -> dict[str, float]:
    """Return what happens on the paths to full slip at ``TRANSITION``, by voltage.

    ``rise``: largest rise of the contact length in a step, over that before sliding; ``left``: ridges of the trailing
    half that leave the contact; ``new``: ridges of the leading half that come.
    """
    found = {}
    for (force, voltage), run in runs.items():
        if force == TRANSITION:
            lengths = run.steps["contact_length"][run.charged : run.full_slip + 1]
            before, after = _ridges(run)
            found[f"rise_{voltage:g}"] = float(np.diff(lengths).max(initial=0) / lengths[0])
            found[f"left_{voltage:g}"] = float(sum(ridge < 0 for ridge in before - after))
            found[f"new_{voltage:g}"] = float(sum(ridge > 0 for ridge in after - before))
    return found


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
    charged = grid["voltage"] > 0
    shares = grid["gaps_within"].sum(axis=0)[charged] / grid["gaps"].sum(axis=0)[charged]
    words = {"voltages": ", ".join(f"{u:g}" for u in grid["voltage"][charged])}
    words["shares"] = ", ".join(f"{100 * each:.0f}" for each in shares)
    return statement("gaps", numbers, most.all(), most.mean() >= HALF, **words)


def _friction(grid: Grid, limit: Limit) -> list[Statement]:
    f = grid["f_ext"]
    ends = {"least": f[0], "most": f[-1]}
    gain, little = _gain(grid, "full_slip_f_t", _HIGH), _gain(grid, "full_slip_f_t", _LOW)
    coarse = float(grid["full_slip_f_t"][_row(grid, MAP), _column(grid, _HIGH)] / MAP)
    off = abs(limit.value / 0.55 - 1)
    mu_app = {"mu_app": limit.value, "bar": limit.bar, "coarse": coarse}
    doubled, few, falls = gain > 2, little < 1.05, np.diff(gain) < 0
    rise = {"up_to": f[doubled].max(initial=0)} | _range(gain - 1)
    small = {"up_to": f[~few].max(initial=0)} | _range(little - 1)
    quarter = (little - 1) / 4 < 0.05  # at half of that voltage, as U²
    return [
        statement("mu_app", mu_app, off < 0.05, off < 0.2, off=limit.value / 0.55 - 1, near=coarse / 0.55 - 1),
        statement("raise", _range(gain, "least", "largest"), doubled.all(), doubled.mean() >= HALF, **rise),
        statement("little", {"largest": little.max()}, few.all(), quarter.all(), **small),
        statement("small forces", {"first": gain[0], "last": gain[-1]}, falls.all(), gain[0] > gain[-1], **ends),
        _pressure(grid),
        _raised(grid),
    ]


def _pressure(grid: Grid) -> Statement:
    """Judge contact force and mean pressure at full slip under the loads of Fig. 2, over those at 0 V: 5 % count."""
    row, voltage = _row(grid, SECTION[0]), SECTION[1]
    force, length = (float(_gain(grid, f"full_slip_{name}", voltage)[row]) for name in ("f_t", "contact_length"))
    numbers = {"force": force - 1, "mean": force / length - 1}
    return statement("pressure", numbers, numbers["mean"] > 0.05, at=SECTION[0], voltage=voltage)


def _raised(grid: Grid) -> Statement:
    """Judge the contact length and the largest tangential force at Fig. 8A's load, at every voltage."""
    row, of = _row(grid, TRANSITION), ("charged_contact_length", "full_slip_contact_length", "full_slip_f_t")
    rises = {name: grid[name][row] / grid[name][row, 0] - 1 for name in of}
    numbers = {name: rise[-1] for name, rise in rises.items()}
    return statement("raised", numbers, all((rise[1:] > 0).all() for rise in rises.values()), at=TRANSITION)


def _lengths(grid: Grid) -> list[Statement]:
    gains = {state: _gain(grid, f"{state}_contact_length", _HIGH) for state in STATES}
    both = np.concatenate(list(gains.values()))
    within = (both > 1.2) & (both <= 1.4)
    counts = {"under": (both <= 1.2).sum(), "over": (both > 1.4).sum(), "within": within.sum(), "of": both.size}
    ranges = _range(gains["charged"] - 1, "normal_low", "normal_high") | _range(gains["full_slip"] - 1)
    of_friction = (gains["full_slip"] - 1) / (_gain(grid, "full_slip_f_t", _HIGH) - 1)
    ridges = {state: grid[f"{state}_ridges_in_contact"] for state in STATES}
    average = {state: grid[f"{state}_contact_length"] / ridges[state] for state in STATES}
    low, high = _column(grid, 0.0), _column(grid, _HIGH)
    new = np.concatenate([n[:, high] > n[:, low] for n in ridges.values()])
    longer = np.concatenate([length[:, high] > length[:, low] for length in average.values()])
    gone = sum(int((n[:, high] < n[:, low]).sum()) for n in ridges.values())
    sources = {"new": new.sum(), "longer": longer.sum(), "both": (new & longer).sum(), "of": new.size, "gone": gone}
    lost = (ridges["charged"] - ridges["full_slip"])[:, [low, high]]
    change = (average["full_slip"] / average["charged"] - 1)[:, [low, high]]
    same, one_or_two, moved = abs(change) < 0.05, (lost == 1) | (lost == 2), grid["moved"][:, [low, high]] > 0
    pairs = [f"{grid['f_ext'][k]:g} N/m and {(0.0, _HIGH)[n]:g} V" for k, n in np.argwhere(~same & ~moved)]
    over = {"over": (~same).sum(), "of": same.size, "moving": (~same & moved).sum(), "still": ", ".join(pairs)}
    fewer = _range(lost, "least", "largest") | {"some": one_or_two.sum(), "of": one_or_two.size}
    return [
        statement("less", _range(of_friction), (of_friction < 0.5).all() and (both > 1.05).all(), both.max() > 1.05),
        statement("longer", counts, within.all(), within.mean() >= HALF, **ranges),
        statement("new", sources, sources["both"] == new.size, longer.all()),
        statement("average", _range(change, "least", "largest"), same.all(), same.mean() >= HALF, **over),
        statement("fewer", fewer, one_or_two.all(), one_or_two.mean() >= HALF, more=max(0.0, -lost.min())),
    ]


def _reductions(grid: Grid, paths: Mapping[str, float]) -> list[Statement]:
    found = reduction(grid)
    fit, per_kpa = {"slope": found.slope, "r_squared": found.r_squared}, 1e3 * found.slope
    by_voltage = (found.stress * found.lost).sum(axis=0) / (found.stress**2).sum(axis=0)
    words = {"per_kpa": per_kpa, "runs": found.lost.size, "first": 1e3 * by_voltage[0], "last": 1e3 * by_voltage[-1]}
    return [
        _falls(grid, found.lost),
        statement("linear", fit, found.r_squared > 0.9, found.r_squared > HALF, **words),
        _wavy(paths),
        _area(grid, found.lost),
        _uncharged(grid, found.lost[:, _column(grid, 0.0)]),
    ]


def _falls(grid: Grid, lost: Array) -> Statement:
    """Judge the loss of all runs: up to 12 % and no contact that grows; in part where most lose contact."""
    row, column = np.unravel_index(np.argmax(lost), lost.shape)
    second, most = np.sort(lost, axis=None)[-2:]
    plain, grown = lost[:, _column(grid, 0.0)].max(), (lost < 0).sum()
    loss = {"most": most, "second": second, "grown": grown, "of": lost.size, "plain": plain}
    ridges = (grid[f"{state}_ridges_in_contact"][row, column] for state in STATES)
    words = {"force": grid["f_ext"][row], "voltage": grid["voltage"][column], "fewer": -np.diff(list(ridges))[0]}
    whole = abs(most - 0.12) < 0.02 and grown == 0
    return statement("falls", loss, whole, (lost > 0).mean() >= HALF, **words)


def _uncharged(grid: Grid, lost: Array) -> Statement:
    """Judge the loss without voltage at Fig. 8A's load: considerable is more than 5 %."""
    more, there = lost > 0.05, float(lost[_row(grid, TRANSITION)])
    numbers = {"there": there, "least": lost.min(), "most": lost.max(), "more": more.sum(), "of": more.size}
    return statement("uncharged", numbers, there > 0.05, more.mean() >= HALF, at=TRANSITION)


def _wavy(paths: Mapping[str, float]) -> Statement:
    """Judge at each voltage waves, rises of more than 1 %, and their cause, a ridge that leaves and one that comes."""
    voltages = [name.removeprefix("rise_") for name in paths if name.startswith("rise_")]
    rise, left, new = ([paths[f"{kind}_{u}"] for u in voltages] for kind in ("rise", "left", "new"))
    waves = [high > 0.01 and go > 0 and come > 0 for high, go, come in zip(rise, left, new, strict=True)]
    cause = all(go > 0 and come > 0 for go, come in zip(left, new, strict=True))
    words = {"voltages": ", ".join(voltages), "rise": ", ".join(f"{100 * high:.2f}" for high in rise)}
    words |= {kind: ", ".join(f"{n:g}" for n in counts) for kind, counts in (("left", left), ("new", new))}
    words["flat"] = ", ".join(u for u, high in zip(voltages, rise, strict=True) if high <= 0.01)
    return statement("wavy", paths, all(waves), np.mean(waves) >= HALF or cause, **words)


def _area(grid: Grid, lost: Array) -> Statement:
    """Judge what the voltage adds to the loss, in points and as a ratio; there is none where 0 V loses nothing."""
    f, (plain, charged) = grid["f_ext"], (lost[:, _column(grid, u)] for u in (0.0, _HIGH))
    more, ratio, small = charged - plain, charged / np.where(plain > 0, plain, np.nan), f < np.median(f)
    numbers = dict[str, float]()
    for name, mine in (("small", small), ("large", ~small)):
        numbers |= _range(more[mine], f"{name}_low", f"{name}_high")
        numbers |= {f"{name}_least": np.fmin.reduce(ratio[mine]), f"{name}_most": np.fmax.reduce(ratio[mine])}
    words = {"first": f[0], "up_to": f[small].max(), "above": f[~small].min(), "last": f[-1]}
    words |= {"outlier": f[np.argmax(more)], "grown": ", ".join(f"{force:g}" for force in f[plain <= 0])}
    times = numbers["small_least"] > numbers["large_most"]
    points, average = numbers["small_low"] > numbers["large_high"], more[small].mean() > more[~small].mean()
    enhanced = (more > 0).all()
    return statement("area", numbers, enhanced and times and points, enhanced and (times or average), **words)
