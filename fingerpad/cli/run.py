"""``fingerpad run``: press, charge and slide a finger, from a scene to tables, pictures and fields."""

import signal
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

from fingerpad.cli.arguments import Parser, echo, path, refuse_twice, scene_of
from fingerpad.launcher import raising_at_ctrl_c
from fingerpad.model.cautions import examine
from fingerpad.report.write import NAME
from fingerpad.results.files import check_folder
from fingerpad.results.folder import full_scene
from fingerpad.results.result import Result
from fingerpad.runs.context import RunContext
from fingerpad.runs.post import in_words
from fingerpad.runs.solve import MODELS, find, solved
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.scene.reading import DEFAULT_MODEL, model_of

_OUT = Path("results")

_EXAMPLES = """
    fingerpad run --set f_ext="50 N/m" --set voltage=150 --out results/mine
    fingerpad run --force "0.5 N" --out results/newtons
    mpirun -n 2 fingerpad run scene.toml --out results/scene -fingerpad_snes_monitor
    fingerpad run --resume results/scene
"""


def main(argv: Sequence[str]) -> int:
    """Run a scene; return the exit code."""
    parser = Parser("run", _EXAMPLES)
    parser.add_scene()
    parser.add_out(str(_OUT), "folder of the results", quiet="result")
    parser.add_argument(
        "--model",
        choices=MODELS,
        help="every ridge (full) or a closed form (default: full, or that of the run whose scene.json is given)",
    )
    parser.add_argument("--resume", type=path, metavar="DIR", help="go on with a run that was cut short in this folder")
    parser.add_argument(
        "--force",
        metavar="FORCE",
        help="force on the whole finger (N), as --set force: slices are summed over traces of the model",
    )
    args = parser.read(argv, petsc=True)
    args.model = args.model or model_of(args.scene)
    if args.resume is not None:
        scene, args.out = _cut_short(args), args.resume
    else:
        refuse_twice(args, "force", "--force")
        args.set = [*args.set, *([] if args.force is None else [f"force={args.force}"])]
        scene = scene_of(args, meshed=find(args.model).meshes)
    check_folder(args.out)
    model, shown = find(args.model), not args.quiet
    context = RunContext(args.out, lines=shown, bar=shown, resume=args.resume is not None)
    if not model.meshes:
        if args.petsc:
            raise SceneError(f"{args.petsc[0]} is given and --model is {model.name}, which solves nothing by PETSc")
        echo(in_words(solved(scene, model, context)))
        _say_report(args)
        return 0
    from fingerpad.startup import start

    start(args.petsc)
    # PETSc has its options from here on.
    for caution in examine("load", scene.resolved()) if shown else ():
        echo(f"Caution: {caution}.")
    with raising_at_ctrl_c():
        result = solved(scene, model, context)
    if args.quiet or not model.path or scene.force is not None:  # else the run has printed it
        echo(f"\n{in_words(result)}" if result.finger or scene.force is None else result.failure)
    _say_report(args)
    return _exit_code(result)


def _say_report(args: Namespace) -> None:
    """Print where the report of the run is, if there is one."""
    if not args.quiet and (args.out / NAME).exists():
        echo(f"Report: {args.out / NAME}")


def _cut_short(args: Namespace) -> Scene:
    """Return the scene of the folder that ``--resume`` names.

    Raises:
        SceneError: the folder has no scene, or the command line gives another one.
    """
    given = {"SCENE": args.scene, "--set": args.set, "--force": args.force}
    given |= {"--model": args.model != DEFAULT_MODEL, "--out": args.out != _OUT}
    if name := next((name for name, value in given.items() if value), ""):
        raise SceneError(f"{name} and --resume are given; the folder of --resume has the scene, and takes the results")
    return full_scene(args.resume)


def _exit_code(result: Result) -> int:
    """Return what a program ends with after a run: 0, 1 after a failure, or what the shell calls a signal."""
    if result.interrupted:
        return 128 + signal.Signals[result.interrupted]
    return 1 if result.failure else 0
