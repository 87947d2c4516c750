"""Fig. 2: tractions along the skin in normal contact, partial and full slip, and the air gaps of the ridges."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper.statement import Statement, statement
from benchmarks.runs import Run
from fingerpad.io.style import ATTRACTION, GREY, PRESSURE, SHEAR

STATES = {"normal": "normal contact", "partial": "partial slip", "slip": "full slip"}


def _scale(run: Run, state: str) -> float:
    """Return f_ext / L_R (Pa), by which the paper normalises."""
    row = {"normal": run.normal, "slip": run.slip}.get(state)
    if row is None:  # the step that is nearest to half of the points slipping, as the run chooses it
        moved = np.flatnonzero(np.abs(run.steps["bone_x"]) >= 1e-12)
        row = int(moved[np.argmin(np.abs(run.steps["slipping"][moved] - 0.5))])
    return float(run.steps["f_ext"][row] / run.steps["contact_length"][row])


def gather(run: Run) -> dict[str, Any]:
    """Return what acts along the skin in contact, by state: x (m), tractions over f_ext / L_R, and that stress (Pa)."""
    arrays, found = run.arrays("surface"), dict[str, Any]()
    for state in STATES:
        a = {name: arrays[f"{state}_{name}"] for name in ("x", "p", "p_el", "t")}
        on = np.flatnonzero(np.nan_to_num(a["p"]) > 0)
        on = on[np.argsort(a["x"][on])]
        stress = _scale(run, state)
        found[state] = {"stress": stress, "x": a["x"][on].tolist()}
        found[state] |= {name: (a[name][on] / stress).round(5).tolist() for name in ("p", "p_el", "t")}
    return found


def paint(figure: Figure, section: Mapping[str, Any]) -> None:
    """Draw pressure, attraction and shear along the skin from normal contact to full slip."""
    axes = figure.subplots(len(STATES), 1, sharex=True, sharey=True)
    looks = {"p": ("contact pressure", PRESSURE), "p_el": ("attraction", ATTRACTION), "t": ("shear", SHEAR)}
    for ax, (state, title) in zip(axes, STATES.items(), strict=True):
        a = section[state]
        for name, (words, colour) in looks.items():
            ax.plot(1e3 * np.array(a["x"]), a[name], ".", ms=2, color=colour, label=words)
        ax.axhline(0, color=GREY, lw=0.8)
        ax.set_title(f"{title}, f_ext/L_R = {a['stress'] / 1e3:.3g} kPa", loc="left")
        ax.set_ylabel("over f_ext/L_R (–)")
    axes[-1].set_xlabel("x on the screen (mm)")
    axes[0].legend(ncols=3, markerscale=4)


def statements(run: Run) -> list[Statement]:
    """Return the statements on normal contact and its path to full slip."""
    a = run.arrays("surface")
    x, p, p_el, t = (a[f"normal_{name}"] for name in ("x", "p", "p_el", "t"))
    known = np.isfinite(p)
    x, p, p_el, t = x[known], p[known], p_el[known], t[known]
    tension = float((p - p_el).min() / _scale(run, "normal"))
    # Shear at -x against -shear at x, on the points in contact.
    order = np.argsort(x)
    mirrored = -np.interp(-x[order], x[order], t[order])
    uneven = float(np.linalg.norm(t[order] - mirrored) / np.linalg.norm(t))
    ridges, d_eq = run.on_ridges(run.normal, "d_eq")
    central, outer = d_eq[np.abs(ridges) <= 2].mean(), d_eq[np.argsort(np.abs(ridges))[-4:]].mean()
    both = np.concatenate([d_eq, run.on_ridges(run.slip, "d_eq")[1]])
    within = float(((both > 1.7e-6) & (both < 3e-6)).mean())
    gaps = {"share": within, "least": both.min(), "largest": both.max()}
    xs, ps, ts = (a[f"partial_{name}"] for name in ("x", "p", "t"))
    on = np.nan_to_num(ps) > 0
    slips = np.abs(ts[on]) >= run.scene.friction * ps[on] * (1 - 1e-6)
    middle = (xs[on].min() + xs[on].max()) / 2
    leading, trailing = (float(slips[side].mean()) for side in (xs[on] > middle, xs[on] < middle))
    halves = {"leading": leading, "trailing": trailing}
    return [
        statement("gaps", gaps, within > 0.9, within > 0.5),
        statement("central", {"central": central, "outer": outer}, central < outer),
        statement("tension", {"tension": tension}, tension < 0),
        statement("symmetric", {"even": uneven / 2}, uneven / 2 < 0.05, uneven / 2 < 0.2),
        statement("leading", halves, leading > 1.2 * trailing, leading > trailing),
    ]
