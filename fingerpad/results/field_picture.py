r"""The picture of the electric field between one ridge and the screen, under the stresses that it causes.

The field is that of the law of attraction, as between plates: it stands upright on the screen. In air it is

.. math:: E = \sqrt{2 p_{el} / \varepsilon_0} = U / (h_0 + g), \qquad g = \max(y, d_{eq})

(Forsbach et al. 2023, Eq. 3). Fringes of the field at steep flanks are left out, as in the model.
"""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from fingerpad.results import style
from variational.attraction.dielectric import VACUUM_PERMITTIVITY

if TYPE_CHECKING:
    from fingerpad.results.curves import SurfaceProfile

_LINES = 90  # of the field
_BESIDE, _ABOVE = 60e-6, 9e-6  # m: shown beside the contact, and above the screen
_UM, _KPA, _PER_UM = 1e6, 1e-3, 1e-6


def field(path: Path | str | None, skin: "SurfaceProfile", title: str) -> Figure:
    """Draw field lines, as many per length as the field is strong, and below them pressure and attraction.

    Args:
        path: of the PNG file; None for the figure alone.
        skin: of a charged state in contact.
        title: which state it is, see :mod:`fingerpad.results.style`.
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
        figure = style.sheet(5.4, f"{title}\nridge {ridge:.0f}, U = {abs(skin.state.voltage):.3g} V")
        above, below = style.column(figure, 0.85, 7.6, [(2.35, 4.85), (0.6, 2.15)])
        place = _UM * (x - middle)
        above.fill_between(place, np.minimum(_UM * gap, 2 * _UM * _ABOVE), 2 * _UM * _ABOVE, color="0.85", lw=0)
        above.plot(place, _UM * gap, color="black", lw=1)
        ends = np.minimum(_UM * np.interp(at, x, gap), 2 * _UM * _ABOVE)
        lines = [
            [(_UM * (each - middle), top), (_UM * (each - middle), 0.0)] for each, top in zip(at, ends, strict=True)
        ]
        colours = LineCollection(lines, array=np.interp(at, x, strength), norm=norm, cmap=style.MAGNITUDE, lw=1.4)
        above.add_collection(colours)
        above.axhspan(-1.2, 0, color="0.35", lw=0)
        above.text(0, -0.6, "screen", color="white", ha="center", va="center", fontsize=9)
        above.text(0, 0.85 * _UM * _ABOVE, "skin", ha="center", va="center")
        above.set(ylim=(-1.2, _UM * _ABOVE), ylabel="gap g (µm)")
        bar = style.panel(figure, 7.85, 8.0, 2.35, 4.85)
        figure.colorbar(ScalarMappable(norm, style.MAGNITUDE), cax=bar)
        bar.set_title("field in air\nE (V/µm)")
        below.plot(place, _KPA * p, color=style.PRESSURE, label="contact pressure p")
        below.plot(place, _KPA * p_el, color=style.ATTRACTION, ls="--", label="attraction p_el")
        below.set(xlim=(-_UM * half, _UM * half), xlabel="x from the middle of the contact (µm)", ylabel="stress (kPa)")
        below.legend(loc="upper right")
        return style.save(figure, path)
