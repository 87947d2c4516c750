"""Pictures of the deformed finger: its cross-section with layers and energy density, and the footprint of the whole.

Plain arrays in SI in, a PNG file out.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fingerpad.results import style
from geometry import tags

if TYPE_CHECKING:
    from fingerpad.slices.finger import WholeFinger
    from variational.output import Snapshot

Array = NDArray[np.float64]
Edges = NDArray[np.int64]

LAYER_COLOURS = {
    tags.STRATUM_CORNEUM: style.ORANGE,
    tags.VIABLE_EPIDERMIS: style.SKY,
    tags.DERMIS: style.PURPLE,
    tags.SUBCUTIS: style.YELLOW,
    tags.NAIL: style.GREY,
    tags.NAIL_BED: style.GREEN,
}
_SITES: dict[str, Any] = {
    "marker": "o", "ms": 5, "mfc": "white", "mec": "black", "mew": 1, "ls": "none", "label": "Merkel sites",
}  # fmt: skip
_MM, _KPA = 1e3, 1e-3
_TOUCHING = 0.5e-6  # m: vertices lower than this count as in contact when a view is chosen
_LIGHT = 0.25  # opacity of the gross contact
_WIDER = 1.2  # width of the panel along the finger over that of a state
_DECADES = 1e3  # span of the colours of the energy density


def finger(
    path: Path | str | None,
    snapshot: "Snapshot",
    sites: Array | None,
    title: str,
    ridges: Mapping[int, float] | None = None,
    highest: float | None = None,
) -> Figure:
    """Draw the deformed cross-section, and the energy density near the contact.

    Args:
        path: of the PNG file; None for the figure alone.
        snapshot: state of the body, see :func:`variational.output.gather_mesh`.
        sites: current positions of Merkel sites (m), shape (n, 2), or None.
        title: what state it is, see :mod:`fingerpad.results.style`.
        ridges: current abscissa (m) of numbered ridges, number 0 at the centre.
        highest: upper end of the colours (Pa), for one scale over several pictures; :func:`highest_density` by default.
    """
    xy = _MM * (snapshot.x + snapshot.u)
    lines = interfaces(snapshot.triangles, snapshot.tag)
    view = _near_contact(xy)
    left, right, bottom, top = view
    with style.look():
        figure = style.figure(6.6)
        figure.suptitle(title)
        above, near = figure.subplots(2, 1, height_ratios=[1.9, 1])
        _draw_layers(above, snapshot, xy, lines, [] if sites is None else [Line2D([], [], **_SITES)])
        above.add_patch(
            Rectangle((left, bottom), right - left, top - bottom, fill=False, ec="black", lw=1.5, ls="--", zorder=4)
        )
        above.set_title("Deformed cross-section; dashed: part below")
        scale = highest_density(snapshot) if highest is None else highest
        _draw_density(figure, near, snapshot, xy, lines, view, _KPA * scale)
        if sites is not None:
            x, y = _MM * np.asarray(sites).T
            near.plot(x, y, **_SITES, zorder=5)
        for number, x in (ridges or {}).items():
            if left < _MM * x < right:
                near.text(_MM * x, 0.6 * bottom, str(number), ha="center", va="center", fontsize=8)
        near.set_title("Near the contact; white: between layers" + ("; numbers: ridges" if ridges else ""))
        for ax in (above, near):
            ax.set_aspect("equal")
            ax.xaxis.set_major_locator(MaxNLocator(10, steps=[1, 2, 5, 10]))
            ax.set_xlabel("x (mm)")
            ax.set_ylabel("height y (mm)")
        return style.save(figure, path)


def highest_density(snapshot: "Snapshot") -> float:
    """Return the energy density (Pa) that one element in a thousand near the contact exceeds; not below 1 µPa."""
    xy = _MM * (snapshot.x + snapshot.u)
    return max(float(np.quantile(snapshot.sed[_visible(snapshot, xy, _near_contact(xy))], 0.999)), 1e-6)


def _near_contact(xy: Array) -> tuple[float, float, float, float]:
    """Return left, right, lower and upper end (mm) of the view: the contact and 1 mm on either side."""
    low = xy[xy[:, 1] <= max(_TOUCHING * _MM, xy[:, 1].min()), 0]
    return float(low.min()) - 1, float(low.max()) + 1, -0.22, 1.3


def _visible(snapshot: "Snapshot", xy: Array, view: tuple[float, float, float, float]) -> NDArray[np.bool_]:
    """Return which triangles have a part in a view, shape (triangles,)."""
    left, right, _, top = view
    lowest, highest = xy[snapshot.triangles].min(axis=1), xy[snapshot.triangles].max(axis=1)
    return (highest[:, 0] > left) & (lowest[:, 0] < right) & (lowest[:, 1] < top)


def interfaces(t: Edges, tags_of: NDArray[np.int32]) -> tuple[Edges, Edges]:
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


def _draw_layers(ax: Axes, snapshot: "Snapshot", xy: Array, lines: tuple[Edges, Edges], more: list[Any]) -> None:
    present = [tag for tag in LAYER_COLOURS if (snapshot.tag == tag).any()]
    shade = np.zeros(max(LAYER_COLOURS) + 1)
    shade[present] = np.arange(len(present))
    colours = ListedColormap([LAYER_COLOURS[tag] for tag in present])
    ax.tripcolor(
        Triangulation(xy[:, 0], xy[:, 1], snapshot.triangles), facecolors=shade[snapshot.tag], cmap=colours,
        vmin=-0.5, vmax=len(present) - 0.5, rasterized=True,
    )  # fmt: skip
    ax.add_collection(LineCollection(list(xy[np.concatenate(lines)]), colors="black", linewidths=0.5))
    ax.axhline(0, color="black", lw=2.5, zorder=3)
    names = {tag: name for name, tag in tags.LAYERS.items()}
    handles: list[Any] = [Patch(fc=LAYER_COLOURS[tag], ec="black", lw=0.5, label=names[tag]) for tag in present]
    handles.append(Line2D([], [], color="black", lw=2.5, label="screen"))
    ax.legend(handles=[*handles, *more], loc="center left", bbox_to_anchor=(1.03, 0.5))
    hole = _hole(lines[1], xy)
    if hole is not None:
        x, y = (xy[hole].min(axis=0) + xy[hole].max(axis=0)) / 2
        ax.text(x, y, "bone", ha="center", va="center")
    ax.autoscale_view()


def _hole(boundary: Edges, xy: Array) -> NDArray[np.int64] | None:
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
    lines: tuple[Edges, Edges],
    view: tuple[float, float, float, float],
    most: float,
) -> None:
    left, right, bottom, top = view
    visible = _visible(snapshot, xy, view)
    norm = LogNorm(most / _DECADES, most)
    shown = np.clip(_KPA * snapshot.sed[visible], norm.vmin, norm.vmax)
    triangles = Triangulation(xy[:, 0], xy[:, 1], snapshot.triangles[visible])
    drawn = ax.tripcolor(triangles, facecolors=shown, cmap=style.MAGNITUDE, norm=norm, rasterized=True)
    ax.add_collection(LineCollection(list(xy[lines[0]]), colors="white", linewidths=0.8))
    ax.add_collection(LineCollection(list(xy[lines[1]]), colors="black", linewidths=0.8))
    ax.axhline(0, color="black", lw=2.5, zorder=3)
    bar = figure.colorbar(drawn, ax=ax, location="bottom", extend="both", shrink=0.8, aspect=40)
    bar.set_label("strain energy density, mean of each element (kPa = kJ/m³ of reference volume)")
    ax.set_xlim(left, right)
    ax.set_ylim(bottom, top)
    ax.set_facecolor("0.92")


def footprint(whole: "WholeFinger", path: Path | None = None) -> Figure:
    """Draw the outline of each state in contact and the mean contact pressure along the finger.

    A state's title has its colour. The gross width of a slice is drawn about its middle, where sliding shifts it. The
    darker band is the sum of the contact lengths of all ridges of a slice, which lie apart in the finger.

    Args:
        whole: the finger.
        path: of the PNG file; None for the figure alone.
    """
    with style.look():
        figure = style.figure(5.0)
        ratios = [*(1.0 for _ in whole.states), _WIDER]
        axes = figure.subplots(1, len(ratios), width_ratios=ratios, squeeze=False)[0]
        widest = max(float(each.columns["gross_width"].max(initial=0)) for each in whole.states.values())
        longest = max(float(np.abs(each.z).max(initial=0)) for each in whole.states.values())
        middle, half, end = 0.0, 0.55 * _MM * widest, 1.1 * _MM * longest
        for axis, head, (name, total) in zip(axes, whole.heads(), whole.states.items(), strict=False):
            z, colour = _MM * total.z, style.STATE[name]
            gross, touching = (_MM * total.columns[key] / 2 for key in ("gross_width", "contact_length"))
            axis.fill_betweenx(z, -gross, gross, color=colour, alpha=_LIGHT, lw=0)
            axis.fill_betweenx(z, -touching, touching, color=colour, lw=0)
            area, ridges = (1e6 * total.totals[key] for key in ("gross_area", "contact_area"))
            words = head.replace(" normal", "\nnormal")
            axis.set_title(f"{words}\n{area:.1f} mm² gross,\nridges {ridges:.2f} mm²", color=colour)
            axis.set(xlim=(-half, half), ylim=(-end, end), xlabel="x (mm)")
            axis.set_aspect("equal")
            axes[-1].plot(total.pressure / 1e3, z, color=colour)
            middle = max(middle, float(total.pressure[len(z) // 2]) / 1e3 if len(z) else 0.0)
        for axis in (axes[0], axes[-1]):
            axis.set_ylabel("z along the finger (mm)")
        axes[-1].set(xlabel="mean contact\npressure (kPa)", title="Along the finger")
        axes[-1].set(xlim=(0, 1.3 * middle or None), ylim=(-end, end), box_aspect=end / half / _WIDER)
        bands = {
            "light: gross contact, from the first touching ridge to the last": _LIGHT,
            "dark: sum of the contact lengths of all ridges of a slice; the ridges lie apart": 1.0,
        }
        handles = [Patch(fc=style.GREY, alpha=alpha, lw=0, label=words) for words, alpha in bands.items()]
        figure.legend(handles=handles, loc="outside lower center")
        figure.suptitle(f"Whole finger under {whole.f_ext:.3g} N, as a sum of slices")
        return style.save(figure, path)
