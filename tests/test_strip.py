"""The layered strip against the finger's curves and plane geometry, and what is refused."""

from functools import partial

import numpy as np
import pytest
import ufl
from mpi4py import MPI
from numpy.testing import assert_allclose

from benchmarks.stability import strip
from geometry import tags
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError, Profiles
from tests.measures import integral, vertices

UM = 1e-6
WAVE, HEIGHT = Fingertip().ridge_wavelength, 1500 * UM
SIZE = MeshSize(contact=20 * UM, interface=60 * UM)


@pytest.fixture(scope="module", params=[1, 3])
def body(request):
    return request.param, load(MPI.COMM_WORLD, partial(strip.build, Fingertip(), SIZE, request.param, HEIGHT))


def mean_depths() -> list[float]:
    """Return the mean heights of skin, SC-VE, VE-D junction and top: those of the finger's layers."""
    return [50 * UM, (50 + 425) * UM, (50 + 425 + 175) * UM, HEIGHT]


@pytest.mark.mpi
def test_area(body):
    """Each layer is its mean thickness wide times the strip's width.

    Tolerance: facets of up to 60 um cut the waves by 6e-4.
    """
    ridges, mesh = body
    expected = np.diff(mean_depths()) * ridges * WAVE
    found = [integral(mesh, tag) for tag in strip.LAYERS]
    assert_allclose(found, expected, rtol=2e-3)


@pytest.mark.mpi
def test_layers_are_mirrored(body):
    """Left and right of x = 0 weigh the same. Tolerance: the placing of nodes along mirrored curves."""
    ridges, mesh = body
    x = ufl.SpatialCoordinate(mesh.mesh)[0]
    for tag in strip.LAYERS:
        moment = integral(mesh, tag, x)
        assert abs(moment) < 1e-5 * ridges * WAVE * integral(mesh, tag)


@pytest.mark.mpi
def test_ridges(body):
    """As many as asked for, ridge 0 in the middle, each a sinusoid long.

    Tolerance: chords of h = 60 um in grooves of radius r = 118 um are short by (h / r)^2 / 24 = 1 %, most far less.
    Centres are where they belong to the placing of nodes along mirrored curves.
    """
    ridges, mesh = body
    assert mesh.ridges() == list(range(-(ridges // 2), ridges // 2 + 1))
    x = np.linspace(-0.5, 0.5, 20001) * WAVE
    y = Profiles(Fingertip()).skin(x)
    length = np.hypot(np.diff(x), np.diff(y)).sum()
    for j in mesh.ridges():
        found = integral(mesh, tags.ridge(j), kind="ds")
        assert found == pytest.approx(length, rel=3e-3)
        centre = integral(mesh, tags.ridge(j), ufl.SpatialCoordinate(mesh.mesh)[0], "ds") / found
        assert centre == pytest.approx(j * WAVE, abs=1e-6 * WAVE)


@pytest.mark.mpi
def test_rim_and_sides(body):
    """The top is as wide as the ridges and at its height; the sides reach from the grooves to it.

    Tolerance: roundoff.
    """
    ridges, mesh = body
    assert integral(mesh, tags.BONE_RIM, kind="ds") == pytest.approx(ridges * WAVE, rel=1e-12, abs=0)
    height = integral(mesh, tags.BONE_RIM, ufl.SpatialCoordinate(mesh.mesh)[1], "ds") / (ridges * WAVE)
    assert height == pytest.approx(HEIGHT, rel=1e-12, abs=0)
    assert integral(mesh, tags.SIDES, kind="ds") == pytest.approx(2 * (HEIGHT - 100 * UM), rel=1e-12, abs=0)


def test_tips_are_on_the_screen(body):
    """The lowest nodes of the mesh are at y = 0, one a ridge, a multiple of the wavelength apart.

    Tolerance: a millionth of a micrometre.
    """
    ridges, mesh = body
    x, y = mesh.mesh.geometry.x[:, 0], mesh.mesh.geometry.x[:, 1]
    assert y.min() == pytest.approx(0, abs=1e-12)
    low = np.sort(x[y < 1e-12])
    assert_allclose(low, (np.arange(ridges) - ridges // 2) * WAVE, rtol=0, atol=1e-12)


def test_contact_size():
    """Facets about a tip are as long as asked. Tolerance: gmsh's freedom to space them, -9 % to 2 %."""
    mesh = load(MPI.COMM_WORLD, partial(strip.build, Fingertip(), MeshSize(contact=5 * UM, interface=60 * UM)))
    x = vertices(mesh, mesh.facet_tags.find(tags.ridge(0)))[:, 0]
    spacing = np.diff(np.sort(x[np.abs(x) < 0.15 * WAVE]))
    assert spacing.max() < 1.1 * 5 * UM
    assert spacing.min() > 0.8 * 5 * UM


def test_finger_without_ridged_flanks():
    """A finger of one ridge makes a strip of one, whose grooves reach their full depth. Tolerance: roundoff."""
    mesh = load(MPI.COMM_WORLD, partial(strip.build, Fingertip(ridge_count=1), SIZE))
    assert integral(mesh, tags.SIDES, kind="ds") == pytest.approx(2 * (HEIGHT - 100 * UM), rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("finger", "arguments", "message"),
    [
        ({}, {"ridges": 2}, "ridges is 2; it must be odd"),
        ({}, {"ridges": 0}, "ridges is 0; it must be odd"),
        ({}, {"ridges": 5}, "ridges is 5; .* at most 3"),
        ({"ridge_count": 1}, {"ridges": 3}, "ridges is 3; .* at most 1"),
        ({}, {"height": 900 * UM}, "height is 0.0009 m; it must exceed that of the VE-D junction, 0.00095 m"),
        ({}, {"height": float("nan")}, "height is nan m"),
        ({}, {"height": float("inf")}, "height is inf m"),
        ({"ve_thickness": 150 * UM}, {}, "SC-VE junction and VE-D junction cross by .*ve_thickness is 0.00015 m"),
    ],
)
def test_strip_is_refused(finger, arguments, message):
    with pytest.raises(GeometryError, match=message):
        strip.check(Fingertip(**finger), SIZE, **({"ridges": 1, "height": HEIGHT} | arguments))


def test_contact_size_is_refused():
    with pytest.raises(GeometryError, match="contact size 0.00013 m is too large for a ridge of 0.000483 m"):
        strip.check(Fingertip(), MeshSize(contact=130 * UM), 1, HEIGHT)


def test_least_height_that_is_named_is_the_least():
    """A micrometre more than the message asks for is accepted."""
    with pytest.raises(GeometryError) as refusal:
        strip.check(Fingertip(), SIZE, 1, 100 * UM)
    strip.check(Fingertip(), SIZE, 1, float(str(refusal.value).split()[-2]) + UM)
