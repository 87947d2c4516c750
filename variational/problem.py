r"""The weak form of a layered body pressed and dragged over a charged rigid screen.

Find u, equal to the bone's translation on its rim, with for all v alike

.. math:: \int P(F) : \nabla v \,dX - \int p_n v_y \,dS - \int t_t v_x \,dS
          - \int p_{el}\, \mathrm{cof} F N \cdot v \,dS + f_{ext} v_y^{bone} = 0

The unknown is :math:`w = u - u^{bone}`, the displacement relative to the bone, which is a constant of the forms. A
rigid translation then adds no digits to the strains: at 10 mm of sliding they are as exact as at none.

P = dW/dF of a :mod:`~variational.materials.material`, the volumetric part as the :mod:`~variational.element` has it,
which may bring a pressure p and a second equation, p = K (J - 1) weakly; p_n and t_t: a law of
:mod:`~variational.contact.friction` and :mod:`~variational.contact.formulation` in one of the formulations
:mod:`~variational.contact.penalty`, :mod:`~variational.contact.nitsche` (with terms of its own) and
:mod:`~variational.contact.augmented`; p_el: :mod:`~variational.attraction.electroadhesion`, written as the derivative
of its potential, as is :mod:`~variational.attraction.adhesion`. Without a voltage p_el is left out, without a law of
friction t_t is. Friction makes the derivative unsymmetric. The derivative may carry a shift :math:`\int \eta\, du \cdot
v \,dS`, which is no part of the equations but of pseudo-transient continuation (:mod:`~variational.solvers.transient`).
This module adds up forms and never solves.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import dolfinx
import numpy as np
import ufl
from dolfinx import fem

from variational import jit, kinematics
from variational.contact.formulation import STICKS, Contact, Skin
from variational.contact.interface import Interface
from variational.element import ELEMENTS, Centroid, Element, LayerwisePressure, grouped, write
from variational.history import History, SkinField
from variational.materials.material import Material
from variational.relaxation import Spent, relaxations
from variational.surface import Surface


class Problem:
    """Forms, and the fields and constants they read.

    Attributes:
        w: displacement relative to the bone (m), zero on its rim; the unknown.
        bone: constant, the bone's translation (m), shape (2,).
        u: displacement w + bone (m), UFL.
        pressure: the mixed element's pressure, None for the others.
        voltage, eta: constants (V; Pa/m, the shift of the Jacobian).
        dt: constant, the duration of the present step (s); 0 where loads change at once.
        lapse: constant, the time (s) since the history that forms read was accepted: dt on the way to a state, and 0
            once it is accepted; set by :meth:`elapse`.
        guess: constant, what points on the friction cone are first taken for:
            :data:`~variational.contact.formulation.STICKS` or SLIPS.
        ease: constant, part of the tangential stiffness of the contact that acts: 1 but on the way to an equilibrium.
        d_eq: equivalent air gap (m), one value a cell, read on the ridges.
        share: share of the voltage, as d_eq; None where it is the same for all ridges.
        anchor: imposed friction history (m), see :mod:`variational.contact.friction`; None without friction.
        multiplier: imposed contact pressure (Pa), read by an augmented Lagrangian.
        history: fields that accepted steps leave to the next one, these two among them.
        contact: the projected tractions.
        opening: length (m) that is negative in contact.
        laws, pressures, densities: each group of layers' material with its numbers as fields, viscous ones with the law
            of the step; volumetric pressure (Pa), positive in tension; and strain energy density (J/m^3), UFL.
        relaxations: history of each group of viscous layers.
        in_time: whether a state depends on the time that the way to it took.
        shortest_time: of all times (s) in which a law ages; infinite where none does.
        weak: residual and Jacobian in w and its test function, UFL.
        residual, jacobian: the same, compiled.
        energy: compiled, of strain and attraction (J/m), without what branches of viscous layers store.
        spent: work on the branches of viscous layers, and what they dissipate; None without such layers.
        skin_mass: compiled mass of the touching skin per unit density.
        pressure_residual: the equation of the pressure; with one only.
        pressure_jacobian: compiled blocks of the Jacobian in (v, dp), (q, du), (q, dp); with a pressure only.
    """

    def __init__(
        self,
        mesh: dolfinx.mesh.Mesh,
        cell_tags: dolfinx.mesh.MeshTags,
        surface: Surface,
        solids: Mapping[int, Material],
        interface: Interface,
        element: str = "P2",
    ) -> None:
        """Add up the forms.

        Args:
            mesh: the body (m).
            cell_tags: tags of its layers.
            surface: the skin that can touch.
            solids: material of each layer's tag.
            interface: laws of the contact.
            element: a name of :data:`variational.element.ELEMENTS`.

        Raises:
            ValueError: a material that is none, or skin that Nitsche's method cannot take; in one sentence.
        """
        self.mesh, self.cell_tags, self.surface, self.interface = mesh, cell_tags, surface, interface
        kind = ELEMENTS[element]
        self.V = fem.functionspace(mesh, ("Lagrange", kind.degree, (2,)))
        cellwise = fem.functionspace(mesh, ("Discontinuous Lagrange", 0))
        self.w = fem.Function(self.V)
        self.bone = fem.Constant(mesh, np.zeros(2))
        self.u = self.w + self.bone
        self.d_eq = fem.Function(cellwise)
        self.share = None if interface.share is None else fem.Function(cellwise)
        self.multiplier = fem.Function(surface.history_space)
        self.anchor = fem.Function(surface.history_space) if interface.friction is not None else None
        self.voltage, self.eta, self.guess = (self._constant(value) for value in (0.0, 0.0, STICKS))
        self.ease, self.dt, self.lapse = (self._constant(value) for value in (1.0, 0.0, 0.0))
        self._friction = None if interface.friction is None else interface.friction.with_constants(self._constant)
        self._h_0 = self._constant(interface.h_0)
        self._adhesion = None if interface.adhesion is None else interface.adhesion.with_constants(self._constant)
        self._springs: list[fem.Constant] = []

        self._dx = ufl.Measure(
            "dx", mesh, subdomain_data=cell_tags, metadata={"quadrature_degree": kind.quadrature_degree}
        )
        self._add_layers(solids, cellwise, kind)
        energy = self._strain_energy(self.laws, kind)
        H = ufl.grad(self.w)
        self.densities = {
            tags: law.density(kinematics.deformation_gradient(H), self.pressures[tags])
            for tags, law in self.laws.items()
        }
        self._solids, self._stiffness = solids, fem.Function(cellwise)
        self._write_skin_stiffness()
        self._add_contact()
        at_rest = {tags: law.at_rest for tags, law in self.laws.items()}
        stored = self._strain_energy(at_rest, kind) if self.relaxations else energy
        if interface.attraction:
            potential = interface.attraction.potential(self.y, self.d_eq, self._shared_voltage, self._h_0)
            pulled = -potential * self.area[1] * surface.measure
            energy, stored = energy + pulled, stored + pulled
        if self._adhesion:
            pulled = -self._adhesion.potential(self.y) * self.area[1] * surface.measure
            energy, stored = energy + pulled, stored + pulled
        self._compile(energy, stored)
        self._add_history()

    def _constant(self, value: float) -> fem.Constant:
        return fem.Constant(self.mesh, np.float64(value))

    @property
    def _shared_voltage(self):
        """Voltage (V) across each ridge, UFL."""
        return self.voltage if self.share is None else self.voltage * self.share

    def _add_layers(self, solids: Mapping[int, Material], cellwise: fem.FunctionSpace, kind: Element) -> None:
        """Group the layers by law, with their numbers as fields, viscous ones with their history."""
        friction = self.interface.friction
        self.laws = grouped(solids, cellwise, self.cell_tags)
        self.relaxations = relaxations(self.laws, self.w, self.lapse, self.cell_tags, kind.quadrature_degree)
        aging: list[Any] = [*solids.values(), *([friction] if friction else [])]
        self.shortest_time = min((t for law in aging for t in law.times), default=np.inf)
        self._remembers = friction is not None and friction.memory is not None
        self.in_time = bool(self.relaxations) or self._remembers
        self.laws |= {tags: each.law for tags, each in self.relaxations.items()}
        self.pressure = self._pressure(solids) if kind.mixed else None
        H = ufl.grad(self.w)
        self.pressures = {tags: law.pressure(H) for tags, law in self.laws.items()}

    def _strain_energy(self, laws: Mapping[tuple[int, ...], Material], kind: Element):
        """Return the strain energy (J/m) of laws by group of layers, UFL; sets the pressures that an element has."""
        H, energy = ufl.grad(self.w), 0
        centroid = Centroid(self.mesh) if kind.reduced else None
        for tags, law in laws.items():
            energy += law.distortion(H) * self._dx(tags)
            bulk = law.volumetric
            if bulk is None:
                continue
            if self.pressure:
                p = self.pressures[tags] = self.pressure.p
                energy += (p * kinematics.dilation(H) - p**2 / (2 * bulk)) * self._dx(tags)
            else:
                rule = {"quadrature_degree": kind.volumetric_degree}
                energy += law.pressure(H) ** 2 / (2 * bulk) * self._dx(tags, metadata=rule)
            if centroid:
                self.pressures[tags] = law.pressure(centroid.value(H))
        return energy

    def _add_contact(self) -> None:
        """Describe the skin and its contact by the formulation of the interface, UFL."""
        mesh, surface, interface = self.mesh, self.surface, self.interface
        F = kinematics.deformation_gradient(ufl.grad(self.w))
        self.x, self.y = ufl.SpatialCoordinate(mesh)[0] + self.u[0], kinematics.current_height(mesh, self.u)
        self._memory, self._x_before = (
            fem.Function(surface.history_space) if self._remembers else None for _ in range(2)
        )
        law, by_area = interface.attraction, self._friction is not None and self._friction.by_area
        self.p_el = law.pressure(self.y, self.d_eq, self._shared_voltage, self._h_0) if law else ufl.zero()
        normal = ufl.FacetNormal(mesh)
        self.area = kinematics.cofactor(F) * normal  # current per reference area, a vector

        def of_springs(value: float) -> fem.Constant:
            self._springs.append(self._constant(value))
            return self._springs[-1]

        self._skin = Skin(
            self.u,
            self.w,
            self.y,
            self.anchor,
            self.multiplier,
            cache(lambda: self._skin_stress(F) * normal),
            (self.p_el + self._adhesion.pressure(self.y) if self._adhesion else self.p_el) * self.area,
            lambda: self._stiffness,
            of_springs,
            self._memory,
            None if self._x_before is None else self.x - self._x_before,
            self.lapse,
            surface.heights_along(self.y, self.w[1]) if by_area else (),
        )
        springs = interface.formulation.springs(self._skin)
        self.contact = Contact(self._skin, springs, self._friction, self.guess, self.ease)
        self.opening = interface.formulation.opening(self._skin, self.contact)

    def _compile(self, energy, stored) -> None:
        """Derive and compile residual, Jacobian and energies.

        Args:
            energy: of strain and attraction (J/m), UFL; its derivative is the residual without the contact.
            stored: the same without what branches of viscous layers store.
        """
        w, v, du = self.w, ufl.TestFunction(self.V), ufl.TrialFunction(self.V)
        dS = self.surface.measure
        work = self.interface.formulation.virtual_work(self._skin, self.contact, v)
        residual = ufl.derivative(energy, w, v) + work * dS
        skin_mass = ufl.dot(du, v) * dS
        jacobian = ufl.derivative(residual, w, du) + self.eta * skin_mass
        self.skin_mass = fem.form(skin_mass, jit_options=jit.OPTIONS)
        self.energy = fem.form(stored, jit_options=jit.OPTIONS)
        self.weak = residual, jacobian
        self.residual, self.jacobian = (fem.form(form, jit_options=jit.OPTIONS) for form in self.weak)
        if self.pressure:
            unknown = self.pressure.unknown
            q, dp = ufl.TestFunction(unknown.function_space), ufl.TrialFunction(unknown.function_space)
            defect = ufl.derivative(energy, unknown, q)
            pairs = ((residual, unknown, dp), (defect, w, du), (defect, unknown, dp))
            self.pressure_residual = fem.form(defect, jit_options=jit.OPTIONS)
            self.pressure_jacobian = fem.form([ufl.derivative(*pair) for pair in pairs], jit_options=jit.OPTIONS)

    def _add_history(self) -> None:
        """List the fields that an accepted step leaves to the next one."""
        surface = self.surface
        self.history = History(surface)
        unloaded = surface.evaluate(surface.compile([ufl.SpatialCoordinate(self.mesh)[0]]))[0]
        self.history.add(SkinField("anchor", self.contact.new_anchor, self.anchor, follows=self.u[0]))
        self.history.add(SkinField("pressure", self.contact.p_n, self.multiplier))
        self.history.add(SkinField("x", self.x, self._x_before, follows=self.x), unloaded)
        if self._memory is not None:
            start = np.full_like(unloaded, self.interface.friction.memory)  # type: ignore[union-attr]
            self.history.add(SkinField("memory", self.contact.memory, self._memory), start)
            self.history.impose(self.history.accepted)
        for relaxation in self.relaxations.values():
            for field in relaxation.fields.values():
                self.history.add(field)
            self.history.on_impose.append(relaxation.prepare)
        self.spent = Spent(self.relaxations, self._dx) if self.relaxations else None

    def elapse(self, seconds: float) -> None:
        """Set the time (s) since the history was accepted, and write what laws have of it; collective."""
        self.lapse.value = seconds
        for relaxation in self.relaxations.values():
            relaxation.prepare()

    def _pressure(self, solids: Mapping[int, Material]) -> LayerwisePressure | None:
        """Return the pressure of the layers whose law has a volumetric part, None if there is none."""
        skins = {tag: solid.shear_modulus for tag, solid in solids.items() if solid.volumetric is not None}
        return LayerwisePressure(self.mesh, self.cell_tags, tuple(skins), max(skins.values())) if skins else None

    def _skin_stress(self, F):
        """Return P (Pa) by the one law of the cells behind the touching skin."""
        cells = self.surface.pairs[:, 0]
        behind = [tags for tags in self.laws if any(np.isin(self.cell_tags.find(tag), cells).any() for tag in tags)]
        found = set().union(*self.mesh.comm.allgather(set(behind)))
        if len(found) != 1:
            raise ValueError(
                f"the touching skin has {len(found)} material laws behind it, of the layers {sorted(sum(found, ()))}; "
                "Nitsche's method takes one"
            )
        behind_all = found.pop()
        return kinematics.first_piola_kirchhoff(self.laws[behind_all], F, self.pressures[behind_all])

    def _write_skin_stiffness(self) -> None:
        """Write the constrained modulus behind the touching skin over the facets' lengths (Pa/m), cell by cell."""
        f = self._stiffness
        for tag, solid in self._solids.items():
            f.x.array[self.cell_tags.find(tag)] = solid.constrained_modulus
        f.x.array[self.surface.pairs[:, 0]] /= self.surface.length
        f.x.scatter_forward()

    def displacement(self) -> np.ndarray:
        """Return the displacement (m) of this rank's nodes, ghosts included, shape (nodes, 2)."""
        return np.asarray(self.w.x.array.reshape(-1, 2) + self.bone.value)

    def set_interface(self, interface: Interface) -> None:
        """Give the laws of the contact other numbers; those of a share of the voltage act from :meth:`set_air_gaps` on.

        Raises:
            ValueError: a law is of another kind, or only one of the shares is None, so that the forms would be others;
                in one sentence.
        """
        before = self.interface
        for name, mine in (("friction", self._friction), ("adhesion", self._adhesion)):
            law, old = getattr(interface, name), getattr(before, name)
            if law is None or old is None or law.kind() != old.kind():
                if law is not old:
                    raise ValueError(f"{name} is {law}; it must be {old}, or that law with other numbers")
                continue
            for number in law.names():
                getattr(mine, number).value = law.number(number)
        if type(interface.formulation) is not type(before.formulation):
            raise ValueError(f"contact is {interface.formulation}; it must be {before.formulation} with other numbers")
        if (interface.share is None) != (self.share is None):
            raise ValueError("share is None before or now; it must be a function both times, or never")
        self._h_0.value = interface.h_0
        values: list[float] = []

        def kept(value: float) -> float:
            values.append(value)
            return value

        interface.formulation.springs(replace(self._skin, constant=kept))
        for constant, value in zip(self._springs, values, strict=True):
            constant.value = value
        self.interface = interface

    def set_solids(self, solids: Mapping[int, Material]) -> None:
        """Give the layers' laws other numbers: material of each layer's tag, of the present kinds."""
        write(self.laws, solids, self.cell_tags)
        self._solids = solids
        self._write_skin_stiffness()

    def set_air_gaps(self, d_eq: np.ndarray) -> None:
        """Give each ridge its equivalent air gap (m), shape (ridges,), and its share of the voltage."""
        fields = [(self.d_eq, d_eq)]
        if self.share is not None and self.interface.share is not None:
            fields.append((self.share, self.interface.share(d_eq)))
        for field, values in fields:
            field.x.array[self.surface.pairs[:, 0]] = values[self.surface.ridge]
            field.x.scatter_forward()
