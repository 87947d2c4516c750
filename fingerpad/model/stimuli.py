r"""What mechanoreceptors are given: compressive stress at their sites, and the strain of the skin along its surface.

The compressive stress is minus the Cauchy stress normal to the screen. The strain is that of half a ridge on average,

.. math:: \varepsilon = \frac{1}{L} \int_L \Big( \frac{ds}{dS} - 1 \Big) dS,

over its reference length L: in plane strain the stretch ds/dS is the current area over the reference area.
"""

import numpy as np
import ufl
from mpi4py import MPI
from numpy.typing import NDArray

from fingerpad.model.finger import Finger
from variational.output import Receptors
from variational.state import Stimuli

Array = NDArray[np.float64]


class SiteStimuli:
    """The stimuli of a finger with receptor sites."""

    def __init__(self, finger: Finger) -> None:
        """Find the sites, and the halves of the ridges that can touch; collective."""
        self._finger, profiles = finger, finger.profiles
        sites = np.concatenate([profiles.merkel_sites(), profiles.meissner_sites(), profiles.pacinian_sites()])
        if not finger.options.both_halves:  # where their mirror images are
            sites[:, 0] = np.abs(sites[:, 0])
        self._sites = Receptors(finger.problem, sites)
        surface = finger.problem.surface
        x, y = surface.evaluate(surface.compile(list(ufl.SpatialCoordinate(surface.mesh))))
        self._number = np.array(surface.ridge_numbers)
        middle = self._number[surface.ridge] * profiles.finger.ridge_wavelength
        arcs = profiles.along_skin(np.column_stack([x.ravel(), y.ravel()])).reshape(x.shape)
        self._half = 2 * surface.ridge[:, None] + (arcs > middle[:, None])
        self._weight = surface.measure_at * surface.weights

    def present(self) -> Stimuli:
        """Return the stimuli of the present state, on every rank; collective."""
        number, stress = np.array(self._finger.profiles.ridges), self._sites.compression()
        merkel, meissner, pacinian = np.split(stress, [len(number), 3 * len(number)])
        left, right = meissner.reshape(-1, 2).T
        strain = np.full((len(number), 2), np.nan)
        found = self._strain()
        strain[np.searchsorted(number, self._number)] = found
        if not self._finger.options.both_halves:
            strain[np.searchsorted(number, -self._number)] = found[:, ::-1]
            strain[number == 0] = found[self._number == 0, 1]
        return Stimuli(number, merkel, left, right, pacinian, *strain.T)

    def _strain(self) -> Array:
        """Return the mean strain along the surface of both halves of the ridges that can touch, shape (ridges, 2)."""
        skin = self._finger.continuation.surface_state
        stretch = np.hypot(skin.area_x, skin.area_y)
        sums = np.zeros((2, 2 * len(self._number)))
        for total, values in zip(sums, (self._weight, self._weight * (stretch - 1)), strict=True):
            total += np.bincount(self._half.ravel(), weights=values.ravel(), minlength=len(total))
        self._finger.problem.surface.mesh.comm.Allreduce(MPI.IN_PLACE, sums)
        length, change = sums
        return np.divide(change, length, out=np.full_like(change, np.nan), where=length > 0).reshape(-1, 2)
