"""``fingerpad mesh``: the mesh of a finger by gmsh alone: a file for gmsh, triangles and layers for a picture."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from fingerpad.cli import output
from fingerpad.cli.arguments import PICTURE, Kind, Parser, echo, scene_of
from fingerpad.model.options import ModelOptions, by_rule
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError, counted
from geometry import tags
from geometry.profiles import GeometryError

_MESH = Kind("a mesh", (".msh",), "$MeshFormat\n2.2 ")
_EXAMPLES = """
    fingerpad mesh --out finger.msh --plot finger.png
    fingerpad mesh scene.toml --set mesh.contact=20e-6 --out coarse.msh
"""
_ON_EDGE = 6  # pieces of a curved edge in a picture
_FINEST_EDGES = 60_000  # triangles of the whole finger up to which their edges are drawn


def main(argv: Sequence[str]) -> int:
    """Write a mesh; return the exit code."""
    parser = Parser("mesh", _EXAMPLES)
    parser.add_scene()
    parser.add_file("--out", _MESH, "file for gmsh (default: finger.msh)", "finger.msh")
    parser.add_file("--plot", PICTURE, "picture of the mesh")
    args = parser.read(argv)
    scene = scene_of(args)
    if scene.geometry.file is not None:
        raise SceneError("geometry.file is given, which is a mesh already; fingerpad check draws it")
    found = write(scene, args.out)
    ridges = counted(found.ridges, "ridge")
    echo(f"{len(found.triangles)} triangles, {len(found.points)} vertices, {ridges} that can touch")
    echo(f"Written: {args.out}")
    if args.plot:
        draw(args.plot, found, scene)
        echo(f"Written: {args.plot}")
    return 0


# -- meshes --------------------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Section:
    """The cross-section of a finger in triangles."""

    points: NDArray[np.float64]
    """Vertices (m), shape (points, 2)."""
    triangles: NDArray[np.int_]
    """Vertices of each triangle, shape (triangles, 3)."""
    outline: NDArray[np.float64]
    """Places around each triangle (m), several on each curved edge, shape (triangles, places, 2)."""
    layer: NDArray[np.int_]
    """Tag of each triangle's layer, of :mod:`geometry.tags`."""
    ridges: int
    """Number of ridges that can touch."""

    @property
    def lowest(self) -> NDArray[np.float64]:
        """The lowest vertex (m), shape (2,)."""
        return np.asarray(self.points[self.points[:, 1].argmin()])

    @property
    def shortest(self) -> float:
        """Length of the shortest edge (m)."""
        corners = self.points[self.triangles]
        return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).min())


@contextmanager
def meshed(scene: Scene, receptors: bool, half: bool) -> Iterator[Any]:
    """Mesh a scene's finger in a session of gmsh; ridges that can touch by the rule of thumb if none are given.

    Yields:
        The module ``gmsh``, lengths of its model in mm.

    Raises:
        SceneError: the finger cannot be meshed.
    """
    import gmsh

    from geometry import fingertip
    from geometry.shape import built, session

    scene = by_rule(scene)
    with session("finger"):
        try:
            built(lambda: fingertip.build(scene.geometry, scene.mesh, receptors, half))
        except GeometryError as error:
            raise SceneError(f"the finger cannot be meshed: {error}") from None
        yield gmsh


def section(scene: Scene, needed: ModelOptions) -> Section:
    """Return the mesh of what a run of a scene would hold, for a picture; that of its file, checked, if it has one.

    Raises:
        SceneError: the finger cannot be meshed, or the file has no such mesh.
    """
    if scene.geometry.file is not None:
        return _of_file(Path(scene.geometry.file), scene.geometry.file_sha256 or "")
    with meshed(scene, needed.receptors, not needed.both_halves) as gmsh:
        return _read(gmsh)


def _of_file(file: Path, sha256: str) -> Section:
    import gmsh

    from geometry import meshfile
    from geometry.shape import built, session

    try:
        with session("file"):
            return _read(gmsh, built(meshfile.file(file, sha256)))
    except GeometryError as error:
        raise SceneError(f"mesh: {error}") from None


def write(scene: Scene, file: Path) -> Section:
    """Write the mesh of the whole finger as gmsh's format 2.2, lengths in m, groups named; and return it."""
    with meshed(scene, scene.output.receptors, False) as gmsh:
        gmsh.option.setNumber("Mesh.ScalingFactor", 1e-3)
        gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
        part = file.with_name(f"{file.stem}.{uuid4().hex[:8]}.part.msh")
        try:
            gmsh.write(str(part))
            part.replace(file)
        except Exception as error:  # gmsh's own are of no other kind
            part.unlink(missing_ok=True)
            raise SceneError(f"{file} cannot be written: {error}") from None
        return _read(gmsh)


def _read(gmsh: Any, unit: float = 1e-3) -> Section:
    """Return the mesh of the current session, whose lengths are in a unit (m)."""
    numbers, coordinates, _ = gmsh.model.mesh.getNodes()
    triangles, layers = [], []
    groups = {tag for _, tag in gmsh.model.getPhysicalGroups(2)}
    for tag in filter(groups.__contains__, tags.LAYERS.values()):
        for entity in gmsh.model.getEntitiesForPhysicalGroup(2, tag):
            for kind, _, nodes in zip(*gmsh.model.mesh.getElements(2, entity), strict=True):
                count = gmsh.model.mesh.getElementProperties(kind)[3]
                triangles.append(nodes.astype(int).reshape(-1, count))
                layers.append(np.full(len(triangles[-1]), tag))
    ridges = sum(tags.is_ridge(tag) for dimension, tag in gmsh.model.getPhysicalGroups(1))
    nodes = np.concatenate(triangles)
    order = np.argsort(numbers)
    places = coordinates.reshape(-1, 3)[order, :2] * unit
    every = np.searchsorted(numbers[order], nodes)
    used = np.unique(every[:, :3])  # the others guide the element size
    corners = np.searchsorted(used, every[:, :3])
    return Section(places[used], corners, _outline(places[every]), np.concatenate(layers), ridges)


def _outline(nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return places around triangles from those of their nodes, in gmsh's order, shape (triangles, 3 or 6, 2)."""
    if nodes.shape[1] == 3:
        return nodes
    first, middle, last = nodes[:, :3, None], nodes[:, 3:, None], nodes[:, [1, 2, 0], None]
    t = np.linspace(0, 1, _ON_EDGE, endpoint=False)[:, None]
    curves = first * (1 - t) * (1 - 2 * t) + middle * 4 * t * (1 - t) + last * t * (2 * t - 1)
    return np.asarray(curves.reshape(len(nodes), -1, 2))


def draw(file: Path, found: Section, scene: Scene) -> None:
    """Draw the mesh: the whole finger, some ridges, and one ridge's tip; layers in colour, axes in mm."""
    shape = scene.geometry
    period, deep = shape.ridge_wavelength, shape.sc_thickness + shape.ve_thickness
    size = scene.mesh.contact
    centre = 0.0
    views: tuple[tuple[str, tuple[float, float] | None], ...] = (
        ("whole finger", None),
        (f"ridge 0, of {period * 1e3:.3g} mm", (1.5 * deep, 2 * deep)),
        (f"tip of ridge 0: facets of {size * 1e6:.3g} µm", (20 * size, 25 * size)),
    )
    if scene.geometry.file is not None:
        centre, size = found.lowest[0], found.shortest
        views = (
            ("whole mesh", None),
            ("around the lowest point", (100 * size, 130 * size)),
            (f"lowest point: shortest edge of {size * 1e6:.3g} µm", (20 * size, 25 * size)),
        )
    title = (
        f"Mesh of the unloaded finger: {len(found.triangles)} triangles, {counted(found.ridges, 'ridge')} can touch\n"
    )
    with output.panels(file, title, 3) as (figure, panels):
        left_most = found.points[:, 0].min()
        for ax, (title, view) in zip(panels, views, strict=True):
            _fill(ax, found, view, centre)
            ax.set(xlabel="x (mm)", ylabel="height (mm)", aspect="equal", title=title)
            ax.axhline(0, color="k", lw=2)
            ax.locator_params(nbins=5)
            if view is not None:
                left = 0.0 if left_most > -1e-9 else (centre - view[0]) * 1e3
                ax.set(xlim=(left, (centre + view[0]) * 1e3), ylim=(-0.03 * view[1] * 1e3, view[1] * 1e3))
        from matplotlib.patches import Patch

        from fingerpad.results.finger_picture import LAYER_COLOURS

        layers = {name: LAYER_COLOURS[tag] for name, tag in tags.LAYERS.items()}
        handles = [Patch(facecolor=colour, edgecolor="k", lw=0.5, label=name) for name, colour in layers.items()]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))


def _fill(ax: Any, found: Section, view: tuple[float, float] | None, middle: float) -> None:
    """Fill the triangles that are in a view, with edges where there is room for them."""
    outline, layer = found.outline, found.layer
    if view is not None:
        centre = outline.mean(axis=1)
        inside = (np.abs(centre[:, 0] - middle) < 1.2 * view[0]) & (centre[:, 1] < 1.2 * view[1])
        outline, layer = outline[inside], layer[inside]
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import ListedColormap

    from fingerpad.results.finger_picture import LAYER_COLOURS

    tagged = list(tags.LAYERS.values())
    colours = [LAYER_COLOURS[tag] for tag in tagged]
    width = 0.25 if view is not None else 0.05 if len(outline) < _FINEST_EDGES else 0.0
    corners: Any = 1e3 * outline
    shapes = PolyCollection(
        corners, array=np.searchsorted(tagged, layer).astype(float), cmap=ListedColormap(colours),
        edgecolors="k" if width else "face", linewidths=width,
    )  # fmt: skip
    shapes.set_clim(-0.5, len(tagged) - 0.5)
    ax.add_collection(shapes)
    ax.autoscale_view()
