"""A finger, or half of it, meshed and set up, and its present state in numbers of the whole finger."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fingerpad.model.options import FingerModel, refuse_mesh, refuse_sizes
from fingerpad.model.state import contact_state, force_error, refuse_unbalanced
from fingerpad.scene.controls import ends_of
from geometry import fingertip, mesh, meshfile, tags
from geometry.profiles import Profiles
from variational.attraction.electroadhesion import ELECTROSTATIC
from variational.body import Body
from variational.contact.formulation import SurfaceState
from variational.contact.interface import Interface
from variational.energy import EnergyBook
from variational.problem import Problem
from variational.resultants import RidgeLoads
from variational.solvers.continuation import Attempt, Continuation
from variational.solvers.target import Target
from variational.state import ContactState

Array = NDArray[np.float64]
_MAX_DISTANCE = 1e-9  # m, within which two nodes are one


@dataclass(frozen=True)
class Step:
    """An accepted step."""

    state: ContactState
    attempt: Attempt
    touches: bool = False
    """Whether the bone was lowered to a first touch."""
    ends: bool = False
    """Whether its load is reached."""


class Finger:
    """A meshed finger with its solver.

    Attributes:
        ridges: numbers of the ridges that can touch, of the whole finger.
        options: the parts of the model.
        size: element sizes of its mesh.
        unknowns: number of unknowns.
        contact_size: size of the facets that can touch (m).
    """

    def __init__(self, model: FingerModel, comm: MPI.Comm, on_accept: Callable[[Target, float, Attempt], bool]) -> None:
        """Mesh the finger and set its :class:`~variational.solvers.continuation.Continuation` up; collective."""
        self.options, self.size, self.profiles = model.options, model.mesh, Profiles(model.geometry)
        self.closure = model.closure
        half = not model.options.both_halves
        self.mesh, made = assembled(model, comm, on_accept, half)
        self._tolerance = model.numerics.tolerance
        self.problem, self.solver, self.observer = made.problem, made.solver, made.observer
        self.coupling, self.continuation = made.coupling, made.continuation
        self.ridges = mirrored(made.surface.ridge_numbers) if half else made.surface.ridge_numbers
        shortest = float(np.min(comm.allgather(made.surface.length.min(initial=np.inf))))
        self.contact_size = model.mesh.contact if model.mesh_file is None else shortest
        self.unknowns = self.solver.layout.global_size

    @property
    def voltage(self) -> float:
        """Present voltage (V)."""
        return float(self.problem.voltage.value)

    @property
    def force_error(self) -> float:
        """What the solves' tolerance leaves of a sum of nodal forces (N/m), see :mod:`fingerpad.model.state`."""
        left = max(self._tolerance, self.solver.floor)
        return force_error(self.unknowns, left, self.solver.force_scale)

    def book(self) -> EnergyBook:
        """Return a book of energies that begins in the present state; collective."""
        return EnergyBook(self.problem, *self.surface_and_bone(), copies=1 if self.options.both_halves else 2)

    def surface_and_bone(self) -> tuple[SurfaceState, Array, Array, Array]:
        """Return the skin, the bone's place and reaction, and the air gaps of the present state."""
        return self.continuation.surface_state, self.solver.bone, self.solver.reaction, self.coupling.d_eq

    def ridge_loads(self, by_gap: bool = False) -> RidgeLoads:
        """Return :meth:`variational.resultants.Observer.ridge_loads` of the whole finger; collective."""
        loads = self.observer.ridge_loads(self.continuation.surface_state, by_gap)
        return loads if self.options.both_halves else loads.whole()

    def check_balance(self, loads: RidgeLoads, load: str) -> float:
        """Return the largest force left at a node, over the solver's force scale.

        Raises:
            StepFailed: see :func:`fingerpad.model.state.refuse_unbalanced`.
        """
        left, scale = self.solver.imbalance(), self.solver.force_scale
        where = f"step {self.continuation.steps} ({load})"
        refuse_unbalanced(where, left, loads, self.solver.reaction, scale, self._tolerance, self.solver.floor)
        return left

    def present(self, loads: RidgeLoads, load: str, number: int, attempt: Attempt | None = None) -> Step:
        """Return the present state as a step without a record of energies and work; collective.

        Args:
            loads: its :meth:`ridge_loads`.
            load: name of the load.
            number: of the load in the history, from 1.
            attempt: how the state was solved, where that is known.
        """
        d_eq = self.coupling.d_eq
        if not self.options.both_halves:
            d_eq = both_sides(d_eq)
        p_c = self.ridge_loads(by_gap=True).p_c if self.coupling.by_gap else loads.p_c  # the closure's own
        notes = [self.closure.state(float(p), self.voltage) if self.closure else "" for p in p_c]
        state = contact_state(
            self.continuation, loads, self.ridges, d_eq, notes,
            load=load, load_number=number, mesh_contact=self.contact_size,
        )  # fmt: skip
        return Step(state, attempt or Attempt())


def mirrored(half: list[int]) -> list[int]:
    """Return the numbers of all ridges from those of ridge 0 and on; ridge -j is the image of ridge j."""
    return [-j for j in half[:0:-1]] + half


def both_sides(half: Array) -> Array:
    """Return one value a ridge that the mirror does not change."""
    return np.concatenate([half[:0:-1], half])


def assembled(
    model: FingerModel, comm: MPI.Comm, on_accept: Callable[[Target, float, Attempt], bool], half: bool
) -> tuple[mesh.TaggedMesh, Body]:
    """Return the mesh of a finger, or of its half at x >= 0, and its solver in the unloaded state; collective."""
    numerics, tagged = model.numerics, meshed(model, comm, half)
    attraction = ELECTROSTATIC if model.options.voltage else None
    layers = tagged.layers().values()
    body = Body(
        tagged,
        {tag: solid for tag, solid in model.solids.items() if tag in layers},
        Interface(model.contact, model.friction, model.h_0, attraction, model.share, model.adhesion),
        model.closure,
        element=numerics.element,
        points=numerics.quadrature_points,
        force_scale=max((ends_of(load.f_ext)[1] for load in model.loads if load.f_ext), default=1.0),
        tolerance=numerics.tolerance,
        mirror=tagged.facets(tags.SYMMETRY) if half else None,
        coupling_tolerance=numerics.coupling_tolerance,
        coupling_cap=numerics.coupling_cap,
        by_gap=model.by_gap,
        on_accept=on_accept,
        step_scale=numerics.step_scale,
    )
    return tagged, body


def meshed(model: FingerModel, comm: MPI.Comm, half: bool | None = None) -> mesh.TaggedMesh:
    """Return the mesh of a finger, or of its half at x >= 0, by default as the model's options have it; collective.

    Raises:
        GeometryError: it cannot be meshed, or needs more memory than is allowed, for which no file is refused.
    """
    if model.mesh_file is not None:
        return mesh.load(comm, meshfile.file(model.mesh_file, model.mesh_sha256 or ""))
    half = not model.options.both_halves if half is None else half
    refuse_sizes(model.geometry, model.mesh, model.numerics, model.options)
    build = partial(fingertip.build, model.geometry, model.mesh, model.options.receptors, half, model.edges)
    found = mesh.load(comm, build, tags.LAYERS.values())
    points, triangles = (found.mesh.topology.index_map(dimension).size_global for dimension in (0, 2))
    refuse_mesh(points, triangles, model)
    return found


class HalfFinger:
    """Leads the half of a finger through loads that do not move the bone sideways, and the whole one with it.

    The whole finger's mesh is the half's and its mirror image (:mod:`geometry.reflection`), so that the state that is
    put on it is one of equilibrium, and symmetric to roundoff. Whether it is stable is examined on the whole finger,
    where it may turn over to one side (:mod:`fingerpad.model.checks`).
    """

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
        if not self._comm.allreduce(float(np.max(far, initial=0.0)), op=MPI.MAX) < _MAX_DISTANCE:
            raise RuntimeError("the finger's mesh is not its own mirror image")
        return np.asarray(found)

    def _together(self, mine: Array) -> Array:
        return np.concatenate(self._comm.allgather(mine))

    def _accepted(self, target: Target, part: float, attempt: Attempt) -> bool:
        self.show()
        return self._on_accept(target, part, attempt)

    def show(self) -> None:
        """Put the half's accepted state on the finger; collective."""
        half, whole = self._body.coupling, self._finger.coupling
        solver = whole.solver
        solver.new_load(replace(half.solver.control), float(half.solver.problem.voltage.value))
        d_eq, whole.gain = map(both_sides, (half.d_eq, half.gain))
        whole.set_air_gaps(d_eq)
        w = self._flip * self._together(half.solver.problem.w.x.array.reshape(-1, 2)[self._own])[self._nodes]
        solver.problem.dt.value = half.solver.problem.dt.value
        solver.problem.elapse(float(solver.problem.dt.value))
        solver.take(w, half.solver.bone, self._together(half.solver.pressure)[self._pressures])
        self._finger.continuation.accept()
        self._finger.continuation.steps = self.path.steps


def _pressure_places(problem: Problem) -> Array:
    """Return where a mixed element's unknowns of the pressure are (m), and in which layer, shape (owned, 3)."""
    return problem.pressure.places() if problem.pressure else np.empty((0, 3))
