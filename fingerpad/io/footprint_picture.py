"""The picture of a whole finger's footprint: gross outline and ridge contact over the finger, slice by slice."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from fingerpad.io import style
from fingerpad.slices.finger import WholeFinger

_MM = 1e3
_LIGHT = 0.25  # opacity of the gross contact
_WIDER = 1.2  # width of the panel along the finger over that of a state


def footprint(finger: WholeFinger, path: Path | None = None) -> Figure:
    """Draw the outline of each state in contact and the mean contact pressure along the finger.

    A state's title has its colour. The gross width of a slice is drawn about its middle, where sliding shifts it. The
    darker band is the sum of the contact lengths of all ridges of a slice, which lie apart in the finger.

    Args:
        finger: the whole finger.
        path: of the PNG file; None for the figure alone.
    """
    with style.look():
        figure = style.figure(5.0)
        ratios = [*(1.0 for _ in finger.states), _WIDER]
        axes = figure.subplots(1, len(ratios), width_ratios=ratios, squeeze=False)[0]
        widest = max(float(each.columns["gross_width"].max(initial=0)) for each in finger.states.values())
        longest = max(float(np.abs(each.z).max(initial=0)) for each in finger.states.values())
        middle, half, end = 0.0, 0.55 * _MM * widest, 1.1 * _MM * longest
        for axis, head, (name, total) in zip(axes, finger.heads(), finger.states.items(), strict=False):
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
        figure.suptitle(f"Whole finger under {finger.f_ext:.3g} N, as a sum of slices")
        return style.save(figure, path)
