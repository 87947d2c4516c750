"""Which ridges touch: what the coarse finger says, beside what full runs found.

environment/run python3 benchmarks/reach.py

From the runs of benchmarks/traces.py and benchmarks/sensitivity.py (which make them; this page takes what is there).
What the coarse finger says of each scene is kept in docs/reach.json; started again, only what is missing is computed.
"""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from benchmarks import arguments, sensitivity, traces
from benchmarks.runs import Run
from fingerpad.io.files import replace, replace_json
from fingerpad.model.touching import MARGIN
from fingerpad.reduced import coarse
from fingerpad.runs.batch import progress
from fingerpad.scene import Scene

_SIZE = 10e-6  # m
_HEADER = f"""# Which ridges touch

Made by `environment/run python3 benchmarks/reach.py`; do not edit. *Meshed*: the last ridge that can touch on a mesh
that a run chooses, {MARGIN} beyond the last one that the coarse finger reaches (`fingerpad/model/touching.py`,
`fingerpad/reduced/coarse.py`). *Touched*: the last one, on either side, that is in contact in any step of the full run.
If it is the last one meshed, the run begins again with more ridges. With its cost: [reach.json](reach.json). """


def scenes() -> dict[str, Scene]:
    """Return all scenes by name."""
    changed = {f"{choice}, {way}": scene for (choice, way), scene in sensitivity.scenes(_SIZE).items() if way}
    return traces.GROUPS["grid"]() | traces.corners() | changed


def touched(run: Run) -> int:
    """Return the last ridge, on either side, in contact in any step of a run."""
    return int(np.abs(run.ridges["ridge"][run.ridges["contact_length"] > 0]).max())


def collect(known: Mapping[str, Any], out: Path, file: Path) -> dict[str, Any]:
    """Return both by scene, for the scenes that were run to their end, writing each as it comes."""
    found = dict(known)
    every = scenes()
    with progress() as bar:
        for name, scene in bar.track(every.items(), total=len(every), description="scenes"):
            try:
                full = touched(Run(scene, out))
            except FileNotFoundError:
                continue
            if "coarse" not in found.get(name, {}):
                found[name] = _said(scene)
            found[name]["touched"] = full
            replace_json(file, found)
    return {name: each for name, each in found.items() if "touched" in each}


def _said(scene: Scene) -> dict[str, Any]:
    try:
        said = coarse.solve(scene, MPI.COMM_WORLD)
    except coarse.NoCoarseSolution as error:  # a run goes by the rule of thumb then
        return {"failure": str(error)}
    return {"coarse": said.last, "factorisations": said.factorisations, "unknowns": said.unknowns}


def page(found: Mapping[str, Any]) -> str:
    """Return the page."""
    lost = [f"No coarse solution: {name} ({each['failure']})." for name, each in found.items() if "failure" in each]
    found = {name: each for name, each in found.items() if "failure" not in each}
    if not found:
        return "\n\n".join([_HEADER.strip(), "None was run.", *lost]) + "\n"
    spare = {name: each["coarse"] + MARGIN - each["touched"] for name, each in found.items()}
    short = [name for name, ridges in spare.items() if ridges <= 0]
    words = f"too few in {', '.join(short)}" if short else "enough in each"
    most = {name: max(each[name] for each in found.values()) for name in ("unknowns", "factorisations")}
    lines = [
        _HEADER,
        f"{len(found)} scenes: the ridges meshed are {words}, by {min(spare.values())} to {max(spare.values())} ridges "
        f"on the side that touches farther. A coarse solve has {most['unknowns']} unknowns and takes at most "
        f"{most['factorisations']} factorisations.",
        *lost,
        "",
        "| scene | meshed | touched |",
        "|---|---|---|",
        *(f"| {name} | {each['coarse'] + MARGIN} | {each['touched']} |" for name, each in found.items()),
    ]
    return "\n".join(lines) + "\n"


def main(given: Sequence[str] | None = None) -> int:
    """Compute what is missing and write the page; fail if ridges are too few anywhere."""
    args = arguments.parser(__doc__).parse_args(given)
    file = args.docs / "reach.json"
    known = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    found = collect(known, args.out, file)
    replace(args.docs / "reach.md", page(found))
    judged = {name: each for name, each in found.items() if "failure" not in each}
    short = [name for name, each in judged.items() if each["coarse"] + MARGIN <= each["touched"]]
    print(f"{len(judged) - len(short)} of {len(found)} scenes have ridges enough; {args.docs / 'reach.md'}")
    return 1 if short else 0


if __name__ == "__main__":
    sys.exit(main())
