"""The traces of a force on the whole finger, as branches of one simulation.

The finger is pressed lightly; from there the trace without voltage is followed aside. It is charged, and the charged
trace is followed aside as well. It slides to full slip, and from there the force is raised from full slip to full slip,
without a path between (:mod:`fingerpad.model.full_slip`).
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fingerpad.accuracy.solves import StateRecorder
from fingerpad.accuracy.states import State
from fingerpad.model.finger import Step
from fingerpad.model.full_slip import Conditions, FullSlips, Solved
from fingerpad.model.options import FingerModel
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.results.interrupt import Interrupted
from fingerpad.results.quantities import Output
from fingerpad.results.states import FIRST_TOUCH
from fingerpad.scene import Load, Scene
from fingerpad.slices import traces
from fingerpad.slices.trace import trace
from fingerpad.slices.traces import Reach, Traced
from fingerpad.startup import MPI
from geometry.units import computed
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import Counts
from variational.state import ContactState

POINTS = 24
"""Forces at full slip, from the light one to the largest of the trace, at equal steps of their roots: of the
indentation, by about as much as lies between a ridge that comes down and the next one."""
LIGHT = 1 / 100
"""Light force over the largest of a trace. Slices under less are extrapolated, which is a part of the error."""
KEPT = 0.35
"""Of the largest force: where a state is kept besides about at the centre of the finger."""
_BEGIN = {"press": "uncharged", "charge": "charged"}  # traces by the load that they begin with


@dataclass
class TraceStates:
    """A trace, with some of its states to be solved for again on the scene's own mesh."""

    top: float
    """Largest force (N/m) that was asked for."""
    states: list[ContactState] = field(default_factory=list)
    anchors: list[State] = field(default_factory=list)
    """Those, at growing forces, the last one about at the centre of the finger."""


class RestartTraces(Exception):  # noqa: N818
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
        force_error: what the tolerance of solves leaves of a force (N/m).
    """

    def __init__(
        self,
        scene: Scene,
        comm: MPI.Comm,
        on_step: Callable[[Step, float], None],
        on_trace: Callable[[str], None],
        kept: dict[str, TraceStates],
        pause: Callable[[], None],
        outputs: Sequence[Output] = (),
    ) -> None:
        """Expect the forces of the default finger.

        Args:
            scene: with a force.
            comm: communicator of the mesh.
            on_step: see :class:`fingerpad.model.simulation.Simulation`.
            on_trace: called with the state's name before a trace is followed, and with an empty one after it.
            kept: traces that an earlier command has followed.
            pause: called before each state of full slip; may raise to stop.
            outputs: of one's own, that are summed.
        """
        self._scene, self._comm, self._on_step, self._on_trace = scene, comm, on_step, on_trace
        self._pause, self._outputs = pause, outputs
        self._reach = Reach(scene, self._made)
        with computed():
            light = max(LIGHT, traces.SMALLEST / self._reach.top)
            self.section = _sliding(scene.replace(force=None), self._reach.top, light)
        self.kept, self.found, self.counts, self.force_error = kept, dict[str, Traced](), Counts(), 0.0
        self._solved: Solved | None = None  # the last full slip

    def follow(self, model: FingerModel) -> None:
        """Follow all traces of a model, whose loads are those of :attr:`section` up to full slip; collective.

        Raises:
            RestartTraces: more must be part of the model.
            StepFailed: a state was not found.
        """
        self.found = {}
        self._simulation = simulation = Simulation(model, self._comm, self._on_step, self._on_load)
        self._slips, self._solved = FullSlips(simulation), None
        self._recorder = StateRecorder(simulation)
        conditions = Conditions.of(model)
        try:
            if (restart := simulation.run()) is not None:
                raise RestartTraces(restart)
            if "full_slip" in traces.states(self._scene):
                self._solved = self._slips.first(conditions)
                self.found["full_slip"] = self._reach.follow("full_slip")
        finally:
            self.force_error = simulation.finger.force_error
            self.counts.add(simulation.finger.solver.counts)
            simulation.finger.solver.iteration.free()

    def _on_load(self) -> None:
        """Follow the trace that begins with the load that was reached."""
        name = _BEGIN.get(self._simulation.states[-1].load)
        if name is not None:
            self.found[name] = self._reach.follow(name)

    def _made(self, name: str, top: float) -> Traced:
        """Return the trace of a state to a largest force."""
        followed = self.kept.get(name)
        if followed is None or followed.top != top:
            self._on_trace(name)
            followed = self._slipped(top) if name == "full_slip" else self._raised(name, top)
            self.kept[name] = followed
            self._on_trace("")
        smooth = name == "full_slip"
        made = trace(followed.states, self._scene.geometry.ridge_wavelength, smooth, self._outputs)
        return Traced(made, followed.states)

    def _raised(self, name: str, top: float) -> TraceStates:
        """Return the trace of normal contact from the present state on."""
        simulation, found = self._simulation, TraceStates(top)
        voltage = simulation.states[-1].voltage
        with simulation.aside(), computed():
            forces = (KEPT * top, top / traces.MARGIN, top)
            loads = [Load(name="raise", f_ext=force) for force in forces]
            simulation.reach(loads, lambda: self._anchor(found, name))
            if simulation.restart is not None:
                raise RestartTraces(simulation.restart)
            del found.anchors[-1]  # the end, beyond the centre
            found.states = [s for s in simulation.states if s.voltage == voltage and s.load != FIRST_TOUCH]
        return found

    def _slipped(self, top: float) -> TraceStates:
        """Return the trace of full slip, each state solved for from the one before."""
        slips, now = self._slips, self._solved
        assert now is not None
        before = self.kept.get("full_slip") if now.state.reached != "path" else None
        found = TraceStates(top, [now.state]) if before is None else replace(before, top=top)
        anchors = (KEPT * top, top / traces.MARGIN)
        for force in _forces(now.conditions.f_ext, top, anchors):
            self._pause()
            try:
                now = slips.reach(replace(now.conditions, f_ext=force), now)
            except StepFailed as error:
                if isinstance(error, Interrupted):
                    raise
                if self._simulation.restart is not None:
                    raise RestartTraces(self._simulation.restart) from None
                if force in (*anchors, top):
                    raise
                continue  # the trace has one point less
            found.states.append(now.state)
            if force in anchors:
                self._anchor(found, "full_slip")
        self._solved = slips.checked(now)
        return found

    def _anchor(self, found: TraceStates, name: str) -> None:
        """Keep the present state as one to be solved for again; collective."""
        self._recorder.keep(name)
        found.anchors.append(self._recorder.states[name])


def _sliding(scene: Scene, top: float, light: float) -> Scene:
    """Return the scene of a finger that is pressed by the light part of a force (N/m), charged, slid and pressed on."""
    far = scene.slide_length
    loads: list[dict[str, float | str | bool]] = [{"name": "press", "f_ext": top * light}]
    loads += [{"name": "charge", "voltage": scene.volts}] if scene.volts else []
    loads += [{"name": "slide", "bone_x": far / 4, "until_full_slip": True}]
    return scene.replace(history=[*loads, {"name": "raise", "f_ext": top, "bone_x": far}])


def _forces(start: float, top: float, among: Sequence[float]) -> list[float]:
    """Return forces (N/m) up to a largest one, whose roots are about as far apart as those of :data:`POINTS`."""
    ends = [start, *(force for force in among if start < force < top), top]
    apart = (1 - LIGHT**0.5) * top**0.5 / (POINTS - 1)
    found = list[float]()
    for a, b in itertools.pairwise(ends):
        roots = np.linspace(a**0.5, b**0.5, max(round((b**0.5 - a**0.5) / apart), 1) + 1)
        found += [*(float(each) ** 2 for each in roots[1:-1]), b]
    return found
