"""Files that are there as a whole or not at all, tables of whole rows, and folders that results can go to.

No symbolic link is written through: a file takes the place of one of its name, and what the link leads to stays.
"""

import contextlib
import csv
import errno
import io
import json
import math
import os
import shutil
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO
from uuid import uuid4

from fingerpad.scene.messages import SceneError, clip
from variational.files import read

FORMAT = 4
"""Number of the format of ``summary.json`` and ``sweep.json``; one more where older files are read otherwise."""
_MAX_BYTES = 200_000_000  # of a file that is read; a summary of a thousand loads has two millions
_PATH = 80  # characters of a path in a sentence
_MAX_NAME, _MAX_PATH, _FILES = 255, 4096, 160  # bytes of a name and a path in Linux, and of it for a file of results
_MAX_DEPTH = 50  # of what it holds, which has some ten


def replace(file: Path, text: str | bytes) -> None:
    """Write a file of text or bytes; what was there stays until all of it is written.

    Raises:
        OSError: it could not be written; with its name.
    """
    part = file.with_name(f"{file.name}.{uuid4().hex[:8]}.part")  # another process may write the same file
    try:
        part.write_bytes(text.encode("utf-8") if isinstance(text, str) else text)
        part.replace(file)
    except BaseException as error:  # Ctrl-C is one
        with contextlib.suppress(OSError):  # where the folder takes no file
            part.unlink()
        if not isinstance(error, OSError):
            raise
        raise OSError(error.errno, error.strerror, str(file)) from error  # the system names no file of a full disk


def replace_json(file: Path, data: Any) -> None:
    """Write data as JSON, as :func:`replace` does; numbers that are not finite, which JSON does not have, are null."""
    replace(file, json.dumps(_finite(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def read_object(file: Path) -> dict[str, Any]:
    """Return the object that a JSON file of a folder of results holds, whoever wrote it.

    Raises:
        OSError: it cannot be read, is no ordinary file or too large.
        ValueError: it holds something else than an object of some depth.
    """
    try:
        found = json.loads(read(file, _MAX_BYTES).decode())
    except RecursionError:
        found = None
    if not isinstance(found, dict) or not _is_shallow(found, _MAX_DEPTH):
        raise ValueError(f"{file.name} holds no object, or one that is nested too deep")
    return found


def has_other_format(kept: Mapping[str, Any]) -> bool:
    """Return whether a summary has another format, or none."""
    return "parameters" in kept and kept.get("format") != FORMAT


def refuse_other_format(kept: Mapping[str, Any], name: str) -> None:
    """Raise :class:`SceneError` where a summary, that of the folder of this name, has another format, or none."""
    if has_other_format(kept):
        raise SceneError(
            f"{name} has the format {clip(str(kept.get('format')), 16)} of another version; this fingerpad reads "
            f"format {FORMAT}; run it again"
        )


def _is_shallow(data: Any, depth: int) -> bool:
    inner = data.values() if isinstance(data, dict) else data if isinstance(data, list) else ()
    return depth > 0 and all(_is_shallow(each, depth - 1) for each in inner)


def lock_file(file: Path) -> BinaryIO:
    """Open a file for a lock; it is made if need be, and its content stays.

    Raises:
        OSError: it cannot be opened, or is no ordinary file, such as a symbolic link.
    """
    flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    try:
        opened = os.fdopen(os.open(file, flags, 0o666), "r+b", buffering=0)
    except OSError as error:
        if error.errno != errno.ELOOP:
            raise
    else:
        if stat.S_ISREG(os.fstat(opened.fileno()).st_mode):
            return opened
        opened.close()
    raise OSError(errno.EINVAL, f"{file.name} in it is no ordinary file", str(file))


def remove(file: Path) -> None:
    """Delete a file, a folder or a symbolic link, but not what a link leads to; nothing where there is none."""
    if file.is_dir() and not file.is_symlink():
        shutil.rmtree(file)
    else:
        file.unlink(missing_ok=True)


def _finite(data: Any) -> Any:
    if isinstance(data, Mapping):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data


class Table:
    """Writes a CSV file row by row: each is on disk, whole, when :meth:`write` returns."""

    def __init__(self, file: Path, row: Mapping[str, Any]) -> None:
        """Start the file with a header, the names of a row; an earlier file goes."""
        remove(file)
        self._file, self._columns = file.open("x+b", buffering=0), list(row)
        self.write(dict(zip(self._columns, self._columns, strict=True)))

    def write(self, row: Mapping[str, Any]) -> None:
        """Append a row; where there is no room for all of it, none of it stays."""
        text = io.StringIO()
        csv.DictWriter(text, self._columns).writerow(row)
        data, start = text.getvalue().encode(), self._file.tell()
        try:
            while data:
                data = data[self._file.write(data) :]
        except OSError:
            self._file.truncate(start)
            raise

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def check_folder(folder: Path, option: str = "--out") -> None:
    """Raise :class:`SceneError` where a folder of an option cannot be made or written to; nothing is made."""
    name, absolute = f"{option} {clip(str(folder), _PATH)}", Path(os.path.abspath(folder))
    try:
        str(folder).encode("utf-8")
    except UnicodeEncodeError:
        raise SceneError(f"{name} is not UTF-8; give a folder whose name is") from None
    longest, length = max(len(os.fsencode(part)) for part in absolute.parts), len(os.fsencode(absolute)) + _FILES
    if "\0" in str(folder) or longest > _MAX_NAME or length > _MAX_PATH:
        raise SceneError(
            f"{name} has a zero byte or is too long; a name can have {_MAX_NAME} bytes, and a path {_MAX_PATH} with "
            f"{_FILES} for files"
        )
    there = next(place for place in (absolute, *absolute.parents) if os.path.lexists(place))
    if not there.is_dir():
        which = "it" if there == absolute else clip(str(there), _PATH)
        raise SceneError(f"{name} cannot be a folder, since {which} is a file; give another one")
    if not os.access(there, os.W_OK | os.X_OK):
        raise SceneError(f"{name} cannot be written to: {clip(str(there), _PATH)} is read-only; give another one")


def below(folder: Path, name: str) -> Path:
    """Return a folder of the program inside a folder of results.

    Raises:
        SceneError: it is a symbolic link, by which files would be written and deleted elsewhere.
    """
    found = folder / name
    if found.is_symlink():
        raise SceneError(
            f"{name} in {clip(str(folder), _PATH)} is a symbolic link, and results are to be in the folder itself; "
            "delete it, or choose another folder"
        )
    return found
