"""Geometric parameters of the fingertip and of its mesh, validated, in SI units."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, model_validator

Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Fingertip(BaseModel):
    """Cross-section of a fingertip (Table 1 of Forsbach et al. 2023; all lengths in m).

    The outline is an ellipse that the ridge tips touch; the lowest tip is at y = 0. What the paper leaves
    open is an *assumption* and said to be one below.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    width: Length = 20e-3
    height: Length = 14e-3
    sc_thickness: Length = 425e-6
    """Mean thickness of the stratum corneum; SC and viable epidermis meet in a curve parallel to the skin."""
    ve_thickness: Length = 175e-6
    """Mean thickness of the viable epidermis."""
    dermis_thickness: Length = 1400e-6
    ridge_wavelength: Length = 483e-6
    """Arc length of one papillary ridge along the outline."""
    ridge_amplitude: Length = 100e-6
    """Height of the papillary ridges, peak to peak."""
    ridge_profile: tuple[float, ...] = (1.0,)
    """Cosine coefficients c_k (k = 1, 2, …) of the ridge profile, scaled to the amplitude above; its crests, wherever
    they are, reach the outline, and the layers and receptor sites below stay centred on the ridge's middle.
    *Assumption*: a sinusoid. The measured profile of the paper is not published."""
    ridge_count: Annotated[int, Field(ge=1, le=101)] = 55
    """Number of ridges (odd: one is centred on x = 0). *Assumption*: they cover the palmar half."""
    intermediate_ridge_height: Length = 450e-6
    """Height of the epidermal ridge under a papillary ridge's centre (A2)."""
    limiting_ridge_height: Length = 150e-6
    """Height of the epidermal ridge under a groove (A1)."""
    bone_width: Length = 8e-3
    """*Assumption*, with the next two: an elliptical bone."""
    bone_height: Length = 5.2e-3
    bone_centre: Length = 8.2e-3
    """Height of the bone's centre above the screen."""
    nail_thickness: Length = 0.5e-3
    """*Assumption*, with the next two: a nail along the dorsal outline, on a bed that reaches to the bone."""
    nail_half_width: Length = 6e-3
    nail_bed_half_width: Length = 3e-3
    """Half the chord of the bone to which the nail bed is attached."""
    merkel_offset: Length = 20e-6
    """Height of a Merkel site above the tip of its intermediate ridge, inside the viable epidermis
    (*assumption*: on the interface itself the modulus jumps 24 times)."""
    meissner_offset: Length = 20e-6
    """Depth of a Meissner site below the top of its dermal papilla (*assumption*)."""

    @model_validator(mode="after")
    def _consistent(self) -> "Fingertip":
        if self.ridge_count % 2 == 0:
            raise ValueError(f"ridge_count is {self.ridge_count}; it must be odd, so that one ridge is at x = 0")
        if not any(self.ridge_profile):
            raise ValueError("ridge_profile has only zero coefficients; give at least one other, for example [1.0]")
        if self.nail_half_width >= self.width / 2:
            raise ValueError(
                f"nail_half_width is {self.nail_half_width:g} m; it must be below half the width, {self.width / 2:g} m"
            )
        if self.nail_bed_half_width >= self.bone_width / 2:
            raise ValueError(
                f"nail_bed_half_width is {self.nail_bed_half_width:g} m; "
                f"it must be below half the bone_width, {self.bone_width / 2:g} m"
            )
        if self.nail_thickness >= self.sc_thickness + self.ve_thickness + self.dermis_thickness:
            raise ValueError(
                f"nail_thickness is {self.nail_thickness:g} m; it must be below the thickness of the skin layers"
            )
        return self


class MeshSize(BaseModel):
    """Element sizes of the fingertip's mesh (m), growing linearly with the distance from what needs them."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    contact: Length = 5e-6
    """Size of surface facets where ridges can touch."""
    receptor: Length = 5e-6
    """Size at the Merkel sites of the ridges that can touch: what they sense needs an element at the tips of the
    intermediate ridges, of a radius of 6 µm, which friction and contact length hardly know of."""
    interface: Length = 80e-6
    """Largest size on wavy interfaces and on ridges that cannot touch."""
    coarsest: Length = 1e-3
    growth: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] = 0.25
    """Increase of the element size per distance."""
    touching_half_arc: Length | None = None
    """Arc length on either side of the centre within which ridges can touch; a run that finds contact at
    its end says so and begins again with more. Without it the run asks a coarse finger
    (:mod:`fingerpad.reach`); a finger is meshed with a number only."""
    touching_fraction: Annotated[float, Field(gt=0, le=1)] = 0.4
    """Part of a ridge's period, about its tip, that can touch; the grooves are coarser."""
