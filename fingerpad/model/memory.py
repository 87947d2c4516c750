"""The memory of a run, and its refusal: by the unknowns of the mesh, and before meshing by a lower bound of them.

A run takes :data:`PROGRAM` bytes and :data:`PER_UNKNOWN` for each unknown of its path's mesh, error estimate included.
More ranks take some 0.2 GB each, and refining to an accuracy, which holds two meshes at a time, takes more as well.
"""

from typing import TYPE_CHECKING

from fingerpad.io.pace import about
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError
from geometry.sizing import least_triangles

if TYPE_CHECKING:
    from fingerpad.model.options import FingerModel, ModelOptions
    from fingerpad.scene import Numerics

PROGRAM = 0.23e9
"""Bytes of the program itself."""
PER_UNKNOWN = 6.3e3
"""Bytes of an unknown, of which the factors of MUMPS are most. ``fingerpad run --set mesh.contact=…`` prints the memory
of a run: 0.35 GB with 27 000 unknowns, 0.56 GB with 73 000, 1.2 GB with 186 000, 5.7 GB with 873 000: the last."""


def unknowns(points: int, triangles: int, element: str) -> int:
    """Return the unknowns of a mesh; a triangulation has as many edges as points and triangles, or one less.

    Args:
        points: number of vertices.
        triangles: number of triangles.
        element: a name of :data:`variational.element.ELEMENTS`.
    """
    edges = points + triangles
    return {
        "P1": 2 * points,
        "P2": 2 * (points + edges),
        "P2 reduced": 2 * (points + edges),
        "P2-P1": 2 * (points + edges) + points,
        "P3": 2 * (points + 2 * edges + triangles),
    }[element]


def memory(number: float) -> float:
    """Return the bytes of a run on a mesh of so many unknowns, on all ranks together."""
    return PROGRAM + PER_UNKNOWN * number


def refuse_mesh(points: int, triangles: int, model: "FingerModel") -> None:
    """Refuse a mesh that needs more memory than is allowed.

    Args:
        points: number of vertices.
        triangles: number of triangles.
        model: whose mesh it is.

    Raises:
        GeometryError: how much, and what to change.
    """
    _refuse("has", triangles, unknowns(points, triangles, model.numerics.element), model.numerics, model.geometry,
            model.mesh)  # fmt: skip


def refuse_sizes(finger: Fingertip, size: MeshSize, numerics: "Numerics", needed: "ModelOptions") -> None:
    """Refuse element sizes whose mesh would need more memory than is allowed, by a lower bound, before it is made.

    Args:
        finger: its shape, which was checked.
        size: element sizes, with a ``touching_half_arc``.
        numerics: the element and the memory allowed.
        needed: the parts of the model.

    Raises:
        GeometryError: how much, and what to change.
    """
    triangles = int(least_triangles(finger, size, needed.receptors, not needed.both_halves))
    _refuse("would have at least", triangles, unknowns(triangles // 2, triangles, numerics.element), numerics, finger,
            size)  # fmt: skip


def _refuse(has: str, triangles: int, number: int, numerics: "Numerics", finger: Fingertip, size: MeshSize) -> None:
    allowed = f"numerics.memory allows {numerics.memory / 1e9:g} GB"
    if numerics.memory <= PROGRAM:
        raise GeometryError(f"{allowed}, and the program takes {PROGRAM / 1e9:g} GB without a mesh; raise it")
    if memory(number) > numerics.memory:
        raise GeometryError(
            f"the mesh {has} {about(triangles)} triangles and {about(number)} unknowns, which need about "
            f"{about(memory(number) / 1e9)} GB; {allowed}: raise it, or make mesh.{_finest(finger, size)} larger"
        )


def _finest(finger: Fingertip, size: MeshSize) -> str:
    """Return the key of the size that would save most triangles if it had its default, or a larger value."""

    def larger(key: str) -> float:
        other = max(getattr(MeshSize(), key), 1.01 * getattr(size, key))
        return least_triangles(finger, size.model_copy(update={key: other}))

    return min(("contact", "interface", "coarsest", "receptor", "growth"), key=larger)
