"""Traces of a model without a path: states at fixed forces, so that a sum does not depend on the way to it."""

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from fingerpad.results.quantities import Output
from fingerpad.scene import Scene
from fingerpad.slices.trace import Trace, refuse_floating, trace
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.reduced.model import Model
    from fingerpad.results.result import Result

LIGHT = 1 / 30
"""Force under which a finger is charged, and slid to full slip, over the largest of its trace."""
PER_OCTAVE = 2
"""Points of a trace of a model without a path in each doubling of the force."""


def of_points(
    scene: Scene,
    model: "Model",
    solve: "Callable[[Scene], Result]",
    name: str,
    expected: float,
    top: float,
    outputs: Iterable[Output] = (),
) -> tuple[Trace, list[ContactState]]:
    """Return a trace of a model without a path, and its states; refuse states without a bone.

    Args:
        scene: without a force on the whole finger.
        model: that solves.
        solve: solves a scene by it.
        name: of the state.
        expected: force (N/m) at the centre of the finger, about.
        top: force (N/m) that the trace is to reach.
        outputs: of one's own, that are summed.
    """
    kind = "full_slip" if name == "full_slip" else "charged"
    scene = scene.model_copy(update={"voltage": 0.0}) if name == "uncharged" else scene
    found = model.over_forces(scene, grid(expected, top), kind, solve)
    refuse_floating(found, model.name)
    return trace(found, scene.geometry.ridge_wavelength, outputs=outputs), found


def grid(expected: float, top: float) -> list[float]:
    """Return the forces (N/m) of a trace: powers of two and between them, from a light one to the second beyond a top.

    A monotone cubic takes its slopes from its neighbours, so that more points do not change it up to the top.

    Args:
        expected: force at the centre of the finger, about, which is :data:`LIGHT` times that at the start.
        top: force that the trace is to reach.
    """
    first = round(math.log2(expected * LIGHT)) * PER_OCTAVE
    last = max(math.ceil(math.log2(top) * PER_OCTAVE) + 1, first + 3)
    return [2.0 ** (k / PER_OCTAVE) for k in range(first, last + 1)]
