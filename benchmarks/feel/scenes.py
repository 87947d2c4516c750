"""The runs of the page on what is felt: the default finger on a coarse mesh, a small one for gratings."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import fingerpad as fp
from fingerpad.scene import Scene
from fingerpad.scene import load as load_scene

LOADS = (25.0, 75.0, 150.0)  # N/m
LOAD, VOLTS = 75.0, 200.0  # N/m, V
PRESS, HOLD, SPEED = 0.04, 0.3, 20e-3  # s, s, m/s
RISE, FALL, STEP, LAST = 0.02, 0.07, 0.01, 0.12  # s: when a voltage rises and falls, in what time, and the end
RELAXED, SLOW = 5.0, 2e-3  # s, m/s: viscous skin relaxes held, and in a slow slide, before the voltage rises
SOFT = ("subcutis", "dermis", "viable_epidermis", "stratum_corneum")
VISCOSITY = "fingerpad"  # preset of the soft layers
PERIODS, GRATING_LOADS, GRATING_SPEED = (1.0e-3, 2.5e-3), (4.0, 10.0), 50e-3  # m, N/m, m/s
SMALL = Path(__file__).parents[2] / "demos" / "scenes" / "small_finger.toml"
_GRATINGS = 3  # periods of a grating that are passed
_COARSE: dict[str, Any] = {
    "mesh": {"contact": 20e-6, "receptor": 20e-6, "growth": 0.5},
    "numerics": {"step_scale": 0.5},
    "output": {"errors": False, "receptors": True},
}
_SLIDE = {"name": "slide", "bone_x": 2.5e-3, "until_full_slip": True}


def _scene(*loads: Mapping[str, Any], **more: Any) -> Scene:
    return Scene(**_COARSE, history=[dict(load) for load in loads], **more)


def _press(f_ext: float, seconds: float | None = None) -> dict[str, Any]:
    return {"name": "press", "f_ext": f_ext} | ({} if seconds is None else {"duration": seconds})


def onset() -> Scene:
    """A press, a hold, and the onset of sliding without voltage."""
    hold, slide = {"name": "hold", "bone_x_by": 0.0, "duration": HOLD}, {"bone_x": 1.2e-3, "speed": SPEED}
    return _scene(_press(LOAD, PRESS), hold, {"name": "slide"} | slide)


def step(f_ext: float, preset: str | None = None) -> Scene:
    """A voltage that rises, stays and falls while the finger slides under a load (N/m).

    Args:
        f_ext: the load.
        preset: of the viscosity of the soft layers, which relax before the voltage rises; elastic without it.
    """
    times = [0.0, RISE, RISE + STEP, FALL, FALL + STEP, LAST]
    table = {"waveform": "file", "times": times, "voltages": [0.0, 0.0, VOLTS, VOLTS, 0.0, 0.0]}
    last = {"name": "step", "bone_x_by": SPEED * LAST, "voltage": table}
    if preset is None:
        return _scene(_press(f_ext), _SLIDE, last)
    hold = {"name": "hold", "bone_x_by": 0.0, "duration": RELAXED}
    settle = {"name": "settle", "bone_x_by": SLOW * RELAXED, "duration": RELAXED}
    materials = {layer: {"viscosity": {"preset": preset}} for layer in SOFT}
    return _scene(_press(f_ext, PRESS), hold, _SLIDE | {"speed": SPEED}, settle, last, materials=materials)


def grating(f_ext: float, period: float) -> Scene:
    """A virtual grating on the small finger: the voltage is on in half of each period (m), under a load (N/m)."""
    frequency = GRATING_SPEED / period
    wave = {"waveform": "square", "amplitude": VOLTS / 2, "offset": VOLTS / 2, "frequency": frequency}
    load = {"name": "grating", "bone_x_by": _GRATINGS * period, "duration": _GRATINGS / frequency, "voltage": wave}
    loads = [_press(f_ext), _SLIDE | {"bone_x": 1.5e-3}, load]
    return load_scene(SMALL).replace(history=loads, **_COARSE | {"mesh": {"contact": 40e-6}})


def charged(volts: float, friction: float) -> Scene:
    """A press, a wait in which a voltage may be switched on, and the onset of sliding."""
    wait = {"name": "wait", "bone_x_by": 0.0, "voltage": volts, "duration": 0.02}
    slide = {"name": "slide", "bone_x": 2.5e-3, "speed": 2 * SPEED}
    return _scene(_press(LOAD, PRESS), wait, slide, friction=friction)


def run(name: str, scene: Scene, folder: Path) -> fp.Result:
    """Return the result of a scene, which is kept in a folder of its name; one of another scene there is refused."""
    from fingerpad.runs.context import finished  # finite elements

    place = folder / name
    ready = finished(scene, place) is not None
    print(f"{name}: {'kept' if ready else 'running'} in {place}", flush=True)
    found = fp.Result.load(place) if ready else fp.run(scene, out=place)
    if found.failure or found.interrupted:
        raise SystemExit(f"{name}: {found.failure or found.interrupted}")
    return found
