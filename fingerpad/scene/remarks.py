"""Remarks on values of a scene that can be run and may not be meant.

A voltage attracts as over lossless insulators, Eq. 3 of the paper. Skin conducts, and so does the air gap: below about
1 kHz the attraction falls with the frequency, and that of a constant voltage leaks away (Persson and Guo 2019, arXiv
1908.01140; measured by Meyer et al. 2013, ``docs/measured.md``). A constant voltage of a scene can be the effective
value of an alternating one, so that it has a note alone. The mean of a waveform is a constant voltage, and has a
caution.
"""

from typing import TYPE_CHECKING

from variational.roughness.bam import BearingArea

if TYPE_CHECKING:
    from fingerpad.scene.scene import Scene

LEAKAGE = (
    "Attraction is computed without leakage of charge (Eq. 3): a voltage is the effective value of an alternating "
    "drive above about 1 kHz. A constant voltage leaks away in a real finger, and attracts less."
)
"""Note on every result with a constant voltage."""
_MEAN = 0.01  # of the peak: mean of a waveform that is none
_LONGEST = 100e-6  # m, lambda_0 of the paper (Table 3), and the default


def remarks(scene: "Scene") -> list[str]:
    """Return the remarks on a scene for the cautions of its results.

    There is none on the roughness of a closure of one's own, or of a mesh of a file.
    """
    found = [*offsets(scene)]
    if isinstance(scene.roughness, BearingArea) and scene.geometry.file is None:
        found += ridges_as_roughness(scene.roughness.wavelength, scene.geometry.ridge_wavelength)
        found += missing_waves(scene.roughness.wavelength)
    return found


def leakage(scene: "Scene") -> list[str]:
    """Return the note on a constant voltage; none at 0 V, or where a caution on an offset says it."""
    return [LEAKAGE] if any(load.level for load in scene.loads()) and not offsets(scene) else []


def offsets(scene: "Scene") -> list[str]:
    """Return a caution on the waveform with the largest mean voltage; none where no mean reaches 1 % of its peak."""
    waves = [(load.name, load.wave) for load in scene.loads() if load.wave is not None]
    name, wave = max(waves, key=lambda each: abs(each[1].mean), default=("", None))
    if wave is None or abs(wave.mean) < _MEAN * wave.peak:
        return []
    return [
        f"the voltage of the load {name} has a mean of {wave.mean:.4g} V, which leaks away in a real finger; here it "
        "attracts all the time, without leakage (Eq. 3), so that the attraction is too large"
    ]


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
