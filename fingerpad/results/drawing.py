"""The pictures of a run from its states and views, each under a title that names the state it shows; on rank 0.

A run draws from what it has in memory, and leaves it as arrays in its folder; a result that was read draws from these.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingerpad.results import curves, field_picture, fields, finger_picture, style
from fingerpad.results.arrays import ALONG, finger_of, put, skin_of
from fingerpad.results.curves import SurfaceProfile
from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.states import WORDS, before_sliding, by_load, called, named, partial_slip
from variational.state import ContactState, Skin

if TYPE_CHECKING:
    from variational.snapshot import Snapshot

Array = NDArray[np.float64]
Along = Skin | Mapping[str, Array]
"""The skin of a state, or the arrays of its :class:`SurfaceProfile` by name, as a file has them."""


@dataclass(frozen=True)
class View:
    """All that is shown of a state."""

    state: ContactState
    size: float | None
    """Contact size (m) of its mesh, where the title has it."""
    skin: Along | None
    """None on ranks other than 0, as the next."""
    snapshot: "Snapshot | None"
    merkel: Array | None
    """Current places (m) of the Merkel sites, shape (sites, 2), None where they are not wanted."""

    def at(self, bone_x: float) -> "View":
        """Return the same with the bone elsewhere (m): in steady full slip the whole finger moves with it."""
        by, found = np.array([bone_x - self.state.bone_x, 0.0]), dict[str, Any](vars(self))
        found["state"] = replace(self.state, bone_x=bone_x)
        for part, array in (("skin", "x"), ("snapshot", "u")):
            if (each := found[part]) is not None:
                kept = dict(each if isinstance(each, Mapping) else vars(each))
                kept[array] = kept[array] + (by[0] if array == "x" else by)
                found[part] = kept if isinstance(each, Mapping) else type(each)(**kept)
        return View(**found | {"merkel": None if self.merkel is None else self.merkel + by})


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

    def write(self, folder: Path, each_load: bool = True) -> None:
        """Write every picture and its arrays into a folder.

        Args:
            folder: where to.
            each_load: also those of the end of each load.
        """
        finger, skin = None, None  # each drawn on again by the next of its kind
        for load, end in self.ends.items() if each_load else ():
            finger = self._put_finger(folder / f"finger_{_file(load)}", f"After {load}", end, finger)
            if end.state.step in self.skins and end.state.ridges_in_contact > 0:
                along = self._along(self.skins[end.state.step], f"After {load}", end.state)
                skin = self._put_skin(folder / f"surface_{_file(load)}", {"end": along}, skin)
        for name, view in self.finer.items():
            if view.snapshot is not None:
                file = folder / f"finger_{_file(WORDS[name])}"
                finger = self._put_finger(file, _title(name, view.state), view, finger)
        self._put_fields(folder, each_load)
        if self._shown():
            self._put_skin(folder / "surface", self._named_skin())
        if self._charged() is not None:
            self.figure("field", folder / "field.png")
        if self._sliding():
            self.figure("history", folder / "history.png")
        if self._timed():
            self.figure("time", folder / "time.png")

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
            return field_picture.field(path, skin, f"{skin.title}: electric field of a ridge")
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
    def _skin(self, path: Path | None, skins: Mapping[str, SurfaceProfile], on: Figure | None = None) -> Figure:
        conditions = style.conditions([skin.state for skin in skins.values()], self.mu_0)
        return curves.surface(path, list(skins.values()), conditions, on=on)

    def _put_skin(self, path: Path, skins: Mapping[str, SurfaceProfile], on: Figure | None = None) -> Figure:
        """Write the picture of the skin in some states and its arrays; ``path`` has no suffix."""
        arrays = {f"{name}_{array}": getattr(skin, array) for name, skin in skins.items() for array in ALONG}
        put(path.with_name(f"{path.name}.npz"), arrays)
        return self._skin(path.with_name(f"{path.name}.png"), skins, on)

    def _along(self, skin: Along, title: str, state: ContactState, view: View | None = None) -> SurfaceProfile:
        return SurfaceProfile(title, state, **sorted_along(skin, state), note=self._note(view))

    def _named_skin(self) -> dict[str, SurfaceProfile]:
        found = {}
        for name, (title, state, view) in self._shown().items():
            skin = self.skins.get(state.step) if view is None else view.skin
            if skin is None:
                raise ValueError("the result has no skin to draw: its folder has no surface.npz that can be read")
            found[name] = self._along(skin, title, state, view)
        return found

    def _shown(self) -> dict[str, tuple[str, ContactState, View | None]]:
        """Return the states along whose skin is drawn: title, state, and its view on the final mesh if there is one."""
        found, partial = named(self.states), partial_slip(self.states)
        shown = {"charged": (_title("charged", found["charged"]), found["charged"])} if "charged" in found else {}
        if partial is not None:
            shown["partial"] = ("Partial slip", partial)
        if "full_slip" in found:
            shown["full_slip"] = _title("full_slip", found["full_slip"]), found["full_slip"]
        elif self._sliding():
            shown["full_slip"] = "Last state", self.states[-1]
        final = {name: view for name, view in self.finer.items() if view.skin is not None}
        return {
            name: (title, final[name].state if name in final else state, final.get(name))
            for name, (title, state) in shown.items()
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
        found = {name: fields.of_snapshot(view.snapshot) for name, view in views.items() if view.snapshot is not None}
        return {name: each for name, each in found.items() if each is not None}

    def _end_of(self, name: str, state: ContactState) -> View | None:
        """Return the end of a load in a named state; in full slip, which further sliding leaves as it is, its last."""
        same = [end for end in self.ends.values() if end.state.step == state.step]
        if name == "full_slip":
            same += [end for end in self.ends.values() if end.state.slip_began == state.slip_began > 0]
        return same[-1] if same else None

    def _put_fields(self, folder: Path, each_load: bool) -> None:
        """Write the fields of each load's end, a collection of them, and the fields of named states on other meshes."""
        files = {name: f"fields_{_file(name)}.vtu" for name in (*(self.ends if each_load else ()), *self.finer)}
        found = {name: each for name, each in self.fields().items() if name in files}
        for name, each in found.items():
            fields.write(folder / files[name], each)
        loads = [(end.state.step, load, files[load]) for load, end in self.ends.items() if load in found]
        if loads:
            fields.write_series(folder / "fields.pvd", loads)

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
                "the result has no finger to draw: no load was reached, or its folder has no finger_*.npz that can be "
                "read"
            )
        load = list(self.ends)[-1]
        return self._finger(path, f"After {load}", self.ends[load])

    def _put_finger(self, path: Path, title: str, view: View, on: Figure | None) -> Figure:
        """Write the picture of a finger and its arrays; ``path`` has no suffix."""
        sites: dict[str, Any] = {} if view.merkel is None else {"merkel": view.merkel}
        arrays = {"bone_x": np.array(view.state.bone_x), **sites, **vars(view.snapshot)}
        put(path.with_name(f"{path.name}.npz"), arrays)
        return self._finger(path.with_name(f"{path.name}.png"), title, view, on)

    def _finger(self, path: Path | None, title: str, view: View, on: Figure | None = None) -> Figure:
        words = f"{style.plain(title)}: {style.conditions([view.state], self.mu_0, place=True)}"
        skin = self.skins.get(view.state.step) if view.size is None else view.skin
        ridges = {} if skin is None else _places(sorted_along(skin, view.state))
        assert view.snapshot is not None
        title, common = self._title(words, view), self._scales
        return finger_picture.finger(path, view.snapshot, view.merkel, title, ridges, common, on)

    @cached_property
    def _scales(self) -> finger_picture.Scales:
        """What the pictures of all views have in common."""
        views = (*self.ends.values(), *self.finer.values())
        return finger_picture.scales([view.snapshot for view in views if view.snapshot is not None])


def _title(name: str, state: ContactState) -> str:
    return called(name, state.voltage).capitalize()


def _file(words: str) -> str:
    return words.replace(" ", "_")


def _places(along: Mapping[str, Array]) -> dict[int, float]:
    """Return the current abscissa (m) of the lowest point of each ridge that can touch, by its number."""
    ridges = np.unique(along["ridge"][np.isfinite(along["ridge"])])
    lowest = {int(k): np.where(along["ridge"] == k, along["y"], np.inf).argmin() for k in ridges}
    return {k: float(along["x"][point]) for k, point in lowest.items()}


def sorted_along(skin: Along, state: ContactState) -> dict[str, Any]:
    """Return the skin of a state as a :class:`SurfaceProfile` has it: sorted along each ridge, a NaN between ridges."""
    if not isinstance(skin, Skin):
        return dict(skin)
    assert state.ridges is not None
    columns: list[list[Any]] = [[] for _ in ALONG]
    for number in np.unique(skin.ridge):
        mine = skin.ridge == number
        order = np.argsort(skin.x[mine], axis=None)
        gap = state.ridges.d_eq[state.ridges.number == number]
        parts = [values[mine].ravel()[order] for values in (skin.x, skin.y, skin.p_n, skin.t_t, skin.p_el)]
        parts += [np.full(len(order), value) for value in (gap.item(), number)]
        for column, part in zip(columns, parts, strict=True):
            column += [part, [np.nan]]
    return dict(zip(ALONG, map(np.concatenate, columns), strict=True))


# -- from a folder ------------------------------------------------------------------------------------
def read(
    folder: Path,
    states: Sequence[ContactState],
    named: Mapping[str, ContactState],
    mu_0: float | None,
    starting_size: float | None,
    final_size: float | None,
) -> Drawing:
    """Return what the pictures of a result that was read are drawn from.

    Args:
        folder: with the arrays of :meth:`Drawing.write`.
        states: accepted states.
        named: named states.
        mu_0: friction coefficient; None where the law of friction is not Coulomb's.
        starting_size: contact size (m) of the mesh of the path, where named states are on another one.
        final_size: contact size (m) of the final mesh, where there is one.
    """
    skins = dict[int, Any]()
    ends, finer = dict[str, View](), dict[str, View]()
    for load, mine in by_load(states):
        if finger := finger_of(folder / f"finger_{_file(load)}.npz"):
            ends[load] = _view(mine[-1], None, None, finger)
        if along := skin_of(folder / f"surface_{_file(load)}.npz", "end"):
            skins[mine[-1].step] = along
    drawing = Drawing(mu_0, states, skins, ends, finer, starting_size, named)
    for name, (_, state, _) in drawing._shown().items():
        skin = skin_of(folder / "surface.npz", name)
        finger = finger_of(folder / f"finger_{_file(WORDS.get(name, ''))}.npz")
        if skin and finger and final_size is not None and name in named:
            there = replace(named[name], bone_x=float(finger.get("bone_x", state.bone_x)))
            finer[name] = _view(there, final_size, skin, finger)
        elif skin:
            skins[state.step] = skin
    return drawing


def _view(state: ContactState, size: float | None, skin: Along | None, finger: dict[str, Any]) -> View:
    snapshot: Any = SimpleNamespace(**finger)
    return View(state, size, skin, snapshot, finger.get("merkel"))
