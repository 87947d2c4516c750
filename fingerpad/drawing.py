"""The pictures of a run from its rows and views, each under a title that names the state it shows; on rank 0."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingerpad import pictures, titles
from fingerpad.states import WORDS, Row, before_sliding, named, partial_slip
from fingerpad.views import Profile, View
from variational.output import Snapshot

_PATH, _FINAL = "path on the starting mesh", "final mesh"


@dataclass(frozen=True)
class Drawing:
    """What a run's pictures are drawn from."""

    folder: Path
    mu_0: float | None
    """Friction coefficient; None where the law of friction is not Coulomb's."""
    rows: Sequence[Row]
    profiles: Mapping[int, Profile]
    """The skin by step."""
    ends: Mapping[str, tuple[Row, Snapshot, NDArray[np.float64] | None]]
    """The state at the end of each load: its row, the finger and its Merkel sites."""
    finer: Mapping[str, View]
    """Normal contact and full slip on another mesh than the path's, by their names in :mod:`fingerpad.states`."""
    starting_size: float | None
    """Contact size (m) of the mesh of the path, where an accuracy was asked for."""

    def draw(self) -> None:
        """Write every picture and its arrays."""
        for load, (row, snapshot, sites) in self.ends.items():
            self._finger(load.replace(" ", "_"), f"After {load}", row, snapshot, sites, self._path_note())
        for name, view in self.finer.items():
            if view.snapshot is not None:
                title, words = WORDS[name], WORDS[name].replace(" ", "_")
                note = _note(_FINAL, view.mesh.contact)
                self._finger(words, title.capitalize(), view.row, view.snapshot, view.merkel, note)
        if len(before_sliding(self.rows)) not in (0, len(self.rows)):
            self._surface()
            shown = self.rows[len(before_sliding(self.rows)) - 1 :]
            conditions = _joined(titles.conditions_of(shown, self.mu_0), self._path_note())
            pictures.history(self.folder / "history.png", shown, conditions, self.mu_0)

    def _path_note(self) -> str:
        return "" if self.starting_size is None else _note(_PATH, self.starting_size)

    def _finger(
        self, name: str, title: str, row: Row, snapshot: Snapshot, sites: NDArray[np.float64] | None, note: str
    ) -> None:
        conditions = titles.conditions(row["f_ext"], row["voltage"], self.mu_0, row["bone_x"])
        shown: dict[str, Any] = {} if sites is None else {"merkel": sites}
        np.savez_compressed(self.folder / f"finger_{name}.npz", **shown, **vars(snapshot))
        words = _joined(f"{title}: {conditions}", note)
        pictures.finger(self.folder / f"finger_{name}.png", snapshot, sites, words)

    def _surface(self) -> None:
        found, partial = named(self.rows), partial_slip(self.rows)
        shown = {"normal": ("Normal contact", found["normal"])} if "normal" in found else {}
        if partial is not None:
            shown["partial"] = ("Partial slip", partial)
        shown["slip"] = ("Full slip", found["slip"]) if "slip" in found else ("Last state", self.rows[-1])
        states, rows = {}, list[Row]()
        for name, (title, row) in shown.items():
            view = self.finer.get(name)
            if view is not None and view.profile is not None:
                rows.append(view.row)
                states[name] = _along(view.profile, title, view.row, _note(_FINAL, view.mesh.contact))
            else:
                rows.append(row)
                states[name] = _along(self.profiles[row["step"]], title, row, self._path_note())
        arrays: dict[str, Any] = {
            f"{name}_{field}": value
            for name, state in states.items()
            for field, value in vars(state).items()
            if isinstance(value, np.ndarray)
        }
        np.savez_compressed(self.folder / "surface.npz", **arrays)
        conditions = titles.conditions_of(rows, self.mu_0)
        pictures.surface(self.folder / "surface.png", list(states.values()), conditions)


def _note(mesh: str, contact_size: float) -> str:
    return f"{mesh}, contact size {contact_size * 1e6:.3g} µm"


def _joined(title: str, note: str) -> str:
    return f"{title}\n{note}" if note else title


def _along(profile: Profile, title: str, row: Row, note: str) -> pictures.SurfaceProfile:
    """Return the skin sorted along each ridge, a NaN between ridges."""
    x, y, p_n, t_t, p_el, area_x, area_y = profile.values
    stretch = np.hypot(area_x, area_y)
    gap = np.broadcast_to(profile.d_eq[profile.ridge][:, None], x.shape)
    columns: list[list[Any]] = [[] for _ in range(6)]
    for k in np.unique(profile.ridge):
        mine = profile.ridge == k
        order = np.argsort(x[mine], axis=None)
        for column, part in zip(columns, (x, y, p_n / stretch, t_t / stretch, p_el, gap), strict=True):
            column += [part[mine].ravel()[order], [np.nan]]
    along = (np.concatenate(column) for column in columns)
    given = {name: row[name] for name in ("f_ext", "voltage", "bone_x", "contact_length")}
    arrays: dict[str, Any] = dict(zip(("x", "y", "p", "t", "p_el", "d_eq"), along, strict=True))
    return pictures.SurfaceProfile(title=title, note=note, **arrays, **given)
