"""The folder that results are to go to, checked before anything is computed."""

import os
from pathlib import Path

from fingerpad.scene.messages import SceneError, clip

_FILES = 160  # bytes that the longest name of a file in the folder takes of a path
_PATH = 80  # characters of a path in a sentence


def check_folder(folder: Path, option: str = "--out") -> None:
    """Refuse a folder that cannot be made or written to; nothing is made.

    Args:
        folder: to be made or written to.
        option: what it was given by.

    Raises:
        SceneError: why not.
    """
    name, text = f"{option} {clip(str(folder), _PATH)}", str(folder)
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        raise SceneError(f"{name} is not UTF-8; give a folder whose name is") from None
    if "\0" in text:
        raise SceneError(f"{name} has a zero byte in it; give a folder whose name has none")
    try:
        absolute = Path(os.path.abspath(folder))
        there = next(place for place in (absolute, *absolute.parents) if os.path.lexists(place))
        longest, whole = (
            os.pathconf(there if there.is_dir() else "/", kind) for kind in ("PC_NAME_MAX", "PC_PATH_MAX")
        )
    except OSError as error:
        raise SceneError(f"{name} cannot be a folder: {error.strerror}") from None
    if max(len(os.fsencode(part)) for part in absolute.parts) > longest:
        raise SceneError(f"{name} is too long; a name can have {longest} bytes")
    if len(os.fsencode(absolute)) + _FILES > whole:
        raise SceneError(f"{name} is too long; a path can have {whole} bytes, of which files take {_FILES}")
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
