"""Files of a user: ordinary ones of a bounded size, and copies of them with nothing beside."""

import codecs
import contextlib
import errno
import os
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

MOST_OF_TEXT = 1e6
"""Largest size (bytes) of a scene or of a program of a user; the longest scene that comes along has 1000."""


def read(path: str | Path, most: float = 500e6) -> bytes:
    """Return the content of an ordinary file, without ever waiting for a pipe or for a device that has no end.

    Args:
        path: of the file.
        most: largest allowed size in bytes; by default that of a mesh or of a height map.

    Raises:
        OSError: the file cannot be opened, is no ordinary file or too large; its ``strerror`` says which.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except ValueError as error:  # of a path with a zero byte
        raise OSError(errno.EINVAL, str(error), str(path)) from None
    try:
        status = os.fstat(descriptor)
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(errno.EISDIR, "Is a directory", str(path))
        if not stat.S_ISREG(status.st_mode):
            raise OSError(errno.EINVAL, "it is not an ordinary file", str(path))
        with open(descriptor, "rb", closefd=False) as file:
            content = b"" if status.st_size > most else file.read(int(most) + 1)
        size = max(status.st_size, len(content))
    finally:
        os.close(descriptor)
    if size > most:
        raise OSError(errno.EFBIG, f"it has {size / 1e6:.9g} MB, and at most {most / 1e6:g} MB are read", str(path))
    return content


def text(content: bytes) -> str | None:
    """Return the text in a file of a program or an instrument, None of binary content."""
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16", errors="replace")
    if b"\0" in content:
        return None
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")  # µ of an instrument


def is_number(word: str) -> bool:
    """Return whether a word of a text is a number, nan and infinity among them."""
    try:
        float(word)
    except ValueError:
        return False
    return True


@contextlib.contextmanager
def alone(content: bytes, name: str) -> Iterator[Path]:
    """Give a copy of a file for a library that reads by path, and work in its folder.

    The folder is the user's alone and holds nothing else. A script beside the file, which gmsh would run, and a
    relative path inside the file, which HDF5 would follow, thus lead nowhere.

    Args:
        content: of the file.
        name: of the copy.
    """
    with tempfile.TemporaryDirectory(prefix="fingerpad-") as folder, contextlib.chdir(folder):
        path = Path(folder) / name
        path.write_bytes(content)
        yield path
