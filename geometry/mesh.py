"""From a gmsh model, built on rank 0, to a distributed dolfinx mesh in metres. The only dolfinx code here."""

from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass

import dolfinx
import gmsh
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

try:  # dolfinx 0.10 renamed the module
    from dolfinx.io import gmsh as gmshio
except ImportError:
    from dolfinx.io import gmshio

from geometry import tags
from geometry.curved import refuse_folded, second_order
from geometry.profiles import GeometryError
from geometry.shape import Shape, session


@dataclass(frozen=True)
class TaggedMesh:
    """A mesh (coordinates in m) with tags of its cells and facets."""

    mesh: dolfinx.mesh.Mesh
    cell_tags: dolfinx.mesh.MeshTags
    facet_tags: dolfinx.mesh.MeshTags

    @property
    def rim(self) -> NDArray[np.int32]:
        """Facets of this rank that are glued to the bone."""
        return self.facets(tags.BONE_RIM)

    def facets(self, tag: int) -> NDArray[np.int32]:
        """Return the facets of this rank with a tag."""
        return np.asarray(self.facet_tags.find(tag))

    def layers(self) -> dict[str, int]:
        """Return the tag of each layer that has a cell, by its name, the same on every rank."""
        here = set(np.unique(self.cell_tags.values).tolist())
        present = set().union(*self.mesh.comm.allgather(here))
        return {name: tag for name, tag in tags.LAYERS.items() if tag in present}

    def ridge_tags(self) -> dict[int, int]:
        """Return the facet tag of each ridge's number, in order, the same on every rank."""
        return {j: tags.ridge(j) for j in self.ridges()}

    def ridges(self) -> list[int]:
        """Return the numbers of the ridges that can touch, in order, the same on every rank."""
        here = {tags.ridge_index(int(tag)) for tag in np.unique(self.facet_tags.values) if tags.is_ridge(int(tag))}
        return sorted(set().union(*self.mesh.comm.allgather(here)))


def load(comm: MPI.Comm, build: Callable[[], float], needed: Iterable[int] = ()) -> TaggedMesh:
    """Build a gmsh model on rank 0 and distribute its mesh.

    Args:
        comm: communicator of the mesh.
        build: meshes in the current gmsh session and returns the length of its unit in m.
        needed: tags of cells or facets that must exist, beside those that a shape names.

    Raises:
        GeometryError: what ``build`` or gmsh refuses, on every rank; or a needed tag without any entity.
    """
    unit, failure = 1.0, None
    with ExitStack() as stack:
        if comm.rank == 0:
            try:
                stack.enter_context(session("body"))
                unit = build()
                refuse_folded(second_order(), unit)
            except Exception as error:  # whatever it is, the other ranks must not wait for a mesh
                plain = type(error) is Exception  # gmsh's own, which are of no other kind
                failure = GeometryError(f"gmsh cannot mesh the body: {error}; try smaller elements") if plain else error
        failure = comm.bcast(failure)
        if failure is not None:
            raise failure
        unit = comm.bcast(unit)
        mesh, cell_tags, facet_tags = gmshio.model_to_mesh(gmsh.model, comm, 0, gdim=2)[:3]
    mesh.geometry.x[:] *= unit
    for tag in (*needed, *(build.needed if isinstance(build, Shape) else ())):
        count = comm.allreduce(int(np.sum(cell_tags.values == tag)) + int(np.sum(facet_tags.values == tag)))
        if count == 0:
            raise GeometryError(f"the mesh has no cell or facet with tag {tag}")
    found = TaggedMesh(mesh, cell_tags, facet_tags)
    _refuse_corner_cells(found)
    return found


def _refuse_corner_cells(body: TaggedMesh) -> None:
    """Refuse a triangle with two sides on the skin that can touch; collective.

    Raises:
        GeometryError: where the first of them is, on every rank.
    """
    mesh, (facets, values) = body.mesh, (body.facet_tags.indices, body.facet_tags.values)
    mesh.topology.create_connectivity(1, 2)
    to_cells = mesh.topology.connectivity(1, 2)
    of = [to_cells.links(f)[0] for f, tag in zip(facets, values, strict=True) if tags.is_ridge(int(tag))]
    cells, count = np.unique(np.array(of, dtype=np.int32), return_counts=True)
    middles = dolfinx.mesh.compute_midpoints(mesh, 2, cells[count > 1])[:, :2].tolist()
    everywhere = [place for there in mesh.comm.allgather(middles) for place in there]
    if everywhere:
        x, y = (round(1e3 * each, 6) + 0.0 for each in everywhere[0])  # no minus before a zero
        raise GeometryError(
            f"the triangle at x = {x:g} mm, y = {y:g} mm has two sides on the skin that can touch, and one is allowed; "
            "give smaller elements there, or a skin without a corner"
        )
