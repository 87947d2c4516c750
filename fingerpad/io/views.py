"""What is shown of a state: the skin that can touch, the deformed finger, and rows of tables."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geometry.parameters import MeshSize
from variational.state import ContactState, Skin

if TYPE_CHECKING:
    from variational.output import Snapshot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Profile:
    """The skin that can touch."""

    ridge: NDArray[np.int64]
    """Position of each facet's ridge among all, shape (facets,)."""
    values: Array
    """Current place (m), pressure, shear and attraction (Pa), and current area, shape (7, facets, points)."""
    d_eq: Array
    """Equivalent air gap (m) of each ridge, shape (ridges,)."""

    def skin(self, numbers: NDArray[np.int64]) -> Skin:
        """Return the same with tractions per current area, for the numbers of the ridges, shape (ridges,)."""
        x, y, p_n, t_t, p_el, area_x, area_y = self.values
        stretch = np.hypot(area_x, area_y)
        return Skin(numbers[self.ridge], x, y, p_n / stretch, t_t / stretch, p_el)


@dataclass(frozen=True)
class View:
    """All that is shown of a state."""

    state: ContactState
    """Without a record of a step."""
    mesh: MeshSize
    profile: Profile | None
    """None on ranks other than 0, likewise the next."""
    snapshot: "Snapshot | None"
    merkel: Array | None
    """Current places (m) of the Merkel sites, shape (sites, 2), None where they are not wanted."""
    ridges: list[dict[str, Any]]
    """Rows of ``ridges.csv``."""
    receptors: list[dict[str, Any]]
    """Rows of ``receptors.csv``."""
