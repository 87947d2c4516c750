"""Remarks on values of a scene that can be run and may not be meant."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fingerpad.scene.scene import Scene

_LONGEST = 100e-6  # m, lambda_0 of the paper (Table 3), and the default


def remarks(scene: "Scene") -> list[str]:
    """Return the remarks on a scene for the cautions of its results.

    There is none on keys that a law or a mesh of its own replaces.
    """
    if scene.laws.closure is not None or scene.laws.mesh is not None:
        return []
    found = ridges_as_roughness(scene.roughness.wavelength, scene.geometry.ridge_wavelength)
    return found + missing_waves(scene.roughness.wavelength)


def missing_waves(longest: float) -> list[str]:
    """Return a remark where roughness ends at waves that are short beside the paper's largest ones.

    *Assumption*: they are below half of 100 µm. h_rms of a self-affine surface is then 0.6 of the whole one's or less.

    Args:
        longest: wave (m) that a height map can hold, its shorter side, or largest one of the roughness.
    """
    if longest >= _LONGEST / 2:
        return []
    return [
        f"roughness ends at waves of {longest:.3g} m, and skin has waves up to {_LONGEST:.3g} m: waves longer than a "
        "height map are missing in its h_rms, which depends on the size of the map; take a larger map"
    ]


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
