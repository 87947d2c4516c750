"""The mesh of a finger's cross-section by gmsh alone: for a description, a picture, or a file for gmsh."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from fingerpad.model.options import ModelOptions, by_rule
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from geometry import tags
from geometry.profiles import GeometryError


@dataclass(frozen=True, eq=False)
class Section:
    """The cross-section of a finger in triangles."""

    points: NDArray[np.float64]
    """Vertices (m), shape (points, 2)."""
    triangles: NDArray[np.int_]
    """Vertices of each triangle, shape (triangles, 3)."""
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
def _meshed(scene: Scene, receptors: bool, half: bool) -> Iterator[Any]:
    """Mesh a scene's finger in a session of gmsh, lengths in mm; ridges that can touch by the rule of thumb by default.

    Yields:
        The module ``gmsh``.

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
    """Return the mesh that a run of a scene would have; that of its file, checked, if it has one.

    Raises:
        SceneError: the finger cannot be meshed, or the file has no such mesh.
    """
    if scene.geometry.file is None:
        with _meshed(scene, needed.receptors, not needed.both_halves) as gmsh:
            return _read(gmsh)
    import gmsh as program

    from geometry import meshfile
    from geometry.shape import built, session

    try:
        with session("file"):
            return _read(program, built(meshfile.file(scene.geometry.file, scene.geometry.file_sha256 or "")))
    except GeometryError as error:
        raise SceneError(f"mesh: {error}") from None


def write(scene: Scene, file: Path) -> Section:
    """Write the mesh of the whole finger as gmsh's format 2.2, lengths in m, groups named; and return it.

    Raises:
        SceneError: the finger cannot be meshed, or the file cannot be written.
    """
    with _meshed(scene, scene.output.receptors, False) as gmsh:
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
                triangles.append(nodes.astype(int).reshape(-1, count)[:, :3])
                layers.append(np.full(len(triangles[-1]), tag))
    ridges = sum(tags.is_ridge(tag) for dimension, tag in gmsh.model.getPhysicalGroups(1))
    order = np.argsort(numbers)
    places = coordinates.reshape(-1, 3)[order, :2] * unit
    corners = np.searchsorted(numbers[order], np.concatenate(triangles))
    used = np.unique(corners)  # other nodes are on edges, or guide the element size
    return Section(places[used], np.searchsorted(used, corners), np.concatenate(layers), ridges)
