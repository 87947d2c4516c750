"""From load to load: adaptive steps with cutback, first touch, snap-off, and accepted states.

A step that fails is halved. Where the loop over the scales cycles there may be no equilibrium in a range of loads (see
:mod:`~variational.solvers.coupling`), which halved steps approach and never cross; so a longer step over that range is
tried first.

The fields of :mod:`variational.history` are accepted in :meth:`Continuation.accept` and nowhere else; a rejected
attempt restores the last accepted state.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from variational.solvers.accepted import relax, return_to_onset
from variational.solvers.coupling import AcceptedState, Coupling, Place
from variational.solvers.outcome import NotConverged
from variational.solvers.target import Control, Progress, Target, Way

Array = NDArray[np.float64]


_SMALLEST = 1e-3  # step below which a load is given up, over the largest
_SMALLEST_SLIP = 1 / 32  # the same from full slip to full slip, where a path is the other way
_BEHIND = 3e-3  # m, how far anchors of friction are put behind the skin, which moves by less between two loads
_MANY = 0.5  # part of the contact points that slip, above which they are expected to slip on when the bone moves
_STEP_OVER = 1.5  # step tried where the loop over the scales cycles, over the one that led there
# To an equilibrium from a state from elsewhere.
_WAYS = ("at once", "under held skin", "part by part", "pseudo-transient")
_EASY_FACTORISATIONS = 6  # factorisations; a step that took no more lets the next one grow
_MAX_STEPS_PER_LARGEST = 20  # steps of a load for each of its largest steps, and
_MAX_FURTHER_STEPS = 100  # more of them
_UNCUT = 3  # steps in a row that were not cut, after which the next one grows however hard they were
_CUT = 4  # steps in a row that were, each a part of what is left up to a jump that none gets over


class StepFailed(RuntimeError):
    """A target that could not be reached; names step, load and reason."""


@dataclass
class Attempt:
    """How a step was solved."""

    newton: int = 0
    factorisations: int = 0
    coupling_iterations: int = 0
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


class Continuation:
    """Leads a coupled problem along targets.

    Attributes:
        steps: accepted steps so far.
        solve: solves at a load, see :meth:`variational.solvers.coupling.Coupling.solve`.
        surface_state: the skin in the accepted state, as solved, before its friction history moved on.
        slip: part of its contact points at the friction cone, and whether all slip one way.
        time: of the accepted state (s), the durations of all targets so far.
        progress: on the way to the present target.
        touching: height of the bone before a first touch is looked for, and how far it is lowered (m); None elsewhere.
        resumes: the next target is one that another process was on the way to, as ``progress`` says.
    """

    def __init__(
        self,
        coupling: Coupling,
        on_accept: Callable[[Target, float, Attempt], bool | None] = lambda target, part, attempt: None,
        touch_depth: float = 5e-6,
        step_scale: float = 1.0,
    ) -> None:
        """Start from the unloaded body.

        Args:
            coupling: solves at fixed loads.
            on_accept: called with the target, the part of it reached and how, after each accepted step; returns True
                to stop there.
            touch_depth: how far the bone is lowered by displacement before force takes over (m).
            step_scale: factor on the largest steps of force, voltage and displacement.
        """
        self.coupling, self.solver = coupling, coupling.solver
        self.solve: Callable[[bool], None] = lambda pseudo_transient: coupling.solve(pseudo_transient)
        self.problem, self.observer = self.solver.problem, coupling.observer
        self.on_accept, self.touch_depth, self.step_scale = on_accept, touch_depth, step_scale
        self.steps, self.slip, self.time = 0, (0.0, False), 0.0
        self.surface_state = self.observer.state()
        self._now = AcceptedState.of(self.coupling)
        self.progress = self._begun()
        self.touching: tuple[float, float] | None = None
        self.resumes = False

    # -- accepted states -------------------------------------------------------------------------------
    def _restore(self) -> None:
        self._now.restore(self.coupling)

    def accept(self) -> None:
        """Accept the present state, an equilibrium; collective."""
        self.surface_state = self.observer.state()
        self.slip = self.observer.slip(self.surface_state)
        history = self.problem.history
        history.accept(history.updated(self.surface_state.history))
        self.problem.elapse(0.0)
        self._now = AcceptedState.of(self.coupling)
        self.steps += 1
        PETSc.garbage_cleanup(self.problem.mesh.comm)  # objects that several ranks have dropped wait for this

    def place(self) -> Place:
        """Return the accepted state, to come back to by :meth:`go_to`."""
        return Place(self._now, self.surface_state, self.slip, self.coupling.gain.copy(), self.time)

    def go_to(self, place: Place) -> None:
        """Accept a state again that was accepted before, under the same laws; collective."""
        self._now, self.surface_state, self.slip = place.accepted, place.surface, place.slip
        self.coupling.gain, self.time = place.gain.copy(), place.time
        self._restore()

    # -- targets ---------------------------------------------------------------------------------------
    def run(self, target: Target) -> None:
        """Reach a target, or stop on the way where ``on_accept`` returns True.

        Raises:
            StepFailed: the load reached and why the next step was not.
        """
        if target.f_ext is not None and self._now.control.y is not None:
            if not self._touch():
                return
        self._reach(target)

    def _touch(self) -> bool:
        """Lower the bone by displacement until the screen bears it: without contact, force control is singular.

        Returns:
            Whether the screen bears it; False where ``on_accept`` stopped the path.
        """
        start, depth = self._now.control.y or 0.0, 0.0
        if self.resumes and self.touching is not None:
            start, depth = self.touching
        while self.resumes or not self._bears():
            if not self.resumes:
                # To a depth at which the screen bears it whatever the roundoff, also where it comes from above.
                clearance = self._clearance()
                depth += self.touch_depth + (clearance if clearance > self.touch_depth / 2 else 0.0)
            self.touching = start, depth
            if not self._reach(Target("touch", bone_height=start - depth, touches=True)):
                return False
        self.touching = None
        self.solver.control.y = None
        self.solver.control.force = float(self.solver.reaction[1])
        self._now = AcceptedState.of(self.coupling)
        return True

    def _touches(self) -> bool:
        """Return whether skin is in contact; collective."""
        return bool(self.problem.mesh.comm.allreduce(bool((self.surface_state.p_n > 0).any()), op=MPI.LOR))

    def _bears(self) -> bool:
        """Return whether the screen bears the body, which the roundoff of a body in the air does not; collective."""
        return self._touches() and float(self.solver.reaction[1]) > 0

    def _clearance(self) -> float:
        """Return how far the lowest point of the skin is above the screen (m); collective."""
        lowest = float(self.surface_state.y.min(initial=np.inf))
        return float(self.problem.mesh.comm.allreduce(lowest, op=MPI.MIN))

    def _reach(self, target: Target) -> bool:
        """Reach a target; return False where ``on_accept`` stopped the path before."""
        p = self.progress = self.begun()
        resumed, self.resumes = self.resumes, False
        way = Way(p, target)
        largest = way.largest_step(self.step_scale)
        # A slide begins with a shorter step: under a light load it may be over within one.
        slides = way.length != 0 and not target.continues
        if not resumed:
            p.step = largest / 2 if slides else largest
        most = _MAX_FURTHER_STEPS + int(np.ceil(_MAX_STEPS_PER_LARGEST / largest))
        while p.part < 1:
            if self.steps > p.steps and target.until_full_slip and self.slip[1]:
                return True
            if self.steps - p.steps >= most:
                slow = NotConverged(f"TOO_SMALL_STEPS, {most} of them, do not get to the end of the load", False)
                raise StepFailed(self._describe(target, p.part, slow)) from slow
            step = min(p.step, 1 - p.part, self.step_scale * way.longest(p.part, self.problem.shortest_time))
            if (law := self.problem.interface.adhesion) and self._touches():
                step = min(step, self.step_scale * way.peels(self._now.height, law.reach))
            if 1 - p.part - step < 0.05 * step:
                step = 1 - p.part
            attempt, within = Attempt(), step
            while True:
                # One or two failures may be a step too large. More in a row, or one in each of several steps, are a
                # jump, which no step is small enough for. One jump comes after the other: of facets, of ridges.
                pseudo_transient = p.jumps or len(attempt.cutbacks) > 1 or p.cut >= _CUT
                try:
                    if target.constants is not None:
                        target.constants(p.part + step)
                    behind = np.sign(-self._now.reaction[0]) * _BEHIND if target.slips else 0.0
                    self._try(way.at(p.part + step), attempt, pseudo_transient, step * target.duration, behind=behind)
                    break
                except NotConverged as failure:
                    self._restore()
                    if target.constants is not None:
                        target.constants(p.part)
                    attempt.cutbacks.append(f"{failure} at part {p.part + step:.4g}")
                    over = min(_STEP_OVER * within, 1 - p.part)
                    attempt.stepped_over_fold = failure.cycling and not attempt.stepped_over_fold and over > within
                    within = within if attempt.stepped_over_fold else within / 2
                    step = over if attempt.stepped_over_fold else within
                    smallest = _SMALLEST_SLIP if target.slips else _SMALLEST * largest
                    if failure.irrecoverable or pseudo_transient and within < smallest:
                        raise StepFailed(self._describe(target, p.part, failure)) from failure
            # What depends on time is another at another time, so that it is not taken back.
            if target.until_full_slip and slides and not (self.problem.in_time and target.duration):
                step -= return_to_onset(self.solver, self.observer, way.length) / abs(way.length)
            self.accept()
            p.part += step
            self.time = p.time + p.part * target.duration
            p.uncut, p.cut = (0, p.cut + 1) if attempt.cutbacks else (p.uncut + 1, 0)
            p.jumps |= attempt.pseudo_transient > 0
            p.step = within
            if attempt.factorisations <= _EASY_FACTORISATIONS or p.uncut >= _UNCUT:
                p.step, p.uncut = min(2 * p.step, largest), 0
            if self.on_accept(target, p.part, attempt) is True:
                return False
        return True

    def resume(self) -> None:
        """Take the present fields and attributes, those of another process, as the accepted state; collective."""
        self._now, self.resumes = AcceptedState.of(self.coupling), True

    def begun(self) -> Progress:
        """Return the progress with which the next target begins: that of another process, or none from here."""
        return self.progress if self.resumes else self._begun()

    def _begun(self) -> Progress:
        now = self._now
        return Progress(replace(now.control), now.voltage, now.height, now.reaction.copy(), self.time, self.steps)

    def _describe(self, target: Target, part: float, failure: NotConverged) -> str:
        c = self._now.control
        load = f"f_ext {c.force:.4g} N/m" if c.y is None else f"bone height {c.y:.4g} m"
        return (
            f"step {self.steps + 1} ({target.name}, {100 * part:.1f} % done) found no equilibrium beyond "
            f"{load}, {self._now.voltage:.4g} V, bone x {c.x:.4g} m: {failure}"
        )

    # -- a state from elsewhere ------------------------------------------------------------------------
    def re_equilibrate(self, name: str) -> Attempt:
        """Solve at the present loads from fields and history that were put in from outside, and accept the state.

        On another mesh of the same body the restored skin is nearly right, and the strain in the elements next to it is
        not. Where Newton's method does not find an equilibrium from there at once, the body is brought into balance
        with its skin held where it is, and Newton's method starts again from that state. If this fails too, the forces
        that are out of balance are taken away part by part; the last way is pseudo-transient continuation.

        Args:
            name: what the state is called in a failure.

        Raises:
            StepFailed: no equilibrium was found from there.
        """
        self._now = AcceptedState.of(self.coupling)
        attempt = Attempt()
        for way in _WAYS:
            try:
                if way == "under held skin":
                    self._relax(1.0, skin=True)
                    self._now = AcceptedState.of(self.coupling)
                if way == "part by part":
                    self._relax(0.5)
                load = replace(self._now.control), self._now.voltage
                self._try(load, attempt, pseudo_transient=way == "pseudo-transient", on_cone=False)
                self.accept()
                return attempt
            except NotConverged as failure:
                self._restore()
                attempt.cutbacks.append(str(failure))
                last = failure
        raise StepFailed(self._describe(Target(name), 0.0, last)) from last

    def _relax(self, part: float, skin: bool = False) -> None:
        self.solver.new_load(replace(self._now.control), self._now.voltage, on_cone=False)
        relax(self.solver, part, skin)

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
            self._try((control, self._now.voltage), Attempt(), pseudo_transient=False)
            return self.solver.reaction.copy(), self.observer.slip(self.observer.state())[1]
        except NotConverged:
            return None
        finally:
            self._restore()
            self.problem.guess.value, self.coupling.gain = guess, gain

    # -- one step --------------------------------------------------------------------------------------
    def _try(
        self,
        load: tuple[Control, float],
        attempt: Attempt,
        pseudo_transient: bool,
        dt: float = 0.0,
        on_cone: bool = True,
        behind: float = 0.0,
    ) -> None:
        counts = self.solver.counts
        self.problem.dt.value = dt
        self.problem.elapse(dt)
        newton, factorisations, shifted = counts.newton, counts.factorisations, counts.pseudo_transient
        if behind:
            history = self.problem.history
            history.accept({"anchor": history.accepted["anchor"] - behind})
        slipping = behind != 0.0 or (load[0].x != self._now.control.x and self.slip[0] > _MANY)
        self.solver.new_load(*load, slipping=slipping, on_cone=on_cone and not behind)
        try:
            self.solve(pseudo_transient)
        finally:
            attempt.newton += counts.newton - newton
            attempt.factorisations += counts.factorisations - factorisations
            attempt.pseudo_transient += counts.pseudo_transient - shifted
            attempt.coupling_iterations = len(self.coupling.history.changes)
            attempt.changes = self.coupling.history.changes
            attempt.jumped = self.coupling.history.jumped
