"""The seeded scenes of people's loads, the forces of their traces, and the meshes of the full model."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from scipy.stats import qmc

from fingerpad.scene import Scene, from_data

Data = dict[str, Any]
Tasks = dict[str, tuple[int, list[tuple[Data, float]]]]
"""By name: the mesh, and scenes with a force of the section (N/m)."""
COUNT, SEED = 64, 2026
AXES = {  # key: ends in SI, and whether the sequence is even in the logarithm
    "force": (0.05, 3.0, True),
    "voltage": (0.0, 400.0, False),
    "friction": (0.1, 1.0, True),
    "electric.d_i": (0.1e-6, 10e-6, True),
    "electric.eps_i": (2.0, 30.0, True),
}
STEP, LIGHT = 3.0, (4.0, 8.0)  # ratio of two forces of a trace, at most, and its least force (N/m) on each mesh
BEYOND = 1.2  # largest force of a trace over the one expected at the centre
LIMIT = 60.0  # N/m: up to it a trace has the first mesh
FIRST, MOST, WORK = 30, 200, 1200  # factorisations: from the nearest neighbour, of a rung, before the last rung
LOWEST, RISE, LEAST_RISE = 60.0, 1.15, 1.03  # V, first rung, and ratios of two rungs at first and at last
_COARSE = {"receptor": 250e-6, "interface": 250e-6, "coarsest": 2e-3, "growth": 0.6}
MESHES: tuple[dict[str, float], ...] = (
    {"contact": 14e-6, "touching_half_arc": 4.8e-3} | _COARSE,
    {"contact": 20e-6, "touching_half_arc": 9e-3} | _COARSE,
)
DEFAULT = {"friction": 0.25, "electric.d_i": 1e-6, "electric.eps_i": 3.9}
CHECKED = tuple((f, u) for f in (5.0, 25.0, 50.0, 75.0, 150.0) for u in (100.0, 200.0))  # of docs/models.json
LADDER = (  # N/m, V and µ_0 of further starts
    ((12.0, 100.0, 0.25), (12.0, 200.0, 0.25), (40.0, 200.0, 0.25), (40.0, 300.0, 0.25), (12.0, 200.0, 0.5)),
    ((25.0, 100.0, 0.25), (25.0, 200.0, 0.25), (80.0, 200.0, 0.25), (80.0, 300.0, 0.25), (25.0, 200.0, 0.5)),
)
FAR = (150.0, 200.0, 280.0, 400.0)  # N/m, of the default finger without voltage


def scenes(seed: int = SEED, count: int = COUNT) -> list[Data]:
    """Return the values of the scenes by key, four digits each, in the order of the sequence."""
    places = qmc.Sobol(len(AXES), seed=seed).random(count)
    return [{key: _on(axis, x) for (key, axis), x in zip(AXES.items(), row, strict=True)} for row in places]


def _on(axis: tuple[float, float, bool], x: float) -> float:
    low, high, even = axis
    return float(f"{low * (high / low) ** x if even else low + (high - low) * x:.4g}")


def top(data: Data) -> float:
    """Return the largest force (N/m) of the trace of a scene."""
    return BEYOND * Scene(force=data["force"]).centre_force


def forces(data: Data) -> list[float]:
    """Return the forces (N/m) of the trace of a scene, four digits each."""
    most, light = top(data), LIGHT[mesh_of(data)]
    count = max(3, int(np.ceil(np.log(most / light) / np.log(STEP))) + 1)
    return [float(f"{each:.4g}") for each in np.geomspace(min(light, most / STEP**2), most, count)]


def mesh_of(data: Data) -> int:
    """Return which mesh the trace of a scene has."""
    return int(top(data) > LIMIT)


def section(data: Data, f_ext: float, **more: Any) -> Scene:
    """Return the section of a scene under a force (N/m)."""
    electric = {key.partition(".")[2]: value for key, value in data.items() if key.startswith("electric.")}
    loads = {"f_ext": f_ext, "voltage": data["voltage"], "friction": data["friction"], "electric": electric}
    return from_data(loads | more)


def meshed(data: Data, f_ext: float, which: int) -> Scene:
    """Return a section as the full model solves it."""
    return section(data, f_ext, mesh=MESHES[which], output={"errors": False, "receptors": False})


def checked(which: int) -> list[tuple[float, float]]:
    """Return the loads (N/m, V) of :data:`CHECKED` on a mesh."""
    return [each for each in CHECKED if (each[0] > LIMIT) == bool(which)]


def tasks() -> Tasks:
    """Return what is solved for, in this order."""
    found: Tasks = {}
    for which in range(len(MESHES)):
        found[f"mesh {which}"] = which, [({"voltage": u} | DEFAULT, f_ext) for f_ext, u in checked(which)]
    found["far"] = 1, [({"voltage": 0.0} | DEFAULT, f_ext) for f_ext in FAR]
    return found | of_scenes(scenes())


def of_scenes(every: Iterable[Data]) -> Tasks:
    """Return the tasks of scenes, those on the coarser mesh first."""
    some = sorted(enumerate(every), key=lambda each: -mesh_of(each[1]))
    return {f"scene {k}": (mesh_of(data), [(data, f_ext) for f_ext in forces(data)]) for k, data in some}
