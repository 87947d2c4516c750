"""The fingertip's mesh against its curves and plane geometry, and what is refused."""

from functools import partial

import gmsh
import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx import geometry as search
from dolfinx.mesh import entities_to_geometry
from mpi4py import MPI
from pydantic import ValidationError
from scipy.spatial import cKDTree

from geometry import fingertip, tags
from geometry.benchmarks import block, cooks_membrane, foot, pad, quarter_tube, ridge
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError, Profiles
from tests.test_profiles import MM, UM, WAVE, dense


def shoelace(*chains) -> float:
    """Return the area of the polygon through chains of points."""
    x, y = np.concatenate(chains).T
    return abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


# -- mesh ----------------------------------------------------------------------------------------------
def integral(body, tag, integrand=1.0) -> float:
    """Integrate over a layer on all ranks."""
    dx = ufl.Measure("dx", body.mesh, subdomain_data=body.cell_tags)
    form = fem.form(fem.Constant(body.mesh, 1.0) * integrand * dx(tag))
    return body.mesh.comm.allreduce(fem.assemble_scalar(form))


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
    """Tolerance: facets of up to 120 um cut the corners of waves of 483 um, those of 1 mm the nail's two faces."""
    tag = tags.LAYERS[layer]
    assert integral(finger_mesh, tag) == pytest.approx(areas(profiles)[tag], rel=1e-2 if "nail" in layer else 5e-3)


@pytest.mark.mpi
@pytest.mark.parametrize("layer", list(tags.LAYERS))
def test_layers_are_mirrored(finger_mesh, layer):
    """Left and right of x = 0 weigh the same. Tolerance: the placing of nodes along the mirrored curves."""
    tag = tags.LAYERS[layer]
    moment = integral(finger_mesh, tag, ufl.SpatialCoordinate(finger_mesh.mesh)[0])
    assert abs(moment) < 1e-6 * 20 * MM * integral(finger_mesh, tag)


@pytest.mark.mpi
def test_no_cell_is_without_layer(finger_mesh):
    """The layers together are the whole section. Tolerance: roundoff of the sums."""
    whole = finger_mesh.mesh.comm.allreduce(
        fem.assemble_scalar(fem.form(fem.Constant(finger_mesh.mesh, 1.0) * ufl.dx(finger_mesh.mesh)))
    )
    assert sum(integral(finger_mesh, tag) for tag in tags.LAYERS.values()) == pytest.approx(whole, rel=1e-12, abs=0)


@pytest.mark.mpi
def test_ridges_that_can_touch(finger_mesh, coarse):
    """Those with a tip within 2 mm of the centre, and half of one."""
    assert finger_mesh.ridges() == list(range(-4, 5)) == list(fingertip.touching_ridges(Fingertip(), coarse))


def vertices(body, facets):
    """Return the vertices of facets, each once; shape (n, 2)."""
    body.mesh.topology.create_connectivity(1, 0)
    body.mesh.topology.create_connectivity(0, 2)
    if not len(facets):  # on a rank that has none
        return np.empty((0, 2))
    links = body.mesh.topology.connectivity(1, 0)
    points = np.unique(np.concatenate([links.links(f) for f in facets]))
    return body.mesh.geometry.x[entities_to_geometry(body.mesh, 0, points.astype(np.int32)).ravel(), :2]


def away_from(curve, points) -> float:
    """Return the greatest distance of points from a curve given densely."""
    return float(cKDTree(curve).query(points)[0].max())


def test_ridges_of_the_mesh(finger_mesh, profiles):
    """Ridge j's nodes are on the skin's curve about s = j wavelengths. Tolerance: splines through 32 points a ridge.

    Its two ends are nodes, to roundoff.
    """
    for j in finger_mesh.ridges():
        s = (j + np.linspace(-0.5, 0.5, 40001)) * WAVE
        nodes = vertices(finger_mesh, finger_mesh.facet_tags.find(tags.ridge(j)))
        assert away_from(profiles.point(s, profiles.skin(s)), nodes) < 0.05 * UM
        ends = profiles.point(s[[0, -1]], profiles.skin(s[[0, -1]]))
        assert away_from(nodes, ends) < 1e-15


def test_lowest_node(finger_mesh):
    """The mesh reaches the screen but for the sagitta of a facet, here up to 40 um, at a tip of radius 118 um.

    Below the screen it may be by what splines miss of the curve.
    """
    lowest = vertices(finger_mesh, finger_mesh.facet_tags.find(tags.ridge(0)))[:, 1].min()
    assert -0.05 * UM < lowest < (40 * UM) ** 2 / (8 * 118 * UM)


def test_contact_size(finger_mesh):
    """Facets about the tips that can touch are about as long as asked; those in the grooves may be longer.

    Tolerance: gmsh's freedom to space them, 2 % here; those in the grooves are at most twice as long on average.
    """
    body = finger_mesh
    for j in (-4, 0, 3):
        facets = body.facet_tags.find(tags.ridge(j))
        x = np.sort(vertices(body, facets)[:, 0])
        if j == 0:
            x = x[np.abs(x) < 0.3 * WAVE]
            assert np.diff(x).max() < 1.1 * 30 * UM
        assert len(facets) >= WAVE / (2 * 30 * UM)


def interface(body, one, other):
    """Return the facets between two layers."""
    layer = np.zeros(body.mesh.topology.index_map(2).size_local, dtype=int)
    layer[body.cell_tags.indices] = body.cell_tags.values
    body.mesh.topology.create_connectivity(1, 2)
    links = body.mesh.topology.connectivity(1, 2)
    every = range(body.mesh.topology.index_map(1).size_local)
    return [f for f in every if sorted(layer[links.links(f)]) == sorted((one, other))]


@pytest.mark.parametrize(
    ("layers", "depth", "within"),
    [
        ((tags.STRATUM_CORNEUM, tags.VIABLE_EPIDERMIS), "sc_ve", 0.1 * UM),
        ((tags.VIABLE_EPIDERMIS, tags.DERMIS), "ve_d", 0.5 * UM),
        ((tags.DERMIS, tags.SUBCUTIS), "d_sub", 0.1 * UM),
    ],
)
def test_interfaces_of_the_mesh(finger_mesh, profiles, layers, depth, within):
    """Nodes between two layers are on their curve. Tolerance: splines, above all at the VE-D junction's sharp tips."""
    nodes = vertices(finger_mesh, interface(finger_mesh, *layers))
    assert away_from(dense(profiles, getattr(profiles, depth)), nodes) < within


def layer_at(body, points):
    """Return the tag of the cell at each point."""
    x = np.pad(points, ((0, 0), (0, 1)))
    near = search.compute_collisions_points(search.bb_tree(body.mesh, 2), x)
    cells = search.compute_colliding_cells(body.mesh, near, x)
    layer = np.zeros(body.mesh.topology.index_map(2).size_local, dtype=int)
    layer[body.cell_tags.indices] = body.cell_tags.values
    return np.array([layer[cells.links(k)[0]] for k in range(len(points))])


def test_cells_at_the_merkel_sites(finger_mesh, profiles):
    """On a mesh of any size they are viable epidermis: each intermediate ridge has a node on its tip."""
    np.testing.assert_array_equal(layer_at(finger_mesh, profiles.merkel_sites()), tags.VIABLE_EPIDERMIS)


def test_cells_at_the_meissner_sites(finger_mesh, profiles):
    """On a mesh of any size they are dermis: each papilla has a node on its top."""
    np.testing.assert_array_equal(layer_at(finger_mesh, profiles.meissner_sites()), tags.DERMIS)


@pytest.mark.mpi
def test_bone_rim(finger_mesh, profiles):
    """The rim is closed: its normals add up to nothing; its length is the ellipse's. Tolerance: chords of 1 mm."""
    ds = ufl.Measure("ds", finger_mesh.mesh, subdomain_data=finger_mesh.facet_tags)(tags.BONE_RIM)
    comm, n = finger_mesh.mesh.comm, ufl.FacetNormal(finger_mesh.mesh)
    rim = profiles.bone(np.linspace(-np.pi, np.pi, 20001))
    length = np.linalg.norm(np.diff(rim, axis=0), axis=1).sum()
    one = fem.Constant(finger_mesh.mesh, 1.0)
    assert comm.allreduce(fem.assemble_scalar(fem.form(one * ds))) == pytest.approx(length, rel=1e-2)
    for k in (0, 1):
        assert abs(comm.allreduce(fem.assemble_scalar(fem.form(n[k] * ds)))) < 1e-12 * length


def test_ridge_tags():
    assert [tags.ridge_index(tags.ridge(j)) for j in (-50, -1, 0, 50)] == [-50, -1, 0, 50]
    others = [*tags.LAYERS.values(), tags.BONE_RIM, tags.OUTER_SKIN, tags.NAIL_SURFACE, tags.SIDES]
    assert not {tags.ridge(j) for j in range(-50, 51)} & set(others)


# -- refusals ------------------------------------------------------------------------------------------
LENGTHS = [name for name, field in Fingertip.model_fields.items() if field.annotation is float]
SIZES = ["contact", "receptor", "interface", "coarsest", "growth", "touching_half_arc", "touching_fraction"]


@pytest.mark.parametrize("value", [0.0, -1e-3, float("nan"), float("inf"), "thick"])
@pytest.mark.parametrize("name", LENGTHS)
def test_length_is_refused(name, value):
    with pytest.raises(ValidationError, match=name):
        Fingertip(**{name: value})


@pytest.mark.parametrize("value", [0.0, -1e-3, float("nan"), float("inf"), "fine"])
@pytest.mark.parametrize("name", SIZES)
def test_size_is_refused(name, value):
    with pytest.raises(ValidationError, match=name):
        MeshSize(**{name: value})


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"ridge_count": 54}, "ridge_count is 54; it must be odd"),
        ({"ridge_count": -1}, "ridge_count"),
        ({"ridge_profile": (0.0, 0.0)}, "ridge_profile has only zero coefficients"),
        ({"nail_half_width": 10e-3}, "nail_half_width is 0.01 m; it must be below half the width, 0.01 m"),
        ({"nail_bed_half_width": 4e-3}, "nail_bed_half_width is 0.004 m; it must be below half the bone_width"),
        ({"nail_thickness": 2e-3}, "nail_thickness is 0.002 m; it must be below the thickness of the skin layers"),
        ({"fingernail": 1e-3}, "fingernail"),
    ],
)
def test_parameters_are_refused(given, message):
    with pytest.raises(ValidationError, match=message):
        Fingertip(**given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"ve_thickness": 150e-6}, "SC-VE junction and VE-D junction cross by .*ve_thickness is 0.00015 m"),
        ({"limiting_ridge_height": 450e-6}, "SC-VE junction and VE-D junction cross by .*ve_thickness is 0.000175 m"),
        ({"dermis_thickness": 100e-6}, "VE-D junction and D-subcutis junction cross by .*dermis_thickness is 0.0001 m"),
        ({"ridge_count": 101}, "ridge_count 101 of ridge_wavelength 0.000483 m do not fit"),
        ({"dermis_thickness": 5e-3}, "0.00565 m deep, more than the outline's radius of curvature, 0.0049 m"),
        ({"bone_centre": 4.5e-3}, "bone touches the skin's layers at .*bone_centre"),
        ({"bone_width": 17e-3}, "bone touches the skin's layers at .*bone_width"),
        ({"bone_height": 13e-3}, "bone touches the skin's layers at .*bone_height"),
        ({"bone_centre": 10.95e-3}, "bone reaches the nail: .* is at 0.01355 m and must stay below .* 0.0135 m"),
    ],
)
def test_fingertip_is_refused(given, message):
    """What crosses, and the parameter, are named."""
    with pytest.raises(GeometryError, match=message):
        Profiles(Fingertip(**given)).check()


def test_default_is_accepted(profiles):
    profiles.check()


def test_least_thickness_that_is_named_is_the_least():
    """A micrometre more than the message asks for is accepted, a micrometre less is not."""
    with pytest.raises(GeometryError) as refusal:
        Profiles(Fingertip(ve_thickness=100e-6)).check()
    least = float(str(refusal.value).split()[-2])
    Profiles(Fingertip(ve_thickness=least + UM)).check()
    with pytest.raises(GeometryError):
        Profiles(Fingertip(ve_thickness=least - UM)).check()


@pytest.mark.parametrize("wavelength", [460e-6, 483e-6, 500e-6])
def test_most_ridges_that_are_named_fit(wavelength):
    """The message gives a number that is accepted, and the next odd one is not."""
    with pytest.raises(GeometryError) as refusal:
        Profiles(Fingertip(ridge_count=101, ridge_wavelength=wavelength)).check()
    most = int(str(refusal.value).split()[-2])
    Profiles(Fingertip(ridge_count=most, ridge_wavelength=wavelength)).check()
    with pytest.raises(GeometryError):
        Profiles(Fingertip(ridge_count=most + 2, ridge_wavelength=wavelength)).check()


def test_contact_size_is_refused():
    with pytest.raises(GeometryError, match="contact size 0.00013 m is too large for a ridge of 0.000483 m"):
        fingertip.check(Fingertip(), MeshSize(contact=130e-6))


@pytest.mark.mpi
@pytest.mark.parametrize("error", [GeometryError, RuntimeError, ZeroDivisionError])
def test_refusal_reaches_every_rank(error):
    """A builder runs on one rank; what it raises is raised on all, and the next mesh can be built."""

    def refuse() -> float:
        raise error("no such body")

    with pytest.raises(error, match="no such body"):
        load(MPI.COMM_WORLD, refuse)
    assert not gmsh.isInitialized()
    assert load(MPI.COMM_WORLD, partial(block, MM, MM, MM)).mesh.topology.index_map(2).size_global == 2


@pytest.mark.mpi
def test_missing_tag_is_refused():
    build = partial(block, MM, MM, 0.5 * MM)
    load(MPI.COMM_WORLD, build, [tags.STRATUM_CORNEUM, tags.ridge(0), tags.BONE_RIM, tags.SIDES])
    with pytest.raises(GeometryError, match=f"no cell or facet with tag {tags.NAIL_SURFACE}"):
        load(MPI.COMM_WORLD, build, [tags.SIDES, tags.NAIL_SURFACE])


# -- verification bodies -------------------------------------------------------------------------------
def lengths(body) -> dict[int, float]:
    """Return the length of each facet group on all ranks."""
    ds, one = ufl.Measure("ds", body.mesh, subdomain_data=body.facet_tags), fem.Constant(body.mesh, 1.0)
    groups = (tags.ridge(0), tags.BONE_RIM, tags.SIDES)
    return {tag: body.mesh.comm.allreduce(fem.assemble_scalar(fem.form(one * ds(tag)))) for tag in groups}


@pytest.mark.mpi
def test_block():
    """Its area, its faces and the heights of bottom and top; 5 x 2 rectangles, as 0.21 mm go into 1 mm five times.

    Tolerance: roundoff.
    """
    body = load(MPI.COMM_WORLD, partial(block, MM, 0.4 * MM, 0.21 * MM, gap=7 * UM))
    assert body.mesh.topology.index_map(2).size_global == 20
    assert integral(body, tags.STRATUM_CORNEUM) == pytest.approx(0.4 * MM**2, rel=1e-12, abs=0)
    expected = {tags.ridge(0): MM, tags.BONE_RIM: MM, tags.SIDES: 0.8 * MM}
    assert lengths(body) == pytest.approx(expected, rel=1e-12, abs=0)
    mean_height = integral(body, tags.STRATUM_CORNEUM, ufl.SpatialCoordinate(body.mesh)[1]) / (0.4 * MM**2)
    assert mean_height == pytest.approx(207 * UM, rel=1e-12, abs=0)
    assert body.ridges() == [0]


@pytest.mark.mpi
def test_one_ridge():
    """Its area is w (h - A / 2), its sides h - A each, its bottom a sinusoid's length. Tolerance: chords of 10 um."""
    body = load(MPI.COMM_WORLD, partial(ridge, 10 * UM))
    x = np.linspace(-0.5, 0.5, 20001) * 483 * UM
    y = 50 * UM * (1 - np.cos(2 * np.pi * x / (483 * UM)))
    expected = {tags.ridge(0): np.hypot(np.diff(x), np.diff(y)).sum(), tags.BONE_RIM: 483 * UM, tags.SIDES: 1000 * UM}
    assert lengths(body) == pytest.approx(expected, rel=1e-3)
    assert integral(body, tags.STRATUM_CORNEUM) == pytest.approx(483 * UM * 550 * UM, rel=1e-3)
    assert body.ridges() == [0]


@pytest.mark.mpi
def test_quarter_tube():
    """Its arcs are 24 chords each, on its radii about an axis 4 mm up, its wall the area between; up to roundoff."""
    body, n = load(MPI.COMM_WORLD, partial(quarter_tube, MM, 2 * MM, 24)), 24
    assert body.mesh.topology.index_map(2).size_global == 2 * n**2
    chord = 2 * n * np.sin(np.pi / 4 / n) * MM
    assert lengths(body) == pytest.approx(
        {tags.ridge(0): 2 * chord, tags.BONE_RIM: chord, tags.SIDES: 2 * MM}, rel=1e-12, abs=0
    )
    area = n / 2 * np.sin(np.pi / 2 / n) * (4 - 1) * MM**2
    assert integral(body, tags.STRATUM_CORNEUM) == pytest.approx(area, rel=1e-12, abs=0)
    for tag, radius in ((tags.ridge(0), 2 * MM), (tags.BONE_RIM, MM)):
        x = vertices(body, body.facet_tags.find(tag))
        np.testing.assert_allclose(np.hypot(x[:, 0], x[:, 1] - 4 * MM), radius, rtol=1e-12)


@pytest.mark.mpi
def test_cooks_membrane():
    """Its edges' lengths and its area, 48 mm times the mean of 44 and 16 mm; tolerance: roundoff."""
    body = load(MPI.COMM_WORLD, partial(cooks_membrane, 3))
    assert body.mesh.topology.index_map(2).size_global == 18
    expected = {tags.ridge(0): np.hypot(48, 44), tags.BONE_RIM: 44.0, tags.SIDES: 16 + np.hypot(48, 16)}
    assert lengths(body) == pytest.approx({tag: value * MM for tag, value in expected.items()}, rel=1e-12)
    assert integral(body, tags.STRATUM_CORNEUM) == pytest.approx(48 * 30 * MM**2, rel=1e-12, abs=0)
    lowest = MPI.COMM_WORLD.allreduce(float(body.mesh.geometry.x[:, 1].min()), op=MPI.MIN)
    assert lowest == pytest.approx(10 * MM, rel=1e-12, abs=0)


def bottom(body) -> np.ndarray:
    """Return the bottom's nodes from left to right, shape (nodes, 2)."""
    nodes = vertices(body, body.facet_tags.find(tags.ridge(0)))[:, :2]
    return nodes[np.argsort(nodes[:, 0])]


def test_pad():
    """Its bottom is a parabola, the facets beside the tip are as long as asked for, and the tip is a node.

    Tolerance: roundoff; gmsh places nodes along a spline to a millionth of their distance.
    """
    size, radius, span = 10 * UM, 0.1, 2 * MM
    body = load(MPI.COMM_SELF, partial(pad, size, 8, radius, span))
    x, y = bottom(body).T
    np.testing.assert_allclose(y, x**2 / (2 * radius), rtol=0, atol=1e-12 * span)
    np.testing.assert_allclose(x[np.abs(x) < 8.5 * size], size * np.arange(-8, 9), rtol=0, atol=1e-6 * size)
    assert lengths(body)[tags.BONE_RIM] == pytest.approx(span, rel=1e-12, abs=0)
    assert lengths(body)[tags.SIDES] == pytest.approx(2 * (span - span**2 / 8 / radius), rel=1e-12)


def test_foot():
    """Flat within its half-width, recessed by the step a facet farther out. Tolerance: roundoff."""
    size, half_width, step, span = 10 * UM, 0.2 * MM, 2 * UM, 2 * MM
    body = load(MPI.COMM_SELF, partial(foot, size, half_width, step, span))
    x, y = bottom(body).T
    np.testing.assert_allclose(y, np.where(np.abs(x) < half_width + size / 2, 0.0, step), rtol=0, atol=1e-12 * span)
    assert np.abs(np.abs(x[y > step / 2]).min() - half_width - size) < 1e-12 * span
    assert lengths(body)[tags.BONE_RIM] == pytest.approx(span, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("build", "name"), [(partial(pad, MM, 8, 0.1, 2 * MM), "flank"), (partial(foot, UM, MM, UM, MM), "recess")]
)
def test_body_without_its_sides_is_refused(build, name):
    with pytest.raises(GeometryError, match=f"{name} is .*; it must be positive"):
        build()


@pytest.mark.parametrize("value", [0.0, -1e-3, float("nan"), float("inf")])
@pytest.mark.parametrize(
    ("build", "name"), [(block, "width"), (block, "height"), (block, "size"), (ridge, "size"), (ridge, "amplitude")]
)
def test_verification_body_is_refused(build, name, value):
    lengths = {"width": MM, "height": MM, "size": MM, name: value}
    with pytest.raises(GeometryError, match=f"{name} is .*; it must be positive"):
        build(**lengths)


def test_ridge_without_a_top_is_refused():
    with pytest.raises(GeometryError, match="amplitude is 0.001 m; it must be below the height, 0.0006 m"):
        ridge(10 * UM, amplitude=MM)


def test_tube_without_a_wall_is_refused():
    with pytest.raises(GeometryError, match="inner is 0.001 m; it must be below the outer radius, 0.001 m"):
        quarter_tube(MM, MM, 4)
