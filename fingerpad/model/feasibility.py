"""Whether a finger can be meshed, before it is: the ridges that can touch, its shape, its sizes and its memory.

Where a scene does not give the ridges that are meshed to touch, a rule of thumb does. Ridges in contact grow with the
force to the power 0.27 in full runs of the default finger, and friction rolls the finger onto its leading side. At
75 N/m and a friction coefficient of 0.25 ten ridges on either side can touch; full runs need nine. The width of the
contact zone is a length, and so a finger of narrower ridges has more of them in it. A bone that is lowered by a depth d
brings down the skin within sqrt(2 R d) of the lowest ridge, R the radius of the outline. The rule has at least one
ridge to spare in every full run of ``tests/reach.json``. What it misses on other fingers costs a restart:
:mod:`fingerpad.model.checks` checks each accepted step.

A run takes :data:`PROGRAM` bytes and :data:`PER_UNKNOWN` for each unknown of its path's mesh, error estimate included.
Before meshing, a lower bound of the unknowns is known. More ranks take some 0.2 GB each, and refining to an accuracy,
which holds two meshes at a time, takes more as well.
"""

import math
import re
from typing import TYPE_CHECKING

from fingerpad.model.options import FingerModel, ModelOptions, plan
from fingerpad.results.pace import about
from fingerpad.scene.messages import SceneError, qualify
from geometry import sizing
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError

if TYPE_CHECKING:
    from fingerpad.scene import Numerics, Scene

PROGRAM = 0.23e9
"""Bytes of the program itself."""
PER_UNKNOWN = 6.3e3
"""Bytes of an unknown, of which the factors of MUMPS are most. ``fingerpad run --set mesh.contact=…`` prints the memory
of a run: 0.35 GB with 27 000 unknowns, 0.56 GB with 73 000, 1.2 GB with 186 000, 5.7 GB with 873 000: the last."""
_RIDGES, _FORCE, _FRICTION = 10, 75.0, 0.25  # on either side, at a force (N/m) and a friction coefficient
_WIDENS, _ROLLS = 0.27, 0.3  # powers of the force and of a larger friction coefficient
_LEAST = 2  # ridges on either side
_PRESSURE = 30e3  # Pa, mean contact pressure of ridges, at which a friction law other than Coulomb's is evaluated


def check(scene: "Scene") -> None:
    """Refuse a scene whose finger cannot be built or meshed.

    Raises:
        SceneError: layers touch or cross, ridges do not fit, the bone touches the skin, elements are too large, or so
            many that they need more memory than the scene allows.
    """
    if scene.geometry.file is not None:  # checked when it is read
        return
    try:
        sizing.check(scene.geometry, scene.mesh)
        refuse_sizes(scene.geometry, by_rule(scene).mesh, scene.numerics, plan(scene))
    except GeometryError as error:
        message = re.sub(r"\bcontact size (\S+) m is", r"mesh.contact is \1 m,", str(error))
        raise SceneError(qualify(message, "geometry.", Fingertip.model_fields)) from None


def by_rule(scene: "Scene") -> "Scene":
    """Return the scene with a ``mesh.touching_half_arc``, by the rule of thumb where it gives none."""
    if scene.mesh.touching_half_arc is not None:
        return scene
    finger, law = scene.geometry, scene.friction_law()
    force = max((load.f_ext for load in scene.loads() if load.f_ext), default=0.0)
    depth = max((-load.bone_height for load in scene.loads() if load.bone_height), default=0.0)
    ridges = _RIDGES * Fingertip().ridge_wavelength / finger.ridge_wavelength * (force / _FORCE) ** _WIDENS
    radius = finger.width**2 / (2 * finger.height)
    lowered = math.sqrt(2 * radius * max(depth, 0.0)) / finger.ridge_wavelength
    friction = 0.0 if law is None else law.coefficient(_PRESSURE)
    last = math.ceil(max(ridges, lowered, _LEAST) * max(friction / _FRICTION, 1.0) ** _ROLLS)
    half_arc = min(last, max(finger.ridge_count // 2, 1)) * finger.ridge_wavelength
    return scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"touching_half_arc": half_arc})})


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


def refuse_mesh(points: int, triangles: int, model: FingerModel) -> None:
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


def refuse_sizes(finger: Fingertip, size: MeshSize, numerics: "Numerics", needed: ModelOptions) -> None:
    """Refuse element sizes whose mesh would need more memory than is allowed, by a lower bound, before it is made.

    Args:
        finger: its shape, which was checked.
        size: element sizes, with a ``touching_half_arc``.
        numerics: the element and the memory allowed.
        needed: the parts of the model.

    Raises:
        GeometryError: how much, and what to change.
    """
    triangles = int(sizing.least_triangles(finger, size, needed.receptors, not needed.both_halves))
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
        return sizing.least_triangles(finger, size.model_copy(update={key: other}))

    return min(("contact", "interface", "coarsest", "receptor", "growth"), key=larger)
