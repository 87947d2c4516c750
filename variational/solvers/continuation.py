"""From load to load: adaptive steps with cutback, first touch, snap-off, and accepted states.

A step that fails is halved. Where the loop over the scales cycles there may be no equilibrium in a range of loads (see
:mod:`~variational.solvers.coupling`), which halved steps only creep up to; so a longer step over that range is tried
first.

History (friction anchors, contact multipliers, air gaps, displacement) is accepted in :meth:`Continuation._accept`
and nowhere else; a rejected attempt restores the last accepted state.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from variational.contact.formulation import History
from variational.solvers.coupling import Coupling
from variational.solvers.failure import NotConverged
from variational.solvers.newton import Control

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Target:
    """A load to reach from the present one; what is None stays as it is.

    At most one of ``f_ext`` (N/m) and ``bone_height`` (m, change from the unloaded position, negative when pressed)
    may be given: it also says which of the two is prescribed from then on.
    """

    name: str
    f_ext: float | None = None
    bone_height: float | None = None
    voltage: float | None = None
    bone_x: float | None = None
    until_full_slip: bool = False
    """Stop as soon as every point in contact slips one way."""


# How far one step may go: parts of sqrt(f_ext) and of U^2, and metres of the bone.
_FORCE, _VOLTAGE, _SINK, _SLIDE = 0.067, 0.25, 40e-6, 60e-6
_SMALLEST = 1e-3  # step below which a load is given up, over the largest
_MANY = 0.5  # part of the contact points that slip, above which they are expected to slip on when the bone moves
_LEAP = 1.5  # step tried where the loop over the scales cycles, over the one that led there
_WAYS = "at once", "settled", "bit by bit", "creeping"  # to an equilibrium from a state from elsewhere
_SMALLEST_BIT = 1 / 8  # of the forces that such a state is out of balance by
_FEW = 6  # factorisations; a step that took no more lets the next one grow
_MANY_STEPS, _FEW_STEPS = 20, 100  # most steps of a load: so many for each of its largest steps, and so many more
_UNCUT = 3  # steps in a row that were not cut, after which the next one grows however hard they were
_CUT = 4  # steps in a row that were, each a part of what is left up to a jump that none gets over


class StepFailed(RuntimeError):
    """A target that could not be reached; names step, load and reason."""


@dataclass
class Attempt:
    """How a step was solved."""

    newton: int = 0
    factorisations: int = 0
    sweeps: int = 0
    changes: list[float] = field(default_factory=list)
    cutbacks: list[str] = field(default_factory=list)
    pseudo_transient: int = 0
    """Solves that full Newton steps did not manage: as a rule, parts of the skin jumped."""
    jumped: set[int] = field(default_factory=set)
    """Numbers of the ridges whose air gap went past a fold."""
    stepped_over_fold: bool = False
    """Whether the step went over loads at which the loop over the scales cycles: a ridge jumped."""

    @property
    def jump(self) -> bool:
        """Whether skin or an air gap moved without the loads."""
        return self.pseudo_transient > 0 or bool(self.jumped) or self.stepped_over_fold


@dataclass
class _Accepted:
    x: Array
    history: History
    d_eq: Array
    control: Control
    voltage: float
    reaction: Array


class Continuation:
    """Leads a coupled problem along targets.

    Attributes:
        steps: accepted steps so far.
        surface_state: the skin in the accepted state, as solved, before its friction history moved on.
        slip: part of its contact points at the friction cone, and whether all slip one way.
    """

    def __init__(
        self,
        coupling: Coupling,
        on_accept: Callable[[Target, float, Attempt], None] = lambda target, part, attempt: None,
        touch_depth: float = 5e-6,
        step_scale: float = 1.0,
    ) -> None:
        """Start from the unloaded body.

        Args:
            coupling: solves at fixed loads.
            on_accept: called with the target, the part of it reached and how, after each accepted step.
            touch_depth: how far the bone is lowered by displacement before force takes over (m).
            step_scale: factor on the largest steps of force, voltage and displacement.
        """
        self.coupling, self.solver = coupling, coupling.solver
        self.problem, self.observer = self.solver.problem, coupling.observer
        self.on_accept, self.touch_depth, self.step_scale = on_accept, touch_depth, step_scale
        self.steps = 0
        self.surface_state = self.observer.state()
        self.slip = (0.0, False)
        self._now = self._snapshot()

    # -- accepted states -------------------------------------------------------------------------------
    def _snapshot(self) -> _Accepted:
        return _Accepted(
            self.solver.x.array_r.copy(),
            self.problem.history,
            self.coupling.d_eq.copy(),
            replace(self.solver.control),
            float(self.problem.voltage.value),
            self.solver.reaction.copy(),
        )

    def _restore(self) -> None:
        a = self._now
        self.solver.x.array_w[:] = a.x
        self.solver.to_fields(self.solver.x)
        self.coupling.set_air_gaps(a.d_eq.copy())
        self.problem.set_history(a.history)
        self.solver.control = replace(a.control)
        self.problem.voltage.value = a.voltage
        self.solver.reaction = a.reaction.copy()

    def _accept(self) -> None:
        self.surface_state = self.observer.state()
        self.slip = self.observer.slip(self.surface_state)
        s = self.surface_state
        self.problem.set_history(History(s.anchor, s.p_n, s.x))
        self._now = self._snapshot()
        self.steps += 1

    # -- targets ---------------------------------------------------------------------------------------
    def run(self, target: Target) -> None:
        """Reach a target.

        Raises:
            StepFailed: the load reached and why the next step was not.
        """
        if target.f_ext is not None and self._now.control.y is not None:
            self._touch(target)
        self._reach(target)

    def _touch(self, target: Target) -> None:
        """Lower the bone by displacement until the screen bears it: without contact, force control is singular."""
        start = self._now.control.y or 0.0
        depth = self.touch_depth
        while self.solver.reaction[1] <= 0 or self.steps == 0:
            self._reach(Target("touch", bone_height=start - depth))
            depth += self.touch_depth
        self.solver.control.y = None
        self.solver.control.force = float(self.solver.reaction[1])
        self._now = self._snapshot()

    def _loads(self, target: Target) -> Callable[[float], tuple[Control, float]]:
        """Return control and voltage as functions of the part of the target reached."""
        a, y0 = self._now, self._height()
        x1 = a.control.x if target.bone_x is None else target.bone_x
        u1 = a.voltage if target.voltage is None else target.voltage

        def at(part: float) -> tuple[Control, float]:
            c = Control(a.control.x + part * (x1 - a.control.x), a.control.y, a.control.force)
            if target.bone_height is not None:
                c.y = y0 + part * (target.bone_height - y0)
            elif target.f_ext is not None:
                # equal steps of the root: nearly equal steps of the indentation
                f0 = max(a.control.force, 0.0)
                c.y, c.force = None, (np.sqrt(f0) + part * (np.sqrt(target.f_ext) - np.sqrt(f0))) ** 2
            # equal steps of U^2, which the attraction follows
            return c, float(np.sqrt(a.voltage**2 + part * (u1**2 - a.voltage**2)))

        return at

    def _height(self) -> float:
        """Return the bone's height (m, change from unloaded) of the accepted state."""
        y = self._now.control.y
        return float(self.solver.bone[1]) if y is None else y

    def _largest_step(self, target: Target) -> float:
        """Return the largest part of a target that one step may cover."""
        a = self._now
        steps: list[tuple[float, float]] = []  # how far one step may go, and how far the target is
        if target.f_ext is not None:
            roots = np.sqrt(target.f_ext), np.sqrt(max(a.control.force, 0.0))
            steps.append((_FORCE * max(roots), abs(roots[0] - roots[1])))
        if target.voltage is not None:
            squares = target.voltage**2, a.voltage**2
            steps.append((_VOLTAGE * max(squares), abs(squares[0] - squares[1])))
        if target.bone_height is not None:
            steps.append((_SINK, abs(target.bone_height - self._height())))
        if target.bone_x is not None:
            steps.append((_SLIDE, abs(target.bone_x - a.control.x)))
        return float(min([1.0, *(self.step_scale * most / whole for most, whole in steps if whole > 0)]))

    def _reach(self, target: Target) -> None:
        at, largest = self._loads(target), self._largest_step(target)
        part, step, uncut, cut = 0.0, largest, 0, 0
        first, most = self.steps, _FEW_STEPS + int(np.ceil(_MANY_STEPS / largest))
        while part < 1:
            if self.steps - first >= most:
                slow = NotConverged(f"TOO_SMALL_STEPS, {most} of them, do not get to the end of the load", False)
                raise StepFailed(self._describe(target, part, slow)) from slow
            step = min(step, 1 - part)
            if 1 - part - step < 0.05 * step:
                step = 1 - part
            attempt, within = Attempt(), step
            while True:
                # One or two failures may be a step too large. More in a row, or one in each of several steps, are a
                # jump, which no step is small enough for.
                creep = len(attempt.cutbacks) > 1 or cut >= _CUT
                try:
                    self._try(at(part + step), attempt, creep)
                    break
                except NotConverged as failure:
                    self._restore()
                    attempt.cutbacks.append(f"{failure} at part {part + step:.4g}")
                    over = min(_LEAP * within, 1 - part)
                    attempt.stepped_over_fold = failure.cycling and not attempt.stepped_over_fold and over > within
                    within = within if attempt.stepped_over_fold else within / 2
                    step = over if attempt.stepped_over_fold else within
                    if failure.irrecoverable or within < _SMALLEST * largest:
                        raise StepFailed(self._describe(target, part, failure)) from failure
            self._accept()
            part += step
            self.on_accept(target, part, attempt)
            if target.until_full_slip and self.slip[1]:
                return
            uncut, cut = (0, cut + 1) if attempt.cutbacks else (uncut + 1, 0)
            step = within
            if attempt.factorisations <= _FEW or uncut >= _UNCUT:
                step, uncut = min(2 * step, largest), 0

    def _describe(self, target: Target, part: float, failure: NotConverged) -> str:
        c = self._now.control
        load = f"f_ext {c.force:.4g} N/m" if c.y is None else f"bone height {c.y:.4g} m"
        return (
            f"step {self.steps + 1} ({target.name}, {100 * part:.1f} % done) found no equilibrium beyond "
            f"{load}, {self._now.voltage:.4g} V, bone x {c.x:.4g} m: {failure}"
        )

    # -- a state from elsewhere ------------------------------------------------------------------------
    def adopt(self, name: str) -> Attempt:
        """Solve at the present loads from fields and history that were put in from outside, and accept the state.

        On another mesh of the same body the carried skin is nearly right, and the strain in the elements next to it is
        not. Where Newton's method does not find an equilibrium from there at once, the body is brought into balance
        with its skin held where it is, and it is tried again from there; then what is left out of balance is let go bit
        by bit; then pseudo-transient continuation is tried.

        Args:
            name: what the state is called in a failure.

        Raises:
            StepFailed: no equilibrium was found from there.
        """
        self._now = self._snapshot()
        attempt = Attempt()
        for way in _WAYS:
            try:
                if way == "settled":
                    self._let_go(1.0, skin=True)
                    self._now = self._snapshot()
                if way == "bit by bit":
                    self._let_go(0.5)
                load = replace(self._now.control), self._now.voltage
                self._try(load, attempt, creep=way == "creeping", on_cone=False)
                self._accept()
                return attempt
            except NotConverged as failure:
                self._restore()
                attempt.cutbacks.append(str(failure))
                last = failure
        raise StepFailed(self._describe(Target(name), 0.0, last)) from last

    def _let_go(self, bit: float, skin: bool = False) -> None:
        """Let go bit by bit, at frozen air gaps, of the forces by which the present state is out of balance.

        Args:
            bit: part of the forces to start with.
            skin: hold the skin where it is.

        Raises:
            NotConverged: not even the smallest bit could be.
        """
        solver = self.solver
        solver.new_load(replace(self._now.control), self._now.voltage, on_cone=False)
        solver.hold(skin)
        try:
            while solver.held > 0:
                before, held = solver.x.array_r.copy(), solver.held
                solver.held = max(held - bit, 0.0)
                try:
                    solver.solve()
                except NotConverged:
                    solver.x.array_w[:], solver.held, bit = before, held, bit / 2
                    if bit < _SMALLEST_BIT:
                        raise
        finally:
            solver.release()

    def probe(self, control: Control) -> tuple[Array, bool] | None:
        """Look where the accepted state would lead, and stay in it.

        Args:
            control: what is prescribed of the bone, at the present voltage.

        Returns:
            The bone's reaction (N/m), shape (2,), and whether every point in contact slips one way; None where no
            equilibrium is found in one step.
        """
        guess, gain = self.problem.guess.value.copy(), self.coupling.gain.copy()
        try:
            self._try((control, self._now.voltage), Attempt(), creep=False)
            return self.solver.reaction.copy(), self.observer.slip(self.observer.state())[1]
        except NotConverged:
            return None
        finally:
            self._restore()
            self.problem.guess.value, self.coupling.gain = guess, gain

    # -- one step --------------------------------------------------------------------------------------
    def _try(self, load: tuple[Control, float], attempt: Attempt, creep: bool, on_cone: bool = True) -> None:
        counts = self.solver.counts
        newton, factorisations, shifted = counts.newton, counts.factorisations, counts.pseudo_transient
        moves = load[0].x != self._now.control.x
        self.solver.new_load(*load, slipping=moves and self.slip[0] > _MANY, on_cone=on_cone)
        try:
            self.coupling.solve(creep)
        finally:
            attempt.newton += counts.newton - newton
            attempt.factorisations += counts.factorisations - factorisations
            attempt.pseudo_transient += counts.pseudo_transient - shifted
            attempt.sweeps = len(self.coupling.history.changes)
            attempt.changes = self.coupling.history.changes
            attempt.jumped = self.coupling.history.jumped
