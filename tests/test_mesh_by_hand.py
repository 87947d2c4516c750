"""Mesh files that gmsh does not make itself: pieces that do not hang together, bad edges."""

import itertools
import re
from pathlib import Path

import gmsh
import numpy as np
import pytest
from mpi4py import MPI

import geometry
from geometry.mesh import load
from geometry.profiles import GeometryError

MM = 1e-3


def block(upper: int = 4) -> tuple[list[tuple[float, float]], list[list[int]]]:
    """Return places (mm) and triangles of two layers of four squares, the upper one cut into ``upper``, on one line.

    Their nodes on the common line are the same as far as they are at the same places.
    """
    rows = [[(x / 4, y) for x in range(5)] for y in (0.0, 0.25)]
    rows += [[(x / upper, y) for x in range(upper + 1)] for y in (0.25, 0.5)]
    places = list(dict.fromkeys(place for row in rows for place in row))
    cells = []
    for low, high in (rows[:2], rows[2:]):
        for k in range(len(low) - 1):
            a, b, c, d = (places.index(place) + 1 for place in (low[k], low[k + 1], high[k + 1], high[k]))
            cells += [[a, b, c], [a, c, d]]
    return places, cells


def by_hand(file: Path, places, cells, rim, more=()) -> Path:
    """Write a file of version 2.2 with the lower edges and some more as ridge 0; ``rim`` are pairs of nodes."""
    skin = [*([k, k + 1] for k in range(1, 5)), *more]
    lines = [f"1 2 1 1 {a} {b}" for a, b in skin] + [f"1 2 2 2 {a} {b}" for a, b in rim]
    elements = [*lines, *(f"2 2 3 3 {' '.join(map(str, cell))}" for cell in cells)]
    file.write_text(
        "\n".join(
            [
                "$MeshFormat\n2.2 0 8\n$EndMeshFormat",
                '$PhysicalNames\n3\n1 1 "ridge 0"\n1 2 "bone rim"\n2 3 "dermis"\n$EndPhysicalNames',
                f"$Nodes\n{len(places)}",
                *(f"{k} {x * MM} {y * MM} 0" for k, (x, y) in enumerate(places, start=1)),
                f"$EndNodes\n$Elements\n{len(elements)}",
                *(f"{k} {element}" for k, element in enumerate(elements, start=1)),
                "$EndElements\n",
            ]
        ),
        encoding="utf-8",
    )
    return file


def rim_of(places) -> list[tuple[int, int]]:
    top = [k for k, (_, y) in enumerate(places, start=1) if y == 0.5]
    return list(itertools.pairwise(top))


@pytest.mark.parametrize(
    ("case", "message"),
    [
        ("crack", "do not share a node there, as neighbours must"),
        ("hanging node", "the triangles at (0.000125, 0.00025) m do not share a node there"),
        ("cells twice", "2 of 18 triangles are in the mesh twice"),
        ("three at an edge", "three triangles have the same edge at (0.000375, 0.000125) m, so that they overlap"),
        ("skin and rim", "groups 'bone rim' and 'ridge 0' have an edge in common"),
    ],
)
def test_mesh_that_does_not_hang_together_is_refused(tmp_path, case, message):
    """Each was accepted once, and gave a body that was too soft, or glued where it should touch."""
    places, cells = block(8 if case == "hanging node" else 4)
    rim = rim_of(places)
    if case == "crack":  # the upper layer has nodes of its own, but for the first
        shared = [k for k, (_, y) in enumerate(places, start=1) if y == 0.25][1:]
        own = {k: len(places) + n for n, k in enumerate(shared, start=1)}
        cells = cells[:8] + [[own.get(k, k) for k in cell] for cell in cells[8:]]
        places = places + [places[k - 1] for k in shared]
    elif case == "cells twice":
        cells = cells + cells[4:6]
    elif case == "three at an edge":
        cells = [*cells, [1, 2, 8]]
    elif case == "skin and rim":
        rim = [*rim, (2, 1)]
    with pytest.raises(GeometryError, match=re.escape(message)):
        load(MPI.COMM_WORLD, geometry.file(by_hand(tmp_path / "mine.msh", places, cells, rim)))


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("binary", [0, 1])
def test_inverted_triangles_of_second_order_are_refused(tmp_path, version, binary):
    """Of each kind of file: how many there are, and where the first is."""
    places, cells = block()
    file = by_hand(tmp_path / "straight.msh", places, cells, rim_of(places))
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(file))
        gmsh.model.mesh.setOrder(2)
        nodes = np.asarray(gmsh.model.mesh.getElementsByType(9)[1]).reshape(-1, 6)
        for triangle in (nodes[3], nodes[9]):  # the middle of an edge inside goes to the opposite corner and beyond
            middle = next(int(node) for node in triangle[3:] if (nodes[:, 3:] == node).sum() == 2)
            place, corner = (
                gmsh.model.mesh.getNode(node)[0] for node in (middle, int(triangle[list(triangle).index(middle) - 4]))
            )
            gmsh.model.mesh.setNode(middle, 1.2 * corner - 0.2 * place, [])
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(tmp_path / "mine.msh"))
    finally:
        gmsh.finalize()
    with pytest.raises(
        GeometryError, match=r"mine.msh: [0-9]+ of 16 triangles are inverted by nodes in .*, the first at \("
    ):
        load(MPI.COMM_WORLD, geometry.file(tmp_path / "mine.msh"))
