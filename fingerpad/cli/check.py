"""``fingerpad check``: what a run of a scene contains, omits and costs; solves nothing."""

import importlib.util
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fingerpad.cli.arguments import Parser, echo, scene_of
from fingerpad.io.files import check_folder
from fingerpad.io.left import about, between
from fingerpad.model import expected as cost
from fingerpad.model.memory import MEASURED, Budget, estimate
from fingerpad.model.options import ModelOptions, plan
from fingerpad.model.touching import by_rule
from fingerpad.scene import Load, Scene
from fingerpad.scene.laws import used
from fingerpad.scene.remarks import leakage, remarks
from geometry.sizing import touching_ridges

if TYPE_CHECKING:
    from fingerpad.cli.section import Section

_EXAMPLES = """
    fingerpad check scene.toml --out results/check
    fingerpad check --set mesh.contact=2e-6 --set f_ext="100 N/m"
"""


def main(argv: Sequence[str]) -> int:
    """Describe a run; return the exit code."""
    parser = Parser("check", _EXAMPLES)
    parser.add_scene()
    parser.add_out("results", "folder of the picture mesh.png (default: results)")
    args = parser.read(argv)
    scene = scene_of(args)
    check_folder(args.out)
    needed = plan(scene)
    own = _own_mesh(scene, needed)
    for title, lines in (
        ("Loads, in order", _loads(scene)),
        ("Laws, numbers in SI units", (f"{name.replace('_', ' ')}: {law}" for name, law in used(scene).items())),
        ("Model", _model(scene, needed) if own is None else _model_of_file(scene, own)),
        ("Omitted", (f"{omission.what}: {omission.reason}" for omission in needed.omitted)),
        (f"Cost, within a factor of {cost.FACTOR:g} where it is known", _cost(scene, needed, own)),
    ):
        shown = list(lines) or ["nothing"]
        echo("\n".join([title, *(f"  {line}" for line in shown)]))
    echo(_picture(scene, needed, args.out, own))
    if cost.beyond_loads(scene):
        echo("The scene is valid; whether its loads can be reached is not known.")
    else:
        echo("The scene can be run.")
    return 0


def _own_mesh(scene: Scene, needed: ModelOptions) -> "Section | None":
    """Return the mesh of a scene's file, checked; None where it has none."""
    if scene.laws.mesh is None:
        return None
    from fingerpad.cli import section  # gmsh

    return section.section(scene, needed)


def _loads(scene: Scene) -> Iterator[str]:
    for k, load in enumerate(scene.loads(), start=1):
        yield f"{k}. {load.name}: {', '.join(_aims(load))}"


def _aims(load: Load) -> Iterator[str]:
    if load.f_ext is not None:
        yield f"force to {load.f_ext:g} N/m (per metre of finger)"
    if load.bone_height is not None:
        yield f"bone's height to {load.bone_height * 1e3:+g} mm of the unloaded one"
    if load.voltage is not None:
        yield f"voltage: {load.wave}" if load.level is None else f"voltage to {load.level:g} V"
    until = ", or until full slip" if load.until_full_slip else ""
    if load.bone_x is not None:
        yield f"bone sideways to {load.bone_x * 1e3:g} mm{until}"
    if load.bone_x_by is not None:
        yield f"bone sideways by {load.bone_x_by * 1e3:+g} mm{until}"
    if load.pace:
        yield load.pace


def _model(scene: Scene, needed: ModelOptions) -> Iterator[str]:
    yield from (*remarks(scene), *leakage(scene))
    found, touching = estimate(scene, needed), by_rule(scene)
    ridges = touching_ridges(touching.geometry, touching.mesh)
    if caution := scene.contact.law().caution:
        yield caution
    given = scene.mesh.touching_half_arc is not None
    how = "as mesh.touching_half_arc gives" if given else "by a rule of thumb; a run takes more where they come near"
    size = touching.mesh
    sizes = {"in contact": size.contact, "at the Merkel sites": size.receptor, "elsewhere at most": size.coarsest}
    if not needed.receptors:
        del sizes["at the Merkel sites"]
    yield f"elements of {', '.join(f'{value * 1e6:.4g} µm {where}' for where, value in sizes.items())}"
    yield f"some {about(found.triangles)} triangles of element {scene.numerics.element}"
    yield f"some {about(found.unknowns)} unknowns, within a factor of 1.5"
    yield f"{len(ridges)} of {scene.geometry.ridge_count} ridges can touch, {how}"
    yield f"{_memory(found)}, of the {scene.numerics.memory * 1e-9:.3g} GB allowed"


def _model_of_file(scene: Scene, own: "Section") -> Iterator[str]:
    found = estimate(scene, triangles=len(own.triangles))
    yield f"{len(own.triangles)} triangles of element {scene.numerics.element}, the shortest edge {_um(own.shortest)}"
    yield f"the lowest point is {_um(own.lowest[1])} above the screen"
    yield f"some {about(found.unknowns)} unknowns, within a factor of 1.5"
    yield f"{own.ridges} ridges can touch, as the file has them"
    yield f"{_memory(found)}; a mesh of a file is not refused for it"


def _memory(found: Budget) -> str:
    beyond = found.unknowns > MEASURED
    measured = f" (extrapolated: measured up to {about(MEASURED)} unknowns)" if beyond else ""
    return f"some {found.memory * 1e-9:.2g} GB of memory{measured}"


def _um(length: float) -> str:
    return f"{length * 1e6:.3g} µm"


def _cost(scene: Scene, needed: ModelOptions, own: "Section | None") -> Iterator[str]:
    unknowns = estimate(scene, needed, None if own is None else len(own.triangles)).unknowns
    found = cost.expected(scene, needed, unknowns)
    few, many = (about(found.factorisations * factor) for factor in (1 / cost.FACTOR, cost.FACTOR))
    loads, mesh = cost.beyond_loads(scene), cost.beyond_mesh(unknowns)
    yield f"the work is not known: {loads}" if loads else f"{few} to {many} factorisations"
    if loads or mesh:
        yield f"the time is not known: {mesh or 'the work is not'}"
    else:
        yield f"{_within(found.seconds)} of processor time, on a machine like that of docs/performance.md:"
        yield f"  {_within(found.path)} for the path of the loads"
        if found.errors:
            yield f"  {_within(found.errors)} for the error estimate"
        yield f"  {_within(found.beside)} for set-up, tables and pictures"
    yield f"{cost.COMPILING:.0f} s more the first time, when the forms are compiled"
    if scene.accuracy is not None:
        yield "and that of finer meshes, to the accuracy asked for: perhaps several times as much"


def _within(seconds: float) -> str:
    """Return a time within the factor of the rule, as a range in words."""
    return between(seconds / cost.FACTOR, seconds * cost.FACTOR)


def _picture(scene: Scene, needed: ModelOptions, folder: Path, own: "Section | None") -> str:
    """Draw the mesh; return what was drawn, or why nothing was."""
    missing = [name for name in ("gmsh", "matplotlib") if importlib.util.find_spec(name) is None]
    if missing:
        return f"The mesh is not drawn, since {missing[0]} is not installed."
    from fingerpad.cli import section

    folder.mkdir(parents=True, exist_ok=True)
    section.draw(folder / "mesh.png", own or section.section(scene, needed), by_rule(scene))
    return f"Mesh drawn: {folder / 'mesh.png'}"
