"""What a scene asks of a machine, estimated before anything is meshed, and refused where it is beyond what may be used.

The number of triangles is :mod:`geometry.count`'s, of unknowns what the element makes of it. Memory is that of MUMPS's
factors and of all else that a run holds, by unknown; it grows a little faster than the unknowns do, which is left out.
It is an estimate: runs of 30 000 to 500 000 unknowns took between 0.6 and 1.4 times as much.
"""

from dataclasses import dataclass

from fingerpad.needs import Plan, plan
from fingerpad.reach import by_rule
from fingerpad.scene import Scene
from geometry import count
from geometry.profiles import GeometryError

_UNKNOWNS = {"P1": 1.0, "P2": 4.0, "P2 reduced": 4.0, "P2-P1": 4.5, "P3": 9.0}  # of a triangle, on large meshes
_AT_LEAST = 0.3e9  # bytes, of the program itself
_EACH = 4e3  # bytes of an unknown


@dataclass(frozen=True)
class Budget:
    """What a mesh of a scene will come to, about."""

    triangles: float
    unknowns: float
    memory: float
    """Bytes, on all ranks together."""


def estimate(scene: Scene, needed: Plan | None = None) -> Budget:
    """Return what a scene will come to, some milliseconds.

    Args:
        scene: one whose geometry was checked.
        needed: the parts of the model; those that the scene needs if None.
    """
    needed, scene = needed or plan(scene), by_rule(scene)
    triangles = count.triangles(scene.geometry, scene.mesh, needed.receptors, not needed.both_halves)
    unknowns = _UNKNOWNS[scene.numerics.element] * triangles
    return Budget(triangles, unknowns, _AT_LEAST + _EACH * unknowns)


def refuse_beyond(scene: Scene, needed: Plan | None = None) -> None:
    """Refuse a scene that would need more memory than it allows; arguments as above.

    Raises:
        GeometryError: how much, and what to change.
    """
    found = estimate(scene, needed)
    if found.memory > scene.numerics.memory:
        raise GeometryError(
            f"the mesh would have some {found.triangles:.2g} triangles and {found.unknowns:.2g} unknowns, which need "
            f"about {found.memory / 1e9:.2g} GB; numerics.memory allows {scene.numerics.memory / 1e9:.3g} GB: raise "
            f"it, or make {_finest(scene)} larger"
        )


def _finest(scene: Scene) -> str:
    """Return the key of the size that would save most triangles if it were doubled."""
    present = by_rule(scene)
    keys = ["contact", "interface", "coarsest", *(["receptor"] if scene.output.receptors else []), "growth"]

    def doubled(key: str) -> float:
        mesh = present.mesh.model_copy(update={key: 2 * getattr(present.mesh, key)})
        return count.triangles(present.geometry, mesh, scene.output.receptors)

    return f"mesh.{min(keys, key=doubled)}"
