r"""Where the energy goes: the balance of stored energy, work and friction from one accepted state to the next.

At an equilibrium the residual (:mod:`~variational.problem`) is work free but for the bone, so along a path of them

.. math:: d\Big(E + \int \tfrac12 \epsilon_n \langle -y \rangle^2 + \tfrac12 \epsilon_t (u_x - s)^2 \,dS\Big)
          = -R \cdot du^{bone} + \frac{\partial E}{\partial U^2}\, dU^2
          + \sum_j \frac{\partial E}{\partial d_{eq,j}}\, d d_{eq,j} - \int |t_t| \, |ds| \,dS
          - \int \sum_i Q_i : dE \,dX

with E strain energy and the attraction's potential, R the force on the bone, s the friction's anchor, Q_i the stresses
of viscous branches and dE the change of Green's strain (:mod:`~variational.relaxation`). The potential is
proportional to U^2; its derivative is the work of the voltage source less what the charged gap keeps. An air gap that
follows the pressure (:mod:`~variational.solvers.coupling`) does work as well. Work is taken by the trapezoidal rule,
that of the air gaps as the mean of the energy's changes at both shapes: an air gap may jump tenfold while the skin
stays. A point slips only while it is at the limit of the friction law, so its traction is the mean of the limits at
both ends, whatever it bore before it slipped: that is of second order along smooth paths, as the rest is, and right
where a step spans sticking and slipping or a reversal. What is left over,

.. math:: \text{released} = \text{external} + \text{voltage} + \text{air gap} - \Delta \text{stored} - \text{dissipated}
          - \text{viscous}

vanishes with the square of the step on a smooth path. At a jump, where the body moves without the loads, it is the
energy that a viscous or inertial body dissipates (Mielke and Roubicek 2015, doi 10.1007/978-1-4939-2706-7), but for
the error of the works in a step that jumps, which falls with the step alone: it is not known where in the step the jump
took place. Each work then lies between that with the forces before and that with the forces after, so that

.. math:: |\text{error}| \le \tfrac12 \Big( |\Delta R| \cdot |\Delta u^{bone}|
          + \Big|\Delta \frac{\partial E}{\partial U^2}\, \Delta U^2\Big| + |\Delta W^{gap}|
          + \int |\Delta t_{max}| |\Delta s| \,dS\Big)

with :math:`\Delta W^{gap}` the difference of the air gaps' works at both shapes, and s the slip, of what slid on both
sides of the jump. Where this error is larger than what is released even the sign is lost; smaller steps tell.
"""

from dataclasses import dataclass

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray

from variational.attraction.dielectric import VACUUM_PERMITTIVITY
from variational.attraction.electroadhesion import ELECTROSTATIC
from variational.contact.formulation import SurfaceState
from variational.problem import Problem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Balance:
    """Energies per length (J/m) of one accepted step; work is done on the body."""

    stored: float
    """Strain, attraction and contact springs after the step."""
    change: float
    """Of what is stored."""
    external: float
    """Work of the bone."""
    voltage: float
    """Work of the voltage at frozen shape."""
    air_gap: float
    """Work of the changing equivalent air gaps at frozen shape."""
    dissipation: float
    """Spent by friction, >= 0."""
    viscous: float
    """Work done on the branches of viscous layers, which store and dissipate it; 0 without such layers."""
    viscous_dissipation: float
    """Dissipated by these branches, >= 0."""
    released_error: float
    """Bound of the error of :attr:`released` in a step that jumps; far above it on a smooth path."""

    @property
    def released(self) -> float:
        """What the loads' work leaves unexplained: the energy released by a jump, otherwise the step's error."""
        return self.external + self.voltage + self.air_gap - self.change - self.dissipation - self.viscous


@dataclass(frozen=True)
class _State:
    stored: float
    bone: Array
    reaction: Array
    square: float  # U^2
    d_eq: Array
    surface: SurfaceState
    viscous: tuple[float, float]  # work so far, dissipation of the last step


class EnergyBook:
    """Keeps the energies of accepted states; only reads the problem."""

    def __init__(
        self, problem: Problem, surface: SurfaceState, bone: Array, reaction: Array, d_eq: Array, copies: int = 1
    ) -> None:
        """Start from an equilibrium; arguments as in :meth:`step`, and of how many copies of it the body is made.

        Raises:
            ValueError: there is an attraction, and not the electrostatic one, the only one with a potential here.
        """
        if problem.interface.attraction not in (None, ELECTROSTATIC):
            raise ValueError("the energy balance has the potential of the electrostatic attraction only")
        self._problem, self._copies = problem, copies
        self._last = self._state(surface, bone, reaction, d_eq)

    def _state(self, surface: SurfaceState, bone: Array, reaction: Array, d_eq: Array) -> _State:
        problem, integrate = self._problem, self._problem.surface.per_ridge
        bulk = problem.mesh.comm.allreduce(float(fem.assemble_scalar(problem.energy)), op=MPI.SUM)
        work, lost = (0.0, 0.0) if problem.spent is None else problem.spent()
        springs = float(integrate(problem.interface.formulation.stored(surface)).sum())
        square = float(problem.voltage.value) ** 2
        return _State(
            self._copies * (bulk + springs),
            np.array(bone),
            np.array(reaction),
            square,
            np.array(d_eq),
            surface,
            (self._copies * work, self._copies * lost),
        )

    def _potential(self, surface: SurfaceState, d_eq: Array) -> Array:
        """Return the attraction's potential (J/m) at 1 V by ridge, shape (ridges,).

        It is :func:`variational.attraction.electroadhesion.potential` in NumPy.
        """
        y, d = surface.y, d_eq[self._problem.surface.ridge, None]
        near, h_0 = np.minimum(y, d), self._problem.interface.h_0
        g = h_0 + np.maximum(y, d)
        phi = -VACUUM_PERMITTIVITY / 2 * (1 / g + (d - near) / g**2)
        if self._problem.interface.share is not None:
            phi *= self._problem.interface.share(d_eq)[self._problem.surface.ridge, None] ** 2
        width = -surface.area_y  # current dx per reference length
        return self._copies * self._problem.surface.per_ridge(phi * width)

    def step(self, surface: SurfaceState, bone: Array, reaction: Array, d_eq: Array) -> Balance:
        """Close the book on a step; collective.

        Args:
            surface: the skin in the state accepted, as solved, before its friction history moved on.
            bone: its translation (m), shape (2,).
            reaction: force per length of the body on the bone (N/m), shape (2,).
            d_eq: air gap of each ridge in that state (m), shape (ridges,).
        """
        a, b = self._last, self._state(surface, bone, reaction, d_eq)
        self._last = b
        # The potential at the shapes (rows) and air gaps (columns) before and after, by ridge.
        phi = np.zeros((2, 2, len(d_eq)))
        if self._problem.interface.attraction:
            phi[:] = [[self._potential(shape.surface, gap.d_eq) for gap in (a, b)] for shape in (a, b)]
        gaps = np.array([[a.square], [b.square]]) * (phi[:, 1] - phi[:, 0])
        charges = np.stack([phi[0, 0], phi[1, 1]]) * (b.square - a.square)
        slid, unsure = self._friction(a.surface, b.surface)
        unsure += float(np.abs(b.reaction - a.reaction) @ np.abs(b.bone - a.bone)) / 2
        unsure += float(np.abs(np.diff([charges, gaps], axis=1)).sum()) / 2
        return Balance(
            stored=b.stored,
            change=b.stored - a.stored,
            external=-float((a.reaction + b.reaction) / 2 @ (b.bone - a.bone)),
            voltage=float(charges.sum()) / 2,
            air_gap=float(gaps.sum()) / 2,
            dissipation=slid,
            viscous=b.viscous[0] - a.viscous[0],
            viscous_dissipation=b.viscous[1],
            released_error=unsure,
        )

    def _friction(self, a: SurfaceState, b: SurfaceState) -> tuple[float, float]:
        """Return what friction spends (J/m), and by how much that may be wrong in a step that jumps."""
        law = self._problem.interface.friction
        if law is None:
            return 0.0, 0.0
        # A point without pressure does not slip.
        slip = np.where(b.touching, np.abs(self._problem.interface.formulation.slip(a, b)), 0.0)
        integrate = self._problem.surface.per_ridge
        found = law.dissipated(a.limit, b.limit, slip)
        spent, unsure = (self._copies * float(integrate(each).sum()) for each in found)
        return spent, unsure
