"""The picture that opens the README: finger, one ridge with air gap and attraction, friction over voltage.

environment/run python3 -m benchmarks.hero FOLDER    keep the numbers of a default run's folder, then draw
environment/run python3 -m benchmarks.pages hero     draw from docs/hero.json, without a run
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from benchmarks.harness import DOCS, keep, kept, made
from fingerpad.io import style
from fingerpad.io.finger_picture import LAYER_COLOURS, interfaces
from fingerpad.io.result import Result
from geometry import tags

FORCES = (25, 75, 150)  # N/m, of the curves of friction
_MM, _UM, _KPA = 1e3, 1e6, 1e-3
_FINE = 0.02  # mm, between the points of a drawn outline


def main(folder: str) -> None:
    """Keep the numbers of a default run with those of docs/ladder.json, and draw."""
    run = Result.load(folder)
    assert run.full_slip is not None
    with np.load(Path(folder) / "finger_slide.npz") as a:
        xy, outlines = _MM * (a["x"] + a["u"]), []
        for tag in tags.LAYERS.values():
            edges = interfaces(a["triangles"][a["tag"] == tag], a["tag"][a["tag"] == tag])[1]
            outlines += [{"layer": int(tag), "points": _thinned(xy[loop])} for loop in _loops(edges)]
    with np.load(Path(folder) / "surface_slide.npz") as a:
        ridge = {name: a[f"end_{name}"][a["end_ridge"] == 0] for name in ("x", "y", "p", "p_el", "d_eq")}
    full = {
        f"{f}": [[u, r["3"]["summary"]["slip_mu_app"]] for u in range(0, 201, 50)]
        for f in FORCES
        for r in [kept("ladder").numbers[f"{f} N/m, {u} V"]]
    }
    numbers = {
        "finger": outlines,
        "ridge": {name: values.tolist() for name, values in ridge.items()},
        "friction": full,
        "full_slip": {"mu_app": run.full_slip.mu_app, "voltage": run.full_slip.voltage},
    }
    keep("hero", numbers, made())
    draw(DOCS)
