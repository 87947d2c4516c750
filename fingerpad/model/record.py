"""What tables and pictures show of a path: its accepted states, with the skin and the whole finger of some of them.

The whole finger is shown whatever mesh and half of it the model has.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fingerpad.model.checks import Checked
from fingerpad.model.finger import Finger, Step
from fingerpad.model.stimuli import SiteStimuli
from fingerpad.results import states
from fingerpad.results.fields import View, sorted_along
from fingerpad.results.pictures import animation
from fingerpad.results.pictures.drawing import Drawing
from fingerpad.results.quantities import SKIN, in_table
from fingerpad.scene import Load
from variational.output import Lines, Receptors
from variational.snapshot import Snapshot
from variational.state import ContactState, Sites, Skin, StepRecord, Stimuli

Array = NDArray[np.float64]
_PROFILE = (*SKIN, "area_x", "area_y")
_HORIZONTAL = ("x", "t_t", "area_x")  # the other way round in the mirror


class Viewer:
    """Collects the states of a finger for tables and pictures."""

    def __init__(self, finger: Finger) -> None:
        """Find the receptor sites, if they are part of the model."""
        self._finger = finger
        profiles = finger.profiles
        sites = np.concatenate([profiles.merkel_sites(), profiles.meissner_sites()])
        if not finger.options.both_halves:  # where their mirror images are
            sites[:, 0] = np.abs(sites[:, 0])
        self._sites = Receptors(finger.problem, sites) if finger.options.receptors else None
        self._stimuli: SiteStimuli | None = None
        self._lines = Lines(finger.problem)

    def view(self, step: Step) -> View:
        """Return all that is shown of the present state, that of the step; collective."""
        state, skin = replace(step.state, sites=self.sites()), self.skin(step)
        return View(state, self._finger.size.contact, skin, *self.picture())

    def skin(self, step: Step) -> Skin | None:
        """Return the skin of a step, the present one, on rank 0, None elsewhere; collective."""
        surface, skin = self._finger.problem.surface, self._finger.continuation.surface_state
        values = surface.gather(np.stack([getattr(skin, name) for name in _PROFILE]))
        ridge = surface.gather(surface.ridge[None, :, None].astype(float))
        if values is None or ridge is None:
            return None
        where = ridge[0, :, 0].astype(int)
        if not self._finger.options.both_halves:
            values, where = _both_sides(values, where)
        assert step.state.ridges is not None
        x, y, p_n, t_t, p_el, area_x, area_y = values
        stretch = np.hypot(area_x, area_y)
        return Skin(step.state.ridges.number[where], x, y, p_n / stretch, t_t / stretch, p_el)

    def picture(self) -> tuple[Snapshot | None, Array | None]:
        """Return the present state of the whole finger, and where the Merkel sites are if wanted; collective."""
        snapshot, ridges = self.body(), np.array(self._finger.profiles.ridges)
        merkel = self._sites.positions()[: len(ridges)] if self._sites else None
        if not self._finger.options.both_halves and merkel is not None:
            merkel[ridges < 0, 0] *= -1
        return snapshot, merkel

    def body(self, fields: bool = True) -> Snapshot | None:
        """Return the present state of the whole body, with its fields or without, on rank 0; collective."""
        snapshot = self._lines.snapshot(self._finger.problem, fields)
        return snapshot if snapshot is None or self._finger.options.both_halves else snapshot.whole()

    def sites(self) -> Sites | None:
        """Return the energy densities at the receptor sites in the present state, None without them; collective."""
        if self._sites is None:
            return None
        names, sed = self._finger.profiles.ridges, self._sites.sed()
        left, right = sed[len(names) :].reshape(-1, 2).T
        return Sites(np.array(names), sed[: len(names)], left, right)

    def stimuli(self, step: Step) -> Stimuli | None:
        """Return what mechanoreceptors are given in the present state of a run over time, else None; collective."""
        if self._sites is None or math.isnan(step.state.time):
            return None
        self._stimuli = self._stimuli or SiteStimuli(self._finger)
        return self._stimuli.present()


def _both_sides(half: Array, ridge: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
    """Return the skin of both sides of that at x >= 0, shape (columns, facets, points), and the ridge of each facet."""
    signs = np.array([-1.0 if name in _HORIZONTAL else 1.0 for name in _PROFILE])[:, None, None]
    last = int(ridge.max())
    return np.concatenate([half, signs * half], axis=1), np.concatenate([last + ridge, last - ridge])


class PathRecord:
    """Keeps accepted states.

    Attributes:
        states: in order, on every rank.
        skins: the skin by step, on rank 0.
        moved: lines and skin by step, on rank 0, for animations.
        ends: the finger at the end of each load, by load, on rank 0.
    """

    def __init__(self, comm: MPI.Comm, checks: Mapping[int, Checked]) -> None:
        """Keep nothing yet; stability is known by step as far as it is examined."""
        self._comm, self._checks = comm, checks
        self.states: list[ContactState] = []
        self.skins: dict[int, Skin] = {}
        self.moved: dict[int, animation.Moved] = {}
        self.ends: dict[str, View] = {}

    def move(self, state: ContactState, skin: Skin, body: Snapshot) -> None:
        """Keep lines and skin of an accepted state, on rank 0."""
        self.skins[state.step] = skin
        self.moved[state.step] = animation.moved(body, sorted_along(skin, state))
        animation.thin(self.moved)

    def prune(self, loads: Sequence[str]) -> None:
        """Drop the skin of steps that nothing will show, whatever follows the loads of these names."""
        last, rows = self.states[-1], self.states
        shown = [*states.named(rows, loads).values(), *(end.state for end in self.ends.values()), last]
        shown += [row for row in (states.partial_slip(rows), states.partial_slip(rows, math.inf)) if row]
        steps = {state.step for state in shown} | {last.slip_began}
        self.skins = {step: skin for step, skin in self.skins.items() if step in steps}

    def named(self, final: Mapping[str, View], loads: Sequence[str]) -> dict[str, ContactState]:
        """Return the named states with their stability and, on every rank, their skin; collective.

        Args:
            final: states on the mesh that the run ended with, whose skin is to be shown, by name.
            loads: names of the loads in order.
        """
        found = {}
        for name, state in states.named(self.states, loads).items():
            skin = self._comm.bcast(final[name].skin if name in final else self.skins.get(state.step))
            # A full slip counts because it was held; the row of its first step is of before that.
            sites = final[name].state.sites if name in final else state.sites
            found[name] = replace(state, skin=skin, sites=sites, slip_held=state.slip_held or name == "full_slip")
            if check := self._check(state):
                found[name] = check.of(found[name])
        return found

    def _check(self, state: ContactState) -> Checked | None:
        """Return the stability of a state, or of another one of the same full slip; None where none was examined."""
        same = [other.step for other in self.states if other.slip_began == state.slip_began > 0]
        return next((self._checks[k] for k in (state.step, *same) if k in self._checks), None)

    def loads(self, loads: Sequence[Load], mu_0: float | None) -> tuple[states.LoadResult, ...]:
        """Return the result of each load of a history; see :func:`fingerpad.results.states.load_results`."""

        def stable(end: ContactState) -> bool | None:
            check = self._check(end)
            return None if check is None else check.stable

        return states.load_results(self.states, loads, stable, mu_0)

    def drawing(
        self, mu_0: float | None, final: Mapping[str, View], size: float | None, named: Mapping[str, ContactState]
    ) -> Drawing | None:
        """Return what the pictures are drawn from, on rank 0; None without a state.

        Args:
            mu_0: friction coefficient; None where the law of friction is not Coulomb's.
            final: states on the mesh that the run ended with, by name.
            size: contact size (m) of the path's mesh, where an accuracy was asked for.
            named: the named states, with their estimated errors.
        """
        if not self.states or self._comm.rank != 0:
            return None
        whole = Drawing(mu_0, self.states, self.skins, self.ends, final, size, named)
        shown = whole.steps_along()
        return replace(whole, skins={step: skin for step, skin in self.skins.items() if step in shown})

    def totals(self) -> dict[str, Any]:
        """Return sums and largest values over all states, ready for JSON."""
        records = [s.record for s in self.states if s.record is not None]
        jumps = [r for r in records if r.jump]
        released = {"energy_released": sum(r.energy_released for r in jumps)}
        released["energy_released_error"] = sum(r.released_error for r in jumps)
        sums = {name: sum(getattr(r, name) for r in records) for name in in_table("summed")}
        largest = {name: max((getattr(r, name) for r in records), default=0.0) for name in in_table("largest")}
        viscous = _of_viscous([r for r in records if not math.isnan(r.viscous)])
        return {"steps": len(self.states), "jumps": len(jumps)} | released | sums | largest | viscous


def _of_viscous(records: Sequence[StepRecord]) -> dict[str, float]:
    """Return what viscous layers dissipate in all, and its least value; nothing without such layers."""
    if not records:
        return {}
    lost = sum(r.viscous_dissipation for r in records)
    return {"viscous_dissipation": lost, "viscous_least": min(r.viscous_least for r in records)}
