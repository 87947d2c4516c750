"""The pictures of a result that was read from its folder, drawn from the arrays that its run left there."""

import zipfile
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fingerpad.io.drawing import Drawing, End
from fingerpad.io.states import PREFIXES, WORDS, by_load
from fingerpad.io.views import View

_PICTURES = ("surface", "finger")


@dataclass(frozen=True)
class KeptDrawing(Drawing):
    """What a result that was read has for its pictures: the states, and arrays on disk that are read when drawn."""

    folder: Path
    """With ``finger_*.npz`` and ``surface*.npz``, see :meth:`fingerpad.io.drawing.Drawing.write`."""
    final_size: float | None
    """Contact size (m) of the final mesh, where an accuracy was asked for."""

    def figure(self, kind: str, path: Path | None = None) -> Figure:
        """Draw a picture as the run did; arguments and errors as of :meth:`fingerpad.io.drawing.Drawing.figure`."""
        return self._read().figure(kind, path) if kind in _PICTURES else super().figure(kind, path)

    def _read(self) -> Drawing:
        """Return the drawing with the skin and the fingers that the folder holds."""
        profiles: dict[int, Any] = {}
        ends, finer = dict[str, End](), dict[str, View]()
        for load, states in by_load(self.states):
            words, end = load.replace(" ", "_"), states[-1]
            if finger := _arrays(self.folder / f"finger_{words}.npz"):
                ends[load] = End(end, *_finger(finger))
            if skin := _part(_arrays(self.folder / f"surface_{words}.npz"), "end"):
                profiles[end.step] = skin
        kept, names = _arrays(self.folder / "surface.npz"), {prefix: name for name, prefix in PREFIXES.items()}
        for prefix, (_, state, _) in self._shown().items():
            skin, name = _part(kept, prefix), names.get(prefix, "")
            finger = _arrays(self.folder / f"finger_{WORDS.get(name, '').replace(' ', '_')}.npz")
            if skin and finger and self.final_size is not None:
                mesh: Any = SimpleNamespace(contact=self.final_size)
                there = replace(self.named[name], bone_x=float(finger.get("bone_x", state.bone_x)))
                finer[name] = View(there, mesh, skin, *_finger(finger), [], [])
            elif skin:
                profiles[state.step] = skin
        return Drawing(self.mu_0, self.states, profiles, ends, finer, self.starting_size, self.named)


def _arrays(file: Path) -> dict[str, Any]:
    """Return the arrays of a file by name; none without a file that can be read."""
    try:
        with file.open("rb") as stream, np.load(stream, allow_pickle=False) as found:
            return dict(found)
    except (OSError, ValueError, EOFError, TypeError, zipfile.BadZipFile, zlib.error):
        return {}


def _part(arrays: dict[str, Any], prefix: str) -> Any:
    """Return the skin of a state, by the names of :class:`fingerpad.io.skin_picture.SurfaceProfile`."""
    return {name.removeprefix(f"{prefix}_"): value for name, value in arrays.items() if name.startswith(f"{prefix}_")}


def _finger(arrays: dict[str, Any]) -> tuple[Any, Any]:
    """Return a finger and its Merkel sites."""
    return SimpleNamespace(**arrays), arrays.get("merkel")
