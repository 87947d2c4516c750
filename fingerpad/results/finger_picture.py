"""Pictures of the deformed finger: its cross-section with layers and energy density, and the footprint of the whole.

Plain arrays in SI in, a PNG file out. Lines are the parabolas that the edges of the elements are.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import matplotlib
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

from fingerpad.results import style
from fingerpad.results.raster import cells_at, pieces
from geometry import tags
from variational.snapshot import loops
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.slices.finger import WholeFinger
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
_HEIGHT = 6.75  # in, of the picture of a state; the places of its parts follow
_ABOVE, _NEAR, _COLOURS = (0.85, 6.75, 3.65, 6.2), (0.85, 8.85, 1.25, 2.8), (1.5, 7.5, 0.52, 0.66)
_STRAIGHT = 0.25  # pixels: the bend of a line that is drawn straight
_LIGHT = 0.25  # opacity of the gross contact
_ALONG = 400  # places along the finger at which ridges are drawn
_ROUNDOFF = 1e-12  # m
_FOOTPRINT, _APART, _WIDER = (0.95, 8.8, 1.2, 3.8), 0.35, 1.4  # in: all panels; between them; last one over a state's
_LABEL = 0.55  # in, more between the last panel and the one before, whose label it is
_DECADES = 1e3  # span of the colours of the energy density


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
    on: Figure | None = None,
) -> Figure:
    """Draw the deformed cross-section, and the energy density near the contact.

    Args:
        path: of the PNG file; None for the figure alone.
        snapshot: state of the body, see :class:`variational.output.Lines`.
        sites: current positions of Merkel sites (m), shape (n, 2), or None.
        title: what state it is, see :mod:`fingerpad.results.style`.
        ridges: current abscissa (m) of numbered ridges, number 0 at the centre.
        common: scales of several pictures; by default those of this state alone.
        on: figure of another state of the same finger on the same scales, which becomes that of this state.
    """
    scale, xy = common or scales([snapshot]), _MM * (snapshot.x + snapshot.u)
    left, right, bottom, top = scale.near
    with style.look():
        figure = on or _empty(snapshot, scale, sites is not None, title)
        style.head(figure, title)
        above, near = figure.axes[:2]
        style.clear((above, near))
        _draw_layers(above, snapshot, xy)
        frame: dict[str, Any] = {"fill": False, "ec": "black", "lw": 1.5, "ls": "--", "zorder": 4}
        above.add_artist(Rectangle((left, bottom), right - left, top - bottom, **frame))
        density(near, snapshot, scale, fitted(_NEAR, scale.near))
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
    figure = style.sheet(_HEIGHT, title)
    for box, view in ((_ABOVE, scale.whole), (_NEAR, scale.near)):
        ax = style.panel(figure, *fitted(box, view))
        ax.set(xlim=view[:2], ylim=view[2:], xlabel="x (mm)", ylabel="height y (mm)")
        ax.set_aspect("equal", adjustable="datalim")  # the panel stays where it is when a reader looks closer
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
        colours, cax=style.panel(figure, *_COLOURS), orientation="horizontal", extend="both",
        ticks=style.decades(_KPA * scale.highest / _DECADES, _KPA * scale.highest), format="%g",
    )  # fmt: skip
    bar.minorticks_off()
    bar.set_label("strain energy density, mean of each element (kPa = kJ/m³ of reference volume)")
    return figure


def fitted(box: Box, view: Box) -> Box:
    """Return the largest part of a box (in), in its middle, in which a view has one scale along both axes."""
    wide, high = view[1] - view[0], view[3] - view[2]
    unit = min((box[1] - box[0]) / wide, (box[3] - box[2]) / high)
    x, y = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
    return x - unit * wide / 2, x + unit * wide / 2, y - unit * high / 2, y + unit * high / 2


def norm(scale: Scales) -> LogNorm:
    """Return what makes colours of densities (kPa)."""
    return LogNorm(_KPA * scale.highest / _DECADES, _KPA * scale.highest)


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


def density(ax: Axes, snapshot: "Snapshot", scale: Scales, box: Box) -> None:
    """Draw the energy density near the contact into axes, with the lines between layers and the screen.

    Args:
        ax: whose units are millimetres.
        snapshot: state of the body.
        scale: of which the view near the contact and the colours are taken.
        box: place of the axes in their figure (in), which gives the number of pixels.
    """
    xy = _MM * (snapshot.x + snapshot.u)
    left, right, bottom, top = scale.near
    columns, rows = round(style.DPI * (box[1] - box[0])), round(style.DPI * (box[3] - box[2]))
    pixel = (right - left) / columns
    x, y = left + pixel * (np.arange(columns) + 0.5), bottom + (top - bottom) / rows * (np.arange(rows) + 0.5)
    corners, cells = pieces(xy, snapshot.triangles, snapshot.lines, snapshot.beside, _STRAIGHT * pixel)
    seen = _visible(corners, scale.near)
    span = norm(scale)
    shown = np.clip(_KPA * snapshot.sed[cells[seen]], span.vmin, span.vmax)
    colours = matplotlib.colormaps[style.MAGNITUDE](span(shown), bytes=True)
    nothing = np.zeros((1, 4), dtype=np.uint8)  # the last one, which -1 is of
    image = np.concatenate([colours, nothing])[cells_at(corners[seen], x, y)]
    ax.imshow(image, extent=scale.near, origin="lower", interpolation="nearest")
    low, high = np.array([left, bottom]), np.array([right, top])
    places = xy[snapshot.lines]
    inside = ((places.max(axis=1) > low) & (places.min(axis=1) < high)).all(axis=1)
    outer = snapshot.beside[:, 1] < 0
    for mine, colour in ((inside & ~outer, "white"), (inside & outer, "black")):
        ax.add_artist(PathPatch(curve(xy, snapshot.lines[mine]), fill=False, ec=colour, lw=0.8))
    ax.axhline(0, color="black", lw=2.5, zorder=3)


def footprint(
    whole: "WholeFinger",
    path: Path | None = None,
    named: Mapping[str, ContactState] | None = None,
    spacing: float = 5e-4,
) -> Figure:
    """Draw the ridges and the outline of each state in contact, and the mean contact pressure along the finger.

    A state's title has its colour. The gross width of a slice is drawn about its middle, where sliding shifts it.
    Slices give the sum of the contact lengths of their ridges. Its parts are those of the section at the centre of
    the finger, at equal places within the gross width: an *assumption* of this picture.

    Args:
        whole: the finger.
        path: of the PNG file; None for the figure alone.
        named: states of the section at its centre by name, whose ridges are drawn; without them, ridges bear like a
            cylinder's contact, by the root of one minus the square of their place.
        spacing: of ridges (m) where no state has them.
    """
    with style.look():
        figure = style.sheet(4.9, f"Whole finger under {whole.f_ext:.3g} N, as a sum of slices")
        widest = max(float(each.columns["gross_width"].max(initial=0)) for each in whole.states.values())
        longest = max(float(np.abs(each.z).max(initial=0)) for each in whole.states.values())
        middle, half, end = 0.0, 0.55 * _MM * widest, 1.1 * _MM * longest
        axes = [style.panel(figure, *box) for box in _footprint_boxes(len(whole.states), half, end)]
        for axis, head, (name, total) in zip(axes, whole.heads(), whole.states.items(), strict=False):
            z, colour = np.linspace(total.z.min(initial=0), total.z.max(initial=0), _ALONG), style.STATE[name]
            gross, touching = (np.interp(z, total.z, total.columns[key]) for key in ("gross_width", "contact_length"))
            axis.fill_betweenx(_MM * z, -_MM * gross / 2, _MM * gross / 2, color=colour, alpha=_LIGHT, lw=0)
            x, parts = ridges_along((named or {}).get(name), spacing, gross)
            lengths: Array = parts * touching
            for k, place in enumerate(x):
                left, right = _MM * (place - lengths[k] / 2), _MM * (place + lengths[k] / 2)
                axis.fill_betweenx(_MM * z, left, right, where=lengths[k] > 0, color=colour, lw=0)
            area, ridges = (1e6 * total.totals[key] for key in ("gross_area", "contact_area"))
            words = head.replace(" normal", "\nnormal")
            axis.set_title(f"{words}\n{area:.1f} mm² gross,\nridges {ridges:.2f} mm²", color=colour)
            axis.set(xlim=(-half, half), ylim=(-end, end), xlabel="x (mm)")
            axes[-1].plot(total.pressure / 1e3, _MM * total.z, color=colour)
            middle = max(middle, float(total.pressure[len(total.z) // 2]) / 1e3 if len(total.z) else 0.0)
        for axis in (axes[0], axes[-1]):
            axis.set_ylabel("z along the finger (mm)")
        axes[-1].set(xlabel="mean contact\npressure (kPa)", title="Along the finger")
        axes[-1].set(xlim=(0, 1.3 * middle or None), ylim=(-end, end))
        bands = {
            "light: gross contact, from the first touching ridge to the last": _LIGHT,
            "dark: ridges; a slice has the sum of their lengths, the centre gives its parts": 1.0,
        }
        handles = [Patch(fc=style.GREY, alpha=alpha, lw=0, label=words) for words, alpha in bands.items()]
        figure.legend(handles=handles, loc="lower center")
        return style.save(figure, path)


def ridges_along(state: ContactState | None, spacing: float, gross: Array) -> tuple[Array, Array]:
    """Return places of ridges (m) about the middle of the contact, and their parts of the contact length of slices.

    Args:
        state: at the centre of the finger, if it is known.
        spacing: of ridges (m).
        gross: width of the contact of each slice (m), shape (slices,).

    Returns:
        Shapes (ridges,) and (ridges, slices); a part is 0 where the ridge does not touch.
    """
    count = int(gross.max(initial=0) / 2 / spacing)
    x, length = spacing * np.arange(-count, count + 1.0), np.array([])
    ridges = None if state is None else state.ridges
    if ridges is not None and (ridges.length > 0).any():
        touches = ridges.length > 0
        x, length = np.asarray(spacing * ridges.number[touches], dtype=np.float64), ridges.length[touches]
        x -= (x.min() + x.max()) / 2
    place = x[:, None] / np.maximum(gross / 2, _ROUNDOFF)
    outer = max(float(np.abs(x).max(initial=0)), _ROUNDOFF)
    if length.size:
        parts = np.interp(place * outer, x, length)
    else:
        parts = np.sqrt(np.maximum(1 - place**2, 0))
    nearest = np.abs(place).min(axis=0, initial=np.inf)  # touches where no ridge lies within a narrow contact
    parts = np.where(np.abs(place) <= np.maximum(1, nearest), parts, 0.0)
    return x, parts / np.maximum(parts.sum(axis=0), _ROUNDOFF)


def _footprint_boxes(states: int, half: float, end: float) -> list[Box]:
    """Return the places (in) of the panels of states, whose millimetres are square, and of the one along the finger."""
    left, right, bottom, top = _FOOTPRINT
    each = (right - left) / (states + _WIDER) - _APART
    boxes = []
    for k in range(states + 1):
        begin = left + k * (each + _APART) + (_LABEL if k == states else 0)
        place = fitted((begin, begin + each, bottom, top), (-half, half, -end, end))
        boxes.append(place if k < states else (begin, right, *place[2:]))
    return boxes
