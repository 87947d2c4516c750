"""A cross-section as a value, which is meshed later, and the session of gmsh in which that is done."""

import inspect
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import gmsh
import numpy as np

from geometry.profiles import GeometryError
from geometry.triangles import refuse_corners, refuse_folded, second_order, triangles_and_skin

P = ParamSpec("P")


@dataclass(frozen=True)
class Shape:
    """A body that is meshed when it is called, in the current gmsh session."""

    name: str
    needed: tuple[int, ...]
    """Tags of cells and facets that its mesh must have (:mod:`geometry.tags`)."""
    build: Callable[..., float]
    """Meshes in the current gmsh session and returns the length of its unit in m."""
    args: tuple[Any, ...]
    kwargs: tuple[tuple[str, Any], ...]

    def __call__(self) -> float:
        """Mesh in the current gmsh session; return the length of its unit in m."""
        return self.build(*self.args, **dict(self.kwargs))


def shape(needed: Iterable[int]) -> Callable[[Callable[P, float]], Callable[P, Shape]]:
    """Turn a function that meshes a body into one that returns its :class:`Shape`.

    Args:
        needed: tags that the mesh must have.
    """
    tags = tuple(needed)

    def decorate(build: Callable[P, float]) -> Callable[P, Shape]:
        signature = inspect.signature(build)

        @wraps(build)
        def make(*args: P.args, **kwargs: P.kwargs) -> Shape:
            bound = signature.bind(*args, **kwargs)  # a TypeError now, not when the shape is meshed
            return Shape(build.__name__, tags, build, bound.args, tuple(bound.kwargs.items()))

        return make

    return decorate


def built(build: Callable[[], float]) -> float:
    """Mesh a body in the current gmsh session, for a run or a picture, and check it; return its unit (m).

    Args:
        build: meshes in the current gmsh session and returns the length of its unit in m.

    Raises:
        GeometryError: what ``build`` or gmsh refuses, folded triangles, and those with two sides that can touch.
    """
    try:
        unit = build()
    except Exception as error:
        if type(error) is not Exception:  # gmsh's own are of no other kind
            raise
        raise GeometryError(f"gmsh cannot mesh the body: {error}; try smaller elements") from None
    refuse_folded(second_order(), unit)
    numbers, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(numbers)
    triangles, skin = triangles_and_skin()
    places = np.searchsorted(numbers[order], triangles)
    refuse_corners(unit * coordinates.reshape(-1, 3)[order, :2], places, np.searchsorted(numbers[order], skin))
    return unit


@contextmanager
def session(name: str) -> Iterator[None]:
    """Work in an empty model with gmsh's default options; a caller's models and options are there again afterwards.

    No configuration of gmsh is read: the options that its window saves in the user's home would change the mesh.

    Args:
        name: name of the model.
    """
    if gmsh.isInitialized():
        with tempfile.TemporaryDirectory(prefix="fingerpad-") as folder:
            options, current = str(Path(folder) / "options.opt"), gmsh.model.getCurrent()
            gmsh.write(options)
            gmsh.option.restoreDefaults()
            try:
                _begin(name)
                yield
            finally:
                gmsh.merge(options)  # which would name a model of the caller that has no name
                gmsh.model.remove()
                gmsh.model.setCurrent(current)
    else:
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        try:
            _begin(name)
            yield
        finally:
            gmsh.finalize()


def _begin(name: str) -> None:
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add(name)
