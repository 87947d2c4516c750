"""The models of one scene side by side, the cheapest first, with what each of them cost.

    cylinders   ridges as charged cylinders, for a contact length that is known (:mod:`fingerpad.reduced.cylinders`)
    full        the whole cross-section with every ridge (:mod:`fingerpad.runs.full`)

Where each model is good enough: ``docs/models.md``.
"""

import math
from collections.abc import Sequence

from fingerpad.io.quantities import PLUS_MINUS, QUANTITIES, cell
from fingerpad.io.result import Result
from fingerpad.io.states import called
from fingerpad.reduced.answer import STATES
from variational.state import RESULTS


def table(results: Sequence[Result]) -> str:
    """Return results of one scene side by side, ± their estimated discretisation errors, and their notes."""
    rows = [["", *(result.model for result in results)]]
    for name in STATES:
        for key in RESULTS:
            quantity = QUANTITIES[key]
            unit = f" ({quantity.unit})" if quantity.unit else ""
            states = [getattr(result, name) for result in results]
            cells = ["–" if s is None else cell(key, getattr(s, key), getattr(s.error, key, math.nan)) for s in states]
            words = called(name, next((s.voltage for s in states if s is not None), results[0].scene.voltage))
            rows.append([f"{words}: {quantity.words}{unit}", *cells])
    rows.append(["processor time (s)", *(f"{result.cost.processor_seconds:.2f}" for result in results)])
    rows.append(["factorisations", *(str(result.cost.factorisations) for result in results)])
    rows.append(["unknowns", *(str(result.cost.unknowns) for result in results)])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]
    said = [(result.model, (*result.notes, *result.cautions, result.failure)) for result in results]
    shared = [note for note in said[0][1] if note and len(said) > 1 and all(note in each for _, each in said)]
    notes = [f"{model}: {note}" for model, each in said for note in each if note and note not in shared]
    if any(state.error.known() for result in results for state in result.named.values()):
        notes.insert(0, PLUS_MINUS)
    return "\n".join(lines + notes + shared)
