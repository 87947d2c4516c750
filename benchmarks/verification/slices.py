r"""A whole finger as a sum of slices: Johnson's elastic foundation, level and tilted.

A paraboloid of radii R_x and R_z on a foundation that bears k per depth has the contact of the plane's cut through it,
an ellipse of semi-axes a and b (Johnson, Contact Mechanics, 1985, sec. 4.3, doi 10.1017/CBO9781139171731):

.. math:: a = \sqrt{2 R_x \delta}, \quad b = \sqrt{2 R_z \delta}, \qquad F = \tfrac12 \pi k a b\, \delta, \qquad
          A = \pi a b.

A slice bears :math:`\frac23 k\, 2a\, \delta`. A sphere is the same at any tilt.
"""

import numpy as np

from benchmarks.verification.case import Case, Row
from fingerpad.scene.parameters import Slices
from fingerpad.slices.total import at_indentation, profile
from fingerpad.slices.trace import Trace

_R_X, _R_Z, _K, _DEPTH, _TILT = 7e-3, 28e-3, 1e7, 0.8e-3, 0.5
_PARTS = 48


def _trace() -> Trace:
    depth = np.geomspace(2e-6, 2e-3, 24, dtype=np.float64)
    width = 2 * np.sqrt(2 * _R_X * depth)
    force = 2 / 3 * _K * width * depth
    return Trace(
        depth,
        {
            "f_ext": force,
            "f_t": 0.3 * force,
            "f_electrostatic": 0 * force,
            "contact_length": width / 3,
            "gross_width": width,
        },
    )


def foundation(small: bool) -> list[Row]:
    """Force and gross area of the sum; of a sphere, level and tilted."""
    a, b = (np.sqrt(2 * radius * _DEPTH) for radius in (_R_X, _R_Z))
    force, area = np.pi / 2 * _K * a * b * _DEPTH, np.pi * a * b
    why, mesh = "the rule's error at an edge whose width begins as a root", f"{_PARTS} slices"
    found, level, tilted = (
        at_indentation(profile(each), _trace(), _DEPTH, _PARTS)
        for each in (
            Slices(radius=_R_Z),
            Slices(radius=_R_X, length=2 * _R_X, shape="ellipsoid"),
            Slices(radius=_R_X, length=2 * _R_X, shape="ellipsoid", tilt=_TILT),
        )
    )
    rows = [("force (N)", "f_ext", 1.0), ("gross area (mm²)", "gross_area", 1e6)]
    known = zip(rows, (force, area), strict=True)
    return [
        *(Row(name, c * found.totals[key], c * of, 1e-6, why, mesh) for (name, key, c), of in known),
        *(
            Row(f"{name}, sphere tilted by {_TILT:g}", c * tilted.totals[key], c * level.totals[key], 1e-9, why, mesh)
            for name, key, c in rows
        ),
    ]


CASES = (Case("Sum of slices on a foundation", "Johnson, Contact Mechanics, 1985, sec. 4.3", foundation),)
