"""Rung 2's answer to one scene, in a process of its own, as JSON on standard output.

python3 -m benchmarks.rung SCENE.json TABLES LIMIT
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fingerpad.io.result import Result
from fingerpad.io.states import PREFIXES
from fingerpad.reduced.answer import STATES
from fingerpad.runs.batch import key
from fingerpad.runs.processes import End, limit_processor_time, run
from fingerpad.scene import Scene, from_data
from variational.state import RESULTS

LIMIT = 900.0  # s of processor time; mostly it takes half a minute


def kept(result: Result) -> dict[str, Any]:
    """Return what ladder.json holds of an answer."""
    keys = [f"{PREFIXES[name]}_{key}" for name in STATES for key in RESULTS]
    values = result.values()
    summary = {"full_slip": result.full_slip is not None} | {k: values[k] for k in keys if values[k] is not None}
    cost, more = result.cost, result.record if result.model != "full" else {}
    spent = {"seconds": cost.processor_seconds, "factorisations": cost.factorisations, "unknowns": cost.unknowns}
    return {"summary": summary, "cost": spent, "more": more}


def ask(scene: Scene, folder: Path) -> End:
    """Start the process for a scene, its file in a folder of tables, and wait for it."""
    file = folder / f"{key(scene)}.json"
    file.write_text(json.dumps(scene.parameters()), encoding="utf-8")
    return run("benchmarks.rung", [str(file), str(folder), str(LIMIT)], LIMIT)


def _main(arguments: Sequence[str]) -> None:
    limit_processor_time(float(arguments[2]))
    from fingerpad import startup

    startup.start()
    from fingerpad.reduced import smooth

    scene, folder = from_data(json.loads(Path(arguments[0]).read_text(encoding="utf-8"))), Path(arguments[1])
    print(json.dumps(kept(smooth.solve(scene, folder, startup.MPI.COMM_WORLD))))


if __name__ == "__main__":
    _main(sys.argv[1:])
