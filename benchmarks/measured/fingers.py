"""The fingers of this page: some pressed for it alone, and the whole finger as a sum of slices over the force (N).

The pressed ones are uncharged, with other skin and other friction. The gross area of the whole finger is what a camera
sees as apparent area. Its traces are those of docs/models.json, by :mod:`benchmarks.newtons`. The default radius along
the axis scales forces and areas alike; so ratios and shapes are compared, and no absolute force.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from benchmarks import newtons
from benchmarks.runs import VOLTAGES, plain
from fingerpad.scene import Scene
from fingerpad.scene.parameters import Slices
from fingerpad.slices.total import at_force
from fingerpad.slices.trace import trace
from variational.roughness.bam import BearingArea
from variational.roughness.boundary_elements import BoundaryElements
from variational.state import ContactState

FORCE = 75.0  # N/m
SIZES = (40e-6, 20e-6)  # m, contact sizes; the difference of their numbers is the stated error
SOFTER = (2.0, 4.0)  # times, by which the stratum corneum is softened; not fitted
ROUGHER = 1.0  # friction coefficient beside the default of 0.25
FLAT = (1, -0.625, 0.27778, -0.08333, 0.01515, -0.00126)  # -sin(t/2)^12, a tip that is flat over half a ridge


def name(kind: str, size: float) -> str:
    """Return the name of a scene by its kind and contact size (m): ``dry 20``, ``soft 4 20``, ``rough 20``."""
    return f"{kind} {size * 1e6:.0f}"


def scenes() -> dict[str, Scene]:
    """Return the scenes by :func:`name`."""
    kinds: dict[str, dict[str, Any]] = {"dry": {}, "rough": {"friction": ROUGHER}}
    for softer in SOFTER:
        shear = Scene().materials.stratum_corneum.shear_modulus / softer
        kinds[f"soft {softer:g}"] = {"materials": {"stratum_corneum": {"shear_modulus": shear}}}
    kinds["flat"] = {"geometry": {"ridge_profile": FLAT}}
    return {name(kind, size): pressed(size, more) for size in SIZES for kind, more in kinds.items()}


def pressed(size: float, more: dict[str, Any]) -> Scene:
    """Return the default finger pressed by :data:`FORCE`, with a contact size (m) and other keys."""
    mesh = {"contact": size, "receptor": size, "interface": 120e-6, "growth": 0.5}
    output = {"receptors": False, "errors": False}
    return plain({"history": [{"name": "press", "f_ext": FORCE}], "mesh": mesh, "output": output} | more)


def gross(run: Mapping[str, Any]) -> float:
    """Return the width (m) between the outer edges of the outermost touching ridges."""
    return float((run["ridges"] - 1) * Scene().geometry.ridge_wavelength + run["length"] / run["ridges"])


# -- whole fingers ---------------------------------------------------------------------------------------------
Array = NDArray[np.float64]
NEWTONS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.2)  # N; the traces end at some 1.3 N
HIGH = 200.0  # V
STATES = (("charged", 0.0), ("charged", HIGH), *(("full_slip", voltage) for voltage in VOLTAGES))
Sums = Mapping[str, Array]
"""``gross_area``, ``contact_area``, ``exact_area``, ``bearing_area`` (m²) and ``depth`` (m) at :data:`NEWTONS`, as
``charged_0_gross_area``: gross contact, that of the ridges, and that of asperities on them by two closures."""
CLOSURES: dict[str, BearingArea | BoundaryElements] = {
    "exact": BoundaryElements(Scene().h_0),
    "bearing": BearingArea(Scene().h_0),
}
"""Closures that give the area of asperities at the pressures of the runs, whose own one is the second."""


def asperities(closure: str, contact_length: ArrayLike, f_contact: ArrayLike) -> Array:
    """Return the length (m) of asperities in contact, by the mean pressure over the ridges' contact.

    Args:
        closure: a name of :data:`CLOSURES`.
        contact_length: of the ridges (m).
        f_contact: contact force per length (N/m), of the same shape.
    """
    law, length = CLOSURES[closure], np.asarray(contact_length, dtype=float)
    return length * law.statistics(np.clip(np.asarray(f_contact) / length, *law.pressures)).area


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
        for closure in CLOSURES:
            real = [
                replace(point, contact_length=float(asperities(closure, point.contact_length, _contact(point))))
                for point in points
            ]
            of_real = trace(real, Scene().geometry.ridge_wavelength)
            areas = [at_force(newtons.finger(), of_real, force, Slices().count) for force in NEWTONS]
            found[f"{state}_{voltage:g}_{closure}_area"] = np.array([total.totals["contact_area"] for total in areas])
        traced = trace(points, Scene().geometry.ridge_wavelength)
        totals = [at_force(newtons.finger(), traced, force, Slices().count) for force in NEWTONS]
        for name in ("gross_area", "contact_area"):
            found[f"{state}_{voltage:g}_{name}"] = np.array([total.totals[name] for total in totals])
        found[f"{state}_{voltage:g}_depth"] = np.array([total.delta for total in totals])
    return found


def _contact(point: ContactState) -> float:
    """Return what the screen bears (N/m)."""
    return point.f_ext + (point.f_electrostatic if point.voltage else 0.0)
