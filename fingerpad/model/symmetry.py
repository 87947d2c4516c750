"""The whole finger's numbers from those of its half at x >= 0.

Under loads that do not move the bone sideways the finger is its own mirror image at x = 0: ridge -j bears what ridge j
does, with horizontal components the other way round. Half of ridge 0 is there, the other half is its image.
"""

from dataclasses import fields
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from variational.output import Snapshot
from variational.quantities import RidgeLoads

Array = NDArray[np.float64]
T = TypeVar("T")
_HORIZONTAL = ("x", "t_t", "area_x", "f_friction", "f_attraction_x")
_ON_LINE = 1e-9  # m from x = 0, within which a vertex is its own image


def names(half: list[int]) -> list[int]:
    """Return the numbers of all ridges from those of ridge 0 and on."""
    return [-j for j in half[:0:-1]] + half


def values(half: list[T]) -> list[T]:
    """Return one value a ridge that the mirror does not change."""
    return half[:0:-1] + half


def loads(half: RidgeLoads) -> RidgeLoads:
    """Return the resultants of all ridges, ridge 0's from its half."""

    def both(name: str) -> Array:
        v = getattr(half, name)
        sign = -1.0 if name in _HORIZONTAL else 1.0
        return np.concatenate([sign * v[:0:-1], [v[0] + sign * v[0]], v[1:]])

    return RidgeLoads(**{field.name: both(field.name) for field in fields(RidgeLoads)})


def profile(columns: tuple[str, ...], half: Array, ridge: Array) -> tuple[Array, Array]:
    """Return values at the skin's points and the position of each point's ridge among all.

    Args:
        columns: what the values are.
        half: values, shape (columns, facets, points).
        ridge: position of the ridge, 0 for ridge 0, shape (facets,).
    """
    signs = np.array([-1.0 if name in _HORIZONTAL else 1.0 for name in columns])
    last = int(ridge.max())
    return (
        np.concatenate([half, signs[:, None, None] * half], axis=1),
        np.concatenate([last + ridge, last - ridge]),
    )


def snapshot(half: Snapshot) -> Snapshot:
    """Return the whole body, one body along the line of symmetry."""
    on_line = np.abs(half.x[:, 0]) < _ON_LINE
    image = np.where(on_line, np.arange(len(on_line)), len(on_line) + np.cumsum(~on_line) - 1)
    flip = np.array([-1.0, 1.0])
    return Snapshot(
        np.concatenate([half.x, flip * half.x[~on_line]]),
        np.concatenate([half.u, flip * half.u[~on_line]]),
        np.concatenate([half.triangles, image[half.triangles][:, ::-1]]),
        np.concatenate([half.sed, half.sed]),
        np.concatenate([half.tag, half.tag]),
    )
