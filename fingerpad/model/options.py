"""What a scene needs of the model, decided from the scene alone, and the model as plain values.

A :class:`FingerModel` reads the scene once. Meshing, solving, recording and refinement receive it, never a scene.

What cannot change any number asked for is left out, and each omission comes with its reason. Nothing here is an
approximation but what the finite elements make of it: the numbers stay those of the whole model. Ridges that are not
expected to touch are another matter (:mod:`fingerpad.model.feasibility`).
"""

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from geometry.parameters import Fingertip, MeshSize
from geometry.sizing import touching_ridges
from variational.contact.formulation import Formulation
from variational.materials.material import Material

if TYPE_CHECKING:
    from fingerpad.scene import Load, Numerics, Scene


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
    """Discretisation errors, from states solved again on other meshes."""
    omitted: tuple[Omission, ...]

    def with_both_halves(self) -> "ModelOptions":
        """Return the options for the whole finger from the start."""
        omitted = tuple(o for o in self.omitted if o != _HALF)
        return replace(self, both_halves=True, symmetric_start=False, omitted=omitted)


_FILE = "the mesh is of a file"
_HALF = Omission(
    "the half at x < 0, but in tables and pictures (displacement.bp, stress.bp and sed.bp hold the other)",
    "no load moves the bone sideways, and the finger is its own mirror image",
)


def plan(scene: "Scene") -> ModelOptions:
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
        return ModelOptions(voltage, friction, False, True, False, False, tuple(omitted))
    symmetric_start = both_halves and symmetric and scene.contact.law.symmetric_start
    if not both_halves:
        omitted.append(_HALF)
    return ModelOptions(voltage, friction, receptors, both_halves, symmetric_start, errors, tuple(omitted))


class FingerModel:
    """A finger as it is meshed and solved: shape, sizes, laws, loads and numbers.

    Attributes:
        options: the parts of the model.
        geometry: shape of the finger.
        mesh: element sizes, and how many ridges can touch.
        mesh_file: file of a mesh, in the place of one with these sizes.
        mesh_sha256: hash of that file, as it was when the scene was given it.
        solids: material of each layer's tag.
        contact: formulation of the contact.
        by_gap: whether a ridge's length is that of a small gap, and not that under contact pressure.
        friction: law of friction; None without friction.
        closure: the microscale; None where there is never a voltage.
        h_0: effective insulator thickness (m).
        loads: to reach one after the other.
        numerics: element, tolerances and memory.
        asked: largest relative errors allowed, by quantity; empty where no accuracy is asked for.
    """

    def __init__(self, scene: "Scene", options: ModelOptions) -> None:
        """Read a scene.

        Args:
            scene: a checked scene with a ``mesh.touching_half_arc``, see :func:`fingerpad.model.feasibility.by_rule`.
            options: the parts of the model, see :func:`plan`.
        """
        self.options = options
        self.geometry: Fingertip = scene.geometry
        self.mesh: MeshSize = scene.mesh
        self.mesh_file = None if scene.geometry.file is None else Path(scene.geometry.file)
        self.mesh_sha256 = scene.geometry.file_sha256
        self.solids = scene.solids()
        self.contact: Formulation = scene.contact.law
        self.by_gap = scene.contact.length == "gap"
        self.friction = scene.friction_law()
        self.closure = scene.closure() if options.voltage else None
        self.h_0 = scene.h_0
        self.loads = scene.loads()
        self.numerics: Numerics = scene.numerics
        self.asked: Mapping[str, float] = {} if scene.accuracy is None else scene.accuracy.tolerances()

    def changed(
        self,
        *,
        options: ModelOptions | None = None,
        mesh: MeshSize | None = None,
        contact: Formulation | None = None,
        loads: tuple["Load", ...] | None = None,
        numerics: "Numerics | None" = None,
    ) -> "FingerModel":
        """Return a copy with some values changed, as the attributes are described; those left out stay."""
        found = copy(self)
        found.options = self.options if options is None else options
        found.mesh = self.mesh if mesh is None else mesh
        found.contact = self.contact if contact is None else contact
        found.loads = self.loads if loads is None else loads
        found.numerics = self.numerics if numerics is None else numerics
        return found

    def with_ridges(self, last: int) -> "FingerModel":
        """Return the model with ridges -last to last meshed to touch."""
        half_arc = last * self.geometry.ridge_wavelength
        return self.changed(mesh=self.mesh.model_copy(update={"touching_half_arc": half_arc}))

    @property
    def omitted(self) -> tuple[Omission, ...]:
        """All omissions, also that of the ridges that are not meshed to touch."""
        if self.mesh_file is not None:
            return self.options.omitted
        last = touching_ridges(self.geometry, self.mesh)[-1]
        if last == (self.geometry.ridge_count - 1) // 2:
            return self.options.omitted
        reason = "they are not expected to touch, which each accepted step is checked for"
        return (*self.options.omitted, Omission(f"contact of the ridges beyond ±{last}", reason))
