"""``fingerpad compare``: results and cost of several models of one scene side by side, the cheapest first."""

import math
from collections.abc import Sequence
from pathlib import Path

from fingerpad.cli.arguments import Parser, echo, path, positive, quantity, scene_of
from fingerpad.ctrl_c import raises
from fingerpad.reduced import cylinders
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.reduced.model import STATES, Model
from fingerpad.reduced.models import MODELS
from fingerpad.results.files import below, check_folder
from fingerpad.results.quantities import PLUS_MINUS, QUANTITIES, cell
from fingerpad.results.result import Result
from fingerpad.results.states import called
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import solved
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from variational.state import RESULTS

_EXAMPLES = """
    fingerpad compare --set voltage=100
    fingerpad compare scene.toml --model cylinders full --out results/compare
"""


def main(argv: Sequence[str]) -> int:
    """Compare models; return the exit code."""
    parser = Parser("compare", _EXAMPLES)
    parser.add_scene()
    parser.add_out("results", "folder of the full run", quiet="table")
    parser.add_argument(
        "--model",
        nargs="+",
        choices=MODELS,
        default=list(MODELS),
        help="models to compare (default: all; full takes minutes)",
    )
    parser.add_argument("--contact-length", type=quantity, metavar="M", help="cylinders: the length in contact, 1.6 mm")
    parser.add_argument("--ridges", type=positive, metavar="N", help="cylinders: on so many ridges")
    parser.add_argument("--run", type=path, metavar="DIR", help="cylinders: contact lengths of this full run")
    args, petsc = parser.read_with_petsc(argv)
    given = [name for name in ("contact_length", "ridges", "run") if getattr(args, name) is not None]
    if given and Cylinders.name not in args.model:
        raise SceneError(f"--{given[0].replace('_', '-')} is given without the model cylinders, which reads it; add it")
    scene = scene_of(args)
    check_folder(args.out)
    models = MODELS | {Cylinders.name: Cylinders(_footprint(scene, args.contact_length, args.ridges, args.run))}
    from fingerpad.startup import start

    start(petsc)
    import fingerpad.runs.full  # noqa: F401  # before Ctrl-C raises

    def answer_or_refusal(model: Model) -> Result:
        try:
            folder = below(args.out, model.name) if model.path else None
            return solved(scene, model, RunContext(folder, lines=not args.quiet, bar=not args.quiet))
        except SceneError as error:
            return Result(scene, model.name, None, None, None, failure=str(error))

    with raises():
        results = [answer_or_refusal(model) for name, model in models.items() if name in args.model]
    echo(table(results))
    return max(1 if result.failure else 0 for result in results)


def _footprint(scene: Scene, length: float | None, ridges: int | None, run: Path | None) -> cylinders.Footprint | None:
    if run is not None:
        if length is not None or ridges is not None:
            raise SceneError("--run is given and a contact length too; give one of the two")
        return cylinders.from_run(scene, run)
    if (length is None) != (ridges is None):
        raise SceneError("one of --contact-length and --ridges is given without the other; give both or none")
    if length is None or ridges is None:
        return None
    finger = scene.geometry
    if ridges > finger.ridge_count:
        raise SceneError(f"--ridges is {ridges}, and the finger has {finger.ridge_count}; count those that touch")
    if length > ridges * finger.ridge_wavelength:
        whole = 1e3 * ridges * finger.ridge_wavelength
        raise SceneError(f"--contact-length is {1e3 * length:g} mm, longer than {ridges} ridges, {whole:.3g} mm")
    return cylinders.given(length, ridges)


def table(results: Sequence[Result]) -> str:
    """Return results of one scene side by side, ± their estimated discretisation errors, and their notes."""
    rows = [["", *(result.model for result in results)]]
    for name in STATES:
        for key in RESULTS:
            quantity = QUANTITIES[key]
            unit = f" ({quantity.unit})" if quantity.unit else ""
            states = [getattr(result, name) for result in results]
            cells = ["–" if s is None else cell(key, getattr(s, key), getattr(s.error, key, math.nan)) for s in states]
            words = called(name, next((s.voltage for s in states if s is not None), results[0].scene.voltage))
            rows.append([f"{words}: {quantity.words}{unit}", *cells])
    rows.append(["processor time (s)", *(f"{result.cost.processor_seconds:.2f}" for result in results)])
    rows.append(["factorisations", *(str(result.cost.factorisations) for result in results)])
    rows.append(["unknowns", *(str(result.cost.unknowns) for result in results)])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]
    said = [(result.model, (*result.notes, *result.cautions, result.failure)) for result in results]
    shared = [note for note in said[0][1] if note and len(said) > 1 and all(note in each for _, each in said)]
    notes = [f"{model}: {note}" for model, each in said for note in each if note and note not in shared]
    if any(state.error.known() for result in results for state in result.named.values()):
        notes.insert(0, PLUS_MINUS)
    return "\n".join(lines + notes + shared)
