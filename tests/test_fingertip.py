"""The fingertip's curves against Table 1, and its mesh against the curves."""

from functools import partial

import numpy as np
import pytest
import ufl
from mpi4py import MPI
from numpy.testing import assert_allclose
from scipy.spatial import cKDTree

from fingerpad.scene import Scene
from geometry import fingertip, sizing, tags
from geometry.mesh import load
from geometry.morph import FOLLOWED, Morph
from geometry.parameters import Fingertip
from geometry.profiles import GeometryError, Profiles
from geometry.reflection import HalfMesh
from tests.measures import integral, vertices
from tests.small_finger import SMALL

UM, MM = 1e-6, 1e-3
WAVE = Fingertip().ridge_wavelength
HALF_DEPTH = 50 * UM  # the mean of the skin lies that deep below the tips


def dense(profiles, depth, count=400001):
    """Return many points of one curve between the nail's edges; shape (count, 2)."""
    s = np.linspace(-profiles.nail_arc, profiles.nail_arc, count)
    return profiles.point(s, depth(s))


@pytest.mark.parametrize("theta", [0.0, 0.3, np.pi / 2, 2.0, np.pi, -2.5])
def test_depths(profiles, theta):
    """The formulas of the three interfaces, below the outline's mean. Tolerance: roundoff."""
    s = np.array(theta / (2 * np.pi) * WAVE)
    ve_d = 450 + (225 if abs(theta) <= np.pi / 2 else 75) * (1 + np.cos(2 * theta))
    assert profiles.skin(s) - HALF_DEPTH == pytest.approx(-50 * UM * np.cos(theta), abs=1e-17)
    assert profiles.sc_ve(s) - HALF_DEPTH == pytest.approx((425 - 50 * np.cos(theta)) * UM, rel=1e-12, abs=0)
    assert profiles.ve_d(s) - HALF_DEPTH == pytest.approx(ve_d * UM, rel=1e-12, abs=0)
    assert profiles.d_sub(s) - HALF_DEPTH == pytest.approx(2000 * UM, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("profile", "crests"),
    [
        ((1.0, -0.6), (-0.18159912, 0.18159912)),
        ((-1.0,), (-0.5, 0.5)),
        ((0.0, -1.0), (-0.25, 0.25)),
        ((3.0, -0.5), (0,)),
    ],
)
def test_lowest_point_is_on_the_screen_wherever_the_crest_is(profile, crests):
    """Crests are where the profile's derivative vanishes; the lowest of them touches the screen, none is beyond.

    cos t - 0.6 cos 2t has its maxima where cos t = 1 / 2.4. Tolerance: points 25 nm apart on a tip of some 100 um; the
    table of arc lengths.
    """
    profiles = Profiles(Fingertip(ridge_profile=profile))
    assert np.array(profiles.crests) == pytest.approx(np.array(crests) * WAVE, abs=1e-7 * WAVE)
    skin = dense(profiles, profiles.skin)
    assert skin[:, 1].min() == pytest.approx(0, abs=1e-10)
    s = np.linspace(0, WAVE, 20001)
    assert np.ptp(profiles.skin(s)) == pytest.approx(100 * UM, rel=1e-6)
    assert profiles.skin(s).min() == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("sites", "places", "deep", "above", "below"),
    [("merkel_sites", [0.0], 880, "sc_ve", "ve_d"), ("meissner_sites", [-0.25, 0.25], 470, "ve_d", "d_sub")],
)
def test_sites_are_in_their_layers(profiles, sites, places, deep, above, below):
    """Merkel: one a ridge, 20 um above the intermediate ridge's tip and below the SC.

    Meissner: two a ridge, 20 um below the tops of the papillae and above the subcutis. Tolerance: roundoff of
    centimetres.
    """
    s = ((np.array(profiles.ridges)[:, None] + places) * WAVE).ravel()
    depth = np.full(55 * len(places), HALF_DEPTH + deep * UM)
    assert_allclose(getattr(profiles, sites)(), profiles.point(s, depth), rtol=0, atol=1e-15)
    assert (getattr(profiles, above)(s) < depth).all()
    assert (depth < getattr(profiles, below)(s)).all()


# -- the fingertip's mesh against its curves and plane geometry, and what is refused ---------------------------------
def shoelace(*chains) -> float:
    """Return the area of the polygon through chains of points."""
    x, y = np.concatenate(chains).T
    return abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


# -- mesh ----------------------------------------------------------------------------------------------
def areas(profiles) -> dict[int, float]:
    """Return each layer's area between the curves of the profiles."""
    f = profiles.finger
    depths = (profiles.skin, profiles.sc_ve, profiles.ve_d, profiles.d_sub)
    skin, sc_ve, ve_d, d_sub = (dense(profiles, depth) for depth in depths)
    attach = np.arcsin(f.nail_bed_half_width / (f.bone_width / 2))
    below = profiles.bone(np.linspace(-(np.pi - attach), np.pi - attach, 4001))
    above = profiles.bone(np.linspace(np.pi - attach, np.pi + attach, 4001))
    s = np.linspace(profiles.nail_arc, profiles.half_perimeter, 2001)
    right = (profiles.point(s), profiles.point(s, f.nail_thickness))
    outside, inside = (np.concatenate([half, half[::-1] * [-1, 1]]) for half in right)
    return {
        tags.STRATUM_CORNEUM: shoelace(skin, sc_ve[::-1]),
        tags.VIABLE_EPIDERMIS: shoelace(sc_ve, ve_d[::-1]),
        tags.DERMIS: shoelace(ve_d, d_sub[::-1]),
        tags.SUBCUTIS: shoelace(d_sub, below[::-1]),
        tags.NAIL: shoelace(outside, inside[::-1]),
        tags.NAIL_BED: shoelace(inside, d_sub[:1], above[::-1], d_sub[-1:]),
    }


@pytest.mark.mpi
@pytest.mark.parametrize("layer", list(tags.LAYERS))
def test_area(finger_mesh, profiles, layer):
    """Tolerance: facets of up to 120 um on tips with a radius of 6 um, where the parabolas do not follow them."""
    tag = tags.LAYERS[layer]
    off = {"viable epidermis": 6e-3, "nail": 3e-3}.get(layer, 1e-3)  # the nail's edge is such a tip, too
    assert integral(finger_mesh, tag) == pytest.approx(areas(profiles)[tag], rel=off)


def away_from(curve, points) -> float:
    """Return the greatest distance of points from a curve given densely."""
    return float(cKDTree(curve).query(points)[0].max())


def test_ridges_of_the_mesh(finger_mesh, profiles):
    """Ridge j's nodes are on the skin's curve about s = j wavelengths. Tolerance: its points are 12 nm apart here.

    Its two ends are nodes, to roundoff.
    """
    for j in finger_mesh.ridges():
        s = (j + np.linspace(-0.5, 0.5, 40001)) * WAVE
        nodes = vertices(finger_mesh, finger_mesh.facet_tags.find(tags.ridge(j)))
        assert away_from(profiles.point(s, profiles.skin(s)), nodes) < 0.01 * UM
        ends = profiles.point(s[[0, -1]], profiles.skin(s[[0, -1]]))
        assert away_from(nodes, ends) < 1e-15


@pytest.mark.mpi
def test_bone_rim(finger_mesh, profiles):
    """The rim is closed: its normals add up to nothing; its length is the ellipse's. Tolerance: chords of 1 mm."""
    n = ufl.FacetNormal(finger_mesh.mesh)
    rim = profiles.bone(np.linspace(-np.pi, np.pi, 20001))
    length = np.linalg.norm(np.diff(rim, axis=0), axis=1).sum()
    assert integral(finger_mesh, tags.BONE_RIM, kind="ds") == pytest.approx(length, rel=1e-2)
    for k in (0, 1):
        assert abs(integral(finger_mesh, tags.BONE_RIM, n[k], "ds")) < 1e-12 * length


def test_finger_is_a_half_and_its_mirror_image(coarse, finger_mesh):
    """To the last node: areas of layers, lengths of ridges and of the rim are twice the half's."""
    half = load(MPI.COMM_WORLD, partial(fingertip.build, Fingertip(), coarse, half=True))
    for name, tag in tags.LAYERS.items():
        assert 2 * integral(half, tag) == pytest.approx(integral(finger_mesh, tag), rel=1e-12), name
    assert half.ridges() == [j for j in finger_mesh.ridges() if j >= 0]
    line = vertices(half, half.facet_tags.find(tags.SYMMETRY))
    assert np.abs(line[:, 0]).max(initial=0) < 1e-12
    assert half.mesh.geometry.x[:, 0].min(initial=0) > -1e-12
    assert not len(finger_mesh.facet_tags.find(tags.SYMMETRY))
    for tag in (tags.BONE_RIM, tags.OUTER_SKIN, tags.NAIL_SURFACE, tags.ridge(0)):
        assert len(finger_mesh.facet_tags.find(tag)) == 2 * len(half.facet_tags.find(tag)) > 0
    points = finger_mesh.mesh.geometry.x[:, :2]
    assert cKDTree(points).query(points * [-1, 1])[0].max() < 1e-15
    for j in half.ridges():
        right, left = (vertices(finger_mesh, finger_mesh.facet_tags.find(tags.ridge(k))) for k in (j, -j))
        assert np.sort(right[:, 0]) == pytest.approx(np.sort(-left[:, 0]), abs=1e-15)


# -- triangles with two sides on the skin ----------------------------------------------------------------------------
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@pytest.mark.slow
@pytest.mark.parametrize("half", [True, False])
def test_sharp_tips_are_meshed(half, monkeypatch):
    """Of the fifth harmonic alone; a mesh of gmsh's own has such triangles, on either side of the mirror.

    Its facets turn by more than they may in a scene.
    """
    monkeypatch.setattr(sizing, "_TURN", 10.0)
    scene = Scene.load(SMALL).replace(geometry={"ridge_profile": [0, 0, 0, 0, 1]}, mesh={"contact": 40e-6})
    size = scene.mesh.model_copy(update={"touching_half_arc": 0.5e-3})
    body = load(MPI.COMM_WORLD, partial(fingertip.build, scene.geometry, size, half=half))
    facets = np.concatenate([body.facets(tag) for tag in body.ridge_tags().values()])
    body.mesh.topology.create_connectivity(1, 2)
    links = body.mesh.topology.connectivity(1, 2)
    cells = [int(links.links(facet)[0]) for facet in facets]
    assert len(cells) == len(set(cells))


@pytest.mark.mpi
def test_corner_that_stays_is_told():
    """A square with two sides on the skin, of two triangles; on every rank, and where it is."""

    def build() -> float:
        triangles, skin = np.array([[1, 2, 3], [1, 3, 4]]), np.array([[1, 2], [2, 3], [3, 4], [4, 1]])
        groups = {(2, tags.STRATUM_CORNEUM): (triangles, "skin"), (1, tags.ridge(0)): (skin, "ridge 0")}
        HalfMesh(np.pad(SQUARE, ((0, 0), (0, 1))), groups).put("square", whole=False)
        return 1e-3

    with pytest.raises(
        GeometryError, match=r"^the triangle at x = .* mm, y = .* mm has two sides on the skin that can"
    ):
        load(MPI.COMM_WORLD, build)


@pytest.mark.parametrize("name", FOLLOWED[:7])
def test_places_on_curves_follow_them(name):
    """Onto the curves of the other finger, at the same phase of a ridge; the bone and the nail stay, to roundoff."""
    now, finger = Profiles(Fingertip()), Fingertip(**{name: 1.01 * getattr(Fingertip(), name)})
    then, s = Profiles(finger), np.linspace(-12 * MM, 12 * MM, 401)
    for curve in ("skin", "sc_ve", "ve_d", "d_sub"):
        places = [
            p.point(at, getattr(p, curve)(at)) for p, at in ((now, s), (then, s * finger.ridge_wavelength / WAVE))
        ]
        assert_allclose(Morph(now.finger, places[0]).to(finger), places[1], rtol=0, atol=1e-15)
    for still in (
        now.bone(np.linspace(0, 1.5, 9)),
        now.point(np.linspace(now.nail_arc, now.half_perimeter, 9), 0.4e-3),
    ):
        assert_allclose(Morph(now.finger, still).to(finger), still, rtol=0, atol=1e-15)
