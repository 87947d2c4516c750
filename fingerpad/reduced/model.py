"""A model of a scene, and what reduced ones have in common: normal contact and full slip, as a full run has them.

A quantity that is not part of a model is NaN in its states, and a note names it. Your own model is a class with one
method, :meth:`Model.solve`, and a line in :data:`fingerpad.runs.solve.MODELS`.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from fingerpad.results.quantities import Output
from fingerpad.scene.materials import adheres
from fingerpad.scene.messages import SceneError, show
from fingerpad.scene.viscosity import viscous_layers
from fingerpad.slices import traces
from fingerpad.slices.total import profile, under_one_force
from fingerpad.slices.trace import refuse_floating, trace
from fingerpad.slices.traces import Reach, Traced
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.results.result import Result
    from fingerpad.runs.context import RunContext
    from fingerpad.scene import Scene
    from fingerpad.slices.finger import WholeFinger

Solve = Callable[["Scene"], "Result"]
"""Returns the result of a scene."""
STATES = ("charged", "full_slip")
"""For which reduced models answer, by their names in :mod:`fingerpad.results.states`."""


class Model(ABC):
    """A way from a scene to its result; what a model can do is an attribute here, and no module compares its name."""

    name: ClassVar[str]
    """In commands, folders and tables."""
    words: ClassVar[str]
    """What it is made of, a sentence without its full stop."""
    meshes: ClassVar[bool] = False
    """Whether it solves on a mesh: it takes PETSc's options, and each point of a sweep is a process of its own."""
    path: ClassVar[bool] = False
    """Whether it follows the loads step by step and writes its own files: steps, fields and pictures of the skin."""
    resumes: ClassVar[bool] = False
    """Whether it goes on from the checkpoint of a run that was cut short."""

    traces: ClassVar[str] = "traces over the force"
    """What a force in newtons is summed over, in words."""
    sums: bool = False
    """Whether the result of a section has the whole finger too: states over many forces cost hardly more than one."""

    def check(self, scene: "Scene") -> None:
        """Refuse a scene before the work, in one sentence; by default one with a history or a mesh of its own.

        Raises:
            SceneError: the model has no answer to the scene.
        """
        check_supported(scene, self.name)

    @abstractmethod
    def solve(self, scene: "Scene", context: "RunContext") -> "Result":
        """Return the result of a scene; collective.

        Args:
            scene: a scene that :meth:`check` has taken.
            context: ranks, folder and console. The summary of a model without a path is written by its caller.

        Raises:
            SceneError: the scene has no result, in one sentence.
        """

    def over_forces(self, scene: "Scene", f_ext: Sequence[float], state: str, solve: Solve) -> list[ContactState]:
        """Return a state of a scene under each of several external forces, for a force in newtons.

        Args:
            scene: with the voltage of all.
            f_ext: external forces (N/m).
            state: ``charged`` or ``full_slip``.
            solve: solves one scene by this model.

        Raises:
            SceneError: the model has no such state of one of them.
        """
        found = [solve(scene.model_copy(update={"f_ext": each})).named.get(state) for each in f_ext]
        states = [each for each in found if each is not None]
        if len(states) < len(f_ext):
            raise SceneError(
                f"the model {self.name!r} has no {state.replace('_', ' ')} at {f_ext[found.index(None)]:.4g} N/m"
            )
        return states

    def of_points(
        self, scene: "Scene", solve: Solve, name: str, expected: float, top: float, outputs: Iterable[Output] = ()
    ) -> Traced:
        """Return the trace of a state of a scene without a force on the whole finger; refuse states without a bone.

        Args:
            scene: of the cross-section.
            solve: solves a scene by this model.
            name: of the state.
            expected: force (N/m) at the centre of the finger, about.
            top: force (N/m) that the trace is to reach.
            outputs: of one's own, that are summed.
        """
        kind = "full_slip" if name == "full_slip" else "charged"
        scene = scene.model_copy(update={"voltage": 0.0}) if name == "uncharged" else scene
        found = self.over_forces(scene, traces.grid(expected, top), kind, solve)
        refuse_floating(found, self.name)
        return Traced(trace(found, scene.geometry.ridge_wavelength, outputs=outputs), found)

    def whole(self, scene: "Scene", solve: Solve, outputs: Sequence[Output] = ()) -> "Result":
        """Return the whole finger under a force, and the section at its centre as named states.

        Args:
            scene: with a force.
            solve: solves a scene without a force on the whole finger by this model.
            outputs: of one's own, that are summed.

        Raises:
            SceneError: a profile that does not fit, or a force that no trace reached.
        """
        section = scene.replace(force=None)

        def make(name: str, top: float) -> Traced:
            return self.of_points(section, solve, name, scene.centre_force, top, outputs)

        found = {name: Reach(scene, make).follow(name) for name in traces.states(scene)}  # none depends on another
        finger = traces.summed(scene, self.traces, found)
        centre = list(found.values())[-1].total.centre / profile(scene.slices).centre_scale  # type: ignore[union-attr]
        if centre < traces.SMALLEST:
            raise SceneError(
                f"force is {scene.force:.4g} N, under which the centre of the finger bears {centre:.2g} N/m, and it "
                f"must bear at least {traces.SMALLEST:g} N/m; give a larger force or a shorter finger"
            )
        return self.of_finger(scene, solve(scene.replace(f_ext=centre)), finger)

    def with_sum(self, result: "Result", solve: Solve, outputs: Sequence[Output] = ()) -> "Result":
        """Return the result of a section with its whole finger, or with a note why it has none; see :meth:`whole`.

        The centre of the finger bears the section's force in one of the named states, and less in the others.
        """
        scene, f_ext = result.scene, result.scene.f_ext
        try:
            names = traces.states(scene)
            found = {name: self.of_points(scene, solve, name, f_ext, f_ext, outputs) for name in names}
            made = {name: each.trace for name, each in found.items()}
            totals = under_one_force(profile(scene.slices), made, scene.slices.count, f_ext)
            found = {name: each._replace(total=totals[name]) for name, each in found.items()}
            return self.of_finger(scene, result, traces.summed(scene, self.traces, found))
        except SceneError as error:
            return replace(result, notes=(*result.notes, f"{traces.NO_NEWTONS}: {error}"))

    def of_finger(self, scene: "Scene", section: "Result", finger: "WholeFinger") -> "Result":
        """Return the result of a force on the whole finger.

        Args:
            scene: with the force.
            section: result of the section at the centre of the finger.
            finger: the finger.
        """
        return replace(section, scene=scene, finger=finger)


def reduced_state(scene: "Scene", contact: Mapping[str, float], slips: bool) -> ContactState:
    """Return normal contact, in which by symmetry there is no friction, or full slip.

    At full slip f_T is the limit of friction, of the mean pressure over the contact length. Coulomb's is mu_0 times the
    contact force, however that is spread.

    Args:
        scene: whose loads act.
        contact: contact force, attraction, contact length and ridges in contact, and the bone's height if known.
        slips: whether at full slip.
    """
    values: dict[str, Any] = {**contact, "ridges_in_contact": int(contact["ridges_in_contact"])}
    law = scene.friction_law() if slips else None
    f_t = 0.0 if law is None else law.resultant(contact["f_contact"], contact["contact_length"])
    return ContactState(f_ext=scene.f_ext, voltage=scene.volts, f_t=f_t, mu_app=f_t / scene.f_ext, **values)


def check_supported(scene: "Scene", model: str) -> None:
    """Refuse a scene whose loads are not press, charge and slide, or whose finger has a mesh, is viscous or adheres.

    Raises:
        SceneError: it has a history, a mesh, viscous layers or adhesion.
    """
    why, timeless = "", f"the model '{model}' has no time, so use the model 'full' with loads over time, or"
    law = scene.friction_law()
    if viscous := viscous_layers(scene.materials):
        why = f"{viscous[0]}.viscosity is given; {timeless} leave the viscosity out"
    elif law is not None and law.memory is not None:
        why = f"friction is {type(law).__name__}; {timeless} another law"
    elif adheres(scene.adhesion):
        why = f"adhesion is {scene.adhesion}, which the model '{model}' does not have; use the model 'full'"
    elif scene.geometry.file is not None:
        why = (
            f"geometry.file is {show(scene.geometry.file)}; the model '{model}' answers for fingers of the scene's own "
            "geometry, so use the model 'full'"
        )
    elif scene.history is not None:
        why = (
            f"history is given; the model '{model}' answers for press, charge and slide alone, so use the model 'full' "
            "or give f_ext and voltage instead"
        )
    if why:
        raise SceneError(why)
