"""A result as text for a console and as HTML for a notebook: headline, whole finger, named states side by side."""

import math
from collections.abc import Sequence

from fingerpad import notebook
from fingerpad.results.data import ResultData
from fingerpad.results.quantities import FRICTION, PER_LENGTH, QUANTITIES, plus_minus_of
from fingerpad.results.states import LoadResult, called
from fingerpad.scene.reading import DEFAULT_MODEL
from variational.state import ContactState

_SECTION = "Middle section of the finger"


def text(result: ResultData, headline: str) -> str:
    """Return the text *Result* at the end of a run: headline, whole finger, and named states with units and errors."""
    lines = [_title(result)]
    if result.named:
        heads, rows = table(result)
        lines += notebook.side_by_side([*notebook.head_rows(heads[1:]), *rows])
    lines += [f"  {note}" for note in (*timed(result), *remarks(result))]
    lines += [f"  ! {caution}" for caution in result.cautions]
    finger = [f"{result.finger}"] if result.finger is not None else []
    return "\n".join([headline, *finger, *lines])


def page(result: ResultData, headline: str) -> str:
    """Return the same for a notebook, with remarks to unfold."""
    title, *known = map(str.strip, headline.splitlines())
    parts = [] if result.finger is None else [result.finger._repr_html_()]
    parts += [notebook.page(_title(result), notebook.table(*table(result)))] if result.named else []
    cautions = notebook.lines(f"! {each}" for each in result.cautions)
    folded = notebook.folded("Remarks", [*timed(result), *remarks(result)])
    return notebook.page(title, notebook.lines(known), *parts, cautions, folded)


def _title(result: ResultData) -> str:
    model = f" (model '{result.model}')" if result.model != DEFAULT_MODEL else ""
    return ("Result" if result.finger is None else _SECTION) + model


def table(result: ResultData) -> tuple[list[str], list[list[str]]]:
    """Return the heads and the rows of the named states side by side, the first of which are words."""
    shown = result.named
    values = ((quantity.title, cells(result, key)) for key, quantity in result.printed.items())
    rows = [[title, *each] for title, each in values if set(each) - {"–"}]
    if any(state.stable is not None for state in shown.values()):
        verdicts = {True: "yes", False: "no", None: "–"}
        rows.append(["stable", *(verdicts[state.stable] for state in shown.values())])
    return ["", *(called(name, state.voltage) for name, state in shown.items())], rows


def cells(result: ResultData, key: str) -> list[str]:
    """Return a printed quantity in each named state, with its error; a dash where it is not shown."""
    of, shown = result.printed[key], []
    for name, state in result.named.items():
        error = getattr(state.error, key, math.nan)
        shown.append("–" if key in FRICTION and name != "full_slip" else of.shown(getattr(state, key), error))
    return shown


def timed(result: ResultData) -> list[str]:
    """Return a line for each load over time."""
    least = result.record.get("force_error") or 0.0
    return [_in_time(load, least) for load in result.loads if load.over_time is not None]


def remarks(result: ResultData) -> list[str]:
    """Return the lines after the table: failure, missing full slip, meaning of ± and N/m, effect of the penalty."""
    found = [f"Not finished: {result.failure}"] if result.failure else []
    if (how := result.missing_slip) and not result.failure:
        found.append(f"Full slip was {how}.")
    if any(state.error.known() for state in result.named.values()):
        found.append(plus_minus_of(result.parts()))
    sizes = {name: state.mesh_contact for name, state in result.named.items() if not math.isnan(state.mesh_contact)}
    if len(set(sizes.values())) > 1:  # with an accuracy
        each = (f"{1e6 * size:.3g} µm ({called(name, result.named[name].voltage)})" for name, size in sizes.items())
        found.append(f"Facets of {', '.join(each)}: differences between these states have the errors of both meshes.")
    share = math.nan if result.full_slip is None else result.full_slip.penalty.contact_length
    if not math.isnan(share):
        found.append(f"Penalty: a rigid screen would change the contact length at full slip by {1e3 * share:+.2g} mm.")
    return [*found, *([PER_LENGTH] if result.named else []), *result.notes]


def _in_time(load: LoadResult, least: float) -> str:
    """Return range and mean of friction in a load over time, and its largest amplitude; of L_R without friction.

    Args:
        load: over time.
        least: friction force (N/m) up to which there is none.
    """
    passed, rubs = load.over_time, load.rubs(least)
    assert passed is not None
    key = "contact_length" if not rubs else "mu_app" if "mu_app" in load.extremes else "f_t"
    quantity, ends, mean = QUANTITIES[key], load.extremes[key], passed.mean[key]
    unit = f" {quantity.unit}" if quantity.unit else ""
    words = f"{load.name}: {quantity.words.split()[-1]} {quantity.shown(ends.min)} to {quantity.shown(ends.max)}{unit}"
    words += "" if math.isnan(mean) else f", mean {quantity.shown(mean)}{unit}"
    if rubs and passed.periods:
        most, frequency = max(zip(passed.f_t_amplitude, passed.frequency, strict=True))
        words += f"; amplitude of f_T at {frequency:.4g} Hz {QUANTITIES['f_t'].shown(most)} N/m"
    return f"{words}; {load.sticking}" if rubs and load.sticking else words


class StatePrinted:
    """A body that a console and a notebook show by its last accepted state."""

    state: ContactState
    states: Sequence[ContactState]

    def _rows(self) -> list[tuple[str, str]]:
        """Return quantities with their units, and their values."""
        found = [(quantity.title, quantity.shown(getattr(self.state, key))) for key, quantity in QUANTITIES.items()]
        return [row for row in found if row[1] != "–"]

    def _title(self) -> str:
        where = f"{self.state.load}, step {len(self.states)}" if self.states else "unloaded"
        return f"{type(self).__name__}, forces per metre of depth: {where}"

    def __repr__(self) -> str:
        """Return the last accepted state."""
        return "\n".join([self._title(), *notebook.side_by_side(self._rows())])

    def _repr_html_(self) -> str:
        """Return the last accepted state for a notebook."""
        return notebook.page(self._title(), notebook.table(("", "last state"), self._rows()))
