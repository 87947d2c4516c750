"""A state of the whole finger as tables and pictures show it, whatever mesh and half of it the model has."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fingerpad.io.drawing import Profile, View
from fingerpad.model import symmetry
from variational.output import Snapshot, gather_mesh
from variational.receptors import Receptors
from variational.state import Sites

if TYPE_CHECKING:
    from fingerpad.model.finger import Finger, Step

Array = NDArray[np.float64]
_PROFILE = ("x", "y", "p_n", "t_t", "p_el", "area_x", "area_y")


class Viewer:
    """Collects the states of a finger for tables and pictures."""

    def __init__(self, finger: "Finger") -> None:
        """Find the receptor sites, if they are part of the model."""
        self._finger = finger
        profiles = finger.profiles
        sites = np.concatenate([profiles.merkel_sites(), profiles.meissner_sites()])
        if not finger.options.both_halves:  # where their mirror images are
            sites[:, 0] = np.abs(sites[:, 0])
        self._sites = Receptors(finger.problem, sites) if finger.options.receptors else None

    def view(self, step: "Step") -> View:
        """Return all that is shown of the present state, that of the step; collective."""
        profile, (snapshot, merkel) = self.profile(step), self.picture()
        return View(replace(step.state, sites=self.sites()), self._finger.size, profile, snapshot, merkel)

    def profile(self, step: "Step") -> Profile | None:
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

    def sites(self) -> Sites | None:
        """Return the energy densities at the receptor sites in the present state, None without them; collective."""
        if self._sites is None:
            return None
        names, sed = self._finger.profiles.ridges, self._sites.sed()
        left, right = sed[len(names) :].reshape(-1, 2).T
        return Sites(np.array(names), sed[: len(names)], left, right)
