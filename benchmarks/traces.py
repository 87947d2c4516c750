"""Scenes shared by studies: press, charge and slide the default finger over forces and voltages."""

from typing import Any

from fingerpad.model.touching import by_rule
from fingerpad.scene import Scene, from_data

VOLTAGES = (0.0, 50.0, 100.0, 150.0, 200.0)
FORCES = (5.0, 10.0, 25.0, 50.0, 75.0, 100.0, 120.0, 150.0)  # N/m
SITES = 20e-6  # m, size at the Merkel sites: coarser than the default of 5 um; energy densities come out 12 % low


def trace(f_ext: float, voltage: float, size: float, **more: Any) -> Scene:
    """Return the scene of one trace; all traces of one force have the same mesh.

    Args:
        f_ext: external force (N/m).
        voltage: amplitude (V).
        size: contact size (m).
        more: other tables of the scene.
    """
    mesh = {"contact": size, "receptor": SITES}
    return by_rule(from_data({"f_ext": f_ext, "voltage": voltage, "mesh": mesh} | more))
