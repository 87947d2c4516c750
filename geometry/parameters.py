"""Geometric parameters of the fingertip and of its mesh, validated, in SI units.

Ranges are wide enough for any primate's finger and for artificial ones; each has its reason in the docstring of its
parameter, or of the one before. What the parameters are together is checked by :mod:`geometry.fingertip`.
"""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, model_validator

from geometry.bounds import within

Finite = Annotated[float, Field(allow_inf_nan=False)]
Outline = Annotated[Finite, within(1e-3, 0.1, "m")]
Part = Annotated[Finite, within(1e-5, 0.1, "m")]
Layer = Annotated[Finite, within(1e-6, 1e-2, "m")]
Wave = Annotated[Finite, within(1e-9, 2e-3, "m")]
Offset = Annotated[Finite, within(1e-7, 1e-3, "m")]
ElementSize = Annotated[Finite, within(1e-8, 1e-2, "m")]
MOST_HARMONICS = 16


class Fingertip(BaseModel):
    """Cross-section of a fingertip (Table 1 of Forsbach et al. 2023; all lengths in m).

    The outline is an ellipse that the ridge tips touch; the lowest tip is at y = 0. What the paper leaves
    open is an *assumption* and said to be one below.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    width: Outline = 20e-3
    """Of the outline, as the height: 1 mm (a mouse's digit) to 0.1 m (a hand)."""
    height: Outline = 14e-3
    sc_thickness: Layer = 425e-6
    """Mean thickness of the stratum corneum; SC and viable epidermis meet in a curve parallel to the skin. The layers
    are of 1 µm, of which cells are made, to 10 mm, the thickness of a finger."""
    ve_thickness: Layer = 175e-6
    """Mean thickness of the viable epidermis."""
    dermis_thickness: Layer = 1400e-6
    ridge_wavelength: Annotated[Finite, within(2e-5, 5e-3, "m")] = 483e-6
    """Arc length of one papillary ridge along the outline; ten times as fine or coarse as any skin's."""
    ridge_amplitude: Wave = 100e-6
    """Height of the papillary ridges, peak to peak; 1 nm is as good as no ridges, 2 mm is beyond any skin."""
    ridge_profile: Annotated[
        tuple[Annotated[Finite, within(1e-6, 1e6, zero=True, sides=2)], ...],
        Field(min_length=1, max_length=MOST_HARMONICS),
    ] = (1.0,)
    """Cosine coefficients c_k (k = 1, 2, …) of the ridge profile, scaled to the amplitude above; its crests, wherever
    they are, reach the outline, and the layers and receptor sites below stay centred on the ridge's middle.
    *Assumption*: a sinusoid. The measured profile of the paper is not published. Curves have 32 points a ridge, which
    16 harmonics use up; of coefficients only the ratios matter."""
    ridge_count: Annotated[int, Field(ge=1, le=101)] = 55
    """Number of ridges (odd: one is centred on x = 0). *Assumption*: they cover the palmar half."""
    intermediate_ridge_height: Wave = 450e-6
    """Height of the epidermal ridge under a papillary ridge's centre (A2); 1 nm is a plane junction."""
    limiting_ridge_height: Wave = 150e-6
    """Height of the epidermal ridge under a groove (A1)."""
    bone_width: Part = 8e-3
    """*Assumption*, with the next two: an elliptical bone. Bone and nail are of 10 µm (a foil) to 0.1 m (a hand)."""
    bone_height: Part = 5.2e-3
    bone_centre: Part = 8.2e-3
    """Height of the bone's centre above the screen."""
    nail_thickness: Part = 0.5e-3
    """*Assumption*, with the next two: a nail along the dorsal outline, on a bed that reaches to the bone."""
    nail_half_width: Part = 6e-3
    nail_bed_half_width: Part = 3e-3
    """Half the chord of the bone to which the nail bed is attached."""
    merkel_offset: Offset = 20e-6
    """Height of a Merkel site above the tip of its intermediate ridge, inside the viable epidermis
    (*assumption*: on the interface itself the modulus jumps 24 times). From 0.1 µm, a part of a cell, to 1 mm, more
    than any epidermis."""
    meissner_offset: Offset = 20e-6
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

    contact: ElementSize = 5e-6
    """Size of surface facets where ridges can touch. Sizes are of 10 nm, below which skin is no continuum, to 10 mm,
    the finger itself; what a machine can hold is checked by itself (:mod:`geometry.count`)."""
    receptor: ElementSize = 5e-6
    """Size at the Merkel sites of the ridges that can touch: what they sense needs an element at the tips of the
    intermediate ridges, of a radius of 6 µm, which friction and contact length hardly know of."""
    interface: ElementSize = 80e-6
    """Largest size on wavy interfaces and on ridges that cannot touch."""
    coarsest: ElementSize = 1e-3
    growth: Annotated[Finite, within(1e-4, 1)] = 0.25
    """Increase of the element size per distance; 1e-4 is as good as none across a finger, and beyond 1 elements are no
    longer graded."""
    touching_half_arc: Annotated[Finite, within(1e-6, 0.2, "m")] | None = None
    """Arc length on either side of the centre within which ridges can touch; a run that finds contact at
    its end says so and begins again with more. Without it a rule of thumb gives it
    (:mod:`fingerpad.model.touching`); a finger is meshed with a number only. 1 µm is ridge 0 alone, 0.2 m goes round
    any finger."""
    touching_fraction: Annotated[Finite, within(1e-3, 1)] = 0.4
    """Part of a ridge's period, about its crest, that can touch; the grooves are coarser. A thousandth is a point."""
