r"""Results with their discretisation error, and refined until that is within what a scene asks for.

The whole path of the loads is run once, on the mesh that the scene gives (a coarse one where it asks for an accuracy
and says nothing else). Two of its states are then restored on other meshes and solved for again
(:mod:`variational.solvers.transfer`): normal contact, the last state before the bone moves, and full slip. Turning one
knob at a time gives each its share of the error (:mod:`fingerpad.richardson`):

* ``contact``: size of the facets that can touch,
* ``bulk``: growth of the elements, their size on the junctions, and the coarsest,
* ``receptor``: size at the Merkel sites; left out where only other quantities are asked for,
* ``steps``: of the loads, which matters where friction keeps a history, to normal contact; from a path with steps
  twice as long, up to there, on the first mesh. Full slip knows no path.

Where errors are asked for, each knob is halved in turn and the states go on from there; then those with the largest
shares again, until the estimate is within what is allowed, or the program says that it is not. Where only an estimate
is wanted, the mesh stays and each size is doubled: that costs less than the states did. A state in which another
number of ridges touches is noted; it shows as a large share.

What is told is the *estimated discretisation error*: the estimate with its factors of safety, which covers the known
errors in nine of ten cases (``docs/accuracy.md``). It is of the mesh, over the screen as it is. What a penalty does is
told beside it (:mod:`fingerpad.accuracy.rigid_screen`).

Not estimated: what a state of normal contact owes to its friction history having been that of the first mesh.
"""

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fingerpad.accuracy.recompute import Solve, State, StateRecorder, quantities, solve_again, words
from fingerpad.accuracy.rigid_screen import over_stiffer, rigid, stiffened
from fingerpad.io.interrupt import Interrupted
from fingerpad.io.quantities import in_words, scaled
from fingerpad.io.states import PREFIXES
from fingerpad.model.memory import refuse_beyond
from fingerpad.model.options import ModelOptions
from fingerpad.model.simulation import Simulation
from fingerpad.model.steps import Step
from fingerpad.richardson import MeshParameter, errors, plus_minus, to_halve
from fingerpad.scene import Load, Scene
from geometry.parameters import MeshSize
from geometry.profiles import GeometryError
from variational.solvers.continuation import StepFailed
from variational.state import RESULTS, ContactState, Errors

Array = NDArray[np.float64]
_SIZES = {"contact": ("contact",), "bulk": ("growth", "interface", "coarsest"), "receptor": ("receptor",)}
_ROUNDS = 6  # of refinement


class Refinement:
    """Estimates errors from a path's states and refines.

    Attributes:
        base: the states whose errors are estimated.
        halved: how often each size has been halved for them; of the steps, for their path.
        knobs: what halving each changed.
        penalty: by how much a rigid screen would change each quantity, in its unit; empty where there is no penalty.
        solves: all that was solved, the path first.
        notes: what a user should know.
        failure: why an accuracy was not reached, else empty.
    """

    def __init__(
        self,
        scene: Scene,
        needed: ModelOptions,
        path: Solve,
        comm: MPI.Comm,
        say: Callable[[str], None],
        pause: Callable[[], None],
        look: Callable[[Simulation], Any] | None = None,
    ) -> None:
        """Start from a path.

        Args:
            scene: with an ``accuracy``, or only an estimate is made.
            needed: the parts of the model that its states have.
            path: its states.
            comm: communicator of the meshes.
            say: prints a line.
            pause: called between solves; may raise to stop.
            look: see :func:`solve_again`.

        Raises:
            StepFailed: the path has no state in which what is asked for is known.
        """
        self.scene, self._needed, self.comm, self.say, self.pause = scene, needed, comm, say, pause
        self._look = look
        self.asked = {} if scene.accuracy is None else scene.accuracy.tolerances()
        self.base = self._path = self._stepped = path
        self.solves, self.failure = [path], ""
        self.notes: list[str] = []
        self.penalty: dict[str, float] = {}
        for name in {"mu_app", "f_t"} & set(self.asked) if "full_slip" not in path.states else ():
            raise StepFailed(
                f"accuracy.{name} is {self.asked[name]:g}, which full slip decides, and that was not reached"
            )
        if self.asked and not path.states:
            raise StepFailed("accuracy is given and the history has neither normal contact nor full slip")
        self.knobs = {
            key: MeshParameter() for key in _SIZES if key != "receptor" or "sed" in self.asked or self._looks()
        }
        contact = {"contact_length", "sed"} & set(self.asked)
        if scene.friction_law() is not None and "charged" in path.states and contact:
            self.knobs["steps"] = MeshParameter()
        self.halved = dict.fromkeys(self.knobs, 0)

    def _looks(self) -> bool:
        """Return whether errors are to be estimated and no more, of receptors too if they are in the output."""
        return not self.asked and self.scene.output.receptors

    def run(self) -> None:
        """Estimate, and refine until what is asked for is met or cannot be.

        Raises:
            Interrupted: ``pause`` was asked to.
        """
        try:
            if self.asked:
                self._refine()
            elif self.base.states:
                for key in self.knobs:
                    self._see(key, self._at(self._mesh({key: -1})), self.base)
                self._tell()
        except Interrupted:
            raise
        except (StepFailed, GeometryError) as error:
            if self.asked:
                self.failure = f"the accuracy asked for could not be established: {error}"
            else:
                self.notes.append(f"discretisation errors could not be estimated: {error}")
                self.say(self.notes[-1])
        if self.scene.contact.formulation == "penalty" and self.base.states:
            self._stiffen()

    def _stiffen(self) -> None:
        """Solve again over a screen of twice the stiffness."""
        scene = self.scene.model_copy(update={"mesh": self.base.mesh, "contact": stiffened(self.scene.contact)})
        states = {name: replace(s, snapshot=over_stiffer(s.snapshot)) for name, s in self.base.states.items()}
        try:
            found = self._again(scene, states)
        except (StepFailed, GeometryError) as error:
            self.notes.append(f"what the penalty changes could not be estimated: {error}")
            self.say(self.notes[-1])
            return
        self.penalty = rigid(self.base.values(), found.values())
        changes = {name: scaled(name, value) for name, value in self.penalty.items() if "_sed_" not in name}
        told = [f"{in_words(name)} by {value:.2g} {unit}".rstrip() for name, (value, unit) in changes.items()]
        self.say(f"penalty: a rigid screen would change {', '.join(told)}")

    def _refine(self) -> None:
        todo = list(self.knobs)
        for _ in range(1 + _ROUNDS):
            for key in todo:
                self._halve(key)
            self._tell()
            todo = to_halve(self.knobs, self.allowed())
            if not todo:
                return
        self.failure = f"the estimate is not within the accuracy asked for after {_ROUNDS} refinements"

    def allowed(self) -> dict[str, float]:
        """Return the largest error allowed of each quantity that is asked for, in its unit."""
        found = {}
        for name, state in self.base.states.items():
            for quantity, value in quantities(name, state).items():
                key = f"{PREFIXES.get(name, name)}_{quantity}"
                if "sed" in self.asked and quantity.startswith("sed_"):
                    found[key] = self.asked["sed"] * max(state.sed.values(), default=0.0)
                elif quantity in self.asked:
                    found[key] = self.asked[quantity] * abs(value)
        return found

    def estimates(self) -> dict[str, float]:
        """Return the estimated error of each quantity, in its unit; none before every knob was turned."""
        if not all(knob.changes for knob in self.knobs.values()):
            return {}
        return errors(self.knobs, list(self.base.values()))

    def _halve(self, key: str) -> None:
        """Halve a knob, take note of what it changes, and go on from there."""
        if key == "steps" and not self.knobs[key].changes:
            self._see(key, self._with_steps(-1), self._path)
            return
        self.halved[key] += 1
        if key == "steps":
            finer = self._with_steps(self.halved[key])
            self._see(key, self._stepped, finer)
            self._stepped = finer
            self.base = self._at(self.base.mesh, finer.states)
            return
        finer = self._at(self._mesh(self.halved))
        self._see(key, self.base, finer)
        self.base = finer

    def _see(self, key: str, coarse: Solve, finer: Solve) -> None:
        self.knobs[key].see(coarse.parts(), finer.parts())
        for name in sorted(coarse.states.keys() & finer.states.keys()):
            before, now = (s.states[name].state.ridges_in_contact for s in (coarse, finer))
            if before != now:
                self.notes.append(f"halving {key}: {now} ridges in contact at {words(name)} instead of {before}")

    def _mesh(self, halved: Mapping[str, int]) -> MeshSize:
        first = self.scene.mesh
        sizes = {size: getattr(first, size) / 2**n for key, n in halved.items() for size in _SIZES.get(key, ())}
        return first.model_copy(update=sizes)

    def _at(self, mesh: MeshSize, states: Mapping[str, State] | None = None) -> Solve:
        """Return the states on a mesh, from those in use or from others where they are given."""
        scene = self.scene.model_copy(update={"mesh": mesh})
        refuse_beyond(scene, self._needed)
        return self._again(scene, {**self.base.states, **(states or {})})

    def _again(self, scene: Scene, states: Mapping[str, State]) -> Solve:
        self.pause()
        found = solve_again(scene, self._needed, states, self.comm, self._look)
        self._note(found)
        return found

    def _with_steps(self, n: int) -> Solve:
        """Return normal contact on the first mesh from a path whose steps are halved n times."""
        numerics = self.scene.numerics.model_copy(update={"step_scale": self._scale(n)})
        loads = loads_to_normal_contact(self.scene)
        scene = self.scene.model_copy(update={"history": loads, "mesh": self._path.mesh, "numerics": numerics})
        self.pause()
        keeper: StateRecorder | None = None

        def on_step(step: Step, done: float) -> None:
            assert keeper is not None
            keeper.see(step)

        simulation = Simulation(scene, self._needed, self.comm, on_step, lambda: None)
        keeper = StateRecorder(simulation)
        simulation.run()
        found = keeper.solve()
        self._note(found)
        return found

    def _scale(self, halvings: int) -> float:
        return self.scene.numerics.step_scale * 0.5**halvings

    def _note(self, solve: Solve) -> None:
        self.solves.append(solve)
        m = solve.mesh
        self.say(
            f"states on another mesh: facets {m.contact * 1e6:.4g} µm, growth {m.growth:.3g}, "
            f"junctions {m.interface * 1e6:.4g} µm, receptors {m.receptor * 1e6:.4g} µm: "
            f"{solve.unknowns} unknowns, {solve.factorisations} factorisations"
        )

    def _tell(self) -> None:
        values, found = self.base.values(), self.estimates()
        allowed = self.allowed()
        for name, error in found.items():
            if "_sed_" in name:
                continue
            (value, unit), (spread, _) = scaled(name, values[name]), scaled(name, error)
            limit = f", {scaled(name, allowed[name])[0]:.2g} allowed" if name in allowed else ""
            number = f"{plus_minus(value, spread)} {unit}".rstrip()
            self.say(f"{in_words(name)}: {number} (estimated discretisation error){limit}")

    def summary(self) -> dict[str, Any]:
        """Return how errors were found, ready for JSON; collective."""
        values, found, allowed = self.base.values(), self.estimates(), self.allowed()
        quantities_ = {
            name: {
                "value": values[name],
                "error": error,
                "estimate": sum(knob.share(name) for knob in self.knobs.values() if knob.acts_on(name)),
                "penalty": self.penalty.get(name),
                "allowed": allowed.get(name),
                "shares": {k: knob.share(name) for k, knob in self.knobs.items() if knob.acts_on(name)},
            }
            for name, error in found.items()
        }
        seconds = [float(np.sum(self.comm.allgather(solve.processor_seconds))) for solve in self.solves]
        return {
            "reached": not self.failure,
            "mesh": self.base.mesh.model_dump(),
            "step_scale": self._scale(self.halved.get("steps", 0)),
            "quantities": quantities_,
            "notes": self.notes,
            "solves": [
                {
                    "mesh": solve.mesh.model_dump(),
                    "unknowns": solve.unknowns,
                    "factorisations": solve.factorisations,
                    "processor_seconds": spent,
                }
                for solve, spent in zip(self.solves, seconds, strict=True)
            ],
            "factorisations": sum(solve.factorisations for solve in self.solves),
            "unknowns_times_factorisations": sum(s.unknowns * s.factorisations for s in self.solves),
            "processor_seconds": sum(seconds),
        }

    def states(self, path: Mapping[str, ContactState]) -> dict[str, ContactState]:
        """Return the named states of a path with their results on the final mesh, their errors and the penalty's share.

        Args:
            path: the states by name, as the path has them.
        """
        estimates, found = self.estimates(), dict(path)
        for name, kept in self.base.states.items():
            if name in found:
                final = {key: getattr(kept.state, key) for key in (*RESULTS, "f_ext", "ridges", "mesh_contact")}
                parts = (errors_of(name, estimates), errors_of(name, self.penalty))
                found[name] = replace(found[name], **final, error=parts[0], penalty=parts[1])
        return found


def errors_of(name: str, changes: Mapping[str, float]) -> Errors:
    """Return the changes of a named state's quantities, of those by key; densities at receptors are left out."""
    prefix = f"{PREFIXES[name]}_"
    known = {field.name for field in fields(Errors)}
    return Errors(**{k: v for key, v in changes.items() if (k := key.removeprefix(prefix)) in known and k != key})


def loads_to_normal_contact(scene: Scene) -> tuple[Load, ...]:
    """Return the loads before the bone first moves sideways with the finger pressed."""
    loads, pressed, place = scene.loads(), False, 0.0
    for k, load in enumerate(loads):
        x = place if load.bone_x is None else load.bone_x
        pressed |= (load.f_ext or 0.0) > 0 or (load.bone_height or 0.0) < 0
        if pressed and x != place:
            return loads[:k]
        place = x
    return loads
