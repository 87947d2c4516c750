"""The skin that is not meshed to touch, checked: where it comes near the screen, the run starts again with more.

Ridges far from the contact have coarse elements and no contact forces. Which ones these are follows from a scene only
roughly. So each accepted step is checked: the last ridge on either side that can touch must not, and skin beyond must
stay clear of the screen. The last ridge touches long before the next one would: by the outline's curvature that one
is a tenth of a millimetre higher.
"""

from dataclasses import dataclass
from pathlib import Path

from dolfinx import fem

from geometry import tags
from geometry.mesh import TaggedMesh
from variational.quantities import Observer, RidgeLoads

_MIN_CLEARANCE = 10e-6  # m, height of the skin at which an attraction of 200 V comes to 1 kPa
_MORE = 2  # ridges on either side that are added at least, or
_PART = 0.25  # this part of those that could touch before


@dataclass(frozen=True)
class Wider:
    """More ridges must be able to touch."""

    last: int
    """Number of the last one, on either side."""
    reason: str


class FingerExceeded(RuntimeError):
    """Skin touches beyond the last ridge that the finger has."""


class ContactZone:
    """Checks the skin of a finger."""

    def __init__(
        self, body: TaggedMesh, observer: Observer, ridges: list[int], count: int, file: str | Path | None = None
    ) -> None:
        """Find the skin that cannot touch.

        Args:
            body: the finger's mesh.
            observer: evaluates its surface.
            ridges: numbers of the ridges that can touch, of the whole finger.
            count: number of all ridges of the finger.
            file: the mesh's, where it is of a file, which has all the ridges there are.
        """
        self._observer, self._problem = observer, observer.problem
        self._ridges, self._count, self._file = ridges, count, file
        outside = body.facet_tags.find(tags.OUTER_SKIN)
        self._nodes = fem.locate_dofs_topological(self._problem.V, 1, outside)

    def _lowest_outside(self) -> float:
        """Return the lowest height (m) of the skin that cannot touch."""
        V, u = self._problem.V, self._problem.displacement()
        return self._observer.lowest_outside(V.tabulate_dof_coordinates()[self._nodes, 1] + u[self._nodes, 1])

    def check(self, loads: RidgeLoads) -> Wider | None:
        """Return what must be added for the present state to be one of the whole finger, if anything; collective.

        Args:
            loads: resultants of the ridges that can touch.

        Raises:
            FingerExceeded: more ridges must be able to touch, and there are no more.
        """
        lowest = self._lowest_outside()
        if self._file is not None:
            if lowest < 0:
                raise FingerExceeded(
                    f"skin of the group 'outer skin' is at a height of {lowest:.3g} m; {self._file} must have more "
                    "ridges, or f_ext be smaller"
                )
            return None
        ridges, wider = self._ridges, more(self._ridges[-1], self._count)
        last = [j for j, length in ((ridges[0], loads.length[0]), (ridges[-1], loads.length[-1])) if length > 0]
        if last:
            reason = f"ridge {last[0]}, the last one that is meshed to touch, is in contact"
        elif lowest < (0.0 if wider is None else _MIN_CLEARANCE):
            reason = f"skin beyond the ridges that are meshed to touch is at a height of {lowest:.3g} m"
        else:
            return None
        if wider is None:
            raise FingerExceeded(
                f"{reason}, and the finger has no more ridges; geometry.ridge_count is {self._count} and must be "
                "larger, or f_ext smaller"
            )
        return Wider(wider, reason)


def more(last: int, count: int) -> int | None:
    """Return the last ridge, on either side, that can touch after a restart; None if all could before.

    Args:
        last: the last one before.
        count: number of all ridges of the finger.
    """
    return None if last == (count - 1) // 2 else last + max(_MORE, round(_PART * last))
