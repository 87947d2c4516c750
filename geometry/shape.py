"""A cross-section as a value: what is to be meshed, and nothing of gmsh until it is."""

import inspect
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import wraps
from typing import Any, ParamSpec

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
