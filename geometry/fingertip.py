"""The fingertip's cross-section as a gmsh model: layers, nail, nail bed, the bone as a hole, ridges, sites."""

import gmsh
import numpy as np
from numpy.typing import NDArray

from geometry import tags
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError, Profiles

_MM = 1e3  # gmsh's tolerances suit models in mm
_SAMPLES = 32  # spline points a ridge
_SHARP_SAMPLES = 128  # of the VE-D junction, whose tips have a radius of some um


def touching_ridges(finger: Fingertip, size: MeshSize) -> range:
    """Return the numbers of the ridges that are meshed finely enough to touch the screen."""
    last = int(size.touching_half_arc / finger.ridge_wavelength + 0.5)
    last = min(last, (finger.ridge_count - 1) // 2)
    return range(-last, last + 1)


def check(finger: Fingertip, size: MeshSize) -> Profiles:
    """Return the fingertip's curves if they and the sizes can be meshed.

    Raises:
        GeometryError: see :meth:`geometry.profiles.Profiles.check`; or elements too large for a ridge.
    """
    profiles = Profiles(finger)
    profiles.check()
    if size.contact > finger.ridge_wavelength / 4:
        raise GeometryError(
            f"contact size {size.contact:g} m is too large for a ridge of {finger.ridge_wavelength:g} m: "
            f"at most a quarter of it, {finger.ridge_wavelength / 4:g} m"
        )
    return profiles


def build(finger: Fingertip, size: MeshSize, receptors: bool = True) -> float:
    """Mesh the fingertip in the current gmsh session, with physical groups from :mod:`geometry.tags`.

    Args:
        finger: what is meshed.
        size: of its elements.
        receptors: whether elements are small at the receptor sites.

    Returns:
        The length of gmsh's unit in m.

    Raises:
        GeometryError: see :func:`check`.
    """
    profiles = check(finger, size)
    curves = _curves(profiles, touching_ridges(finger, size))
    _surfaces(curves)
    _sizes(profiles, size, curves, receptors)
    gmsh.model.mesh.generate(2)
    return 1 / _MM


class _Curves:
    """Tags of gmsh curves by what they are; closed ones run anticlockwise."""

    def __init__(self) -> None:
        self.skin: list[int] = []
        self.touching: list[int] = []
        self.wavy: list[int] = []
        self.interfaces: dict[str, list[int]] = {}
        self.ends: dict[int, list[int]] = {}
        self.ridges: dict[int, list[int]] = {}


def _point(xy: NDArray[np.float64]) -> int:
    return int(gmsh.model.geo.addPoint(xy[0] * _MM, xy[1] * _MM, 0.0))


def _spline(points: NDArray[np.float64], first: int, last: int) -> int:
    return int(gmsh.model.geo.addSpline([first, *(_point(xy) for xy in points[1:-1]), last]))


def _chain(
    p: Profiles, depth, stations: NDArray[np.float64], ends: tuple[int, int], samples: int = _SAMPLES
) -> list[int]:
    """Return splines through the curve of given depth, broken at the stations (arc lengths)."""
    knots = [ends[0], *(_point(p.point(s, depth(s))) for s in stations[1:-1]), ends[1]]
    chain = []
    for k, (a, b) in enumerate(zip(stations, stations[1:], strict=False)):
        count = max(3, int(np.ceil(samples * (b - a) / p.finger.ridge_wavelength)) + 1)
        s = np.linspace(a, b, count)
        chain.append(_spline(p.point(s, depth(s)), knots[k], knots[k + 1]))
    return chain


def _curves(p: Profiles, touching: range) -> _Curves:
    f, c = p.finger, _Curves()
    end = p.nail_arc
    edge = np.array([-end, end])
    depths = {
        "skin": p.skin,
        "sc_ve": p.sc_ve,
        "nail": lambda s: np.full_like(s, f.nail_thickness),
        "ve_d": p.ve_d,
        "d_sub": p.d_sub,
    }

    # End lines at the nail's edges, normal to the outline, and on to the bone.
    corners: dict[str, tuple[int, int]] = {}
    for name, depth in depths.items():
        xy = p.point(edge, depth(edge))
        corners[name] = (_point(xy[0]), _point(xy[1]))
    down = sorted(depths, key=lambda name: float(depths[name](edge)[0]))
    attach = np.arcsin(f.nail_bed_half_width / (f.bone_width / 2))
    bone = tuple(_point(p.bone(side * (np.pi - attach))) for side in (-1, 1))
    for side in (0, 1):
        nodes = [corners[name][side] for name in down] + [bone[side]]
        c.ends[side] = [gmsh.model.geo.addLine(a, b) for a, b in zip(nodes, nodes[1:], strict=False)]
    c.interfaces["order"] = [down.index(name) for name in ("skin", "sc_ve", "ve_d", "d_sub", "nail")]

    # Skin: one group of curves a ridge, those that can touch broken where the fine mesh ends.
    grooves = (np.arange(f.ridge_count + 1) - f.ridge_count / 2) * f.ridge_wavelength
    stations = np.concatenate([[-end], grooves, [end]])
    c.skin = _chain(p, p.skin, stations, corners["skin"])
    for j, curve in zip(p.ridges, c.skin[1:-1], strict=True):
        c.ridges[j] = [curve]
        if j in touching:
            c.touching.append(curve)
    for name, depth in (("sc_ve", p.sc_ve), ("d_sub", p.d_sub)):
        c.interfaces[name] = _chain(p, depth, stations, corners[name])
    # A node on each tip and papilla: facets that cut them off would leave receptor sites in the wrong layer.
    tips = np.concatenate([[-end], np.linspace(grooves[0], grooves[-1], 4 * f.ridge_count + 1), [end]])
    c.interfaces["ve_d"] = _chain(p, p.ve_d, tips, corners["ve_d"], _SHARP_SAMPLES)
    c.wavy = c.skin[1:-1] + c.interfaces["sc_ve"][1:-1] + c.interfaces["ve_d"][1:-1]

    # Dorsal faces of the nail, from the right edge over the top to the left one.
    s = np.linspace(end, p.half_perimeter, 61)
    for name, depth_value in (("nail outside", 0.0), ("nail inside", f.nail_thickness)):
        right = p.point(s, depth_value)
        xy = np.concatenate([right, (right * [-1, 1])[-2::-1]])
        key = "skin" if name == "nail outside" else "nail"
        if key == "skin":  # the ridges' mean line lies deeper than the outline; start the nail on the skin
            xy[[0, -1]] = p.point(edge, p.skin(edge))[::-1]
        c.interfaces[name] = [_spline(xy, corners[key][1], corners[key][0])]

    lower = np.linspace(-(np.pi - attach), np.pi - attach, 121)
    upper = np.linspace(np.pi - attach, np.pi + attach, 61)
    c.interfaces["bone below"] = [_spline(p.bone(lower), bone[0], bone[1])]
    c.interfaces["bone above"] = [_spline(p.bone(upper), bone[1], bone[0])]
    return c


def _surfaces(c: _Curves) -> None:
    geo = gmsh.model.geo
    skin, sc_ve, ve_d, d_sub, nail = c.interfaces["order"]
    left, right = c.ends[0], c.ends[1]
    i = c.interfaces

    def surface(*loop: int) -> int:
        return int(geo.addPlaneSurface([geo.addCurveLoop(list(loop))]))

    def band(upper: list[int], lower: list[int], a: int, b: int) -> int:
        """Return the surface between two curves whose ends are at positions a < b of the end lines."""
        return surface(*upper, *right[a:b], *(-k for k in reversed(lower)), *(-k for k in reversed(left[a:b])))

    def reverse(curves: list[int]) -> list[int]:
        return [-k for k in reversed(curves)]

    surfaces = {
        tags.STRATUM_CORNEUM: band(c.skin, i["sc_ve"], skin, sc_ve),
        tags.VIABLE_EPIDERMIS: band(i["sc_ve"], i["ve_d"], sc_ve, ve_d),
        tags.DERMIS: band(i["ve_d"], i["d_sub"], ve_d, d_sub),
        tags.SUBCUTIS: surface(*i["d_sub"], *right[d_sub:], *reverse(i["bone below"]), *reverse(left[d_sub:])),
        tags.NAIL: surface(
            *i["nail outside"], *left[skin:nail], *reverse(i["nail inside"]), *reverse(right[skin:nail])
        ),
        tags.NAIL_BED: surface(*i["nail inside"], *left[nail:], *reverse(i["bone above"]), *reverse(right[nail:])),
    }
    geo.synchronize()
    for name, tag in tags.LAYERS.items():
        gmsh.model.addPhysicalGroup(2, [surfaces[tag]], tag, name)
    gmsh.model.addPhysicalGroup(1, i["bone below"] + i["bone above"], tags.BONE_RIM, "bone rim")
    gmsh.model.addPhysicalGroup(1, i["nail outside"], tags.NAIL_SURFACE, "nail surface")
    others = [k for k in c.skin if k not in c.touching]
    gmsh.model.addPhysicalGroup(1, others, tags.OUTER_SKIN, "outer skin")
    for j, curves in c.ridges.items():
        if curves[0] in c.touching:
            gmsh.model.addPhysicalGroup(1, curves, tags.ridge(j), f"ridge {j}")


def _sizes(p: Profiles, size: MeshSize, c: _Curves, receptors: bool) -> None:
    """Set the element size: smallest of several cones, each growing from what needs fine elements."""
    f = p.finger
    touching = touching_ridges(f, size)
    fields = gmsh.model.mesh.field

    def cone(smallest: float, **what: list[int] | list[float]) -> int:
        distance = fields.add("Distance")
        for key, value in what.items():
            fields.setNumbers(distance, key, value)
        fields.setNumber(distance, "Sampling", 40)
        growth = fields.add("MathEval")
        fields.setString(growth, "F", f"{smallest * _MM} + {size.growth} * F{distance}")
        return int(growth)

    # The tips that can touch, as points half a facet apart.
    half = size.touching_fraction * f.ridge_wavelength / 2
    across = np.linspace(-half, half, 1 + int(np.ceil(2 * half / max(size.contact / 2, 2e-6))))
    s = (np.array(touching)[:, None] * f.ridge_wavelength + across).ravel()
    tips = _mesh_points(p.point(s, p.skin(s)))
    cones = [cone(size.contact, PointsList=tips)]
    if receptors:
        sites = _mesh_points(p.merkel_sites()[[p.ridges.index(j) for j in touching]])
        cones.append(cone(size.receptor, PointsList=sites))
    cones.append(cone(size.interface, CurvesList=c.wavy))
    cap = fields.add("MathEval")
    fields.setString(cap, "F", str(size.coarsest * _MM))
    smallest = fields.add("Min")
    fields.setNumbers(smallest, "FieldsList", [*cones, cap])
    fields.setAsBackgroundMesh(smallest)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)


def _mesh_points(xy: NDArray[np.float64]) -> list[int]:
    """Add points that guide the element size without being part of the mesh."""
    points = [_point(point) for point in xy]
    gmsh.model.geo.synchronize()
    return points
