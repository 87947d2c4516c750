"""The checkpoint of a run: its last accepted state and all of its tables, from which it goes on after it was cut short.

``checkpoint/head.json`` in the folder of results names the scene and the program; ``0001.npz``, ... hold arrays and
JSON, without pickle. The list of accepted states only grows: ``0001.more.npz``, ... hold what a checkpoint has more of
it than the one before. Each file is flushed to the disk before it gets its name, so that after a power cut it is there
as a whole or not at all. The last two checkpoints stay, and all that their lists need. The folder goes when the run
reaches its end.
"""

import hashlib
import io
import json
import os
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import fingerpad.startup  # noqa: F401
from fingerpad.accuracy.states import State
from fingerpad.results.fields import View
from fingerpad.results.files import read_object, remove, replace_json
from fingerpad.results.folder import CheckpointError, on_rank_0
from fingerpad.results.provenance import provenance
from fingerpad.results.quantities import Output
from fingerpad.scene import Scene
from fingerpad.startup import MPI
from variational.files import read as read_bytes
from variational.snapshot import Snapshot
from variational.solvers.outcome import Counts
from variational.solvers.state_snapshot import SkinState, StateSnapshot
from variational.solvers.target import Control, Progress
from variational.state import ContactState, Errors, RidgeStates, Sites, Skin, StepRecord, Stimuli

Arrays = dict[str, NDArray[Any]]
_CLASSES = (
    *(ContactState, RidgeStates, Sites, Stimuli, StepRecord, Errors, Skin, Control, Counts, Progress),
    *(State, StateSnapshot, SkinState, View, Snapshot),
)  # dataclasses of what a checkpoint holds
_FORMAT = 4
_FACTS, _MORE = "facts", "more"
_COUNT = 2  # checkpoints in a folder, of which the earlier serves where the last is damaged


class Checkpoint:
    """States of one run in a folder, of one scene and one program; all of it on rank 0.

    Attributes:
        number: of the last one, 0 before there is one.
    """

    def __init__(self, results: Path, parameters: Mapping[str, Any], versions: Mapping[str, str]) -> None:
        """Name the folder, in that of the results; ``versions`` are of all that its numbers depend on, by name."""
        self._results, self._folder = results, results / "checkpoint"
        scene = hashlib.sha256(json.dumps(parameters, sort_keys=True).encode()).hexdigest()
        self._head = {"format": _FORMAT, "scene": scene, **versions}
        self.number = 0
        self._count, self._last = 0, None  # items of the list that are written; the last of them, which identifies it
        self._numbers: tuple[int, ...] = ()  # of the checkpoints with which they were written

    def _file(self, number: int, kind: str = "") -> Path:
        return self._folder / f"{number:04d}{kind}.npz"

    def read(self, classes: Iterable[type] = ()) -> dict[str, Any]:
        """Return the last state, which may hold some dataclasses; its list of items has the name ``items``.

        Raises:
            CheckpointError: there is none, or it is of another scene or program, or damaged.
        """
        results = str(self._results)[-80:]
        numbers = [int(file.stem) for file in self._folder.glob("[0-9]*.npz") if file.stem.isdecimal()]
        if not numbers:
            raise CheckpointError(
                f"{results} has no checkpoint to go on from: its run has reached its end, or not come to one; run "
                "again without --resume"
            )
        file, known = self._folder / "head.json", {cls.__name__: cls for cls in classes}
        try:
            head = read_object(file)
            for name, value in self._head.items():
                if head.get(name) != value:
                    raise CheckpointError(
                        f"the checkpoint in {results} is of another {name} ({str(head.get(name))[:12]}, and "
                        f"{str(value)[:12]} now), which may compute other numbers; run again without --resume"
                    )
            file = self._file(max(numbers))
            found, items = _read(file, known), list[Any]()
            self._numbers = tuple(found.pop(_MORE))
            for number in self._numbers:
                file = self._file(number, ".more")
                items += _read(file, known)
        except CheckpointError:
            raise
        except (KeyError, OSError, TypeError, ValueError, RecursionError, zipfile.BadZipFile) as error:
            raise CheckpointError(
                f"{file} cannot be read ({error!r}); delete the last checkpoint, to go on from the one before it, or "
                "run again without --resume"
            ) from error
        self.number, self._count, self._last = max(numbers), len(items), items[-1] if items else None
        return {**found, "items": items}

    def write(self, state: Mapping[str, Any], items: Sequence[Any] = ()) -> None:
        """Write a state; the last but one goes, and with the first of a run those of an earlier run.

        Args:
            state: arrays, dataclasses, dictionaries and numbers by name.
            items: a list that grows from one checkpoint to the next, and none of whose items ever changes. Another list
                is written as a whole.
        """
        if self.number == 0:
            self.delete()
            self._folder.mkdir()
            replace_json(self._folder / "head.json", self._head)
        number, count, numbers = self.number + 1, self._count, self._numbers
        if len(items) < count or (count and items[count - 1] is not self._last):
            count, numbers = 0, ()
        if len(items) > count:
            _write(self._file(number, ".more"), list(items[count:]))
            numbers = (*numbers, number)
        _write(self._file(number), {**state, _MORE: list(numbers)})
        self._count, self._last, self._numbers = len(items), items[-1] if items else None, numbers
        self.number = number
        folder = os.open(self._folder, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
        self._file(number - _COUNT).unlink(missing_ok=True)

    def delete(self) -> None:
        """Delete all of it."""
        remove(self._folder)


def checkpoint_of(scene: Scene, folder: Path, outputs: Sequence[Output]) -> Checkpoint:
    """Return the checkpoint of a scene by the present program."""
    versions = provenance()["versions"]
    names = ", ".join(each.name for each in outputs) or "none"
    same = {"source": versions["source"], "dolfinx": versions["dolfinx"], "list of outputs": names}
    return Checkpoint(folder, scene.parameters(), same)


def read(checkpoint: Checkpoint, comm: MPI.Comm, classes: Sequence[type] = ()) -> dict[str, Any]:
    """Return what the last checkpoint holds, on every rank; ``classes`` besides those of a run; collective.

    Raises:
        CheckpointError: a run cannot go on from there; on every rank.
    """
    return on_rank_0(comm, lambda: checkpoint.read((*_CLASSES, *classes)))


def _write(file: Path, value: Any) -> None:
    """Write a value, as a whole or not at all."""
    parts: dict[str, list[NDArray[Any]]] = {}
    facts = json.dumps(_plain(value, parts, {})).encode()
    arrays: dict[str, Any] = {name: np.concatenate(each) for name, each in parts.items()}
    arrays[_FACTS] = np.frombuffer(facts, dtype=np.uint8)
    part = file.with_suffix(".part")
    remove(part)
    try:
        with part.open("xb") as stream:
            np.savez(stream, **arrays)
            stream.flush()
            os.fsync(stream.fileno())
        part.replace(file)
    except OSError:
        part.unlink(missing_ok=True)
        raise


def _read(file: Path, classes: Mapping[str, type]) -> Any:
    """Return the value that a file holds."""
    data = read_bytes(file)
    if zipfile.ZipFile(io.BytesIO(data)).testzip() is not None:
        raise zipfile.BadZipFile("a checksum differs")
    with np.load(io.BytesIO(data), allow_pickle=False) as stream:
        arrays = dict(stream)
    return _restored(json.loads(arrays.pop(_FACTS).tobytes()), arrays, classes)


def _plain(value: Any, parts: dict[str, list[NDArray[Any]]], sizes: dict[str, int]) -> Any:
    """Return a value ready for JSON; its arrays are put into one a type, flat: ``parts``, with the ``sizes`` so far."""
    if isinstance(value, np.ndarray):
        kind = value.dtype.name
        parts.setdefault(kind, []).append(value.ravel())
        sizes[kind] = sizes.get(kind, 0) + value.size
        return {"array": [kind, sizes[kind] - value.size, value.shape]}
    if isinstance(value, np.generic):
        return value.item()
    if is_dataclass(value) and not isinstance(value, type):
        whole = {field.name: _plain(getattr(value, field.name), parts, sizes) for field in fields(value)}
        return {type(value).__name__: whole}
    if isinstance(value, Mapping):
        return {"dict": [[_plain(each, parts, sizes) for each in pair] for pair in value.items()]}
    if isinstance(value, tuple):
        return {"tuple": [_plain(each, parts, sizes) for each in value]}
    if isinstance(value, list):
        return [_plain(each, parts, sizes) for each in value]
    return value


def _restored(value: Any, arrays: Arrays, classes: Mapping[str, type]) -> Any:
    """Return what :func:`_plain` was given."""
    if isinstance(value, list):
        return [_restored(each, arrays, classes) for each in value]
    if not isinstance(value, dict):
        return value
    ((kind, inner),) = value.items()
    if kind == "array":
        name, start, shape = inner
        return arrays[name][start : start + int(np.prod(shape))].reshape(shape)
    if kind == "dict":
        return dict(_restored(each, arrays, classes) for each in inner)
    if kind == "tuple":
        return tuple(_restored(each, arrays, classes) for each in inner)
    return classes[kind](**{name: _restored(each, arrays, classes) for name, each in inner.items()})
