r"""Exact sensitivities of a state that does not depend on its path: full slip, or contact without friction.

The unknowns x (displacement, the bone's translation, a mixed element's pressure) and the ridges' air gaps d solve

.. math:: R(x, d; \theta) = 0, \qquad d_j = D(p_j; \theta), \qquad p_j = P_j(x, d; \theta)

with the mean contact pressure p of a ridge and the closure D. At full slip every point in contact is at the limit of
friction, so that its traction follows from the pressure and no history stands in R. The derivative by a number
:math:`\theta` is, with the tangent :math:`K = R_x` of the slipping branch,

.. math:: \dot x = a + B \dot d, \quad K a = -R_\theta, \quad K B = -R_d, \qquad
          (I - D_p (P_x B + P_d)) \, \dot d = D_p (P_x a + P_\theta) + D_\theta

One factorisation serves all right sides, of which there is one for each number and each ridge. They are solved
together. The solves are forward ones: all quantities follow from them, and the numbers are few. (An adjoint solve for
each quantity has the same factorisation; it would need the gradient of each quantity.) The small system is that of
Woodbury: the ridges change K by a matrix of their number's rank. Rows that are prescribed have the derivative of what
is prescribed.

:math:`R_\theta` is a central difference quotient of R at fixed x and d: no step of Newton's method and no kink lies
between, since points change neither contact nor direction while x stays. So are :math:`P_\theta, D_\theta`. Numbers
of no layer change R on the skin alone. :math:`R_d` and the derivatives of the skin by x and d are UFL's. A quantity
is a function of the values at the Gauss points, which are moved along their derivatives by some picometres.

The derivative is that with the points in contact as they are. As a number changes, points come and go one by one, and
the quantity is smooth between. A ridge that comes or goes makes a kink or a jump: :attr:`Slopes.up` and ``down``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray
from petsc4py import PETSc

from variational import jit
from variational.contact.formulation import SurfaceState
from variational.contact.interface import Interface
from variational.materials.material import Material
from variational.roughness.closure import Closure, air_gaps
from variational.solvers.coupling import AcceptedState, Coupling
from variational.solvers.outcome import NotConverged, linear_failure
from variational.solvers.target import Control

Array = NDArray[np.float64]
STEP = 1e-5
"""Part of a number in difference quotients at fixed x; a bulk modulus changes by 25 times that of Poisson's ratio."""
_OF_MOVE = 1e-3  # largest part of a change of the state, of the difference quotients of quantities
_MOVE = 3e-12  # m, by which the augmented gap of a point near the contact moves in those of quantities
_NEAR = 1e-7  # m, augmented gap of such a point at most
_SLIPS = -0.5  # guess: a point whose trial traction is above half its limit slips on
_HISTORY = {"anchor", "pressure", "x"}  # on which full slip does not depend
_VALUES = [f.name for f in fields(SurfaceState) if f.name != "history"]


@dataclass(frozen=True)
class Numbers:
    """All that a state of equilibrium depends on, but for the shape of the body; the voltage in V."""

    solids: Mapping[int, Material]
    """Material of each layer's tag."""
    interface: Interface
    closure: Closure | None
    control: Control
    voltage: float


@dataclass(frozen=True)
class Slopes:
    """Derivatives by one number, whose unit step is :attr:`Varied.scale`."""

    by_step: dict[str, float]
    """Of each quantity, for one scale of the number."""
    down: float
    up: float
    """How far the number can fall and rise, in its scale, until a ridge comes or goes, by straight extrapolation."""


Varied = Callable[[float], Numbers]
"""Returns the numbers with one of a scene's changed by a part of its scale; at 0 they are those of the state."""
Measure = Callable[[SurfaceState, Array], Mapping[str, float]]
"""Returns quantities of a skin and of the bone's translation (m), shape (2,); collective."""


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


def impose(coupling: Coupling, numbers: Numbers) -> None:
    """Give a problem other numbers, at the unknowns and air gaps that it has; collective.

    Raises:
        ValueError: a law is of another kind than before.
    """
    problem = coupling.solver.problem
    problem.set_interface(numbers.interface)
    problem.set_solids({tag: numbers.solids[tag] for tags in problem.laws for tag in tags})
    problem.voltage.value, coupling.solver.control = numbers.voltage, replace(numbers.control)
    coupling.closure = numbers.closure
    coupling.set_air_gaps(coupling.d_eq)


@dataclass(frozen=True)
class _Fixed:
    """Derivatives by one number at fixed unknowns and air gaps."""

    residual: Array
    skin: Array
    """Of the values at the Gauss points."""
    gaps: Array
    """Of the closure's air gaps."""
    explicit: Array
    """Of the quantities; empty where none depends on a number but by the skin."""


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
        self._place, self._guess = AcceptedState.of(coupling), float(problem.guess.value)
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
        problem.guess.value = _SLIPS
        self.solver.equations.to_fields(self.solver.x)
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
        self.problem.guess.value = self._guess
        self._ksp.destroy()
        self._K.destroy()

    def _solve(self, right: list[Array]) -> list[Array]:
        """Return minus K^-1 of right sides, this rank's parts; collective."""
        local = self.solver.layout.local_size
        size = ((local, self.solver.layout.global_size), (PETSc.DECIDE, len(right)))
        B = PETSc.Mat().createDense(size, array=-np.stack(right, axis=1), comm=self.solver.layout.comm)
        X = B.duplicate()
        self._ksp.getPC().getFactorMatrix().matSolve(B, X)
        found = [*X.getDenseArray().T.copy()]
        B.destroy()
        X.destroy()
        return found

    # -- derivatives at fixed unknowns -----------------------------------------------------------------
    def _fixed(self, varied: Varied) -> "_Fixed":
        """Return the derivatives by a number at fixed unknowns and air gaps; collective."""
        p_c, solver = self._pressures(self._skin), self.solver
        f = solver.layout.create_vector()
        sizes = [solver.layout.local_size, _stack(self._skin).size, len(p_c)]

        part = self._on_skin if varied(STEP).solids == varied(-STEP).solids else None

        def values(step: float) -> Array:
            impose(self.coupling, varied(step))
            solver.equations.residual(solver.x, f, part)
            closure = self.coupling.closure if self._charged else None
            gaps = np.zeros_like(p_c) if closure is None else air_gaps(closure, p_c)
            found = self.measure(self._skin, solver.bone) if self.problem.interface.adhesion else {}  # else without
            return np.concatenate([f.array_r, _stack(self.observer.state()).ravel(), gaps, [*found.values()]])

        residual, skin, gaps, explicit = np.split(_quotient(values, STEP), np.cumsum(sizes))
        return _Fixed(residual, skin.reshape(_stack(self._skin).shape), gaps, explicit)

    def _pressures(self, state: SurfaceState) -> Array:
        return self.observer.ridge_loads(state, self.coupling.by_gap).p_c

    def _pressures_along(self, change: Array, dd: Array) -> Array:
        """Return the derivative of the ridges' mean contact pressures along a change of the skin and of air gaps."""
        d_eq, by_gap = self.coupling.d_eq, self.coupling.by_gap

        def values(skin: SurfaceState, part: float) -> Array:
            if by_gap:  # the length below the air gap depends on it
                self.problem.set_air_gaps(d_eq + part * dd)
            return self._pressures(skin)

        found = self._along_skin(values, change)
        self.coupling.set_air_gaps(d_eq)
        return found

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

    def _along_skin(self, values: Callable[[SurfaceState, float], Array], change: Array) -> Array:
        """Return the derivative of a function of the skin along a change of it; collective."""
        skin = _stack(self._skin)
        gap = _VALUES.index("gap")
        moved = np.abs(change[gap], where=skin[gap] < _NEAR, out=np.zeros_like(skin[gap])).max(initial=0.0)
        most = max(self.problem.mesh.comm.allgather(float(moved)))
        step = min(_MOVE / most, _OF_MOVE) if most > 0 else _OF_MOVE
        return _quotient(lambda part: values(SurfaceState(*(skin + part * change)), part), step)

    # -- all numbers -----------------------------------------------------------------------------------
    def slopes(self, varied: Mapping[str, Varied]) -> dict[str, Slopes]:
        """Return the derivatives by each number, and leave the state as it was, with the numbers at 0; collective."""
        try:
            return self._by(varied)
        finally:
            self._leave()

    def _by(self, varied: Mapping[str, Varied]) -> dict[str, Slopes]:
        self._skin = self.observer.state()
        none = np.zeros_like(self.coupling.d_eq)
        unit = [np.eye(len(none))[k] for k in range(len(none) if self._charged else 0)]
        right, f = list[Array](), self.solver.layout.create_vector()
        for each in unit:
            self._set_gaps(each)
            self.solver.equations.forces(self._by_gaps, f)
            right.append(f.array_r.copy())
        fixed = {key: self._fixed(numbers) for key, numbers in varied.items()}
        impose(self.coupling, next(iter(varied.values()))(0.0))
        self._place.restore(self.coupling)
        solved = self._solve([*right, *(each.residual for each in fixed.values())])
        B, of_numbers = solved[: len(unit)], dict(zip(fixed, solved[len(unit) :], strict=True))
        skins = [self._skin_along(*pair) for pair in zip(B, unit, strict=True)]
        loop = np.eye(len(unit))
        if len(unit):
            closure_slope = self._closure_slope(self._pressures(self._skin))
            moved = [self._pressures_along(*pair) for pair in zip(skins, unit, strict=True)]
            loop = loop - closure_slope[:, None] * np.stack(moved, axis=1)
        found = {}
        for key, a in of_numbers.items():
            skin = fixed[key].skin + self._skin_along(a, none)
            if len(unit):
                dd = np.linalg.solve(loop, closure_slope * self._pressures_along(skin, none) + fixed[key].gaps)
                skin = skin + sum(d * each for d, each in zip(dd, skins, strict=True))
                a = a + sum(d * b for d, b in zip(dd, B, strict=True))
            found[key] = self._slopes(a, skin, fixed[key].explicit)
        return found

    def _slopes(self, dx: Array, change: Array, explicit: Array) -> Slopes:
        """Return the derivatives of the quantities along a change of the state."""
        step = self.solver.layout.create_vector()
        step.array_w[:] = dx
        bone = self.solver.layout.rigid_part(step)
        names = [*self.measure(self._skin, self.solver.bone)]

        def values(skin: SurfaceState, part: float) -> Array:
            return np.array([*self.measure(skin, self.solver.bone + part * bone).values(), *self._margins(skin)])

        found = self._along_skin(values, change)
        by_step = dict(zip(names, map(float, found[: len(names)] + (explicit if len(explicit) else 0.0)), strict=True))
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = -self._margins(self._skin) / found[len(names) :]
        ends = ends[np.isfinite(ends)]
        return Slopes(by_step, float((-ends[ends < 0]).min(initial=np.inf)), float(ends[ends > 0].min(initial=np.inf)))

    def _margins(self, skin: SurfaceState) -> Array:
        """Return of each ridge its contact force (N/m), or without one the gap of its lowest point (m); collective."""
        surface = self.problem.surface
        gap = np.array([skin.gap[surface.ridge == k].min(initial=np.inf) for k in range(len(surface.ridge_numbers))])
        gap = np.min(surface.mesh.comm.allgather(gap), axis=0)
        force = surface.per_ridge(skin.p_n)
        return np.asarray(np.where(force > 0, force, gap))


def _stack(skin: SurfaceState) -> Array:
    return np.stack([np.broadcast_to(getattr(skin, name), skin.x.shape) for name in _VALUES])
