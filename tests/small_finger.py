"""Run a script with a small finger in the place of the default one: python3 tests/small_finger.py SCRIPT [ARG ...]

The script's lines stay as they are.
"""

import runpy
import sys
from pathlib import Path
from typing import Any

import fingerpad
from fingerpad.scene import Scene, load

SMALL = Path(__file__).parents[1] / "demos" / "scenes" / "small_finger.toml"
NINE = {
    "geometry": {"ridge_count": 9},
    "mesh": {"contact": 40e-6, "receptor": 100e-6, "interface": 200e-6, "growth": 1.0, "touching_half_arc": 1.0e-3},
}
"""Keys of a finger of nine ridges, of which five can touch, that runs in a second."""
LIGHTER = 1.0 / 75.0  # of the loads: 1 N/m on the small finger for 75 N/m on the default one


def small(f_ext: float = 75.0, voltage: float = 200.0, force: str | None = None, **values: Any) -> Scene:
    """Return the scene on the small finger, under a lighter load and half of the voltage."""
    load_of = {"f_ext": f_ext * LIGHTER} if force is None else {"force": "0.01 N"}
    return load(SMALL).replace(**load_of, voltage=voltage / 2, **values)


def default(scene: Scene, *args: Any, **more: Any) -> fingerpad.Sweep:
    """Return a sweep of the default finger: the closed form is made for it."""
    return SWEEP(Scene(force="0.5 N") if scene.force else Scene(), *args, **more)


def beside(scene: Scene, *args: Any, out: str | None = None, **more: Any) -> fingerpad.Result:
    """Run a scene into a folder beside that of the script, which may hold the default finger."""
    return RUN(scene, *args, out=None if out is None else f"{out}_small", **more)


RUN, SWEEP = fingerpad.run, fingerpad.sweep
if __name__ == "__main__":
    fingerpad.Scene, fingerpad.run, fingerpad.sweep = small, beside, default  # type: ignore[misc,assignment]
    sys.argv = sys.argv[1:]
    runpy.run_path(sys.argv[0], run_name="__main__")
