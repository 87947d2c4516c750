"""Write the report of a folder and its footprint; what cannot be made costs a line, not the results."""

import sys
from pathlib import Path

from fingerpad.results.files import replace
from fingerpad.results.result import Result
from fingerpad.scene import SceneError
from fingerpad.scene.messages import clip

NAME = "report.html"


def write(folder: Path) -> Path:
    """Write ``report.html`` into a folder of results; serial.

    Args:
        folder: of a run or of a sweep.

    Returns:
        The file.

    Raises:
        SceneError: the folder holds nothing that a report can be made of, or files that are not of a run, or it cannot
            be written to.
    """
    from fingerpad.report import run_page, source, sweep_page

    found = source.read(folder)
    try:
        page = run_page.page(found) if isinstance(found, Result) else sweep_page.page(found)
    except (LookupError, ValueError, TypeError, AttributeError) as error:  # of files that somebody else has written
        where, kind = clip(str(folder), 80), type(error).__name__
        raise SceneError(f"no report of {where} can be made of its files ({kind}: {clip(str(error))})") from error
    try:
        replace(folder / NAME, page)
    except OSError as error:
        where = clip(str(folder / NAME), 80)
        raise SceneError(f"the report cannot be written to {where}: {error.strerror}") from None
    return folder / NAME


def attempt(folder: Path) -> Path | None:
    """Write the report at the end of a run; None and a line on the console where it cannot be made; serial."""
    try:
        return write(folder)
    except Exception as error:  # whatever it is, the results are there
        again = "fingerpad report makes it again"
        print(f"fingerpad: no report of {clip(str(folder), 80)}: {clip(str(error), 160)}; {again}", file=sys.stderr)
        return None


def draw_footprint(result: Result) -> None:
    """Write ``footprint.png`` at the end of a run with a whole finger; a line on the console where it fails; serial."""
    if result.finger is None or result.folder is None:
        return
    from fingerpad.results.finger_picture import footprint  # Matplotlib

    try:
        footprint(result.finger, result.folder / "footprint.png")
    except OSError as error:
        print(f"fingerpad: footprint.png was not written: {error.strerror or error}", file=sys.stderr)
