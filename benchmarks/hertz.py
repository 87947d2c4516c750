"""Hertz's line contact on meshes that are halved: a contact length whose error is known exactly.

The cylinder of benchmarks/verification/normal_contact.py, pressed to half-widths that end anywhere in a facet. Its
length in contact has two edges, mirror images of one another, where the finger's has some thirty. How far each is off
depends on where in a facet it should be: near an edge the pressure falls with the root of the distance, which has no
length of its own, so that the facets' is the only one (the penalty's falls with it).
"""

import numpy as np
from numpy.typing import NDArray

from benchmarks.verification.normal_contact import E_STAR, HALF_WIDTH, NU, RADIUS, SPAN, YOUNG
from benchmarks.verification.over_screen import formulations, over_screen
from geometry.bodies import pad
from variational.materials.saint_venant import SaintVenant
from variational.problem import Interface
from variational.solvers.continuation import Target

Array = NDArray[np.float64]
HALF_WIDTHS = tuple(part * HALF_WIDTH for part in (0.817, 0.893, 0.961, 1.049, 1.137))
FACETS = (5, 10, 20, 40)  # to HALF_WIDTH
BAR = (HALF_WIDTH / SPAN) ** 2  # relative: the body is a block, not a half-space
PLACES = 12  # of an edge in a facet
_REACH = 1.4  # of the facets that can touch, over HALF_WIDTH


def contact_length(a: float, facets: int) -> float:
    """Return the length in contact (m), 2a by Hertz, with ``facets`` facets to :data:`HALF_WIDTH`."""
    size, force = HALF_WIDTH / facets, np.pi * E_STAR * a**2 / (4 * RADIUS)
    interface = Interface(formulations(YOUNG / size, 1e-11)["penalty"], 0.0, 1e-6)
    build = pad(size, int(np.ceil(_REACH * facets)), RADIUS, SPAN)
    run = over_screen(build, SaintVenant(YOUNG, NU), interface, force, touch_depth=0.5e-6, step_scale=15.0)
    run.run(Target("press", f_ext=force))
    return float(run.observer.ridge_loads(run.surface_state).length[0])


def places(facets: int) -> Array:
    """Return half-widths (m) about :data:`HALF_WIDTH` that end all over a facet, evenly; shape (PLACES,)."""
    return HALF_WIDTH + HALF_WIDTH / facets * (np.arange(PLACES) / PLACES - 0.5)


def edge_error(a: float, facets: int) -> float:
    """Return how far an edge of the contact is beyond its place, in lengths of a facet; negative if short of it."""
    return (contact_length(a, facets) / 2 - a) / (HALF_WIDTH / facets)
