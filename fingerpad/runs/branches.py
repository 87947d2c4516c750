"""The traces of a force on the whole finger, as branches of one simulation.

The finger is pressed lightly; from there the trace without voltage is followed aside. It is charged, and the charged
trace is followed aside as well. It slides to full slip, and from there the force is raised from full slip to full slip,
without a path between (:mod:`fingerpad.model.full_slip`).
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fingerpad.model.finger import Step
from fingerpad.model.full_slip import Conditions, FullSlips, Solved
from fingerpad.model.options import FingerModel
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.results.states import FIRST_TOUCH
from fingerpad.scene import Load, Scene
from fingerpad.slices import traces
from fingerpad.slices.trace import trace
from fingerpad.slices.traces import Reach, Traced
from fingerpad.startup import MPI
from geometry.units import computed
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import Counts
from variational.solvers.transfer import StateSnapshot
from variational.state import ContactState

POINTS = 16
"""Forces at full slip, from the light one to the largest of the trace."""
QUARTER = 0.25
"""Of the largest force: where full slip is kept besides about at the centre of the finger."""
_BEGIN = {"press": "uncharged", "charge": "charged"}  # traces by the load that they begin with


@dataclass
class Followed:
    """A trace, with some of its states to be solved for again on another mesh."""

    top: float
    """Largest force (N/m) that was asked for."""
    states: list[ContactState] = field(default_factory=list)
    snapshots: list[StateSnapshot] = field(default_factory=list)
    """At growing forces, the last one about at the centre of the finger."""
    anchors: list[ContactState] = field(default_factory=list)
    """The states of these."""
    half: bool = False
    """Whether the snapshots are of one half of the finger."""


class Again(Exception):  # noqa: N818
    """The traces must be followed again with another model."""

    def __init__(self, restart: RestartRequired) -> None:
        super().__init__(restart.reason)
        self.restart = restart


class Branches:
    """Follows the traces of a scene with a force on one mesh.

    Attributes:
        found: the traces by state.
        kept: what there is of each.
        counts: work of all solvers so far.
    """

    def __init__(
        self,
        scene: Scene,
        comm: MPI.Comm,
        on_step: Callable[[Step, float], None],
        on_trace: Callable[[str], None],
        kept: dict[str, Followed],
    ) -> None:
        """Expect the forces of the default finger.

        Args:
            scene: with a force.
            comm: communicator of the mesh.
            on_step: see :class:`fingerpad.model.simulation.Simulation`.
            on_trace: called with the state's name before a trace is followed, and with an empty one after it.
            kept: traces that an earlier command has followed.
        """
        self._scene, self._comm, self._on_step, self._on_trace = scene, comm, on_step, on_trace
        self._reach = Reach(scene, self._made)
        with computed():
            self.section = traces.history(scene.replace(force=None), "full_slip", self._reach.top)
        self.kept, self.found, self.counts = kept, dict[str, Traced](), Counts()
        self._solved: Solved | None = None  # the last full slip

    def follow(self, model: FingerModel) -> None:
        """Follow all traces; collective.

        Args:
            model: whose loads are those of :attr:`section` up to full slip.

        Raises:
            Again: more must be part of the model.
            StepFailed: a state was not found.
            ValueError: full slip depends on its past.
        """
        self.found = {}
        self._simulation = simulation = Simulation(model, self._comm, self._on_step, self._on_load)
        self._slips, self._solved = FullSlips(simulation), None
        conditions = Conditions.of(model)
        try:
            if (restart := simulation.run()) is not None:
                raise Again(restart)
            if "full_slip" in traces.states(self._scene):
                self._solved = self._slips.first(conditions)
                self.found["full_slip"] = self._reach.follow("full_slip")
        finally:
            self.counts.add(simulation.finger.solver.counts)
            simulation.finger.solver.iteration.free()

    def _on_load(self) -> None:
        """Follow the trace that begins with the load that was reached."""
        name = _BEGIN.get(self._simulation.states[-1].load)
        if name is not None:
            self.found[name] = self._reach.follow(name)

    def _made(self, name: str, top: float, tries: int) -> Traced:
        """Return the trace of a state to a largest force."""
        followed = self.kept.get(name)
        if followed is None or followed.top != top:
            self._on_trace(name)
            followed = self._slipped(top) if name == "full_slip" else self._raised(top)
            self.kept[name] = followed
            self._on_trace("")
        return Traced(trace(followed.states, self._scene.geometry.ridge_wavelength), followed.states)

    def _raised(self, top: float) -> Followed:
        """Return the trace of normal contact from the present state on."""
        simulation, found = self._simulation, Followed(top)
        voltage = simulation.states[-1].voltage
        with simulation.aside(), computed():
            loads = [Load(name="raise", f_ext=force) for force in (top / traces.MARGIN, top)]
            simulation.reach(loads, lambda: self._anchor(found))
            if simulation.restart is not None:
                raise Again(simulation.restart)
            del found.snapshots[1:], found.anchors[1:]  # the end, beyond the centre
            found.states = [s for s in simulation.states if s.voltage == voltage and s.load != FIRST_TOUCH]
        return found

    def _slipped(self, top: float) -> Followed:
        """Return the trace of full slip, each state solved for from the one before."""
        slips, now = self._slips, self._solved
        assert now is not None
        before = self.kept.get("full_slip") if now.state.reached != "path" else None
        found = Followed(top, [now.state]) if before is None else replace(before, top=top)
        anchors = (QUARTER * top, top / traces.MARGIN)
        for force in _forces(now.conditions.f_ext, top, anchors):
            try:
                now = slips.reach(replace(now.conditions, f_ext=force), now)
            except StepFailed:
                if self._simulation.restart is not None:
                    raise Again(self._simulation.restart) from None
                raise
            found.states.append(now.state)
            if force in anchors:
                self._anchor(found, now.state)
        self._solved = slips.checked(now)
        return found

    def _anchor(self, found: Followed, state: ContactState | None = None) -> None:
        """Keep the present state as one to be solved for again; collective."""
        snapshot, found.half = self._simulation.snapshot()
        found.snapshots.append(snapshot)
        found.anchors.append(self._simulation.states[-1] if state is None else state)


def _forces(start: float, top: float, among: Sequence[float]) -> list[float]:
    """Return forces (N/m) up to a largest one, about as far from each other as :data:`POINTS` of a whole trace.

    Args:
        start: of the present state.
        top: the largest.
        among: to be among them, where they are above the present one.
    """
    ends = [start, *(force for force in among if start < force < top), top]
    apart = -math.log(traces.LIGHT) / (POINTS - 1)
    found = list[float]()
    for a, b in itertools.pairwise(ends):
        count = max(round(math.log(b / a) / apart), 1)
        found += [*(float(each) for each in np.geomspace(a, b, count + 1)[1:-1]), b]
    return found
