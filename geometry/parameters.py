"""Geometric parameters of the fingertip and of its mesh, validated, in SI units.

Ranges are wide enough for any primate's finger and for artificial ones; the docstring of a parameter gives the reason
where a range has one of its own. Consistency of several parameters is checked by :mod:`geometry.fingertip`.
"""

from typing import Annotated

from pydantic import Field, model_validator

from geometry.units import Finite, Table, within

Outline = Annotated[Finite, within(1e-3, 0.1, "m")]
Part = Annotated[Finite, within(1e-5, 0.1, "m")]
Layer = Annotated[Finite, within(1e-6, 1e-2, "m")]
Wave = Annotated[Finite, within(1e-9, 2e-3, "m")]
Offset = Annotated[Finite, within(1e-7, 1e-3, "m")]
LEAST_SIZE = 1e-8
"""Least length (m) of an element's edge: places that are 1e-9 m apart are taken for one."""
ElementSize = Annotated[Finite, within(LEAST_SIZE, 1e-2, "m")]
MOST_HARMONICS = 16


class Fingertip(Table):
    """Cross-section of a fingertip (Table 1 of Forsbach et al. 2023; all lengths in m).

    The outline is an ellipse that the ridge tips touch; the lowest tip is at y = 0. Choices that the paper leaves open
    are marked as *assumption*.
    """

    width: Outline = 20e-3
    """Width of the outline. Range: the digit of a mouse to a hand."""
    height: Outline = 14e-3
    """Height of the outline."""
    sc_thickness: Layer = 425e-6
    """Mean thickness of the stratum corneum. The junction of stratum corneum and viable epidermis is parallel to
    the skin."""
    ve_thickness: Layer = 175e-6
    """Mean thickness of the viable epidermis."""
    dermis_thickness: Layer = 1400e-6
    """Mean thickness of the dermis."""
    ridge_wavelength: Annotated[Finite, within(2e-5, 5e-3, "m")] = 483e-6
    """Arc length of one papillary ridge along the outline."""
    ridge_amplitude: Wave = 100e-6
    """Height of the papillary ridges, peak to peak. At 1 nm there are practically no ridges."""
    ridge_profile: Annotated[
        tuple[Annotated[Finite, within(1e-6, 1e6, zero=True, sides=2)], ...],
        Field(min_length=1, max_length=MOST_HARMONICS),
    ] = (1.0,)
    """Cosine coefficients c_k (k = 1, 2, …) of the ridge profile; only their ratios matter, since the profile is
    scaled to the amplitude. The crests reach the outline; layers and receptor sites stay centred on the ridge's
    middle. *Assumption*: a sinusoid, since the measured profile of the paper is not published. Curves have 32
    points per ridge, enough for 16 harmonics."""
    ridge_count: Annotated[int, Field(strict=True, ge=1, le=101)] = 55
    """Number of ridges; odd, so that one ridge is centred on x = 0. A whole finger has 3 at least. *Assumption*: the
    ridges cover the palmar half."""
    intermediate_ridge_height: Wave = 450e-6
    """Height of the epidermal ridge under a papillary ridge's centre (A2); at 1 nm the junction is flat."""
    limiting_ridge_height: Wave = 150e-6
    """Height of the epidermal ridge under a groove (A1)."""
    bone_width: Part = 8e-3
    """Width of the elliptical bone (*assumption*)."""
    bone_height: Part = 5.2e-3
    """Height of the elliptical bone (*assumption*)."""
    bone_centre: Part = 8.2e-3
    """Height of the bone's centre above the screen (*assumption*)."""
    nail_thickness: Part = 0.5e-3
    """Thickness of the nail along the dorsal outline (*assumption*)."""
    nail_half_width: Part = 6e-3
    """Half the width of the nail (*assumption*)."""
    nail_bed_half_width: Part = 3e-3
    """Half the chord of the bone to which the nail bed is attached (*assumption*)."""
    merkel_offset: Offset = 20e-6
    """Height of a Merkel site above the tip of its intermediate ridge, inside the viable epidermis. *Assumption*:
    on the interface itself the modulus jumps by a factor of 24."""
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


class MeshSize(Table):
    """Element sizes of the fingertip's mesh (m); elements grow linearly with the distance from the finest ones."""

    contact: ElementSize = 10e-6
    """Length of surface facets where ridges can touch: a quarter of the wavelength at most, and twice the least radius
    of curvature of the skin there. Where contact ends, facets of named states are a sixteenth of it. Range: below 10 nm
    skin is no continuum; 10 mm is the finger itself."""
    receptor: ElementSize = 5e-6
    """Element size at the tips of the intermediate ridges, just below the Merkel sites, of ridges that can touch. These
    tips have a radius of 6 µm, and energy densities at the sites need an element of that size. Friction and contact
    length hardly depend on this size."""
    interface: ElementSize = 80e-6
    """Largest element size on wavy junctions and on ridges that cannot touch."""
    coarsest: ElementSize = 0.5e-3
    """Largest element size. At 1 mm the force at a given indentation is 0.15 % higher, by the elements of the subcutis;
    at 0.5 mm a finger has 3 % more unknowns."""
    growth: Annotated[Finite, within(1e-4, 1)] = 0.25
    """Increase of the element size per distance from the finest elements; twice as much, and 1 at most, from the tips
    of the intermediate ridges."""
    touching_half_arc: Annotated[Finite, within(1e-6, 0.2, "m")] | None = None
    """Arc length on either side of the centre within which ridges can touch. By default a rule of thumb gives it
    (:mod:`fingerpad.model.options`). A run that finds contact at the end of this arc starts again with more
    ridges."""
    touching_fraction: Annotated[Finite, within(1e-3, 1)] = 0.4
    """Part of a ridge's period, around its crest, that can touch. Grooves have coarser facets."""

    @property
    def edge(self) -> float:
        """Length (m) of facets where contact ends, of states whose ends are known.

        The pressure falls as a root there, and the error of a length in contact is of first order in these facets.
        """
        return self.contact / 16

    def scaled(self, factor: float) -> "MeshSize":
        """Return sizes, and the growth of the elements, times a factor."""
        sizes = {name: getattr(self, name) * factor for name in ("contact", "receptor", "interface", "coarsest")}
        return self.model_copy(update=sizes | {"growth": min(self.growth * factor, 1.0)})
