"""What the contact cases share: a body over the screen, led through loads, and what it bears."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from geometry import tags
from geometry.mesh import load
from variational.body import Body
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.materials.material import Material
from variational.problem import Interface
from variational.roughness.closure import AirGap, Closure
from variational.solvers.continuation import Continuation

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Smooth(Closure):
    """A screen and skin without roughness: one air gap (m) at any pressure."""

    d_eq: float

    def __call__(self, p_c: ArrayLike) -> AirGap:
        """Return the air gap, which does not follow the pressure."""
        return AirGap(self.d_eq + 0 * np.asarray(p_c, dtype=np.float64))


def over_screen(
    build: Callable[[], float],
    solid: Material,
    interface: Interface,
    force: float,
    element: str = "P2",
    held: bool = False,
    d_eq: float = 1e-6,
    tolerance: float = 1e-9,
    **steps: Any,
) -> Continuation:
    """Return a body over the screen, unloaded.

    Args:
        build: makes the mesh.
        solid: what the body is made of.
        interface: laws of the contact.
        force: what its forces are like (N/m).
        element: a name of :data:`variational.element.ELEMENTS`.
        held: whether the sides may not move sideways.
        d_eq: air gap (m).
        tolerance: part of ``force`` at which solves end.
        steps: further arguments of :class:`variational.body.Body`.
    """
    body = load(MPI.COMM_SELF, build)
    sides = body.facets(tags.SIDES) if held else None
    return Body(
        body, {tags.STRATUM_CORNEUM: solid}, interface, Smooth(d_eq), element=element, force_scale=force,
        tolerance=tolerance, held=sides, **steps,
    ).continuation  # fmt: skip


def formulations(stiffness: float, depth: float) -> dict[str, Formulation]:
    """Return each way of contact by name.

    Args:
        stiffness: of the skin over a facet's length (Pa/m).
        depth: penetration (m) that the augmented Lagrangian leaves.
    """
    return {
        "penalty": Penalty(100 * stiffness, 10 * stiffness),
        "Nitsche 1": Nitsche(100.0, 1),
        "Nitsche 0": Nitsche(10.0, 0),
        "Nitsche -1": Nitsche(10.0, -1),
        "augmented Lagrangian": AugmentedLagrangian(100 * stiffness, 10 * stiffness, depth),
    }


def profile(run: Continuation, values: NDArray[Any]) -> tuple[Array, NDArray[Any]]:
    """Return abscissae (m) of the accepted skin's points, from left to right, and values there."""
    x = run.surface_state.x.ravel()
    order = np.argsort(x)
    return x[order], values.ravel()[order]


def plane_strain_modulus(young: float, poisson: float) -> float:
    """Return E* (Pa) against a rigid plane."""
    return young / (1 - poisson**2)
