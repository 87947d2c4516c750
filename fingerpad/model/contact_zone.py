"""The skin that is not meshed to touch, checked: where it comes near the screen, the run starts again with more.

Ridges far from the contact have coarse elements and no contact forces. Which ones these are follows from a scene only
roughly. So each accepted step is checked: the last ridge on either side that can touch must not, and skin beyond must
stay clear of the screen. The last ridge touches long before the next one would: by the outline's curvature that one
is a tenth of a millimetre higher.
"""

from dataclasses import dataclass

from dolfinx import fem

from fingerpad.model.options import ModelOptions
from fingerpad.scene import Scene
from geometry import tags
from geometry.mesh import TaggedMesh
from geometry.sizing import touching_ridges
from variational.quantities import Observer, RidgeLoads

_NEAR = 10e-6  # m, height of the skin at which an attraction of 200 V comes to 1 kPa
_MORE = 2  # ridges on either side that are added at least, or
_PART = 0.25  # this part of those that could touch before


@dataclass(frozen=True)
class RestartRequired:
    """The loads must be gone through again, since an omitted part of the model turned out to matter."""

    reason: str
    scene: Scene
    """With more ridges that can touch, or a finer mesh."""
    options: ModelOptions
    """With more parts of the model."""


class FingerExceeded(RuntimeError):
    """Skin touches beyond the last ridge that the finger has."""


class ContactZone:
    """Checks the skin of a finger."""

    def __init__(self, scene: Scene, options: ModelOptions, body: TaggedMesh, observer: Observer) -> None:
        """Find the skin that cannot touch."""
        self._options = options
        self._scene, self._observer, self._problem = scene, observer, observer.problem
        outside = body.facet_tags.find(tags.OUTER_SKIN)
        self._nodes = fem.locate_dofs_topological(self._problem.V, 1, outside)

    def _lowest_outside(self) -> float:
        """Return the lowest height (m) of the skin that cannot touch."""
        V, u = self._problem.V, self._problem.displacement()
        return self._observer.lowest_outside(V.tabulate_dof_coordinates()[self._nodes, 1] + u[self._nodes, 1])

    def check(self, ridges: list[int], loads: RidgeLoads) -> RestartRequired | None:
        """Check the present state; collective.

        Args:
            ridges: numbers of the ridges that can touch.
            loads: their resultants.

        Returns:
            The scene with more ridges that can touch, where they must; else None.

        Raises:
            FingerExceeded: more ridges must be able to touch, and there are no more.
        """
        if self._scene.laws.mesh is not None:
            self._check_file()
            return None
        wider = self._wider()
        last = [j for j, length in ((ridges[0], loads.length[0]), (ridges[-1], loads.length[-1])) if length > 0]
        lowest = self._lowest_outside()
        if last:
            reason = f"ridge {last[0]}, the last one that is meshed to touch, is in contact"
        elif lowest < (_NEAR if wider else 0.0):
            reason = f"skin beyond the ridges that are meshed to touch is at a height of {lowest:.3g} m"
        else:
            return None
        if wider is None:
            raise FingerExceeded(
                f"{reason}, and the finger has no more ridges; geometry.ridge_count is "
                f"{self._scene.geometry.ridge_count} and must be larger, or f_ext smaller"
            )
        return RestartRequired(reason, wider, self._options)

    def _check_file(self) -> None:
        """Refuse contact of skin that a mesh file does not give to a ridge."""
        lowest = self._lowest_outside()
        if lowest < 0:
            raise FingerExceeded(
                f"skin of the group 'outer skin' is at a height of {lowest:.3g} m; {self._scene.laws.mesh} must have "
                "more ridges, or f_ext be smaller"
            )

    def _wider(self) -> Scene | None:
        """Return the scene with more ridges that can touch, None if all can."""
        finger, size = self._scene.geometry, self._scene.mesh
        last = touching_ridges(finger, size)[-1]
        if last == (finger.ridge_count - 1) // 2:
            return None
        half_arc = (last + max(_MORE, round(_PART * last))) * finger.ridge_wavelength
        return self._scene.model_copy(update={"mesh": size.model_copy(update={"touching_half_arc": half_arc})})
