"""Loads that do not move the bone sideways, reached on half the finger and put on the whole one as its mirror image.

The whole finger's mesh is the half's and its mirror image (:mod:`geometry.reflection`), so that the state that is put
on it is one of equilibrium, and symmetric to roundoff. Whether it is stable is examined on the whole finger, where it
may turn over to one side (:mod:`fingerpad.model.stability`).
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fingerpad.model import symmetry
from fingerpad.model.finger import Finger, assembled
from fingerpad.model.options import FingerModel
from variational.problem import Problem
from variational.solvers.continuation import Attempt, Continuation, Target

Array = NDArray[np.float64]
_SAME = 1e-9  # m, within which two nodes are one


class HalfFinger:
    """Leads the half of a finger, and the whole one with it."""

    def __init__(
        self, model: FingerModel, finger: Finger, comm: MPI.Comm, on_accept: Callable[[Target, float, Attempt], bool]
    ) -> None:
        """Mesh the half and set its solver up; collective.

        Args:
            model: of the finger.
            finger: the whole one, in its unloaded state.
            comm: communicator of the meshes.
            on_accept: called when the whole finger has accepted the state that the half has reached, see
                :class:`variational.solvers.continuation.Continuation`.
        """
        self._finger, self._comm, self._on_accept = finger, comm, on_accept
        # The image doubles the squares of the forces that are left.
        half = model.changed(numerics=model.numerics.model_copy(update={"tolerance": model.numerics.tolerance / 2}))
        self._body = assembled(half, comm, self._accepted, half=True)[1]
        self._own = np.arange(self._body.problem.V.dofmap.index_map.size_local)
        here = self._body.problem.V.tabulate_dof_coordinates()[self._own, :2]
        there = finger.problem.V.tabulate_dof_coordinates()[:, :2]
        self._flip = np.where(there[:, :1] < 0, [-1.0, 1.0], [1.0, 1.0])
        self._nodes = self._images(here, there)
        self._pressures = self._images(_pressure_places(self._body.problem), _pressure_places(finger.problem))

    @property
    def path(self) -> Continuation:
        """What leads the half."""
        return self._body.continuation

    def run(self, target: Target) -> None:
        """Reach a target, see :meth:`variational.solvers.continuation.Continuation.run`; collective."""
        self._body.continuation.run(target)

    def free(self) -> None:
        """Free the memory that the half's solver takes, which cannot be used any more; collective."""
        self._body.solver.iteration.free()

    def count(self) -> None:
        """Count the half's work as the finger's."""
        whole, half = self._finger.solver, self._body.solver
        whole.counts.add(half.counts)
        whole.timings.add(half.timings)

    def _images(self, here: Array, there: Array) -> NDArray[np.int64]:
        """Return which place of the half, of those of all ranks, each place of the finger is the image of; collective.

        Args:
            here: places of this rank's unknowns of the half (m), x first, with further numbers that tell them apart.
            there: the same of the finger.
        """
        far, found = cKDTree(self._together(here)).query(np.column_stack([np.abs(there[:, 0]), there[:, 1:]]))
        if not self._comm.allreduce(float(np.max(far, initial=0.0)), op=MPI.MAX) < _SAME:
            raise RuntimeError("the finger's mesh is not its own mirror image")
        return np.asarray(found)

    def _together(self, mine: Array) -> Array:
        return np.concatenate(self._comm.allgather(mine))

    def _accepted(self, target: Target, part: float, attempt: Attempt) -> bool:
        """Put the half's accepted state on the finger."""
        half, whole = self._body.coupling, self._finger.coupling
        solver = whole.solver
        solver.new_load(replace(half.solver.control), float(half.solver.problem.voltage.value))
        d_eq, whole.gain = (np.array(symmetry.values(list(values))) for values in (half.d_eq, half.gain))
        whole.set_air_gaps(d_eq)
        w = self._flip * self._together(half.solver.problem.w.x.array.reshape(-1, 2)[self._own])[self._nodes]
        solver.take(w, half.solver.bone, self._together(half.solver.pressure)[self._pressures])
        solver.problem.dt.value = half.solver.problem.dt.value
        self._finger.continuation.accept()
        return self._on_accept(target, part, attempt)


def _pressure_places(problem: Problem) -> Array:
    """Return where a mixed element's unknowns of the pressure are (m), and in which layer, shape (owned, 3)."""
    return problem.pressure.places() if problem.pressure else np.empty((0, 3))
