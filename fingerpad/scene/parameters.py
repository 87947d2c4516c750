"""The tables of a scene: accuracy, contact, output, numerics and slices, with units and the ranges that make sense.

:mod:`fingerpad.scene.materials` and :mod:`fingerpad.scene.loads` have the others. The docstring of a key is its text in
the scene reference, ``fingerpad params``.
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from fingerpad.scene.law_keys import Kind, LawKey, key_error, keys_of, reading_results
from fingerpad.scene.messages import SceneError, clip, show
from geometry.parameters import Fingertip
from geometry.units import Finite, Switch, Table, within
from variational import files
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty

FORMULATIONS: dict[str, type[Formulation]] = {"penalty": Penalty, "nitsche": Nitsche, "augmented": AugmentedLagrangian}
"""Contact formulations by their names, key ``contact.formulation``: a new one is an entry here."""
CONTACT = LawKey(Kind(Formulation, "a Formulation", FORMULATIONS), Penalty(), flat="formulation")
Asked = Annotated[Finite, within(1e-6, 0.5)]
_MOST_PLACES = 1000  # along the axis of a finger
# A finger of the default's width bears some 0.53 N where its centre bears 75 N/m; forces grow as F^0.77.
LINE, POINT, POWER, WIDTH = 75.0, 0.53, 0.77, 20e-3
Place = Annotated[Finite, within(1e-9, 0.1, "m", zero=True, sides=2)]
Height = Annotated[Finite, within(1e-9, 0.1, "m", zero=True)]
Scale = Annotated[Finite, within(0.1, 10)]
Many = Field(min_length=1, max_length=_MOST_PLACES)


class Accuracy(Table):
    """Largest relative discretisation errors allowed.

    See :mod:`fingerpad.accuracy.richardson` and :mod:`fingerpad.accuracy.refinement`. Friction is that of full slip,
    lengths and energy densities are those of normal contact and of full slip.
    """

    mu_app: Asked | None = None
    """Largest relative error of the apparent friction coefficient at full slip. Range: from 1e-6, beyond any mesh
    that fits into memory, to 0.5, which excludes almost nothing."""
    f_t: Asked | None = None
    """Largest relative error of the friction force at full slip."""
    contact_length: Asked | None = None
    """Largest relative error of the contact length, at normal contact and at full slip."""
    sed: Asked | None = None
    """Largest error of the strain energy density at the Merkel sites of touching ridges, relative to the largest
    density among the sites."""

    @model_validator(mode="after")
    def _asks(self) -> "Accuracy":
        if not self.tolerances():
            raise ValueError(f"accuracy is empty; give at least one of {', '.join(type(self).model_fields)}")
        return self

    def tolerances(self) -> dict[str, float]:
        """Return what is asked for, by quantity."""
        return {name: value for name in type(self).model_fields if (value := getattr(self, name)) is not None}

    def refuse(self, receptors: bool, friction: Any) -> None:
        """Refuse an accuracy of receptor sites that are not there, and of friction that is zero.

        Args:
            receptors: whether there are receptor sites.
            friction: coefficient or law of friction, a key of the scene.

        Raises:
            ValueError: the keys, their values and the remedy.
        """
        for name in ("mu_app", "f_t") if friction == 0 else ():
            if (asked := getattr(self, name)) is not None:
                raise ValueError(
                    f"accuracy.{name} is {show(asked)} and friction is 0, with which the quantity is zero and has no "
                    "relative accuracy; leave out one of the two"
                )
        if self.sed is not None and not receptors:
            raise ValueError(
                f"accuracy.sed is {show(self.sed)} and output.receptors is false, without which there are no "
                "sites; leave out one of the two"
            )


class Geometry(Fingertip):
    """Cross-section of a fingertip (Table 1 of Forsbach et al. 2023; all lengths in m), or the file of its mesh.

    The outline is an ellipse that the ridge tips touch; the lowest tip is at y = 0. Choices that the paper leaves open
    are marked as *assumption*.
    """

    file: str | None = None
    """File of a gmsh mesh in place of the cross-section and of the sizes in mesh, by the rules of ``docs/laws.md``; a
    relative path starts at the scene file. Only sc_thickness is read of the other keys, for the attraction."""
    file_sha256: str | None = None
    """Hash of that file, which a run writes into its scene; another file is then refused."""

    @model_validator(mode="before")
    @classmethod
    def _hashed(cls, data: Any) -> Any:
        file = data.get("file") if isinstance(data, dict) else None
        if not isinstance(file, str) or reading_results():
            return data
        try:
            found = hashlib.sha256(files.read(file)).hexdigest()
        except FileNotFoundError:
            raise key_error(f"is {show(file)}, and there is no such file", "file") from None
        except OSError as error:
            raise key_error(f"is {show(file)}, which cannot be read: {error.strerror}", "file") from None
        if data.get("file_sha256") not in (None, found):
            raise key_error(f"is {show(file)}, which was changed since the scene was kept; put that file back", "file")
        return data | {"file": str(Path(file).absolute()), "file_sha256": found}


def refuse_beside_mesh(data: Mapping[str, Any]) -> None:
    """Refuse keys of a scene beside ``geometry.file`` that a run on that mesh does not read.

    Args:
        data: nested tables, as they were given.

    Raises:
        SceneError: the first of them.
    """
    shape = data.get("geometry")
    if not isinstance(shape, Mapping) or shape.get("file") is None:
        return
    sizes = data.get("mesh")
    given = [f"geometry.{key}" for key in shape if key not in ("file", "file_sha256", "sc_thickness")]
    given += [f"mesh.{key}" for key in sizes] if isinstance(sizes, Mapping) else []
    given += ["accuracy"] if data.get("accuracy") is not None else []
    if given:
        raise SceneError(
            f"{clip(given[0])} is given and geometry.file too, whose mesh has its own shape and sizes and cannot be "
            "refined; leave one of the two out"
        )


class Contact(Table):
    """Discretisation of contact and friction, and the definition of the contact length.

    A formulation reads its own keys only; keys of another formulation are refused.
    """

    law: Annotated[Formulation, CONTACT] = Penalty()
    """Penalty (springs of the screen), Nitsche's method or an augmented Lagrangian; see
    :mod:`variational.contact.formulation`. The augmented Lagrangian is a method for comparison: it takes several times
    the factorisations of the penalty, finds full slip in fewer scenes (``docs/performance.md``), and its friction at
    full slip depends a little on the load path."""
    length: Literal["pressure", "gap"] = "pressure"
    """Ridge length L_R of Eq. 4: ``"pressure"`` is the length under contact pressure, ``"gap"`` the length where
    the gap is below d_eq. *Assumption*: the former; the domain printed in Eq. 4 is the whole boundary. Tables have the
    length and the mean pressure of the former in either case."""

    @model_validator(mode="before")
    @classmethod
    def _nested(cls, data: Any) -> Any:
        """Put the keys of a formulation into a table of their own."""
        if isinstance(data, Formulation):
            return {"law": data}
        if not isinstance(data, dict):
            return data
        own = {key: value for key, value in data.items() if key not in ("law", "formulation", "length")}
        before = data.get("law", {})  # a table, of a scene of which some keys are changed
        name = before if isinstance(before, str) else data.get("formulation")
        if name is not None:
            same = isinstance(before, dict) and CONTACT.kind.laws.get(str(name)) is before.get("law", ...)
            own = (before if same else {"law": name}) | own
        elif isinstance(before, dict):
            own = before | own
        elif own:
            raise ValueError(f"{next(iter(own))} is given beside a formulation, which has its own; leave it out")
        else:
            return data
        return {key: value for key, value in data.items() if key == "length"} | {"law": own}

    @model_serializer(mode="wrap")
    def _flat(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        found: dict[str, Any] = write(self)
        own = found.pop("law")
        return {"formulation": own.pop("law", self.formulation)} | own | found

    @property
    def formulation(self) -> str:
        """Name of the formulation, or its import path."""
        return CONTACT.kind.name(type(self.law))

    def __getattr__(self, name: str) -> Any:
        """Return a parameter of the formulation."""
        law = self.__dict__.get("law")
        if law is not None and name in keys_of(law):
            return getattr(law, name)
        raise AttributeError(f"contact has no {name}")


class Output(Table):
    """Optional outputs; an output that is switched off is not computed."""

    receptors: Switch = True
    """Whether strain energy densities at the Merkel and Meissner sites are computed, with elements of size
    ``mesh.receptor`` below the Merkel sites."""
    errors: Switch = True
    """Whether discretisation errors are estimated; see :mod:`fingerpad.accuracy.refinement`. Then the loading path is
    followed on elements twice as large, and the named states are solved again on the mesh that is given, finest where
    contact ends. With viscous layers the path is followed on the mesh that is given, and once more on elements twice as
    large. With an accuracy errors are always estimated."""
    sensitivities: Switch = False
    """Whether the slopes of friction, contact length and pressure by every number of the scene are computed, at full
    slip and in contact without friction; see :mod:`variational.sensitivity`."""
    each_load: Switch = True
    """Whether the finger and its skin are drawn at the end of each load. A load over time has one end."""

    def refuse(self, force: float | None, friction: Any, contact: Formulation, viscous: Any) -> None:
        """Refuse sensitivities of what has none.

        Args:
            force: on the whole finger.
            friction: coefficient or law of friction.
            contact: the formulation.
            viscous: the viscous layers.

        Raises:
            ValueError: the key, and the remedy.
        """
        remedies = {
            f"force is {show(force)} N, of slices under forces of their own; give f_ext": force is not None,
            "layers are viscous, so that states depend on their past; leave their branches out": bool(viscous),
            "friction has a memory, so that states depend on their past; take another law": getattr(
                friction, "memory", None
            ) is not None,
            "contact.formulation is of multipliers that depend on the path; take penalty": contact.tolerance > 0,
        }  # fmt: skip
        for words in (words for words, true in remedies.items() if true and self.sensitivities):
            raise ValueError(f"output.sensitivities is true and {words}, or leave the sensitivities out")


class Numerics(Table):
    """Discretisation and tolerances."""

    element: Literal["P1", "P2", "P2 reduced", "P2-P1", "P3"] = "P2"
    """Element of the displacement, and of the pressure in P2-P1; see :mod:`variational.element`."""
    quadrature_points: Annotated[int, Field(strict=True, ge=2, le=8)] = 4
    """Number of Gauss points on a surface facet."""
    tolerance: Annotated[Finite, within(1e-12, 1e-7)] = 1e-9
    """Residual of the equilibrium at which Newton's method ends, relative to the largest f_ext of the loads; where all
    are by the bone's height, to 1 N/m. Range: from 5e-7 on the forces of bone and screen can differ by more than the
    1e-6 that is accepted."""
    coupling_tolerance: Annotated[Finite, within(1e-12, 1e-3)] = 1e-6
    """Relative change of d_eq at which the coupling iteration ends. With a gain g the remaining error of d_eq is up
    to g / (1 - g) times as large, that of the attraction up to twice that."""
    coupling_cap: Annotated[int, Field(strict=True, ge=1, le=1000)] = 30
    """Largest number of coupling iterations of one solve."""
    step_scale: Annotated[Finite, within(1e-3, 10.0)] = 1.0
    """Factor on the largest steps of force, voltage and displacement."""
    memory: Annotated[Finite, within(1e8, 1e15, "B")] = 16e9
    """Most memory (bytes) of all ranks together, by :mod:`fingerpad.model.options`. A larger scene
    is refused before meshing. The default fits a machine of 24 GB."""

    @model_validator(mode="after")
    def _consistent(self) -> "Numerics":
        if self.element != "P1" and self.quadrature_points < 3:
            raise ValueError(
                f"quadrature_points is {self.quadrature_points}; it must be at least 3 for element {show(self.element)}"
            )
        return self


class Slices(Table):
    """Shape of the finger along its axis z, cut in slices (:mod:`fingerpad.slices`); no part of the cross-section.

    Without a table of heights the finger's lower side is a parabola of radius ``radius``.
    """

    radius: Annotated[Finite, within(1e-3, 1, "m")] = 28e-3
    """Radius R_z of the lower side along the axis. *Assumption*: 28 mm is that of an ellipse with semi-axes of 14 mm
    along the finger and 7 mm in height; likely values are 15 to 40 mm. Range: the end of a finger to a straight one."""
    length: Annotated[Finite, within(1e-3, 0.2, "m")] = 28e-3
    """Length of the finger pad, centred on z = 0. *Assumption*: the last phalanx. A contact that is longer is
    refused."""
    shape: Literal["parabola", "ellipsoid"] = "parabola"
    """Lower side without a table of heights: a parabola with slices of one width, or half an ellipsoid of the same
    radius and length, whose slices become narrower towards its tip. Tilts above some 15 degrees need the latter."""
    tilt: Annotated[Finite, within(1e-6, 0.79, zero=True, sides=2)] = 0.0
    """Angle α of the bone's axis to the screen (rad), positive where the end at z < 0 goes down. The indentation is
    that of the place that touches first, and slices stand upright on the screen. Range: up to 45 degrees."""
    z: Annotated[tuple[Place, ...], Many] | None = None
    """Places along the axis of the tables ``height`` and ``width``, growing. The finger ends at the first and the
    last."""
    height: Annotated[tuple[Height, ...], Many] | None = None
    """Height s of the lower side above its lowest point, at the places ``z``, in place of the parabola. Heights that
    are all 0 make a straight finger, which may touch up to its ends."""
    width: Annotated[tuple[Scale, ...], Many] | None = None
    """Width of the slices at the places ``z``, over that of the scene's cross-section: a slice is the cross-section
    on this scale. *Assumption*: 1 everywhere. Range: a tenth to ten times."""
    count: Annotated[int, Field(strict=True, ge=4, le=_MOST_PLACES)] = 48
    """Number of slices in each stretch of contact, the points of a Gauss rule. Half the default changes forces by less
    than 0.01 % and areas by less than 0.3 % on a smooth trace (``docs/newtons.md``), and by more where ridges jump."""

    @model_validator(mode="after")
    def _consistent(self) -> "Slices":
        tables = {name: values for name in ("height", "width") if (values := getattr(self, name)) is not None}
        if self.z is None:
            for name in tables:
                raise ValueError(f"{name} is given without z; give the places along the axis of its values")
            return self
        if not tables:
            raise ValueError("z is given without height or width; give one of the two, with a value for each place")
        if len(self.z) < 2:
            raise ValueError(f"z is {show(list(self.z))}; it must have two places at least, the ends of the finger")
        if any(after <= before for before, after in zip(self.z, self.z[1:], strict=False)):
            raise ValueError(f"z is {show(list(self.z))}; it must grow from each place to the next")
        for name, values in tables.items():
            if len(values) != len(self.z):
                raise ValueError(f"{name} has {len(values)} values and z has {len(self.z)}; each place needs one value")
        given = [name for name in ("radius", "length") if name in self.model_fields_set]
        given += ["shape"] if self.shape != "parabola" else []
        if self.height is not None and given:
            raise ValueError(
                f"{given[0]} is {show(getattr(self, given[0]))} and height is given too; leave out one of them"
            )
        return self


def centre_force(force: float, width: float) -> float:
    """Return about the force at the centre of a finger (N/m): of one of the default's shape, on another scale.

    Args:
        force: on the whole finger (N).
        width: of the finger (m).
    """
    scale = width / WIDTH
    return LINE * scale * (force / (POINT * scale**2)) ** POWER
