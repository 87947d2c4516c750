r"""Exact linear-elastic contact of a rough ridge as a closure: a periodic half-space on a hard wall.

:mod:`~variational.roughness.halfspace` solves the contact, attraction does not deform it (Derjaguin, Muller and
Toporov, as in the paper's model), and the equivalent air gap has the attraction of all gaps that are found. By linear
elasticity one table, :mod:`~variational.roughness.gaps`, serves every modulus, height, wavelength, insulator and
voltage. The package has tables of self-affine Gaussian surfaces with Hurst exponents of 0.6 to 0.9; a measured height
map has its own.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from variational.roughness import gaps
from variational.roughness.closure import Progress
from variational.roughness.gaps import GapTable
from variational.roughness.tabulated import TabulatedClosure

if TYPE_CHECKING:
    from variational.roughness.topography import HeightMap


@dataclass(frozen=True)
class BoundaryElements(TabulatedClosure):
    """A rough ridge on a hard wall, by boundary elements; SI units."""

    surface: str = ""
    """Name of a measured map's table, which ``topography`` computes; empty for the package's Gaussian surfaces. With
    it ``shortest_wave`` and ``hurst`` are those of the map, and the keys are not read."""
    measured: ClassVar[tuple[str, ...]] = (*TabulatedClosure.measured, "surface", "shortest_wave", "hurst")
    shared: ClassVar[tuple[str, ...]] = (*TabulatedClosure.shared, "surface")

    def tables(self) -> list[tuple[float, GapTable]]:
        """Return the tables of the spectrum, or that of the measured map.

        Raises:
            ValueError: there is none; in one sentence.
        """
        if self.surface:
            return gaps.of_map(self.surface)
        try:
            return gaps.of_spectrum(self.hurst, self.wavelength / self.shortest_wave)
        except ValueError as error:
            if str(error).startswith("hurst"):
                raise ValueError(f"{error}, and Persson has no such limits") from None
            ratios = gaps.ratios(self.hurst)
            low, high = self.wavelength / ratios[-1], self.wavelength / ratios[0]
            raise ValueError(
                f"shortest_wave is {self.shortest_wave:g} m; {error}, so take {low:.4g} to {high:.4g} m"
            ) from None

    @classmethod
    def of_map(cls, measured: "HeightMap", progress: Progress | None = None) -> dict[str, Any]:
        """Return the parameters that a measured map gives, whose table is computed once and kept.

        Args:
            measured: heights (m).
            progress: called after each contact with the number done and the total.

        Raises:
            ValueError: a map that is flat or has too few pixels or pixels that are not square; in one sentence.
        """
        from variational.roughness.halfspace import keep  # solves contacts

        name, h_rms, wavelength = keep(measured.detrended("curvature"), progress)
        return {"h_rms": h_rms, "wavelength": wavelength, "surface": name}
