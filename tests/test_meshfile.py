"""A body from a gmsh file: what is read, on any number of ranks, and what is refused in one sentence."""

import os
import re
from functools import partial
from pathlib import Path

import gmsh
import numpy as np
import pytest
from mpi4py import MPI

import geometry
from fingerpad.model.body import Body
from geometry import tags
from geometry.mesh import load
from geometry.profiles import GeometryError
from tests.measures import straightened
from tests.pages import ROOT, blocks, printed
from variational import compat
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden

MM = 1e-3
SKIN, SPRINGS = Ogden(86.76e3, -14.53, 0.48), Penalty(1.5e12, 5e10)
RIDGE = geometry.ridge(size=40e-6)


def model(shape=RIDGE) -> None:
    """Mesh a shape and bring it from gmsh's mm to metres."""
    shape()
    scale(MM)


def scale(factor: float, up: float = 0.0, out: float = 0.0) -> None:
    gmsh.model.mesh.affineTransform([factor, 0, 0, 0, 0, factor, 0, up, 0, 0, factor, out])


def write(path: Path, build=model, version: float = 4.1) -> Path:
    """Write what a function makes of the current gmsh session into a file; on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        gmsh.initialize(interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        try:
            build()
            gmsh.write(str(path))
        finally:
            gmsh.finalize()
    MPI.COMM_WORLD.barrier()
    return path


@pytest.fixture
def place(tmp_path) -> Path:
    """A path of a file, the same on every rank."""
    return Path(MPI.COMM_WORLD.bcast(str(tmp_path / "mine.msh")))


@pytest.mark.mpi
@pytest.mark.parametrize(("version", "order"), [(2.2, 2), (4.1, 2), (4.1, 1)])
def test_body_from_a_file_is_the_body(place, version, order):
    """The ridge by a file and by itself, curved and straight: the file's decimals are good for 1e-15 of a place."""
    written = write(place, changed(lambda: gmsh.model.mesh.setOrder(order)), version)
    own = load(MPI.COMM_WORLD, RIDGE)
    body = Body(written, SKIN, contact=SPRINGS, friction=0.25).press(1.0).slide(1e-6)
    itself = Body(own if order == 2 else straightened(own), SKIN, contact=SPRINGS, friction=0.25).press(1.0).slide(1e-6)
    assert compat.cell_geometry(body.mesh.mesh).shape[1] == 3 * order
    assert body.state.f_t == pytest.approx(itself.state.f_t, rel=1e-8)
    assert body.state.bone_height == pytest.approx(itself.state.bone_height, rel=1e-8)


# -- refusals ------------------------------------------------------------------------------------------
def named(dim: int, tag: int, name: str | None):
    """Return what meshes the ridge with a group renamed or, without a name, removed."""

    def build():
        model()
        entities = gmsh.model.getEntitiesForPhysicalGroup(dim, tag)
        gmsh.model.removePhysicalName(gmsh.model.getPhysicalName(dim, tag))
        gmsh.model.removePhysicalGroups([(dim, tag)])
        if name is not None:
            gmsh.model.addPhysicalGroup(dim, entities, 77, name)

    return build


def changed(change):
    """Return what meshes the ridge and changes it."""

    def build():
        model()
        change()

    return build


def two_parts():
    """Two squares of two layers that touch and share no node."""
    geo, lines, surfaces = gmsh.model.geo, [], []
    for k in range(2):
        corners = [geo.addPoint(x * MM, (y + k) * MM, 0, 0.5 * MM) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        lines.append([geo.addLine(corners[i], corners[(i + 1) % 4]) for i in range(4)])
        surfaces.append(geo.addPlaneSurface([geo.addCurveLoop(lines[-1])]))
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, surfaces[:1], name="stratum corneum")
    gmsh.model.addPhysicalGroup(2, surfaces[1:], name="dermis")
    gmsh.model.addPhysicalGroup(1, lines[0][:1], name="ridge 0")
    gmsh.model.addPhysicalGroup(1, lines[1][2:3], name="bone rim")
    gmsh.model.mesh.generate(2)


def squares():
    model()
    gmsh.model.mesh.setOrder(1)
    gmsh.model.mesh.recombine()


def rim_elsewhere(inside: bool):
    """Two layers, and a rim that is the line between them or one beside them."""
    geo = gmsh.model.geo
    corners = [[geo.addPoint(x * MM, y * MM, 0, 0.5 * MM) for x in (0, 1)] for y in range(4)]
    across = [geo.addLine(*pair) for pair in corners]
    up = [[geo.addLine(a[x], b[x]) for a, b in zip(corners, corners[1:], strict=False)] for x in (0, 1)]
    loops = [[across[k], up[1][k], -across[k + 1], -up[0][k]] for k in range(2)]
    surfaces = [geo.addPlaneSurface([geo.addCurveLoop(loop)]) for loop in loops]
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, surfaces, name="dermis")
    gmsh.model.addPhysicalGroup(1, across[:1], name="ridge 0")
    gmsh.model.addPhysicalGroup(1, [across[1 if inside else 3]], name="bone rim")
    gmsh.model.mesh.generate(2)


def thrown(flat: bool):
    """Move a node of the mesh inside onto or across an opposite edge of one of its triangles."""
    gmsh.model.mesh.setOrder(1)
    entity = gmsh.model.getEntities(2)[0][1]
    inside = set(gmsh.model.mesh.getNodes(2, entity)[0])
    triangles = np.asarray(gmsh.model.mesh.getElementsByType(2, entity)[1]).reshape(-1, 3)
    first, *others = next([n, *(m for m in each if m != n)] for each in triangles for n in each if n in inside)
    here, one, two = (gmsh.model.mesh.getNode(int(node))[0] for node in (first, *others))
    middle = (one + two) / 2
    gmsh.model.mesh.setNode(int(first), middle if flat else middle + (middle - here), [])


def folded():
    """Move the node in the middle of an edge inside to the far end of one of its triangles."""
    nodes = next(iter(six_nodes()))
    gmsh.model.mesh.setNode(int(nodes[3]), 3 * gmsh.model.mesh.getNode(int(nodes[2]))[0], [])


def six_nodes():
    return np.asarray(gmsh.model.mesh.getElementsByType(9)[1]).reshape(-1, 6)


REFUSED = {
    "no rim": (named(1, tags.BONE_RIM, None), "the group 'bone rim' is missing"),
    "no skin": (named(1, tags.ridge(0), None), "no skin can touch; give the facets that can a group 'ridge 0'"),
    "no layer": (named(2, tags.STRATUM_CORNEUM, None), "no group of cells is a layer; give at least one of 'stratum"),
    "mm": (lambda: RIDGE(), "the body is 0.6 m large, which is no finger; lengths are in m: did you mean mm?"),
    "below": (changed(lambda: scale(1, up=-1e-5)), "the lowest point is at y = -1e-05 m, below the screen at y = 0"),
    "out of the plane": (changed(lambda: scale(1, out=1e-4)), "nodes lie out of the plane z = 0"),
    "third order": (
        changed(lambda: gmsh.model.mesh.setOrder(3)),
        "'Line 4'; cells must be triangles with 3 or with 6 nodes",
    ),
    "folded": (changed(folded), "triangles are inverted by nodes in the middle of their edges, the first at ("),
    "rim inside": (partial(rim_elsewhere, True), "group 'bone rim' has edges inside the body"),
    "no area": (changed(lambda: thrown(flat=True)), "triangles have no area, the first at"),
    "orientation": (changed(lambda: thrown(flat=False)), "triangles are clockwise and the others are not"),
    "lowest point": (changed(lambda: scale(-1, up=2e-3)), "is in no ridge group, and the lowest ridge is at y ="),
    "two parts": (two_parts, "the mesh is in 2 parts that share no node"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_file_is_refused(place, case):
    build, message = REFUSED[case]
    with pytest.raises(GeometryError, match=f"mine.msh: .*{re.escape(message)}") as error:
        load(MPI.COMM_WORLD, geometry.file(write(place, build)))
    assert "\n" not in str(error.value)


@pytest.mark.mpi
def test_no_file_is_refused_on_every_rank(place):
    with pytest.raises(GeometryError, match="mine.msh: the mesh file cannot be read: No such file or directory"):
        Body(place, SKIN)


@pytest.mark.parametrize("text", ["", "Point(1) = {0, 0, 0};", "SystemCall 'touch run';", "$MeshFormat\n4.1 0 8\n"])
def test_other_file_is_refused_and_not_run(place, text):
    """gmsh takes any other file for a script, which may call programs."""
    place.write_text(text, encoding="utf-8")
    with pytest.raises(GeometryError, match=r"mine\.msh"):
        load(MPI.COMM_SELF, geometry.file(place))
    assert os.listdir(place.parent) == ["mine.msh"]


@pytest.mark.slow
def test_page_runs(tmp_path, monkeypatch):
    """The example of the documentation runs as written."""
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    page = (ROOT / "docs" / "laws.md").read_text(encoding="utf-8").partition("## A mesh of your own")[2]
    for code, _ in blocks(page):
        printed(code, names)
    skin = names["pad"].skin
    assert (np.diff(skin.x.ravel()) > 0).all()


# -- numbers of nodes ----------------------------------------------------------------------------------------------
def alone():
    """With a point in a group, as also Mesh.SaveAll has it in the file: its node is of no cell."""
    model()
    point = gmsh.model.addDiscreteEntity(0)
    gmsh.model.mesh.addNodes(0, point, [10**6], [0, 5 * MM, 0])
    gmsh.model.mesh.addElementsByType(point, 15, [], [10**6])
    gmsh.model.addPhysicalGroup(0, [point], name="centre")


def numbered(first: int, gap: int):
    """Return what meshes the ridge with nodes numbered from elsewhere, one in ten after a gap."""

    def build():
        model()
        old = np.sort(gmsh.model.mesh.getNodes()[0])
        new = first + np.arange(len(old)) + gap * (np.arange(len(old)) // 10)
        gmsh.model.mesh.renumberNodes(old, new)

    return build


@pytest.mark.mpi
@pytest.mark.parametrize("build", [alone, numbered(48, 0), numbered(1, 3)], ids=["a node alone", "from 48", "gaps"])
@pytest.mark.parametrize("version", [2.2, 4.1])
def test_numbers_of_nodes_do_not_matter(place, build, version):
    """dolfinx ends the program for a node of no cell, and its reader asserts numbers from 1 without a gap."""
    made, own = load(MPI.COMM_WORLD, geometry.file(write(place, build, version))), load(MPI.COMM_WORLD, RIDGE)
    for dim in (0, 2):
        assert made.mesh.topology.index_map(dim).size_global == own.mesh.topology.index_map(dim).size_global
    assert MPI.COMM_WORLD.allreduce(len(made.rim)) == MPI.COMM_WORLD.allreduce(len(own.rim))
