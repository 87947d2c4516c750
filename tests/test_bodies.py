"""Bodies of the verification and the layered strip: their sizes, their groups and what they refuse."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import ufl
from mpi4py import MPI
from numpy.testing import assert_allclose

from benchmarks.stability import solve, strip
from benchmarks.stability.solve import Case
from geometry import tags
from geometry.bodies import block, pad, ridge
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError
from tests.measures import integral, vertices
from tests.test_fingertip import MM, UM


def lengths(body) -> dict[int, float]:
    """Return the length of each facet group on all ranks."""
    groups = (tags.ridge(0), tags.BONE_RIM, tags.SIDES)
    return {tag: integral(body, tag, kind="ds") for tag in groups}


@pytest.mark.mpi
def test_block():
    """Its area, its faces and the heights of bottom and top; 5 x 2 rectangles, as 0.21 mm go into 1 mm five times.

    Tolerance: roundoff.
    """
    body = load(MPI.COMM_WORLD, block(MM, 0.4 * MM, 0.21 * MM, gap=7 * UM))
    assert body.mesh.topology.index_map(2).size_global == 20
    assert integral(body, tags.STRATUM_CORNEUM) == pytest.approx(0.4 * MM**2, rel=1e-12, abs=0)
    expected = {tags.ridge(0): MM, tags.BONE_RIM: MM, tags.SIDES: 0.8 * MM}
    assert lengths(body) == pytest.approx(expected, rel=1e-12, abs=0)
    mean_height = integral(body, tags.STRATUM_CORNEUM, ufl.SpatialCoordinate(body.mesh)[1]) / (0.4 * MM**2)
    assert mean_height == pytest.approx(207 * UM, rel=1e-12, abs=0)
    assert body.ridges() == [0]


def bottom(body) -> np.ndarray:
    """Return the bottom's nodes from left to right, shape (nodes, 2)."""
    nodes = vertices(body, body.facet_tags.find(tags.ridge(0)))[:, :2]
    return nodes[np.argsort(nodes[:, 0])]


def test_pad():
    """Its bottom is a parabola, the facets beside the tip are as long as asked for, and the tip is a node.

    Tolerance: roundoff; gmsh places nodes along a spline to a millionth of their distance.
    """
    size, radius, span = 10 * UM, 0.1, 2 * MM
    body = load(MPI.COMM_SELF, pad(size, 8, radius, span))
    x, y = bottom(body).T
    np.testing.assert_allclose(y, x**2 / (2 * radius), rtol=0, atol=1e-12 * span)
    np.testing.assert_allclose(x[np.abs(x) < 8.5 * size], size * np.arange(-8, 9), rtol=0, atol=1e-6 * size)
    assert lengths(body)[tags.BONE_RIM] == pytest.approx(span, rel=1e-12, abs=0)
    assert lengths(body)[tags.SIDES] == pytest.approx(2 * (span - span**2 / 8 / radius), rel=1e-12)


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (pad(MM, 8, 0.1, 2 * MM), "flank is .*; it must be positive"),
        (
            ridge(240 * UM),
            "size is 0.00024 m, too large for a tip with a radius of 0.000118 m; it must",
        ),
        (ridge(10 * UM, amplitude=MM), "amplitude is 0.001 m; it must be below the height, 0.0006 m"),
    ],
)
def test_body_that_cannot_be_made_is_refused(build, words):
    with pytest.raises(GeometryError, match=words):
        build()


# -- the layered strip against the finger's curves and plane geometry ------------------------------------------------
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


# -- single runs of a coarse strip: what they reach, and how a failure is recorded -----------------------------------
# A press of half an newton a metre on facets of 60 um: two seconds a run.
TINY = Case(contact_size=60e-6, force=0.5, voltage=50.0, element="P1", slide=0.0)


@pytest.mark.slow
def test_friction_at_full_slip():
    """Pressed without voltage the ridge bears the force, and the screen drags with mu_0 times it, to the solve's."""
    found = solve.run(replace(TINY, voltage=0.0, slide=1e-3))
    assert found.status == "converged" and found.full_slip
    assert found.f_ext == pytest.approx(0.5, rel=1e-7)
    assert found.f_t == pytest.approx(0.25 * 0.5, rel=1e-6)
    assert found.contact_length > 0 < found.penetration


@pytest.mark.slow
def test_failure_is_recorded_with_its_reason():
    """A penalty 1e12 times the default leaves no digits: the run says by which name and in which load it ended."""
    found = solve.run(replace(TINY, parameter=1.5e24))
    assert found.status == "failed" and found.load == "press"
    assert found.reason.startswith("DIVERGED_") and found.reason in found.message
