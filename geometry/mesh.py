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
from geometry.profiles import GeometryError
from geometry.shape import Shape, built, session


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
    unit = 1.0
    failure: Exception | None = None
    with ExitStack() as stack:
        if comm.rank == 0:
            try:
                stack.enter_context(session("body"))
                unit = built(build)
            except Exception as error:  # whatever it is, the other ranks must not wait for a mesh
                failure = error
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
    return TaggedMesh(mesh, cell_tags, facet_tags)
