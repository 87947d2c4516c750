"""One scene from mesh to accepted steps: joins geometry, mechanics and roughness, and reports as it goes."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fingerpad.io.states import SLIDE_ON, full_slip
from fingerpad.model import symmetry
from fingerpad.model.contact_zone import ContactZone, FingerExceeded, RestartRequired
from fingerpad.model.options import ModelOptions
from fingerpad.model.steps import Checked, Step, force_error
from fingerpad.scene import Load, Scene
from geometry import fingertip, mesh, meshfile, tags
from geometry.profiles import Profiles
from variational.attraction.electroadhesion import ELECTROSTATIC
from variational.body import Body
from variational.contact.formulation import SurfaceState
from variational.energy import EnergyBook
from variational.problem import Interface
from variational.quantities import RidgeLoads
from variational.solvers.continuation import Attempt, StepFailed, Target
from variational.solvers.failure import NotConverged
from variational.solvers.stability import StabilityCheck
from variational.solvers.transfer import StateSnapshot, give
from variational.state import ContactState, RidgeStates, StepRecord

Array = NDArray[np.float64]
_STEADY = 1e-6  # relative change of f_t that sliding on at full slip may cause, beside that of gaps not closed
_BALANCED = 1e-6  # largest part of f_ext that may be left at a node, and by which bone and screen may disagree


class Simulation:
    """A scene's finger and the path of its loads.

    Attributes:
        ridges: numbers of the ridges that can touch, of the whole finger.
        plan: the parts of the model that the scene needs.
        checks: stability of the state at the end of each load, at first full slip and after each jump, by step.
        states: the accepted states so far, and states from elsewhere, which have no record of a step.
        unknowns: number of unknowns.
    """

    def __init__(
        self,
        scene: Scene,
        needed: ModelOptions,
        comm: MPI.Comm,
        on_step: Callable[[Step, float], None],
        on_load: Callable[[], None],
    ) -> None:
        """Mesh the finger and set the solver up.

        Args:
            scene: a checked scene.
            needed: the parts of the model that it needs.
            comm: communicator of the mesh.
            on_step: called on every rank after each accepted step with the part of the whole history that is done.
            on_load: called on every rank when a load has been reached.
        """
        self.scene, self.on_step, self.on_load = scene, on_step, on_load
        self.profiles = Profiles(scene.geometry)
        self.plan = needed
        half = not needed.both_halves
        self.body = _meshed(scene, needed, comm)
        body, contact, numerics = self.body, scene.contact, scene.numerics
        interface = Interface(
            contact.law(), scene.friction_law(), scene.h_0, ELECTROSTATIC if self.plan.voltage else None
        )
        self.closure = scene.closure() if self.plan.voltage else None
        made = Body(
            body,
            {tag: solid for tag, solid in scene.solids().items() if tag in body.layers().values()},
            interface,
            self.closure,
            element=numerics.element,
            points=numerics.quadrature_points,
            force_scale=max((load.f_ext for load in scene.loads() if load.f_ext), default=1.0),
            tolerance=numerics.tolerance,
            mirror=body.facets(tags.SYMMETRY) if half else None,
            coupling_tolerance=numerics.coupling_tolerance,
            coupling_cap=numerics.coupling_cap,
            by_gap=contact.length == "gap",
            on_accept=self._accepted,
            step_scale=numerics.step_scale,
        )
        self.problem, self.solver, self.observer = made.problem, made.solver, made.observer
        self.coupling, self.continuation = made.coupling, made.continuation
        self.ridges = symmetry.names(made.surface.names) if half else made.surface.names
        shortest = float(np.min(comm.allgather(made.surface.length.min(initial=np.inf))))
        self._contact_size = scene.mesh.contact if scene.laws.mesh is None else shortest
        self.energy = EnergyBook(self.problem, *self._state(), copies=self._copies)
        self.unknowns = self.solver.layout.global_size
        self.states: list[ContactState] = []
        self.checks: dict[int, Checked] = {}
        self._stability = StabilityCheck(self.solver)
        self._load, self._loads_done = "", 0.0
        self._zone = ContactZone(scene, needed, body, self.observer)

    def run(self) -> None:
        """Reach every load of the scene.

        Raises:
            StepFailed: a load that could not be reached; everything accepted before was reported.
            RestartRequired: what the plan left out matters.
        """
        loads = self.scene.loads()
        for k, load in enumerate(loads):
            self._load, self._loads_done = load.name, float(k)
            self.continuation.run(_target(load))
            self._check_stability()
            while load.until_full_slip and self.continuation.slip[1]:
                ahead = self._ahead(load)
                if self._slides_on(load) or ahead * self._ahead(load) <= 0:  # or at the end of the slide
                    break
                self.continuation.run(_target(load))
                self._check_stability()
            self.on_load()

    @property
    def force_error(self) -> float:
        """What the solves' tolerance leaves of a sum of nodal forces (N/m), see :func:`force_error`."""
        left = max(self.scene.numerics.tolerance, self.solver.floor)
        return force_error(self.unknowns, left, self.solver.force_scale)

    @property
    def balanced(self) -> float:
        """Largest force, over the solver's force scale, that an accepted state may leave at a node or of its sum."""
        return _BALANCED

    def ridge_loads(self) -> RidgeLoads:
        """Return the resultants of all ridges that can touch, of the whole finger; collective."""
        loads = self.observer.ridge_loads(self.continuation.surface_state)
        return loads if self.plan.both_halves else symmetry.loads(loads)

    def resultants(self, loads: RidgeLoads) -> dict[str, Any]:
        """Return what bone and ridges bear in the present state, in SI, by the names of :class:`ContactState`."""
        reaction = self.solver.reaction
        f_ext, f_t = float(reaction[1]), 0.0 - float(reaction[0])  # no negative zero
        return {
            "f_ext": f_ext,
            "bone_height": float(self.solver.bone[1]),
            "f_t": f_t,
            "mu_app": f_t / f_ext if f_ext > _BALANCED * self.solver.force_scale else 0.0,
            "f_contact": float(loads.f_contact.sum()),
            "f_electrostatic": float(loads.f_attraction.sum()),
            "ridges_in_contact": int((loads.length > 0).sum()),
            "contact_length": float(loads.length.sum()),
        }

    def adopt(self, carried: StateSnapshot, name: str, direction: int = 0) -> None:
        """Solve again for a state that was reached on another mesh of the same finger.

        Args:
            carried: the state.
            name: what it is called in a failure.
            direction: 1 or -1 for a state of full slip, the way the bone slides; zero for another.

        Raises:
            StepFailed: no equilibrium was found from there, or it is none (forces out of balance, skin where it was not
                expected to touch), or full slip is no longer full or not steady.
        """
        try:
            self._adopt(carried, name, direction)
        except (RestartRequired, FingerExceeded) as error:
            raise StepFailed(
                f"{name}, solved again with a contact size of {self.scene.mesh.contact:g} m: {error}"
            ) from error

    def _adopt(self, carried: StateSnapshot, name: str, direction: int) -> None:
        give(carried, self.coupling, direction * SLIDE_ON)
        self._load = name
        self.continuation.adopt(name)
        # What was dissipated on the way is not known.
        self.energy = EnergyBook(self.problem, *self._state(), copies=self._copies)
        loads = self.ridge_loads()
        self._check_balance(loads)
        self._zone.check(self.ridges, loads)
        self.states.append(self._placed(self.present(loads).state, probe=False))
        ahead = Load.model_construct(name=name, bone_x=self.solver.control.x + direction)
        if direction and not self._slides_on(ahead):
            raise StepFailed(
                f"{name}, solved again with a contact size of {self.scene.mesh.contact:g} m, is not steady"
            )

    def _ahead(self, load: Load) -> float:
        return (load.bone_x or 0.0) - float(self.solver.control.x)

    def _slides_on(self, load: Load) -> bool:
        """Slide a little further: full slip is steady, since the screen looks the same everywhere."""
        before, x = self.solver.reaction[0], self.solver.control.x
        direction = np.sign((load.bone_x or 0.0) - x) or 1.0
        self.continuation.run(Target(load.name, bone_x=x + direction * SLIDE_ON))
        return self.continuation.slip[1] and self._unchanged(before, self.solver.reaction[0])

    def _unchanged(self, before: Any, after: Any) -> bool:
        """Return whether forces (N/m) before and after sliding on at full slip are the same."""
        return bool(np.all(np.abs(after - before) <= self._steady() * np.abs(before) + self.force_error))

    def _holds(self) -> bool:
        """Return whether full slip would go on as it is for a further 0.2 mm; none of that is accepted."""
        before, control = self.solver.reaction.copy(), self.solver.control
        found = self.continuation.probe(replace(control, x=control.x - (np.sign(before[0]) or -1.0) * SLIDE_ON))
        return found is not None and found[1] and self._unchanged(before, found[0])

    def _steady(self) -> float:
        """Return the relative change of f_t that means nothing.

        An augmented Lagrangian leaves gaps of up to its tolerance, which close further with each load; the attraction
        goes with the inverse square of the air gap and the insulator behind it.
        """
        left = self.scene.contact.law().tolerance
        return _STEADY + (2 * left / (float(self.coupling.d_eq.min()) + self.scene.h_0) if self.plan.voltage else 0.0)

    def _check_stability(self) -> None:
        step = self.continuation.steps
        if step not in self.checks:
            gain = self.coupling.gain[self.observer.ridge_loads(self.continuation.surface_state).length > 0]
            known = gain[np.isfinite(gain)]
            largest = float(known.max()) if len(known) and self._voltage > 0 else 0.0
            try:
                self.checks[step] = Checked(self._stability.check(), largest)
            except NotConverged as failure:
                raise StepFailed(
                    f"step {step} ({self._load}): its stability cannot be examined: {failure}"
                ) from failure
            if not (self.plan.both_halves or self.checks[step].frozen.stable):
                reason = "the half of the finger is not stable, so that the whole may not be symmetric"
                raise RestartRequired(reason, self.scene, self.plan.with_both_halves())

    @property
    def _copies(self) -> int:
        return 1 if self.plan.both_halves else 2

    # -- reports ---------------------------------------------------------------------------------------
    def _state(self) -> tuple[SurfaceState, Array, Array, Array]:
        solver = self.solver
        return self.continuation.surface_state, solver.bone, solver.reaction, self.coupling.d_eq

    def present(self, loads: RidgeLoads, attempt: Attempt | None = None, touches: bool = False) -> Step:
        """Return the present state as a step without a record of energies and work.

        Args:
            loads: its :meth:`ridge_loads`.
            attempt: how it was solved, where that is known.
            touches: whether the bone was lowered to the first touch.
        """
        state, d_eq = self.continuation.surface_state, self.coupling.d_eq
        if not self.plan.both_halves:
            d_eq = np.array(symmetry.values(list(d_eq)))
        notes = [self.closure.state(float(p), self._voltage) if self.closure else "" for p in loads.p_c]
        slipping, full = self.continuation.slip
        found = ContactState(
            step=self.continuation.steps,
            load="touch" if touches else self._load,
            load_number=int(self._loads_done) + 1,
            voltage=self._voltage,
            bone_x=float(self.solver.bone[0]),
            **self.resultants(loads),
            slipping=slipping,
            all_slip=full,
            mesh_contact=self._contact_size,
            ridges=RidgeStates(
                np.array(self.ridges),
                loads.length,
                loads.f_contact,
                loads.f_friction,
                loads.f_attraction,
                loads.p_c,
                d_eq,
            ),
        )
        return Step(found, notes, attempt or Attempt(), state)

    def _placed(self, state: ContactState, probe: bool) -> ContactState:
        """Return a state with what full slip it is of; where none was held so long yet, a probe may show that it would.

        Args:
            state: not among :attr:`states` yet.
            probe: whether to slide on for that, none of which is accepted.
        """
        began, held = full_slip(self.states, state, self._steady(), self.force_error)
        return replace(state, slip_began=began, slip_held=held or (probe and began > 0 and self._holds()))

    def _accepted(self, target: Target, part: float, attempt: Attempt) -> None:
        loads = self.ridge_loads()
        imbalance = self._check_balance(loads)
        if attempt.jump:
            self._check_stability()
        step = self.present(loads, attempt, target.name == "touch")
        state = self._placed(step.state, probe=part >= 1 and not target.until_full_slip)
        state = replace(state, record=self._record(imbalance, attempt))
        self.states.append(state)
        whole = len(self.scene.loads())
        done = min((self._loads_done + (0.0 if target.name == "touch" else part)) / whole, 1.0)
        self.on_step(replace(step, state=state), done)
        try:
            self._zone.check(self.ridges, loads)
        except FingerExceeded as error:
            raise StepFailed(f"step {self.continuation.steps} ({self._load}): {error}") from error

    @property
    def _voltage(self) -> float:
        return float(self.problem.voltage.value)

    def _record(self, imbalance: float, attempt: Attempt) -> StepRecord:
        """Return energies and work of the step to the present state; collective."""
        energy = self.energy.step(*self._state())
        return StepRecord(
            penetration=self.observer.penetration(self.continuation.surface_state),
            imbalance=imbalance,
            floor=self.solver.floor,
            stored=energy.stored,
            dissipation=energy.dissipation,
            energy_released=energy.released,
            released_error=energy.released_error,
            newton_iterations=attempt.newton,
            factorisations=attempt.factorisations,
            sweeps=attempt.sweeps,
            cutbacks=len(attempt.cutbacks),
            jump=attempt.jump,
        )

    def _check_balance(self, loads: RidgeLoads) -> float:
        """Stop if forces are left at a node, or the bone does not bear what the screen does: no equilibrium.

        Returns:
            The largest force left at a node, over the solver's force scale.
        """
        scale, left = self.solver.force_scale, self.solver.imbalance()
        step, remedy = (
            f"step {self.continuation.steps} ({self._load})",
            (
                f"forces are not balanced to {self.balanced:g} of {scale:g} N/m; try a numerics.tolerance below "
                f"{self.scene.numerics.tolerance:g}, and no PETSc option that ends a solve before it has converged"
            ),
        )
        if not left <= self.balanced:
            raise StepFailed(f"{step}: a force of {left * scale:.4g} N/m is left at a node; {remedy}")
        vertical = float((loads.f_contact - loads.f_attraction).sum())
        screen, bone = np.array([float(loads.f_friction.sum()), vertical]), self.solver.reaction
        worst = int(np.argmax(np.abs(screen - bone)))
        if not abs(screen[worst] - bone[worst]) <= self.balanced * scale:
            raise StepFailed(
                f"{step}: the bone bears {bone[worst]:.9g} N/m {('sideways', 'downwards')[worst]} and the screen "
                f"{screen[worst]:.9g} N/m; {remedy}"
            )
        return left


def _meshed(scene: Scene, needed: ModelOptions, comm: MPI.Comm) -> mesh.TaggedMesh:
    """Return the mesh of a scene's finger."""
    if scene.laws.mesh is not None:
        return mesh.load(comm, meshfile.file(scene.laws.mesh))
    build = partial(fingertip.build, scene.geometry, scene.mesh, needed.receptors, not needed.both_halves)
    return mesh.load(comm, build, tags.LAYERS.values())


def _target(load: Load) -> Target:
    return Target(load.name, load.f_ext, load.bone_height, load.voltage, load.bone_x, load.until_full_slip)
