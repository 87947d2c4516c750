"""The checkpoint of a run: its last accepted state and all of its tables, from which it goes on after it was cut short.

``checkpoint/head.json`` in the folder of results says of which scene and by which program; ``0001.npz``, ... hold
arrays and JSON, without pickle, each what a run goes on from. A list that only grows (:class:`Growing`), as that of the
accepted states, is not written again and again: ``0001.more.npz``, ... hold what a checkpoint has more of it than the
one before. Files are written beside, flushed to the disk and put in place, so that after a power cut each is there as a
whole or not at all. The last two checkpoints stay, and all that their lists need. The folder goes when the run reaches
its end.
"""

import hashlib
import io
import json
import os
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.results.files import read_object, remove, replace_json
from fingerpad.scene import SceneError
from variational.files import read

Arrays = dict[str, NDArray[Any]]
_FORMAT = 3
_FACTS, _MORE = "facts", "more"
_STAY = 2  # checkpoints, of which the earlier serves where the last is damaged


class CheckpointError(SceneError):
    """A checkpoint from which a run cannot go on; one sentence."""


@dataclass(frozen=True)
class Growing:
    """A list to which items are added, and none of whose items ever changes. A checkpoint holds one of it."""

    items: list[Any]


@dataclass
class _Kept:
    """Files that hold the items of a growing list."""

    last: Any = None
    """The last item, by which the list is known again."""
    count: int = 0
    numbers: tuple[int, ...] = ()
    """Of the checkpoints with which they were written."""


class Checkpoint:
    """States of one run in a folder, of one scene and one program; all of it on rank 0.

    Attributes:
        number: of the last one, 0 before there is one.
    """

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
        self.number, self._kept = 0, _Kept()

    def _file(self, number: int) -> Path:
        return self._folder / f"{number:04d}.npz"

    def _more(self, number: int) -> Path:
        return self._folder / f"{number:04d}.more.npz"

    def _last(self) -> int:
        """Return the number of the last state in the folder."""
        return max((int(file.stem) for file in self._folder.glob("[0-9]*.npz") if file.stem.isdecimal()), default=0)

    def check(self) -> None:
        """Find the last state; refuse to go on where that is not possible.

        Raises:
            CheckpointError: why not.
        """
        results = f"{str(self._results)[-80:]}"
        last = self._last()
        if last == 0:
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
        more = self._more(last)
        if not _whole(self._file(last)) or (more.exists() and not _whole(more)):
            raise CheckpointError(
                f"{self._file(last)} is not whole; delete it, to go on from the one before it if there is one"
            )
        self.number = last

    def _ended(self) -> bool:
        """Return whether the run has written its results, and was not stopped before."""
        try:
            summary = read_object(self._results / "summary.json")
        except (OSError, ValueError):
            return False
        return not summary.get("interrupted")

    def read(self, classes: Iterable[type]) -> dict[str, Any]:
        """Return the last state, after :meth:`check`.

        Args:
            classes: the dataclasses that it may hold.

        Raises:
            CheckpointError: it holds something else.
        """
        file, known = self._file(self.number), {cls.__name__: cls for cls in (*classes, Growing)}
        try:
            found: dict[str, Any] = _read(file, known)
            numbers = tuple(found.pop(_MORE))
            if numbers:
                grown = next(each for each in found.values() if isinstance(each, Growing))
                for number in numbers:
                    file = self._more(number)
                    grown.items.extend(_read(file, known))
                self._kept = _Kept(grown.items[-1], len(grown.items), numbers)
        except (KeyError, OSError, TypeError, ValueError, RecursionError, zipfile.BadZipFile) as error:
            raise CheckpointError(f"{file} holds no state of a run ({error!r}); run again without --resume") from error
        return found

    def write(self, state: Mapping[str, Any]) -> None:
        """Write a state; the last but one goes, and with the first of a run those of an earlier run.

        Args:
            state: arrays, dataclasses, dictionaries and numbers by name; one of its values may be :class:`Growing`.
        """
        if self.number == 0:
            self.delete()
            self._folder.mkdir()
            replace_json(self._folder / "head.json", self._head)
        number, kept = self.number + 1, self._kept
        for name, value in state.items():
            if isinstance(value, Growing):
                kept = self._grown(value.items, number)
                state = {**state, name: Growing([])}
        _write(self._file(number), {**state, _MORE: list(kept.numbers)})
        self._kept = kept
        self.number += 1
        folder = os.open(self._folder, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
        self._file(self.number - _STAY).unlink(missing_ok=True)

    def _grown(self, items: list[Any], number: int) -> _Kept:
        """Write what a list has more than the last checkpoint, all of it where it is another list."""
        kept = self._kept
        if len(items) < kept.count or (kept.count and items[kept.count - 1] is not kept.last):
            kept = _Kept()
        if len(items) == kept.count:
            return kept
        _write(self._more(number), items[kept.count :])
        return _Kept(items[-1], len(items), (*kept.numbers, number))

    def delete(self) -> None:
        """Delete all of it."""
        remove(self._folder)


def _write(file: Path, value: Any) -> None:
    """Write a value, as a whole or not at all."""
    parts: dict[str, list[NDArray[Any]]] = {}
    facts = json.dumps(_plain(value, parts, {})).encode()
    arrays: dict[str, Any] = {name: np.concatenate(each) for name, each in parts.items()}
    arrays[_FACTS] = np.frombuffer(facts, dtype=np.uint8)
    beside = file.with_suffix(".part")
    remove(beside)
    try:
        with beside.open("xb") as stream:
            np.savez(stream, **arrays)
            stream.flush()
            os.fsync(stream.fileno())
        beside.replace(file)
    except OSError:
        beside.unlink(missing_ok=True)
        raise


def _read(file: Path, classes: Mapping[str, type]) -> Any:
    """Return the value that a file holds."""
    with np.load(io.BytesIO(read(file)), allow_pickle=False) as stream:
        arrays = dict(stream)
    return _restored(json.loads(arrays.pop(_FACTS).tobytes()), arrays, classes)


def _whole(file: Path) -> bool:
    """Return whether a file is there and undamaged."""
    try:
        with zipfile.ZipFile(io.BytesIO(read(file))) as state:
            return state.testzip() is None and f"{_FACTS}.npy" in state.namelist()
    except (OSError, zipfile.BadZipFile, ValueError):
        return False


def _plain(value: Any, parts: dict[str, list[NDArray[Any]]], sizes: dict[str, int]) -> Any:
    """Return a value ready for JSON, with its arrays put into one a type; arrays, dataclasses, dictionaries, numbers.

    Args:
        value: what is to be kept.
        parts: arrays so far, flat, by their type.
        sizes: number of their values.
    """
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
