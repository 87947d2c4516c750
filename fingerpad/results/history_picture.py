"""Pictures of a history: friction and contact over the bone's displacement, and over time."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingerpad.results import style
from fingerpad.results.states import called
from variational.state import ContactState

Array = NDArray[np.float64]
_MM, _MS = 1e3, 1e3
_SHORT = 1.0  # s, below which the axis of time is in ms
_RUBS = 1e-6  # of mu_0: a coefficient below is roundoff


def history(
    path: Path | str | None,
    rows: Sequence[Mapping[str, Any]],
    title: str,
    mu_0: float | None = None,
    named: Mapping[str, ContactState] | None = None,
) -> Figure:
    """Draw friction force, contact length and the number of ridges in contact over the bone's displacement.

    Args:
        path: of the PNG file; None for the figure alone.
        rows: accepted steps in order, with ``bone_x`` (m), ``f_t`` and ``f_ext`` (N/m), ``mu_app``,
            ``contact_length`` (m), ``ridges_in_contact`` and, true where ridges jumped, ``jump``. What precedes
            sliding is left out but for its last row.
        title: what run it is, see :mod:`fingerpad.results.style`.
        mu_0: friction coefficient, drawn as the limit without attraction.
        named: states by name; those with an estimated discretisation error are drawn with error bars.
    """
    rows = _sliding(rows)

    def column(name: str) -> Array:
        return np.array([row[name] for row in rows], dtype=float)

    x, f_t = _MM * column("bone_x"), column("f_t")
    jumps = x[[bool(row.get("jump", False)) for row in rows]]
    with style.look():
        figure = style.figure(7.5)
        figure.suptitle(title)
        force, length, ridges = figure.subplots(3, 1, sharex=True, height_ratios=[2, 2, 1])
        force.plot(x, f_t, "o-", ms=3.5, color=style.BLACK, label="friction force $f_T$")
        force.set_ylabel("friction force $f_T$ (N/m)")
        _draw_apparent(force, x, column("f_ext"), column("mu_app"), mu_0)
        length.plot(x, _MM * column("contact_length"), "o-", ms=3.5, color=style.BLACK, label="contact length $L_R$")
        length.set_ylabel("contact length $L_R$ (mm)")
        _draw_errors(force, named or {}, "f_t", 1.0)
        _draw_errors(length, named or {}, "contact_length", _MM)
        ridges.step(x, column("ridges_in_contact"), where="post", color=style.BLACK)
        ridges.set_ylabel("ridges in\ncontact (number)")
        ridges.margins(y=0.15)
        style.count(ridges.yaxis)
        ridges.set_xlabel("sideways displacement of the bone (mm)")
        for ax in (force, length, ridges):
            for k, jump in enumerate(jumps):
                label = "part of the skin jumps" if k == 0 and ax is force else None
                ax.axvline(jump, color="0.4", lw=1, ls=":", zorder=0, label=label)
        for ax in (force, length):
            ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, borderaxespad=0.2)
        return style.save(figure, path)


def _draw_errors(ax: Axes, named: Mapping[str, ContactState], quantity: str, unit: float) -> None:
    """Draw the named states whose error is known, with error bars, in the colours of the states."""
    for name, state in named.items():
        error = getattr(state.error, quantity)
        if np.isfinite(error) and np.isfinite(state.bone_x) and not (quantity == "f_t" and name != "full_slip"):
            ax.errorbar(
                _MM * state.bone_x, unit * getattr(state, quantity), unit * error, fmt="D", ms=6, capsize=5,
                color=style.STATE[name], label=f"{called(name, state.voltage)} ± discretisation error", zorder=4,
            )  # fmt: skip


def _sliding(rows: Sequence[Mapping[str, Any]]) -> Sequence[Mapping[str, Any]]:
    """Return the rows from the last one before the bone first moves sideways."""
    for k in range(1, len(rows)):
        if rows[k]["bone_x"] != rows[0]["bone_x"]:
            return rows[k - 1 :]
    return rows[-1:]


def _draw_apparent(ax: Axes, x: Array, f_ext: Array, mu_app: Array, mu_0: float | None) -> None:
    """Add mu_app on the right, a second scale of the same curve where f_ext is constant, else a curve of its own."""
    label = "apparent friction\n$\\mu_{app} = f_T / f_{ext}$ (–)"
    load, other = float(f_ext[0]), ax
    if load > 0 and np.allclose(f_ext, load, rtol=1e-6, atol=0):
        there_and_back: Any = (lambda force: force / load, lambda mu: mu * load)
        ax.secondary_yaxis("right", functions=there_and_back).set_ylabel(label)
    else:
        load, other = 1.0, ax.twinx()
        other.plot(x, mu_app, "s--", ms=3, color=style.GREEN)
        other.set_ylabel(label, color=style.GREEN)
    if mu_0 is not None:
        words = f"$\\mu_{{app}} = \\mu_0$ = {mu_0:.3g}: without attraction"
        ax.plot([], [], color="0.4", lw=1, ls="--", label=words)
        for sign in np.unique(np.sign(mu_app[np.abs(mu_app) > _RUBS * mu_0])) if mu_0 else ():
            other.axhline(sign * mu_0 * load, color="0.4", lw=1, ls="--")


def over_time(path: Path | str | None, states: Sequence[ContactState], title: str) -> Figure:
    """Draw voltage, friction force and contact length over time.

    Args:
        path: of the PNG file; None for the figure alone.
        states: accepted states in order, with their times.
        title: what run it is, see :mod:`fingerpad.results.style`.
    """
    time = np.array([state.time for state in states])
    short = time[-1] - time[0] < _SHORT
    t = (_MS if short else 1.0) * time
    rows = (
        ("voltage $U$ (V)", [state.voltage for state in states], style.VERMILION),
        ("friction force\n$f_T$ (N/m)", [state.f_t for state in states], style.BLACK),
        ("contact length\n$L_R$ (mm)", [_MM * state.contact_length for state in states], style.BLUE),
    )
    jumps = t[[state.record is not None and state.record.jump for state in states]]
    with style.look():
        figure = style.figure(7.5)
        figure.suptitle(title)
        axes = figure.subplots(3, 1, sharex=True)
        for ax, (label, values, colour) in zip(axes, rows, strict=True):
            ax.plot(t, values, "o-", ms=3, color=colour)
            ax.set_ylabel(label)
            for jump in jumps:
                ax.axvline(jump, color="0.4", lw=1, ls=":", zorder=0)
        words = "; dotted lines: part of the skin jumps" if len(jumps) else ""
        axes[-1].set_xlabel(f"time ({'ms' if short else 's'}){words}")
        return style.save(figure, path)
