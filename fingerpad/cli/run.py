"""``fingerpad run``: press, charge and slide a finger, from a scene to tables, pictures and fields."""

from collections.abc import Sequence

from fingerpad.cli import refuse
from fingerpad.cli.arguments import Parser, scene_of
from fingerpad.folder import check_folder

_EXAMPLES = """
    fingerpad run --set f_ext="50 N/m" --set voltage=150 --out results/mine
    mpirun -n 2 fingerpad run scene.toml --out results/scene -fingerpad_snes_monitor
"""


def main(argv: Sequence[str]) -> int:
    """Run a scene; return the exit code."""
    parser = Parser(
        "fingerpad run", "Press, charge and slide a finger: tables, pictures and fields in a folder.", _EXAMPLES
    )
    parser.add_scene()
    parser.add_out("results", "folder of the results (default: results)")
    args, petsc = parser.read_with_petsc(argv)
    scene = scene_of(args)
    check_folder(args.out)
    from fingerpad.entry import MPI, start

    start(petsc)
    # PETSc has its options from here on.
    from fingerpad.balance import broken
    from fingerpad.run import exit_code, run

    summary = run(scene, args.out, MPI.COMM_WORLD)
    defect = broken(summary, scene.friction)
    if defect:
        refuse(defect)
        return 1
    return exit_code(summary)
