"""Which ridges are meshed to touch the screen, where a scene does not give their number: a rule of thumb.

Ridges in contact grow with the force to the power 0.27 in full runs of the default finger, and friction rolls the
finger onto its leading side. At 75 N/m and a friction coefficient of 0.25 ten ridges on either side can touch; full
runs need nine. The width of the contact zone is a length, and so a finger of narrower ridges has more of them in it.
A bone that is lowered by a depth d brings down the skin within sqrt(2 R d) of the lowest ridge, R the radius of the
outline.

The rule has at least one ridge to spare in every full run of ``tests/reach.json``. What the rule misses on other
fingers costs a restart: :mod:`fingerpad.model.contact_zone` checks each accepted step.
"""

import math
from typing import TYPE_CHECKING

from geometry.parameters import Fingertip

if TYPE_CHECKING:
    from fingerpad.scene import Scene

_RIDGES, _FORCE, _FRICTION = 10, 75.0, 0.25  # on either side, at a force (N/m) and a friction coefficient
_WIDENS, _ROLLS = 0.27, 0.3  # powers of the force and of a larger friction coefficient
_LEAST = 2  # ridges on either side
_PRESSURE = 30e3  # Pa, mean contact pressure of ridges, at which a friction law other than Coulomb's is evaluated


def by_rule(scene: "Scene") -> "Scene":
    """Return the scene with a ``mesh.touching_half_arc``, by the rule of thumb where it gives none."""
    if scene.mesh.touching_half_arc is not None:
        return scene
    finger, law = scene.geometry, scene.friction_law()
    force = max((load.f_ext for load in scene.loads() if load.f_ext), default=0.0)
    depth = max((-load.bone_height for load in scene.loads() if load.bone_height), default=0.0)
    ridges = _RIDGES * Fingertip().ridge_wavelength / finger.ridge_wavelength * (force / _FORCE) ** _WIDENS
    radius = finger.width**2 / (2 * finger.height)
    lowered = math.sqrt(2 * radius * max(depth, 0.0)) / finger.ridge_wavelength
    friction = 0.0 if law is None else law.coefficient(_PRESSURE)
    last = math.ceil(max(ridges, lowered, _LEAST) * max(friction / _FRICTION, 1.0) ** _ROLLS)
    half_arc = min(last, max(finger.ridge_count // 2, 1)) * finger.ridge_wavelength
    return scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"touching_half_arc": half_arc})})
