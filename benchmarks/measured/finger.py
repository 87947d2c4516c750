"""The whole finger as a sum of slices over the force (N): its gross area is what a camera sees as apparent area.

The traces are those of docs/models.json, by :mod:`benchmarks.newtons`. The default radius along the axis scales forces
and areas alike; so ratios and shapes are compared, and no absolute force.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import newtons
from benchmarks.runs import VOLTAGES
from fingerpad.scene import Scene
from fingerpad.scene.parameters import Slices
from fingerpad.slices.total import at_force
from fingerpad.slices.trace import trace

Array = NDArray[np.float64]
NEWTONS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.2)  # N; the traces end at some 1.3 N
HIGH = 200.0  # V
STATES = (("charged", 0.0), ("charged", HIGH), ("full_slip", 0.0), ("full_slip", HIGH))
Sums = Mapping[str, Array]
"""``gross_area``, ``contact_area`` (m²) and ``depth`` (m) at :data:`NEWTONS`, as ``charged_0_gross_area``."""


def sums(known: Mapping[str, Any], fine: Mapping[str, Array] | None = None) -> Sums:
    """Return the sums of the full model.

    Args:
        known: numbers of docs/models.json.
        fine: contact lengths and counts of ridges on another mesh, ``charged_contact_length`` and so on, of shape
            (forces, voltages), in place of those; indentations are then those of ``known``.
    """
    found = dict[str, Array]()
    for state, voltage in STATES:
        points = newtons.states(known["scenes"], "full", voltage, state)
        if fine is not None:
            at = VOLTAGES.index(voltage)
            other = (fine[f"{state}_{key}"][:, at] for key in ("contact_length", "ridges_in_contact"))
            points = [
                replace(point, contact_length=float(length), ridges_in_contact=int(ridges))
                for point, length, ridges in zip(points, *other, strict=True)
            ]
        traced = trace(points, Scene().geometry.ridge_wavelength)
        totals = [at_force(newtons.finger(), traced, force, Slices().count) for force in NEWTONS]
        for name in ("gross_area", "contact_area"):
            found[f"{state}_{voltage:g}_{name}"] = np.array([total.totals[name] for total in totals])
        found[f"{state}_{voltage:g}_depth"] = np.array([total.delta for total in totals])
    return found
