"""Small verification bodies as gmsh models: a block and a single ridge."""

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
    for edge, length in zip(edges, (width, height, width, height), strict=True):
        geo.mesh.setTransfiniteCurve(edge, 1 + int(np.ceil(length / size * (1 - 1e-9))))
    body = geo.addPlaneSurface([geo.addCurveLoop(edges)])
    geo.mesh.setTransfiniteSurface(body)
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
