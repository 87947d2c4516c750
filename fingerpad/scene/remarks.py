"""Remarks on values of a scene that can be run and may not be meant."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fingerpad.scene.scene import Scene


def remarks(scene: "Scene") -> list[str]:
    """Return the remarks on a scene for the cautions of its results.

    There is none on keys that a law or a mesh of its own replaces.
    """
    if scene.laws.closure is not None or scene.laws.mesh is not None:
        return []
    return ridges_as_roughness(scene.roughness.wavelength, scene.geometry.ridge_wavelength)


def ridges_as_roughness(wavelength: float, ridge_wavelength: float) -> list[str]:
    """Return a remark where the roughness is not short beside a ridge, as that of a height map of several ridges is.

    *Assumption*: it is not where its largest wavelength is above half of the ridges' distance.

    Args:
        wavelength: the largest one (m) of the roughness.
        ridge_wavelength: distance (m) of ridges.
    """
    if wavelength <= ridge_wavelength / 2:
        return []
    return [
        f"roughness.wavelength is {wavelength:.3g} m, above half of geometry.ridge_wavelength, {ridge_wavelength:.3g} "
        "m: ridges or the finger's form may count as roughness; remove both from the height map, or take a smaller map "
        "on one ridge"
    ]
