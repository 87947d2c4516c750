"""The pictures of a run from its states and views, each under a title that names the state it shows; on rank 0.

A run draws from what it has in memory, and leaves that in ``fields.npz``; a result that was read draws from there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingerpad.results import fields
from fingerpad.results.fields import Along, Groups, View, sorted_along
from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.pictures import curves, solid, style
from fingerpad.results.pictures import finger as finger_picture
from fingerpad.results.pictures.curves import SurfaceProfile
from fingerpad.results.states import before_sliding, called, shown
from variational.state import ContactState

if TYPE_CHECKING:
    from variational.snapshot import Snapshot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Drawing:
    """What a run's pictures are drawn from."""

    mu_0: float | None
    """Friction coefficient; None where the law of friction is not Coulomb's."""
    states: Sequence[ContactState]
    skins: Mapping[int, Along]
    """By step."""
    ends: Mapping[str, View]
    """The finger at the end of a load, by load."""
    finer: Mapping[str, View]
    """Named states on another mesh than the path's, by names of :mod:`fingerpad.results.states`."""
    starting_size: float | None
    """Contact size (m) of the mesh of the path, where named states are on another one."""
    named: Mapping[str, ContactState]
    """Named states with their estimated errors, by their names in :mod:`fingerpad.results.states`."""

    def write(self, folder: Path) -> None:
        """Write the pictures of a run into a folder: the finger, its skin, and its history over sliding or time."""
        if self._shown():
            self.figure("surface", folder / "surface.png")
        if self.body() is not None:
            self.figure("finger", folder / "finger.png")
        if self._timed():
            self.figure("time", folder / "time.png")
        elif self._sliding():
            self.figure("history", folder / "history.png")

    def figure(self, kind: str, path: Path | None = None) -> Figure:
        """Draw a picture, and write it where a path is given.

        Args:
            kind: ``"surface"``, the skin in normal contact, partial and full slip; ``"finger"``, the deformed finger at
                full slip or else at the end; ``"history"``, friction and contact length over sliding; ``"time"``, the
                same with the voltage over time; ``"field"``, the electric field of a ridge.
            path: of the PNG file.

        Raises:
            ValueError: a history that has no such picture.
        """
        if kind == "finger":
            return self._last_finger(path)
        if kind == "surface":
            skins = self._named_skin()
            if not skins:
                raise ValueError("the run has no state with skin on the screen to draw")
            return self._skin(path, skins)
        if kind == "field":
            if (name := self._charged()) is None:
                raise ValueError("the run has no charged state with skin on the screen to draw")
            skin = self._named_skin()[name]
            return solid.field(path, skin, f"{skin.title}: electric field of a ridge")
        if kind == "time":
            states = self._timed()
            if not states:
                raise ValueError("the run has no load over time; give one a speed, a duration or a waveform")
            return curves.over_time(path, states, self._title(style.conditions(states, self.mu_0)))
        states = self._sliding()
        if not states:
            raise ValueError("the run has no history of sliding; the bone never moved sideways with skin on the screen")
        return curves.history(path, states, self._title(style.conditions(states, self.mu_0)), self.mu_0, self.named)

    def _charged(self) -> str | None:
        """Return the last charged state in contact along whose skin is drawn."""
        shown = self._shown().items()
        charged = [name for name, (_, state, _) in shown if state.voltage and state.ridges_in_contact]
        return charged[-1] if charged else None

    def body(self) -> "Snapshot | None":
        """Return the last finger that is drawn."""
        views = [*self.finer.values(), *self.ends.values()]
        return views[-1].snapshot if views else None

    def _title(self, words: str, view: View | None = None) -> str:
        """Return words with a line for the mesh below, where there are two."""
        note = self._note(view)
        return f"{words}\n{note}" if note else words

    def _note(self, view: View | None = None) -> str:
        """Return what mesh it is, the final one of a view or the path's; empty where there is one."""
        if view is not None and view.size is not None:
            return f"final mesh, contact size {view.size * 1e6:.3g} µm"
        size = self.starting_size
        return "" if size is None else f"path on its own mesh, contact size {size * 1e6:.3g} µm"

    # -- skin ----------------------------------------------------------------------------------------
    def _skin(self, path: Path | None, skins: Mapping[str, SurfaceProfile]) -> Figure:
        conditions = style.conditions([skin.state for skin in skins.values()], self.mu_0)
        return curves.surface(path, list(skins.values()), conditions)

    def _along(self, skin: Along, title: str, state: ContactState, view: View | None = None) -> SurfaceProfile:
        return SurfaceProfile(title, state, **sorted_along(skin, state), note=self._note(view))

    def _named_skin(self) -> dict[str, SurfaceProfile]:
        found = {}
        for name, (title, state, view) in self._shown().items():
            skin = self.skins.get(state.step) if view is None else view.skin
            if skin is None:
                raise ValueError("the result has no skin to draw: its folder has no fields.npz that can be read")
            found[name] = self._along(skin, title, state, view)
        return found

    def _shown(self) -> dict[str, tuple[str, ContactState, View | None]]:
        """Return the states along whose skin is drawn: title, state, and its view on the final mesh if there is one."""
        words = {"partial": "Partial slip"}
        states = shown(self.states)
        for name, state in states.items():
            words.setdefault(name, _title(name, state) if name in self.named else "Last state")
        final = {name: view for name, view in self.finer.items() if view.skin is not None}
        return {
            name: (words[name], final[name].state if name in final else state, final.get(name))
            for name, state in states.items()
        }

    def steps_along(self) -> list[int]:
        """Return the steps of the states along whose skin is drawn."""
        states = [state for _, state, _ in self._shown().values()] + [end.state for end in self.ends.values()]
        return [state.step for state in states]

    # -- fields --------------------------------------------------------------------------------------
    def fields(self) -> dict[str, fields.Fields]:
        """Return the fields inside the finger: at the end of each load by its name, and of named states by theirs."""
        views = {**self.ends, **self.finer}
        if self.starting_size is None:  # named states are those of the path
            ends = {name: (self._end_of(name, state), state.bone_x) for name, state in self.named.items()}
            views |= {name: end.at(bone_x) for name, (end, bone_x) in ends.items() if end is not None}
        return {name: fields.of_snapshot(view.snapshot) for name, view in views.items() if view.snapshot is not None}

    def groups(self, each_load: bool = True) -> Groups:
        """Return the groups of ``fields.npz``.

        Args:
            each_load: also of the end of each load.
        """
        loads = {name: replace(end, skin=self._skin_of(end)) for name, end in self.ends.items()} if each_load else {}
        states = {
            name: view or View(state, None, self.skins[state.step], None, None)
            for name, (_, state, view) in self._shown().items()
        }
        return fields.groups_of(loads, {**self.finer, **states})

    def _skin_of(self, end: View) -> Along | None:
        """Return the skin at the end of a load; None in the air."""
        return self.skins.get(end.state.step) if end.state.ridges_in_contact > 0 else None

    def _end_of(self, name: str, state: ContactState) -> View | None:
        """Return the end of a load in a named state; in full slip, which further sliding leaves as it is, its last."""
        same = [end for end in self.ends.values() if end.state.step == state.step]
        if name == "full_slip":
            same += [end for end in self.ends.values() if end.state.slip_began == state.slip_began > 0]
        return same[-1] if same else None

    # -- history -------------------------------------------------------------------------------------
    def _sliding(self) -> Sequence[ContactState]:
        """Return the states from the last one before sliding on; none where the bone does not slide."""
        still = len(before_sliding(self.states))
        return () if still in (0, len(self.states)) else self.states[still - 1 :]

    def _timed(self) -> Sequence[ContactState]:
        """Return the states from the last one at time 0 on; none where no load takes time."""
        first = sum(state.time == 0 for state in self.states)
        if not (self.states and self.states[-1].time > 0):
            return []
        return without_parts_of_jumps(self.states[max(first - 1, 0) :])

    # -- finger --------------------------------------------------------------------------------------
    def _last_finger(self, path: Path | None) -> Figure:
        final = next((name for name in ("full_slip", "charged") if name in self.finer), None)
        if final is not None and (view := self.finer[final]).snapshot is not None:
            return self._finger(path, _title(final, view.state), view)
        if not self.ends:
            raise ValueError(
                "the result has no finger to draw: no load was reached, or its folder has no fields.npz that can be "
                "read"
            )
        load = list(self.ends)[-1]
        return self._finger(path, f"After {load}", self.ends[load])

    def _finger(self, path: Path | None, title: str, view: View) -> Figure:
        words = f"{style.plain(title)}: {style.conditions([view.state], self.mu_0, place=True)}"
        skin = self.skins.get(view.state.step) if view.size is None else view.skin
        ridges = {} if skin is None else _places(sorted_along(skin, view.state))
        assert view.snapshot is not None
        title, common = self._title(words, view), self._scales
        return finger_picture.finger(path, view.snapshot, view.merkel, title, ridges, common)

    @cached_property
    def _scales(self) -> finger_picture.Scales:
        """What the pictures of all views have in common."""
        views = (*self.ends.values(), *self.finer.values())
        return finger_picture.scales([view.snapshot for view in views if view.snapshot is not None])


def _title(name: str, state: ContactState) -> str:
    return called(name, state.voltage).capitalize()


def _places(along: Mapping[str, Array]) -> dict[int, float]:
    """Return the current abscissa (m) of the lowest point of each ridge that can touch, by its number."""
    ridges = np.unique(along["ridge"][np.isfinite(along["ridge"])])
    lowest = {int(k): np.where(along["ridge"] == k, along["y"], np.inf).argmin() for k in ridges}
    return {k: float(along["x"][point]) for k, point in lowest.items()}


# -- from a folder ------------------------------------------------------------------------------------
def read(
    folder: Path, states: Sequence[ContactState], named: Mapping[str, ContactState], mu_0: float | None
) -> Drawing:
    """Return what the pictures of a result that was read are drawn from.

    Args:
        folder: with ``fields.npz``.
        states: accepted states.
        named: named states.
        mu_0: friction coefficient; None where the law of friction is not Coulomb's.
    """
    loads, found = fields.views_of(folder, states, named)
    finer = {name: view for name, view in found.items() if view.snapshot is not None}
    ends = {name: view for name, view in loads.items() if view.snapshot is not None}
    views = (*loads.values(), *(view for name, view in found.items() if name not in finer))
    skins = {view.state.step: view.skin for view in views if view.skin is not None}
    size = states[-1].mesh_contact if finer else None
    return Drawing(mu_0, states, skins, ends, finer, size, named)
