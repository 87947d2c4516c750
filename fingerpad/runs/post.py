"""What follows from the states of a result: newtons, bands, cautions, pictures, dataset and report, as one list.

A result is written as soon as its states are known. :data:`POST` is applied to it then, once, where the result is made,
and the result is written again. An entry that fails costs itself alone: a line on the console, a note in the result,
and its traceback in ``run.log``. An entry that has no answer raises :class:`SceneError`, whose sentence is the note.

A new entry is a line of :data:`POST`. No entry makes a collective call: one that fails on one rank alone would leave
the others waiting. Ranks agree after each entry whether it failed on any of them.
"""

import traceback
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from pkgutil import resolve_name
from typing import NamedTuple

from fingerpad.results import dataset
from fingerpad.results.data import checked
from fingerpad.results.files import replace as replace_file
from fingerpad.results.files import replace_json
from fingerpad.results.folder import Serial
from fingerpad.results.quantities import Output
from fingerpad.results.result import Result
from fingerpad.results.writing import Writer
from fingerpad.runs.context import BEGUN, RunContext
from fingerpad.scene.materials import adheres
from fingerpad.scene.messages import SceneError, clip
from variational.caution import Caution
from variational.state import ContactState

_LONGEST = 300  # characters of a failure in a note, whose traceback is in run.log
_BEGUN = "The run ended before what follows from its states was computed: no newtons, bands, cautions or pictures."


class Entry(NamedTuple):
    """One thing that follows from the states of a result."""

    name: str
    """In notes, with its article where it has one."""
    compute: str | Callable[[Result], object]
    """Takes the result, and returns it with what is new; what makes a file returns nothing of use. A text is the place
    of a function, ``module:function``, which is imported when it is needed."""
    needs: Callable[[Result, RunContext], bool] = lambda *_: True
    """Whether a result has it, and a run wants it."""
    files: bool = False
    """Whether it makes a file, of a result that is written: after all others, and on rank 0 alone."""


# -- values ------------------------------------------------------------------------------------------------
def with_cautions(result: Result, found: Iterable[Caution]) -> Result:
    """Return a result with further cautions, but for those that it has with other numbers."""
    known = {each.form for each in result.cautions}
    return replace(result, cautions=(*result.cautions, *(each for each in found if each.form not in known)))


def _cautions(result: Result, states: Sequence[ContactState]) -> Result:
    """Return a result of the full model with the notes on its drives, and the cautions on scene, states and loads."""
    from fingerpad.model.cautions import examine, on_scene
    from fingerpad.results.over_time import NOTE

    scene = result.scene
    notes = [*map(str, examine("note", scene)), *([NOTE] if any(load.takes_time for load in scene.loads()) else [])]
    found = [*on_scene(scene, states), *examine("result", result, states)]
    return with_cautions(replace(result, notes=tuple(dict.fromkeys((*result.notes, *notes)))), found)


def cautions_on(states: Sequence[ContactState] = ()) -> Entry:
    """Return the entry of the cautions on a result of the full model.

    Args:
        states: that it was computed from; by default its steps, or its named states.
    """
    return Entry("cautions", lambda each: _cautions(each, states or each.steps or [*each.named.values()]), _follows)


def _sums(result: Result) -> Result:
    """Return a result with notes on the outputs that have no value for the whole finger, though they have a rule."""
    assert result.finger is not None
    return replace(result, notes=(*result.notes, *result.finger.missing(result.outputs)))


def _words(result: Result) -> Result:
    """Return the result itself, once it was put into words and into its summary."""
    result.to_dict()
    str(result)
    return result


# -- files -------------------------------------------------------------------------------------------------
def _picture(kind: str) -> Callable[[Result], None]:
    def draw(result: Result) -> None:
        assert result.folder is not None
        result.plot(kind, result.folder / f"{kind}.png")

    return draw


def _follows(result: Result, _: RunContext) -> bool:
    return result.follows_path


def _page(result: Result, context: RunContext) -> bool:
    return context.report and result.folder is not None


SUMS = Entry("sums of outputs", _sums, lambda result, _: result.finger is not None)
WORDS = Entry("headline", _words)
BANDS = Entry("bands of friction", "fingerpad.reduced.closure_band:with_band", lambda r, c: c.report or r.follows_path)
PEOPLE = Entry("range over people", "fingerpad.reduced.people_band:with_people", BANDS.needs)
NEWTONS = Entry(
    "newtons of the whole finger",
    "fingerpad.slices.estimate:with_newtons",
    lambda r, _: r.follows_path and r.finger is None,
)
PULL_OFF = Entry(
    "the pull-off force",
    "fingerpad.slices.pull_off:with_pull_off",
    lambda r, _: r.follows_path and bool(r.steps) and adheres(r.scene.adhesion),
)
POST: list[Entry] = [
    NEWTONS,
    PULL_OFF,
    SUMS,
    BANDS,
    PEOPLE,
    cautions_on(),
    WORDS,
    Entry(
        "footprint.png",
        _picture("footprint"),
        lambda r, c: _page(r, c) and r.finger is not None and (r.whole or not r.steps),
        files=True,
    ),
    Entry("solid.png", _picture("solid"), lambda r, c: _page(r, c) and r.finger is not None and r.whole, files=True),
    Entry("report", "fingerpad.report.write:of_result", _page, files=True),
]
"""What follows from the states of a result, in order."""


def of_outputs(outputs: Sequence[Output]) -> list[Entry]:
    """Return the entries of outputs of one's own, for results whose states do not have them yet."""
    return [Entry(f"output {each.name}", partial(Result.with_outputs, outputs=[each])) for each in checked(outputs)]


def of_kept(outputs: Sequence[Output]) -> list[Entry]:
    """Return the entries of outputs of one's own, for results that were read from their files, with their sums."""
    again = NEWTONS._replace(needs=lambda r, _: r.follows_path and r.finger is not None and not r.whole)
    return [*of_outputs(outputs), *([again, SUMS] if any(each.sum for each in outputs) else [])]


# -- where a result is made --------------------------------------------------------------------------------
def kept(result: Result, context: RunContext, own: Sequence[Entry] = ()) -> Result:
    """Return a result with what follows from it, written into the folder if there is one; collective.

    Entries of its ``own`` come before those of :data:`POST`.

    Raises:
        FolderError: the folder is in use, holds results of another scene or model, or cannot be written to.
    """
    with context.place(result.scene, result.model) as place:
        writer = Writer(place, context.ranks)
        try:
            return completed(result, context, writer, own)
        finally:
            writer.close()


def completed(result: Result, context: RunContext, writer: Writer, own: Sequence[Entry] = ()) -> Result:
    """Write a result, compute what follows from it, and write it again; collective; see :func:`kept`."""
    writer.take()
    written = result = replace(result, folder=writer.folder)
    begun = replace(result, notes=(*result.notes, _BEGUN), record=result.record | {BEGUN: True})
    _write(begun, writer, headline=False)
    in_words = True
    for entry in sorted((*own, *POST), key=lambda each: each.files):
        if entry.files and result is not written:
            _write(result, writer, in_words)
            written = result
        result, done = _tried(entry, result, context, writer)
        in_words &= done or entry is not WORDS
    if result is not written:
        _write(result, writer, in_words)
    if result.failure:
        writer.log.error(result.failure)
    return result


def _write(result: Result, writer: Writer, headline: bool) -> None:
    """Write ``result.nc``, and what others read as ``summary.json``, on rank 0."""
    if writer.folder is not None and writer.comm.rank == 0:
        replace_file(writer.folder / dataset.FILE, dataset.content(result.to_xarray()))
        replace_json(writer.folder / "summary.json", result.to_dict(headline))


def _tried(entry: Entry, result: Result, context: RunContext, writer: Writer) -> tuple[Result, bool]:
    """Return a result with what an entry computes, or with a note why it has none, and whether it has; collective."""
    found, why, trace = None, "", ""
    try:
        if (writer.comm.rank == 0 or not entry.files) and entry.needs(result, context):
            compute = resolve_name(entry.compute) if isinstance(entry.compute, str) else entry.compute
            found = compute(result)
    except Exception as error:  # whatever it is, the result stays
        words = f"{entry.name}: {type(error).__name__}: {error}"
        why = str(error) if isinstance(error, SceneError) else clip(words, _LONGEST)
        trace = traceback.format_exc()
    why, trace = next((each for each in writer.comm.allgather((why, trace)) if each[0]), ("", ""))
    if not why:
        return found if isinstance(found, Result) else result, True
    writer.lost(why, trace)
    return replace(result, notes=(*result.notes, why)), False


def applied(result: Result, entries: Iterable[Entry]) -> Result:
    """Return a result that is written already, or is not to be, with what further entries compute; on one rank."""
    for entry in entries:
        result, _ = _tried(entry, result, RunContext(), Writer(None, Serial()))
    return result


def in_words(result: Result) -> str:
    """Return the text of a result; its notes alone where it cannot be put into words, which is one of them."""
    try:
        return str(result)
    except Exception:
        return "\n".join(result.notes)
