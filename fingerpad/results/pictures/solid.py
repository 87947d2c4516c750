r"""Pictures of a whole finger from its slices: its footprint, and in three dimensions its underside with its ridges.

Every slice is the same unloaded cross-section, at the height of the finger's lower side less the lowering of the bone,
and cut off at the screen: how it deforms beside the screen is not drawn.

And the electric field between one ridge and the screen. It is that of the law of attraction, as between plates, and
stands upright on the screen. In air it is :math:`E = \sqrt{2 p_{el} / \varepsilon_0} = U / (h_0 + g)` with
:math:`g = \max(y, d_{eq})` (Forsbach et al. 2023, Eq. 3). Fringes at steep flanks are left out, as in the model.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LightSource, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from fingerpad.results.data import ResultData
from fingerpad.results.pictures import style
from fingerpad.results.states import WORDS
from fingerpad.slices.total import Total, profile
from geometry.profiles import Profiles
from variational.attraction.dielectric import VACUUM_PERMITTIVITY
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.results.pictures.curves import SurfaceProfile
    from fingerpad.slices.finger import WholeFinger

Array = NDArray[np.float64]
_MM, _KPA = 1e3, 1e-3
_SLICES, _APART = 31, 0.12  # along the finger; mm between the points of an outline
_BEYOND, _UPPER = 1.5, 5.0  # times the length of the contact; mm, of the height that is drawn
_LIGHT = 0.25  # opacity of the gross contact
_ALONG = 400  # places along the finger at which ridges are drawn
_ROUNDOFF = 1e-12  # m
_LINES = 90  # of the field
_BESIDE, _ABOVE = 60e-6, 9e-6  # m: shown beside the contact, and above the screen
_UM, _PER_UM = 1e6, 1e-6
_SKIN, _LIGHT_FROM = "#B58E7A", (120, 60)  # degrees


def draw(result: ResultData, kind: str, path: Path | None) -> Figure:
    """Draw a picture of a result with a whole finger, on rank 0.

    Args:
        result: with ``finger``.
        kind: ``"footprint"`` or ``"solid"``.
        path: of the PNG file; None for the figure alone.
    """
    assert result.finger is not None
    section = Profiles(result.scene.geometry)
    if kind == "footprint":
        return footprint(result.finger, path, result.named, section.finger.ridge_wavelength)
    name = list(result.finger.states)[-1]
    return solid(result.finger, section, path, result.named.get(name), name)


def solid(whole: "WholeFinger", section: Profiles, path: Path | None, state: ContactState | None, name: str) -> Figure:
    """Draw the finger from below, through the screen.

    Args:
        whole: the finger.
        section: its unloaded cross-section.
        path: of the PNG file; None for the figure alone.
        state: of the section at the centre, as in :func:`fingerpad.results.pictures.solid.footprint`.
        name: of the state.
    """
    total, finger = whole.states[name], profile(whole.shape)
    far = min(_BEYOND * float(np.abs(total.z).max()), 0.98 * min(-finger.ends[0], finger.ends[1]))
    z = np.linspace(-far, far, _SLICES)
    half = section.half_perimeter
    s = np.linspace(-half, half, 1 + 2 * round(_MM * half / _APART))
    edge = _MM * section.point(s, section.skin(s))
    edge = edge[edge[:, 1] <= _UPPER]
    lift = _MM * (finger.rise(z) - total.delta)
    shown = np.maximum(edge[None, :, 1] + lift[:, None], 0.0)
    x = np.broadcast_to(edge[:, 0], shown.shape)
    norm = Normalize(0, _KPA * float(total.pressure.max()))
    with style.look():
        figure = style.figure(5.6, f"Whole finger under {whole.f_ext:.3g} N, from below: {WORDS[name]}")
        ax: Any = figure.add_subplot(projection="3d", computed_zorder=False)
        along, light = _MM * np.broadcast_to(z[:, None], x.shape), LightSource(*_LIGHT_FROM)
        ax.plot_surface(x, along, shown, color=_SKIN, lw=0, rstride=1, cstride=1, lightsource=light)
        strips, values = _strips(total, state, section.finger.ridge_wavelength)
        ax.add_collection3d(Poly3DCollection(strips, array=values, norm=norm, cmap=style.MAGNITUDE, lw=0, zorder=5))
        ax.set(xlabel="x (mm)", ylabel="z along the finger (mm)", zlabel="height y (mm)")
        ax.set_box_aspect((np.ptp(edge[:, 0]), 2 * _MM * far, float(shown.max())), zoom=1.05)
        ax.view_init(elev=-32, azim=-58)
        bar = figure.colorbar(ScalarMappable(norm, style.MAGNITUDE), ax=ax, shrink=0.7, pad=0.12)
        bar.ax.set_title("mean contact\npressure (kPa)")
        return style.save(figure, path)


def _strips(total: Total, state: ContactState | None, spacing: float) -> tuple[Array, Array]:
    """Return pieces of ridges on the screen (mm), shape (pieces, 4, 3), and their mean pressure (kPa)."""
    z, columns = total.z, total.columns
    x, parts = _ridges_along(state, spacing, columns["gross_width"])
    length: Array = parts * columns["contact_length"]
    found, values = [], []
    for ridge, place in enumerate(x):
        mine = length[ridge]
        for k in np.flatnonzero((mine[1:] > 0) & (mine[:-1] > 0)):
            a, b = mine[k] / 2, mine[k + 1] / 2
            ends = [(place - a, z[k]), (place + a, z[k]), (place + b, z[k + 1]), (place - b, z[k + 1])]
            found.append([(_MM * u, _MM * v, 0.0) for u, v in ends])
            values.append(_KPA * float(total.pressure[k : k + 2].mean()))
    return np.array(found), np.array(values)


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
        figure = style.figure(5.1, f"Whole finger under {whole.f_ext:.3g} N, as a sum of slices")
        figure.set_layout_engine("constrained", rect=(0.0, 0.0, 1.0, 0.95))  # below the title
        axes = list(figure.subplots(1, len(whole.states) + 1, squeeze=False)[0])
        widest = max(float(each.columns["gross_width"].max(initial=0)) for each in whole.states.values())
        longest = max(float(np.abs(each.z).max(initial=0)) for each in whole.states.values())
        middle, half, end = 0.0, 0.55 * _MM * widest, 1.1 * _MM * longest
        for axis, head, (name, total) in zip(axes, whole.heads(), whole.states.items(), strict=False):
            z, colour = np.linspace(total.z.min(initial=0), total.z.max(initial=0), _ALONG), style.STATE[name]
            gross, touching = (np.interp(z, total.z, total.columns[key]) for key in ("gross_width", "contact_length"))
            axis.fill_betweenx(_MM * z, -_MM * gross / 2, _MM * gross / 2, color=colour, alpha=_LIGHT, lw=0)
            x, parts = _ridges_along((named or {}).get(name), spacing, gross)
            lengths: Array = parts * touching
            for k, place in enumerate(x):
                left, right = _MM * (place - lengths[k] / 2), _MM * (place + lengths[k] / 2)
                axis.fill_betweenx(_MM * z, left, right, where=lengths[k] > 0, color=colour, lw=0)
            area, ridges = (1e6 * total.totals[key] for key in ("gross_area", "contact_area"))
            words = head.replace(" normal", "\nnormal")
            axis.set_title(f"{words}\n{area:.1f} mm² gross,\nridges {ridges:.2f} mm²", color=colour)
            axis.set(xlim=(-half, half), ylim=(-end, end), xlabel="x (mm)", aspect="equal")
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
        figure.legend(handles=handles, loc="outside lower center")
        return style.save(figure, path)


def _ridges_along(state: ContactState | None, spacing: float, gross: Array) -> tuple[Array, Array]:
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


def field(path: Path | str | None, skin: "SurfaceProfile", title: str) -> Figure:
    """Draw field lines, as many per length as the field is strong, and below them pressure and attraction.

    Args:
        path: of the PNG file; None for the figure alone.
        skin: of a charged state in contact.
        title: which state it is, see :mod:`fingerpad.results.pictures.style`.
    """
    touching = skin.ridge[skin.p > 0]
    ridge = float(touching[np.abs(touching - np.median(touching)).argmin()])
    mine = skin.ridge == ridge
    x, y, p, p_el = (each[mine] for each in (skin.x, skin.y, skin.p, skin.p_el))
    middle, half = float(x[p > 0].mean()), float(np.ptp(x[p > 0])) / 2 + _BESIDE
    gap = np.maximum(y, float(skin.d_eq[mine][0]))
    strength = np.sqrt(2 * p_el / VACUUM_PERMITTIVITY) * _PER_UM
    fine = np.linspace(middle - half, middle + half, 2001)
    flux = np.cumsum(np.interp(fine, x, strength))
    at = np.interp((np.arange(_LINES) + 0.5) / _LINES * flux[-1], flux, fine)
    norm = Normalize(0, float(strength.max()))
    with style.look():
        figure = style.figure(5.4, f"{title}\nridge {ridge:.0f}, U = {abs(skin.state.voltage):.3g} V")
        above, below = style.column(figure, [5, 3])
        place = _UM * (x - middle)
        above.fill_between(place, np.minimum(_UM * gap, 2 * _UM * _ABOVE), 2 * _UM * _ABOVE, color="0.85", lw=0)
        above.plot(place, _UM * gap, color="black", lw=1)
        ends = np.minimum(_UM * np.interp(at, x, gap), 2 * _UM * _ABOVE)
        lines = [
            [(_UM * (each - middle), top), (_UM * (each - middle), 0.0)] for each, top in zip(at, ends, strict=True)
        ]
        upright = LineCollection(lines, array=np.interp(at, x, strength), norm=norm, cmap=style.MAGNITUDE, lw=1.4)
        above.add_collection(upright)
        above.axhspan(-1.2, 0, color="0.35", lw=0)
        above.text(0, -0.6, "screen", color="white", ha="center", va="center", fontsize=9)
        above.text(0, 0.85 * _UM * _ABOVE, "skin", ha="center", va="center")
        above.set(ylim=(-1.2, _UM * _ABOVE), ylabel="gap g (µm)")
        colours = figure.colorbar(ScalarMappable(norm, style.MAGNITUDE), ax=[above, below], aspect=40)
        colours.ax.set_title("field in air\nE (V/µm)")
        below.plot(place, _KPA * p, color=style.PRESSURE, label="contact pressure p")
        below.plot(place, _KPA * p_el, color=style.ATTRACTION, ls="--", label="attraction p_el")
        below.set(xlim=(-_UM * half, _UM * half), xlabel="x from the middle of the contact (µm)", ylabel="stress (kPa)")
        below.legend(loc="upper right")
        return style.save(figure, path)
