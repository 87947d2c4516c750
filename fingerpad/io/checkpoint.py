"""The checkpoint of a run: files from which the run goes on after it was cut short.

``checkpoint/head.json`` in the folder of results says of which scene and by which program; the parts ``0001.npz``, …
hold what was computed since the part before, as arrays and JSON, without pickle. A part is written beside, flushed to
the disk and put in place, so that after a power cut each part is there as a whole or not at all. The folder goes when
the run reaches its end. adios4dolfinx keeps fields only, which are the smaller half of what a run goes on from.
"""

import hashlib
import json
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.io.files import read_object, remove, replace_json
from fingerpad.scene import SceneError

Arrays = dict[str, NDArray[Any]]
_FORMAT = 1
_FACTS = "facts"


class CheckpointError(SceneError):
    """A checkpoint from which a run cannot go on; one sentence."""


class Checkpoint:
    """Parts in a folder, of one scene and one program; all of it on rank 0."""

    def __init__(self, results: Path, parameters: Mapping[str, Any], versions: Mapping[str, str]) -> None:
        """Name the folder; nothing is touched.

        Args:
            results: folder of the run's results.
            parameters: of its scene.
            versions: of what its numbers depend on, by name.
        """
        self._results, self._folder = results, results / "checkpoint"
        scene = hashlib.sha256(json.dumps(parameters, sort_keys=True).encode()).hexdigest()
        self._head = {"format": _FORMAT, "scene": scene, **versions}

    def _part(self, number: int) -> Path:
        return self._folder / f"{number:04d}.npz"

    def count(self) -> int:
        """Return the number of parts."""
        return next(number for number in range(1_000_000) if not self._part(number + 1).exists())

    def check(self) -> None:
        """Refuse to go on where that is not possible.

        Raises:
            CheckpointError: why not.
        """
        results = f"{str(self._results)[-80:]}"
        if self.count() == 0:
            why = "reached its end" if self._ended() else "not come to one; run again with --out"
            raise CheckpointError(f"{results} has no checkpoint to go on from: its run has {why}")
        file = self._folder / "head.json"
        try:
            head = read_object(file)
        except (OSError, ValueError) as error:
            raise CheckpointError(f"{file} cannot be read ({error}); run again without --resume") from None
        for name, value in self._head.items():
            if head.get(name) != value:
                raise CheckpointError(
                    f"the checkpoint in {results} is of another {name} ({str(head.get(name))[:12]}, and "
                    f"{str(value)[:12]} now), which may compute other numbers; run again without --resume"
                )
        for number in range(1, self.count() + 1):
            try:
                with zipfile.ZipFile(self._part(number)) as part:
                    damaged = part.testzip() is not None or f"{_FACTS}.npy" not in part.namelist()
            except (OSError, zipfile.BadZipFile, ValueError):
                damaged = True
            if damaged:
                raise CheckpointError(
                    f"{self._part(number)} is not whole; delete it, and those after it, to go on from what is before it"
                )

    def _ended(self) -> bool:
        """Return whether the run has written its results, and was not stopped before."""
        try:
            summary = read_object(self._results / "summary.json")
        except (OSError, ValueError):
            return False
        return not summary.get("interrupted")

    def read(self, number: int) -> tuple[Any, Arrays]:
        """Return the JSON and the arrays of a part."""
        with np.load(self._part(number), allow_pickle=False) as file:
            arrays = dict(file)
        return json.loads(arrays.pop(_FACTS).tobytes()), arrays

    def write(self, number: int, facts: Any, arrays: Arrays) -> None:
        """Write a part; with the first, those of an earlier run go."""
        if number == 1:
            self.delete()
            self._folder.mkdir()
            replace_json(self._folder / "head.json", self._head)
        file = self._part(number)
        beside = file.with_suffix(".part")
        whole: dict[str, Any] = {_FACTS: np.frombuffer(json.dumps(facts).encode(), dtype=np.uint8), **arrays}
        remove(beside)
        try:
            with beside.open("xb") as stream:
                np.savez(stream, **whole)
                stream.flush()
                os.fsync(stream.fileno())
            beside.replace(file)
        except OSError:
            beside.unlink(missing_ok=True)
            raise
        folder = os.open(self._folder, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)

    def delete(self) -> None:
        """Delete all parts."""
        remove(self._folder)
