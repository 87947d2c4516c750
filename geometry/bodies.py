"""Small bodies: block, ridge, round pad.

Each function returns a :class:`geometry.shape.Shape`. What it refuses, it refuses with a
:class:`geometry.profiles.GeometryError` when the shape is meshed.
"""

from collections.abc import Sequence

import gmsh
import numpy as np

from geometry import tags
from geometry.parameters import LEAST_SIZE, MeshSize
from geometry.profiles import GeometryError
from geometry.shape import shape
from geometry.sizing import FROM_EDGES
from geometry.triangles import curve_edges

_MM = 1e3  # gmsh's tolerances suit models in mm
_SAMPLES = 128  # spline points of a curved bottom
_GROWTH = 0.25  # increase of the element size per distance from what can touch
_NEEDED = (tags.BONE_RIM, tags.ridge(0))
_TOUCHING = 0.6  # part of the ridge's width, about its tip, that is meshed finely
Point = tuple[float, float]


@shape(_NEEDED)
def block(width: float, height: float, size: float, gap: float = 0.0) -> float:
    """Return a rectangle, centred on x = 0.

    The mesh is a regular grid of rectangles no larger than ``size``, halved into triangles. The bottom is
    ridge 0, the top the bone's rim, the left and right faces are sides.

    Args:
        width: (m).
        height: (m).
        size: largest edge of a grid cell (m).
        gap: height of the bottom above the screen (m), 0 or more.

    Raises:
        GeometryError: a length is not positive, or the gap is below 0.
    """
    _refuse_non_positive(width=width, height=height, size=size)
    if not 0 <= gap < np.inf:
        raise GeometryError(f"gap is {gap:g} m; it must be 0 or more, since the body begins outside of the screen")
    geo = gmsh.model.geo
    x, low, high = width / 2 * _MM, gap * _MM, (gap + height) * _MM
    corners = [geo.addPoint(*xy, 0.0) for xy in ((-x, low), (x, low), (x, high), (-x, high))]
    edges = [geo.addLine(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    for edge, length in zip(edges, (width, height, width, height), strict=True):
        geo.mesh.setTransfiniteCurve(edge, 1 + int(np.ceil(length / size * (1 - 1e-9))))
    body = int(geo.addPlaneSurface([geo.addCurveLoop(edges)]))
    geo.mesh.setTransfiniteSurface(body)
    _groups(body, [edges[0]], *edges[1:])
    gmsh.model.mesh.generate(2)
    return 1 / _MM


@shape(_NEEDED)
def ridge(
    size: float,
    width: float = 483e-6,
    height: float = 600e-6,
    amplitude: float = 100e-6,
    ends: Sequence[float] = (),
) -> float:
    r"""Return one papillary ridge.

    The bottom is :math:`y = \tfrac12 A (1 - \cos 2 \pi x / w)`, lowest at x = 0; groups are those of :func:`block`.

    Args:
        size: length of the facets that can touch (m).
        width: w, one period (m).
        height: of the flat top above the screen (m).
        amplitude: A, height of the grooves above the tip (m).
        ends: abscissae (m) of the unloaded skin where contact is known to end; facets are a sixteenth of ``size``
            there, as those of a finger (:attr:`geometry.parameters.MeshSize.edge`).

    Raises:
        GeometryError: a length is not positive, the top is not above the grooves, or a facet cannot follow the tip.
    """
    _refuse_non_positive(size=size, width=width, height=height, amplitude=amplitude)
    if amplitude >= height:
        raise GeometryError(f"amplitude is {amplitude:g} m; it must be below the height, {height:g} m")
    radius = 2 / amplitude * (width / (2 * np.pi)) ** 2
    if size > 2 * radius:  # along which the tip would turn by more than 2 rad
        raise GeometryError(
            f"size is {size:g} m, too large for a tip with a radius of {radius:.3g} m; it must be at most twice that"
        )

    def bottom(x: float) -> Point:
        return x, amplitude / 2 * (1 - np.cos(2 * np.pi * x / width))

    half = _TOUCHING * width / 2
    along = [bottom(x) for x in np.linspace(-width / 2, width / 2, _SAMPLES + 1)]
    fine = [bottom(x) for x in np.linspace(-half, half, 1 + int(np.ceil(4 * half / size)))]
    return _graded([(along, 0)], height, size, fine, [bottom(x) for x in ends])


@shape(_NEEDED)
def pad(size: float, facets: int, radius: float, span: float) -> float:
    r"""Return a square block with a cylinder's bottom, :math:`y = x^2 / (2R)`.

    The tip is a node. Groups are those of :func:`block`.

    Args:
        size: length of the facets that can touch (m).
        facets: how many of these are on either side of the tip.
        radius: R (m).
        span: width and height of the block (m).

    Raises:
        GeometryError: a length is not positive, or the facets leave no flank.
    """
    _refuse_non_positive(size=size, facets=facets, radius=radius, span=span, flank=span / 2 - facets * size)

    def bottom(x: float) -> Point:
        return x, x**2 / (2 * radius)

    ends = [-span / 2, -facets * size, facets * size, span / 2]
    curves = [[bottom(x) for x in np.linspace(a, b, _SAMPLES + 1)] for a, b in zip(ends, ends[1:], strict=False)]
    tip = [bottom(x) for x in np.linspace(ends[1], ends[2], 4 * facets + 1)]
    return _graded(list(zip(curves, (0, 2 * facets, 0), strict=True)), span, size, tip)


def _graded(
    bottom: Sequence[tuple[Sequence[Point], int]],
    height: float,
    size: float,
    fine: Sequence[Point],
    ends: Sequence[Point] = (),
) -> float:
    """Mesh what lies between curves, each a spline through points (m), and a flat top.

    Args:
        bottom: the curves, from left to right, and the number of facets on each, 0 where the size decides.
        height: of the top (m).
        size: element size at the points ``fine`` (m).
        fine: where elements are smallest.
        ends: points where contact ends, at which elements are smaller still.
    """
    geo = gmsh.model.geo

    def add(point: Point) -> int:
        return int(geo.addPoint(point[0] * _MM, point[1] * _MM, 0.0))

    first = add(bottom[0][0][0])
    curves, last = [], first
    for curve, facets in bottom:
        points = [last, *(add(point) for point in curve[1:])]
        curves.append(geo.addSpline(points))
        last = points[-1]
        if facets:
            geo.mesh.setTransfiniteCurve(curves[-1], facets + 1)
    right, left = (add((point[0], height)) for point in (bottom[-1][0][-1], bottom[0][0][0]))
    corners = [last, right, left, first]
    sides = [geo.addLine(*pair) for pair in zip(corners, corners[1:], strict=False)]
    body = geo.addPlaneSurface([geo.addCurveLoop([*curves, *sides])])
    finest = [(size, _GROWTH, fine), (MeshSize(contact=size).edge, FROM_EDGES, ends)]
    cones = [(smallest, slope, [add(point) for point in places]) for smallest, slope, places in finest if places]
    _groups(body, curves, *sides)

    fields = gmsh.model.mesh.field
    grown = []
    for smallest, slope, points in cones:
        distance, field = fields.add("Distance"), fields.add("MathEval")
        fields.setNumbers(distance, "PointsList", points)
        fields.setString(field, "F", f"{smallest * _MM} + {slope} * F{distance}")
        grown.append(field)
    least = fields.add("Min")
    fields.setNumbers(least, "FieldsList", grown)
    fields.setAsBackgroundMesh(least)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.model.mesh.generate(2)
    curve_edges()
    return 1 / _MM


def _refuse_non_positive(**lengths: float) -> None:
    for name, value in lengths.items():
        if not 0 < value < np.inf:
            raise GeometryError(f"{name} is {value:g} m; it must be positive")
    if lengths.get("size", LEAST_SIZE) < LEAST_SIZE:
        raise GeometryError(f"size is {lengths['size']:g} m; it must be at least {LEAST_SIZE:g} m, beyond roundoff")


def _groups(body: int, bottom: list[int], right: int, top: int, left: int) -> None:
    gmsh.model.geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [body], tags.STRATUM_CORNEUM, "stratum corneum")
    gmsh.model.addPhysicalGroup(1, bottom, tags.ridge(0), "ridge 0")
    gmsh.model.addPhysicalGroup(1, [top], tags.BONE_RIM, "bone rim")
    gmsh.model.addPhysicalGroup(1, [left, right], tags.SIDES, "sides")
