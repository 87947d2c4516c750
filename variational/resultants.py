"""Contact resultants: forces and contact length of each ridge and of the skin, summed over facets and all ranks."""

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from variational.contact.formulation import SurfaceState
from variational.contact.friction import CONE_ROUNDOFF
from variational.highest import highest

if TYPE_CHECKING:
    from variational.problem import Problem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RidgeLoads:
    """Resultants of each ridge, shape (ridges,) each, the same on every rank."""

    f_contact: Array
    """Contact force per length (N/m)."""
    f_friction: Array
    """Friction on the skin (N/m), positive towards x > 0."""
    f_limit: Array
    """Largest friction that the law allows under the contact pressure (N/m): at full slip that on the skin."""
    f_attraction: Array
    """Downward resultant of the attraction (N/m)."""
    f_attraction_x: Array
    length: Array
    """Current length in contact, p_n > 0 (m); its ends are located inside facets."""

    def whole(self) -> "RidgeLoads":
        """Return the resultants of all ridges of a body whose half at x >= 0 these are of, ridge 0's from its half."""

        def both(name: str) -> Array:
            v = getattr(self, name)
            sign = -1.0 if name in ("f_friction", "f_attraction_x") else 1.0
            return np.concatenate([sign * v[:0:-1], [v[0] + sign * v[0]], v[1:]])

        return RidgeLoads(**{field.name: both(field.name) for field in fields(RidgeLoads)})

    @property
    def p_c(self) -> Array:
        """Mean contact pressure over the length in contact (Pa of current area), zero without contact."""
        return np.divide(self.f_contact, self.length, out=np.zeros_like(self.length), where=self.length > 0)


class Observer:
    """Evaluates the surface of a problem.

    Attributes:
        mirrored: whether it is that of the half of a body whose other half is the mirror image.
    """

    def __init__(self, problem: "Problem", mirrored: bool = False) -> None:
        """Take the problem.

        Args:
            problem: whose surface is evaluated.
            mirrored: see the attribute.
        """
        self.problem, self.surface, self.mirrored = problem, problem.surface, mirrored
        c, area = problem.contact, problem.area
        self._evaluated = [problem.x, problem.y, problem.opening, c.new_anchor, c.p_n, c.t_t, problem.p_el, *area]
        self._rules: dict[str, int] = {}  # of history: place among what is compiled

    def state(self) -> SurfaceState:
        """Evaluate the surface in the problem's current state, with what it leaves in the history; collective."""
        skin = self.problem.history.skin
        if len(skin) > len(self._rules):
            found = [*self._evaluated]
            found += [field.update for field in skin if field.update not in found]
            self._rules = {field.name: found.index(field.update) for field in skin}
            self._compiled = self.surface.compile(found)
        values = self.surface.evaluate(self._compiled)
        history = {name: values[k] for name, k in self._rules.items()}
        return replace(SurfaceState(*values[: len(self._evaluated)]), history=history)

    def ridge_loads(self, state: SurfaceState | None = None, by_gap: bool = False) -> RidgeLoads:
        """Return the ridges' resultants.

        Args:
            state: an evaluated surface; by default the current one.
            by_gap: count as contact what is lower than the ridge's d_eq, not what bears pressure.
        """
        s = state or self.state()
        gap = s.gap
        if by_gap:
            gap = s.y - self.problem.d_eq.x.array[self.surface.pairs[:, 0], None]
        integrate = self.surface.per_ridge
        return RidgeLoads(
            f_contact=integrate(s.p_n),
            f_friction=integrate(s.t_t),
            f_limit=integrate(self.limit(s)),
            f_attraction=-integrate(s.p_el * s.area_y),
            f_attraction_x=integrate(s.p_el * s.area_x),
            length=self.surface.sum_over_facets(self.surface.closed_length(s.x, s.y, gap)),
        )

    def limit(self, state: SurfaceState) -> Array:
        """Return the largest friction that the law allows (Pa of reference area) at this rank's points."""
        law = self.problem.interface.friction
        return np.zeros_like(state.p_n) if law is None else law.limit_in(state)

    def slip(self, state: SurfaceState) -> tuple[float, bool]:
        """Return the part of the contact points at the friction cone, and whether all slip one way."""
        loaded, limit = state.p_n > 0, self.limit(state)
        # The law gives plus or minus the limit where it slips; the factor covers roundoff alone.
        forth = loaded & (state.t_t >= limit * (1 - CONE_ROUNDOFF))
        back = loaded & (-state.t_t >= limit * (1 - CONE_ROUNDOFF))
        count = np.array([loaded.sum(), forth.sum(), back.sum(), (forth | back).sum()])
        total = np.empty_like(count)
        self.problem.mesh.comm.Allreduce(count, total)
        if total[0] == 0:
            return 0.0, False
        one_way = total[0] in (total[1], total[2])
        if self.mirrored:  # what slips forth here slips back there
            one_way = total[0] == total[1] == total[2]
        return float(total[3] / total[0]), bool(one_way)

    def highest_pressures(self, state: SurfaceState) -> Array:
        """Return each ridge's highest contact pressure (Pa of current area), shape (ridges,); collective.

        :mod:`variational.highest` has how they are found.
        """
        surface, density = self.surface, (state.p_n, np.hypot(state.area_x, state.area_y))
        force, width = ((each * surface.measure_at) @ surface.weights for each in density)
        closed = np.minimum(surface.closed_length(state.x, state.y, state.gap), width)
        mine = force, width, closed, surface.ends(), surface.ridge
        ranks = self.problem.mesh.comm.allgather(mine)
        force, width, closed, ends, ridge = (np.concatenate(each) for each in zip(*ranks, strict=True))
        if self.mirrored:
            force, width, closed, ridge = (np.concatenate([each, each]) for each in (force, width, closed, ridge))
            ends = np.concatenate([ends, ends * [-1.0, 1.0]])
        of = (ridge == k for k in range(len(surface.ridge_numbers)))
        return np.array([highest(force[k], width[k], closed[k], ends[k]) for k in of])

    def penetration(self, state: SurfaceState) -> float:
        """Return how deep the skin is in the screen where it bears pressure (m), the largest of all ranks' points."""
        deepest = float(np.max(-state.y, where=state.p_n > 0, initial=0.0))
        return float(np.max(self.problem.mesh.comm.allgather(deepest)))
