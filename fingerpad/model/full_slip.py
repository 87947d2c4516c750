r"""Full slip under other loads and laws, solved for from full slip: no path lies between.

At full slip every touching point is at the limit of friction and slips one way. Its traction
:math:`t_t = \mp t_{max}(p_n)` then follows from the pressure, and a state is an equilibrium that does not depend on how
it was reached. So the state at another voltage, force, law of friction, roughness or coating is solved for from a
neighbour, with the anchors of friction far behind the skin
(:class:`variational.solvers.target.Target`). What changes the mesh or the layers is left to a path.

There may be two such states: a ridge that touches already is held down by its attraction, and another one is not drawn
down yet. Then the state depends on the side from which it is reached.
"""

from dataclasses import dataclass, replace

from fingerpad.model.drive_loads import GapFactor
from fingerpad.model.options import FingerModel
from fingerpad.model.simulation import Simulation
from fingerpad.scene.controls import number_of
from variational.coefficients import between
from variational.contact.friction import Friction
from variational.roughness.closure import Closure
from variational.solvers.continuation import StepFailed
from variational.solvers.coupling import Place
from variational.solvers.target import Target
from variational.state import ContactState

_FIELDS = {"anchor", "pressure", "x"}  # of history, that full slip does not depend on


@dataclass(frozen=True)
class Conditions:
    """Loads and laws of full slip."""

    f_ext: float
    """External normal force (N/m)."""
    voltage: float
    friction: Friction | None
    roughness: Closure | None
    """None where there is never a voltage."""
    h_0: float
    """Effective insulator thickness (m)."""
    share: GapFactor | None = None
    """Of each air gap in a drive; None where no drive of the model has losses."""

    @classmethod
    def of(cls, model: FingerModel) -> "Conditions":
        """Return those at the end of a model's loads."""
        force = [force for load in model.loads if (force := number_of(load.f_ext)) is not None]
        voltage = [load.level for load in model.loads if load.level is not None]
        return cls(force[-1], [0.0, *voltage][-1], model.friction, model.closure, model.h_0, model.share)

    def difference(self, other: "Conditions") -> str:
        """Return what these have that others have not, in words."""
        words = {"f_ext": f"f_ext {self.f_ext:g} N/m", "voltage": f"voltage {self.voltage:g} V"}
        words |= {"friction": f"friction {self.friction}", "roughness": f"roughness {self.roughness}"}
        words |= {"h_0": f"an insulator thickness of {self.h_0:g} m", "share": "another drive"}
        return ", ".join(text for name, text in words.items() if getattr(self, name) != getattr(other, name))


@dataclass(frozen=True)
class Solved:
    """A state of full slip, from which others are solved for."""

    conditions: Conditions
    state: ContactState
    place: Place


class FullSlips:
    """Leads a finger from full slip to full slip.

    Attributes:
        simulation: that leads the finger.
        finger: the finger.
    """

    def __init__(self, simulation: Simulation) -> None:
        """Take a simulation, whose loads are reached before :meth:`first`.

        Raises:
            ValueError: friction has a memory, so that full slip depends on its past.
        """
        self.simulation, self.finger = simulation, simulation.finger
        memory = set(self.finger.problem.history.fields) - _FIELDS
        if memory:
            raise ValueError(f"the model has the history {min(memory)!r}, on which full slip may depend")

    def first(self, conditions: Conditions) -> Solved:
        """Return the present state, the end of a path.

        Args:
            conditions: of the path.

        Raises:
            StepFailed: it is no full slip that was held.
        """
        state = self.simulation.states[-1]
        if not state.slip_held:
            raise StepFailed(f"the path ends without full slip over a further 0.2 mm (step {state.step})")
        return Solved(conditions, state, self.finger.continuation.place())

    def solve(self, conditions: Conditions, start: Solved) -> Solved:
        """Return full slip under other conditions, found to be stable; collective.

        Args:
            conditions: whose law of friction is of the kind of the first one.
            start: a neighbour, the nearer the better.

        Raises:
            StepFailed: no steady and stable full slip was found from there.
            ValueError: another kind of law of friction.
        """
        return self.checked(self.reach(conditions, start))

    def reach(self, conditions: Conditions, start: Solved) -> Solved:
        """Return steady full slip under other conditions, whose stability is not examined; see :meth:`solve`."""
        before, path = start.conditions, self.finger.continuation

        def set_laws(part: float) -> None:
            self._set_laws(
                between(before.friction, conditions.friction, part),
                between(before.roughness, conditions.roughness, part),
                (1 - part) * before.h_0 + part * conditions.h_0,
                before.share and conditions.share and before.share.toward(conditions.share, part),
            )

        self._set_laws(before.friction, before.roughness, before.h_0, before.share)
        path.go_to(start.place)
        name = f"full slip from {before.difference(conditions) or 'itself'}"
        target = Target(name, conditions.f_ext, voltage=conditions.voltage, slips=True, constants=set_laws)
        state = self.simulation.slip_to(target)
        if not state.slip_held:
            raise StepFailed(f"{name}: {'full slip is not steady' if state.all_slip else 'not every point slips'}")
        return Solved(conditions, replace(state, reached=name), path.place())

    def checked(self, solved: Solved) -> Solved:
        """Return the present state with its stability; collective.

        Raises:
            StepFailed: it is not stable.
        """
        state, checked = solved.state, self.simulation.checks.check(solved.state.reached)
        if not checked.stable:
            raise StepFailed(f"{state.reached}: full slip is {checked}")
        return replace(solved, state=checked.of(state))

    def _set_laws(
        self, friction: Friction | None, roughness: Closure | None, h_0: float, share: GapFactor | None
    ) -> None:
        problem = self.finger.problem
        problem.set_interface(replace(problem.interface, friction=friction, h_0=h_0, share=share))
        self.finger.closure = self.finger.coupling.closure = roughness
