r"""One to three papillary ridges side by side on a flat layered strip, as a gmsh model.

The finger's junctions without its outline: with x along the strip and y upwards from the screen, each curve is
:math:`y = \text{depth}(x)` of :class:`~geometry.profiles.Profiles`, so that ridge tips are at y = 0 and the middle
of one ridge is at x = 0. The dermis ends in a flat top, the bone's rim; the lateral faces are in the grooves beyond the
outer ridges.
"""

import gmsh
import numpy as np
from numpy.typing import NDArray

from geometry import tags
from geometry.curved import curve_edges
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import Profiles

_MM = 1e3  # gmsh's tolerances suit models in mm
_SAMPLES = 32  # spline points of half a period
LAYERS = (tags.STRATUM_CORNEUM, tags.VIABLE_EPIDERMIS, tags.DERMIS)


def build(finger: Fingertip, size: MeshSize, ridges: int = 1, height: float = 1.5e-3) -> float:
    """Mesh a strip in the current gmsh session, with physical groups from :mod:`geometry.tags`.

    Args:
        finger: its layers and ridges; outline, bone and nail are left out.
        size: element sizes; every ridge can touch, over ``touching_fraction`` of its width.
        ridges: how many, 1 or 3: one is at x = 0.
        height: of the flat top above the screen (m).

    Returns:
        The length of gmsh's unit in m.
    """
    p, geo = Profiles(finger), gmsh.model.geo
    half = ridges * finger.ridge_wavelength / 2
    # Broken at tips, grooves and papillae: facets that cut them off would move material from layer to layer.
    stations = np.linspace(-half, half, 4 * ridges + 1)
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
    for k in range(ridges):
        j = k - ridges // 2
        gmsh.model.addPhysicalGroup(1, curves[0][4 * k : 4 * k + 4], tags.ridge(j), f"ridge {j}")
    gmsh.model.addPhysicalGroup(1, curves[-1], tags.BONE_RIM, "bone rim")
    gmsh.model.addPhysicalGroup(1, left + right, tags.SIDES, "sides")
    _sizes(p, size, ridges, curves[0] + curves[1] + curves[2])
    gmsh.model.mesh.generate(2)
    curve_edges()
    return 1 / _MM


def _point(x: float, y: float | NDArray[np.float64]) -> int:
    return int(gmsh.model.geo.addPoint(x * _MM, float(y) * _MM, 0.0))


def _sizes(p: Profiles, size: MeshSize, ridges: int, wavy: list[int]) -> None:
    """Let the element size grow from the tips and from the junctions."""
    wavelength = p.finger.ridge_wavelength
    across = p.touching_arcs(size.touching_fraction, size.contact / 2)
    x = ((np.arange(ridges) - ridges // 2)[:, None] * wavelength + across).ravel()
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
