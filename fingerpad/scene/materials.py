"""Materials, insulators and roughness of a scene, with units and the ranges that make sense.

A range is wider than measured values by a factor of ten or more on either side. The docstring of a key is its text in
the scene reference, ``docs/scene.md``.
"""

import re
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, Field, ValidationError, model_validator

from fingerpad.scene.messages import show
from fingerpad.scene.table import Finite, Part
from geometry.bounds import within
from variational.attraction.insulator import insulator_thickness
from variational.roughness.bam import BearingArea

if TYPE_CHECKING:
    from variational.materials.material import Material

Poisson = Annotated[Finite, within(-0.9, 0.4999)]
Modulus = Annotated[Finite, within(1.0, 1e12, "Pa")]
Permittivity = Annotated[Finite, within(1.0, 1e7)]


class Skin(Part):
    """Ogden solid (Eqs. 1 and 2)."""

    shear_modulus: Modulus
    """Initial shear modulus G_0 (Pa). Range: slime to diamond."""
    alpha: Annotated[Finite, within(1e-2, 50.0, sides=2)]
    """Exponent of the stretches, of either sign. Range: at 50 a stretch of 2 raises the stress by 1e15; zero, the
    logarithmic limit, is not supported."""
    poisson: Poisson = 0.48
    """Poisson's ratio of small strains. Range: stability needs more than -1; above 0.4999 roundoff of the volume
    decides, and such stiff volumes need the element P2-P1."""


class Stiff(Part):
    """Saint Venant-Kirchhoff solid: linear elastic at finite rotation (*assumption*; the paper: linear elastic)."""

    young: Modulus
    """Young's modulus (Pa)."""
    poisson: Poisson = 0.3
    """Poisson's ratio."""


class Materials(Part):
    """Materials of the layers (Table 2). A table that gives some keys of a layer keeps the others' defaults."""

    subcutis: Skin = Skin(shear_modulus=25e3, alpha=5.0)
    dermis: Skin = Skin(shear_modulus=2.55e3, alpha=-14.53)
    viable_epidermis: Skin = Skin(shear_modulus=61.75e3, alpha=-14.53)
    stratum_corneum: Skin = Skin(shear_modulus=86.76e3, alpha=-14.53)
    nail: Stiff = Stiff(young=170e6)
    nail_bed: Stiff = Stiff(young=1e6)
    exponent: Literal["printed", "abaqus"] = "printed"
    """Exponent of the stretches: ``"printed"`` is the paper's -alpha, ``"abaqus"`` is +alpha. *Assumption*: the
    paper prints -alpha but was computed with Abaqus, whose Ogden law has +alpha."""

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        defaults = {name: field.default for name, field in cls.model_fields.items()}
        return {
            name: defaults[name].model_dump() | given
            if isinstance(given, dict) and isinstance(defaults.get(name), BaseModel)
            else given
            for name, given in data.items()
        }

    def solids(self) -> "dict[str, Material]":
        """Return the solid of each layer by the layer's key."""
        from variational.materials.ogden import Ogden  # UFL: not for those who only read scenes
        from variational.materials.saint_venant import SaintVenant

        found: dict[str, Material] = {}
        for layer in ("subcutis", "dermis", "viable_epidermis", "stratum_corneum"):
            skin: Skin = getattr(self, layer)
            found[layer] = Ogden(skin.shear_modulus, skin.alpha, skin.poisson, self.exponent)
        found["nail"] = SaintVenant(self.nail.young, self.nail.poisson)
        found["nail_bed"] = SaintVenant(self.nail_bed.young, self.nail_bed.poisson)
        return found


class Electric(Part):
    """Insulators between finger and electrode (Table 3)."""

    eps_sc: Permittivity = 1650.0
    """Relative permittivity of the stratum corneum at 3 kHz. Range: vacuum to ten times the skin's at the lowest
    frequencies."""
    d_i: Annotated[Finite, within(1e-9, 1e-2, "m")] = 1e-6
    """Thickness of the screen's insulating layer (m). Range: a few atoms to a pane of glass."""
    eps_i: Permittivity = 3.9
    """Relative permittivity of the screen's insulating layer. Range: vacuum to ferroelectrics."""

    def h_0(self, d_sc: float) -> float:
        """Return the effective insulator thickness (m) under stratum corneum of thickness ``d_sc`` (m)."""
        return insulator_thickness(d_sc, self.eps_sc, self.d_i, self.eps_i)


Length = Annotated[Finite, within(1e-10, 0.1, "m")]


class Topography(Part):
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
    """Mark of missing pixels besides nan and empty places: a number, in a plain matrix also a word. Without it a value
    far from all other heights is refused; "nan" takes all values as measured."""

    def roughness(self) -> dict[str, float]:
        """Return h_rms and wavelength (m) of the map.

        Raises:
            ValueError: the file cannot be read, or is no height map.
        """
        from variational.roughness.heightfile import scan
        from variational.roughness.spectrum import roughness_table

        try:
            return roughness_table(scan(**dict(self)).map)
        except OSError as error:
            raise ValueError(f"topography.file is {show(self.file)}: {error.strerror or error}") from None
        except (ValueError, ImportError) as error:
            text = re.sub(r"'(unit|size|pixel|missing)'", r"topography.\1", str(error))
            raise ValueError(f"topography: {text}") from None


class Roughness(Part):
    """Roughness of a ridge (Table 3), see :class:`variational.roughness.bam.BearingArea`."""

    h_rms: Annotated[Finite, within(1e-9, 1e-3, "m")] = 3.1e-6
    """Root mean square height of the roughness (m)."""
    wavelength: Annotated[Finite, within(1e-8, 1e-2, "m")] = 100e-6
    """Largest wavelength lambda_0 of the roughness (m)."""
    young: Modulus = 1e6
    """Elastic modulus of the stratum corneum on the microscale (Pa)."""
    gamma: Annotated[Finite, within(1e-2, 10.0)] = 0.5
    """Decay length of the repulsion, relative to h_rms; Persson's theory gives 0.4 to 0.5."""
    beta: Annotated[Finite, within(1e-2, 100.0)] = 1.0
    """Prefactor of the repulsion: 1 in Eq. 9, 3/4 in Eq. 15. *Assumption*: Eq. 9 is meant."""
    p_floor: Annotated[Finite, within(1e-3, 1e9, "Pa")] = 1e3
    """Mean contact pressure (Pa) below which the air gap is held constant (*assumption*). It must be below the
    pressure at zero separation."""

    topography: Annotated[Topography | None, Field(exclude=True)] = None
    """Measured height map in place of h_rms and wavelength. The map is read at once: a scene stores only the two
    numbers."""

    @model_validator(mode="before")
    @classmethod
    def _measured(cls, data: Any) -> Any:
        if not isinstance(data, dict) or data.get("topography") is None:
            return data
        for name in ("h_rms", "wavelength"):
            if name in data:
                raise ValueError(f"{name} is {show(data[name])} and topography is given too, which has it; give one")
        given = data["topography"]
        if isinstance(given, dict):  # strict rules take no list for a tuple
            given = {key: tuple(value) if isinstance(value, list) else value for key, value in given.items()}
        try:
            found = Topography.model_validate(given)
        except ValidationError:
            return data | {"topography": given}  # to be refused where it is
        return {key: value for key, value in data.items() if key != "topography"} | found.roughness()

    def largest_gap(self, h_0: float) -> float:
        """Return the air gap (m) at which it is held, infinite where the surfaces no longer see each other."""
        with np.errstate(all="ignore"):
            return float(self.bearing_area(h_0)(self.p_floor).d_eq)

    def bearing_area(self, h_0: float) -> BearingArea:
        """Return the closure for an effective insulator thickness ``h_0`` (m)."""
        return BearingArea(h_0, **self.model_dump())

    @model_validator(mode="after")
    def _consistent(self) -> "Roughness":
        full = self.bearing_area(1.0).full_pressure
        if self.p_floor >= full:
            raise ValueError(
                f"p_floor is {show(self.p_floor)}; it must be below the pressure at zero separation, {full:.4g} Pa"
            )
        return self
