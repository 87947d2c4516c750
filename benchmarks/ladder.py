"""Where each rung of the ladder is good enough: the cheaper ones beside the full runs, over forces and voltages.

environment/run python3 benchmarks/ladder.py [--jobs 2] [--only 1 2]

The full runs are those of ``benchmarks/traces.py``, contact size 10 um; those that are not there are not run. What the
rungs say is kept in docs/ladder.json, from which page and picture are drawn; started again, only what is missing of
rung 2, or was answered by older tables, is computed, and full runs that are gone keep the
numbers they had.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks import arguments
from benchmarks.paper.scenes import grid
from benchmarks.paper.style import VOLTAGE, draw
from benchmarks.rung import ask, kept
from benchmarks.traces import FORCES, VOLTAGES
from fingerpad.io.files import replace, replace_json
from fingerpad.io.result import Result
from fingerpad.io.states import WORDS
from fingerpad.reduced import cylinders, ridge_cell
from fingerpad.runs.batch import progress, result
from fingerpad.runs.processes import End, Pool

SIZE = 10e-6  # m
NAMES = {
    "slip_mu_app": "µ_app at full slip",
    "slip_contact_length": "contact length at full slip",
    "normal_contact_length": f"contact length, {WORDS['charged']}",
    "normal_f_electrostatic": f"attraction, {WORDS['charged']}",
}
RUNGS = {1: "charged cylinders, fitted length", 2: "smooth finger with ridge law"}
_HEADER = """# A ladder of models

Made by `environment/run python3 benchmarks/ladder.py`; do not edit. Numbers unrounded: [ladder.json](ladder.json).

| rung | model | knows | takes |
|---|---|---|---|
| 1 | every ridge the same charged cylinder (`fingerpad/reduced/cylinders.py`, `variational/attraction/cylinder.py`) | forces, friction and contact length, for a finger whose uncharged contact length is known | {one} |
| 2 | smooth layered finger, one ridge's law as its contact (`fingerpad/reduced/smooth.py`, `variational/contact/ridge_law.py`) | the same and the bone's height, for any finger | {two} |
| 3 | every ridge (`fingerpad/runs/full.py`) | all, receptors too | {three} |

Errors are against the full model at a contact size of 10 µm, whose own are in [errors.md](errors.md). What rung 3 takes is wall time of runs that shared the machine; the
tables of rung 2's ridge take some seconds more, once a voltage and friction coefficient.

Rung 1's uncharged lengths come from the full runs at 0 V themselves, so its columns at 0 V say nothing but how they
are rounded; charged, its numbers are predictions. It misses the ridges that jump on the screen with the voltage: two of
thirteen at 25 N/m and 200 V. Rung 2 has seen no full run. It counts ridges by their mean height, which misses
some that barely touch, and lets those at the contact's edge hang on as far as a lifted one does.

Each rung tells an estimated discretisation error (±). Rung 1 has no mesh, and so none of its own. Rung 2 is solved
with the ridge's tables of facets of `mesh.contact` and of half of it; where the ridge is lost before it lets go, or the
error is more than half of the answer, the mesh is refused. Rung 3 solves its states again on other meshes.

    environment/run python3 -m fingerpad compare scene.toml --model cylinders smooth full
"""  # noqa: E501


def name(f_ext: float, voltage: float) -> str:
    """Return what a scene is called in ladder.json."""
    return f"{f_ext:g} N/m, {voltage:g} V"


def collect(known: dict[str, Any], out: Path, rungs: Sequence[str], jobs: int, file: Path) -> dict[str, Any]:
    """Return the answers by scene and rung, computing what is missing and writing each as it comes."""
    scenes = {name(f, u): scene for (f, u), scene in grid(SIZE).items()}
    for key, scene in scenes.items():
        mine = known.setdefault(key, {})
        summary = result(scene, out)
        if summary is not None and summary.get("full_slip"):
            mine["3"] = kept(Result.from_dict(summary))
        if "1" in rungs:
            mine["1"] = kept(cylinders.solve(scene))
    tables = out.parent / "ridge_tables"
    tables.mkdir(parents=True, exist_ok=True)

    def done(key: str, end: End, left: int) -> None:
        known[key]["2"] = {"failure": f"{end.reason}: {end.message}"} if end.reason else json.loads(end.stdout)
        replace_json(file, known)
        words = known[key]["2"].get("failure", "done")
        bar.console.print(f"{key}, rung 2: {words}", highlight=False, markup=False, soft_wrap=True)
        bar.advance(task)

    missing = [key for key in scenes if not _present(known[key])] if "2" in rungs else []
    with progress() as bar:
        task = bar.add_task("answers", total=len(missing))
        Pool[str, End](lambda key: ask(scenes[key], tables), jobs).run(missing, done)
    replace_json(file, known)
    return known


def _present(found: dict[str, Any]) -> bool:
    """Return whether a scene has rung 2's answer by the present tables."""
    return bool(found.get("2", {}).get("more", {}).get("table_version") == ridge_cell.VERSION)


def error(found: dict[str, Any], rung: int, key: str) -> float | None:
    """Return a rung's relative error against the full model, None where either is not known."""
    own, full = (found.get(str(k), {}).get("summary", {}).get(key) for k in (rung, 3))
    return None if own is None or not full else own / full - 1


def _table(known: dict[str, Any], rung: int, key: str) -> str:
    lines = ["| f_ext (N/m) | " + " | ".join(f"{u:g} V" for u in VOLTAGES) + " |", "|---" * (len(VOLTAGES) + 1) + "|"]
    for f in FORCES:
        errors = [error(known.get(name(f, u), {}), rung, key) for u in VOLTAGES]
        cells = ["–" if e is None else f"{1e2 * e:+.1f}" for e in errors]
        lines.append(f"| {f:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _takes(known: dict[str, Any], rung: int) -> str:
    costs = [found[str(rung)]["cost"] for found in known.values() if "cost" in found.get(str(rung), {})]
    if not costs:
        return "not run"
    seconds, factorisations, unknowns = (
        float(np.median([c[k] for c in costs])) for k in ("seconds", "factorisations", "unknowns")
    )
    kind = "wall" if rung == 3 else "processor time"
    words = f"{seconds:.2g} s of {kind}" if seconds < 10 else f"{seconds:.0f} s of {kind}"
    return words if not unknowns else f"{words}, {factorisations:.0f} factorisations, {unknowns:.0f} unknowns"


def page(known: dict[str, Any]) -> str:
    """Return the page."""
    parts = [_HEADER.format(one=_takes(known, 1), two=_takes(known, 2), three=_takes(known, 3))]
    parts.append("![Errors of the rungs over force and voltage](ladder.png)")
    for rung in (1, 2):
        done = [found for found in known.values() if "summary" in found.get(str(rung), {}) and "3" in found]
        if not done:
            continue
        lost = [f"{key} ({found['2']['failure']})" for key, found in known.items() if "failure" in found.get("2", {})]
        parts.append(
            f"## Rung {rung}: {RUNGS[rung]}\n\nErrors in % against the full model, {len(done)} of {len(known)} scenes."
        )
        old = sum(not _present(found) for found in done)
        if rung == 2 and old:
            parts.append(
                f"{old} of them are by older tables, in which a ridge's forces fall over 0.5 µm of height when it lets "
                "go (now 2 µm), and are still to be computed again."
            )
        if rung == 2 and lost:
            parts.append(f"No answer: {'; '.join(lost)}.")
        for key, words in NAMES.items():
            parts += [f"### {words}", _table(known, rung, key)]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def paint(figure: Figure, known: dict[str, Any]) -> None:
    """Draw the errors of friction and contact length over force, a row a rung."""
    keys = ("slip_mu_app", "slip_contact_length", "normal_contact_length")
    axes = figure.subplots(2, len(keys), sharex=True, sharey=True)
    for row, rung in zip(axes, (1, 2), strict=True):
        for ax, key in zip(row, keys, strict=True):
            ax.axhspan(-1, 1, color="0.9", lw=0)
            for u in VOLTAGES:
                errors = [(f, error(known.get(name(f, u), {}), rung, key)) for f in FORCES]
                points = np.array([(f, 1e2 * e) for f, e in errors if e is not None]).reshape(-1, 2)
                colour, marker, dash = VOLTAGE[u]
                ax.plot(*points.T, color=colour, marker=marker, ls=dash, ms=4, label=f"{u:g} V")
            ax.set_xscale("log")
        row[0].set_ylabel(f"rung {rung}: error (%)")
    for ax, key in zip(axes[0], keys, strict=True):
        ax.set_title(NAMES[key])
    for ax in axes[-1]:
        ax.set_xlabel("external force (N/m)")
    axes[0, 0].legend(title="grey: 1 %")


def main(given: Sequence[str] | None = None) -> int:
    """Compare the rungs and write page and picture."""
    parser = arguments.parser(__doc__)
    parser.add_argument("--only", nargs="*", choices=("1", "2"), default=["1", "2"], help="rungs to compute")
    args = parser.parse_args(given)
    file = args.docs / "ladder.json"
    known = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    known = collect(known, args.out, args.only, args.jobs, file)
    replace(args.docs / "ladder.md", page(known))
    draw(args.docs / "ladder.png", (10.0, 5.6), lambda figure: paint(figure, known))
    compared = sum("3" in found for found in known.values())
    print(f"{compared} of {len(known)} scenes have a full run; {args.docs / 'ladder.md'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
