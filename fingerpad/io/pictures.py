"""Pictures of a run for people: plain arrays in SI in, PNG files out.

Each says by itself what is shown and under which load. Colours are told apart with any colour vision: Okabe and Ito's
for categories, viridis for magnitudes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fingerpad.io import titles
from geometry import tags

if TYPE_CHECKING:
    from variational.output import Snapshot

Array = NDArray[np.float64]

BLUE, VERMILION, GREEN, ORANGE = "#0072B2", "#D55E00", "#009E73", "#E69F00"
SKY, YELLOW, PURPLE, GREY = "#56B4E9", "#F0E442", "#CC79A7", "#999999"
_LAYER_COLOURS = {
    tags.STRATUM_CORNEUM: ORANGE,
    tags.VIABLE_EPIDERMIS: SKY,
    tags.DERMIS: PURPLE,
    tags.SUBCUTIS: YELLOW,
    tags.NAIL: GREY,
    tags.NAIL_BED: GREEN,
}
_STYLE = {
    "font.size": 11,
    "axes.titlesize": 11,
    "legend.fontsize": 10,
    "figure.titlesize": 13,
    "axes.grid": False,
    "lines.linewidth": 1.5,
}
_MM, _UM, _KPA = 1e3, 1e6, 1e-3
_TOUCHING = 0.5e-6  # m: vertices lower than this count as in contact when a view is chosen
_DECADES = 1e3  # span of the colours of the energy density


def _save(figure: Figure, path: Path | str | None) -> None:
    if path is not None:
        figure.savefig(path, dpi=170)


def _second_scale(ax: Axes, unit: float, label: str) -> None:
    """Add a scale on the right that measures the left one in ``unit``."""

    def forth(value: Any) -> Any:
        return value / unit

    def back(value: Any) -> Any:
        return value * unit

    ax.secondary_yaxis("right", functions=(forth, back)).set_ylabel(label)


# -- the body ------------------------------------------------------------------------------------------
def finger(path: Path | str | None, snapshot: "Snapshot", sites: Array | None, title: str) -> Figure:
    """Draw the deformed cross-section, and the energy density near the contact.

    Args:
        path: of the PNG file; None for the figure alone.
        snapshot: state of the body, see :func:`variational.output.gather_mesh`.
        sites: current positions of Merkel sites (m), shape (n, 2), or None.
        title: what state it is, see :mod:`fingerpad.io.titles`.
    """
    xy = _MM * (snapshot.x + snapshot.u)
    lines = interfaces(snapshot.triangles, snapshot.tag)
    left, right, top = _near_contact(xy)
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(14, 5.2), layout=ConstrainedLayoutEngine(h_pad=0.12))
        whole, near = figure.subplots(1, 2, width_ratios=[1, 2])
        figure.suptitle(title)
        _draw_layers(whole, snapshot, xy, lines)
        whole.add_patch(Rectangle((left, -0.05), right - left, top, fill=False, ec="black", lw=1.5, ls="--", zorder=4))
        whole.set_title("Deformed cross-section (dashed: view on the right)")
        _draw_density(figure, near, snapshot, xy, lines, (left, right, top))
        if sites is not None:
            x, y = _MM * np.asarray(sites).T
            near.plot(x, y, "o", ms=5, mfc="white", mec="black", mew=1, ls="none", label="Merkel sites", zorder=5)
        near.set_title("Near the contact; white: between layers", loc="left", pad=24)  # above the legend
        near.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=2, frameon=False, borderaxespad=0.2)
        for ax in (whole, near):
            ax.set_aspect("equal")
            ax.xaxis.set_major_locator(MaxNLocator(8, steps=[1, 2, 5, 10]))
            ax.set_xlabel("x (mm)")
            ax.set_ylabel("height y (mm)")
        _save(figure, path)
    return figure


def _near_contact(xy: Array) -> tuple[float, float, float]:
    """Return left, right and upper end (mm) of the view: the contact and 1 mm on either side."""
    low = xy[xy[:, 1] <= max(_TOUCHING * _MM, xy[:, 1].min()), 0]
    return float(low.min()) - 1, float(low.max()) + 1, 1.3


def interfaces(t: NDArray[np.int64], tags_of: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the edges, pairs of vertices, between layers and on the boundary.

    Args:
        t: vertices of each triangle, shape (cells, 3).
        tags_of: the layer of each, shape (cells,).
    """
    edges = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    edges, where, count = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    tag = np.tile(tags_of, 3)
    lowest, highest = np.full(len(edges), np.iinfo(np.int32).max), np.zeros(len(edges), dtype=int)
    np.minimum.at(lowest, where.ravel(), tag)
    np.maximum.at(highest, where.ravel(), tag)
    return edges[(count == 2) & (lowest != highest)], edges[count == 1]


def _draw_layers(ax: Axes, snapshot: "Snapshot", xy: Array, lines: tuple[NDArray[np.int64], NDArray[np.int64]]) -> None:
    present = [tag for tag in _LAYER_COLOURS if (snapshot.tag == tag).any()]
    shade = np.zeros(max(_LAYER_COLOURS) + 1)
    shade[present] = np.arange(len(present))
    colours = ListedColormap([_LAYER_COLOURS[tag] for tag in present])
    ax.tripcolor(
        Triangulation(xy[:, 0], xy[:, 1], snapshot.triangles), facecolors=shade[snapshot.tag], cmap=colours,
        vmin=-0.5, vmax=len(present) - 0.5, rasterized=True,
    )  # fmt: skip
    ax.add_collection(LineCollection(list(xy[np.concatenate(lines)]), colors="black", linewidths=0.5))
    ax.axhline(0, color="black", lw=2.5, zorder=3)
    names = {tag: name for name, tag in tags.LAYERS.items()}
    handles: list[Any] = [Patch(fc=_LAYER_COLOURS[tag], ec="black", lw=0.5, label=names[tag]) for tag in present]
    handles.append(Line2D([], [], color="black", lw=2.5, label="screen"))
    ax.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=3, frameon=False)
    hole = _hole(lines[1], xy)
    if hole is not None:
        x, y = (xy[hole].min(axis=0) + xy[hole].max(axis=0)) / 2
        ax.text(x, y, "bone", ha="center", va="center")
    ax.autoscale_view()


def _hole(boundary: NDArray[np.int64], xy: Array) -> NDArray[np.int64] | None:
    """Return the vertices on the inner one of two closed boundaries, None if there are not two."""
    pairs = (np.ones(len(boundary)), (boundary[:, 0], boundary[:, 1]))
    label = connected_components(coo_array(pairs, shape=(len(xy), len(xy))), directed=False)[1]
    vertices = np.unique(boundary)
    parts = [vertices[label[vertices] == part] for part in np.unique(label[vertices])]
    if len(parts) != 2:
        return None
    return min(parts, key=lambda part: float(np.ptp(xy[part, 0])))


def _draw_density(
    figure: Figure,
    ax: Axes,
    snapshot: "Snapshot",
    xy: Array,
    lines: tuple[NDArray[np.int64], NDArray[np.int64]],
    view: tuple[float, float, float],
) -> None:
    left, right, top = view
    lowest, highest = xy[snapshot.triangles].min(axis=1), xy[snapshot.triangles].max(axis=1)
    visible = (highest[:, 0] > left) & (lowest[:, 0] < right) & (lowest[:, 1] < top)
    sed = _KPA * snapshot.sed
    most = max(float(np.quantile(sed[visible], 0.999)), 1e-9)
    norm = LogNorm(most / _DECADES, most)
    shown = np.clip(sed[visible], norm.vmin, norm.vmax)
    triangles = Triangulation(xy[:, 0], xy[:, 1], snapshot.triangles[visible])
    drawn = ax.tripcolor(triangles, facecolors=shown, cmap="viridis", norm=norm, rasterized=True)
    ax.add_collection(LineCollection(list(xy[lines[0]]), colors="white", linewidths=0.8))
    ax.add_collection(LineCollection(list(xy[lines[1]]), colors="black", linewidths=0.8))
    ax.axhline(0, color="black", lw=2.5, label="screen", zorder=3)
    bar = figure.colorbar(drawn, ax=ax, location="bottom", extend="both", shrink=0.8, aspect=40)
    bar.set_label("strain energy density, mean of each element (kPa = kJ/m³ of reference volume)")
    ax.set_xlim(left, right)
    ax.set_ylim(-0.05, top)
    ax.set_facecolor("0.92")


# -- the surface ---------------------------------------------------------------------------------------
@dataclass(frozen=True)
class SurfaceProfile:
    """The skin near the screen in one state; arrays along the arc, a NaN between ridges breaks the lines."""

    title: str
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
    f_ext: float
    """External normal force per length (N/m)."""
    voltage: float
    """Instantaneous voltage (V)."""
    bone_x: float
    """Where the bone is sideways (m)."""
    contact_length: float
    """Contact length L_R (m)."""
    note: str = ""
    """What else the panel's title says."""


def surface(path: Path | str | None, states: Sequence[SurfaceProfile], title: str, largest_gap: float = 6e-6) -> Figure:
    """Draw pressure, shear traction, attraction and gaps along the surface (Fig. 2 of Forsbach et al. 2023).

    Args:
        path: of the PNG file; None for the figure alone.
        states: one pair of panels each, such as normal contact, partial slip and full slip.
        title: what they have in common, see :mod:`fingerpad.io.titles`.
        largest_gap: end of the gaps' axis (m).
    """
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(11, 1 + 3.5 * len(states)), layout="constrained")
        figure.suptitle(title)
        axes = figure.subplots(2 * len(states), 1, sharex=True, squeeze=False, height_ratios=[2, 1] * len(states))[:, 0]
        stresses, gaps = axes[::2], axes[1::2]
        for letter, state, above, below in zip("ABCDEFGH", states, stresses, gaps, strict=False):
            _draw_stresses(above, state)
            above.set_title(_surface_title(letter, state), loc="left")
            _draw_gaps(below, state, largest_gap)
        bottom, top = _common_range(states)
        for ax in stresses:
            ax.set_ylim(bottom, top)
        handles = [h for ax in (stresses[0], gaps[0]) for h in ax.get_legend_handles_labels()[0]]
        figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
        touching = np.concatenate([s.x[s.p > 0] for s in states])
        if len(touching):
            gaps[-1].set_xlim(_MM * touching.min() - 0.5, _MM * touching.max() + 0.5)
        gaps[-1].set_xlabel("x on the screen (mm)")
        _save(figure, path)
    return figure


def _surface_title(letter: str, state: SurfaceProfile) -> str:
    words = f"{letter}  {state.title}: {titles.loads([(state.f_ext, state.voltage, state.bone_x)])}"
    words += f", $L_R$ = {_MM * state.contact_length:.3g} mm"
    if state.contact_length > 0:
        words += f", $f_{{ext}}/L_R$ = {_KPA * state.f_ext / state.contact_length:.3g} kPa"
    return f"{words}\n     {state.note}" if state.note else words


def _common_range(states: Sequence[SurfaceProfile]) -> tuple[float, float]:
    values = _KPA * np.concatenate([array[np.isfinite(array)] for s in states for array in (s.p, s.t, s.p_el)])
    low, high = min(float(values.min(initial=0)), 0.0), max(float(values.max(initial=0)), 1e-9)
    return low - 0.06 * (high - low), high + 0.06 * (high - low)


def _draw_stresses(ax: Axes, s: SurfaceProfile) -> None:
    x = _MM * s.x
    ax.axhline(0, color="0.7", lw=0.8, zorder=0)
    ax.fill_between(x, 0, _KPA * s.p, color=BLUE, alpha=0.15, lw=0)
    ax.plot(x, _KPA * s.p, color=BLUE, label="contact pressure $p$")
    ax.plot(x, _KPA * s.p_el, color=VERMILION, ls="--", label="attraction $\\sigma_{el}$")
    ax.plot(x, _KPA * s.t, color=PURPLE, label="shear traction $t$ on the skin, positive to the right")
    ax.set_ylabel("stress (kPa)")
    if s.contact_length > 0 and s.f_ext > 0:
        _second_scale(ax, _KPA * s.f_ext / s.contact_length, "stress / $(f_{ext}/L_R)$ (–)")


def _draw_gaps(ax: Axes, s: SurfaceProfile, largest: float) -> None:
    ax.axhline(0, color="0.7", lw=0.8, zorder=0)
    ax.fill_between(_MM * s.x, np.minimum(_UM * s.y, 2 * _UM * largest), 2 * _UM * largest, color="0.85", lw=0)
    ax.plot(_MM * s.x, _UM * s.y, color="black", lw=1, label="height of the skin (grey) above the screen")
    ax.plot(_MM * s.x, _UM * s.d_eq, color=GREEN, lw=2.2, label="equivalent air gap $d_{eq}$")
    ax.set_ylim(-0.08 * largest * _UM, largest * _UM)
    ax.set_ylabel("gap (µm)")


# -- the history ---------------------------------------------------------------------------------------
def history(
    path: Path | str | None, rows: Sequence[Mapping[str, Any]], title: str, mu_0: float | None = None
) -> Figure:
    """Draw friction force and contact length over the bone's displacement.

    Args:
        path: of the PNG file; None for the figure alone.
        rows: accepted steps in order, with ``bone_x`` (m), ``f_t`` and ``f_ext`` (N/m), ``contact_length`` (m),
            ``ridges_in_contact`` and, true where ridges jumped, ``jump``. What precedes sliding is left out but
            for its last row.
        title: what run it is, see :mod:`fingerpad.io.titles`.
        mu_0: friction coefficient, drawn as the limit without attraction.
    """
    rows = _sliding(rows)

    def column(name: str) -> Array:
        return np.array([row[name] for row in rows], dtype=float)

    x, f_t, f_ext = _MM * column("bone_x"), column("f_t"), column("f_ext")
    jumps = x[[bool(row.get("jump", False)) for row in rows]]
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(9.5, 7), layout="constrained")
        figure.suptitle(title)
        force, length = figure.subplots(2, 1, sharex=True)
        force.plot(x, f_t, "o-", ms=3.5, color=BLUE, label="friction force $f_T$")
        force.set_ylabel("friction force $f_T$ (N/m)")
        apparent = _draw_apparent(force, x, f_t, f_ext, mu_0)
        length.plot(x, _MM * column("contact_length"), "o-", ms=3.5, color=BLUE, label="contact length $L_R$")
        length.set_ylabel("contact length $L_R$ (mm)", color=BLUE)
        length.set_xlabel("sideways displacement of the bone (mm)")
        ridges = length.twinx()
        ridges.step(x, column("ridges_in_contact"), where="post", color=VERMILION, label="ridges in contact")
        ridges.set_ylabel("ridges in contact (number)", color=VERMILION)
        ridges.yaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
        for ax, other in ((force, apparent), (length, ridges)):
            for jump in jumps:
                line = ax.axvline(jump, color="black", lw=1, ls=":", zorder=0)
            if len(jumps):
                line.set_label("part of the skin jumps")
            handles = [h for a in {ax: None, other: None} for h in a.get_legend_handles_labels()[0]]
            ax.legend(
                handles=handles, loc="lower left", bbox_to_anchor=(0, 1), ncols=3, frameon=False, borderaxespad=0.2
            )
        _save(figure, path)
    return figure


def _sliding(rows: Sequence[Mapping[str, Any]]) -> Sequence[Mapping[str, Any]]:
    """Return the rows from the last one before the bone first moves sideways."""
    for k in range(1, len(rows)):
        if rows[k]["bone_x"] != rows[0]["bone_x"]:
            return rows[k - 1 :]
    return rows[-1:]


def _draw_apparent(ax: Axes, x: Array, f_t: Array, f_ext: Array, mu_0: float | None) -> Axes:
    """Add mu_app on the right, a second scale of the same curve where f_ext is constant, else a curve of its own.

    Returns:
        The axes whose vertical coordinate mu_0 was drawn in.
    """
    label = "apparent friction $\\mu_{app} = f_T / f_{ext}$ (–)"
    load, other = float(f_ext[0]), ax
    if load > 0 and np.allclose(f_ext, load, rtol=1e-6, atol=0):
        _second_scale(ax, load, label)
    else:
        load, other = 1.0, ax.twinx()
        mu_app = np.divide(f_t, f_ext, out=np.full_like(f_t, np.nan), where=f_ext > 0)
        other.plot(x, mu_app, "s--", ms=3, color=VERMILION, label="apparent friction $\\mu_{app}$")
        other.set_ylabel(label, color=VERMILION)
        ax.yaxis.label.set_color(BLUE)
    if mu_0 is not None:
        words = f"$\\mu_{{app}} = \\mu_0$ = {mu_0:.3g}, the most without attraction"
        other.axhline(mu_0 * load, color="0.4", lw=1, ls="--", label=words)
    return other
