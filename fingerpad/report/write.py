"""The report of a folder: what the folder holds, and its page; what cannot be made costs a line, not the results."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from fingerpad.results.files import replace
from fingerpad.results.result import Result
from fingerpad.scene import SceneError
from fingerpad.scene.messages import clip

if TYPE_CHECKING:
    from fingerpad.report.sweep_page import Table

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
    found = read(folder)
    try:
        page = _page(found)
    except (LookupError, ValueError, TypeError, AttributeError) as error:  # of files that somebody else has written
        where, kind = clip(str(folder), 80), type(error).__name__
        raise SceneError(f"no report of {where} can be made of its files ({kind}: {clip(str(error), 400)})") from error
    try:
        replace(folder / NAME, page)
    except OSError as error:
        where = clip(str(folder / NAME), 80)
        raise SceneError(f"the report cannot be written to {where}: {error.strerror}") from None
    return folder / NAME


def of_result(result: Result) -> None:
    """Write the report of a result that is in its folder; serial."""
    assert result.folder is not None
    write(result.folder)


def _page(found: "Result | Table") -> str:
    if isinstance(found, Result):
        from fingerpad.report import run_page  # Matplotlib

        return run_page.page(found)
    from fingerpad.report import sweep_page  # Jinja

    return sweep_page.page(found)


def attempt(folder: Path) -> Path | None:
    """Write the report at the end of a sweep; None and a line on the console where it cannot be made; serial."""
    try:
        return write(folder)
    except Exception as error:  # whatever it is, the results are there
        again = "fingerpad report makes it again"
        print(f"fingerpad: no report of {clip(str(folder), 80)}: {clip(str(error), 400)}; {again}", file=sys.stderr)
        return None


def read(folder: Path) -> "Result | Table":
    """Return what is in a folder.

    Raises:
        SceneError: nothing that a report can be made of, in one sentence.
    """
    name = clip(str(folder), 80)
    if not folder.is_dir():
        raise SceneError(f"{name} is not a folder; give one that fingerpad run or fingerpad sweep wrote")
    if any((folder / kept).exists() for kept in ("result.nc", "summary.json")):
        return Result.load(folder)
    if (folder / "sweep.json").exists():
        from fingerpad.report.sweep_page import table_of

        return table_of(folder)
    done = sum(1 for _ in folder.glob("*/*/summary.json"))  # of points, by model
    if done or any(folder.glob("*/*/asked.json")):
        raise SceneError(f"the sweep in {name} has not ended ({done} runs are there); give its command again to go on")
    if (folder / "scene.json").exists():
        raise SceneError(f"the run in {name} has not ended; make the report when it has, or go on with it by --resume")
    raise SceneError(f"{name} holds no results of fingerpad; give a folder that fingerpad run or fingerpad sweep wrote")
