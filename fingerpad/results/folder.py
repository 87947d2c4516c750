"""The folder of a run's results: of one scene, and of one run at a time.

The scene is kept in the folder (``scene.json``) and another one is refused there, so that no file of one scene stays
beside a summary of another, and no run is overwritten because ``--out`` was forgotten. The same scene may be run
again: what its earlier run left stays until the new one has reached its first step, and goes then as a whole.
Results are not written beside and put in place at the end, since every accepted step is to be seen at once and has
to outlive the run. A resumed run writes its files anew, from :mod:`fingerpad.runs.checkpoint`.
"""

import contextlib
import errno
import fcntl
import json
from collections.abc import Callable, Mapping
from fnmatch import fnmatch
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar

from fingerpad.results.files import lock_file, read_object, remove, replace_json
from fingerpad.scene.law_code import foreign
from fingerpad.scene.messages import SceneError, ends
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.scene import Scene, from_data

if TYPE_CHECKING:
    from mpi4py import MPI

# All that a run leaves, for the next run of the same scene to delete; what else is in the folder is not touched.
LEFT = (
    *("steps.csv", "summary.json", "summary.json*.part", "run.log", "result.nc", "result.nc*.part"),
    *("fields.npz", "fields.npz*.part", "finger*.png", "surface*.png"),
    *("history.png", "time.png", "field.png", "footprint.png", "solid.png", "report.html", "report.html*.part"),
    *("spikes.csv", "spikes.nc", "raster.png", "animation.webp"),
)
_LOCK = ".lock"
T = TypeVar("T")
_NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP)  # some network file systems


_MODEL = {"model": DEFAULT_MODEL}  # of parameters that name none


class Serial:
    """The one rank of a model without MPI, as far as a folder needs it."""

    rank = 0

    def bcast(self, value: Any) -> Any:
        """Return the value."""
        return value

    def allgather(self, value: T) -> list[T]:
        """Return the value, of the one rank."""
        return [value]


def on_rank_0(comm: "MPI.Comm | Serial", work: Callable[[], T]) -> T:
    """Return on every rank what rank 0 finds; collective.

    Raises:
        OSError: what rank 0 cannot read or write, on every rank: the others would wait for it.
        SceneError: its refusal, on every rank.
    """
    found: T | OSError | SceneError | None = None
    if comm.rank == 0:
        try:
            found = work()
        except (OSError, SceneError) as error:
            found = error
    found = comm.bcast(found)
    if isinstance(found, OSError | SceneError):
        raise found
    return found  # type: ignore[return-value]


class FolderError(SceneError):
    """A folder that results cannot be written to; one sentence."""


class CheckpointError(SceneError):
    """A checkpoint from which a run cannot go on; one sentence."""


class Folder:
    """A folder that is locked for one run.

    Attributes:
        folder: where results go.
    """

    def __init__(
        self, folder: Path, parameters: Mapping[str, Any], comm: "MPI.Comm | Serial", model: str = DEFAULT_MODEL
    ) -> None:
        """Choose a folder for results of a scene; nothing is touched before :meth:`take`, but the folder is made."""
        self.folder, self._comm = folder, comm
        self._parameters = json.loads(json.dumps(parameters))  # as they are read back
        if model != DEFAULT_MODEL:
            self._parameters["model"] = model
        self._lock: BinaryIO | None = None
        self._new = False

    def __enter__(self) -> "Folder":
        """Lock the folder; collective.

        Raises:
            FolderError: another run is at it, it holds another scene's results, or cannot be written to.
        """
        try:
            on_rank_0(self._comm, self._open)
        except (OSError, FolderError) as error:
            self.__exit__()
            if isinstance(error, FolderError):
                raise
            words = f"results cannot be written to {ends(self.folder)}: {error.strerror}; choose another folder"
            raise FolderError(words) from None
        return self

    def __exit__(self, *error: object) -> None:
        """Unlock the folder; one that was made for nothing goes again."""
        if self._lock is None:
            return
        with contextlib.suppress(OSError):
            if self._new and [file.name for file in self.folder.iterdir()] == [_LOCK]:
                remove(self.folder / _LOCK)
                self.folder.rmdir()
        self._lock.close()

    def _open(self) -> None:
        self._new = not self.folder.exists()
        self.folder.mkdir(parents=True, exist_ok=True)
        self._lock = lock_file(self.folder / _LOCK)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FolderError(f"another run is writing to {ends(self.folder)}; choose another folder") from None
        except OSError as error:
            if error.errno not in _NO_LOCKS:
                raise
        if (self.folder / "sweep.json").exists():
            raise FolderError(f"{ends(self.folder)} holds the results of a sweep; choose another folder")
        for file in (*self._left(), *(self.folder / name for name in ("scene.json", "checkpoint"))):
            if file.is_symlink():
                raise FolderError(
                    f"{file.name} in {ends(self.folder)} is a symbolic link, through which no results are written; "
                    "delete it, or choose another folder"
                )
        kept = self._kept()
        if kept is not None and identity(kept) != identity(self._parameters):
            what = difference(identity(kept), identity(self._parameters))
            raise FolderError(
                f"{ends(self.folder)} holds the results of another scene ({what}); "
                "choose another folder, or delete the folder"
            )

    def _kept(self) -> dict[str, Any] | None:
        """Return the parameters of the scene whose results are in the folder; None if there are none."""
        with contextlib.suppress(FileNotFoundError, ValueError):
            return read_object(self.folder / "scene.json")
        for file in (self.folder / "scene.json", *self._left()):
            if file.exists():
                raise FolderError(f"{ends(self.folder)} holds {file.name} of an unknown scene; choose another folder")
        return None

    def _left(self) -> list[Path]:
        """Return what an earlier run has left."""
        return sorted(file for file in self.folder.iterdir() if any(fnmatch(file.name, name) for name in LEFT))

    def take(self) -> None:
        """Make way for the run's files: an earlier run's go; collective."""
        on_rank_0(self._comm, self._clear)

    def _clear(self) -> None:
        for file in self._left():
            remove(file)
        replace_json(self.folder / "scene.json", self._parameters)


def full_scene(folder: Path) -> Scene:
    """Return the scene whose full run is in a folder.

    Raises:
        FolderError: there is none, or it is of another model.
        SceneError: its mesh, or the file of a law of one's own, is gone or was changed.
    """
    foreign(folder)
    try:
        kept = read_object(folder / "scene.json")
    except (OSError, ValueError):
        raise FolderError(f"{ends(folder)} has no scene.json of a run, and so no run to go on with") from None
    if "model" in kept:
        raise FolderError(f"{ends(folder)} has a run of the model {kept['model']!r}; only a full one can go on")
    return from_data(kept)


def identity(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return what results depend on: the scene's parameters without the place of a mesh file, whose hash stays."""
    shape = parameters.get("geometry")
    if not isinstance(shape, dict) or "file" not in shape:
        return dict(parameters)
    return {**parameters, "geometry": {key: value for key, value in shape.items() if key != "file"}}


def difference(old: Mapping[str, Any], new: Mapping[str, Any], table: str = "") -> str:
    """Return the first key in which two scenes differ, with both values; empty if there is none."""
    for key in sorted(old.keys() | new.keys()):
        a, b = (each.get(key, _MODEL.get(key)) for each in (old, new))
        if isinstance(a, dict) and isinstance(b, dict):
            found = difference(a, b, f"{table}{key}.")
            if found:
                return found
        elif a != b:
            plain = all(isinstance(value, int | float | str | None) for value in (a, b))
            return f"its {table}{key} was {ends(a)}, and is {ends(b)} now" if plain else f"its {table}{key} differs"
    return ""
