"""The pictures of a run from its states and views, each under a title that names the state it shows; on rank 0."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingerpad.results import finger_picture, history_picture, skin_picture, style
from fingerpad.results.files import replace
from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.skin_picture import SurfaceProfile
from fingerpad.results.states import WORDS, before_sliding, called, named, partial_slip
from geometry.parameters import MeshSize
from variational.state import ContactState, Skin

if TYPE_CHECKING:
    from variational.output import Snapshot

Array = NDArray[np.float64]
_PATH, _FINAL = "path on the starting mesh", "final mesh"


@dataclass(frozen=True)
class Profile:
    """The skin that can touch."""

    ridge: NDArray[np.int64]
    """Position of each facet's ridge among all, shape (facets,)."""
    values: Array
    """Current place (m), pressure, shear and attraction (Pa), and current area, shape (7, facets, points)."""
    d_eq: Array
    """Equivalent air gap (m) of each ridge, shape (ridges,)."""

    def skin(self, numbers: NDArray[np.int64]) -> Skin:
        """Return the same with tractions per current area, for the numbers of the ridges, shape (ridges,)."""
        x, y, p_n, t_t, p_el, area_x, area_y = self.values
        stretch = np.hypot(area_x, area_y)
        return Skin(numbers[self.ridge], x, y, p_n / stretch, t_t / stretch, p_el)


@dataclass(frozen=True)
class View:
    """All that is shown of a state."""

    state: ContactState
    """Without a record of a step."""
    mesh: MeshSize
    profile: Profile | None
    """None on ranks other than 0, as the next."""
    snapshot: "Snapshot | None"
    merkel: Array | None
    """Current places (m) of the Merkel sites, shape (sites, 2), None where they are not wanted."""


Along = Profile | Mapping[str, Array]
"""The skin of a state, or the arrays of its :class:`SurfaceProfile` by name, as a file has them."""


class End(NamedTuple):
    """The finger at the end of a load."""

    state: ContactState
    snapshot: "Snapshot"
    sites: Array | None
    """Current places (m) of the Merkel sites, shape (sites, 2); None where there are none."""


@dataclass(frozen=True)
class Drawing:
    """What a run's pictures are drawn from."""

    mu_0: float | None
    """Friction coefficient; None where the law of friction is not Coulomb's."""
    states: Sequence[ContactState]
    profiles: Mapping[int, Along]
    """The skin by step."""
    ends: Mapping[str, End]
    """By load."""
    finer: Mapping[str, View]
    """Normal contact and full slip on another mesh than the path's, by names of :mod:`fingerpad.results.states`."""
    starting_size: float | None
    """Contact size (m) of the mesh of the path, where an accuracy was asked for."""
    named: Mapping[str, ContactState]
    """Named states with their estimated errors, by their names in :mod:`fingerpad.results.states`."""

    def write(self, folder: Path, each_load: bool = True) -> None:
        """Write every picture and its arrays into a folder.

        Args:
            folder: where to.
            each_load: also those of the end of each load.
        """
        for load, end in self.ends.items() if each_load else ():
            words = load.replace(" ", "_")
            _keep(folder / f"finger_{words}.npz", end.state, end.snapshot, end.sites)
            self._end(folder / f"finger_{words}.png", load)
            if end.state.step in self.profiles and end.state.ridges_in_contact > 0:
                along = _along(self.profiles[end.state.step], f"After {load}", end.state, self._path_note())
                self._surface(folder / f"surface_{words}", {"end": along}, [end.state])
        for name, view in self.finer.items():
            if view.snapshot is not None:
                words = WORDS[name].replace(" ", "_")
                _keep(folder / f"finger_{words}.npz", view.state, view.snapshot, view.merkel)
                self._final(folder / f"finger_{words}.png", name)
        if shown := self._shown():
            self._surface(folder / "surface", self._named_skin(), [state for _, state, _ in shown.values()])
        if self._slides():
            self.figure("history", folder / "history.png")
        if self._timed():
            self.figure("time", folder / "time.png")

    def figure(self, kind: str, path: Path | None = None) -> Figure:
        """Draw a picture, and write it where a path is given.

        Args:
            kind: ``"surface"``, the skin in normal contact, partial and full slip; ``"finger"``, the deformed finger at
                full slip or else at the end; ``"history"``, friction and contact length over sliding; ``"time"``, the
                same with the voltage over time.
            path: of the PNG file.

        Raises:
            ValueError: a history that has no such picture.
        """
        if kind == "finger":
            return self._last_finger(path)
        if kind == "surface":
            profiles = self._named_skin()
            if not profiles:
                raise ValueError("the run has no state with skin on the screen to draw")
            return self._skin(path, profiles, [state for _, state, _ in self._shown().values()])
        if kind == "time":
            return self._over_time(path)
        if not self._slides():
            raise ValueError("the run has no history of sliding; the bone never moved sideways with skin on the screen")
        shown = [state.row() for state in self.states[len(before_sliding(self.states)) - 1 :]]
        conditions = _joined(style.conditions_of(shown, self.mu_0), self._path_note())
        return history_picture.history(path, shown, conditions, self.mu_0, self.named)

    def _skin(
        self, path: Path | None, profiles: Mapping[str, SurfaceProfile], states: Sequence[ContactState]
    ) -> Figure:
        conditions = style.conditions_of([state.row() for state in states], self.mu_0)
        return skin_picture.surface(path, list(profiles.values()), conditions)

    def _surface(self, path: Path, profiles: Mapping[str, SurfaceProfile], states: Sequence[ContactState]) -> None:
        """Write the picture of the skin in some states and its arrays; ``path`` has no suffix."""
        arrays: dict[str, Any] = {
            f"{name}_{field}": value
            for name, profile in profiles.items()
            for field, value in vars(profile).items()
            if isinstance(value, np.ndarray)
        }
        _put(path.with_name(f"{path.name}.npz"), arrays)
        self._skin(path.with_name(f"{path.name}.png"), profiles, states)

    def _slides(self) -> bool:
        return len(before_sliding(self.states)) not in (0, len(self.states))

    def _timed(self) -> list[ContactState]:
        """Return the states from the last one at time 0 on; none where no load takes time."""
        first = sum(state.time == 0 for state in self.states)
        if not (self.states and self.states[-1].time > 0):
            return []
        return without_parts_of_jumps(self.states[max(first - 1, 0) :])

    def _over_time(self, path: Path | None) -> Figure:
        states = self._timed()
        if not states:
            raise ValueError("the run has no load over time; give one a speed, a duration or a waveform")
        conditions = style.conditions_of([state.row() for state in states], self.mu_0)
        return history_picture.over_time(path, states, _joined(conditions, self._path_note()))

    def _path_note(self) -> str:
        return "" if self.starting_size is None else _note(_PATH, self.starting_size)

    def _last_finger(self, path: Path | None) -> Figure:
        final = next((name for name in ("full_slip", "charged") if name in self.finer), None)
        if final is not None and self.finer[final].snapshot is not None:
            return self._final(path, final)
        if not self.ends:
            raise ValueError(
                "the result has no finger to draw: no load was reached, or its folder has no finger_*.npz that can be "
                "read"
            )
        return self._end(path, list(self.ends)[-1])

    def _end(self, path: Path | None, load: str) -> Figure:
        end = self.ends[load]
        return self._finger(
            path, f"After {load}", *end, self._path_note(), _places(self.profiles.get(end.state.step), end.state)
        )

    def _final(self, path: Path | None, name: str) -> Figure:
        view = self.finer[name]
        assert view.snapshot is not None
        title, note = _title(name, view.state), _note(_FINAL, view.mesh.contact)
        ridges = _places(view.profile, view.state)
        return self._finger(path, title, view.state, view.snapshot, view.merkel, note, ridges)

    def _finger(
        self,
        path: Path | None,
        title: str,
        state: ContactState,
        snapshot: "Snapshot",
        sites: Array | None,
        note: str,
        ridges: Mapping[int, float],
    ) -> Figure:
        conditions = style.conditions(state.f_ext, state.voltage, self.mu_0, state.bone_x)
        snapshots = [end.snapshot for end in self.ends.values()]
        snapshots += [view.snapshot for view in self.finer.values() if view.snapshot is not None]
        highest = max(map(finger_picture.highest_density, snapshots))
        words = _joined(f"{style.plain(title)}: {conditions}", note)
        return finger_picture.finger(path, snapshot, sites, words, ridges, highest)

    def _shown(self) -> "dict[str, tuple[str, ContactState, View | None]]":
        """Return the states along whose skin is drawn: title, state, and its view on the final mesh if there is one."""
        found, partial = named(self.states), partial_slip(self.states)
        shown = {"charged": (_title("charged", found["charged"]), found["charged"])} if "charged" in found else {}
        if partial is not None:
            shown["partial"] = ("Partial slip", partial)
        if "full_slip" in found:
            shown["full_slip"] = _title("full_slip", found["full_slip"]), found["full_slip"]
        elif self._slides():
            shown["full_slip"] = "Last state", self.states[-1]
        final = {name: view for name, view in self.finer.items() if view.profile is not None}
        return {
            name: (title, final[name].state if name in final else state, final.get(name))
            for name, (title, state) in shown.items()
        }

    def steps_along(self) -> list[int]:
        """Return the steps of the states along whose skin is drawn."""
        states = [state for _, state, _ in self._shown().values()] + [end.state for end in self.ends.values()]
        return [state.step for state in states]

    def _named_skin(self) -> dict[str, SurfaceProfile]:
        profiles = {}
        for name, (title, state, view) in self._shown().items():
            if view is not None and view.profile is not None:
                profiles[name] = _along(view.profile, title, state, _note(_FINAL, view.mesh.contact))
            elif state.step not in self.profiles:
                raise ValueError("the result has no skin to draw: its folder has no surface.npz that can be read")
            else:
                profiles[name] = _along(self.profiles[state.step], title, state, self._path_note())
        return profiles


def _keep(path: Path, state: ContactState, snapshot: "Snapshot", sites: Array | None) -> None:
    shown: dict[str, Any] = {} if sites is None else {"merkel": sites}
    _put(path, {"bone_x": np.array(state.bone_x), **shown, **vars(snapshot)})


def _put(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write arrays into a file, which is there as a whole or not at all."""
    data = BytesIO()
    np.savez_compressed(data, **arrays)
    replace(path, data.getvalue())


def _title(name: str, state: ContactState) -> str:
    return called(name, state.voltage).capitalize()


def _note(mesh: str, contact_size: float) -> str:
    return f"{mesh}, contact size {contact_size * 1e6:.3g} µm"


def _joined(title: str, note: str) -> str:
    return f"{title}\n{note}" if note else title


def _numbers(profile: Profile, state: ContactState) -> NDArray[np.int64]:
    """Return the number of each ridge, 0 at the centre, shape (ridges,)."""
    count = len(profile.d_eq)
    return np.arange(count) - count // 2 if state.ridges is None else state.ridges.number


def _places(profile: Along | None, state: ContactState) -> dict[int, float]:
    """Return the current abscissa (m) of the lowest point of each ridge that can touch, by its number."""
    if profile is None:
        return {}
    along = _arrays(profile, state)
    lowest = {int(k): np.where(along["ridge"] == k, along["y"], np.inf).argmin() for k in _known(along["ridge"])}
    return {k: float(along["x"][point]) for k, point in lowest.items()}


def _known(values: Array) -> Array:
    return np.unique(values[np.isfinite(values)])


def _along(profile: Along, title: str, state: ContactState, note: str) -> SurfaceProfile:
    """Return the skin sorted along each ridge, a NaN between ridges."""
    given = {k: getattr(state, k) for k in ("f_ext", "voltage", "bone_x", "contact_length")}
    return SurfaceProfile(title=title, note=note, **_arrays(profile, state), **given)


def _arrays(profile: Along, state: ContactState) -> dict[str, Any]:
    """Return the arrays of a :class:`SurfaceProfile` by name."""
    if not isinstance(profile, Profile):
        return dict(profile)
    skin = profile.skin(_numbers(profile, state))
    gap = np.broadcast_to(profile.d_eq[profile.ridge][:, None], skin.x.shape)
    number = np.broadcast_to(skin.ridge[:, None].astype(float), skin.x.shape)
    columns: list[list[Any]] = [[] for _ in range(7)]
    for k in np.unique(profile.ridge):
        mine = profile.ridge == k
        order = np.argsort(skin.x[mine], axis=None)
        for column, part in zip(columns, (skin.x, skin.y, skin.p_n, skin.t_t, skin.p_el, gap, number), strict=True):
            column += [part[mine].ravel()[order], [np.nan]]
    along = (np.concatenate(column) for column in columns)
    return dict(zip(("x", "y", "p", "t", "p_el", "d_eq", "ridge"), along, strict=True))
