"""Materials, friction and roughness of a scene, with units and the ranges that make sense.

A range is wider than measured values by a factor of ten or more on either side. The docstring of a key is its text in
the scene reference, ``fingerpad params``.
"""

import re
import sys
import time
from collections.abc import Mapping
from numbers import Real
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError, ValidationInfo

from fingerpad import launcher
from fingerpad.scene.drive import Electric
from fingerpad.scene.law_keys import (
    Kind,
    LawKey,
    UnresolvedLaw,
    key_error,
    keys_of,
    law_error,
    nested_error,
    range_of,
    reading_results,
)
from fingerpad.scene.messages import show
from fingerpad.scene.viscosity import Viscosity, elastic
from geometry import tags
from geometry.parameters import Fingertip
from geometry.units import Finite, Table, within
from variational.attraction.adhesion import Adhesion, Dugdale
from variational.contact.aging import GrowingShear, Occlusion, Speed
from variational.contact.friction import Coulomb, Derjaguin, Friction
from variational.materials.material import Material
from variational.materials.neo_hooke import NeoHooke
from variational.materials.ogden import Ogden
from variational.materials.qlv import QLV
from variational.materials.saint_venant import SaintVenant
from variational.materials.viscoelastic import Viscoelastic
from variational.roughness import closure
from variational.roughness.bam import BearingArea
from variational.roughness.boundary_elements import BoundaryElements
from variational.roughness.persson import Persson
from variational.roughness.tabulated import TabulatedClosure


def _named(*laws: type) -> dict[str, type]:
    return {law.__name__: law for law in laws}


MATERIALS = Kind(Material, "a Material", _named(Ogden, NeoHooke, SaintVenant), Material.check)
FRICTION_LAWS = Kind(Friction, "a Friction", _named(Coulomb, Derjaguin, Occlusion, GrowingShear, Speed), Friction.check)
ADHESION_LAWS = Kind(Adhesion, "an Adhesion", _named(Dugdale), lambda law: law.check())
CLOSURES = Kind(closure.Closure, "a Closure", _named(BearingArea, BoundaryElements, Persson), closure.check)
"""Laws of the package by kind: a new one is a line here."""
PRESET_LAWS: dict[str, type] = {**MATERIALS.laws, **CLOSURES.laws}
"""Laws whose parameters a finger by name may set, by name."""
LAYERS = {name.replace(" ", "_"): tag for name, tag in tags.LAYERS.items()}
"""Tag of each layer by its key in the scene."""

_MAX_DIFFERENCE = 1e-6  # relative difference of thicknesses that are the same
_SILENT = 30.0  # s between two lines of progress in a file
LARGEST_GAP = 1.0  # m, with which the attraction is as good as none


class _MaterialKey(LawKey):
    """The key of a layer's material, which may be viscous."""

    def tables(self, law: type) -> tuple[type[BaseModel], ...]:
        """Return the table of the viscosity; a law without a volumetric part of its own cannot have one."""
        return (Viscosity,) if hasattr(law, "bulk") or "bulk" in keys_of(law) else ()

    def read(self, value: Any, info: ValidationInfo) -> Any:
        """Return the law of a value, see :meth:`fingerpad.scene.law_keys.LawKey.read`."""
        given: Any = value.table if isinstance(value, UnresolvedLaw) else value
        if elastic(given) is not given:
            return self._viscous(super().read(elastic(given), info), given.viscosity)
        if not isinstance(given, Mapping) or "viscosity" not in given:
            return super().read(value, info)
        found = super().read({key: each for key, each in given.items() if key != "viscosity"}, info)
        if given["viscosity"] is None:
            return found
        return UnresolvedLaw(given) if isinstance(found, UnresolvedLaw) else self._viscous(found, given["viscosity"])

    @staticmethod
    def _viscous(elastic: Material, viscosity: Any) -> Viscoelastic:
        try:
            viscosity = viscosity if isinstance(viscosity, QLV) else Viscosity.model_validate(viscosity).qlv()
            found = Viscoelastic(elastic, viscosity)
            found.check()
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            if first["type"] != "value_error":
                raise nested_error(error, Viscosity, "viscosity") from None
            raise law_error(f"viscosity.{first['ctx']['error']}", "viscosity") from None
        except ValueError as error:
            raise law_error(str(error), "viscosity") from None
        return found

    def written(self, law: Any) -> Any:
        """Return a law as it stands in a file."""
        if elastic(law) is law:
            return super().written(law)
        branches = {"moduli": law.viscosity.moduli, "times": law.viscosity.times}
        return super().written(elastic(law)) | {"viscosity": {"law": "QLV", **branches}}


def _layer(default: Material) -> Any:
    """Return the annotation of a layer's material; an Ogden solid has its exponent from the key before it."""
    return _MaterialKey(MATERIALS, default, of_scene=lambda data: {"convention": data.get("exponent")})


_SUBCUTIS, _DERMIS = Ogden(25e3, 5.0), Ogden(2.55e3, -14.53)
_EPIDERMIS, _CORNEUM = Ogden(61.75e3, -14.53), Ogden(86.76e3, -14.53)
_NAIL, _NAIL_BED = SaintVenant(170e6), SaintVenant(1e6)


class Materials(Table):
    """Materials of the layers (Table 2). A table that gives some keys of a layer keeps the others' defaults."""

    model_config = ConfigDict(validate_default=True)

    exponent: Literal["printed", "abaqus"] = "printed"
    """Exponent of the stretches in Ogden's law: ``"printed"`` is the paper's -alpha, ``"abaqus"`` is +alpha.
    *Assumption*: the paper prints -alpha but was computed with Abaqus, whose Ogden law has +alpha."""
    subcutis: Annotated[Material, _layer(_SUBCUTIS)] = _SUBCUTIS
    """Material of the subcutis."""
    dermis: Annotated[Material, _layer(_DERMIS)] = _DERMIS
    """Material of the dermis."""
    viable_epidermis: Annotated[Material, _layer(_EPIDERMIS)] = _EPIDERMIS
    """Material of the viable epidermis."""
    stratum_corneum: Annotated[Material, _layer(_CORNEUM)] = _CORNEUM
    """Material of the stratum corneum."""
    nail: Annotated[Material, _layer(_NAIL)] = _NAIL
    """Material of the nail."""
    nail_bed: Annotated[Material, _layer(_NAIL_BED)] = _NAIL_BED
    """Material of the nail bed."""


Length = Annotated[Finite, within(1e-10, 0.1, "m")]


class Topography(Table):
    """A measured height map, from which the roughness is taken; see :mod:`variational.roughness.heightfile`."""

    file: str
    """File of the height map: NumPy's, a plain matrix of numbers, or a format of SurfaceTopography; a relative path
    starts at the scene file."""
    unit: Literal["m", "cm", "mm", "um", "µm", "μm", "nm", "pm"] | None = None
    """Unit of the heights, for a file that has no unit of its own."""
    size: tuple[Length, Length] | None = None
    """Lengths of the map along x, from the first line of a matrix to the last, and y, along a line (m), for a file that
    has no size of its own."""
    pixel: tuple[Length, Length] | None = None
    """Lengths of a pixel along x and y (m), in place of the map's lengths."""
    missing: str | None = None
    """Number that marks missing pixels, besides nan and empty places. Without it a value far from all other heights is
    refused; "nan" takes all values and lines as measured."""

    def roughness(self, law: type[BearingArea | TabulatedClosure]) -> dict[str, Any]:
        """Return the parameters of a law that the map gives.

        Raises:
            ValueError: the file cannot be read, or is no height map.
        """
        from variational.roughness.heightfile import scan

        try:
            found = law.of_map(scan(**dict(self)).map, _Solved())
        except OSError as error:
            raise ValueError(f"topography.file is {show(self.file)}: {error.strerror or error}") from None
        except (ValueError, ImportError) as error:
            text = re.sub(r"'(unit|size|pixel|missing)'", r"topography.\1", str(error))
            raise ValueError(f"topography: {text}") from None
        for name in law.measured:
            limits = range_of(keys_of(law)[name]) if name in found else None
            if limits is not None and found[name] not in limits:
                raise ValueError(
                    f"topography has {name} = {found[name]:.4g} {limits.unit}; it must be from {limits.low:g} to "
                    f"{limits.high:g} {limits.unit}: is the unit of the heights or the size right?"
                )
        return found


class _Solved:
    """Prints how many contacts of a height map are solved: in one line of a terminal, elsewhere twice a minute."""

    def __init__(self) -> None:
        self._live, self._last = sys.stderr.isatty(), time.monotonic()

    def __call__(self, done: int, of: int) -> None:
        """Print the number of contacts that are solved and of all."""
        if launcher.rank():
            return
        text = f"contacts of the height map: {done} of {of}"
        if self._live:
            sys.stderr.write(f"\r{text}" + "\n" * (done == of))
        elif time.monotonic() - self._last > _SILENT:
            self._last = time.monotonic()
            sys.stderr.write(f"{text}\n")
        sys.stderr.flush()


class _RoughnessKey(LawKey):
    """The key of the model of roughness, which can be that of a height map."""

    def tables(self, law: type) -> tuple[type[BaseModel], ...]:
        """Return the height map, for a law that has its parameters of one."""
        return (Topography,) if hasattr(law, "of_map") else ()

    def completed(self, table: dict[str, Any], law: type) -> dict[str, Any]:
        """Return a table of parameters with those of its height map."""
        topography = table.pop("topography", None) if self.tables(law) else None
        if topography is not None:
            for name in law.measured:  # type: ignore[attr-defined]
                if name in table:
                    raise key_error(
                        f"is {show(table[name])} and roughness.topography is given too, which has it; give one", name
                    )
            try:
                table |= Topography.model_validate(topography).roughness(law)  # type: ignore[arg-type]
            except ValidationError as error:
                raise nested_error(error, Topography, "topography") from None
            except ValueError as error:
                raise law_error(
                    re.sub(r"(?<=\s)topography\.", "roughness.topography.", str(error)), "topography"
                ) from None
        return super().completed(table, law)

    def check(self, law: Any) -> None:
        """Refuse a floor of the pressure that is no floor, or holds the gap of an unloaded ridge at over a metre."""
        if getattr(law, "shared", ()) and not reading_results():
            self._refuse_floor(law)  # results are read where a measured map's table is not
        super().check(law)

    @staticmethod
    def _refuse_floor(law: Any) -> None:
        if law.p_floor >= law.pressures[1]:
            raise ValueError(f"p_floor is {show(law.p_floor)}; it must be below {law.end}, {law.pressures[1]:.4g} Pa")
        with np.errstate(all="ignore"):  # infinite where the surfaces no longer see each other
            gap = float(law(law.p_floor).d_eq)
        if not gap < LARGEST_GAP:
            raise ValueError(
                f"p_floor is {show(law.p_floor)}, where the air gap would be held at {gap:.3g} m; "
                f"it must be below {LARGEST_GAP:g} m: take a larger p_floor, or a smaller gamma or h_rms"
            )


def _insulators(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a closure has from the keys before it."""
    electric, shape = data.get("electric"), data.get("geometry")
    return {"h_0": electric.h_0(shape.sc_thickness)} if electric is not None and shape is not None else {"h_0": 1.0}


BEARING_AREA = BearingArea(Electric().h_0(Fingertip().sc_thickness))
ROUGHNESS = _RoughnessKey(CLOSURES, BEARING_AREA, of_scene=_insulators, all_laws=True)
FRICTION = LawKey(FRICTION_LAWS, Coulomb(0.25), number="mu_f")
NO_ADHESION = Dugdale(0.0)
ADHESION = Annotated[Adhesion, LawKey(ADHESION_LAWS, NO_ADHESION)]


def adheres(law: Adhesion | UnresolvedLaw) -> bool:
    """Return whether a scene's law of adhesion attracts; one of one's own in results that were read does."""
    return isinstance(law, UnresolvedLaw) or law.work > 0


def refuse_memory(force: float | None, friction: Any) -> None:
    """Refuse a law of friction with a memory beside a force on the whole finger (N), by ``ValueError``."""
    if force is not None and isinstance(friction, Friction) and friction.memory is not None:
        raise ValueError(
            "force is given and friction has a memory, and the sum of slices has no common time; give f_ext or a "
            "history"
        )


def refuse_thickness(closure: Any, h_0: float) -> None:
    """Refuse a closure of another insulator than the one whose voltage attracts.

    Args:
        closure: a closure; one without a number ``h_0`` has no insulator of its own.
        h_0: effective insulator thickness of the attraction (m).

    Raises:
        ValueError: the two differ by more than roundoff.
    """
    own = getattr(closure, "h_0", h_0)
    if isinstance(own, Real) and abs(float(own) - h_0) > _MAX_DIFFERENCE * h_0:
        raise ValueError(
            f"the closure {type(closure).__name__} has h_0 = {float(own):.7g} m, and the attraction has an effective "
            f"insulator thickness h_0 of {h_0:.7g} m; the two must be the same"
        )
