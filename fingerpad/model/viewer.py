"""A state of the whole finger as tables and pictures show it, whatever mesh and half of it the model has."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.io.views import Profile, View
from fingerpad.model import symmetry
from fingerpad.model.finger import Finger, Step
from variational.output import Snapshot, gather_mesh
from variational.receptors import Receptors

Array = NDArray[np.float64]
_PROFILE = ("x", "y", "p_n", "t_t", "p_el", "area_x", "area_y")


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

    def view(self, step: Step) -> View:
        """Return all that is shown of the present state, that of the step; collective."""
        profile, (snapshot, merkel) = self.profile(step), self.picture()
        mesh, receptors = self._finger.size, list(self.receptors(step))
        return View(step.state, mesh, profile, snapshot, merkel, list(self.ridges(step)), receptors)

    def profile(self, step: Step) -> Profile | None:
        """Return the skin of a step, the present one, on rank 0, None elsewhere; collective."""
        surface, skin = self._finger.problem.surface, self._finger.continuation.surface_state
        values = surface.gather(np.stack([getattr(skin, name) for name in _PROFILE]))
        ridge = surface.gather(surface.ridge[None, :, None].astype(float))
        if values is None or ridge is None:
            return None
        where = ridge[0, :, 0].astype(int)
        if not self._finger.options.both_halves:
            values, where = symmetry.profile(_PROFILE, values, where)
        return Profile(where, values, step.state.d_eq)

    def picture(self) -> tuple[Snapshot | None, Array | None]:
        """Return the present state of the whole finger, and where the Merkel sites are if wanted; collective."""
        snapshot, ridges = gather_mesh(self._finger.problem), np.array(self._finger.profiles.ridges)
        merkel = self._sites.positions()[: len(ridges)] if self._sites else None
        if not self._finger.options.both_halves:
            snapshot = symmetry.snapshot(snapshot) if snapshot else None
            if merkel is not None:
                merkel[ridges < 0, 0] *= -1
        return snapshot, merkel

    def ridges(self, step: Step) -> Iterator[dict[str, Any]]:
        """Yield the row of each ridge in contact."""
        values = step.state.ridges
        assert values is not None
        for k, note in enumerate(step.notes):
            if values.length[k] > 0:
                yield {
                    "step": step.state.step,
                    "ridge": int(values.number[k]),
                    "contact_length": values.length[k],
                    "f_contact": values.f_contact[k],
                    "f_friction": values.f_friction[k],
                    "f_electrostatic": values.f_electrostatic[k],
                    "p_c": values.p_c[k],
                    "d_eq": values.d_eq[k],
                    "state": note,
                }

    def receptors(self, step: Step) -> list[dict[str, Any]]:
        """Return the row of each ridge's sites in the present state, that of the step; collective."""
        if self._sites is None:
            return []
        names, sed = self._finger.profiles.ridges, self._sites.sed()
        merkel, meissner = sed[: len(names)], sed[len(names) :].reshape(-1, 2)
        return [
            {
                "step": step.state.step,
                "ridge": j,
                "merkel_sed": at_tip,
                "meissner_left": left,
                "meissner_right": right,
            }
            for j, at_tip, (left, right) in zip(names, merkel, meissner, strict=True)
        ]
