"""The memory that a scene needs, estimated before anything is meshed, and refused where it is more than allowed.

The number of triangles is :mod:`geometry.count`'s, of unknowns what the element makes of it. Memory, of which the
factors of MUMPS are most, grows as the power 1.13 of the unknowns: runs on one rank that pressed, charged and slid took
0.35 GB with 27 000, 0.56 GB with 73 000, 1.2 GB with 186 000 and 5.7 GB with 873 000 of them. It is an estimate. More
ranks take some 0.2 GB each; refining to an accuracy, which holds two meshes at a time, takes more as well.
"""

import math
from dataclasses import dataclass

from fingerpad.io.left import about
from fingerpad.model.options import ModelOptions, plan
from fingerpad.model.touching import by_rule
from fingerpad.scene import Numerics, Scene
from geometry import count
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError

_UNKNOWNS = {"P1": 1.0, "P2": 4.0, "P2 reduced": 4.0, "P2-P1": 4.5, "P3": 9.0}  # of a triangle, on large meshes
_AT_LEAST = 0.23e9  # bytes, of the program itself
MEASURED = 873_000  # unknowns, the most of these runs
_FIRST, _POWER = 1.06e3, 1.13  # bytes of one unknown, and the power with which they grow


@dataclass(frozen=True)
class Budget:
    """What a mesh of a scene will come to, about."""

    triangles: float
    unknowns: float
    memory: float
    """Bytes, on all ranks together."""


def estimate(scene: Scene, needed: ModelOptions | None = None, triangles: int | None = None) -> Budget:
    """Return what a scene will come to, some milliseconds.

    Args:
        scene: one whose geometry was checked.
        needed: the parts of the model; those that the scene needs if None.
        triangles: of a mesh of a file.
    """
    if triangles is not None:
        return _of(triangles, scene.numerics.element)
    return _budget(scene.geometry, by_rule(scene).mesh, scene.numerics.element, needed or plan(scene))


def refuse_beyond(finger: Fingertip, size: MeshSize, numerics: Numerics, needed: ModelOptions) -> None:
    """Refuse a mesh that would need more memory than is allowed.

    Args:
        finger: its shape, which was checked.
        size: element sizes, with a ``touching_half_arc``.
        numerics: the element and the memory allowed.
        needed: the parts of the model.

    Raises:
        GeometryError: how much, and what to change.
    """
    allowed = f"numerics.memory allows {numerics.memory / 1e9:g} GB"
    if numerics.memory <= _AT_LEAST:
        raise GeometryError(f"{allowed}, and the program takes {_AT_LEAST / 1e9:g} GB without a mesh; raise it")
    found = _budget(finger, size, numerics.element, needed)
    if found.memory > numerics.memory:
        raise GeometryError(
            f"the mesh would have some {about(found.triangles)} triangles and {about(found.unknowns)} unknowns, and "
            f"need about {about(_up(found.memory / 1e9))} GB; {allowed}: "
            f"raise it, or make {_finest(finger, size, needed.receptors)} larger"
        )


def _budget(finger: Fingertip, size: MeshSize, element: str, needed: ModelOptions) -> Budget:
    return _of(count.triangles(finger, size, needed.receptors, not needed.both_halves), element)


def _of(triangles: float, element: str) -> Budget:
    unknowns = _UNKNOWNS[element] * triangles
    return Budget(triangles, unknowns, _AT_LEAST + _FIRST * unknowns**_POWER)


def _up(value: float) -> float:
    """Return a number rounded up to two digits, which is above all that the number itself is above."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / step) * step


def _finest(finger: Fingertip, size: MeshSize, receptors: bool) -> str:
    """Return the key of the size that would save most triangles if it were doubled."""
    keys = ["contact", "interface", "coarsest", *(["receptor"] if receptors else []), "growth"]

    def doubled(key: str) -> float:
        return count.triangles(finger, size.model_copy(update={key: 2 * getattr(size, key)}), receptors)

    return f"mesh.{min(keys, key=doubled)}"
