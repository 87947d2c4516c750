"""A scene on the mesh of a gmsh file: the same numbers as on its own mesh, what is left out, and what is refused."""

import re
from pathlib import Path

import gmsh
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.scene import from_data
from geometry import fingertip
from geometry.parameters import Fingertip, MeshSize
from tests.measures import rows_of
from tests.test_meshfile import write

pytestmark = pytest.mark.slow
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


def test_study_with_a_mesh_runs_its_points(place, tmp_path):
    """Each in a process of its own, from what is kept of the scene; the path starts at the file of the study."""
    write(place)
    file = place.with_name("study.toml")
    text = 'friction = 0.0\n[geometry]\nfile = "mine.msh"\n[[history]]\nname = "press"\nf_ext = 2.0\n'
    file.write_text(f'{text}[output]\nerrors = false\n[sweep]\n"history[0].f_ext" = [1.0, 2.0]\n', encoding="utf-8")
    assert main(["sweep", str(file), "--out", str(tmp_path / "out"), "--jobs", "1", "--quiet"]) == 0
    forces = [float(row["history[0].f_ext"]) for row in rows_of(tmp_path / "out", "table") if not row["failure"]]
    assert forces == [1.0, 2.0]


@pytest.mark.mpi
def test_same_numbers_as_on_its_own_mesh(place):
    """The file's decimals are good for 1e-15 of a coordinate. A bone moved sideways needs both halves of either."""
    mesh = {"mesh": SIZE | {"touching_half_arc": 2e-3}, "geometry": {"ridge_count": 13}}
    own = fp.run(scene(history=[{"name": "press", "f_ext": 5.0}, {"name": "nudge", "bone_x": 1e-9}], **mesh))
    file = fp.run(
        scene(
            history=[{"name": "press", "f_ext": 5.0}, {"name": "nudge", "bone_x": 1e-9}],
            geometry={"file": write(place, finger(2e-3))},
        )
    )
    assert not file.failure
    assert file.charged.bone_height == pytest.approx(own.charged.bone_height, rel=1e-9)
    assert file.charged.contact_length == pytest.approx(own.charged.contact_length, rel=1e-9)
    assert file.steps[-1].mesh_contact < 100e-6  # that of the file: the shortest facet that can touch


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"geometry": {"file": "gone.msh"}}, "geometry.file is 'gone.msh', and there is no such file"),
        ({"geometry": {"file": "m.msh", "width": 0.02}}, "geometry.width is given and geometry.file too, whose mesh"),
        ({"geometry": {"file": "m.msh"}, "mesh": {"contact": 1e-5}}, "mesh.contact is given and geometry.file too"),
        ({"geometry": {"file": "m.msh"}, "accuracy": {"mu_app": 0.01}}, "accuracy is given and geometry.file too"),
    ],
)
def test_file_that_cannot_be_is_refused(given, words, tmp_path, monkeypatch):
    """Before anything is meshed, in one sentence."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(fp.SceneError, match=f"^{re.escape(words)}") as refused:
        from_data(given)
    assert "\n" not in str(refused.value)


def write_text(path: Path, text: str) -> str:
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.mpi
def test_bad_file_is_refused(place):
    if MPI.COMM_WORLD.rank == 0:
        place.write_text("no mesh", encoding="utf-8")
    MPI.COMM_WORLD.barrier()
    with pytest.raises(fp.SceneError, match=r"^mesh: .*mine\.msh is no mesh of gmsh; it must be a \.msh file"):
        fp.run(scene(geometry={"file": place}))
