"""Full slip that was reached on coarser elements, solved for again on a scene's own mesh, with errors from both.

A state that was solved for from its neighbour has these numbers as a run has those of its named states: the mesh is
finest where the state's own contact ends, and the difference of the two meshes makes the estimated error
(:func:`fingerpad.richardson.of_two_meshes`). A screen of twice the stiffness makes that of the penalty. Where other
ridges touch on the two meshes, that difference is in it.
"""

from dataclasses import dataclass, replace

from mpi4py import MPI

from fingerpad.accuracy.estimate import errors_of
from fingerpad.accuracy.solves import solve_again
from fingerpad.accuracy.states import Solve, StateRecorder, with_values
from fingerpad.model.options import FingerModel
from fingerpad.model.simulation import Simulation
from fingerpad.richardson import of_two_meshes, rigid
from variational.element import ELEMENTS
from variational.state import ContactState, Errors

_SLIP = "full_slip"


@dataclass(frozen=True)
class Sharpened:
    """Full slip on the mesh that a scene gives."""

    state: ContactState
    """With its estimated errors."""
    solve: Solve
    """What it cost on that mesh."""


class Sharpener:
    """Solves for the full slips of a simulation again.

    Attributes:
        simulation: of which each state is the present one when it is solved for again.
    """

    def __init__(self, simulation: Simulation, comm: MPI.Comm) -> None:
        """Find the receptor sites.

        Args:
            simulation: on the path's mesh.
            comm: communicator of the meshes.
        """
        self.simulation, self._comm, self._recorder = simulation, comm, StateRecorder(simulation)

    def sharpened(self, model: FingerModel, state: ContactState) -> Sharpened:
        """Return the present state on the mesh of a model; collective.

        Args:
            model: with loads and laws of the state, and the :attr:`~fingerpad.model.options.FingerModel.final` sizes.
            state: the present state, at full slip.

        Raises:
            StepFailed: no steady full slip was found on one of the meshes.
        """
        assert model.final is not None
        arc = {"touching_half_arc": self.simulation.model.mesh.touching_half_arc}
        final = model.final.model_copy(update=arc)
        self._recorder.keep(_SLIP)
        path, coarser = self._recorder.solve(), model.coarser(final)
        stiffer = model.contact.over_stiffer_screen()
        fine = solve_again(model.changed(mesh=final), path.states, self._comm, stiffer=stiffer)
        coarse = path
        if path.mesh != coarser:
            coarse = solve_again(model.changed(mesh=coarser), path.states, self._comm)
        facets = {_SLIP: (coarse.states[_SLIP].facet, fine.states[_SLIP].facet)}
        found = of_two_meshes(coarse.parts(), fine.parts(), facets, ELEMENTS[model.numerics.element].degree)
        change = {} if fine.stiffer is None else rigid(fine.values(), fine.stiffer.values())
        mesh, penalty = (errors_of(_SLIP, each) for each in (found, change))
        error = {key: value + abs(penalty.get(key, 0.0)) for key, value in mesh.items()}
        final_state = with_values(state, fine.states[_SLIP])
        return Sharpened(replace(final_state, error=Errors.of(error), penalty=Errors.of(penalty)), fine)
