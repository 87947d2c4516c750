"""The picture of a whole finger's footprint: gross outline and ridge contact over the finger, slice by slice."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from fingerpad.io import style
from fingerpad.slices.finger import WholeFinger

_MM = 1e3


def footprint(finger: WholeFinger, path: Path | None = None) -> Figure:
    """Draw the outline of each state in contact and the mean contact pressure along the finger.

    A state's title has its colour. The gross width of a slice is drawn about its middle, where sliding shifts it; the
    darker band is the part of it that touches, all ridges of a slice side by side.

    Args:
        finger: the whole finger.
        path: of the PNG file; None for the figure alone.
    """
    with style.look():
        figure = style.figure(4.6)
        axes = figure.subplots(1, len(finger.states) + 1, width_ratios=[1] * len(finger.states) + [1.2], squeeze=False)[
            0
        ]
        widest = max(float(each.columns["gross_width"].max(initial=0)) for each in finger.states.values())
        longest = max(float(np.abs(each.z).max(initial=0)) for each in finger.states.values())
        middle = 0.0
        for axis, head, (name, total) in zip(axes, finger.heads(), finger.states.items(), strict=False):
            z, colour = _MM * total.z, style.STATE[name]
            gross, touching = (_MM * total.columns[key] / 2 for key in ("gross_width", "contact_length"))
            axis.fill_betweenx(z, -gross, gross, color=colour, alpha=0.25, lw=0)
            axis.fill_betweenx(z, -touching, touching, color=colour, lw=0)
            area, ridges = (1e6 * total.totals[key] for key in ("gross_area", "contact_area"))
            words = head.replace(" normal", "\nnormal")
            axis.set_title(f"{words}\n{area:.1f} mm² gross,\nridges {ridges:.2f} mm²", color=colour)
            half, end = 0.55 * _MM * widest, 1.1 * _MM * longest
            axis.set(xlim=(-half, half), ylim=(-end, end), xlabel="x (mm)")
            axis.set_aspect("equal")
            axes[-1].plot(total.pressure / 1e3, z, color=colour)
            middle = max(middle, float(total.pressure[len(z) // 2]) / 1e3 if len(z) else 0.0)
        axes[0].set_ylabel("z along the finger (mm)")
        axes[-1].set(xlabel="mean contact pressure (kPa)", xlim=(0, 1.3 * middle or None), title="Along the finger")
        figure.suptitle(f"Whole finger under {finger.f_ext:.3g} N, as a sum of slices")
        return style.save(figure, path)
