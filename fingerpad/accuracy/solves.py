"""The states of a path solved for again: on other meshes, with other steps, over a stiffer screen; and their cost."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI

from fingerpad.accuracy.recompute import Solve, State, StateRecorder, solve_again
from fingerpad.accuracy.rigid_screen import over_stiffer
from fingerpad.model.finger import Step
from fingerpad.model.memory import refuse_beyond
from fingerpad.model.options import FingerModel
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.scene import Load
from geometry.parameters import MeshSize
from variational.contact.formulation import Formulation
from variational.solvers.continuation import StepFailed


class Solves:
    """All solves of a path's states, the path's first.

    Attributes:
        found: the solves, in order.
        restart: what a path with other steps turned out to need, if anything.
    """

    def __init__(
        self,
        model: FingerModel,
        path: Solve,
        comm: MPI.Comm,
        show: Callable[[str], None],
        pause: Callable[[], None],
    ) -> None:
        """Start with the path's states; arguments as of :class:`fingerpad.accuracy.refinement.Refinement`."""
        self._model = model
        self._comm, self._show, self._pause = comm, show, pause
        self.found = [path]
        self.restart: RestartRequired | None = None

    def on_mesh(self, mesh: MeshSize, states: Mapping[str, State]) -> Solve:
        """Return states on a mesh; collective.

        Args:
            mesh: element sizes.
            states: as they were found on another mesh.

        Raises:
            GeometryError: the mesh would need too much memory.
            StepFailed: a state was not found.
        """
        model = self._model
        refuse_beyond(model.geometry, mesh, model.numerics, model.options)
        return self._again(model.changed(mesh=mesh), states)

    def over_stiffer_screen(self, base: Solve, contact: Formulation) -> Solve:
        """Return states over a screen of twice the stiffness; collective.

        Args:
            base: the states.
            contact: over that screen.

        Raises:
            StepFailed: a state was not found.
        """
        model = self._model.changed(mesh=base.mesh, contact=contact)
        states = {name: replace(s, snapshot=over_stiffer(s.snapshot)) for name, s in base.states.items()}
        return self._again(model, states)

    def _again(self, model: FingerModel, states: Mapping[str, State]) -> Solve:
        self._pause()
        return self._keep(solve_again(model, states, self._comm, bool(model.asked)))

    def with_steps(self, step_scale: float) -> Solve:
        """Return normal contact on the first mesh from a path with other steps; collective.

        Args:
            step_scale: factor on the largest steps.

        Raises:
            StepFailed: the path was lost, or needs more of the model (:attr:`restart`).
        """
        numerics = self._model.numerics.model_copy(update={"step_scale": step_scale})
        loads = loads_to_normal_contact(self._model.loads)
        model = self._model.changed(mesh=self.found[0].mesh, loads=loads, numerics=numerics)
        self._pause()
        recorder: StateRecorder | None = None

        def on_step(step: Step, done: float) -> None:
            assert recorder is not None
            recorder.record(step)

        simulation = Simulation(model, self._comm, on_step)
        recorder = StateRecorder(simulation)
        restart = simulation.run()
        if restart is not None:
            more = self._model.changed(mesh=restart.model.mesh, options=restart.model.options)
            self.restart = replace(restart, model=more)
            raise StepFailed(restart.reason)
        return self._keep(recorder.solve())

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
        """Return the processor time (s) of this rank that a solve to come takes at least, about; 0 where not known.

        It is that of the last solve on another mesh than the path's, since those to come have no larger elements.
        """
        return next((s.processor_seconds for s in reversed(self.found) if s.mesh != self.found[0].mesh), 0.0)

    def cost(self) -> dict[str, Any]:
        """Return what each solve and all of them took, ready for JSON; collective."""
        seconds = [float(np.sum(self._comm.allgather(solve.processor_seconds))) for solve in self.found]
        return {
            "solves": [
                {
                    "mesh": solve.mesh.model_dump(),
                    "unknowns": solve.unknowns,
                    "factorisations": solve.factorisations,
                    "processor_seconds": spent,
                }
                for solve, spent in zip(self.found, seconds, strict=True)
            ],
            "factorisations": sum(solve.factorisations for solve in self.found),
            "unknowns_times_factorisations": sum(s.unknowns * s.factorisations for s in self.found),
            "processor_seconds": sum(seconds),
        }


def loads_to_normal_contact(loads: tuple[Load, ...]) -> tuple[Load, ...]:
    """Return the loads before the bone first moves sideways with the finger pressed."""
    pressed, place = False, 0.0
    for k, load in enumerate(loads):
        to = load.place(place)
        x = place if to is None else to
        if load.f_ext is not None or load.bone_height is not None:
            pressed = (load.f_ext or 0.0) > 0 or (load.bone_height or 0.0) < 0
        if pressed and x != place:
            return loads[:k]
        place = x
    return loads
