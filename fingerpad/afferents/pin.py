r"""A flat pin on the skin: the stimulus of the laws that were fitted to indentations, as a stress at the receptor.

A rigid pin of radius a indents an elastic half-space by y with the force P = 2 a E y / (1 - nu^2). On its axis, at the
depth z, the vertical stress is

.. math:: \sigma = \frac{P}{2 \pi a^2} \, \frac{1 + 3 (z/a)^2}{(1 + (z/a)^2)^2} .

I. N. Sneddon (1946), Proc. Camb. Phil. Soc. 42, 29. E = 0.05 MPa and nu = 0.4 are those of Saal et al. (2017), doi
10.1073/pnas.1704856114, as the depths of the receptors, which are fitted and no anatomy.
"""

import math

E, NU = 0.05e6, 0.4
"""Modulus (Pa) and Poisson's ratio of the half-space."""
DEPTH = {"SA1": 0.3e-3, "RA1": 1.6e-3, "PC": 2.0e-3}
"""Depth of the receptors by class (m)."""
RADIUS = 1e-3
"""Radius of the pin (m)."""


def force(indentation: float, radius: float = RADIUS) -> float:
    """Return the force (N) on a pin of a radius (m) at an indentation (m)."""
    return 2 * radius * E * indentation / (1 - NU**2)


def stress(indentation: float, depth: float, radius: float = RADIUS) -> float:
    """Return the vertical stress (Pa, positive in compression) on the axis of a pin, at a depth (m)."""
    z = depth / radius
    return force(indentation, radius) / (2 * math.pi * radius**2) * (1 + 3 * z**2) / (1 + z**2) ** 2


def indentation_per_stress(name: str) -> float:
    """Return by how much (m/Pa) a pin of 1 mm radius indents for the stress at the depth of a class."""
    return 1 / stress(1.0, DEPTH[name])
