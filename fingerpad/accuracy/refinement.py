r"""Named states on a final mesh with their discretisation errors, refined until these are within what a scene asks for.

**Two meshes.** Full slip does not depend on the path of the loads where the same ridges touch. So a path is followed on
elements twice as large as those that the scene gives, and its named states are restored on the final mesh and solved
for again (:mod:`variational.solvers.transfer`), with facets of a sixteenth where their contact ends
(:mod:`fingerpad.accuracy.states`). The difference of the two meshes makes the estimated error
(:mod:`fingerpad.accuracy.richardson`), without a further solve. Where other ridges touch on the final mesh, or a state
is not found there, the path is followed on the scene's sizes, and states on elements twice as large are solved for.

**An accuracy** is met on one mesh after the other. The path is followed once, on the mesh that the scene gives (a
coarse one where it gives no sizes). Each mesh parameter is halved in turn, which gives its share of the error: the size
of the facets (``contact``), of the other elements (``bulk``) and of those at Merkel sites (``receptor``), and the steps
of the loads (``steps``), where normal contact keeps a history of friction. Then those with the largest shares are
halved again, until the estimate is within what is allowed, or the run reports that it is not.

The estimate has factors of safety, and is of the mesh, over the screen as it is; the effect of a penalty is reported
beside it. Not estimated: the effect on normal contact of a friction history that is the first mesh's.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from mpi4py import MPI

from fingerpad.accuracy.estimate import Estimate, of_key
from fingerpad.accuracy.richardson import MeshParameter, errors, rigid, to_refine
from fingerpad.accuracy.solves import follow, solve_again
from fingerpad.accuracy.states import Solve, State, quantities
from fingerpad.model.cautions import lost
from fingerpad.model.options import FingerModel
from fingerpad.model.schedule import loads_to_normal_contact
from fingerpad.model.simulation import RestartRequired
from fingerpad.results.interrupt import Interrupted
from fingerpad.results.states import WORDS
from fingerpad.scene.messages import counted
from geometry.parameters import MeshSize
from geometry.profiles import GeometryError
from variational.contact.formulation import Formulation
from variational.solvers.continuation import StepFailed

_SIZES = {"contact": ("contact",), "bulk": ("growth", "interface", "coarsest"), "receptor": ("receptor",)}
_ROUNDS = 6  # of refinement


class Refinement(Estimate):
    """Estimates errors of a path's states, and lowers them where an accuracy is asked for.

    Attributes:
        refinements: how often each mesh parameter was halved.
        stiffer: the contact over a screen of twice the stiffness; None where the screen is rigid.
        restart: what a path with other steps turned out to need, if anything.
        to_come: solves that are still to come, the one that starts now among them; more where they are not enough.
    """

    def __init__(
        self, model: FingerModel, path: Solve, comm: MPI.Comm, show: Callable[[str], None], pause: Callable[[], None]
    ) -> None:
        """Choose the mesh parameters; ``pause`` is called before each solve and may raise to stop.

        Raises:
            StepFailed: the path has no state in which a quantity asked for is known.
        """
        super().__init__(model, path, comm, show)
        self._pause = pause
        self.restart: RestartRequired | None = None
        self.asked = model.asked
        for name in {"mu_app", "f_t"} & set(self.asked) if "full_slip" not in path.states else ():
            raise StepFailed(
                f"accuracy.{name} is {self.asked[name]:g}, which full slip decides, and that was not reached"
            )
        if "mu_app" in self.asked and math.isnan(path.states["full_slip"].state.mu_app):
            raise StepFailed(
                f"accuracy.mu_app is {self.asked['mu_app']:g}, and at full slip no force presses the finger, so that "
                "mu_app has no value; ask for accuracy.f_t"
            )
        if self.asked and not path.states:
            raise StepFailed("accuracy is given and the history has neither normal contact nor full slip")
        if self.asked:
            path = replace(path, states={name: state for name, state in path.states.items() if name != "uncharged"})
        self.base = self._stepped = path
        self._met = not self.asked
        self.stiffer = model.contact.over_stiffer_screen()
        self.to_come = 1
        keys = [key for key in _SIZES if key != "receptor" or "sed" in self.asked] if self.asked else []
        if model.options.friction and "charged" in path.states and {"contact_length", "sed"} & set(self.asked):
            keys.append("steps")
        self.parameters = {key: MeshParameter(degree=self.degree) for key in keys}
        self.refinements = dict.fromkeys(keys, 0)

    def run(self) -> RestartRequired | None:
        """Estimate, and refine until what is asked for is met or cannot be; collective.

        Returns:
            What must be changed of the model and why, where the path turns out to need it.

        Raises:
            Interrupted: ``pause`` stopped the run.
        """
        try:
            if self.asked:
                self._refine()
            elif self.base.states:
                restart = self._solve_on_final_mesh()
                if restart is not None:
                    return restart
                self._report()
                self._penalty(self.base)
        except Interrupted:
            raise
        except (StepFailed, GeometryError) as error:
            if self.asked:
                self.failure = f"the accuracy asked for could not be established: {error}"
            else:
                self._note(f"discretisation errors could not be estimated: {error}")
        return self.restart

    def _solve_on_final_mesh(self) -> RestartRequired | None:
        """Solve the states again on the mesh that the scene gives, finest where their contact ends.

        Returns:
            That the path must be followed on that mesh, where other ridges touch than on the path's.
        """
        path, model = self.base, self.model
        final = model.mesh if model.final is None else model.final
        reason = ""
        try:
            fine = self._on_mesh(final, path.states, True, self.stiffer)
            others = [name for name in path.states if _ridges(path, name) != _ridges(fine, name)]
            if others:
                name = others[0]
                here = counted(_ridges(fine, name), "ridge touches", "ridges touch")
                reason = f"{here} at {WORDS[name]} on the final mesh, and on that of the path {_ridges(path, name)}"
                reason = lost(reason, fine.states[name].state, model.closure)
        except StepFailed as error:
            if model.mesh == final or isinstance(error, Interrupted):
                raise
            reason = str(error)
        if reason and model.mesh != final:
            return RestartRequired(f"{reason}; the path is followed on the final mesh", model.changed(mesh=final))
        coarser = model.coarser(final)
        self.compare(path if path.mesh == coarser else self._on_mesh(coarser, path.states), fine)
        return None

    def _penalty(self, solve: Solve) -> None:
        """Estimate what a rigid screen would change, from states over one of twice the stiffness."""
        if solve.stiffer is None:
            if solve.soft:
                self._note(f"the effect of the penalty could not be estimated: {solve.soft}")
            return
        self.penalty = rigid(solve.values(), solve.stiffer.values())
        listed = []
        for name, value in self.penalty.items():
            if "_sed_" not in name:
                quantity, words = of_key(name)
                listed.append(f"{words} by {value * quantity.scale:.2g} {quantity.unit}".rstrip())
        self._show(f"penalty: a rigid screen would change {', '.join(listed)}")

    def _refine(self) -> None:
        todo = list(self.parameters)
        for _ in range(1 + _ROUNDS):
            for k, key in enumerate(todo):
                self.to_come = len(todo) - k + (self.stiffer is not None)
                self._halve(key)
            self._report()
            todo = to_refine(self.parameters, self.allowed())
            if not todo:
                self._met = True
                break
        else:
            self.failure = f"the estimate is not within the accuracy asked for after {_ROUNDS} refinements"
        if self.stiffer is not None and self.restart is None:
            self.to_come = 1
            try:
                self._penalty(self._on_mesh(self.base.mesh, self.base.states, stiffer=self.stiffer))
            except (StepFailed, GeometryError) as error:
                if isinstance(error, Interrupted):
                    raise
                self._note(f"the effect of the penalty could not be estimated: {error}")

    def allowed(self) -> dict[str, float]:
        """Return the largest error allowed of each quantity that is asked for, in its unit."""
        found = {}
        for name, state in self.base.states.items():
            for quantity, value in quantities(name, state).items():
                key = f"{name}_{quantity}"
                if "sed" in self.asked and quantity.startswith("sed_"):
                    found[key] = self.asked["sed"] * max(state.sed.values(), default=0.0)
                elif quantity in self.asked:
                    found[key] = self.asked[quantity] * abs(value)
        return found

    def estimates(self) -> dict[str, float]:
        """Return the estimated error of each quantity, in its unit; none before every parameter was changed."""
        if not self.asked:
            return super().estimates()
        if not all(parameter.changes for parameter in self.parameters.values()):
            return {}
        return errors(self.parameters, list(self.base.values()))

    def summary(self) -> dict[str, Any]:
        """Return how errors were found, ready for JSON; collective."""
        step_scale = self._step_scale(self.refinements.get("steps", 0))
        met = {"reached": self._met and not self.failure, "step_scale": step_scale}
        return super().summary() | met

    def _shares(self, name: str, error: float) -> dict[str, float]:
        if not self.asked:
            return super()._shares(name, error)
        return {key: each.share(name) for key, each in self.parameters.items() if each.acts_on(name)}

    def _halve(self, key: str) -> None:
        """Halve a mesh parameter, record what that changes, and go on from there."""
        if key == "steps" and not self.parameters[key].changes:
            self._record(key, self._with_steps(self._step_scale(-1)), self.found[0])
            return
        self.refinements[key] += 1
        if key == "steps":
            finer = self._with_steps(self._step_scale(self.refinements[key]))
            self._record(key, self._stepped, finer)
            self._stepped = finer
            self.base = self._on_mesh(self.base.mesh, {**self.base.states, **finer.states})
            return
        first, numbers = self.model.mesh, self.refinements.items()
        sizes = {size: getattr(first, size) / 2**n for each, n in numbers for size in _SIZES.get(each, ())}
        finer = self._on_mesh(first.model_copy(update=sizes), self.base.states, True)
        self._record(key, self.base, finer)
        self.base = finer

    def _record(self, key: str, coarse: Solve, finer: Solve) -> None:
        self.parameters[key].record(coarse.parts(), finer.parts())
        for name in sorted(coarse.states.keys() & finer.states.keys()):
            before, now = (s.states[name].state.ridges_in_contact for s in (coarse, finer))
            if before != now:
                self.notes.append(
                    f"halving {key}: {counted(now, 'ridge')} in contact at {WORDS[name]} instead of {before}"
                )

    def _on_mesh(
        self, mesh: MeshSize, states: Mapping[str, State], views: bool = False, stiffer: Formulation | None = None
    ) -> Solve:
        """Return states on a mesh of other element sizes; collective; see :func:`solve_again`."""
        self._pause()
        return self._keep(solve_again(self.model.changed(mesh=mesh), states, self._comm, views, stiffer))

    def _with_steps(self, step_scale: float) -> Solve:
        """Return normal contact on the first mesh from a path whose largest steps have another scale; collective.

        Raises:
            StepFailed: the path was lost, or needs more of the model (:attr:`restart`).
        """
        numerics = self.model.numerics.model_copy(update={"step_scale": step_scale})
        loads = loads_to_normal_contact(self.model.loads)
        model = self.model.changed(mesh=self.found[0].mesh, loads=loads, numerics=numerics)
        self._pause()
        found = follow(model, self._comm)
        if isinstance(found, RestartRequired):
            more = self.model.changed(mesh=found.model.mesh, options=found.model.options)
            self.restart = replace(found, model=more)
            raise StepFailed(found.reason)
        return self._keep(found)

    def _keep(self, solve: Solve) -> Solve:
        self.found.append(solve)
        m = solve.mesh
        self._show(
            f"states on another mesh: facets {m.contact * 1e6:.4g} µm, growth {m.growth:.3g}, "
            f"junctions {m.interface * 1e6:.4g} µm, receptors {m.receptor * 1e6:.4g} µm: "
            f"{solve.unknowns} unknowns, {solve.factorisations} factorisations"
        )
        return solve

    def least(self) -> float:
        """Return the processor time (s) of this rank of the last solve on another mesh; 0 where none was made.

        Those to come have no larger elements, and take as much at least, about.
        """
        return next((s.processor_seconds for s in reversed(self.found) if s.mesh != self.found[0].mesh), 0.0)

    def _step_scale(self, refinements: int) -> float:
        return self.model.numerics.step_scale * 0.5**refinements


def _ridges(solve: Solve, name: str) -> int:
    return solve.states[name].state.ridges_in_contact
