"""``fingerpad run``: press, charge and slide a finger, from a scene to tables, pictures and fields."""

from collections.abc import Sequence

from fingerpad.cli import refuse
from fingerpad.cli.arguments import Parser, say, scene_of
from fingerpad.folder import check_folder
from fingerpad.scene import Scene
from fingerpad.sentences import SceneError

_EXAMPLES = """
    fingerpad run --set f_ext="50 N/m" --set voltage=150 --out results/mine
    mpirun -n 2 fingerpad run scene.toml --out results/scene -fingerpad_snes_monitor
"""


def main(argv: Sequence[str]) -> int:
    """Run a scene; return the exit code."""
    scene, folder, petsc = arguments(argv)
    from fingerpad import entry

    entry.start(petsc)
    return _run(scene, folder)
