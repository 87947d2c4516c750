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
def test_rim_and_sides(body):
    """The top is as wide as the ridges and at its height; the sides reach from the grooves to it.

    Tolerance: roundoff.
    """
    mesh = body
    assert integral(mesh, tags.BONE_RIM, kind="ds") == pytest.approx(WAVE, rel=1e-12, abs=0)
    height = integral(mesh, tags.BONE_RIM, ufl.SpatialCoordinate(mesh.mesh)[1], "ds") / (WAVE)
    assert height == pytest.approx(HEIGHT, rel=1e-12, abs=0)
    assert integral(mesh, tags.SIDES, kind="ds") == pytest.approx(2 * (HEIGHT - 100 * UM), rel=1e-12, abs=0)
