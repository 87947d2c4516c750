"""Pictures of curves: along the skin near the screen, over sliding, over time and over a period; and of spikes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingerpad.results.pictures import style
from fingerpad.results.quantities import STEPS
from fingerpad.results.states import called
from variational.state import ContactState

Array = NDArray[np.float64]
_MM, _MS, _UM, _KPA = 1e3, 1e3, 1e6, 1e-3
_GIVEN = ("voltage", "f_ext", "bone_x")
_FLAT = 1e-3  # of the largest amount: a change that is none
_SHORT = 1.0  # s, below which the axis of time is in ms
_RUBS = 1e-6  # of mu_0: a coefficient below is roundoff
_TOOTH_SPAN = 4  # points: the span of a saw tooth to either side
_NOTHING = 1e-9  # of the contact force: an external force below is roundoff
_LEAST_AMPLITUDE = 1e-3  # of the largest one, from which components are drawn
_COMPONENTS = 60  # at most
_COARSE = 0.1  # of the peak: deeper saw teeth are noted
_PANEL, _ROW, _DENSITIES = 0.6, 0.09, 1.8  # in: of a panel of spikes, of a unit in it, and of energy densities
_MARKED = 4  # ridges whose density has a colour
_NAMED = 0.06  # of the length of the run, from which a load has its name


@dataclass(frozen=True)
class SurfaceProfile:
    """The skin near the screen in one state; arrays along the arc, a NaN between ridges breaks the lines."""

    title: str
    state: ContactState
    x: Array
    """Current abscissa (m)."""
    y: Array
    """Current height above the screen (m)."""
    p: Array
    """Contact pressure (Pa of current area)."""
    t: Array
    """Shear traction on the skin (Pa of current area), positive towards x > 0."""
    p_el: Array
    """Electrostatic attraction (Pa of current area)."""
    d_eq: Array
    """Equivalent air gap of the ridge (m)."""
    ridge: Array
    """Number of the ridge, 0 at the centre."""
    note: str = ""
    """What else the panel's title says."""


def surface(
    path: Path | str | None,
    states: Sequence[SurfaceProfile],
    title: str,
    largest_gap: float = 6e-6,
) -> Figure:
    """Draw pressure, shear traction, attraction and gaps along the surface (Fig. 2 of Forsbach et al. 2023).

    Numbers above the pressure are those of the ridges in contact, 0 at the centre of the finger. A note says where the
    mesh is too coarse for the pressure: where its saw teeth exceed a tenth.

    Args:
        path: of the PNG file; None for the figure alone.
        states: one pair of panels each, such as normal contact, partial slip and full slip.
        title: what they have in common, see :mod:`fingerpad.results.pictures.style`.
        largest_gap: end of the gaps' axis (m).
    """
    with style.look():
        figure = style.figure(1 + 3.0 * len(states), title)
        axes = style.column(figure, [2, 1] * len(states))
        stresses, gaps = axes[::2], axes[1::2]
        bottom, top = _common_range(states)
        for letter, state, above, below in zip("ABCDEFGH", states, stresses, gaps, strict=False):
            above.set_ylim(bottom, top)
            _draw_stresses(above, state)
            above.set_title(_surface_title(letter, state), loc="left", fontsize=9.5)
            _draw_gaps(below, state, largest_gap)
        handles = [h for ax in (stresses[0], gaps[0]) for h in ax.get_legend_handles_labels()[0]]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
        gaps[-1].set_xlabel("x on the screen (mm)")
        touching = np.concatenate([s.x[s.p > 0] for s in states])
        if len(touching):
            gaps[-1].set_xlim(_MM * touching.min() - 0.5, _MM * touching.max() + 0.5)
        return style.save(figure, path)


def _saw_teeth(p: Array) -> float:
    """Return the depth of the deepest saw tooth of the contact pressure over its peak.

    A tooth is a dip of the pressure between two larger ones, both within :data:`_TOOTH_SPAN` points, where every point
    between is under pressure. Four points are a facet's: teeth of a coarse mesh go up and down within one facet or two.

    Args:
        p: contact pressure (Pa) along the arc, a NaN between ridges, shape (points,).
    """
    known = np.nan_to_num(p)
    parts = np.cumsum(known <= 0)  # a patch is all points of one part that are under pressure
    pressed = np.flatnonzero(known > 0)
    largest = []
    for way in (-1, 1):
        beside = (pressed[:, None] + way * np.arange(1, _TOOTH_SPAN + 1)).clip(0, len(p) - 1)
        same = (parts[beside] == parts[pressed][:, None]) & (known[beside] > 0)
        largest.append(np.where(same, known[beside], 0.0).max(axis=1, initial=0.0))
    deepest = float((np.minimum(*largest) - known[pressed]).max(initial=0.0))
    return deepest / float(known.max()) if deepest else 0.0


def _surface_title(letter: str, s: SurfaceProfile) -> str:
    words = f"{letter}  {style.plain(s.title)}: {style.conditions([s.state], place=True)}"
    words += f", L_R = {_MM * s.state.contact_length:.3g} mm"
    if _pressed(s):
        words += f", f_ext/L_R = {_KPA * s.state.f_ext / s.state.contact_length:.3g} kPa"
    teeth = _saw_teeth(s.p)
    coarse = (
        f"mesh too coarse for the pressure: saw teeth of {100 * teeth:.0f} % of its peak" if teeth > _COARSE else ""
    )
    notes = "; ".join(filter(None, (s.note, coarse)))
    return f"{words}\n     {notes}" if notes else words


def _pressed(s: SurfaceProfile) -> bool:
    """Return whether an external force presses the skin, beyond roundoff of what the skin bears."""
    length = s.state.contact_length
    return length > 0 and s.state.f_ext > _NOTHING * float(np.nanmax(s.p)) * length


def _common_range(states: Sequence[SurfaceProfile]) -> tuple[float, float]:
    values = _KPA * np.concatenate([array[np.isfinite(array)] for s in states for array in (s.p, s.t, s.p_el)])
    low, high = min(float(values.min(initial=0)), 0.0), max(float(values.max(initial=0)), 1e-9)
    return low - 0.06 * (high - low), high + 0.17 * (high - low)  # numbers of ridges above


def _draw_stresses(ax: Axes, s: SurfaceProfile) -> None:
    x = _MM * s.x
    ax.axhline(0, color="0.7", lw=0.8, zorder=0)
    ax.fill_between(x, 0, _KPA * s.p, color=style.PRESSURE, alpha=0.12, lw=0)
    ax.plot(x, _KPA * s.p, color=style.PRESSURE, lw=1.2, label="contact pressure p")
    ax.plot(x, _KPA * s.p_el, color=style.ATTRACTION, ls="--", label="attraction p_el")
    ax.plot(x, _KPA * s.t, color=style.SHEAR, label="shear traction t on the skin, positive to the right")
    ax.set_ylabel("stress (kPa)")
    for number in np.unique(s.ridge[s.p > 0]):
        where = x[(s.ridge == number) & (s.p > 0)].mean()
        ax.text(where, 0.97, f"{number:.0f}", transform=ax.get_xaxis_transform(), ha="center", va="top", fontsize=8)
    if _pressed(s):
        mean = _KPA * s.state.f_ext / s.state.contact_length
        style.second_scale(ax, mean, "stress / (f_ext/L_R) (–)")


def _draw_gaps(ax: Axes, s: SurfaceProfile, largest: float) -> None:
    ax.axhline(0, color="0.7", lw=0.8, zorder=0)
    ax.fill_between(_MM * s.x, np.minimum(_UM * s.y, 2 * _UM * largest), 2 * _UM * largest, color="0.85", lw=0)
    ax.plot(_MM * s.x, _UM * s.y, color="0.4", lw=1, label="height of the skin (grey) above the screen")
    ax.plot(_MM * s.x, _UM * s.d_eq, color=style.GAP, lw=2.2, label="equivalent air gap d_eq")
    ax.set_ylim(-0.08 * largest * _UM, largest * _UM)
    ax.set_ylabel("gap (µm)")


def _draw(ax: Axes, x: Array, states: Sequence[ContactState], key: str, colour: str = style.BLACK) -> None:
    """Draw a quantity of states, with its words, symbol and unit on the left."""
    of = STEPS[key]
    ax.plot(x, [of.scale * getattr(state, key) for state in states], "o-", ms=3.5, color=colour, label=of.words)
    ax.set_ylabel(f"{of.words.removesuffix(of.symbol)}\n{of.head}")


def history(
    path: Path | str | None,
    states: Sequence[ContactState],
    title: str,
    mu_0: float | None = None,
    named: Mapping[str, ContactState] | None = None,
) -> Figure:
    """Draw friction force, contact length and the number of ridges in contact over the bone's displacement.

    Args:
        path: of the PNG file; None for the figure alone.
        states: accepted states in order, from the last one before sliding on.
        title: what run it is, see :mod:`fingerpad.results.pictures.style`.
        mu_0: friction coefficient, drawn as the limit without attraction.
        named: states by name; those with a known error are drawn with error bars.
    """
    x = np.array([_MM * state.bone_x for state in states])
    with style.look():
        figure = style.figure(7.25, title)
        panels = style.column(figure, [8, 8, 5])
        force, length, ridges = panels
        for ax, key in ((force, "f_t"), (length, "contact_length")):
            _draw(ax, x, states, key)
            _draw_errors(ax, named or {}, key)
        _draw_apparent(force, x, states, mu_0)
        ridges.step(x, [state.ridges_in_contact for state in states], where="post", color=style.BLACK)
        ridges.set(ylabel="ridges in\ncontact (number)", xlabel="sideways displacement of the bone (mm)")
        ridges.margins(y=0.15)
        style.count(ridges.yaxis)
        _draw_jumps(panels, x, states)
        for ax in (force, length):
            ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, borderaxespad=0.2)
        return style.save(figure, path)


def _draw_jumps(axes: Sequence[Axes], at: Array, states: Sequence[ContactState]) -> bool:
    """Draw a dotted line at each jump; return whether there is one."""
    jumps = at[[state.record is not None and state.record.jump for state in states]]
    for k, ax in enumerate(axes):
        for j, jump in enumerate(jumps):
            label = "part of the skin jumps" if j == k == 0 else None
            ax.axvline(jump, color="0.4", lw=1, ls=":", zorder=0, label=label)
    return len(jumps) > 0


def _draw_errors(ax: Axes, named: Mapping[str, ContactState], key: str) -> None:
    """Draw the named states whose error is known, with error bars, in the colours of the states."""
    for name, state in named.items():
        error, scale = getattr(state.error, key), STEPS[key].scale
        if np.isfinite(error) and np.isfinite(state.bone_x) and not (key == "f_t" and name != "full_slip"):
            ax.errorbar(
                _MM * state.bone_x, scale * getattr(state, key), scale * error, fmt="D", ms=6, capsize=5,
                color=style.STATE[name], label=f"{called(name, state.voltage)} ± error", zorder=4,
            )  # fmt: skip


def _draw_apparent(ax: Axes, x: Array, states: Sequence[ContactState], mu_0: float | None) -> None:
    """Add mu_app on the right, a second scale of the same curve where f_ext is constant, else a curve of its own."""
    label, other = "apparent friction\nµ_app = f_T / f_ext (–)", ax
    f_ext, mu_app = (np.array([getattr(state, key) for state in states]) for key in ("f_ext", "mu_app"))
    load = float(f_ext[0])
    if load > 0 and np.allclose(f_ext, load, rtol=1e-6, atol=0):
        style.second_scale(ax, load, label)
    else:
        load, other = 1.0, ax.twinx()
        other.plot(x, mu_app, "s--", ms=3, color=style.GREEN)
        other.set_ylabel(label, color=style.GREEN)
    if mu_0 is not None:
        ax.plot([], [], color="0.4", lw=1, ls="--", label=f"µ_app = µ_0 = {mu_0:.3g}: without attraction")
        for sign in np.unique(np.sign(mu_app[np.abs(mu_app) > _RUBS * mu_0])) if mu_0 else ():
            other.axhline(sign * mu_0 * load, color="0.4", lw=1, ls="--")


# -- over time -------------------------------------------------------------------------------------------------
def over_time(path: Path | str | None, states: Sequence[ContactState], title: str) -> Figure:
    """Draw voltage, force or place, whichever changes first, friction force and contact length over time.

    Args:
        path: of the PNG file; None for the figure alone.
        states: accepted states in order, with their times.
        title: what run it is, see :mod:`fingerpad.results.pictures.style`.
    """
    time = np.array([state.time for state in states])
    short = time[-1] - time[0] < _SHORT
    t = (_MS if short else 1.0) * time
    later = np.array([[getattr(s, key) for key in _GIVEN] for s in states if s.time > time[0]] or np.zeros((1, 3)))
    changes = np.ptp(later, axis=0) > _FLAT * np.abs(later).max(axis=0)
    keys = _GIVEN[int(changes.argmax())], "f_t", "contact_length"
    with style.look():
        figure = style.figure(7.25, title)
        axes = style.column(figure, [1, 1, 1])
        drawn = zip(axes, keys, (style.VERMILION, style.BLACK, style.BLUE), strict=True)
        for ax, key, colour in drawn:
            _draw(ax, t, states, key, colour)
        words = "; dotted lines: part of the skin jumps" if _draw_jumps(axes, t, states) else ""
        axes[-1].set_xlabel(f"time ({'ms' if short else 's'}){words}")
        return style.save(figure, path)


def over_period(found: Any, path: Path | str | None) -> Figure:
    """Draw voltage, attraction and friction over a period of a drive, and the spectrum of friction.

    Args:
        found: a :class:`fingerpad.runs.drive.DrivenFriction`.
        path: of the PNG file; None for the figure alone.
    """
    friction, mean = f"{'F_T' if found.unit == 'N' else 'f_T'} ({found.unit})", found.f_t.mean()
    with style.look():
        figure = style.figure(6.0, style.plain(f"{found.scene.voltage}, full slip, closed form"))
        above, right = figure.subfigures(1, 2, width_ratios=(3, 2))
        panels = style.column(above, [1, 1, 1])
        parts = (
            (found.voltage, "U (V)", style.BLACK),
            (_KPA * found.sigma_el, "attraction (kPa)", style.ATTRACTION),
            (found.f_t, friction, style.VERMILION),
        )
        for ax, (values, label, colour) in zip(panels, parts, strict=True):
            ax.plot(_MS * found.time, values, color=colour)
            ax.set_ylabel(label)
        panels[-1].axhline(mean, color=style.GREY, ls="--", label=f"mean {mean:.4g} {found.unit}")
        panels[-1].legend(frameon=True)
        panels[-1].set_xlabel("time (ms)")
        ax, largest = right.subplots(), found.amplitude.max(initial=0.0)
        shown = np.flatnonzero(found.amplitude > _LEAST_AMPLITUDE * largest)[:_COMPONENTS]
        ax.stem(found.frequency[shown], found.amplitude[shown], linefmt=style.VERMILION, basefmt=" ")
        ax.set(xlabel="frequency (Hz)", ylabel=f"amplitude of {friction}", xlim=(0, None), ylim=(0, None))
        return style.save(figure, path)


def raster(found: Any, path: Path | str | None) -> Figure:
    """Draw the spikes of a run, a panel a class, a row a unit, and above them energy densities at Merkel sites.

    Args:
        found: :class:`fingerpad.results.spikes.Spikes`.
        path: of the PNG file; None for the figure alone.
    """
    units = {law: [unit for unit in found.units if unit.law == law] for law in found.laws}
    few, end, colours = max(map(len, units.values())) / 2, _MS * found.seconds, style.CATEGORIES
    heights = [_PANEL + _ROW * (0 if mine[0].ridge is None else max(len(mine), few)) for mine in units.values()]
    heights = [_DENSITIES] * (found.densities is not None) + heights
    with style.look():
        title = "Spikes of afferents below the ridges that can touch; thresholds are relative"
        figure = style.figure(1.3 + sum(heights), title)
        panels = style.column(figure, heights)
        if found.densities is not None:
            _draw_densities(panels[0], found.densities)
        for ax, colour, (law, mine) in zip(panels[-len(units) :], colours, units.items(), strict=False):
            places, alone = [unit.place for unit in mine], mine[0].ridge is None
            spikes = [_MS * train for train in found.of(law)]
            ax.eventplot(spikes, colors=colour, lineoffsets=places, linelengths=0.4 if mine[0].side else 0.8, lw=1.1)
            ax.set_ylabel(law if alone else f"{law}\nridge", color=colour)
            ax.set_ylim(min(places) - 0.7, max(places) + 0.7)
            style.count(ax.yaxis)
            ax.tick_params(left=not alone, labelleft=not alone)
        for load in found.loads:
            begin, last = _MS * load.begin, _MS * load.end
            for ax in panels:
                ax.axvline(begin, color=style.GREY, lw=0.8, ls=":")
            if last - begin > _NAMED * end:
                above: dict[str, Any] = {
                    "transform": panels[0].get_xaxis_transform(),
                    "ha": "center",
                    "va": "bottom",
                    "fontsize": 9,
                }
                panels[0].text((begin + last) / 2, 1.0, style.plain(load.name), **above)
        panels[-1].set(xlabel="time (ms)", xlim=(0, end))
        return style.save(figure, path)


def _draw_densities(ax: Axes, found: Any) -> None:
    """Draw all densities, those that change most in colours with the numbers of their ridges."""
    marked = np.sort(np.argsort(-np.ptp(found.values, axis=1))[:_MARKED])
    ax.plot(_MS * found.time, _KPA * found.values.T, color=style.GREY, lw=0.7, alpha=0.6)
    for k in marked:
        ax.plot(_MS * found.time, _KPA * found.values[k], label=f"ridge {found.ridges[int(k)]}")
    ax.set(ylabel="SED at Merkel\nsites (kPa)", ylim=(0, None))
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
