"""A ladder of models of one scene, the cheapest first: the same keys, side by side, with what each of them cost.

    rung 1   ridges as charged cylinders, for a contact length that is known (:mod:`fingerpad.closed_form`)
    rung 2   a smooth finger with one ridge's law as its contact (:mod:`fingerpad.smooth`); tables in DIR/ridge_tables
    rung 3   the whole cross-section with every ridge (:mod:`fingerpad.run`), left in DIR/full; or its
             full slip alone, from rung 2's (:mod:`fingerpad.start`), nothing left, or else the run as without

Where each rung is good enough: ``docs/ladder.md``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from fingerpad import entry
from fingerpad.rungs import NAMES, STATES, Answer, Cost, Stopwatch
from fingerpad.scene import Scene

_UNITS = {"f_t": "N/m", "f_electrostatic": "N/m", "f_contact": "N/m", "bone_height": "m", "contact_length": "m"}


def full(scene: Scene, folder: Path) -> Answer:
    """Return rung 3's answer, leaving the run in a folder; collective."""
    from fingerpad.run import run

    clock = Stopwatch()
    return from_summary(run(scene, folder, entry.MPI.COMM_WORLD), clock.seconds())


def started(scene: Scene, folder: Path) -> Answer:
    """Return rung 3's full slip from rung 2's, or its answer along the path with a note why; collective."""
    from fingerpad import start
    from variational.continuation import StepFailed

    clock = Stopwatch()
    try:
        return start.answer(scene, folder / "ridge_tables", entry.MPI.COMM_WORLD)
    except StepFailed as error:
        found = full(scene, folder / "full")
        notes = (*found.notes, f"{error}; the path was followed instead")
        return replace(found, cost=replace(found.cost, seconds=clock.seconds()), notes=notes)


def smooth(scene: Scene, folder: Path) -> Answer:
    """Return rung 2's answer, leaving the ridge's tables in a folder; collective."""
    from fingerpad.smooth import solve

    return solve(scene, folder)


def from_summary(summary: Mapping[str, Any], seconds: float | None = None) -> Answer:
    """Return rung 3's answer from a run's summary; without its processor time (s), its wall time stands for it."""
    keys = [f"{state}_{name}" for state in STATES for name in NAMES]
    found = {key: summary[key] for key in ("full_slip", *keys) if summary.get(key) is not None}
    took = summary["wall_seconds"] if seconds is None else seconds
    notes = (summary["failure"],) if "failure" in summary else ()
    errors = {key: summary[f"{key}_error"] for key in found if summary.get(f"{key}_error") is not None}
    return Answer(3, found, Cost(took, summary["factorisations"], summary["unknowns"]), notes, errors=errors)


def table(answers: Sequence[Answer]) -> str:
    """Return the answers side by side, ± their estimated discretisation errors, and their notes."""
    rows = [["", *(f"rung {answer.rung}" for answer in answers)]]
    for state in STATES:
        for name in NAMES:
            unit = f" ({_UNITS[name]})" if name in _UNITS else ""
            rows.append([f"{state} {name}{unit}", *(_cell(a, f"{state}_{name}") for a in answers)])
    rows.append(["processor time (s)", *(f"{a.cost.seconds:.2f}" for a in answers)])
    rows.append(["factorisations", *(str(a.cost.factorisations) for a in answers)])
    rows.append(["unknowns", *(str(a.cost.unknowns) for a in answers)])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]
    notes = [f"rung {answer.rung}: {note}" for answer in answers for note in answer.notes]
    if any(answer.errors for answer in answers):
        notes.insert(0, "±: estimated discretisation error")
    return "\n".join(lines + notes)


def _cell(answer: Answer, key: str) -> str:
    value, error = answer.summary.get(key), answer.errors.get(key)
    if value is None:
        return "–"
    if isinstance(value, int):
        return str(value)
    return f"{value:.5g}" + (f" ± {error:.2g}" if error else "")
