"""The pictures of a whole finger from its result: its footprint, and the finger in three dimensions."""

from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from fingerpad.results.finger_picture import footprint
from fingerpad.results.solid_picture import solid

if TYPE_CHECKING:
    from fingerpad.results.answer import Answer
    from fingerpad.results.drawing import Drawing


def draw(result: "Answer", drawing: "Drawing | None", kind: str, path: Path | None) -> Figure:
    """Draw a picture of a result with a whole finger, on rank 0.

    Args:
        result: with ``finger``.
        drawing: what its other pictures are drawn from.
        kind: ``"footprint"`` or ``"solid"``.
        path: of the PNG file; None for the figure alone.

    Raises:
        ValueError: the result has no cross-section to draw in three dimensions.
    """
    assert result.finger is not None
    spacing = result.scene.geometry.ridge_wavelength
    if kind == "footprint":
        return footprint(result.finger, path, result.named, spacing)
    body, name = None if drawing is None else drawing.body(), list(result.finger.states)[-1]
    if body is None or name not in result.named:
        raise ValueError("the result has no cross-section to draw in three dimensions; a full run with a folder has")
    return solid(result.finger, body, path, result.named[name], name, spacing)
