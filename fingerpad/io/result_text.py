"""A result as text: the named states side by side, the whole finger, loads over time and remarks."""

import math

from fingerpad.io.quantities import PER_LENGTH, PLUS_MINUS, QUANTITIES, cell
from fingerpad.io.result import Result
from fingerpad.io.states import LoadResult, called
from fingerpad.scene.reading import DEFAULT_MODEL

_SECTION = "Section at the centre of the finger"


def text(result: Result) -> str:
    """Return the text *Result* at the end of a run: the named states side by side, with units and errors.

    The whole finger follows; it comes first where the scene has a force on it.
    """
    whole, shown = result.whole and result.finger is not None, result.named
    lines = ["Result" if result.finger is None else _SECTION]
    lines[0] += f" (model '{result.model}')" if result.model != DEFAULT_MODEL else ""
    if shown:
        heads = [called(name, state.voltage).split(" normal") for name, state in shown.items()]
        rows = [
            ["", *(head[0] for head in heads)],
            ["", *(("normal" + head[1]) if head[1:] else "" for head in heads)],
        ]
        values = ((quantity.title, result.cells(key)) for key, quantity in result.printed.items())
        rows += [[title, *each] for title, each in values if set(each) - {"–"}]
        if any(state.stable is not None for state in shown.values()):
            verdicts = {True: "yes", False: "no", None: "–"}
            rows.append(["stable", *(verdicts[state.stable] for state in shown.values())])
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        for first, *rest in rows:
            cells = (cell.rjust(width) for cell, width in zip(rest, widths[1:], strict=True))
            lines.append("   ".join(["  " + first.ljust(widths[0]), *cells]).rstrip())
    least = result.record.get("force_error") or 0.0
    lines += [f"  {_in_time(load, least)}" for load in result.loads if load.over_time is not None]
    lines += [f"  {note}" for note in _remarks(result)]
    finger = [f"{result.finger}"] if result.finger is not None else []
    return "\n".join([*finger, *lines] if whole else [*lines, *finger])


def _remarks(result: Result) -> list[str]:
    """Return the lines after the table: failure, missing full slip, meaning of ± and N/m, effect of the penalty."""
    found = [f"Not finished: {result.failure}"] if result.failure else []
    asked = any(load.until_full_slip or load.moves for load in result.scene.loads())
    if asked and result.full_slip is None and not result.failure:
        reached = any(load.full_slip_reached for load in result.loads)
        found.append(f"Full slip was {'not held over a further 0.2 mm' if reached else 'not reached'}.")
    if any(state.error.known() for state in result.named.values()):
        found.append(PLUS_MINUS)
    sizes = {name: state.mesh_contact for name, state in result.named.items() if not math.isnan(state.mesh_contact)}
    if len(set(sizes.values())) > 1:  # with an accuracy
        each = (f"{1e6 * size:.3g} µm ({called(name, result.named[name].voltage)})" for name, size in sizes.items())
        found.append(f"Facets of {', '.join(each)}: differences between these states have the errors of both meshes.")
    share = math.nan if result.full_slip is None else result.full_slip.penalty.contact_length
    if not math.isnan(share):
        found.append(f"Penalty: a rigid screen would change the contact length at full slip by {1e3 * share:+.2g} mm.")
    cautions = [f"! {caution}" for caution in result.cautions]
    return [*found, *([PER_LENGTH] if result.named else []), *result.notes, *cautions]


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
    words = f"{load.name}: {quantity.words.split()[-1]} {cell(key, ends.min)} to {cell(key, ends.max)}{unit}"
    words += "" if math.isnan(mean) else f", mean {cell(key, mean)}{unit}"
    if rubs and passed.periods:
        most, frequency = max(zip(passed.f_t_amplitude, passed.frequency, strict=True))
        words += f"; amplitude of f_T at {frequency:.4g} Hz {cell('f_t', most)} N/m"
    return f"{words}; {load.sticking}" if rubs and load.sticking else words
