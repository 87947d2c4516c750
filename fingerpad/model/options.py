"""What a scene needs of the model, decided from the scene alone: its parts, its ridges, its memory; and plain values.

A :class:`FingerModel` reads the scene once. Meshing, solving, recording and refinement receive it, never a scene.

**Parts.** What cannot change any number asked for is left out, and each omission comes with its reason. Nothing here is
an approximation but what the finite elements make of it: the numbers stay those of the whole model.

**Ridges.** Where a scene does not give the ridges that are meshed to touch, a rule of thumb does. Ridges in contact
grow with the force to the power 0.27 in full runs of the default finger, and friction rolls the finger onto its leading
side. At 75 N/m and a friction coefficient of 0.25 ten ridges on either side can touch; full runs need nine. The width
of the contact zone is a length, and so a finger of narrower ridges has more of them in it. A bone that is lowered by a
depth d brings down the skin within sqrt(2 R d) of the lowest ridge, R the radius of the outline. The rule has at least
one ridge to spare in every full run of ``tests/reach.json``. What it misses on other fingers costs a restart:
:mod:`fingerpad.model.checks` checks each accepted step.

**Memory.** A run takes :data:`_PROGRAM` bytes and :data:`_PER_UNKNOWN` for each unknown of its path's mesh, error
estimate included. Before meshing, a lower bound of the unknowns is known. More ranks take some 0.2 GB each, and
refining to an accuracy, which holds two meshes at a time, takes more as well.
"""

import math
import re
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fingerpad.model import drive_loads
from fingerpad.results.terminal import about
from fingerpad.scene import Numerics, Scene, with_values
from fingerpad.scene.controls import ends_of
from fingerpad.scene.materials import adheres
from fingerpad.scene.messages import SceneError, qualify
from fingerpad.scene.reading import flat
from fingerpad.scene.viscosity import viscous_layers
from geometry import sizing
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError
from geometry.units import computed
from variational.contact.formulation import Formulation
from variational.materials.material import Material

COARSER = 2.0
"""Sizes of the elements on which a path is followed over those with which its named states are solved again."""
_PROGRAM = 0.23e9
"""Bytes of the program itself."""
_PER_UNKNOWN = 6.3e3
"""Bytes of an unknown, of which the factors of MUMPS are most. ``fingerpad run --set mesh.contact=…`` prints the memory
of a run: 0.35 GB with 27 000 unknowns, 0.56 GB with 73 000, 1.2 GB with 186 000, 5.7 GB with 873 000: the last."""
_RIDGES, _FORCE, _FRICTION = 10, 75.0, 0.25  # on either side, at a force (N/m) and a friction coefficient
_WIDENS, _ROLLS = 0.27, 0.3  # powers of the force and of a larger friction coefficient
_FEWEST = 2  # ridges on either side
_PRESSURE = 30e3  # Pa, mean contact pressure of ridges, at which a friction law other than Coulomb's is evaluated

_NO_PHYSICS = "mesh numerics output accuracy slices slide_length".split()  # tables and keys


@dataclass(frozen=True)
class Omission:
    """A part of the model that is left out, and why."""

    what: str
    reason: str

    def __str__(self) -> str:
        """Return both in words."""
        return f"{self.what} left out: {self.reason}"


@dataclass(frozen=True)
class ModelOptions:
    """The parts of the model that a scene needs."""

    voltage: bool
    """Attraction in the forms, and the loop over the scales."""
    friction: bool
    """Tangential tractions and their history."""
    receptors: bool
    """Receptor sites, and elements small enough for them."""
    both_halves: bool
    """The finger on both sides of x = 0."""
    symmetric_start: bool
    """Loads before the bone first moves sideways are reached on one half, and the whole is its mirror image."""
    errors: bool
    """Discretisation errors, from states on other meshes."""
    past: bool
    """Layers have a past, which is of their own mesh: states on another mesh are those of a path followed there."""
    omitted: tuple[Omission, ...]

    def with_both_halves(self) -> "ModelOptions":
        """Return the options for the whole finger from the start."""
        omitted = tuple(o for o in self.omitted if o != _HALF)
        return replace(self, both_halves=True, symmetric_start=False, omitted=omitted)


_FILE = "the mesh is of a file"
_HALF = Omission(
    "the half at x < 0, but in tables, pictures and fields",
    "no load moves the bone sideways, and the finger is its own mirror image",
)


def plan(scene: Scene) -> ModelOptions:
    """Return what a scene needs; a pure function of it."""
    voltage = any(load.voltage for load in scene.loads())
    friction, receptors = scene.friction_law() is not None, scene.output.receptors
    omitted = []
    if not voltage:
        omitted.append(Omission("attraction and the air gaps of the ridges", "no load has a voltage"))
    if not friction:
        omitted.append(Omission("friction and its history", "the friction coefficient is 0"))
    if not receptors:
        omitted.append(Omission("receptor sites and their fine elements", "output.receptors is false"))
    past = bool(viscous_layers(scene.materials))
    errors = scene.output.errors or scene.accuracy is not None
    if not errors:
        omitted.append(Omission("discretisation errors", "output.errors is false"))
    symmetric = all(solid.keeps_symmetry() for solid in scene.own_laws().values() if isinstance(solid, Material))
    both_halves = any(load.moves for load in scene.loads()) or not symmetric
    if scene.geometry.file is not None:  # the whole of it, and no other mesh of the same finger
        if receptors:
            omitted.append(Omission("receptor sites", _FILE))
        if errors:
            omitted.append(Omission("discretisation errors", f"{_FILE} and cannot be refined"))
        return ModelOptions(voltage, friction, False, True, False, False, past, tuple(omitted))
    symmetric_start = both_halves and symmetric and scene.contact.law.symmetric_start
    if not both_halves:
        omitted.append(_HALF)
    return ModelOptions(voltage, friction, receptors, both_halves, symmetric_start, errors, past, tuple(omitted))


class FingerModel:
    """A finger as it is meshed and solved: shape, sizes, laws, loads and numbers.

    Attributes:
        options: the parts of the model.
        geometry: shape of the finger.
        mesh: element sizes, and how many ridges can touch.
        final: element sizes with which the named states are solved again; None where they are not.
        edges: arc lengths (m) >= 0 about which facets are small, since contact ends there.
        mesh_file: file of a mesh, in the place of one with these sizes.
        mesh_sha256: hash of that file, as it was when the scene was given it.
        solids: material of each layer's tag.
        contact: formulation of the contact.
        by_gap: whether a ridge's length is that of a small gap, and not that under contact pressure.
        friction: law of friction; None without friction.
        adhesion: law of adhesion without a voltage; None without.
        closure: the microscale; None where there is never a voltage.
        h_0: effective insulator thickness (m).
        loads: to reach one after the other, with voltages of Eq. 3.
        share: voltage at air gaps (m) over that of the loads; None where nothing is lost.
        numerics: element, tolerances and memory.
        asked: largest relative errors allowed, by quantity; empty where no accuracy is asked for.
        given: numbers of the scene by dotted key, by which slopes are wanted; empty where none are.
    """

    def __init__(self, scene: Scene, options: ModelOptions) -> None:
        """Read a scene.

        Args:
            scene: a checked scene with a ``mesh.touching_half_arc``, see :func:`fingerpad.model.options.by_rule`.
            options: the parts of the model, see :func:`plan`.
        """
        self.options = options
        self.geometry: Fingertip = scene.geometry
        self.mesh: MeshSize = scene.mesh
        self.mesh_file = None if scene.geometry.file is None else Path(scene.geometry.file)
        self.mesh_sha256 = scene.geometry.file_sha256
        self.solids = scene.solids()
        self.friction = scene.friction_law()
        self.contact: Formulation = scene.contact.law.beside(self.friction)
        self.by_gap = scene.contact.length == "gap"
        self.adhesion = scene.adhesion if adheres(scene.adhesion) else None
        self.closure = scene.closure() if options.voltage else None
        self.h_0 = scene.h_0
        self.loads = drive_loads.loads(scene)
        self.share = drive_loads.gap_factor(scene)
        self.numerics: Numerics = scene.numerics
        self.asked: Mapping[str, float] = {} if scene.accuracy is None else scene.accuracy.tolerances()
        self.given = numbers(scene) if scene.output.sensitivities else {}
        own = scene if self.mesh_file is None else scene.model_copy(update={"mesh": MeshSize()})
        self._scene = own.replace(output={"sensitivities": False}) if self.given else None
        self.final: MeshSize | None = None
        self.edges: tuple[float, ...] = ()

    def of_path(self) -> "FingerModel":
        """Return the model that is led along the loads: coarser, where the named states are solved again anyway.

        Full slip does not depend on the path where the same ridges touch, and a path on elements twice as large finds
        them. The difference of the two meshes is then what the estimated error is made of. Where layers have a past,
        states cannot be solved again, and the path is led on the final mesh.
        """
        if self.asked or self.options.past or not self.options.errors:
            return self
        return self.changed(mesh=self.coarser(self.mesh), final=self.mesh)

    def coarser(self, mesh: MeshSize) -> MeshSize:
        """Return element sizes :data:`COARSER` as large, as far as ridges can have them."""
        return sizing.coarser(self.geometry, mesh, COARSER)

    def changed(self, **changes: Any) -> "FingerModel":
        """Return a copy with some attributes changed; those that are left out or None stay."""
        found = copy(self)
        vars(found).update({name: value for name, value in changes.items() if value is not None})
        if found.final is not None:  # the same ridges can touch
            found.final = found.final.model_copy(update={"touching_half_arc": found.mesh.touching_half_arc})
        return found

    def with_ridges(self, last: int) -> "FingerModel":
        """Return the model with ridges -last to last meshed to touch."""
        half_arc = last * self.geometry.ridge_wavelength
        return self.changed(mesh=self.mesh.model_copy(update={"touching_half_arc": half_arc}))

    def with_number(self, key: str, value: float) -> "FingerModel":
        """Return the model of its scene with another of the numbers :attr:`given`."""
        assert self._scene is not None
        with computed():
            return FingerModel(with_values(self._scene, {key: value}), self.options)

    @property
    def omitted(self) -> tuple[Omission, ...]:
        """All omissions, also that of the ridges that are not meshed to touch."""
        if self.mesh_file is not None:
            return self.options.omitted
        last = sizing.touching_ridges(self.geometry, self.mesh)[-1]
        if last == (self.geometry.ridge_count - 1) // 2:
            return self.options.omitted
        reason = "they are not expected to touch, which each accepted step is checked for"
        return (*self.options.omitted, Omission(f"contact of the ridges beyond ±{last}", reason))


def numbers(scene: Scene) -> dict[str, float]:
    """Return the numbers of a scene on which its states depend, by dotted key; not those of meshes and solvers."""
    own = {key: x for key, x in flat(scene.parameters()).items() if isinstance(x, float)}
    return {key: x for key, x in own.items() if re.split(r"[.\[]", key)[0] not in _NO_PHYSICS}


def check(scene: Scene) -> None:
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


def by_rule(scene: Scene) -> Scene:
    """Return the scene with a ``mesh.touching_half_arc``, by the rule of thumb where it gives none."""
    if scene.mesh.touching_half_arc is not None:
        return scene
    finger, law = scene.geometry, scene.friction_law()
    force = max((ends_of(load.f_ext)[1] for load in scene.loads()), default=0.0)
    depth = max((-ends_of(load.bone_height)[0] for load in scene.loads()), default=0.0)
    ridges = _RIDGES * Fingertip().ridge_wavelength / finger.ridge_wavelength * (force / _FORCE) ** _WIDENS
    radius = finger.width**2 / (2 * finger.height)
    lowered = math.sqrt(2 * radius * max(depth, 0.0)) / finger.ridge_wavelength
    friction = 0.0 if law is None else law.coefficient(_PRESSURE)
    last = math.ceil(max(ridges, lowered, _FEWEST) * max(friction / _FRICTION, 1.0) ** _ROLLS)
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
    return _PROGRAM + _PER_UNKNOWN * number


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


def refuse_sizes(finger: Fingertip, size: MeshSize, numerics: Numerics, needed: ModelOptions) -> None:
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


def _refuse(has: str, triangles: int, number: int, numerics: Numerics, finger: Fingertip, size: MeshSize) -> None:
    allowed = f"numerics.memory allows {numerics.memory / 1e9:g} GB"
    if numerics.memory <= _PROGRAM:
        raise GeometryError(f"{allowed}, and the program takes {_PROGRAM / 1e9:g} GB without a mesh; raise it")
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
