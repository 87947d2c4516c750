"""One run in a process of its own, as a sweep of runs on a mesh starts it (:mod:`fingerpad.runs.batch`).

The command is ``python3 -m fingerpad.runs.one SCENE.json FOLDER LIMIT MODEL``.
"""

import json
import os
import sys
from dataclasses import replace
from pathlib import Path

import fingerpad.startup  # noqa: F401
from fingerpad.reduced.models import find
from fingerpad.results.checkpoint import CheckpointError
from fingerpad.results.files import replace_json
from fingerpad.results.folder import FolderError
from fingerpad.runs.context import RunContext
from fingerpad.runs.processes import limit_processor_time
from fingerpad.runs.solve import solved
from fingerpad.scene import SceneError, from_data


def main(scene: Path, folder: Path, model: str) -> None:
    """Run a scene into a folder, from its checkpoint where it has one.

    Args:
        scene: file of its parameters in JSON.
        folder: of the results.
        model: a name of :data:`fingerpad.reduced.models.MODELS`.
    """
    asked, way = from_data(json.loads(scene.read_text(encoding="utf-8"))), find(model)
    context = RunContext(folder, lines=way.path, bar=way.path, report=False)
    try:
        try:
            solved(asked, way, replace(context, resume=way.resumes))
        except CheckpointError:  # nothing to go on from
            solved(asked, way, context)
    except FolderError as error:  # another run is at it, or the disk is full: it may be gone the next time
        print(error, file=sys.stderr)
        sys.exit(os.EX_TEMPFAIL)
    except SceneError as error:  # it would be the same the next time
        replace_json(folder / "summary.json", {"failure": str(error)})


if __name__ == "__main__":
    limit_processor_time(float(sys.argv[3]))
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[4])
