r"""Contact resultants: forces and contact length of each ridge and of the skin, summed over facets and all ranks.

The highest pressure on skin in contact comes from mean pressures of facets. Within a facet the pressure of a penalty is
high at both ends and low in the middle, or the other way round, by a per cent and more: the height of the skin is a
polynomial of low degree, and the pressure is that times a large number. The highest value at a Gauss point is therefore
too high. The mean over a facet has no such part. The pressure is taken as the parabola

.. math:: p(t) = \alpha + \beta t + \gamma t^2, \qquad
          \frac{1}{|I_k|} \int_{I_k} p \, dt = p_k, \quad k = -1, 0, 1,

with the same means over three facets :math:`I_k`, as finite volumes reconstruct a density from averages (Colella and
Woodward 1984, doi 10.1016/0021-9991(84)90143-8), where its top lies on the middle one.
"""

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from variational.contact.formulation import SurfaceState
from variational.contact.friction import CONE_ROUNDOFF
from variational.problem import Problem

Array = NDArray[np.float64]
_SAME_PLACE = 1e-12  # m, within which places are the same
_TO_THE_END = 1 + 1e-6  # of half a facet, so that a top between two is on one of them
_GAUSS_SHARE = 0.1  # of a facet: what a Gauss point stands for, at least about


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
    """Downward resultant of the electrostatic attraction (N/m)."""
    f_attraction_x: Array
    f_adhesion: Array
    """Downward resultant of the adhesion without a voltage (N/m)."""
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
        evaluated: what the numbers of a :class:`SurfaceState` are, in their order; UFL.
    """

    def __init__(self, problem: Problem, mirrored: bool = False) -> None:
        """Take the problem.

        Args:
            problem: whose surface is evaluated.
            mirrored: see the attribute.
        """
        self.problem, self.surface, self.mirrored = problem, problem.surface, mirrored
        c, place = problem.contact, [problem.x, problem.y, problem.opening]
        self.evaluated = [*place, c.new_anchor, c.p_n, c.t_t, problem.p_el, *problem.area, c.limit]
        self._rules: dict[str, int] = {}  # of history: place among what is compiled
        self._beside: list[tuple[NDArray[np.int64], NDArray[np.int64]]] = []  # each ridge's facets' neighbours

    def state(self) -> SurfaceState:
        """Evaluate the surface in the problem's current state, with what it leaves in the history; collective."""
        skin = self.problem.history.skin
        if len(skin) > len(self._rules):
            found = [*self.evaluated]
            found += [field.update for field in skin if field.update not in found]
            self._rules = {field.name: found.index(field.update) for field in skin}
            self._compiled = self.surface.compile(found)
        values = self.surface.evaluate(self._compiled)
        history = {name: values[k] for name, k in self._rules.items()}
        return replace(SurfaceState(*values[: len(self.evaluated)]), history=history)

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
            f_limit=integrate(s.limit),
            f_attraction=-integrate(s.p_el * s.area_y),
            f_attraction_x=integrate(s.p_el * s.area_x),
            f_adhesion=-integrate(self.adhesion(s) * s.area_y),
            length=self.surface.sum_over_facets(self.surface.closed_length(s.x, s.y, gap)),
        )

    def adhesion(self, state: SurfaceState) -> Array:
        """Return the attraction without a voltage (Pa of current area) at this rank's points."""
        law = self.problem.interface.adhesion
        return np.zeros_like(state.y) if law is None else np.asarray(law.pressure(state.y))

    def slip(self, state: SurfaceState) -> tuple[float, bool]:
        """Return the part of the contact points at the friction cone, and whether all slip one way."""
        loaded, limit = state.touching, state.limit
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

        The module's docstring has how they are found.
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
        of = [ridge == k for k in range(len(surface.ridge_numbers))]
        self._beside = self._beside or [neighbours(ends[k]) for k in of]
        pairs = zip(of, self._beside, strict=True)
        return np.array([highest(force[k], width[k], closed[k], beside) for k, beside in pairs])

    def penetration(self, state: SurfaceState) -> float:
        """Return how deep the skin is in the screen where it bears pressure (m), the largest of all ranks' points."""
        deepest = float(np.max(-state.y, where=state.p_n > 0, initial=0.0))
        return float(np.max(self.problem.mesh.comm.allgather(deepest)))


def highest(force: Array, width: Array, closed: Array, beside: tuple[NDArray[np.int64], NDArray[np.int64]]) -> float:
    """Return the highest pressure (Pa), zero without contact.

    Args:
        force: contact force per length of each facet (N/m), shape (facets,).
        width: current length of each facet (m).
        closed: its part in contact (m).
        beside: :func:`neighbours` of the facets.

    A mean counts, too: of a facet that is partly in contact that over this part.
    """
    touching = (force > 0) & (closed > 0)
    if not touching.any():
        return 0.0
    before, after = beside
    mean = force / width
    inside = np.flatnonzero(touching & (before >= 0) & (after >= 0) & (closed >= 0.5 * width))
    around = np.stack([before[inside], inside, after[inside]], axis=1)
    means = force[touching] / np.maximum(closed, _GAUSS_SHARE * width)[touching]
    return float(np.concatenate([means, _tops(mean[around], width[around])]).max())


def neighbours(ends: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the facet beyond each facet's first and second end, -1 where there is none.

    Args:
        ends: reference places of the facets' ends (m), shape (facets, 2, 2).
    """
    places = np.rint(ends.reshape(-1, 2) / _SAME_PLACE).astype(np.int64)
    _, vertex = np.unique(places, axis=0, return_inverse=True)
    vertex = np.asarray(vertex).ravel()
    order = np.argsort(vertex, kind="stable")
    same = np.flatnonzero(vertex[order[1:]] == vertex[order[:-1]])
    beyond = np.full(len(vertex), -1)
    beyond[order[same]], beyond[order[same + 1]] = order[same + 1] // 2, order[same] // 2
    return beyond[::2], beyond[1::2]


def _tops(mean: Array, width: Array) -> Array:
    """Return the highest values of parabolas with given means over three facets, of those that have it on the middle.

    Args:
        mean: (Pa), shape (parabolas, 3).
        width: of the facets (m), likewise.
    """
    half = width[:, 1] / 2
    edges = np.stack([-half - width[:, 0], -half, half, half + width[:, 2]], axis=1)
    a, b = edges[:, :-1], edges[:, 1:]
    moments = np.stack([np.ones_like(a), (a + b) / 2, (a * a + a * b + b * b) / 3], axis=2)
    alpha, beta, gamma = np.linalg.solve(moments, mean[:, :, None])[:, :, 0].T
    on = (gamma < 0) & (np.abs(beta) <= -2 * gamma * half * _TO_THE_END)
    return np.asarray(alpha[on] - beta[on] ** 2 / (4 * gamma[on]))
