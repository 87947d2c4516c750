"""The fingertip's cross-section as a gmsh model: layers, nail, nail bed, the bone as a hole, ridges, sites."""

from collections.abc import Callable
from functools import lru_cache

import gmsh
import numpy as np
from numpy.typing import NDArray

from geometry import tags
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import Profiles
from geometry.reflection import HalfMesh, swap_corners
from geometry.shape import shape
from geometry.sizing import FROM_EDGES, check, growth_from_tips, touching_ridges
from geometry.triangles import unfold

Array = NDArray[np.float64]
_MM = 1e3  # gmsh's tolerances suit models in mm
_HALF_ARC = 5e-3  # m
_SAMPLES = 32  # spline points a ridge
_PRECISION = 1e-3  # of a curve's number of facets; gmsh's 1e-9 takes as long as all the rest of a mesh
_SHARP_SAMPLES = 128  # of the VE-D junction, whose tips have a radius of some um


def build(
    finger: Fingertip, size: MeshSize, receptors: bool = True, half: bool = False, edges: tuple[float, ...] = ()
) -> float:
    """Mesh the fingertip in the current gmsh session, with physical groups from :mod:`geometry.tags`.

    Args:
        finger: what is meshed.
        size: of its elements.
        receptors: whether elements are small at the tips of the intermediate ridges, just below the Merkel sites.
        half: leave it at the half at x >= 0, with half of ridge 0; else its mirror image is added.
        edges: arc lengths (m) >= 0 where contact ends, about which facets have the size ``edge``.

    Returns:
        The length of gmsh's unit in m.

    Raises:
        GeometryError: see :mod:`geometry.sizing`.
    """
    _half(finger, size, receptors, edges).put("meshed finger", whole=not half)
    return 1 / _MM


@lru_cache(maxsize=4)  # a path's half and whole, and after meshes for three errors the one for the penalty's effect
def _half(finger: Fingertip, size: MeshSize, receptors: bool, edges: tuple[float, ...]) -> HalfMesh:
    """Mesh the half at x >= 0 in the current gmsh session, see :func:`build`."""
    profiles = check(finger, size)
    touching = [j for j in touching_ridges(finger, size) if j >= 0]
    curves = _curves(profiles, touching)
    _surfaces(curves)
    _sizes(profiles, size, curves, touching, receptors, np.array(edges))
    gmsh.model.mesh.generate(2)
    swap_corners()
    gmsh.model.mesh.setOrder(2)
    _onto_profiles(profiles, curves)
    unfold()
    return HalfMesh.read()


@shape(tags.LAYERS.values())
def finger(parameters: Fingertip | None = None, receptors: bool = False, **sizes: float) -> float:
    """Return the whole fingertip.

    Args:
        parameters: what is meshed; by default the default fingertip.
        receptors: whether elements are small at the tips of the intermediate ridges, just below the Merkel sites.
        sizes: of elements, as in :class:`geometry.parameters.MeshSize`; ridges within 5 mm of the centre can touch
            unless ``touching_half_arc`` says otherwise.
    """
    size = MeshSize.model_validate({"touching_half_arc": _HALF_ARC} | sizes)
    return build(parameters or Fingertip(), size, receptors)


class _Curves:
    """Tags of gmsh curves of the half at x >= 0 by what they are; closed ones run anticlockwise.

    At either end the layers are cut by a line from the skin to the bone: at x = 0 (0) and at the nail's edge (1). Half
    a nail and its bed have another cut, on top.
    """

    def __init__(self) -> None:
        self.skin: list[int] = []
        self.touching: list[int] = []
        self.wavy: list[int] = []
        self.interfaces: dict[str, list[int]] = {}
        self.ends: dict[int, list[int]] = {}
        self.depths: dict[int, list[str]] = {}
        self.top: list[int] = []
        self.symmetry: list[int] = []
        self.ridges: dict[int, list[int]] = {}
        self.profiles: dict[int, tuple[Callable[[Array], Array], float, float]] = {}
        """Depth, first and last arc length of each curve that is a part of one of the profiles."""

    def cut(self, side: int, upper: str, lower: str) -> list[int]:
        """Return the lines of an end between two depths."""
        a, b = (self.depths[side].index(name) for name in (upper, lower))
        return self.ends[side][a:b]


def _point(xy: Array) -> int:
    return int(gmsh.model.geo.addPoint(xy[0] * _MM, xy[1] * _MM, 0.0))


def _spline(points: Array, first: int, last: int) -> int:
    return int(gmsh.model.geo.addSpline([first, *(_point(xy) for xy in points[1:-1]), last]))


def _lines(points: list[int]) -> list[int]:
    return [gmsh.model.geo.addLine(a, b) for a, b in zip(points, points[1:], strict=False)]


def _chain(
    p: Profiles, c: _Curves, depth, stations: Array, ends: tuple[int, int], samples: int = _SAMPLES
) -> list[int]:
    """Return splines through the curve of given depth, broken at the stations (arc lengths)."""
    knots = [ends[0], *(_point(p.point(s, depth(s))) for s in stations[1:-1]), ends[1]]
    chain = []
    for k, (a, b) in enumerate(zip(stations, stations[1:], strict=False)):
        count = max(3, int(np.ceil(samples * (b - a) / p.finger.ridge_wavelength)) + 1)
        s = np.linspace(a, b, count)
        chain.append(_spline(p.point(s, depth(s)), knots[k], knots[k + 1]))
        c.profiles[chain[-1]] = depth, a, b
    return chain


def _curves(p: Profiles, touching: list[int]) -> _Curves:
    f, c = p.finger, _Curves()
    end = p.nail_arc
    edge = np.array([0.0, end])
    depths = {
        "skin": p.skin,
        "sc_ve": p.sc_ve,
        "nail": lambda s: np.full_like(s, f.nail_thickness),
        "ve_d": p.ve_d,
        "d_sub": p.d_sub,
    }

    # End lines, normal to the outline, and on to the bone.
    corners: dict[str, tuple[int, int]] = {}
    for name, depth in depths.items():
        xy = p.point(edge, depth(edge))
        corners[name] = (_point(xy[0]), _point(xy[1]))
    attach = np.arcsin(f.nail_bed_half_width / (f.bone_width / 2))
    bone = tuple(_point(p.bone(phi)) for phi in (0.0, np.pi - attach))
    for side in (0, 1):
        down = sorted(depths, key=lambda name: float(depths[name](edge)[side]))
        if side == 0:
            down.remove("nail")
        c.ends[side] = _lines([corners[name][side] for name in down] + [bone[side]])
        c.depths[side] = [*down, "bone"]

    # Skin: one group of curves a ridge, those that can touch broken where the fine mesh ends.
    grooves = (np.arange(f.ridge_count + 1) - f.ridge_count / 2) * f.ridge_wavelength
    tips = np.linspace(grooves[0], grooves[-1], 4 * f.ridge_count + 1)
    stations = np.concatenate([[0.0], grooves[grooves > 0], [end]])
    c.skin = _chain(p, c, p.skin, stations, corners["skin"])
    for j, curve in zip((j for j in p.ridges if j >= 0), c.skin[:-1], strict=True):
        c.ridges[j] = [curve]
        if j in touching:
            c.touching.append(curve)
    for name, depth in (("sc_ve", p.sc_ve), ("d_sub", p.d_sub)):
        c.interfaces[name] = _chain(p, c, depth, stations, corners[name])
    # A node on each tip and papilla: facets that cut them off would leave receptor sites in the wrong layer.
    tips = np.concatenate([[0.0], tips[tips > f.ridge_wavelength / 8], [end]])
    c.interfaces["ve_d"] = _chain(p, c, p.ve_d, tips, corners["ve_d"], _SHARP_SAMPLES)
    c.wavy = c.skin[:-1] + c.interfaces["sc_ve"][:-1] + c.interfaces["ve_d"][:-1]

    # Dorsal faces of the nail, from the right edge to the top.
    top = [_point(p.point(p.half_perimeter, depth)) for depth in (0.0, f.nail_thickness)]
    s = np.linspace(end, p.half_perimeter, 61)
    for k, (name, key, depth_value) in enumerate(
        (("nail outside", "skin", 0.0), ("nail inside", "nail", f.nail_thickness))
    ):
        # The first is the corner: the ridges' mean line lies deeper than the outline, the nail starts on the skin.
        c.interfaces[name] = [_spline(p.point(s, depth_value), corners[key][1], top[k])]

    lower, upper = np.linspace(0.0, np.pi - attach, 121), np.linspace(np.pi - attach, np.pi, 61)
    summit = _point(p.bone(np.pi))
    c.interfaces["bone below"] = [_spline(p.bone(lower), bone[0], bone[1])]
    c.interfaces["bone above"] = [_spline(p.bone(upper), bone[1], summit)]
    c.top = _lines([*top, summit])
    c.symmetry = c.ends[0] + c.top
    return c


def _onto_profiles(p: Profiles, c: _Curves) -> None:
    """Move nodes from gmsh's splines onto the profiles.

    A spline leaves its first point towards the second: at x = 0 and at the tips that it ends in there would be kinks,
    on which the pressure and the energy density have peaks.
    """
    for curve, (depth, a, b) in c.profiles.items():
        numbers, _, u = gmsh.model.mesh.getNodes(1, curve, returnParametricCoord=True)
        s = a + np.asarray(u) * (b - a)  # a spline's parameter counts its points
        places = _MM * p.point(s, depth(s))
        for k, number in enumerate(numbers.tolist()):
            gmsh.model.mesh.setNode(number, [places[k, 0], places[k, 1], 0.0], [])


def _surfaces(c: _Curves) -> None:
    geo = gmsh.model.geo
    i = c.interfaces

    def surface(*loop: int) -> int:
        return int(geo.addPlaneSurface([geo.addCurveLoop(list(loop))]))

    def reverse(curves: list[int]) -> list[int]:
        return [-k for k in reversed(curves)]

    def band(upper: list[int], lower: list[int], a: str, b: str) -> int:
        """Return the surface between two curves whose ends are at depths a and b of the end lines."""
        return surface(*upper, *c.cut(1, a, b), *reverse(lower), *reverse(c.cut(0, a, b)))

    nail, bed = c.top[:1], c.top[1:]

    surfaces = {
        tags.STRATUM_CORNEUM: band(c.skin, i["sc_ve"], "skin", "sc_ve"),
        tags.VIABLE_EPIDERMIS: band(i["sc_ve"], i["ve_d"], "sc_ve", "ve_d"),
        tags.DERMIS: band(i["ve_d"], i["d_sub"], "ve_d", "d_sub"),
        tags.SUBCUTIS: band(i["d_sub"], i["bone below"], "d_sub", "bone"),
        tags.NAIL: surface(*i["nail outside"], *nail, *reverse(i["nail inside"]), *reverse(c.cut(1, "skin", "nail"))),
        tags.NAIL_BED: surface(*i["nail inside"], *bed, *reverse(i["bone above"]), *reverse(c.cut(1, "nail", "bone"))),
    }
    geo.synchronize()
    for name, tag in tags.LAYERS.items():
        gmsh.model.addPhysicalGroup(2, [surfaces[tag]], tag, name)
    gmsh.model.addPhysicalGroup(1, i["bone below"] + i["bone above"], tags.BONE_RIM, "bone rim")
    gmsh.model.addPhysicalGroup(1, i["nail outside"], tags.NAIL_SURFACE, "nail surface")
    gmsh.model.addPhysicalGroup(1, c.symmetry, tags.SYMMETRY, "symmetry")
    others = [k for k in c.skin if k not in c.touching]
    gmsh.model.addPhysicalGroup(1, others, tags.OUTER_SKIN, "outer skin")
    for j, curves in c.ridges.items():
        if curves[0] in c.touching:
            gmsh.model.addPhysicalGroup(1, curves, tags.ridge(j), f"ridge {j}")


def _sizes(p: Profiles, size: MeshSize, c: _Curves, touching: list[int], receptors: bool, edges: Array) -> None:
    """Set the element size: smallest of several cones, each growing from what needs fine elements."""
    f = p.finger
    fields = gmsh.model.mesh.field

    def cone(smallest: float, slope: float, **what: list[int] | list[float]) -> int:
        distance = fields.add("Distance")
        for key, value in what.items():
            fields.setNumbers(distance, key, value)
        fields.setNumber(distance, "Sampling", 40)
        growth, largest = fields.add("Threshold"), max(size.coarsest, smallest)
        values = {"SizeMin": smallest * _MM, "SizeMax": largest * _MM, "DistMin": 0.0}
        values["DistMax"] = max(largest - smallest, 1e-9) / slope * _MM
        for key, value in {"InField": distance, **values}.items():
            fields.setNumber(growth, key, value)
        return int(growth)

    # The tips that can touch, as points half a facet apart.
    across = p.touching_arcs(size.touching_fraction, max(size.contact / 2, 2e-6))
    middles = np.array(touching) * f.ridge_wavelength
    s = (middles[:, None] + across).ravel()
    cones = [cone(size.contact, size.growth, PointsList=_mesh_points(p.point(s, p.skin(s))))]
    if receptors:  # the shape of the tip decides on the energy density at the site above it
        tips = _mesh_points(p.point(middles, p.ve_d(middles)))
        cones.append(cone(size.receptor, growth_from_tips(size), PointsList=tips))
    cones.append(cone(size.interface, size.growth, CurvesList=c.wavy))
    if len(edges):
        cones.append(cone(size.edge, FROM_EDGES, PointsList=_mesh_points(p.point(edges, p.skin(edges)))))
    cap = fields.add("MathEval")
    fields.setString(cap, "F", str(size.coarsest * _MM))
    smallest = fields.add("Min")
    fields.setNumbers(smallest, "FieldsList", [*cones, cap])
    fields.setAsBackgroundMesh(smallest)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.option.setNumber("Mesh.LcIntegrationPrecision", _PRECISION)
    gmsh.option.setNumber("Mesh.Algorithm", 6)


def _mesh_points(xy: Array) -> list[int]:
    """Add points that guide the element size without being part of the mesh."""
    points = [_point(point) for point in xy]
    gmsh.model.geo.synchronize()
    return points
