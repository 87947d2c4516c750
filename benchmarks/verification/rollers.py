r"""The width of a roller that is pressed on the screen.

The roller is a half-space's pad of radius R,

.. math:: 2a = 4 \sqrt{f R / \pi E^*}

(Hertz 1882; Johnson, Contact Mechanics, 1985, sec. 4.2(c), doi 10.1017/CBO9781139171731), by the body of a user's own,
:class:`fingerpad.Body`, at three forces.
"""

import numpy as np
from mpi4py import MPI

import fingerpad as fp
from benchmarks.verification.case import Case, Row
from geometry.bodies import pad

_YOUNG, _NU, _RADIUS = 1e6, 0.3, 1.0


def roller(small: bool) -> list[Row]:
    """Width of contact of a roller at three forces, each with the same body."""
    half, facets = 0.5e-3, 10 if small else 40
    size, e_star = half / (facets + 0.5), _YOUNG / (1 - _NU**2)
    shape, contact = pad(size, int(np.ceil(1.5 * facets)), _RADIUS, 50 * half), fp.Penalty(100 * _YOUNG / size)
    solid, comm = fp.SaintVenant(_YOUNG, _NU), MPI.COMM_SELF
    body = fp.Body(shape, solid, contact=contact, touch_depth=0.5e-6, step_scale=7.5, comm=comm)
    rows, why = [], "half a facet at either edge"
    for part in (0.5, 1.0, 1.3):
        force = np.pi * e_star * (part * half) ** 2 / (4 * _RADIUS)
        body.press(force)
        width, exact = 1e3 * body.state.contact_length, 4e3 * np.sqrt(force * _RADIUS / (np.pi * e_star))
        mesh = f"P2, facets of {1e6 * size:.3g} µm"
        rows.append(Row(f"width at {force:.3g} N/m (mm)", width, exact, 1e3 * size, why, mesh, absolute=True))
    return rows


CASES = (Case("Roller's width", "Hertz 1882, in Johnson, Contact Mechanics, 1985, sec. 4.2(c)", roller),)
