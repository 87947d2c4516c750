"""A sweep over the force in newtons: each scene is traced once, to the largest force, and read at the others."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fingerpad.io.result import Result
from fingerpad.runs.sweep_columns import FORCE
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.messages import show
from fingerpad.slices import traces
from fingerpad.slices.force import newtons


def forces(axes: Mapping[str, Sequence[Any]], scenes: Sequence[Scene]) -> tuple[float, ...]:
    """Return the forces of a sweep (N); none where it is not over the force.

    Args:
        axes: values by key as they were given.
        scenes: of the other axes.

    Raises:
        SceneError: no force, one given twice, forces in N and in N/m, or a scene that has no whole finger.
    """
    if FORCE not in axes:
        return ()
    if "f_ext" in axes:
        raise SceneError("the sweep is over force, in N, and over f_ext, in N/m; give one of the two")
    found = tuple(newtons(value) for value in axes[FORCE])
    if len(set(found)) < len(found):
        raise SceneError(f"{FORCE} of the sweep is {show(axes[FORCE])}; each value must be there once")
    for scene in scenes:
        traces.refuse(scene)
    return found


def at_each(found: Sequence[Result], values: Mapping[str, Sequence[Any]]) -> list[Result]:
    """Return the results of all points.

    Args:
        found: of the scenes under the largest force, the last axis fastest; see :func:`fingerpad.runs.solve.run`.
        values: of all axes, the force among them.
    """
    keys = list(values)
    shape = [len(values[key]) for key in keys]
    others = np.arange(len(found)).reshape([1 if key == FORCE else n for key, n in zip(keys, shape, strict=True)])
    forces_at = np.reshape(values[FORCE], [n if key == FORCE else 1 for key, n in zip(keys, shape, strict=True)])
    pairs = zip(np.broadcast_to(others, shape).ravel(), np.broadcast_to(forces_at, shape).ravel(), strict=True)
    return [_under(found[k], float(force)) for k, force in pairs]


def _under(result: Result, force: float) -> Result:
    """Return a result with its finger under another force, or with the reason why not."""
    if result.finger is None or force == result.finger.f_ext:
        return result
    try:
        return replace(result, finger=result.finger.under(force))
    except SceneError as error:
        return replace(result, finger=None, failure=str(error))
