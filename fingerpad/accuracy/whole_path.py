r"""Discretisation errors of a path whose states have a past: from the same path on elements twice as large.

A state of viscous layers cannot be solved again on another mesh, since what the layers keep of their past is of their
own mesh. So the whole path is followed on the mesh that the scene gives, whose states are the results, and once more on
elements twice as large. The difference of the named states makes their estimated errors
(:func:`~fingerpad.accuracy.richardson.of_two_meshes`). Facets where contact ends are those of the two meshes, and not
shorter as on the final mesh of other runs. So friction has the order of lengths in contact, p = 1, as where an accuracy
is met.

In loads over time the paths are compared over time as well (:func:`differences`), and the error is that of the largest
difference (:func:`~fingerpad.accuracy.richardson.of_two_paths`). States are compared load by load, by the time since
the load began, so that a slide that ends later on one mesh, at full slip, does not shift what follows. Between two
states the other path follows a monotone cubic curve (Fritsch and Carlson), cut where the voltage jumps. Loads that take
no time are compared at their ends.

Not estimated: what the penalty changes, and the error of the time steps, which the two paths have in common.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from fingerpad.accuracy.estimate import Estimate
from fingerpad.accuracy.richardson import FEW_FACETS, of_two_paths
from fingerpad.accuracy.solves import follow
from fingerpad.accuracy.states import Solve
from fingerpad.model.finger import Step
from fingerpad.model.options import FingerModel
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.model.stimuli import SiteStimuli
from fingerpad.results.interrupt import Interrupted
from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.states import WORDS, by_load
from fingerpad.results.terminal import about
from fingerpad.scene.messages import counted
from geometry.profiles import GeometryError
from variational.solvers.continuation import StepFailed
from variational.state import ContactState

Array = NDArray[np.float64]
_Of = Callable[[ContactState], Array]
_Piece = tuple[Array, list[ContactState]]
_TIME_TOLERANCE = 1e-9  # of the length of a run: two times that are one
_STIMULI = {
    "merkel_stress": ("merkel_stress",),
    "meissner_stress": ("meissner_stress_left", "meissner_stress_right"),
    "pacinian_stress": ("pacinian_stress",),
    "surface_strain": ("surface_strain_left", "surface_strain_right"),
}


class WholePath(Estimate):
    """Errors of a path's named states, and of the path over time, from the path on elements twice as large.

    Attributes:
        over_time: largest difference of the two paths over time by quantity, over its largest amount; empty where no
            load takes time.
    """

    def __init__(
        self,
        model: FingerModel,
        path: Solve,
        comm: MPI.Comm,
        show: Callable[[str], None],
        states: Sequence[ContactState],
        on_step: Callable[[float], None],
    ) -> None:
        """Follow nothing yet; arguments as of :class:`Estimate`.

        Args:
            model: of the path.
            path: its named states.
            comm: communicator of the meshes.
            show: prints a line.
            states: accepted states of the path.
            on_step: called with the part of the coarser path that is done; may raise to stop.
        """
        super().__init__(model, path, comm, show)
        self._states, self._on_step = states, on_step
        self._simulation: Simulation | None = None  # on the coarser mesh
        self._stimuli: SiteStimuli | None = None
        self._coarse = list[ContactState]()
        self.over_time, self._errors = dict[str, float](), dict[str, float]()

    def run(self) -> RestartRequired | None:
        """Follow the path on the coarser mesh, and estimate, which needs nothing more of the model; collective.

        Raises:
            Interrupted: ``on_step`` stopped the run.
        """
        try:
            coarse = self._on_coarser_path()
        except Interrupted:
            raise
        except (StepFailed, GeometryError) as error:
            self._note(f"discretisation errors could not be estimated: on elements twice as large, {error}")
            return None
        self.compare(self._comparable(coarse), self.base, short=False)
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
        return None

    def _on_coarser_path(self) -> Solve:
        """Return the named states on elements twice as large, where the model may turn out to need more; collective.

        Raises as :func:`~fingerpad.accuracy.solves.follow`.
        """
        mesh = self.model.coarser(self.model.mesh)
        if mesh.contact == self.model.mesh.contact:
            raise GeometryError(f"the ridges have no larger elements than {mesh.contact * 1e6:.3g} µm")
        found = follow(self.model.changed(mesh=mesh), self._comm, self._accepted)
        while isinstance(found, RestartRequired):
            self._show(f"on elements twice as large: {found.reason}; all loads again")
            found = follow(found.model, self._comm, self._accepted)
        self.found.append(found)
        return found

    def summary(self) -> dict[str, Any]:
        """Return how errors were found, ready for JSON; collective."""
        over_time = {
            name: {"difference": difference, "error": self._errors[name]} for name, difference in self.over_time.items()
        }
        return super().summary() | ({"over_time": over_time} if over_time else {})

    def _accepted(self, simulation: Simulation, step: Step, done: float) -> None:
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


# -- two paths over time -------------------------------------------------------------------------------------
def differences(path: Sequence[ContactState], other: Sequence[ContactState]) -> dict[str, float]:
    """Return the largest difference over time by quantity, over the largest amount on the path.

    Of stimuli the largest difference at a site counts, over the largest amount at any site.

    Args:
        path: accepted states, with their times.
        other: those of the same loads on another mesh.

    Returns:
        Of friction and contact length, and of stimuli where both paths have them; none of a quantity that is zero.
    """
    wanted: dict[str, _Of] = {name: partial(_value, name) for name in ("f_t", "contact_length")}
    if all(state.stimuli is not None for state in (*path, *other)):
        wanted |= {name: partial(_stimulus, parts) for name, parts in _STIMULI.items()}
    pieces = _pieces(path), _pieces(other)
    shared = [(pieces[0][key], pieces[1][key]) for key in pieces[0] if key in pieces[1]]
    found = {}
    for name, of in wanted.items():
        most = np.nanmax([np.abs(of(state)) for state in path], initial=0.0)
        if shared and most > 0:
            found[name] = float(max(_difference(mine, theirs, of) for mine, theirs in shared) / most)
    return found


def _value(name: str, state: ContactState) -> Array:
    return np.atleast_1d(getattr(state, name))


def _stimulus(parts: Sequence[str], state: ContactState) -> Array:
    return np.concatenate([getattr(state.stimuli, part) for part in parts])


def _pieces(states: Sequence[ContactState]) -> dict[tuple[int, int], _Piece]:
    """Return the states between two jumps with their times since the load began, by load and number of the jump.

    A load begins with the last state of the load before; of one that takes no time the last state alone is there.
    """
    found = dict[tuple[int, int], _Piece]()
    near, before = _TIME_TOLERANCE * states[-1].time, list[ContactState]()
    for _, mine in by_load(states):
        number, rows = mine[-1].load_number, [*before, *mine]
        before = mine[-1:]
        start = rows[0].time if len(rows) > len(mine) else 0.0
        if mine[-1].time - start <= near:
            found[number, 0] = np.zeros(1), before
            continue
        rows = without_parts_of_jumps(rows)
        time = np.array([state.time for state in rows]) - start
        cuts = [0, *(np.flatnonzero(np.diff(time) <= near) + 1), len(rows)]
        for k, (a, b) in enumerate(zip(cuts[:-1], cuts[1:], strict=True)):
            found[number, k] = time[a:b], rows[a:b]
    return found


def _difference(mine: _Piece, theirs: _Piece, of: _Of) -> float:
    """Return the largest difference at the times of the first piece that are within those of the second one."""
    (time, states), (times, others) = mine, theirs
    values = np.array([of(state) for state in others])
    both = np.isfinite(values).all(axis=0)
    near = _TIME_TOLERANCE * times[-1]
    inside = (time >= times[0] - near) & (time <= times[-1] + near)
    if not (both.any() and inside.any()):
        return 0.0
    values = values[:, both]
    if len(times) > 1:
        values = PchipInterpolator(times, values)(np.clip(time[inside], times[0], times[-1]))
    own = np.array([of(state) for state in states])[inside][:, both]
    return float(np.nanmax(np.abs(own - values), initial=0.0))
