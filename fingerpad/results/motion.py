"""The motion of a finger from step to step in ``fields.npz``: its lines, and its skin with pressure and attraction.

A state takes some 50 kB. Long runs keep every second, fourth, ... of their states, so that memory, checkpoints and the
file stay small.
"""

from collections.abc import Mapping, MutableMapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.results import fields
from fingerpad.scene.messages import SceneError, clip

if TYPE_CHECKING:
    from variational.snapshot import Snapshot

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Moved = Mapping[str, NDArray[np.float32]]
"""A state: ``u``, displacement of the points on lines (m), shape (points, 2); ``skin``, shape (rows, skin points)."""
ROWS = ("x", "p", "t", "p_el")
"""Rows of the skin: place (m), contact pressure, shear traction and attraction (Pa)."""
_MOST = 160  # states that are kept


def moved(snapshot: "Snapshot", skin: Mapping[str, Array]) -> Moved:
    """Return a state in single precision.

    Args:
        snapshot: the body.
        skin: along the skin by the names in :data:`ROWS`, a NaN between ridges.
    """
    u = snapshot.u[np.unique(snapshot.lines)]
    return {"u": u.astype(np.float32), "skin": np.stack([skin[name] for name in ROWS]).astype(np.float32)}


def thin(states: MutableMapping[int, Moved]) -> None:
    """Drop every second state but the last where there are too many; they are by step, in order."""
    if len(states) > _MOST:
        for step in list(states)[-2::-2]:
            del states[step]


def group(snapshot: "Snapshot", states: Mapping[int, Moved]) -> dict[str, NDArray[Any]]:
    """Return the group ``motion`` of ``fields.npz``.

    Args:
        snapshot: the body in any state.
        states: by step.
    """
    points, lines = np.unique(snapshot.lines, return_inverse=True)
    layers = np.where(snapshot.beside >= 0, snapshot.tag[snapshot.beside], 0)
    arrays = {name: np.stack([state[name] for state in states.values()]) for name in ("u", "skin")}
    about = {"x": snapshot.x[points], "lines": lines.reshape(-1, 3), "layers": layers}
    return {"step": np.array(list(states)), **about, **arrays}


@dataclass(frozen=True)
class Motion:
    """The motion of a finger."""

    step: Numbers
    """Of each state, shape (states,)."""
    x: Array
    """Reference places of points on lines (m), shape (points, 2)."""
    u: Array
    """Their displacements (m), shape (states, points, 2)."""
    lines: Numbers
    """Points where each line begins, has its middle and ends, shape (lines, 3)."""
    layers: Numbers
    """Tags on the left and on the right of each, 0 outside, shape (lines, 2)."""
    skin: Array
    """The rows of :data:`ROWS`, shape (states, rows, skin points)."""

    def between(self, k: int, part: float) -> tuple[Array, Array]:
        """Return places of points (m), shape (points, 2), and rows of the skin, on the way from a state to the next.

        Args:
            k: number of the first of both.
            part: of the way, 0 to 1; values are linear in between.
        """
        after = min(k + 1, len(self.step) - 1)
        u, skin = ((1 - part) * each[k] + part * each[after] for each in (self.u, self.skin))
        return self.x + u, skin


def read(folder: Path) -> Motion:
    """Return the motion of the finger of a run.

    Raises:
        SceneError: the folder has none; one sentence.
    """
    found: dict[str, Any] = fields.read(folder).get("motion", {})
    try:
        motion = Motion(**{name: found[name] for name in Motion.__dataclass_fields__})
        states, points = len(motion.step), len(motion.x)
        whole = motion.u.shape == (states, points, 2) and motion.skin.shape[:2] == (states, len(ROWS)) and states > 0
        whole &= motion.lines.shape[1:] == (3,) and motion.layers.shape == (len(motion.lines), 2)
        whole &= all(each.dtype.kind == "i" for each in (motion.step, motion.lines, motion.layers))
        whole = bool(whole and np.all((motion.lines >= 0) & (motion.lines < points)))
    except (KeyError, TypeError):
        whole = False
    if not whole:
        where = clip(str(folder), 80)
        raise SceneError(
            f"{where} has no motion of a run in {fields.FILE}, which is written at the end of a full run with "
            "output.each_load = true; make the run again"
        )
    return motion
