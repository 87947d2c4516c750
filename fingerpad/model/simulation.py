"""The path of a finger's loads: from one load to the next, every accepted state checked and reported."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpi4py import MPI

from fingerpad.model.checks import Checked, ContactZone, FingerExceeded, FullSlip, StabilityChecks
from fingerpad.model.finger import Finger, HalfFinger, Step
from fingerpad.model.options import FingerModel
from fingerpad.model.schedule import targets
from fingerpad.model.state import refuse_strained, step_record
from fingerpad.results.states import FIRST_TOUCH
from fingerpad.scene import Load
from variational.resultants import RidgeLoads
from variational.solvers import checkpoint
from variational.solvers.continuation import Attempt, Continuation, StepFailed
from variational.solvers.outcome import Counts, Timings
from variational.solvers.stability import Stability
from variational.solvers.state_snapshot import StateSnapshot, take_snapshot
from variational.solvers.target import Target
from variational.solvers.transfer import restore
from variational.state import ContactState

_WAY = ("steps", "time", "progress", "touching")  # of a path that goes on on another mesh


@dataclass(frozen=True)
class RestartRequired:
    """An omitted part of the model turned out to matter: the loads must be gone through again, or go on, with it."""

    reason: str
    model: FingerModel
    """With more ridges that can touch, a finer mesh, or more parts."""
    carries: bool = False
    """Whether the accepted state is an equilibrium of that model too, from which its path goes on."""


class Simulation:
    """A finger led along its loads.

    Attributes:
        finger: the finger.
        restart: what must be added to the model, if the present load turned out to need it.
        checks: stability of the state at the end of each load, at first full slip and after each jump, by step.
        states: the accepted states so far. States solved for again (:mod:`fingerpad.accuracy.solves`) have no record of
            a step.
    """

    def __init__(
        self,
        model: FingerModel,
        comm: MPI.Comm,
        on_step: Callable[[Step, float], None] = lambda step, done: None,
        on_load: Callable[[], None] = lambda: None,
    ) -> None:
        """Mesh the finger and set the solver up; collective.

        Args:
            model: the finger and its loads.
            comm: communicator of the mesh.
            on_step: called on every rank after each accepted step with the part of the whole history that is done.
            on_load: called on every rank when a load has been reached.
        """
        self.model = model
        self._comm = comm
        self.on_step, self.on_load = on_step, on_load
        self.finger = finger = Finger(model, comm, self._accepted)
        self.energy = finger.book()
        self.states: list[ContactState] = []
        self.checks = StabilityChecks(finger)
        self._load, self._loads_done = "", 0
        self._slip = FullSlip(finger)
        self._timed = any(load.takes_time for load in model.loads)
        self._began = self._seconds = 0.0  # when the present load began, and how long it takes (s)
        self._over_time = False  # whether it has a waveform
        self._x, self._runs = 0.0, 0  # where the bone was when it began (m), and how often the path was run for it
        self._passed = 0  # runs of the load at which another process has been, the last of them not to its end
        self._half_kept: dict[str, Any] | None = None
        self._zone = ContactZone(finger, model)
        self.restart: RestartRequired | None = None
        self._half: HalfFinger | None = None  # while it leads the finger

    def run(self) -> RestartRequired | None:
        """Reach every load; collective.

        Returns:
            What must be added to the model and why, where an omitted part turns out to matter; the loads are not
            reached then. None at the end of the loads.

        Raises:
            StepFailed: a load that could not be reached; everything accepted before was reported.
        """
        loads, first = self.model.loads, self._loads_done
        self._begin_half()
        if self._half is not None and self._half_kept is not None:
            checkpoint.put(self._half.path, self._half_kept)
            self.finger.continuation.resumes = False
        try:
            for k, load in enumerate(loads[first:], start=first):
                if k == self._moves:
                    self._end_half()
                self._load, self._loads_done = load.name, k
                self._follow(load)
                if self.restart is not None:
                    return self.restart
                self.on_load()
        finally:  # nothing collective: a rank may be alone here with its error
            if self._half is not None:
                self._half.count()
        self.checks.free()
        return None

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Leave the present state, and come back to it after what is reached inside, with no energies; collective."""
        places = {name: path.place() for name, path in self._paths().items()}
        before = self.states, self._load
        self.states = [*self.states]
        yield
        for name, path in self._paths().items():
            path.go_to(places[name])
        self.states, self._load = before
        self.energy = self.finger.book()

    def reach(self, loads: Sequence[Load], reached: Callable[[], None]) -> None:
        """Reach loads beside those of the model, inside of :meth:`aside`; collective.

        Args:
            loads: that do not move the bone.
            reached: called at the end of each.

        Raises:
            StepFailed: one could not be reached.
        """
        for load in loads:
            self._load = load.name
            for target in targets(load, self._x, self.model.numerics.step_scale):
                if self.restart is None:
                    self._path.run(target)
            if self.restart is not None:
                return
            reached()
        self.restart = self._symmetry_lost()

    @property
    def _moves(self) -> int:
        """Number of the load that first moves the bone sideways."""
        loads = self.model.loads
        return next((k for k, load in enumerate(loads) if load.moves), len(loads))

    def _begin_half(self) -> None:
        """Have the half lead the finger where it can, if it does not yet; collective."""
        if self._half is None and self._moves > self._loads_done and self.model.options.symmetric_start:
            self._half = HalfFinger(self.model, self.finger, self._comm, self._accepted)

    def _end_half(self) -> None:
        """Go on with the whole finger."""
        half, self._half = self._half, None
        if half is not None:
            self.finger.continuation.time = half.path.time
            half.count()
            half.free()

    # -- checkpoints -----------------------------------------------------------------------------------
    def forget(self) -> None:
        """Leave nothing to the next solve that another process would not have, see :meth:`kept`; collective."""
        for path in self._paths().values():
            path.solver.iteration.forget()

    @property
    def _path(self) -> Continuation:
        """The path that leads the finger."""
        return self.finger.continuation if self._half is None else self._half.path

    def _paths(self) -> dict[str, Continuation]:
        paths = {"finger": self.finger.continuation}
        return paths if self._half is None else paths | {"half": self._half.path}

    def kept(self) -> dict[str, Any]:
        """Return all that another process needs to go on from the accepted state, whole on rank 0; collective.

        Both go on the same to the last bit on one rank, if this one forgets (:meth:`forget`).
        """
        return {"paths": {name: checkpoint.take(path) for name, path in self._paths().items()}} | self._progress()

    def carried(self) -> dict[str, Any]:
        """Return all that a simulation on a wider mesh needs to go on, and free the memory of this one; collective."""
        solver, path = self.finger.solver, self.finger.continuation
        snapshot = take_snapshot(path.coupling, path.surface_state)
        for path in self._paths().values():
            path.solver.iteration.free()
        way = {name: getattr(self._path, name) for name in _WAY}
        return self._progress() | {"carried": (snapshot, way, solver.counts, solver.timings)}

    def _progress(self) -> dict[str, Any]:
        return {
            "checks": {step: (c.frozen.lambda_min, c.frozen.settled, c.gain) for step, c in self.checks.items()},
            "load": (self._loads_done, self._x, self._began, self._runs),
        }

    def resume(self, kept: dict[str, Any], states: list[ContactState]) -> None:
        """Go on with :meth:`run` from where another process was; collective.

        Args:
            kept: what it kept, on every rank.
            states: accepted until there.

        Raises:
            OtherBody, StepFailed: its mesh was another one, or its state has no equilibrium on this wider one.
        """
        self._loads_done, self._x, self._began, self._passed = kept["load"]
        if "carried" in kept:
            self._put_down(*kept["carried"])
        else:
            checkpoint.put(self.finger.continuation, kept["paths"]["finger"])
            self._half_kept = kept["paths"].get("half")
        self.energy, self.states = self.finger.book(), states
        for step, (least, settled, gain) in kept["checks"].items():
            self.checks[step] = Checked(Stability(least, settled), gain)

    def _put_down(self, snapshot: StateSnapshot, way: dict[str, Any], counts: Counts, timings: Timings) -> None:
        """Solve for a state of another mesh again, and have its path go on from there; collective."""
        self._begin_half()
        path = self._path
        for each in self._paths().values():
            restore(snapshot, each.coupling)
        path.re_equilibrate("state on a wider mesh")
        vars(path).update(way | {"resumes": True})
        if self._half is not None:
            self._half.show()
        self.finger.solver.counts.add(counts)
        self.finger.solver.timings.add(timings)

    def _follow(self, load: Load) -> None:
        """Reach a load, and slide on where it ends at full slip."""
        path, x = self.finger.continuation, self._x
        if not self._passed:
            x, self._began = float(path.solver.control.x), self._time
            self._x = x
        *before, target = targets(load, x, self.model.numerics.step_scale)
        end = x if target.bone_x is None else target.bone_x
        direction = float(np.sign(end - x))
        seconds = load.seconds(end - x)
        speed = abs(end - x) / seconds if seconds else 0.0
        self._seconds, self._over_time, self._runs = seconds, load.wave is not None, 0
        for piece in before:
            if self.restart is None and self._is_next():
                self._path.run(piece)
        self._reach(target)
        slides = direction and target.until_full_slip
        while slides and self.restart is None and (self._runs < self._passed or path.slip[1]):
            following = self._is_next()
            steady = following and self._slip.slides_on(load.name, direction, speed)
            left = direction * (end - path.begun().control.x)
            if steady or (following and left <= 0):  # or at the end of the slide
                break
            self._reach(replace(target, duration=left / speed if speed else 0.0))
        self._passed = 0

    def _is_next(self) -> bool:
        """Count a run of the path for the present load; return whether another process has not been through it."""
        self._runs += 1
        return self._runs >= self._passed

    @property
    def _time(self) -> float:
        """Time of the accepted state (s)."""
        return self._path.time

    def _done(self, part: float) -> float:
        """Return the part of the present load that is done, in time where it has a waveform."""
        timed = self._over_time and self._seconds > 0
        return min((self._time - self._began) / self._seconds, 1.0) if timed else part

    def _reach(self, target: Target) -> None:
        if self.restart is None and self._is_next():
            self._path.run(target)
            if self.restart is None:
                self.restart = self._symmetry_lost()

    def slip_to(self, target: Target) -> ContactState:
        """Return the state of another full slip, solved for from the present one; collective.

        Args:
            target: with ``slips``.

        Raises:
            StepFailed: no state was found from there, or more of the skin must be able to touch.
        """
        self._load, self.restart = target.name, None
        self.finger.continuation.run(target)
        if self.restart is not None:
            raise StepFailed(f"{target.name}: {self.restart.reason}")
        self.energy = self.finger.book()  # what was dissipated on the way is not known
        return self.states[-1]

    def present(self, loads: RidgeLoads, attempt: Attempt | None = None, touches: bool = False) -> Step:
        """Return the present state as a step, see :meth:`Finger.present`; ``touches`` is that of the first touch."""
        return self.finger.present(loads, FIRST_TOUCH if touches else self._load, self._loads_done + 1, attempt)

    def _symmetry_lost(self) -> RestartRequired | None:
        """Check the stability of the present state; return that the whole finger is needed where a half is unstable."""
        stable = self.checks.check(self._load).frozen.stable
        options = self.model.options
        if options.both_halves or stable:
            return None
        reason = "the half of the finger is not stable, so that the whole may not be symmetric"
        return RestartRequired(reason, self.model.changed(options=options.with_both_halves()))

    def _zone_exceeded(self, loads: RidgeLoads) -> RestartRequired | None:
        """Return that more ridges must be able to touch, where they must; collective."""
        wider = self._zone.check(loads)
        carries = not self.model.options.past  # the past of layers is that of their mesh
        return None if wider is None else RestartRequired(wider[1], self.model.with_ridges(wider[0]), carries)

    def _accepted(self, target: Target, part: float, attempt: Attempt) -> bool:
        """Check and report an accepted state; return whether the path must stop here."""
        finger, touches = self.finger, target.touches
        loads = finger.ridge_loads()
        imbalance = finger.check_balance(loads, self._load)
        if attempt.jump:
            self.restart = self._symmetry_lost()
            if self.restart is not None:
                return True
        step = self.present(loads, attempt, touches)
        record = None
        if not target.slips:
            energy = self.energy.step(*finger.surface_and_bone())
            record = step_record(finger.continuation, energy, imbalance, attempt)
        if record and not (loads.f_contact.any() or finger.voltage or finger.problem.interface.adhesion):
            where = f"step {finger.continuation.steps} ({self._load})"
            formulation = finger.problem.interface.formulation
            refuse_strained(where, record, self.states, finger.solver.force_scale, formulation)
        probe = part >= 1 and not target.until_full_slip and not self._over_time
        state = self._slip.placed(self.states, step.state, probe)
        state = replace(state, record=record, time=self._time if self._timed else math.nan)
        self.states.append(state)
        part = 0.0 if touches else self._done(part)
        done = min((self._loads_done + part) / len(self.model.loads), 1.0)
        self.on_step(replace(step, state=state, touches=touches, ends=part >= 1), done)
        try:
            self.restart = self._zone_exceeded(loads)
        except FingerExceeded as error:
            raise StepFailed(f"step {finger.continuation.steps} ({self._load}): {error}") from error
        return self.restart is not None
