"""Small verification bodies as gmsh models: a block, a single ridge, a quarter of a tube, Cook's membrane."""

import gmsh
import numpy as np

from geometry import tags
from geometry.profiles import GeometryError

_MM = 1e3  # gmsh's tolerances suit models in mm
_SAMPLES = 128  # spline points of the ridge
_GROWTH = 0.25  # increase of the element size per distance from the ridge's tip
_TOUCHING = 0.6  # part of the ridge's width, about its tip, that is meshed finely


def block(width: float, height: float, size: float, gap: float = 0.0) -> float:
    """Mesh a rectangle, centred on x = 0, in the current gmsh session.

    The mesh is a regular grid of rectangles no larger than ``size``, halved into triangles. The bottom is
    ridge 0, the top the bone's rim, the left and right faces are sides.

    Args:
        width: (m).
        height: (m).
        size: largest edge of a grid cell (m).
        gap: height of the bottom above the screen (m).

    Returns:
        The length of gmsh's unit in m.

    Raises:
        GeometryError: a length is not positive.
    """
    _refuse_non_positive(width=width, height=height, size=size)
    geo = gmsh.model.geo
    x, low, high = width / 2 * _MM, gap * _MM, (gap + height) * _MM
    corners = [geo.addPoint(*xy, 0.0) for xy in ((-x, low), (x, low), (x, high), (-x, high))]
    edges = [geo.addLine(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    lengths = (width, height, width, height)
    body = _grid(edges, tuple(1 + int(np.ceil(length / size * (1 - 1e-9))) for length in lengths))
    _groups(body, bottom=edges[0], right=edges[1], top=edges[2], left=edges[3])
    gmsh.model.mesh.generate(2)
    return 1 / _MM


def ridge(size: float, width: float = 483e-6, height: float = 600e-6, amplitude: float = 100e-6) -> float:
    r"""Mesh one papillary ridge in the current gmsh session.

    The bottom is :math:`y = \tfrac12 A (1 - \cos 2 \pi x / w)`, lowest at x = 0; groups are those of :func:`block`.

    Args:
        size: length of the facets that can touch (m).
        width: w, one period (m).
        height: of the flat top above the screen (m).
        amplitude: A, height of the grooves above the tip (m).

    Returns:
        The length of gmsh's unit in m.

    Raises:
        GeometryError: a length is not positive, or the top is not above the grooves.
    """
    _refuse_non_positive(size=size, width=width, height=height, amplitude=amplitude)
    if amplitude >= height:
        raise GeometryError(f"amplitude is {amplitude:g} m; it must be below the height, {height:g} m")
    geo = gmsh.model.geo

    def bottom(x: float) -> int:
        y = amplitude / 2 * (1 - np.cos(2 * np.pi * x / width))
        return int(geo.addPoint(x * _MM, y * _MM, 0.0))

    curve = [bottom(x) for x in np.linspace(-width / 2, width / 2, _SAMPLES + 1)]
    right, left = (geo.addPoint(side * width / 2 * _MM, height * _MM, 0.0) for side in (1, -1))
    corners = [curve[0], curve[-1], right, left]
    edges = [geo.addSpline(curve), *(geo.addLine(corners[k], corners[(k + 1) % 4]) for k in (1, 2, 3))]
    body = geo.addPlaneSurface([geo.addCurveLoop(edges)])
    half = _TOUCHING * width / 2
    tip = [bottom(x) for x in np.linspace(-half, half, 1 + int(np.ceil(4 * half / size)))]
    _groups(body, bottom=edges[0], right=edges[1], top=edges[2], left=edges[3])

    fields = gmsh.model.mesh.field
    distance, growth = fields.add("Distance"), fields.add("MathEval")
    fields.setNumbers(distance, "PointsList", tip)
    fields.setString(growth, "F", f"{size * _MM} + {_GROWTH} * F{distance}")
    fields.setAsBackgroundMesh(growth)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.model.mesh.generate(2)
    return 1 / _MM


def quarter_tube(inner: float, outer: float, divisions: int) -> float:
    """Mesh a quarter of a tube's cross-section in the current gmsh session.

    It lies right of x = 0 and above the tube's axis, which is at twice the outer radius above the screen. The mesh is
    a regular grid in polar coordinates, halved into triangles, with as many divisions of the wall as of the quarter
    turn. The outer surface is ridge 0, the inner one the bone's rim, the planes of symmetry are sides.

    Args:
        inner: inner radius (m).
        outer: outer radius (m).
        divisions: of the wall and of the quarter turn.

    Returns:
        The length of gmsh's unit in m.

    Raises:
        GeometryError: a length is not positive, or the wall has no thickness.
    """
    _refuse_non_positive(inner=inner, outer=outer, divisions=divisions)
    if inner >= outer:
        raise GeometryError(f"inner is {inner:g} m; it must be below the outer radius, {outer:g} m")
    geo, axis = gmsh.model.geo, 2 * outer * _MM
    centre = geo.addPoint(0.0, axis, 0.0)
    right = [geo.addPoint(radius * _MM, axis, 0.0) for radius in (inner, outer)]
    top = [geo.addPoint(0.0, axis + radius * _MM, 0.0) for radius in (inner, outer)]
    edges = [
        geo.addLine(right[0], right[1]),
        geo.addCircleArc(right[1], centre, top[1]),
        geo.addLine(top[1], top[0]),
        geo.addCircleArc(top[0], centre, right[0]),
    ]
    body = _grid(edges, (divisions + 1,) * 4)
    _groups(body, bottom=edges[1], right=edges[0], top=edges[3], left=edges[2])
    gmsh.model.mesh.generate(2)
    return 1 / _MM


def cooks_membrane(divisions: int, gap: float = 10e-3) -> float:
    """Mesh Cook's tapered and swept panel, 48 mm long, in the current gmsh session.

    The mesh is a regular grid, halved into triangles. The lower edge is ridge 0, the left one, which is clamped, the
    bone's rim, the right one, which is loaded, and the upper one are sides.

    Args:
        divisions: of each edge.
        gap: height of the lowest corner above the screen (m).

    Returns:
        The length of gmsh's unit in m.

    Raises:
        GeometryError: a length is not positive.
    """
    _refuse_non_positive(divisions=divisions, gap=gap)
    geo, low = gmsh.model.geo, gap * _MM
    corners = [geo.addPoint(x, y + low, 0.0) for x, y in ((0.0, 0.0), (48.0, 44.0), (48.0, 60.0), (0.0, 44.0))]
    edges = [geo.addLine(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    body = _grid(edges, (divisions + 1,) * 4)
    _groups(body, bottom=edges[0], right=edges[1], top=edges[3], left=edges[2])
    gmsh.model.mesh.generate(2)
    return 1 / _MM


def _grid(edges: list[int], points: tuple[int, ...]) -> int:
    """Return a surface of four edges, to be meshed regularly with so many points on each."""
    geo = gmsh.model.geo
    for edge, count in zip(edges, points, strict=True):
        geo.mesh.setTransfiniteCurve(edge, count)
    body = int(geo.addPlaneSurface([geo.addCurveLoop(edges)]))
    geo.mesh.setTransfiniteSurface(body)
    return body


def _refuse_non_positive(**lengths: float) -> None:
    for name, value in lengths.items():
        if not 0 < value < np.inf:
            raise GeometryError(f"{name} is {value:g} m; it must be positive")


def _groups(body: int, bottom: int, right: int, top: int, left: int) -> None:
    gmsh.model.geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [body], tags.STRATUM_CORNEUM, "stratum corneum")
    gmsh.model.addPhysicalGroup(1, [bottom], tags.ridge(0), "ridge 0")
    gmsh.model.addPhysicalGroup(1, [top], tags.BONE_RIM, "bone rim")
    gmsh.model.addPhysicalGroup(1, [left, right], tags.SIDES, "sides")
