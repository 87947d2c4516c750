"""The section on speed: processor time of all programs along the same ten states, beside their errors."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.harness import prose, table
from benchmarks.peers.exchange import TIMED, Answer, Ridge, answer_path
from benchmarks.peers.quantities import differences, values

SIZES, FINEST, REPEATS = (10.0, 2.5), 1.25, ("1", "2", "3")
SLOW = ("felupe", "calculix")  # run once
UNSTEADY = 0.15  # relative spread of repeats, above which the page says so
_HEAD = ["program", "set-up (s)", "ten states (s)", "over fingerpad's", "spread", "iterations", "factorisations"]
_ERRORS = ["error of F_n", "F_t", "half-width", "peak pressure"]


def tasks() -> list[tuple[float, str, str]]:
    """Return size (µm), repeat and program of every answer; programs take turns."""
    every = [(size, repeat, program) for repeat in REPEATS for size in SIZES for program in TIMED]
    return [task for task in every if task[1] == "1" or task[2] not in SLOW] + [(FINEST, "1", "ours")]


def numbers(folder: Path) -> dict[str, Any]:
    """Return what the section shows of the answers in a folder, ready for JSON; programs that failed are left out."""
    finest = Answer.read(answer_path(folder, FINEST, "timed", "1", "ours"))
    ridge = Ridge.read(folder / f"{FINEST:g}.npz")
    exact = [values(state, ridge) for state in finest.states]
    meshes, loads = [], list[float]()
    for size in SIZES:
        ridge, rows = Ridge.read(folder / f"{size:g}.npz"), []
        for program in TIMED:
            paths = [answer_path(folder, size, "timed", repeat, program) for repeat in REPEATS]
            if answers := [Answer.read(path) for path in paths if path.exists()]:
                rows.append(_row(answers, ridge, exact))
                loads += [answer.load for answer in answers]
        meshes.append({"size": size, "triangles": len(ridge.triangles), "rows": rows})
    return {"finest": FINEST, "repeats": len(REPEATS), "load": [min(loads), max(loads)], "meshes": meshes}


def _row(answers: Sequence[Answer], ridge: Ridge, exact: Sequence[Sequence[float]]) -> dict[str, Any]:
    """Return the least times of a program's repeats, its work, and its largest errors of all states."""
    one, seconds = answers[0], [answer.seconds for answer in answers]
    pairs = zip(one.states, exact, strict=True)
    errors = [[abs(d or 0.0) for d in differences(values(state, ridge), best)] for state, best in pairs]
    return {
        "program": one.program,
        "setup": min(answer.setup for answer in answers),
        "seconds": min(seconds),
        "spread": max(seconds) / min(seconds) - 1 if len(seconds) > 1 else None,
        "iterations": one.iterations,
        "factorisations": one.factorisations or one.iterations,
        "errors": np.max(errors, axis=0).tolist(),
    }


def section(told: dict[str, Any]) -> str:
    """Return the section of the kept numbers, fingerpad's in the first row of each mesh."""
    text, parts, ratios = prose("peers"), [], list[dict[str, float]]()
    for mesh in told["meshes"]:
        own = mesh["rows"][0]["seconds"]
        ratios.append({row["program"]: row["seconds"] / own for row in mesh["rows"]})
        lines = []
        for row in mesh["rows"]:
            times = [f"{row['setup']:.2f}", f"{row['seconds']:.2f}", f"{ratios[-1][row['program']]:.2f}"]
            spread = None if row["spread"] is None else f"{100 * row['spread']:.0f} %"
            work = [spread, row["iterations"], row["factorisations"]]
            lines.append([row["program"], *times, *work, *(f"{100 * error:.2g} %" for error in row["errors"])])
        head = f"**Facets of {mesh['size']:g} µm ({mesh['triangles']} triangles)**"
        parts.append(f"{head}\n\n{table([*_HEAD, *_ERRORS], lines)}")
    first = all(min(ratio.values()) >= 1 for ratio in ratios)
    others = [min(v for k, v in ratio.items() if k not in ("fingerpad", "plain dolfinx")) for ratio in ratios]
    largest = max(row["spread"] or 0.0 for mesh in told["meshes"] for row in mesh["rows"])
    whole = [[mesh["rows"][k]["setup"] + mesh["rows"][k]["seconds"] for mesh in told["meshes"]] for k in (0, 1)]
    script = [ratio["plain dolfinx"] for ratio in ratios]
    shown = {"script": script, "others": others, "own_whole": whole[0], "script_whole": whole[1]}
    filled = text["finding"].format(
        first="the least" if first else "not the least",
        sizes=" and ".join(f"{mesh['size']:g}" for mesh in told["meshes"]),
        **{name: " and ".join(f"{value:.1f}" for value in some) for name, some in shown.items()},
    )
    how = text["how"].format(repeats=told["repeats"], low=told["load"][0], high=told["load"][1], finest=told["finest"])
    if largest > UNSTEADY:
        how += f" The largest spread is {100 * largest:.0f} %, so that ratios hold to about that."
    rows = told["meshes"][-1]["rows"]
    each = [1e3 * row["seconds"] / row["iterations"] for row in rows[:2]]
    why = text["why"].format(size=told["meshes"][-1]["size"], own=rows[0], script=rows[1], each=each)
    origin = f"Times by {told['made']}; computed by `benchmarks/peers/run timed`."
    return "\n\n".join(["## Speed", filled, how, *parts, why, origin])
