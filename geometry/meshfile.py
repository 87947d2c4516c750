"""A body from a gmsh file: its physical groups say, by their names, what each part is.

The file holds a plane mesh of triangles in metres, ``.msh`` of version 2.2 or 4.1. They have three nodes, or six: the
edges are parabolas then, through the nodes in their middle. The screen is the line y = 0, and
the body lies above it or on it; nothing is moved. Groups of cells are the layers of :data:`geometry.tags.LAYERS`
(*stratum corneum*, *viable epidermis*, *dermis*, *subcutis*, *nail*, *nail bed*), and every triangle is in one. Groups
of facets are

- *bone rim*: glued to the rigid bone. It must be there.
- *ridge 0*, *ridge 1*, *ridge -1*, ...: skin that can touch, by ridges, numbered from the centre to x > 0. At least one
  must be there; a body without ridges has *ridge 0*. Air gaps and pressures are those of ridges.
- *outer skin*: skin that is not expected to touch. A run of a whole finger checks that it stays clear of the screen.
- *nail surface*, *sides*: free surfaces, of which nothing depends.

The rest of the outline is free. ``docs/laws.md`` has an example.
"""

import hashlib
import re
import subprocess
import sys
from difflib import get_close_matches
from pathlib import Path

import gmsh
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from geometry import tags
from geometry.profiles import GeometryError
from geometry.shape import shape
from geometry.triangles import FLAT, refuse_folded, refuse_misplaced, refuse_misshapen, refuse_unconnected
from variational import files

FACETS = {
    "bone rim": tags.BONE_RIM,
    "outer skin": tags.OUTER_SKIN,
    "nail surface": tags.NAIL_SURFACE,
    "sides": tags.SIDES,
}
_RIDGE = re.compile(r"ridge (0|-?[1-9][0-9]{0,2})")
_KINDS = {2: {2: 3, 9: 6}, 1: {1: 2, 8: 3}}  # nodes of the elements allowed, by dimension and gmsh's number
_START = b"$MeshFormat"
# Wrong numbers can end the process in which gmsh reads them, keep it reading for ever, or take all of the memory.
_TRY = """
import gmsh, resource, sys
resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[2]),) * 2)
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
try:
    gmsh.merge(sys.argv[1])
except Exception as error:
    sys.exit(str(error))
"""
_MEMORY = 4e9, 40.0  # bytes, and bytes more for each of the file; gmsh takes some 4
_SECONDS = 20.0, 1e-6  # s, and s more for each byte; gmsh takes 1e-7 or less

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


@shape((tags.BONE_RIM,))
def file(path: str | Path, sha256: str = "") -> float:
    """Return the body of a gmsh file.

    Args:
        path: of a ``.msh`` file, see :mod:`geometry.meshfile`; read on rank 0, when the shape is meshed.
        sha256: hash that the file must have; without one any will do.

    Raises:
        GeometryError: the file is none, has changed, or holds no such body.
    """
    path = Path(path)
    content = _content(path, sha256)
    try:
        with files.alone(content, "mesh.msh") as copy:  # gmsh would run a script called NAME.msh.opt beside NAME.msh
            _refuse_unreadable(copy, len(content))
            gmsh.merge(str(copy))
        if gmsh.model.getNumberOfPartitions():
            raise GeometryError("the mesh is cut into partitions; write it whole, as by gmsh's Mesh > Unpartition")
        _rename()
        _check_mesh()
        _renumber()
    except GeometryError as error:
        raise GeometryError(f"{path}: {error}") from error
    return 1.0


def _content(path: Path, sha256: str) -> bytes:
    """Return the content of a file that gmsh takes for a mesh."""
    try:
        content = files.read(path)
    except OSError as error:
        raise GeometryError(f"{path}: the mesh file cannot be read: {error.strerror}") from error
    if sha256 and hashlib.sha256(content).hexdigest() != sha256:
        raise GeometryError(f"{path} has changed since the scene was made; make the scene again")
    if not content.startswith(_START) or path.suffix != ".msh":
        # gmsh tells kinds of files by their ends, and takes an unknown one for a script of its own, which it runs.
        raise GeometryError(f"{path} is no mesh of gmsh; it must be a .msh file of version 2.2 or 4.1")
    return content


def _refuse_unreadable(copy: Path, size: int) -> None:
    """Refuse a file of a size (bytes) that gmsh cannot read, as another process finds out.

    Raises:
        GeometryError: why not.
    """
    memory, seconds = (least + more * size for least, more in (_MEMORY, _SECONDS))
    command, words = [sys.executable, "-P", "-c", _TRY, str(copy), str(int(memory))], ""
    try:
        done = subprocess.run(command, capture_output=True, timeout=seconds)
        if done.returncode == 0:
            return
        words = done.stderr.decode(errors="replace").strip() if done.returncode > 0 else ""
    except subprocess.TimeoutExpired:
        pass
    why = f": {words.splitlines()[-1]}" if words else ", which is damaged; write it again"
    raise GeometryError(f"gmsh cannot read the mesh{why}")


def _rename() -> None:
    """Give the groups the tags of :mod:`geometry.tags`, by their names."""
    groups = []
    for dim, tag in gmsh.model.getPhysicalGroups():
        try:
            name = gmsh.model.getPhysicalName(dim, tag)
        except UnicodeDecodeError:
            raise GeometryError(f"group {tag} has a name that is no text in UTF-8; write the file in UTF-8") from None
        gmsh.model.removePhysicalName(name)  # else it stays with its old tag
        if dim == 0:
            continue
        if dim == 3:
            raise GeometryError(f"group {name!r} is of volumes; the mesh must be plane")
        groups.append((dim, _tag(dim, tag, name), name, gmsh.model.getEntitiesForPhysicalGroup(dim, tag)))
    gmsh.model.removePhysicalGroups()
    found = {tag for _, tag, _, _ in groups}
    if not found & set(tags.LAYERS.values()):
        raise GeometryError(f"no group of cells is a layer; give at least one of {_listed(tags.LAYERS)}")
    if not any(map(tags.is_ridge, found)):
        raise GeometryError("no skin can touch; give the facets that can a group 'ridge 0', 'ridge 1', 'ridge -1', ...")
    if tags.BONE_RIM not in found:
        raise GeometryError("the group 'bone rim' is missing: the facets that are glued to the bone")
    taken: dict[tuple[int, int], str] = {}
    for dim, tag, name, entities in groups:
        for entity in entities:
            if (dim, entity) in taken:
                raise GeometryError(f"groups {taken[dim, entity]!r} and {name!r} overlap")
            taken[dim, entity] = name
        gmsh.model.addPhysicalGroup(dim, entities, tag, name)


def _tag(dim: int, number: int, name: str) -> int:
    """Return the tag that a group's name stands for."""
    known = tags.LAYERS if dim == 2 else FACETS
    if name in known:
        return known[name]
    ridge = _RIDGE.fullmatch(name)
    if dim == 1 and ridge and abs(int(ridge[1])) < 500:
        return tags.ridge(int(ridge[1]))
    what = "cells" if dim == 2 else "facets"
    if not name:
        raise GeometryError(f"group {number} of {what} has no name")
    allowed = [*known, "ridge 0", "ridge 1", "ridge -1"] if dim == 1 else [*known]
    near = get_close_matches(name.lower(), allowed, n=1)
    if near:
        raise GeometryError(f"group {name!r} of {what} is unknown; did you mean {near[0]!r}?")
    raise GeometryError(f"group {name!r} of {what} is unknown; it must be one of {_listed(allowed)}")


def _listed(names: list[str] | dict[str, int]) -> str:
    return ", ".join(map(repr, names))


def _check_mesh() -> None:
    """Refuse what is no plane mesh of triangles, of first or second order, on its screen."""
    nodes, coordinates, _ = gmsh.model.mesh.getNodes()
    xyz = np.asarray(coordinates, dtype=np.float64).reshape(-1, 3)
    every = _triangles()
    triangles = every[:, :3]
    used = np.isin(nodes, every)
    refuse_misplaced(xyz[used])
    order = np.argsort(nodes)
    places = order[np.searchsorted(nodes, triangles, sorter=order)]
    refuse_misshapen(xyz[places][:, :, :2])
    refuse_folded(every)
    grouped = sum(len(_of_group(2, tag)) for tag in tags.LAYERS.values())
    if grouped < len(triangles):
        raise GeometryError(f"{len(triangles) - grouped} of {len(triangles)} triangles are in no group of cells")
    _, corners = np.unique(triangles, return_inverse=True)
    corners = corners.reshape(-1, 3)
    edges = corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    links = coo_array((np.ones(len(edges)), edges.T), shape=(corners.max() + 1,) * 2)
    parts = connected_components(links, directed=False)[0]
    if parts > 1:
        raise GeometryError(f"the mesh is in {parts} parts that share no node; layers must share nodes where they meet")
    refuse_unconnected(xyz[:, :2], places)
    _check_facets(triangles)
    _check_lowest(xyz[used], np.asarray(nodes, dtype=np.int64)[used])


def _renumber() -> None:
    """Leave the nodes of triangles alone in the model, numbered from 1 without a gap, and the groups."""
    groups = [(dim, tag, gmsh.model.getPhysicalName(dim, tag)) for dim, tag in gmsh.model.getPhysicalGroups()]
    elements = [_of_group(dim, tag) for dim, tag, _ in groups]
    numbers, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(numbers)
    used = np.unique(np.concatenate([nodes.ravel() for nodes in elements]))
    places = coordinates.reshape(-1, 3)[order[np.searchsorted(numbers, used, sorter=order)]]
    gmsh.model.remove()
    gmsh.model.add("file")
    cells = next(k for k, (dim, _, _) in enumerate(groups, start=1) if dim == 2)
    for k, (dim, tag, name) in enumerate(groups, start=1):
        gmsh.model.addDiscreteEntity(dim, k)
        gmsh.model.addPhysicalGroup(dim, [k], tag, name)
    gmsh.model.mesh.addNodes(2, cells, np.arange(1, len(used) + 1), places.ravel())
    for k, ((dim, _, _), nodes) in enumerate(zip(groups, elements, strict=True), start=1):
        kind = next(kind for kind, count in _KINDS[dim].items() if count == nodes.shape[1])
        gmsh.model.mesh.addElementsByType(k, kind, [], np.searchsorted(used, nodes).ravel() + 1)


def _check_lowest(xyz: Array, nodes: Numbers) -> None:
    """Refuse a body whose lowest point cannot touch; of all nodes, their places (m) and their numbers."""
    ridges = [_of_group(1, tag).ravel() for _, tag in gmsh.model.getPhysicalGroups(1) if tags.is_ridge(tag)]
    low = xyz[np.isin(nodes, np.concatenate(ridges)), 1].min()
    below = xyz[:, 1].min()
    size = float(np.ptp(xyz[:, :2], axis=0).max())
    if below < low - FLAT * size:
        raise GeometryError(
            f"the lowest point, at y = {below:g} m, is in no ridge group, and the lowest ridge is at y = {low:g} m; "
            "give the skin that comes down first a group 'ridge 0'"
        )
    if low > size:
        raise GeometryError(
            f"the lowest ridge is at y = {low:g} m, further above the screen at y = 0 than the body is large; "
            f"move the body down by {low:g} m"
        )


def _check_facets(triangles: Numbers) -> None:
    """Refuse ridges inside the body, and groups of facets that are no edges of triangles; of nodes, shape (n, 3)."""
    taken: dict[int, str] = {}
    known, counts = np.unique(_keys(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), return_counts=True)
    for dim, tag in gmsh.model.getPhysicalGroups(1):
        name, mine = gmsh.model.getPhysicalName(dim, tag), _keys(_of_group(1, tag)[:, :2])
        if not len(mine) or not np.isin(mine, known).all():
            raise GeometryError(f"group {name!r} has edges that no triangle has, or none at all")
        if (counts[np.isin(known, mine)] > 1).any() and (tags.is_ridge(tag) or tag in (tags.BONE_RIM, tags.OUTER_SKIN)):
            raise GeometryError(f"group {name!r} has edges inside the body; it must be of the outline alone")
        for key in mine:
            if key in taken:
                raise GeometryError(f"groups {taken[key]!r} and {name!r} have an edge in common")
            taken[key] = name


def _keys(edges: Numbers) -> Numbers:
    """Return a number for each edge, whichever of its nodes is the first; of nodes, shape (n, 2)."""
    low, high = np.sort(edges, axis=1).T
    return np.asarray(low * 2**31 + high)


def _triangles() -> Numbers:
    """Return the nodes of all triangles, shape (triangles, 3 or 6), if they and the facets are of one order."""
    if len(gmsh.model.mesh.getElements(3)[0]):
        raise GeometryError("the mesh has volumes; it must be plane")
    found = {dim: gmsh.model.mesh.getElements(dim) for dim in (1, 2)}
    for dim, (kinds, _, _) in found.items():
        others = [gmsh.model.mesh.getElementProperties(k)[0] for k in kinds if k not in _KINDS[dim]]
        if others:
            raise GeometryError(f"the mesh has elements {others[0]!r}; cells must be triangles with 3 or with 6 nodes")
    kinds, _, nodes = found[2]
    if not len(kinds):
        raise GeometryError("the mesh has no triangles with 3 or with 6 nodes")
    if len(kinds) > 1 or any(_KINDS[1][k] != _KINDS[2][kinds[0]] // 3 + 1 for k in found[1][0]):
        raise GeometryError(
            "the mesh has elements of first and of second order; give triangles with 3 nodes and edges with 2, or "
            "triangles with 6 nodes and edges with 3"
        )
    return np.asarray(nodes[0], dtype=np.int64).reshape(-1, _KINDS[2][kinds[0]])


def _of_group(dim: int, tag: int) -> Numbers:
    """Return the nodes of the elements of a group, shape (elements, nodes)."""
    entities = gmsh.model.getEntitiesForPhysicalGroup(dim, tag) if (dim, tag) in _groups() else ()
    found = [
        nodes.astype(np.int64).reshape(-1, _KINDS[dim][kind])
        for entity in entities
        for kind, _, nodes in zip(*gmsh.model.mesh.getElements(dim, entity), strict=True)
    ]
    return np.concatenate(found) if found else np.empty((0, dim + 1), dtype=np.int64)


def _groups() -> set[tuple[int, int]]:
    return set(gmsh.model.getPhysicalGroups())
