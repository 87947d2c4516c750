"""Shapes, sizes, meshes and needs of memory that are refused, in one sentence."""

from functools import partial

import gmsh
import numpy as np
import pytest
from mpi4py import MPI
from pydantic import ValidationError

from fingerpad.model.options import check, memory
from fingerpad.scene import SceneError, from_data
from geometry import fingertip, sizing
from geometry.bodies import block
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError, Profiles
from geometry.sizing import least_triangles
from tests.test_fingertip import MM

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
        ({"ridge_profile": (0.0, 0.0)}, "ridge_profile has only zero coefficients"),
        ({"nail_half_width": 10e-3}, "nail_half_width is 0.01 m; it must be below half the width, 0.01 m"),
        ({"nail_thickness": 2e-3}, "nail_thickness is 0.002 m; it must be below the thickness of the skin layers"),
    ],
)
def test_parameters_are_refused(given, message):
    with pytest.raises(ValidationError, match=message):
        Fingertip(**given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"ve_thickness": 150e-6}, "SC-VE junction and VE-D junction cross by .*ve_thickness is 0.00015 m"),
        ({"ve_thickness": 136e-6, "ridge_count": 3}, "VE-D junction cross by .*must exceed 0.0001"),
        ({"ridge_count": 1}, "ridge_count is 1; a whole finger has 3 ridges at least"),
        (
            {
                **{"width": 4e-3, "height": 3e-3, "bone_width": 1.6e-3, "bone_height": 0.8e-3, "bone_centre": 1.7e-3},
                **{"nail_half_width": 1e-3, "nail_bed_half_width": 0.4e-3, "ridge_wavelength": 5e-3},
            },
            "between the nail's edges; 3 do where ridge_wavelength is 0.00[0-9]+ m or less",
        ),
        ({"dermis_thickness": 100e-6}, "VE-D junction and D-subcutis junction cross by .*dermis_thickness is 0.0001 m"),
        (
            {"merkel_offset": 900e-6},
            "merkel_offset is 0.0009 m; it must be below the thickness of the viable epidermis",
        ),
        (
            {"meissner_offset": 1e-3, "dermis_thickness": 800e-6},
            "meissner_offset is 0.001 m; it must be below the height",
        ),
        ({"dermis_thickness": 3.8e-3}, "layers end inside the bone at the nail's edge: reduce dermis_thickness"),
        (
            {"nail_thickness": 475e-6},
            "nail_thickness is 0.000475 m, the depth of the SC-VE junction at the nail's edge",
        ),
        ({"dermis_thickness": 5e-3}, "0.00565 m deep, more than the outline's radius of curvature, 0.0049 m"),
        ({"bone_centre": 4.5e-3}, "bone touches the skin's layers at .*bone_centre"),
        ({"bone_centre": 10.95e-3}, "bone reaches the nail: .* is at 0.01355 m and must stay below .* 0.0135 m"),
    ],
)
def test_fingertip_is_refused(given, message):
    """What crosses, and the parameter, are named."""
    with pytest.raises(GeometryError, match=message):
        sizing.check_shape(Profiles(Fingertip(**given)))


def test_skin_that_a_facet_cannot_follow_is_refused():
    """Where it can touch, it turns by 2 rad along a facet at most; its circle is that of differences."""
    sharp = Fingertip(ridge_profile=(1.0, 0, 0, 0, 0, 0, 0, 0.3))
    message = r"contact size 2e-05 m is too large for skin that has a radius of curvature of .*: at most [0-9.e-]+ m$"
    with pytest.raises(GeometryError, match=message) as refusal:
        sizing.check(sharp, MeshSize(contact=20e-6))
    largest = float(str(refusal.value).split()[-2])
    profiles = sizing.check(sharp, MeshSize(contact=largest))
    s = np.linspace(-60e-6, 60e-6, 120_001)
    slope = np.gradient(profiles.skin(s), s)
    radius = (1 + slope**2) ** 1.5 / np.abs(np.gradient(slope, s))
    assert radius[5:-5].min() == pytest.approx(largest / 2, rel=2e-2)
    assert profiles.radius(s)[5:-5] == pytest.approx(radius[5:-5], rel=1e-3)


@pytest.mark.mpi
@pytest.mark.parametrize("error", [GeometryError, RuntimeError, ZeroDivisionError])
def test_refusal_reaches_every_rank(error):
    """A builder runs on one rank; what it raises is raised on all, and the next mesh can be built."""

    def refuse() -> float:
        raise error("no such body")

    with pytest.raises(error, match="no such body"):
        load(MPI.COMM_WORLD, refuse)
    assert not gmsh.isInitialized()
    assert load(MPI.COMM_WORLD, block(MM, MM, MM)).mesh.topology.index_map(2).size_global == 2


@pytest.mark.mpi
def test_what_gmsh_refuses_is_one_sentence():
    def refuse() -> float:
        raise Exception("Invalid boundary mesh (overlapping facets) on surface 1")

    with pytest.raises(
        GeometryError, match="gmsh cannot mesh the body: Invalid boundary mesh .*; try smaller elements"
    ):
        load(MPI.COMM_WORLD, refuse)


# -- memory by the unknowns of a mesh, its refusal, and the bound that refuses element sizes before gmsh meets them --
FINE = {"contact": 10e-6, "receptor": 10e-6, "touching_half_arc": 1.0e-3}
COARSE = {"contact": 30e-6, "receptor": 60e-6, "interface": 120e-6, "growth": 0.5, "touching_half_arc": 2.0e-3}
EVEN = {"contact": 100e-6, "receptor": 100e-6, "interface": 150e-6, "coarsest": 150e-6, "touching_half_arc": 1.0e-3}


@pytest.mark.parametrize(
    ("finger", "size", "receptors", "half"),
    [
        ({}, COARSE, True, False),
        ({}, EVEN, True, True),
        ({"ridge_profile": (1.0, -0.6), "ridge_count": 15}, FINE, True, True),
    ],
)
@pytest.mark.slow
def test_triangles_are_bounded_before_meshing(finger, size, receptors, half):
    """By a third of them or more: of meshes fine at the crests, at the sites, everywhere and nowhere."""
    finger, size = Fingertip(**finger), MeshSize(**size)
    body = load(MPI.COMM_SELF, partial(fingertip.build, finger, size, receptors, half))
    triangles = body.mesh.topology.index_map(2).size_global
    assert triangles / 3 < least_triangles(finger, size, receptors, half) <= triangles


@pytest.mark.parametrize(("number", "gigabytes"), [(27258, 0.354), (73208, 0.561), (186302, 1.171), (873366, 5.729)])
def test_memory_of_runs(number, gigabytes):
    """Measured, in GB, of runs with quadratic elements: never more than by the constant, and a fifth less at most."""
    assert 0.995 * gigabytes < memory(number) / 1e9 < gigabytes / 0.8


@pytest.mark.parametrize(("mesh", "key"), [({"contact": 1e-8}, "contact"), ({"interface": 1e-8}, "interface")])
def test_too_fine_a_mesh(mesh, key):
    """The size that would help most is named, and a larger bound lets the scene pass."""
    with pytest.raises(SceneError, match=f"numerics.memory allows 16 GB: raise it, or make mesh.{key} larger"):
        check(from_data({"mesh": mesh}))
    if key == "contact":
        check(from_data({"mesh": mesh, "numerics": {"memory": 1e12}}))
