r"""Discretisation errors of a path whose states have a past: from the same path on elements twice as large.

A state of viscous layers cannot be solved again on another mesh, since what the layers keep of their past is of their
own mesh. So the whole path is followed on the mesh that the scene gives, whose states are the results, and once more on
elements twice as large. The difference of the named states makes their estimated errors
(:func:`fingerpad.accuracy.richardson.of_two_meshes`). Facets where contact ends are those of the two meshes, and not
shorter as on the final mesh of other runs. So friction has the order of lengths in contact, p = 1, as where an accuracy
is met.

In loads over time the two paths are compared over time as well (:mod:`fingerpad.accuracy.over_time`). The error of the
finer one is that of the largest difference (:func:`fingerpad.accuracy.richardson.of_two_paths`).

Not estimated: what the penalty changes, and the error of the time steps, which the two paths have in common. A path
that is lost on the coarser mesh leaves the results without errors, with a note that says why. Where fewer than
:data:`fingerpad.accuracy.richardson.FEW_FACETS` facets of a ridge touch, its length changes by accident with the mesh,
and the estimate may be too small: a note says so.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fingerpad.accuracy.estimate import Estimate
from fingerpad.accuracy.over_time import differences
from fingerpad.accuracy.richardson import FEW_FACETS, of_two_paths
from fingerpad.accuracy.states import Solve
from fingerpad.model.simulation import Simulation
from fingerpad.model.stimuli import SiteStimuli
from fingerpad.results.interrupt import Interrupted
from fingerpad.results.states import WORDS
from fingerpad.results.terminal import about
from fingerpad.scene.messages import counted
from geometry.profiles import GeometryError
from variational.solvers.continuation import StepFailed
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.accuracy.solves import Solves
    from fingerpad.model.finger import Step


class WholePath(Estimate):
    """Errors of a path's named states, and of the path over time, from the path on elements twice as large.

    Attributes:
        over_time: largest difference of the two paths over time by quantity, over its largest amount; empty where no
            load takes time.
    """

    def __init__(self, solves: "Solves", states: Sequence[ContactState], on_step: Callable[[float], None]) -> None:
        """Follow nothing yet.

        Args:
            solves: the path's alone.
            states: accepted states of the path.
            on_step: called with the part of the coarser path that is done; may raise to stop.
        """
        super().__init__(solves)
        self._states, self._on_step = states, on_step
        self._simulation: Simulation | None = None  # on the coarser mesh
        self._stimuli: SiteStimuli | None = None
        self._coarse: list[ContactState] = []
        self.over_time: dict[str, float] = {}
        self._errors: dict[str, float] = {}  # of these, likewise

    def run(self) -> None:
        """Follow the path on the coarser mesh, and estimate; collective.

        Raises:
            Interrupted: ``on_step`` stopped the run.
        """
        try:
            coarse = self.solves.on_coarser_path(self._accepted)
        except Interrupted:
            raise
        except (StepFailed, GeometryError) as error:
            self._note(f"discretisation errors could not be estimated: on elements twice as large, {error}")
            return
        self._compare(self._comparable(coarse), self.base, short=False)
        self._few_facets()
        self._report()
        if self._states[-1].time > 0:
            self.over_time = differences(self._states, self._coarse)
            self._errors = of_two_paths(self.over_time, coarse.mesh.contact / self.base.mesh.contact)
        if "f_t" in self._errors:
            part = about(100 * self._errors["f_t"])
            self._note(
                f"Over time, friction has an estimated discretisation error of up to {part} % of its largest value, "
                "from the path on elements twice as large."
            )

    def summary(self) -> dict[str, Any]:
        """Return how errors were found, ready for JSON; collective."""
        over_time = {
            name: {"difference": difference, "error": self._errors[name]} for name, difference in self.over_time.items()
        }
        return super().summary() | ({"over_time": over_time} if over_time else {})

    def _accepted(self, simulation: Simulation, step: "Step", done: float) -> None:
        """Keep an accepted state of the coarser path; collective."""
        if simulation is not self._simulation:
            self._simulation, self._stimuli = simulation, None
            self._coarse.clear()
        state = step.state
        if self._states[-1].stimuli is not None:
            self._stimuli = self._stimuli or SiteStimuli(simulation.finger)
            state = replace(state, stimuli=self._stimuli.present())
        self._coarse.append(state)
        self._on_step(done)

    def _comparable(self, coarse: Solve) -> Solve:
        """Return the coarser states that are of the same load as those of the path; note what differs."""
        kept = dict(coarse.states)
        for name, state in self.base.states.items():
            other = coarse.states.get(name)
            if other is None or other.state.load != state.state.load:
                where = "not reached" if other is None else f"that of load {other.state.load!r}"
                self._note(
                    f"{WORDS[name]} has no estimated discretisation error: on elements twice as large it was {where}"
                )
                kept.pop(name, None)
                continue
            here, there = state.state.ridges_in_contact, other.state.ridges_in_contact
            if here != there:
                ridges = counted(here, "ridge touches", "ridges touch")
                self._note(
                    f"{ridges} at {WORDS[name]}, and {there} on elements twice as large: "
                    "the estimated discretisation error includes this change"
                )
        return replace(coarse, states=kept)

    def _few_facets(self) -> None:
        """Note that contacts are of few facets."""
        facets = {
            name: each.state.contact_length / max(each.state.ridges_in_contact, 1) / each.facet
            for name, each in self.base.states.items()
        }
        fewest = min(facets, key=facets.__getitem__, default="")
        if fewest and facets[fewest] < FEW_FACETS:
            self._note(
                f"a ridge touches with {facets[fewest]:.1f} facets in the mean at {WORDS[fewest]}: on so few the "
                "estimated discretisation errors may be too small; a smaller mesh.contact resolves it"
            )
