"""The layered strip against the finger's curves and plane geometry."""

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
from geometry.profiles import Profiles
from tests.measures import integral

UM = 1e-6
WAVE, HEIGHT = Fingertip().ridge_wavelength, 1500 * UM
SIZE = MeshSize(contact=20 * UM, interface=60 * UM)


@pytest.fixture(scope="module")
def body():
    return load(MPI.COMM_WORLD, partial(strip.build, Fingertip(), SIZE, HEIGHT))


def mean_depths() -> list[float]:
    """Return the mean heights of skin, SC-VE, VE-D junction and top: those of the finger's layers."""
    return [50 * UM, (50 + 425) * UM, (50 + 425 + 175) * UM, HEIGHT]


@pytest.mark.mpi
def test_area(body):
    """Each layer is its mean thickness wide times the strip's width.

    Tolerance: facets of up to 60 um cut the waves by 6e-4.
    """
    expected = np.diff(mean_depths()) * WAVE
    found = [integral(body, tag) for tag in strip.LAYERS]
    assert_allclose(found, expected, rtol=2e-3)


@pytest.mark.mpi
def test_ridge(body):
    """A sinusoid long about x = 0.

    Tolerance: chords of h = 60 um in grooves of radius r = 118 um are short by (h / r)^2 / 24 = 1 %, most far less.
    """
    x = np.linspace(-0.5, 0.5, 20001) * WAVE
    length = np.hypot(np.diff(x), np.diff(Profiles(Fingertip()).skin(x))).sum()
    found = integral(body, tags.ridge(0), kind="ds")
    assert found == pytest.approx(length, rel=3e-3)
    assert integral(body, tags.ridge(0), ufl.SpatialCoordinate(body.mesh)[0], "ds") / found == pytest.approx(
        0, abs=1e-9
    )


@pytest.mark.mpi
def test_rim_and_sides(body):
    """The top is as wide as the ridges and at its height; the sides reach from the grooves to it.

    Tolerance: roundoff.
    """
    mesh = body
    assert integral(mesh, tags.BONE_RIM, kind="ds") == pytest.approx(WAVE, rel=1e-12, abs=0)
    height = integral(mesh, tags.BONE_RIM, ufl.SpatialCoordinate(mesh.mesh)[1], "ds") / (WAVE)
    assert height == pytest.approx(HEIGHT, rel=1e-12, abs=0)
    assert integral(mesh, tags.SIDES, kind="ds") == pytest.approx(2 * (HEIGHT - 100 * UM), rel=1e-12, abs=0)


def test_tip_is_on_the_screen(body):
    """The lowest node of the mesh is at the origin. Tolerance: a millionth of a micrometre."""
    x, y = body.mesh.geometry.x[:, 0], body.mesh.geometry.x[:, 1]
    assert y.min() == pytest.approx(0, abs=1e-12)
    assert_allclose(x[y < 1e-12], [0.0], rtol=0, atol=1e-12)
