"""The pictures of a result that was read from its folder, drawn from the arrays that its run left there."""

import zipfile
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fingerpad.results.drawing import Drawing, End, View
from fingerpad.results.states import WORDS, by_load

_PICTURES = ("surface", "finger")


@dataclass(frozen=True)
class KeptDrawing(Drawing):
    """What a result that was read has for its pictures: the states, and arrays on disk that are read when drawn."""

    folder: Path
    """With ``finger_*.npz`` and ``surface*.npz``, see :meth:`fingerpad.results.drawing.Drawing.write`."""
    final_size: float | None
    """Contact size (m) of the final mesh, where an accuracy was asked for."""

    def figure(self, kind: str, path: Path | None = None) -> Figure:
        """Draw a picture as the run did, see :meth:`fingerpad.results.drawing.Drawing.figure`."""
        return self._read().figure(kind, path) if kind in _PICTURES else super().figure(kind, path)

    def _read(self) -> Drawing:
        """Return the drawing with the skin and the fingers that the folder holds."""
        profiles: dict[int, Any] = {}
        ends, finer = dict[str, End](), dict[str, View]()
        for load, states in by_load(self.states):
            words, end = load.replace(" ", "_"), states[-1]
            if finger := finger_of(self.folder / f"finger_{words}.npz"):
                ends[load] = End(end, *_finger(finger))
            if along := skin_of(self.folder / f"surface_{words}.npz", "end"):
                profiles[end.step] = along
        for name, (_, state, _) in self._shown().items():
            skin: Any = skin_of(self.folder / "surface.npz", name)
            finger = finger_of(self.folder / f"finger_{WORDS.get(name, '').replace(' ', '_')}.npz")
            if skin and finger and self.final_size is not None:
                mesh: Any = SimpleNamespace(contact=self.final_size)
                there = replace(self.named[name], bone_x=float(finger.get("bone_x", state.bone_x)))
                finer[name] = View(there, mesh, skin, *_finger(finger))
            elif skin:
                profiles[state.step] = skin
        return Drawing(self.mu_0, self.states, profiles, ends, finer, self.starting_size, self.named)


def finger_of(file: Path) -> dict[str, Any]:
    """Return the arrays of a finger by name, see :class:`variational.output.Snapshot`; none that are not whole."""
    found = arrays_of(file)
    try:
        points, triangles = len(found["x"]), found["triangles"]
        whole = found["x"].shape == found["u"].shape == (points, 2) and triangles.shape[1:] == (3,)
        whole &= found["sed"].shape == found["tag"].shape == (len(triangles),)
        whole &= triangles.dtype.kind in "iu" and bool(np.all((triangles >= 0) & (triangles < points)))
        whole &= all(found[name].dtype.kind in "iuf" for name in ("x", "u", "sed", "tag"))
    except (KeyError, TypeError):
        whole = False
    return found if whole else {}


def skin_of(file: Path, prefix: str) -> dict[str, Any]:
    """Return the skin of a state, by the names of :class:`fingerpad.results.skin_picture.SurfaceProfile`, or nothing.

    Args:
        file: of one state or several.
        prefix: of the state.
    """
    found = arrays_of(file)
    names = ("x", "y", "p", "t", "p_el", "d_eq", "ridge")
    skin = {name: found[f"{prefix}_{name}"] for name in names if f"{prefix}_{name}" in found}
    whole = all(value.ndim == 1 and value.dtype.kind == "f" for value in skin.values())
    return skin if whole and len(skin) == len(names) and len({len(value) for value in skin.values()}) == 1 else {}


def arrays_of(file: Path) -> dict[str, Any]:
    """Return the arrays of a file by name; none without a file that can be read."""
    try:
        with file.open("rb") as stream, np.load(stream, allow_pickle=False) as found:
            return dict(found)
    except (OSError, ValueError, EOFError, TypeError, RuntimeError, MemoryError, zipfile.BadZipFile, zlib.error):
        return {}


def _finger(arrays: dict[str, Any]) -> tuple[Any, Any]:
    """Return a finger and its Merkel sites."""
    return SimpleNamespace(**arrays), arrays.get("merkel")
