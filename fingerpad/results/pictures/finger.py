"""The picture of the deformed finger: its cross-section with layers, and the energy density near the contact.

Plain arrays in SI in, a PNG file out. Lines are the parabolas that the edges of the elements are.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch, Rectangle
from matplotlib.path import Path as Curve
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from fingerpad.results.pictures import style
from geometry import tags
from variational.snapshot import loops

if TYPE_CHECKING:
    from variational.snapshot import Snapshot

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Box = tuple[float, float, float, float]
"""Left, right, lower and upper end."""

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
_MARGIN = 0.05  # of the cross-section, around it
_LEAST = 1e-6  # Pa, of the upper end of the colours
_HEIGHT = 6.75  # in, of the picture of a state
DECADES = 1e3  # span of the colours of the energy density


class Scales(NamedTuple):
    """What the pictures of several states of a finger have in common."""

    whole: Box
    """Of the cross-section (mm)."""
    near: Box
    """Of the view near the contact (mm): the contact and 1 mm on either side."""
    highest: float
    """Upper end of the colours of the energy density (Pa)."""


def scales(snapshots: "Sequence[Snapshot]") -> Scales:
    """Return scales that show every one of some states; one element in a thousand near the contact is beyond them."""
    places = [_MM * (each.x + each.u) for each in snapshots]
    low, high = np.min([xy.min(axis=0) for xy in places], axis=0), np.max([xy.max(axis=0) for xy in places], axis=0)
    (left, bottom), (right, top) = low - _MARGIN * (high - low), high + _MARGIN * (high - low)
    touching = [xy[xy[:, 1] <= max(_TOUCHING * _MM, xy[:, 1].min()), 0] for xy in places]
    near = (float(min(x.min() for x in touching)) - 1, float(max(x.max() for x in touching)) + 1, -0.22, 1.3)
    densities = [each.sed[_visible(xy[each.triangles], near)] for each, xy in zip(snapshots, places, strict=True)]
    highest = max(float(np.quantile(density, 0.999)) for density in densities)
    return Scales((left, right, bottom, top), near, max(highest, _LEAST))


def _visible(corners: Array, view: Box) -> NDArray[np.bool_]:
    """Return which triangles, shape (triangles, 3, 2), have a part in a view, shape (triangles,)."""
    left, right, _, top = view
    lowest, highest = corners.min(axis=1), corners.max(axis=1)
    return (highest[:, 0] > left) & (lowest[:, 0] < right) & (lowest[:, 1] < top)


def finger(
    path: Path | str | None,
    snapshot: "Snapshot",
    sites: Array | None,
    title: str,
    ridges: Mapping[int, float] | None = None,
    common: Scales | None = None,
) -> Figure:
    """Draw the deformed cross-section, and the energy density near the contact.

    Args:
        path: of the PNG file; None for the figure alone.
        snapshot: state of the body, see :class:`variational.output.Lines`.
        sites: current positions of Merkel sites (m), shape (n, 2), or None.
        title: what state it is, see :mod:`fingerpad.results.pictures.style`.
        ridges: current abscissa (m) of numbered ridges, number 0 at the centre.
        common: scales of several pictures; by default those of this state alone.
    """
    scale, xy = common or scales([snapshot]), _MM * (snapshot.x + snapshot.u)
    left, right, bottom, top = scale.near
    with style.look():
        figure = _empty(snapshot, scale, sites is not None, title)
        above, near = figure.axes[:2]
        _draw_layers(above, snapshot, xy)
        frame: dict[str, Any] = {"fill": False, "ec": "black", "lw": 1.5, "ls": "--", "zorder": 4}
        above.add_artist(Rectangle((left, bottom), right - left, top - bottom, **frame))
        density(near, snapshot, scale)
        near.set_title("Near the contact; white: between layers" + ("; numbers: ridges" if ridges else ""))
        if sites is not None:
            x, y = _MM * np.asarray(sites).T
            near.plot(x, y, **_SITES, zorder=5)
        for number, x in (ridges or {}).items():
            if left < _MM * x < right:
                near.text(_MM * x, 0.6 * bottom, str(number), ha="center", va="center", fontsize=8, clip_on=True)
        return style.save(figure, path)


def _empty(snapshot: "Snapshot", scale: Scales, sites: bool, title: str) -> Figure:
    """Return a figure with what all states have: the axes of both views, names of layers, colours of densities."""
    figure = style.figure(_HEIGHT, title)
    for ax, view in zip(figure.subplots(2, 1, height_ratios=(5, 3)), (scale.whole, scale.near), strict=True):
        ax.set(xlim=view[:2], ylim=view[2:], xlabel="x (mm)", ylabel="height y (mm)")
        ax.set_aspect("equal")
        ax.xaxis.set_major_locator(MaxNLocator(10, steps=[1, 2, 5, 10]))
    above, near = figure.axes
    above.set_title("Deformed cross-section; dashed: part below")
    near.set_facecolor("0.92")
    names = {tag: name for name, tag in tags.LAYERS.items()}
    layers = _layers(snapshot)
    handles: list[Any] = [Patch(fc=LAYER_COLOURS[tag], ec="black", lw=0.5, label=names[tag]) for tag in layers]
    handles += [Line2D([], [], color="black", lw=2.5, label="screen")]
    handles += [Line2D([], [], **_SITES)] if sites else []
    above.legend(handles=handles, loc="center left", bbox_to_anchor=(1.03, 0.5))
    colours = ScalarMappable(norm(scale), style.MAGNITUDE)
    bar = figure.colorbar(
        colours, ax=near, location="bottom", extend="both", aspect=50,
        ticks=style.decades(_KPA * scale.highest / DECADES, _KPA * scale.highest), format="%g",
    )  # fmt: skip
    bar.minorticks_off()
    bar.set_label("strain energy density, mean of each element (kPa = kJ/m³ of reference volume)")
    return figure


def norm(scale: Scales) -> LogNorm:
    """Return what makes colours of densities (kPa)."""
    return LogNorm(_KPA * scale.highest / DECADES, _KPA * scale.highest)


def _layers(snapshot: "Snapshot") -> list[int]:
    """Return the tags of the layers that a finger has."""
    return [tag for tag in LAYER_COLOURS if (snapshot.tag == tag).any()]


def _draw_layers(ax: Axes, snapshot: "Snapshot", xy: Array) -> None:
    for tag in _layers(snapshot):
        around = loops(snapshot.lines, snapshot.beside, snapshot.tag, tag)
        ax.add_artist(PathPatch(curve(xy, np.concatenate(around)), fc=LAYER_COLOURS[tag], ec="black", lw=0.5))
    outside = loops(snapshot.lines, snapshot.beside, snapshot.tag, 0)
    if len(outside) == 2:
        bone = min((xy[loop[:, 0]] for loop in outside), key=lambda places: float(np.ptp(places[:, 0])))
        x, y = (bone.min(axis=0) + bone.max(axis=0)) / 2
        ax.text(x, y, "bone", ha="center", va="center")
    ax.axhline(0, color="black", lw=2.5, zorder=3)


def curve(xy: Array, lines: Numbers) -> Curve:
    """Return lines as one path of parabolas, which goes on where a line begins at the end of the one before.

    Args:
        xy: points, shape (points, 2).
        lines: points where each line begins, has its middle and ends, shape (lines, 3).
    """
    begin, middle, end = xy[lines].swapaxes(0, 1)
    tangents = 2 * middle - (begin + end) / 2  # where those at both ends meet
    points = np.stack([begin, tangents, end], axis=1).reshape(-1, 2)
    kept = np.ones((len(lines), 3), dtype=bool)
    kept[1:, 0] = lines[1:, 0] != lines[:-1, 2]
    codes = np.tile(np.array([Curve.MOVETO, Curve.CURVE3, Curve.CURVE3], dtype=Curve.code_type), len(lines))
    return Curve(points[kept.ravel()], codes[kept.ravel()])


def density(ax: Axes, snapshot: "Snapshot", scale: Scales) -> None:
    """Draw the energy density near the contact into axes in mm, with the lines between layers and the screen.

    Cells have straight edges; lines between layers are the parabolas that the edges of the elements are.
    """
    xy, span = _MM * (snapshot.x + snapshot.u), norm(scale)
    seen = snapshot.triangles[near := _visible(xy[snapshot.triangles], scale.near)]
    shown = np.clip(_KPA * snapshot.sed[near], span.vmin, span.vmax)
    ax.tripcolor(xy[:, 0], xy[:, 1], shown, triangles=seen, norm=span, cmap=style.MAGNITUDE, rasterized=True)
    left, right, bottom, top = scale.near
    low, high, places = np.array([left, bottom]), np.array([right, top]), xy[snapshot.lines]
    inside = ((places.max(axis=1) > low) & (places.min(axis=1) < high)).all(axis=1)
    outer = snapshot.beside[:, 1] < 0
    for mine, colour in ((inside & ~outer, "white"), (inside & outer, "black")):
        ax.add_artist(PathPatch(curve(xy, snapshot.lines[mine]), fill=False, ec=colour, lw=0.8))
    ax.axhline(0, color="black", lw=2.5, zorder=3)
    ax.set(xlim=(left, right), ylim=(bottom, top))
