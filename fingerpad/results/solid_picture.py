"""The picture of the finger in three dimensions, from its slices: its underside, and its ridges by their pressure.

Every slice is the same unloaded cross-section, at the height of the finger's lower side less the lowering of the bone,
and cut off at the screen: how it deforms beside the screen is not drawn.
"""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LightSource, Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import NDArray

from fingerpad.results import style
from fingerpad.results.finger_picture import ridges_along
from fingerpad.results.states import WORDS
from fingerpad.slices.total import Total, profile
from geometry.profiles import Profiles
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.slices.finger import WholeFinger

Array = NDArray[np.float64]
_MM, _KPA = 1e3, 1e-3
_SLICES, _APART = 31, 0.12  # along the finger; mm between the points of an outline
_BEYOND, _UPPER = 1.5, 5.0  # times the length of the contact; mm, of the height that is drawn
_SKIN, _LIGHT_FROM = "#B58E7A", (120, 60)  # degrees


def solid(whole: "WholeFinger", section: Profiles, path: Path | None, state: ContactState | None, name: str) -> Figure:
    """Draw the finger from below, through the screen.

    Args:
        whole: the finger.
        section: its unloaded cross-section.
        path: of the PNG file; None for the figure alone.
        state: of the section at the centre, as in :func:`fingerpad.results.finger_picture.footprint`.
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
        figure = style.sheet(5.6, f"Whole finger under {whole.f_ext:.3g} N, from below: {WORDS[name]}")
        ax = Axes3D(figure, rect=(0.0, 0.0, 0.8, 0.92), computed_zorder=False)
        figure.add_axes(ax)
        along, light = _MM * np.broadcast_to(z[:, None], x.shape), LightSource(*_LIGHT_FROM)
        ax.plot_surface(x, along, shown, color=_SKIN, lw=0, rstride=1, cstride=1, lightsource=light)
        strips, values = _strips(total, state, section.finger.ridge_wavelength)
        ax.add_collection3d(Poly3DCollection(strips, array=values, norm=norm, cmap=style.MAGNITUDE, lw=0, zorder=5))
        ax.set(xlabel="x (mm)", ylabel="z along the finger (mm)", zlabel="height y (mm)")
        ax.set_box_aspect((np.ptp(edge[:, 0]), 2 * _MM * far, float(shown.max())), zoom=1.25)
        ax.view_init(elev=-32, azim=-58)
        bar = style.panel(figure, 7.9, 8.05, 1.2, 4.4)
        figure.colorbar(ScalarMappable(norm, style.MAGNITUDE), cax=bar)
        bar.set_title("mean contact\npressure (kPa)")
        return style.save(figure, path)


def _strips(total: Total, state: ContactState | None, spacing: float) -> tuple[Array, Array]:
    """Return pieces of ridges on the screen (mm), shape (pieces, 4, 3), and their mean pressure (kPa)."""
    z, columns = total.z, total.columns
    x, parts = ridges_along(state, spacing, columns["gross_width"])
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
