"""A finger's states solved for again on another mesh than that of their path.

Where ridges adhere without a load, or are about to, a mesh can have several states that differ in the facets in contact
at the end of a ridge. If skin jumps as one is solved for, roundoff can decide to which it comes; the jump is therefore
reported with the ridge that adheres.
"""

from mpi4py import MPI

from fingerpad.accuracy.states import State
from fingerpad.model.adhesion import adhering, lost
from fingerpad.model.checks import FingerExceeded
from fingerpad.model.options import FingerModel
from fingerpad.model.simulation import Simulation
from fingerpad.results.states import SLIDE_ON
from variational.contact.formulation import Formulation
from variational.solvers.continuation import Attempt, StepFailed
from variational.solvers.transfer import restore

_JUMPED = "skin jumped on the way, and roundoff (the number of ranks) may have chosen this state among others"


class StateSolver(Simulation):
    """A finger on a mesh of its own, on which states from elsewhere are solved for, without a path.

    Attributes:
        doubts: states that roundoff may have chosen among others, in words.
    """

    def __init__(self, model: FingerModel, comm: MPI.Comm) -> None:
        """Mesh the finger and set the solver up; collective."""
        super().__init__(model, comm)
        self.doubts: list[str] = []

    def re_equilibrate(self, state: State, name: str) -> None:
        """Solve again for a state that was reached on another mesh of the same finger; collective.

        Args:
            state: as it was found there.
            name: what it is called in a failure.

        Raises:
            StepFailed: no equilibrium was found from there, or it is none (forces out of balance, skin where it was not
                expected to touch), or full slip is no longer full or not steady. It names a ridge that adheres.
        """
        again = f"{name}, solved again with a contact size of {self.finger.contact_size:g} m"
        closure = self.model.closure
        try:
            restore(state.snapshot, self.finger.coupling, state.direction * SLIDE_ON)
        except ValueError as error:  # meshes so coarse that one does not have the shape of the other
            raise StepFailed(f"{again}: {error}") from error
        try:
            attempt = self._restored(state, name, again)
        except StepFailed as error:
            raise StepFailed(lost(error, state.state, closure)) from error
        adheres = adhering(self.states[-1], closure)
        if attempt.jump and adheres:
            self.doubts.append(f"{again}: {_JUMPED}: {adheres}")

    def _restored(self, state: State, name: str, again: str) -> Attempt:
        """Return how a state that was put in was solved for."""
        attempt = self._balance(name)
        try:
            steady = not state.direction or self._slip.slides_on(name, state.direction)
        except FingerExceeded as error:
            raise StepFailed(f"{again}: {error}") from error
        if self._restart is not None:
            raise StepFailed(f"{again}: {self._restart.reason}")
        if not steady:
            raise StepFailed(f"{again}, is not steady")
        return attempt

    def over_stiffer_screen(self, formulation: Formulation, name: str, direction: int = 0) -> None:
        """Solve the present state again over springs of twice the stiffness, which bear the same friction; collective.

        Args:
            formulation: the contact over that screen.
            name: of the state.
            direction: 1 or -1 for a state of full slip, the way the bone slides; zero for another.

        Raises:
            StepFailed: no equilibrium was found from there.
        """
        problem = self.finger.problem
        place = problem.history.followed(self.finger.continuation.surface_state.history)["anchor"]
        elastic = problem.history.accepted["anchor"] - place
        problem.history.accept({"anchor": place + elastic / 2 - direction * SLIDE_ON})
        problem.set_formulation(formulation)
        self._balance(name)

    def _balance(self, name: str) -> Attempt:
        """Solve for an equilibrium from the present fields, and accept it; return how it was solved for."""
        finger = self.finger
        self._load = name
        attempt = finger.continuation.re_equilibrate(name)
        self.energy = finger.book()  # what was dissipated on the way is not known
        loads = finger.ridge_loads()
        finger.check_balance(loads, name)
        self.states.append(self._slip.placed(self.states, self.present(loads).state, probe=False))
        try:
            self._restart = self._zone_exceeded(loads)
        except FingerExceeded as error:
            raise StepFailed(f"{name}: {error}") from error
        if self._restart is not None:
            raise StepFailed(f"{name}: {self._restart.reason}")
        return attempt
