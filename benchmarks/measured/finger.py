"""The whole finger as a sum of slices over the force (N): its gross area is what a camera sees as apparent area.

The traces are those of docs/models.json, by :mod:`benchmarks.newtons`. The default radius along the axis scales forces
and areas alike; so ratios and shapes are compared, and no absolute force.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import newtons
from fingerpad.scene.slices import Slices
from fingerpad.slices.total import at_force

Array = NDArray[np.float64]
NEWTONS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.2)  # N; the traces end at some 1.3 N
HIGH = 200.0  # V
STATES = (("charged", 0.0), ("charged", HIGH), ("full_slip", 0.0), ("full_slip", HIGH))
Sums = Mapping[str, Array]
"""``gross_area``, ``contact_area`` (m²) and ``depth`` (m) at :data:`NEWTONS`, as ``charged_0_gross_area``."""


def sums(known: Mapping[str, Any], model: str) -> Sums:
    """Return the sums of a model, ``full`` or ``smooth``, from the numbers of docs/models.json."""
    found = dict[str, Array]()
    for state, voltage in STATES:
        trace = newtons.kept(known["scenes"], model, voltage, state)
        totals = [at_force(newtons.finger(), trace, force, Slices().count) for force in NEWTONS]
        for name in ("gross_area", "contact_area"):
            found[f"{state}_{voltage:g}_{name}"] = np.array([total.totals[name] for total in totals])
        found[f"{state}_{voltage:g}_depth"] = np.array([total.delta for total in totals])
    return found
