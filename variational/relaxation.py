r"""Viscous layers of a body: the history of their stresses, and the law of the present step.

Each group of layers of one :class:`~variational.materials.viscoelastic.Viscoelastic` law has the fields of history

- ``isochoric stress``, S of the elastic law, and ``overstress 1``, ``overstress 2``, ..., Q of each branch (Pa), with
  the components 11, 22, 12 and 33;
- ``strain``, Green's, with the components 11, 22 and 12, and ``viscous work`` (J/m^3), the work of all Q so far,

  .. math:: w^{n+1} = w^n + \tfrac12 \sum_i (Q_i^n + Q_i^{n+1}) : (E^{n+1} - E^n);

- ``branch energies`` (J/m^3), what each branch stores.

All are values at the quadrature points of the energy, held as the polynomials through them, which other points can
read. The law of the step has the scale and the stress that follow from them and from the time ``lapse`` that has passed
since they were accepted: the duration of a step on the way to its state, and zero in an accepted state, of whose stress
they are then part. Both are written once a step (:meth:`Relaxation.prepare`), so that forms do not sum over branches.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import basix
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray

from variational import compat, jit
from variational.history import BodyField, Values
from variational.materials.material import Material
from variational.materials.viscoelastic import Viscoelastic

Array = NDArray[np.float64]
_STRESS, _STRAIN = "isochoric stress", "strain"
_WORK, _ENERGIES = "viscous work", "branch energies"
_STATE = 13  # numbers of StepLaw.strained
_ENGINEERING = np.array([1.0, 1.0, 2.0])  # stress 12 does work on twice strain 12


@dataclass(frozen=True, eq=False)
class _LayerField(BodyField):
    """Numbers at the quadrature points of some layers, as the polynomial through them; zero in other layers."""

    layers: "Relaxation"
    """What they belong to."""

    def left(self) -> Values:
        """Return what a step to the present state leaves of all fields of these layers; collective."""
        return self.layers.left()

    def at_points(self, values: Array) -> Array:
        """Return values as in ``x.array`` at the points of these layers, shape (cells, points, components)."""
        return np.asarray(self.layers.to_points @ self.by_cell(values)[self.layers.cells])


def relaxations(
    laws: Mapping[tuple[int, ...], Material],
    w: fem.Function,
    lapse: fem.Constant,
    cell_tags: dolfinx.mesh.MeshTags,
    quadrature_degree: int,
) -> dict[tuple[int, ...], "Relaxation"]:
    """Return the history of each group of layers whose law is viscous; arguments as in :class:`Relaxation`."""
    return {
        tags: Relaxation(cast(Viscoelastic, law), w, lapse, cell_tags, tags, quadrature_degree)
        for tags, law in laws.items()
        if law.times
    }


class Relaxation:
    """The history of a group of viscous layers.

    Attributes:
        law: of the present step.
        fields: of history, by name.
        cells: this rank's own cells of these layers.
        to_points: matrix from nodal values to those at the points.
        lost: energy (J/m^3) that each branch dissipated in the last accepted step at the points of these layers, shape
            (cells, points, branches).
        dissipation: the same of all branches.
    """

    def __init__(
        self,
        law: Viscoelastic,
        w: fem.Function,
        lapse: fem.Constant,
        cell_tags: dolfinx.mesh.MeshTags,
        tags: tuple[int, ...],
        quadrature_degree: int,
    ) -> None:
        """Start from unloaded layers.

        Args:
            law: with fields in the place of its numbers.
            w: displacement (m).
            lapse: time (s) since the history was accepted.
            cell_tags: tags of layers.
            tags: of these layers.
            quadrature_degree: of the energy.
        """
        mesh = w.function_space.mesh
        self._points = np.asarray(basix.make_quadrature(basix.CellType.triangle, quadrature_degree)[0])
        degree = {1: 0, 3: 1, 6: 2}[len(self._points)]
        cells = np.concatenate([cell_tags.find(tag) for tag in tags]).astype(np.int32)
        self.cells = np.sort(cells[cells < mesh.topology.index_map(2).size_local])
        self._named, self._lapse, self._branches = ", ".join(map(str, tags)), lapse, law.branches
        self._overstresses = [f"overstress {k}" for k in range(1, len(law.branches) + 1)]

        def space(components: int) -> fem.FunctionSpace:
            shape = (components,) if components > 1 else ()
            return fem.functionspace(mesh, ("Discontinuous Lagrange", degree, shape))

        stresses = space(4)
        spaces = {_STRESS: stresses, _STRAIN: space(3), **dict.fromkeys(self._overstresses, stresses)}
        spaces |= {_WORK: space(1), _ENERGIES: space(len(law.branches))}
        functions = {name: fem.Function(each) for name, each in spaces.items()}
        self.fields = {name: _LayerField(f"{name} of {self._named}", None, f, self) for name, f in functions.items()}
        element = spaces[_WORK].element.basix_element
        self.to_points = np.asarray(element.tabulate(0, self._points))[0, :, :, 0]
        self._to_nodes = np.linalg.inv(self.to_points)
        nodes = stresses.dofmap.list
        self._cell_of = np.empty(nodes.size, dtype=np.int64)  # of each node
        self._cell_of[nodes] = np.arange(len(nodes))[:, None]
        self._scale = fem.Function(fem.functionspace(mesh, ("Discontinuous Lagrange", 0)))
        self._held = fem.Function(stresses)
        energies = functions[_ENERGIES]
        stored = sum(energies[k] for k in range(len(law.branches))) if energies.ufl_shape else energies
        self.law = law.step(self._scale, self._held, stored)
        self._state = self.law.strained(ufl.grad(w))
        self.lost = np.zeros((len(self.cells), len(self._points), len(law.branches)))
        self.dissipation = fem.Function(spaces[_WORK])
        self.prepare()

    @cached_property
    def _at_points(self) -> fem.Expression:
        return fem.Expression(self._state, self._points, jit_options=jit.OPTIONS)

    def _factors(self) -> list[tuple[Array, Array, Array]]:
        """Return, for each branch, its weight and the parts exp(-lapse / tau) and exp(-lapse / 2 tau), by cell."""
        found, lapse = [], float(self._lapse.value)
        for weight, time in self._branches:
            tau = time.x.array
            rate = np.divide(lapse, tau, out=np.zeros_like(tau), where=tau != 0)  # other layers have no time
            found.append((weight.x.array, np.exp(-rate), np.exp(-rate / 2)))
        return found

    def prepare(self) -> None:
        """Write scale and stress of the present step, by history and the time since it was accepted."""
        factors, of = self._factors(), self._cell_of
        self._scale.x.array[:] = 1 + sum(weight * half for weight, _, half in factors)
        stress = self.fields[_STRESS].function.x.array.reshape(-1, 4)
        held = np.zeros_like(stress)
        for name, (weight, left, half) in zip(self._overstresses, factors, strict=True):
            past = self.fields[name].function.x.array.reshape(-1, 4)
            held += left[of, None] * past - (weight * half)[of, None] * stress
        self._held.x.array[:] = held.ravel()

    def left(self) -> Values:
        """Return what a step to the present state leaves of all fields; collective."""
        values = compat.evaluate_on_cells(self._at_points, self._held.function_space.mesh, self.cells)
        found = np.split(values.reshape(len(self.cells), len(self._points), _STATE), [4, 7], axis=2)
        past = {name: each.at_points(each.function.x.array) for name, each in self.fields.items()}
        dS, dE = found[0] - past[_STRESS], (found[1] - past[_STRAIN]) * _ENGINEERING
        at_points = {_STRESS: found[0], _STRAIN: found[1], _WORK: past[_WORK]}
        energies = []
        for k, (name, factors) in enumerate(zip(self._overstresses, self._factors(), strict=True)):
            weight, left, half = (each[self.cells, None, None] for each in factors)
            before = past[name]
            now = at_points[name] = left * before + weight * half * dS
            at_points[_WORK] = at_points[_WORK] + ((before + now)[..., :3] * dE).sum(axis=2, keepdims=True) / 2
            risen, after = (_stored(Q, found[2]) / weight[..., 0] for Q in (half * before + weight * dS, now))
            self.lost[..., k] = (1 - left[..., 0]) * past[_ENERGIES][..., k] + risen - after
            energies.append(after)
        at_points[_ENERGIES] = np.stack(energies, axis=2)
        self.dissipation.x.array[:] = self._to_field(_WORK, self.lost.sum(axis=2, keepdims=True))
        return {self.fields[name].name: self._to_field(name, each) for name, each in at_points.items()}

    def _to_field(self, name: str, values: Array) -> Array:
        """Return values at the points as in ``x.array``; collective."""
        field = self.fields[name]
        found = np.zeros((*field.cells.shape, values.shape[2]))
        found[self.cells] = self._to_nodes @ values
        return field.from_cells(found)

    def extremes(self) -> tuple[float, float]:
        """Return the least and largest energy (J/m^3) that a branch lost in the last step at a point; collective."""
        comm = self._held.function_space.mesh.comm
        return (
            float(comm.allreduce(float(self.lost.min(initial=np.inf)), op=MPI.MIN)),
            float(comm.allreduce(float(self.lost.max(initial=-np.inf)), op=MPI.MAX)),
        )


def _stored(Q: Array, M: Array) -> Array:
    """Return Q : M : Q / 2 (J/m^3), shape (cells, points), of stresses (Pa) and the M (1/Pa) of StepLaw.strained."""
    a, b, c = (Q[..., k] for k in range(3))
    m = [M[..., k] for k in range(6)]
    return np.asarray((m[0] * a * a + m[1] * b * b + m[2] * c * c) / 2 + m[3] * a * b + m[4] * a * c + m[5] * b * c)


class Spent:
    """Compiled integrals (J/m) over all viscous layers."""

    def __init__(self, found: Mapping[tuple[int, ...], Relaxation], dx: ufl.Measure) -> None:
        """Compile the work on all branches so far, and what they dissipated in the last accepted step."""
        works = ((each.fields[_WORK].function, tags) for tags, each in found.items())
        lost = ((each.dissipation, tags) for tags, each in found.items())
        self._comm = next(iter(found.values())).dissipation.function_space.mesh.comm
        self._forms = [
            fem.form(sum(f * dx(tags) for f, tags in each), jit_options=jit.OPTIONS) for each in (works, lost)
        ]

    def __call__(self) -> tuple[float, float]:
        """Return work so far and dissipation of the last step; collective."""
        work, lost = (self._comm.allreduce(float(fem.assemble_scalar(form)), op=MPI.SUM) for form in self._forms)
        return work, lost
