"""The scenes that several studies run, and finished runs of them."""

from pathlib import Path
from typing import Any

from fingerpad.paper.run import Array as Array
from fingerpad.paper.run import Run as Run
from fingerpad.paper.scenes import FORCES as FORCES
from fingerpad.paper.scenes import VOLTAGES as VOLTAGES
from fingerpad.paper.scenes import plain as plain
from fingerpad.scene import Scene

SITES = 20e-6  # m, size at the Merkel sites: coarser than the default of 5 um; energy densities come out 12 % low


def trace(f_ext: float, voltage: float, size: float, **more: Any) -> Scene:
    """Return the default finger pressed (N/m), charged (V) and slid, with a contact size (m) and more of its tables."""
    return plain({"f_ext": f_ext, "voltage": voltage, "mesh": {"contact": size, "receptor": SITES}} | more)


def finished(scene: Scene, out: Path) -> Run | None:
    """Return a run that reached full slip, None where there is none."""
    try:
        run = Run(scene, out)
    except FileNotFoundError:
        return None
    return run if run.summary["full_slip"] else None
