"""The runs that are made for this page alone: an uncharged finger pressed, with other skin and other friction."""

from typing import Any

from benchmarks.runs import plain
from fingerpad.scene import Scene

FORCE = 75.0  # N/m
SIZES = (40e-6, 20e-6)  # m, contact sizes; the difference of their numbers is the stated error
SOFTER = (2.0, 4.0)  # times, by which the stratum corneum is softened; not fitted
ROUGHER = 1.0  # friction coefficient beside the default of 0.25


def name(kind: str, size: float) -> str:
    """Return the name of a scene by its kind and contact size (m): ``dry 20``, ``soft 4 20``, ``rough 20``."""
    return f"{kind} {size * 1e6:.0f}"


def scenes() -> dict[str, Scene]:
    """Return the scenes by :func:`name`."""
    kinds: dict[str, dict[str, Any]] = {"dry": {}, "rough": {"friction": ROUGHER}}
    for softer in SOFTER:
        shear = Scene().materials.stratum_corneum.shear_modulus / softer
        kinds[f"soft {softer:g}"] = {"materials": {"stratum_corneum": {"shear_modulus": shear}}}
    return {name(kind, size): _pressed(size, more) for size in SIZES for kind, more in kinds.items()}


def _pressed(size: float, more: dict[str, Any]) -> Scene:
    mesh = {"contact": size, "receptor": size, "interface": 120e-6, "growth": 0.5}
    output = {"receptors": False, "errors": False}
    return plain({"history": [{"name": "press", "f_ext": FORCE}], "mesh": mesh, "output": output} | more)
