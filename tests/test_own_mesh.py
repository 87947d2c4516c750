"""A scene on the mesh of a gmsh file: the same numbers as on its own mesh, what is left out, and what is refused."""

from pathlib import Path

import gmsh
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.model.check import check
from fingerpad.model.options import plan
from fingerpad.scene import from_data
from geometry import fingertip
from geometry.parameters import Fingertip, MeshSize
from tests.test_meshfile import write

FINGER = Fingertip(ridge_count=13)
SIZE = {"contact": 100e-6, "receptor": 200e-6, "interface": 200e-6, "growth": 0.5, "coarsest": 1e-3}
OUTPUT = {"errors": False, "receptors": False}


def scene(f_ext: float = 5.0, **more) -> fp.Scene:
    """Return a scene that is pressed alone, with no friction and no voltage."""
    history = [{"name": "press", "f_ext": f_ext}]
    return from_data({"friction": 0.0, "history": history, "output": OUTPUT, **more})


def finger(half_arc: float):
    """Return what meshes the default finger with thirteen ridges, in metres, whose ridges within an arc can touch."""

    def build() -> None:
        fingertip.build(FINGER, MeshSize(**SIZE, touching_half_arc=half_arc), False)
        gmsh.model.mesh.affineTransform([1e-3, 0, 0, 0, 0, 1e-3, 0, 0, 0, 0, 1e-3, 0])

    return build


@pytest.fixture
def place(tmp_path) -> Path:
    """A path of a file, the same on every rank."""
    return Path(MPI.COMM_WORLD.bcast(str(tmp_path / "mine.msh")))


@pytest.mark.mpi
def test_same_numbers_as_on_its_own_mesh(place):
    """The file's decimals are good for 1e-15 of a coordinate. A bone moved sideways needs both halves of either."""
    mesh = {"mesh": SIZE | {"touching_half_arc": 2e-3}, "geometry": {"ridge_count": 13}}
    own = fp.run(scene(history=[{"name": "press", "f_ext": 5.0}, {"name": "nudge", "bone_x": 1e-9}], **mesh))
    file = fp.run(
        scene(history=[{"name": "press", "f_ext": 5.0}, {"name": "nudge", "bone_x": 1e-9}]),
        mesh=write(place, finger(2e-3)),
    )
    assert not file.failure
    assert file.charged.bone_height == pytest.approx(own.charged.bone_height, rel=1e-9)
    assert file.charged.contact_length == pytest.approx(own.charged.contact_length, rel=1e-9)
    assert file.steps[-1].mesh_contact < 100e-6  # that of the file: the shortest facet that can touch


def test_skin_outside_the_ridges_touches(place):
    """With ridge 0 alone ready for contact, its neighbours come down: the run stops and says what the file lacks."""
    with pytest.warns(UserWarning, match="outer skin"):
        result = fp.run(scene(20.0), mesh=write(place, finger(1e-6)))
    assert "skin of the group 'outer skin' is at a height of -" in result.failure
    assert "mine.msh must have more ridges, or f_ext be smaller" in result.failure
    assert len(result.steps) > 0


def test_one_ridge_of_one_layer_runs(place):
    """A body that is no finger: one layer, one ridge, no outer skin to watch."""
    result = fp.run(scene(2.0), mesh=write(place))
    assert result.failure is None or result.failure == ""
    assert result.charged.f_contact == pytest.approx(2.0, rel=1e-6)


def test_what_is_left_out_is_said(place):
    whole = scene(output={"errors": True, "receptors": True}).with_laws(mesh=write(place))
    needed = plan(whole)
    assert (needed.receptors, needed.errors, needed.both_halves) == (False, False, True)
    said = {omission.what: omission.reason for omission in needed.omitted}
    assert said["receptor sites"] == "the mesh is of a file"
    assert said["discretisation errors"] == "the mesh is of a file and cannot be refined"


def test_accuracy_is_refused(place):
    asked = from_data({"accuracy": {"mu_app": 0.01}}).with_laws(mesh=write(place))
    with pytest.raises(fp.SceneError, match="accuracy is given and the mesh is of a file, which cannot be refined"):
        check(asked)


@pytest.mark.mpi
def test_bad_file_is_refused(place):
    if MPI.COMM_WORLD.rank == 0:
        place.write_text("no mesh", encoding="utf-8")
    MPI.COMM_WORLD.barrier()
    with pytest.raises(fp.SceneError, match=r"^mesh: .*mine\.msh is no mesh of gmsh; it must be a \.msh file"):
        fp.run(scene(), mesh=place)
