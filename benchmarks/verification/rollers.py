r"""Curved facets: an arc meshed by parabolas, and the width of a roller that is pressed on the screen.

A quarter of a tube lies between two arcs. A parabola through both ends and the middle of a facet that spans the angle t
is off its arc by some t^4 / 384 of the radius. The roller is a half-space's pad of radius R,

.. math:: 2a = 4 \sqrt{f R / \pi E^*}

(Hertz 1882; Johnson, Contact Mechanics, 1985, sec. 4.2(c), doi 10.1017/CBO9781139171731), by the body of a user's own,
:class:`fingerpad.Body`, at three forces.
"""

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

import fingerpad as fp
from benchmarks.verification.case import Case, Row, order, order_row
from geometry.bodies import pad, quarter_tube
from geometry.mesh import load

_INNER, _OUTER = 1e-3, 2e-3  # m
_YOUNG, _NU, _RADIUS = 1e6, 0.3, 1.0


def _area(divisions: int) -> float:
    """Return the area (m²) of the meshed quarter of a tube."""
    mesh = load(MPI.COMM_SELF, quarter_tube(_INNER, _OUTER, divisions)).mesh
    return float(fem.assemble_scalar(fem.form(fem.Constant(mesh, 1.0) * ufl.Measure("dx", mesh))))


def arc(small: bool) -> list[Row]:
    """Area between two arcs, and how it converges."""
    divisions, exact = (4, 8) if small else (4, 8, 16), np.pi / 4 * (_OUTER**2 - _INNER**2)
    found = [_area(each) for each in divisions]
    angle = np.pi / 2 / divisions[-1]
    why, mesh = "the fourth power of the angle of a facet, over 180", f"{divisions[-1]} facets to each arc"
    observed = order([each / exact - 1 for each in found], divisions)
    return [
        Row("area between two arcs (mm²)", 1e6 * found[-1], 1e6 * exact, angle**4 / 180, why, mesh),
        order_row("order of the area", observed, 4.0, 0.1, "not yet asymptotic", mesh),
    ]


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


CASES = (
    Case("Area between arcs", "pi (b^2 - a^2) / 4", arc),
    Case("Roller's width", "Hertz 1882, in Johnson, Contact Mechanics, 1985, sec. 4.2(c)", roller),
)
