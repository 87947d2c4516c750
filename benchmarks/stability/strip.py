r"""A papillary ridge on a flat layered strip, as a gmsh model.

The finger's junctions without its outline: with x along the strip and y upwards from the screen, each curve is
:math:`y = \text{depth}(x)` of :class:`~geometry.profiles.Profiles`, so that the ridge's tip is at y = 0 and its middle
at x = 0. The dermis ends in a flat top, the bone's rim; the lateral faces are in the grooves beside the ridge.
"""

import gmsh
import numpy as np
from numpy.typing import NDArray

from geometry import tags
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import Profiles
from geometry.triangles import curve_edges

_MM = 1e3  # gmsh's tolerances suit models in mm
_SAMPLES = 32  # spline points of half a period
LAYERS = (tags.STRATUM_CORNEUM, tags.VIABLE_EPIDERMIS, tags.DERMIS)


def build(finger: Fingertip, size: MeshSize, height: float = 1.5e-3) -> float:
    """Mesh a strip in the current gmsh session, with physical groups from :mod:`geometry.tags`.

    Args:
        finger: its layers and ridges; outline, bone and nail are left out.
        size: element sizes; the ridge can touch over ``touching_fraction`` of its width.
        height: of the flat top above the screen (m).

    Returns:
        The length of gmsh's unit in m.
    """
    p, geo = Profiles(finger), gmsh.model.geo
    half = finger.ridge_wavelength / 2
    # Broken at tips, grooves and papillae: facets that cut them off would move material from layer to layer.
    stations = np.linspace(-half, half, 5)
    curves, ends = [], []
    for depth in (p.skin, p.sc_ve, p.ve_d):
        knots = [_point(x, depth(x)) for x in stations]
        ends.append((knots[0], knots[-1]))
        chain = []
        for k, (a, b) in enumerate(zip(stations, stations[1:], strict=False)):
            inner = [_point(x, depth(x)) for x in np.linspace(a, b, _SAMPLES)[1:-1]]
            chain.append(geo.addSpline([knots[k], *inner, knots[k + 1]]))
        curves.append(chain)
    ends.append((_point(-half, height), _point(half, height)))
    curves.append([geo.addLine(*ends[-1])])

    left, right = ([geo.addLine(a[side], b[side]) for a, b in zip(ends, ends[1:], strict=False)] for side in (0, 1))
    layers = [
        geo.addPlaneSurface([geo.addCurveLoop([*curves[k], right[k], *(-c for c in curves[k + 1][::-1]), -left[k]])])
        for k in range(len(LAYERS))
    ]
    geo.synchronize()
    for tag, layer in zip(LAYERS, layers, strict=True):
        gmsh.model.addPhysicalGroup(2, [layer], tag)
    gmsh.model.addPhysicalGroup(1, curves[0], tags.ridge(0), "ridge 0")
    gmsh.model.addPhysicalGroup(1, curves[-1], tags.BONE_RIM, "bone rim")
    gmsh.model.addPhysicalGroup(1, left + right, tags.SIDES, "sides")
    _sizes(p, size, curves[0] + curves[1] + curves[2])
    gmsh.model.mesh.generate(2)
    curve_edges()
    return 1 / _MM


def _point(x: float, y: float | NDArray[np.float64]) -> int:
    return int(gmsh.model.geo.addPoint(x * _MM, float(y) * _MM, 0.0))


def _sizes(p: Profiles, size: MeshSize, wavy: list[int]) -> None:
    """Let the element size grow from the tips and from the junctions."""
    x = p.touching_arcs(size.touching_fraction, size.contact / 2)
    tips = [_point(*xy) for xy in zip(x, p.skin(x), strict=True)]
    gmsh.model.geo.synchronize()
    fields = gmsh.model.mesh.field
    cones = []
    for smallest, key, what in ((size.contact, "PointsList", tips), (size.interface, "CurvesList", wavy)):
        distance, growth = fields.add("Distance"), fields.add("MathEval")
        fields.setNumbers(distance, key, what)
        fields.setNumber(distance, "Sampling", 40)
        fields.setString(growth, "F", f"{smallest * _MM} + {size.growth} * F{distance}")
        cones.append(growth)
    cap, field = fields.add("MathEval"), fields.add("Min")
    fields.setString(cap, "F", str(size.coarsest * _MM))
    fields.setNumbers(field, "FieldsList", [*cones, cap])
    fields.setAsBackgroundMesh(field)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
