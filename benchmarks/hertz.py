"""Hertz's line contact on meshes of halved size: a contact length whose error is known.

The cylinder of benchmarks/verification/normal_contact.py, pressed to half-widths that end anywhere in a facet. Its
contact has two edges, mirror images of one another; a finger's has some thirty. An edge moves facet by facet: near an
edge the pressure falls with the root of the distance, so that the facet is the only length there.
"""

import itertools
from collections.abc import Iterator

import numpy as np

from benchmarks.calibration import HERTZ, Case
from benchmarks.verification.normal_contact import E_STAR, HALF_WIDTH, RADIUS, SPAN, press
from fingerpad.richardson import MeshParameter
from geometry.bodies import pad

HALF_WIDTHS = tuple(part * HALF_WIDTH for part in (0.817, 0.893, 0.961, 1.049, 1.137))
FACETS = (5, 10, 20, 40)  # to HALF_WIDTH
BAR = (HALF_WIDTH / SPAN) ** 2  # relative: the body is a block, not a half-space
_REACH = 1.4  # of the facets that can touch, over HALF_WIDTH


def contact_length(a: float, facets: int) -> float:
    """Return the length in contact (m), 2a by Hertz, with ``facets`` facets to :data:`HALF_WIDTH`."""
    size, force = HALF_WIDTH / facets, np.pi * E_STAR * a**2 / (4 * RADIUS)
    run = press(pad(size, int(np.ceil(_REACH * facets)), RADIUS, SPAN), "penalty", size, force)
    return float(run.observer.ridge_loads(run.surface_state).length[0])


def cases() -> Iterator[Case]:
    """Yield the cases; a minute of computation."""
    name = "contact_length"
    for a in HALF_WIDTHS:
        found, parameter = [contact_length(a, facets) for facets in FACETS], MeshParameter()
        for k, (coarse, fine) in enumerate(itertools.pairwise(found), start=1):
            parameter.record({name: coarse}, {name: fine})
            scene = f"half-width {1e3 * a:.3f} mm, {a / HALF_WIDTH * FACETS[k]:.1f} facets"
            estimate, error = (100 / (2 * a) * value for value in (parameter.share(name), abs(fine - 2 * a)))
            yield Case(HERTZ, scene, "contact length", k == 1, estimate, error, 100 * BAR)
