"""The report of a folder: what the folder holds, and its page; what cannot be made costs a line, not the results."""

import csv
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from fingerpad.reduced.registry import MODELS
from fingerpad.results.files import read_object, replace
from fingerpad.results.result import Result, steps_of
from fingerpad.results.states import load_results, named
from fingerpad.scene import SceneError, as_kept
from fingerpad.scene.messages import clip
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.remarks import coefficient

if TYPE_CHECKING:
    from fingerpad.report.sweep_page import Table

NAME = "report.html"
_NO_STEP = "has no accepted step yet; make the report when it has one"


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
    found, name = read(folder), clip(str(folder), 80)
    try:
        page = _page(found)
    except (LookupError, ValueError, TypeError, AttributeError) as error:  # of files that somebody else has written
        why = f"{type(error).__name__}: {clip(str(error), 400)}"
        raise SceneError(f"no report of {name} can be made of its files ({why})") from error
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
    from fingerpad.report import run_page, sweep_page  # Matplotlib and Jinja

    return run_page.page(found) if isinstance(found, Result) else sweep_page.page(found)


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
    if (folder / "summary.json").exists():
        return Result.load(folder)
    if (folder / "table.csv").exists():
        from fingerpad.report.sweep_page import table_of

        return table_of(folder)
    if (folder / "steps.csv").exists():
        return _unfinished(folder)
    points = [folder / name for name, model in MODELS.items() if model.meshes and (folder / name).is_dir()]
    done = sum(1 for place in points for _ in place.glob("*/summary.json"))
    if done or any(any(place.glob("*/asked.json")) for place in points):
        raise SceneError(f"the sweep in {name} has not ended ({done} runs are there); give its command again to go on")
    if (folder / "scene.json").exists():
        raise SceneError(f"the run in {name} {_NO_STEP}")
    raise SceneError(f"{name} holds no results of fingerpad; give a folder that fingerpad run or fingerpad sweep wrote")


def _unfinished(folder: Path) -> Result:
    """Return the steps that a run has written so far."""
    name = clip(str(folder), 80)
    try:
        scene, steps = as_kept(read_object(folder / "scene.json")), steps_of(folder)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, csv.Error) as error:
        raise SceneError(f"the unfinished run in {name} cannot be read: {error}") from None
    if not steps:
        raise SceneError(f"the run in {name} {_NO_STEP}")
    found = named(steps, [load.name for load in scene.loads()])
    return Result(
        scene, DEFAULT_MODEL, *(found.get(state) for state in ("uncharged", "charged", "full_slip")), steps=steps,
        loads=tuple(load_results(steps, scene.loads(), lambda k, end: None, coefficient(scene))), folder=folder,
        failure=f"the run has not ended, or was killed, after step {steps[-1].step}: these are its steps so far",
    )  # fmt: skip
