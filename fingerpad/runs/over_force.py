"""The axis ``force`` of a sweep: forces on the whole finger, which are no key of a scene."""

from collections.abc import Mapping, Sequence
from typing import Any

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
