"""Where the time of a run goes: seconds by phase, counts and memory.

python3 benchmarks/trace.py [the options of fingerpad run]
"""

import sys

from fingerpad.cli import refuse
from fingerpad.cli.arguments import Parser, scene_of
from fingerpad.scene.messages import SceneError
from fingerpad.startup import MPI, start

_PHASES = {
    "setup": "meshing, compiling, setting up",
    "assembly": "residuals and Jacobians",
    "factorisation": "factorisations and back-substitutions",
    "coupling": "ridge pressures and closure",
    "stability": "stability of the states reached",
    "output": "tables, fields, pictures",
}
_COUNTS = ("unknowns", "steps", "jumps", "cutbacks", "newton_iterations", "factorisations")


def main(comm: MPI.Comm) -> int:
    """Run a scene and print its trace."""
    parser = Parser("benchmarks/trace.py", "Where the time of a run goes.", "benchmarks/trace.py --set voltage=0")
    parser.add_scene()
    parser.add_out("results/trace", "folder of the results")
    try:
        args, petsc = parser.read_with_petsc(sys.argv[1:])
        scene = scene_of(args)
    except SceneError as error:
        return refuse(str(error))
    start(petsc)
    from fingerpad.runs.full import exit_code, run

    result = run(scene, args.out, comm)
    s = result.to_dict()
    if comm.rank == 0:
        seconds = {phase: s.get(f"seconds_{phase}", 0.0) for phase in _PHASES}
        seconds["other"] = s["wall_seconds"] - sum(seconds.values())
        print(f"\n{'phase':40s} seconds  share")
        for phase, value in seconds.items():
            print(f"{_PHASES.get(phase, phase):40s} {value:7.1f} {100 * value / s['wall_seconds']:5.1f} %")
        print(f"{'all':40s} {s['wall_seconds']:7.1f}")
        for name in _COUNTS:
            print(f"{name.replace('_', ' '):40s} {s[name]:7d}")
        print(f"{'peak memory, all ranks (MB)':40s} {s['memory_mb']:7.0f}")
    return exit_code(result)


if __name__ == "__main__":
    sys.exit(main(MPI.COMM_WORLD))
