r"""Sensitivities of a state that does not depend on its path: full slip, or contact without friction.

The unknowns x (displacement, the bone's translation, a mixed element's pressure) and the ridges' air gaps d solve

.. math:: R(x, d; \theta) = 0, \qquad d_j = D(p_j; \theta), \qquad p_j = P_j(x, d; \theta)

with the mean contact pressure p of a ridge and the closure D. At full slip every point in contact is at the limit of
friction, so that its traction follows from the pressure and no history stands in R. The derivative by a number
:math:`\theta` is, with the tangent :math:`K = R_x` of the slipping branch,

.. math:: \dot x = a + B \dot d, \quad K a = -R_\theta, \quad K B = -R_d, \qquad
          (I - D_p (P_x B + P_d)) \, \dot d = D_p (P_x a + P_\theta) + D_\theta

One factorisation serves all right sides, of which there is one for each number and each ridge. The solves are forward
ones: all quantities follow from them, and an adjoint solve would need the gradient of each. The small system is that of
Woodbury: the ridges change K by a matrix of their number's rank. Prescribed rows have the derivative of their values.

:math:`R_\theta` is a central difference quotient of R at fixed x and d: no step of Newton's method and no kink lies
between, since points change neither contact nor direction while x stays. So are :math:`P_\theta, D_\theta`. Numbers
of no layer change R on the skin alone. :math:`R_d` and the derivatives of the skin by x and d are UFL's. A quantity
is a function of the values at the Gauss points, which are moved along their derivatives by some picometres.

As a number changes, points come into contact and leave it one by one. The exact derivative is that of one stair
between, whose largest error is that of the ridges' lengths. So lengths change as the ends of contact move
(:mod:`variational.ends`). A ridge that comes or goes makes a kink or a jump: :attr:`Slopes.up` and ``down``.

Where a number moves the nodes of the mesh, a state has the nodes' places after deformation for its unknowns: then skin
in contact stays where it is as the number changes alone.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray
from petsc4py import PETSc

from variational import jit
from variational.contact.formulation import SurfaceState
from variational.ends import Ends
from variational.numbers import Numbers, impose
from variational.resultants import RidgeLoads
from variational.roughness.closure import air_gaps
from variational.solvers.coupling import AcceptedState, Coupling
from variational.solvers.outcome import NotConverged, linear_failure

Array = NDArray[np.float64]
STEP = 1e-5
"""Part of a number in difference quotients at fixed x; a bulk modulus changes by 25 times that of Poisson's ratio."""
_OF_MOVE = 1e-3  # largest part of a change of the state, of the difference quotients of quantities
_MOVE = 3e-12  # m, by which the augmented gap of a point near the contact moves in those of quantities
_NEAR = 1e-7  # m, augmented gap of such a point at most
_BEHIND = 3e-3  # m, of anchors, so that no point comes near sticking; full slip does not depend on them
_HISTORY = {"anchor", "pressure", "x"}  # on which full slip does not depend
_VALUES = [f.name for f in fields(SurfaceState) if f.name != "history"]


@dataclass(frozen=True)
class Slopes:
    """Derivatives by one number, whose changes are parts of a scale."""

    by_step: dict[str, float]
    """Of each quantity, for one scale of the number."""
    stair: dict[str, float]
    """The same at fixed points in contact: the exact derivative until the next point comes or goes."""
    down: float
    up: float
    """How far the number can fall and rise, in its scale, until a ridge comes or goes, by straight extrapolation."""


Varied = Callable[[float], Numbers]
"""Returns the numbers with one of a scene's changed by a part of its scale; at 0 they are those of the state."""
Measure = Callable[[SurfaceState, RidgeLoads, Array], Mapping[str, float]]
"""Returns quantities of a skin, of the ridges' resultants and of the bone's translation (m), shape (2,); collective."""


def _quotient(values: Callable[[float], Array], step: float) -> Array:
    """Return the derivative at zero by a central difference quotient."""
    return np.asarray((values(step) - values(-step)) / (2 * step))


def refuse(coupling: Coupling) -> None:
    """Refuse a state that depends on its path, or on a history.

    Raises:
        ValueError: why, in one sentence.
    """
    problem = coupling.solver.problem
    history = sorted(set(problem.history.fields) - _HISTORY)
    if history or problem.in_time:
        raise ValueError(f"the state depends on its past ({', '.join(history) or 'time'}), so that it has no slope")
    if problem.interface.formulation.tolerance:
        name = type(problem.interface.formulation).__name__
        raise ValueError(f"contact is {name}, whose multipliers depend on the path; slopes need another formulation")
    if problem.anchor is not None and not coupling.observer.slip(coupling.observer.state())[1]:
        raise ValueError("points stick, so that the state depends on its path and has no slope; full slip has one")


@dataclass(frozen=True)
class _Fixed:
    """Derivatives by one number at fixed unknowns and air gaps."""

    residual: Array
    skin: Array
    """Of the values at the Gauss points."""
    gaps: Array
    """Of the closure's air gaps, at fixed values at the Gauss points."""
    explicit: Array
    """Of the quantities; a zero where none depends on a number but by the skin."""


class Linearised:
    """The derivative of a coupled state of equilibrium, by its numbers; of one use."""

    def __init__(self, coupling: Coupling, measure: Measure) -> None:
        """Compile derivatives, and factorise the tangent of the present state; collective.

        Args:
            coupling: in a state of equilibrium.
            measure: the quantities.

        Raises:
            ValueError: see :func:`refuse`.
            NotConverged: the factorisation failed.
        """
        refuse(coupling)
        self.coupling, self.measure = coupling, measure
        self.solver, self.problem, self.observer = coupling.solver, coupling.solver.problem, coupling.observer
        problem = self.problem
        self._place = place = AcceptedState.of(coupling)
        anchor = place.history["anchor"] + np.sign(place.reaction[0]) * _BEHIND
        self._slid = replace(place, history={**place.history, "anchor": anchor})
        self._charged = coupling.closure is not None and float(problem.voltage.value) != 0.0
        self._du = fem.Function(problem.V)
        ways = [(problem.w, self._du)]
        if problem.pressure:
            self._dp = fem.Function(problem.pressure.unknown.function_space)
            ways.append((problem.pressure.unknown, self._dp))
        self._dd = fem.Function(problem.d_eq.function_space)
        of_gaps = [(problem.d_eq, self._dd)]
        self._ds = None if problem.share is None else fem.Function(problem.d_eq.function_space)
        of_gaps += [] if self._ds is None else [(problem.share, self._ds)]
        ways += of_gaps
        values = [ufl.as_ufl(each) for each in self.observer.evaluated]
        self._along = problem.surface.compile([sum(ufl.derivative(each, *way) for way in ways) for each in values])
        if self._charged:
            by_gaps = sum(ufl.derivative(problem.weak[0], *way) for way in of_gaps)
            self._by_gaps = fem.form(by_gaps, jit_options=jit.OPTIONS)
        on_skin = [each for each in problem.weak[0].integrals() if each.integral_type() == "exterior_facet"]
        self._on_skin = fem.form(ufl.Form(on_skin), jit_options=jit.OPTIONS)
        self._slid.restore(coupling)
        self._factorise()

    def _factorise(self) -> None:
        self._ksp = ksp = PETSc.KSP().create(self.solver.layout.comm)
        self._K = self.solver.iteration.tangent.unshifted()
        ksp.setOperators(self._K)
        ksp.setType(PETSc.KSP.Type.PREONLY)
        pc = ksp.getPC()
        pc.setType(PETSc.PC.Type.LU)
        pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        ksp.setUp()
        self.solver.counts.factorisations += 1
        if pc.getFailedReason():
            self._leave()
            raise NotConverged(linear_failure(pc)[0], False)

    def _leave(self) -> None:
        """Leave the state as it was."""
        self._place.restore(self.coupling)
        self._ksp.destroy()
        self._K.destroy()

    def _solve(self, right: list[Array]) -> list[Array]:
        """Return minus K^-1 of right sides, this rank's parts; collective."""
        layout, sides = self.solver.layout, np.stack(right)
        some = np.any(layout.comm.allgather((sides != 0).any(axis=1)), axis=0)  # numbers of the closure have none
        if not some.any():
            return [*sides]
        size = ((layout.local_size, layout.global_size), (PETSc.DECIDE, int(some.sum())))
        B = PETSc.Mat().createDense(size, array=-sides[some].T, comm=layout.comm)
        X = B.duplicate()
        self._ksp.getPC().getFactorMatrix().matSolve(B, X)
        sides[some] = X.getDenseArray().T
        B.destroy()
        X.destroy()
        return [*sides]

    # -- derivatives at fixed unknowns -----------------------------------------------------------------
    def _fixed(self, varied: Varied) -> "_Fixed":
        """Return the derivatives by a number at fixed unknowns and air gaps; collective."""
        p_c, solver = self._pressures(self._skin), self.solver
        f, x = solver.layout.create_vector(), solver.x.copy()
        sizes = [solver.layout.local_size, _stack(self._skin).size, len(p_c)]
        up, down = varied(STEP), varied(-STEP)
        moves = any(self.problem.mesh.comm.allgather(not np.array_equal(up.places, down.places)))
        part = None if moves or up.solids != down.solids else self._on_skin
        depends = moves or self.problem.interface.adhesion is not None

        def values(step: float) -> Array:
            impose(self.coupling, varied(step))
            if moves:  # the nodes, and by their displacement back to where they are in the state
                displacement = self._displacement - (self.problem.V.tabulate_dof_coordinates()[:, :2] - self._nodes)
                solver.layout.from_nodes(displacement.ravel(), solver.bone, x)
            solver.equations.residual(x, f, part)
            closure = self.coupling.closure if self._charged else None
            p = self._pressures(self._skin) if moves else p_c
            gaps = np.zeros_like(p_c) if closure is None else air_gaps(closure, p)
            loads = self.observer.ridge_loads(self._skin)
            found = self.measure(self._skin, loads, solver.bone) if depends else {"": 0.0}
            return np.concatenate([f.array_r, _stack(self.observer.state()).ravel(), gaps, [*found.values()]])

        residual, skin, gaps, explicit = np.split(_quotient(values, STEP), np.cumsum(sizes))
        return _Fixed(residual, skin.reshape(_stack(self._skin).shape), gaps, explicit)

    def _pressures(self, state: SurfaceState) -> Array:
        return self.observer.ridge_loads(state, self.coupling.by_gap).p_c

    def _closure_slope(self, p_c: Array) -> Array:
        """Return the derivative of the closure's air gaps (m/Pa)."""
        closure = self.coupling.closure
        assert closure is not None
        if (known := closure(p_c).derivative) is not None:
            return np.asarray(known, dtype=float)
        by_part = _quotient(lambda part: air_gaps(closure, p_c * (1 + part)), _OF_MOVE)
        return np.divide(by_part, p_c, out=np.zeros_like(p_c), where=p_c > 0)

    # -- along a change of the state -------------------------------------------------------------------
    def _skin_along(self, dx: Array, dd: Array) -> Array:
        """Return the derivative of the values at the Gauss points along unknowns and air gaps; collective."""
        x = self.solver.layout.create_vector()
        x.array_w[:] = dx
        self.solver.layout.to_nodes(x, self._du.x.array)
        if self.problem.pressure:
            self.solver.layout.to_pressure(x, self._dp.x.array)
        self._set_gaps(dd)
        return self.problem.surface.evaluate(self._along)

    def _set_gaps(self, dd: Array) -> None:
        """Write a change of the air gaps (m), and that of the ridges' shares of the voltage."""
        written, surface = [(self._dd, dd)], self.problem.surface
        share, d_eq = self.problem.interface.share, self.coupling.d_eq
        if self._ds is not None and share is not None:
            written.append((self._ds, _quotient(lambda part: share(d_eq * (1 + part)), _OF_MOVE) / d_eq * dd))
        for function, values in written:
            function.x.array[surface.pairs[:, 0]] = values[surface.ridge]
            function.x.scatter_forward()

    def _results(self, skin: SurfaceState, loads: RidgeLoads, bone: Array) -> Array:
        """Return mean contact pressures (Pa), the quantities, and of each ridge how far it is from the next kink."""
        p_c = self._pressures(skin) if self.coupling.by_gap else loads.p_c
        found = self.measure(skin, loads, bone)
        self._names = [*found]
        return np.concatenate([p_c, [*found.values()], self._margins(skin, loads)])

    def _results_along(self, change: Array, dx: Array, dd: Array) -> Array:
        """Return the derivatives of the results along a change of the skin, of unknowns and of air gaps; collective.

        In two rows: with the ridges' lengths as their ends move, and as they do at fixed points in contact.
        """
        skin, gap = _stack(self._skin), self._skin.gap
        moved = np.abs(change[_VALUES.index("gap")], where=gap < _NEAR, out=np.zeros_like(gap)).max(initial=0.0)
        most = max(self.problem.mesh.comm.allgather(float(moved)))
        step = min(_MOVE / most, _OF_MOVE) if most > 0 else _OF_MOVE
        smooth, d_eq = self._ends.rates(SurfaceState(*change)), self.coupling.d_eq
        vector = self.solver.layout.create_vector()
        vector.array_w[:] = dx
        bone = self.solver.layout.rigid_part(vector)

        def results(part: float) -> Array:
            there = SurfaceState(*(skin + part * change))
            stair = self.observer.ridge_loads(there)
            length = np.where(self._ends.located, self._length + part * smooth, stair.length)
            if self.coupling.by_gap:  # the length below the air gap depends on it
                self.problem.set_air_gaps(d_eq + part * dd)
            both, moved = (replace(stair, length=length), stair), self.solver.bone + part * bone
            return np.stack([self._results(there, each, moved) for each in both])

        found = _quotient(results, step)
        self.coupling.set_air_gaps(d_eq)
        return found

    # -- all numbers -----------------------------------------------------------------------------------
    def slopes(self, varied: Mapping[str, Varied]) -> dict[str, Slopes]:
        """Return the derivatives by each number, and leave the state as it was, with the numbers at 0; collective."""
        try:
            return self._by(varied)
        finally:
            self._leave()

    def _by(self, varied: Mapping[str, Varied]) -> dict[str, Slopes]:
        self._skin = self.observer.state()
        self._ends = Ends(self.problem.surface, self._skin)
        self._length = self.observer.ridge_loads(self._skin).length
        self._nodes = self.problem.V.tabulate_dof_coordinates()[:, :2]
        self._displacement = self.problem.w.x.array.reshape(-1, 2).copy()
        none = np.zeros_like(self.coupling.d_eq)
        unit = [np.eye(len(none))[k] for k in range(len(none) if self._charged else 0)]
        right, f = list[Array](), self.solver.layout.create_vector()
        for each in unit:
            self._set_gaps(each)
            self.solver.equations.forces(self._by_gaps, f)
            right.append(f.array_r.copy())
        fixed = {key: self._fixed(numbers) for key, numbers in varied.items()}
        impose(self.coupling, next(iter(varied.values()))(0.0))
        self._slid.restore(self.coupling)
        solved = self._solve([*right, *(each.residual for each in fixed.values())])
        B, of_numbers = solved[: len(unit)], dict(zip(fixed, solved[len(unit) :], strict=True))
        count, pairs = len(unit), zip(B, unit, strict=True)
        by_gaps = [self._results_along(self._skin_along(b, each), b, each) for b, each in pairs]
        closure_slope = self._closure_slope(self._pressures(self._skin)) if count else none
        found = {}
        for key, a in of_numbers.items():
            both = [*self._results_along(fixed[key].skin + self._skin_along(a, none), a, none)]
            for k, each in enumerate(both) if count else ():
                of_gaps = np.stack([pair[k] for pair in by_gaps])
                loop = np.eye(count) - closure_slope[:, None] * of_gaps[:, :count].T
                both[k] = each + np.linalg.solve(loop, closure_slope * each[:count] + fixed[key].gaps) @ of_gaps
            found[key] = self._slopes([each[len(none) :] for each in both], fixed[key].explicit)
        return found

    def _slopes(self, along: Sequence[Array], explicit: Array) -> Slopes:
        """Return the derivatives of the quantities from those of quantities and margins, in both ways."""
        count = len(self._names)
        smooth, stair = (dict(zip(self._names, map(float, each[:count] + explicit), strict=True)) for each in along)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = -self._margins(self._skin, self.observer.ridge_loads(self._skin)) / along[0][count:]
        ends = ends[np.isfinite(ends)]
        down, up = -ends[ends < 0], ends[ends > 0]
        return Slopes(smooth, stair, float(down.min(initial=np.inf)), float(up.min(initial=np.inf)))

    def _margins(self, skin: SurfaceState, loads: RidgeLoads) -> Array:
        """Return of each ridge its contact force (N/m), or without one the gap of its lowest point (m); collective."""
        surface = self.problem.surface
        gap = np.array([skin.gap[surface.ridge == k].min(initial=np.inf) for k in range(len(surface.ridge_numbers))])
        gap = np.min(surface.mesh.comm.allgather(gap), axis=0)
        return np.asarray(np.where(loads.f_contact > 0, loads.f_contact, gap))


def _stack(skin: SurfaceState) -> Array:
    return np.stack([np.broadcast_to(getattr(skin, name), skin.x.shape) for name in _VALUES])
