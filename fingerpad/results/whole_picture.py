"""The pictures of a whole finger from its result: its footprint, and the finger in three dimensions."""

from pathlib import Path

from matplotlib.figure import Figure

from fingerpad.results.data import ResultData
from fingerpad.results.finger_picture import footprint
from fingerpad.results.solid_picture import solid
from geometry.profiles import Profiles


def draw(result: ResultData, kind: str, path: Path | None) -> Figure:
    """Draw a picture of a result with a whole finger, on rank 0.

    Args:
        result: with ``finger``.
        kind: ``"footprint"`` or ``"solid"``.
        path: of the PNG file; None for the figure alone.
    """
    assert result.finger is not None
    section = Profiles(result.scene.geometry)
    if kind == "footprint":
        return footprint(result.finger, path, result.named, section.finger.ridge_wavelength)
    name = list(result.finger.states)[-1]
    return solid(result.finger, section, path, result.named.get(name), name)
