"""What the macroscale asks of a microscale model."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray


class AirGap(NamedTuple):
    """Equivalent air gap of each ridge and its derivative."""

    d_eq: NDArray[np.float64]
    """Equivalent air gap (m)."""
    derivative: NDArray[np.float64]
    """d d_eq / d p_c (m/Pa)."""


class Closure(Protocol):
    """A microscale model: mean contact pressure in, equivalent air gap out."""

    def __call__(self, p_c: ArrayLike) -> AirGap:
        """Return the air gap at mean contact pressures ``p_c`` >= 0 (Pa); zero means no contact."""
        ...

    def state(self, p_c: float, voltage: float) -> str:
        """Return ``""`` or what a reader should know of a ridge at this pressure (Pa) and voltage (V)."""
        ...
