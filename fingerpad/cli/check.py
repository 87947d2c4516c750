"""``fingerpad check``: what a run of a scene contains, omits and costs; solves nothing."""

import importlib.util
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from fingerpad.cli import output
from fingerpad.cli.arguments import Kind, Parser, echo, scene_of
from fingerpad.model.cautions import examine
from fingerpad.model.options import COARSER, FingerModel, ModelOptions, by_rule, memory, plan, refuse_mesh, unknowns
from fingerpad.model.section import Section, section, write
from fingerpad.reduced import cylinders
from fingerpad.reduced.closure_band import with_band
from fingerpad.reduced.cylinder_errors import REGIONS, where, within
from fingerpad.results.files import check_folder
from fingerpad.results.headline import why_not_known
from fingerpad.results.quantities import BAND
from fingerpad.results.terminal import about
from fingerpad.scene import Load, Scene, SceneError
from fingerpad.scene.controls import ends_of
from fingerpad.scene.loads import ways
from fingerpad.scene.messages import counted
from fingerpad.scene.remarks import finger_in_words, used
from fingerpad.scene.viscosity import elastic, viscous_layers
from geometry import tags
from geometry.profiles import GeometryError

_EXAMPLES = """
    fingerpad check scene.toml --out results/check
    fingerpad check --set mesh.contact=2e-6 --set f_ext="100 N/m"
    fingerpad check scene.toml --mesh finger.msh
"""
_FINEST_EDGES = 60_000  # triangles of the whole finger up to which their edges are drawn
_MESH = Kind("a mesh", (".msh",), "$MeshFormat\n2.2 ")
SLIDE_STIFFNESS = 7.0e3
"""Friction over the way until full slip and the root of the number of ridges (N/m²): within 10 % of the ways of four
runs of the default finger, 0.5 to 1.33 mm. *Assumption*: of the default shape and skin."""


def main(argv: Sequence[str]) -> int:
    """Describe a run; return the exit code."""
    parser = Parser("check", _EXAMPLES)
    parser.add_scene()
    parser.add_out("results", "folder of the picture mesh.png")
    parser.add_file("--mesh", _MESH, "file for gmsh of the whole unloaded finger, in m, its parts named")
    args = parser.read(argv)
    scene = scene_of(args)
    check_folder(args.out)
    if args.mesh and scene.geometry.file is not None:
        raise SceneError("geometry.file is given, which is a mesh already; leave --mesh out")
    needed = plan(scene)
    mesh = _mesh(scene, needed)
    for title, lines in (
        ("Loads, in order", _loads(scene)),
        ("Laws, numbers in SI units", (f"{name.replace('_', ' ')}: {law}" for name, law in used(scene).items())),
        ("Model", _model(scene, needed)),
        ("Mesh", _size(scene, mesh)),
        ("Omitted", (f"{omission.what}: {omission.reason}" for omission in needed.omitted)),
    ):
        echo("\n".join([title, *(f"  {line}" for line in list(lines) or ["nothing"])]))
    echo(_picture(scene, args.out, mesh))
    if args.mesh:
        echo(f"Mesh written: {args.mesh}, {len(write(scene, args.mesh).triangles)} triangles of the whole finger")
    echo(_verdict(scene))
    return 0


def _mesh(scene: Scene, needed: ModelOptions) -> Section | None:
    """Return the mesh that a run would have, or that of the scene's file; None where there is no gmsh.

    Raises:
        SceneError: it cannot be made, or a run on it needs more memory than is allowed.
    """
    if scene.geometry.file is None and importlib.util.find_spec("gmsh") is None:
        return None
    found = section(scene, needed)
    if scene.geometry.file is None:
        try:
            refuse_mesh(len(found.points), len(found.triangles), FingerModel(by_rule(scene), needed))
        except GeometryError as error:
            raise SceneError(str(error)) from None
    return found


def _along(scene: Scene) -> Iterator[tuple[Load, float | None, float, float]]:
    """Yield each load, how far it moves the bone (m) where that is known, and its force (N/m) and peak voltage (V)."""
    force = voltage = 0.0
    for _, load, moved in ways(scene.loads()):
        force = force if load.f_ext is None else ends_of(load.f_ext)[1]
        voltage = load.drive.peak if load.drive is not None else voltage if load.level is None else load.level
        yield load, moved, force, voltage


def _verdict(scene: Scene) -> str:
    """Return whether the scene can be run, that it may not slip fully, and what is not known of loads never tried."""
    tried = REGIONS[0]
    for load, _, force, voltage in _along(scene):
        if not (within(force, tried.ranges["f_ext"]) and within(voltage, tried.ranges["voltage"])):
            held = "a prescribed height of the bone" if load.bone_height is not None else f"{force:g} N/m"
            return (
                f"The scene is valid; whether its loads can be reached is not known: {load.name} has {held} and "
                f"{voltage:g} V, and tried were {where(tried)}."
            )
    if any(too_short(scene)):
        return "The scene can be run, and may end without full slip: see above, under Model."
    return "The scene can be run."


def _loads(scene: Scene) -> Iterator[str]:
    for k, (_, load, moved) in enumerate(ways(scene.loads()), start=1):
        aims = [*load.aims()]
        if load.wave is not None and load.takes_time:
            seconds = load.seconds(moved or 0.0)
            aims.append(f"{load.wave.count(seconds, scene.numerics.step_scale):.0f} samples over {seconds:.4g} s")
        yield f"{k}. {load.name}: {', '.join(aims)}"


def _model(scene: Scene, needed: ModelOptions) -> Iterator[str]:
    yield from (*finger_in_words(scene), *map(str, examine("scene", scene) + examine("note", scene)))
    yield from (*too_short(scene), *_adhering(scene), *map(str, examine("load", scene) + examine("law", scene)))
    if scene.geometry.file is None:
        sizes = {"in contact": scene.mesh.contact}
        sizes |= {"at the Merkel sites": scene.mesh.receptor} if needed.receptors else {}
        sizes |= {"elsewhere at most": scene.mesh.coarsest}
        yield f"elements of {', '.join(f'{value * 1e6:.4g} µm {where}' for where, value in sizes.items())}"
    if scene.accuracy is not None:
        yield "finer meshes follow, to the accuracy asked for"
    elif needed.errors and needed.past:
        yield f"the path on these, and once more on elements {COARSER:g} times as large, for the discretisation errors"
    elif needed.errors:
        yield (
            f"named states on these, with {scene.mesh.edge * 1e6:.3g} µm where their contact ends; the path on "
            f"elements {COARSER:g} times as large"
        )


def too_short(scene: Scene) -> Iterator[str]:
    """Yield a sentence for each slide until full slip, or under a waveform, that may end before full slip.

    Friction and number of ridges are those of the closed form, with viscous layers at their lasting stiffness. There
    is none where the way of the bone is not known.
    """
    place = farthest = 0.0
    for load, moved, force, voltage in _along(scene):
        if moved is None or load.bone_height is not None:
            return
        place += moved
        farthest = max(farthest, abs(place))
        if moved and force and (load.until_full_slip or load.wave is not None):
            layers = {name: elastic(law) for name, law in scene.materials}
            lasting = scene.model_copy(update={"materials": scene.materials.model_copy(update=layers)})
            try:
                slip = cylinders.solve(lasting.replace(history=None, f_ext=force, voltage=voltage)).full_slip
            except SceneError:
                return
            needed = 0.0 if slip is None else slip.f_t / (SLIDE_STIFFNESS * slip.ridges_in_contact**0.5)
            if needed > farthest:
                less = ", less of viscous skin" if viscous_layers(scene.materials) else ""
                yield (
                    f"{load.name}: the finger may never slip fully, since that needs some {1e3 * needed:.2g} mm from "
                    f"where it was unloaded, by a rule of thumb{less}, and the bone goes {1e3 * farthest:.2g} mm"
                )
        if load.until_full_slip:
            return


def _adhering(scene: Scene) -> Iterator[str]:
    """Yield that ridges adhere by the scene's closure, where the closed form has no friction for it."""
    try:
        band = with_band(cylinders.solve(scene)).record.get(BAND, {})
    except SceneError:
        return
    if why := why_not_known(band):
        yield (
            f"a run may follow many jumps and not reach full slip: {why}; take a smaller voltage or another roughness"
        )


def _size(scene: Scene, mesh: Section | None) -> Iterator[str]:
    if mesh is None:
        yield "not made, since gmsh is not installed"
        return
    own, of = scene.geometry.file is not None, scene.geometry.ridge_count
    number = unknowns(len(mesh.points), len(mesh.triangles), scene.numerics.element)
    yield f"{len(mesh.triangles)} triangles of element {scene.numerics.element}, {number} unknowns"
    if own:
        shortest, lowest = mesh.shortest * 1e6, mesh.lowest[1] * 1e6
        yield f"the shortest edge is {shortest:.3g} µm, the lowest point {lowest:.3g} µm above the screen"
        how = "as the file has them"
    elif scene.mesh.touching_half_arc is not None:
        how = "as mesh.touching_half_arc gives"
    else:
        how = "by a rule of thumb; a run takes more where they come near"
    ridges = counted(mesh.ridges, "ridge") if own else f"{mesh.ridges} of {counted(of, 'ridge')}"
    yield f"{ridges} can touch, {how}"
    most = f"of the {scene.numerics.memory * 1e-9:.3g} GB allowed"
    allowed = "for which a mesh of a file is not refused" if own else most
    yield f"about {about(memory(number) * 1e-9)} GB of memory, {allowed}"
    yield "time: a run prints what is left of its path; measured times are in docs/performance.md"


def _picture(scene: Scene, folder: Path, mesh: Section | None) -> str:
    """Draw the mesh; return what was drawn, or why nothing was."""
    if mesh is None or importlib.util.find_spec("matplotlib") is None:
        return f"The mesh is not drawn, since {'gmsh' if mesh is None else 'matplotlib'} is not installed."
    folder.mkdir(parents=True, exist_ok=True)
    _draw(folder / "mesh.png", mesh, by_rule(scene))
    return f"Mesh drawn: {folder / 'mesh.png'}"


def _draw(file: Path, found: Section, scene: Scene) -> None:
    """Draw the mesh: the whole finger, some ridges, and one ridge's tip; layers in colour, axes in mm."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch
    from matplotlib.tri import Triangulation

    from fingerpad.results.pictures.finger import LAYER_COLOURS

    shape, size, x = scene.geometry, scene.mesh.contact, 0.0
    period, deep = shape.ridge_wavelength, shape.sc_thickness + shape.ve_thickness
    views: tuple[tuple[str, tuple[float, float] | None], ...] = (
        ("whole finger", None),
        (f"ridge 0, of {period * 1e3:.3g} mm", (1.5 * deep, 2 * deep)),
        (f"tip of ridge 0: facets of {size * 1e6:.3g} µm", (20 * size, 25 * size)),
    )
    if shape.file is not None:
        x, size = float(found.lowest[0]), found.shortest
        views = (
            ("whole mesh", None),
            ("around the lowest point", (100 * size, 130 * size)),
            (f"lowest point: shortest edge of {size * 1e6:.3g} µm", (20 * size, 25 * size)),
        )
    colours = {tag: LAYER_COLOURS[tag] for tag in tags.LAYERS.values()}
    kinds, places = np.searchsorted(list(colours), found.layer), 1e3 * found.points
    title = f"Mesh of the unloaded finger: {len(found.triangles)} triangles, {counted(found.ridges, 'ridge')} can touch"
    with output.panels(file, f"{title}\n", 3) as (figure, panels):
        for ax, (words, view) in zip(panels, views, strict=True):
            inside = np.ones(len(kinds), bool)
            if view is not None:
                centre = found.points[found.triangles].mean(axis=1)
                inside = (np.abs(centre[:, 0] - x) < 1.2 * view[0]) & (centre[:, 1] < 1.2 * view[1])
            width = 0.25 if view is not None else 0.05 if len(kinds) < _FINEST_EDGES else 0.0
            seen = Triangulation(places[:, 0], places[:, 1], found.triangles[inside])
            ax.tripcolor(
                seen, facecolors=kinds[inside].astype(float), vmin=-0.5,
                vmax=len(colours) - 0.5, cmap=ListedColormap(list(colours.values())), linewidth=width,
                edgecolors="k" if width else "face",
            )  # fmt: skip
            ax.set(xlabel="x (mm)", ylabel="height (mm)", aspect="equal", title=words)
            ax.axhline(0, color="k", lw=2)
            ax.locator_params(nbins=5)
            if view is not None:
                left = 0.0 if found.points[:, 0].min() > -1e-9 else (x - view[0]) * 1e3
                ax.set(xlim=(left, (x + view[0]) * 1e3), ylim=(-0.03 * view[1] * 1e3, view[1] * 1e3))
        handles = [
            Patch(facecolor=colours[tag], edgecolor="k", lw=0.5, label=name) for name, tag in tags.LAYERS.items()
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
