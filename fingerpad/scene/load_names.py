"""Names of loads, which are also those of files.

A name may have spaces and letters of any alphabet. It must not lead out of the folder of results, nor be one that a
file system cannot hold or that no one can read on a screen, and every load's file must be its own.
"""

import unicodedata
from collections.abc import Sequence

FINAL_STATES = ("charged normal contact", "full slip")
"""States that have files of their own where an accuracy is asked for."""
_MAX_BYTES = 100  # of a name; a file system allows 255, of which the files take some
_FORMULA = ("=", "+", "-", "@")  # of a cell in a spreadsheet, also as wide letters; a tab is forbidden anyway
_FORBIDDEN = '/\\:*?"<>|'  # the first separates folders, the others are forbidden on memory sticks


def load_name(name: str) -> str:
    """Return a name if it can be a load's.

    Raises:
        ValueError: why not, to follow the name.
    """
    if not name.strip():
        raise ValueError("it must have a letter or a digit")
    if len(name.encode("utf-8", "surrogatepass")) > _MAX_BYTES:
        raise ValueError(f"it must be of {_MAX_BYTES} bytes at most, since files are named by it")
    unfit = next((c for c in name if c in _FORBIDDEN or not c.isprintable()), None)
    if unfit is not None:
        raise ValueError(f"it must be without {unfit!r}, since files are named by it")
    if name.startswith((".", "-", " ")):
        raise ValueError(f"it must not begin with {name[0]!r}, since files are named by it")
    if unicodedata.normalize("NFKC", name[0]) in _FORMULA:
        raise ValueError(f"it must not begin with {name[0]!r}, which makes a formula of it when a table is opened")
    return name


def file_name(name: str) -> str:
    """Return the part of a file's name that stands for a load."""
    return name.replace(" ", "_")


def first_clash(names: Sequence[str]) -> tuple[int, int] | None:
    """Return the places of the first two loads whose files would be one, also where letters have no case."""
    seen: dict[str, int] = {}
    for k, name in enumerate(names):
        key = unicodedata.normalize("NFKC", file_name(name)).casefold()
        if key in seen:
            return seen[key], k
        seen[key] = k
    return None
