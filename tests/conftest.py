"""Small meshes, shared by the tests, and tests on several ranks."""

import os
import tempfile
from functools import partial
from pathlib import Path

import pytest

from fingerpad.startup import MPI, start

start()

from fingerpad.scene import law_code
from geometry import fingertip
from geometry import mesh as meshing
from geometry.bodies import block
from geometry.mesh import TaggedMesh, load
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import Profiles


def pytest_addoption(parser):
    """Let the suite be run with other rounding: ``OPENBLAS_CORETYPE`` chooses the kernels, this the order of cells."""
    parser.addoption("--renumber", action="store_true", help="mesh with the cells in reverse order")


def pytest_configure(config):
    """Reverse the cells of every mesh that comes from gmsh, so that all sums are taken in another order."""
    if config.getoption("--renumber"):
        create = meshing.gmshio.create_mesh
        meshing.gmshio.create_mesh = lambda comm, cells, *rest, **more: create(comm, cells[::-1].copy(), *rest, **more)


def pytest_sessionstart():
    """Give each rank a folder of its own.

    Ranks that share one delete its old runs under each other's hands.
    """
    if MPI.COMM_WORLD.size > 1:
        root = Path(tempfile.gettempdir()) / f"fingerpad-tests-{os.getuid()}-{MPI.COMM_WORLD.rank}"
        root.mkdir(mode=0o700, exist_ok=True)
        os.environ["PYTEST_DEBUG_TEMPROOT"] = str(root)


def pytest_collection_modifyitems(config, items):
    """Leave out, under mpirun, what is written for one rank."""
    if MPI.COMM_WORLD.size > 1:
        config.hook.pytest_deselected(items=[item for item in items if item.get_closest_marker("mpi") is None])
        items[:] = [item for item in items if item.get_closest_marker("mpi") is not None]


@pytest.fixture(autouse=True)
def no_folder_of_a_scene():
    """Forget the folders of scenes that a test has read, from which a process takes no laws."""
    yield
    law_code._SCENES.clear()


@pytest.fixture(scope="session", autouse=True)
def meshed_once():
    """Mesh a finger once for all runs with its sizes: half a second each, and none of them changes the mesh."""
    load, made = meshing.load, {}

    def once(comm, build, needed=()):
        if getattr(build, "func", None) is not fingertip.build:
            return load(comm, build, needed)
        key = (comm.py2f(), repr((build.args, build.keywords)))
        if key not in made:
            made[key] = load(comm, build, needed)
        return made[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(meshing, "load", once)
        yield


@pytest.fixture(scope="session")
def square() -> TaggedMesh:
    """A block 1 mm wide and high, 8 x 8 x 2 cells, its bottom on the screen."""
    return load(MPI.COMM_WORLD, block(1e-3, 1e-3, 0.125e-3))


@pytest.fixture(scope="session")
def coarse() -> MeshSize:
    """Element sizes of a fingertip that is meshed in seconds; nine ridges can touch."""
    return MeshSize(contact=30e-6, receptor=80e-6, interface=120e-6, growth=0.5, touching_half_arc=2.0e-3)


@pytest.fixture(scope="session")
def finger_mesh(coarse) -> TaggedMesh:
    """The default fingertip on a coarse mesh."""
    return load(MPI.COMM_WORLD, partial(fingertip.build, Fingertip(), coarse))


@pytest.fixture(scope="session")
def profiles() -> Profiles:
    """The default fingertip's curves."""
    return Profiles(Fingertip())


@pytest.fixture
def write(tmp_path):
    """Write a scene file and return its path."""

    def write(text: str) -> Path:
        path = tmp_path / "scene.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def table(tmp_path):
    """Write a table of measurements with its source, and return its path."""

    def table(text: str, source: str = "# source: Somebody 2020\n") -> Path:
        path = tmp_path / "mine.csv"
        path.write_text(source + text, encoding="utf-8")
        return path

    return table
