"""Scenes that nothing was tuned on: drawn once, from what fingers and screens may differ in.

Force, voltage and friction are drawn evenly from their ranges, everything else within a quarter of its default value; a
finger that cannot be built is drawn again.
"""

from typing import Any

import numpy as np

from fingerpad.model.check import check
from fingerpad.model.touching import by_rule
from fingerpad.scene import Scene, SceneError, from_data, start
from fingerpad.scene.parameters import Accuracy

SEED, COUNT = 2023, 10
_RANGES = {"f_ext": (10.0, 120.0), "voltage": (0.0, 200.0), "friction": (0.15, 0.5)}  # N/m, V
_QUARTER = (
    *("geometry.sc_thickness", "geometry.ridge_amplitude", "geometry.bone_width", "geometry.dermis_thickness"),
    *("materials.subcutis.shear_modulus", "materials.stratum_corneum.shear_modulus"),
    *("roughness.h_rms", "roughness.young", "electric.eps_sc"),
)


def _default(key: str) -> float:
    value: Any = Scene()
    for part in key.split("."):
        value = getattr(value, part)
    return float(value)


def scenes() -> dict[str, Scene]:
    """Return the scenes by number, force, voltage and friction."""
    random, found = np.random.default_rng(SEED), dict[str, Scene]()
    while len(found) < COUNT:
        drawn = {key: random.uniform(*span) for key, span in _RANGES.items()}
        drawn |= {key: _default(key) * random.uniform(0.75, 1.25) for key in _QUARTER}
        data: dict[str, Any] = {}
        for key, value in drawn.items():
            *tables, last = key.split(".")
            place = data
            for table in tables:
                place = place.setdefault(table, {})
            place[last] = float(f"{value:.3g}")
        scene = by_rule(from_data(data))
        try:
            check(scene)
        except SceneError:
            continue
        name = f"{len(found) + 1}: {scene.f_ext:g} N/m, {scene.voltage:g} V, friction {scene.friction:g}"
        found[name] = scene
    return found


def asked(scene: Scene, **tolerances: float) -> Scene:
    """Return a scene of which an accuracy is asked, on the coarse mesh that this starts from."""
    mesh = scene.mesh.model_copy(update=start(tolerances))
    return scene.model_copy(update={"accuracy": Accuracy(**tolerances), "mesh": mesh})
