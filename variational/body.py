"""A body over the screen, set up once: surface, weak form, solver, loop over the scales and path of loads.

Models of fingers, of ridges and of verification bodies share this set-up. The mesh comes from outside, with its tags.
"""

from collections.abc import Callable, Mapping
from typing import Protocol

import dolfinx
import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from variational.contact.formulation import SurfaceState
from variational.contact.interface import Interface
from variational.materials.material import Material
from variational.problem import Problem
from variational.resultants import Observer
from variational.roughness.closure import Closure
from variational.solvers.continuation import Attempt, Continuation, Target
from variational.solvers.coupling import Coupling
from variational.solvers.equations import Equations
from variational.solvers.newton import Solver
from variational.state import Skin
from variational.surface import Surface

Array = NDArray[np.float64]
Facets = NDArray[np.int32]


class Tagged(Protocol):
    """A mesh (m) with tags of its layers and facets."""

    @property
    def mesh(self) -> dolfinx.mesh.Mesh:
        """Straight-sided triangles."""
        ...

    @property
    def cell_tags(self) -> dolfinx.mesh.MeshTags:
        """Tags of layers."""
        ...

    @property
    def facet_tags(self) -> dolfinx.mesh.MeshTags:
        """Tags of facets."""
        ...

    @property
    def rim(self) -> Facets:
        """Facets of this rank that are glued to the bone."""
        ...

    def ridge_tags(self) -> Mapping[int, int]:
        """Return the facet tag of each ridge's number, in order, the same on every rank."""
        ...


class Body:
    """A layered body pressed and dragged over the screen.

    Attributes:
        surface: the skin that can touch.
        problem: the weak form.
        solver: solves it for given loads.
        observer: evaluates its surface.
        coupling: joins it to the microscale.
        continuation: leads it along targets.
    """

    def __init__(
        self,
        tagged: Tagged,
        solids: Mapping[int, Material],
        interface: Interface,
        closure: Closure | None = None,
        *,
        element: str = "P2",
        points: int = 4,
        force_scale: float = 1.0,
        tolerance: float = 1e-9,
        held: Facets | None = None,
        moving_sides: Facets | None = None,
        mirror: Facets | None = None,
        coupling_tolerance: float = 1e-6,
        coupling_cap: int = 30,
        by_gap: bool = False,
        on_accept: Callable[[Target, float, Attempt], bool | None] = lambda target, part, attempt: None,
        touch_depth: float = 5e-6,
        step_scale: float = 1.0,
    ) -> None:
        """Set up the unloaded body; collective.

        Args:
            tagged: its mesh.
            solids: material of each layer's tag.
            interface: laws of the contact.
            closure: the microscale; None where there is never a voltage.
            element: a name of :data:`variational.element.ELEMENTS`.
            points: Gauss points on a facet.
            force_scale: force per length (N/m) in which residuals are measured.
            tolerance: see :class:`variational.solvers.newton.Solver`.
            held: facets that do not move sideways.
            moving_sides: facets that move sideways with the bone, in place of ``held``; see
                :class:`variational.solvers.equations.Equations`.
            mirror: facets at x = 0 of the half of a body that is its own mirror image.
            coupling_tolerance: relative error of air gaps at which the loop over the scales ends.
            coupling_cap: most iterations of that loop.
            by_gap: see :class:`variational.solvers.coupling.Coupling`.
            on_accept: called after each accepted step, see :class:`variational.solvers.continuation.Continuation`.
            touch_depth: how far the bone is lowered by displacement before force takes over (m).
            step_scale: factor on the largest steps of force, voltage and displacement.

        Raises:
            ValueError: a cell has two facets on the surface.
        """
        self.surface = Surface(tagged.mesh, tagged.facet_tags, tagged.ridge_tags(), points)
        self.problem = Problem(tagged.mesh, tagged.cell_tags, self.surface, solids, interface, element)
        fixed = [] if held is None else [(2 * fem.locate_dofs_topological(self.problem.V, 1, held), 0.0)]
        equations = Equations(self.problem, tagged.rim, fixed, moving_sides, mirror)
        self.solver = Solver(equations, force_scale, tolerance)
        self.observer = Observer(self.problem, mirror is not None)
        self.coupling = Coupling(self.solver, self.observer, closure, coupling_tolerance, coupling_cap, by_gap)
        self.continuation = Continuation(self.coupling, on_accept, touch_depth, step_scale)


class Points:
    """Brings the skin to every rank, ridge by ridge and from left to right, whatever ranks hold it."""

    def __init__(self, made: Body) -> None:
        self._surface = surface = made.surface
        unloaded = made.continuation.surface_state
        x, y, ridge = self._gather(unloaded.x, unloaded.y, np.broadcast_to(surface.ridge[:, None], unloaded.x.shape))
        self._flip = x[:, 0] > x[:, -1]
        middle = ((z[:, 0] + z[:, -1]) / 2 for z in (y, x))
        self._order = np.lexsort((*middle, ridge[:, 0]))
        self._ridge = np.array(surface.ridge_numbers)[ridge[self._order, 0].astype(int)]

    def _gather(self, *mine: Array) -> Array:
        stacked = np.stack([np.asarray(values, dtype=np.float64) for values in mine])
        return np.concatenate(self._surface.mesh.comm.allgather(stacked), axis=1)

    def gather(self, state: SurfaceState) -> Skin:
        """Return the skin in a state; collective."""
        stretch = np.hypot(state.area_x, state.area_y)  # current per reference area
        pull = np.broadcast_to(state.p_el, state.x.shape)
        values = self._gather(state.x, state.y, state.p_n / stretch, state.t_t / stretch, pull)
        values[:, self._flip] = values[:, self._flip, ::-1]
        return Skin(self._ridge, *values[:, self._order])
