"""One body over the screen: a ridge, a block, a finger or a mesh of your own, led by hand through its loads.

The example at the door::

    ridge = fp.Body(fp.geometry.ridge(size=10e-6), fp.Ogden(86.76e3, -14.53, 0.48),
                    contact=fp.Penalty(1.5e12, 5e10), friction=0.25, roughness=fp.BearingArea(h_0=0.51e-6))
    ridge.press(4.4).charge(200.0).slide(until_full_slip=True)
    print(ridge.state.mu_app, ridge.state.d_eq, ridge.displacement)

The body is in plane strain, so that forces and energies are per out-of-plane length, in N/m and J/m. Under mpirun all
ranks construct the body and call its loads together; what it then holds is the same on every rank. A load is a number
in SI or a text with a unit.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from numbers import Real
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import fingerpad.startup  # noqa: F401
from fingerpad.model import cautions
from fingerpad.model.state import contact_state, force_error, refuse_strained, steady, step_record
from fingerpad.results.fields import Fields, of_snapshot
from fingerpad.results.printing import StatePrinted
from fingerpad.results.states import full_slip
from fingerpad.scene.materials import refuse_thickness
from fingerpad.startup import MPI
from geometry.mesh import TaggedMesh, load
from geometry.meshfile import file
from geometry.units import to_si
from variational import body as setup
from variational.attraction.adhesion import Adhesion
from variational.attraction.electroadhesion import ELECTROSTATIC
from variational.caution import Caution
from variational.contact.formulation import Formulation
from variational.contact.friction import Friction
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.element import ELEMENTS
from variational.energy import EnergyBook
from variational.materials.material import Material
from variational.output import Lines, Nodes
from variational.roughness.closure import Closure, check
from variational.solvers.continuation import Attempt, StepFailed, Target
from variational.state import ContactState, Skin, StepRecord

Array = NDArray[np.float64]
Quantity = float | str
"""A number in SI, or a text with a unit: ``"0.0044 N/mm"``."""
_TOLERANCE = 1e-9  # of the solves, over the force scale
_FARTHEST = 1000.0  # of the size of the body: a slide in millimetres, given as metres


@dataclass(frozen=True)
class Energy:
    """Energies per out-of-plane length (J/m)."""

    stored: float
    """Strain, attraction and contact springs, now."""
    dissipated: float
    """Spent by friction since the unloaded state."""
    released: float
    """By jumps since then; on a smooth path the error of the steps' works."""


class Body(StatePrinted):
    """A body pressed on the screen, charged and slid.

    Attributes:
        state: the last accepted state, with its ridges and its skin.
        states: all accepted states, in order.
        coordinates: nodes of the unloaded mesh (m), shape (nodes, 2), in the order of the mesh's file.
        triangles: nodes of each cell, shape (cells, 3).
        displacement: of these nodes in the last accepted state (m), shape (nodes, 2).
        energy: of the last accepted state and of the way there.
        problem: the weak form, for what else is to be evaluated.
    """

    def __init__(
        self,
        shape: Callable[[], float] | TaggedMesh | str | Path,
        material: Material | Mapping[str, Material],
        *,
        contact: Formulation = Penalty(),  # noqa: B008
        friction: Friction | float | None = None,
        roughness: Closure | None = None,
        adhesion: Adhesion | None = None,
        h_0: float | None = None,
        element: str = "P2",
        force_scale: float = 1.0,
        touch_depth: float = 5e-6,
        step_scale: float = 1.0,
        comm: MPI.Comm = MPI.COMM_WORLD,
    ) -> None:
        """Mesh the body, unloaded; collective.

        Args:
            shape: a shape of :mod:`geometry`, a gmsh file (:mod:`geometry.meshfile`), or a mesh.
            material: of the whole body, or of each layer by its name in :data:`geometry.tags.LAYERS`, with spaces or
                with underscores.
            contact: how contact enters the weak form.
            friction: law of friction; a number is the coefficient of Coulomb's.
            roughness: the microscale, from pressure to air gap; without it there is no voltage.
            adhesion: attraction without a voltage.
            h_0: effective insulator thickness (m); by default that of ``roughness``.
            element: a name of :data:`variational.element.ELEMENTS`.
            force_scale: force (N/m) in which residuals are measured.
            touch_depth: how far the bone is lowered at a time until the screen bears it (m).
            step_scale: factor on the largest steps.
            comm: communicator of the mesh.

        Raises:
            geometry.profiles.GeometryError: the shape or the file cannot be meshed.
            ValueError: layers and materials do not agree, a law is none, a number is out of range, or ``roughness`` has
                no ``h_0`` and none is given, or another one.
        """
        if roughness is not None:
            check(roughness)
        if not (isinstance(element, str) and element in ELEMENTS):
            raise ValueError(f"element is {element!r}; it must be one of {', '.join(ELEMENTS)}")
        if not isinstance(contact, Formulation):
            raise ValueError(f"contact is {contact!r}; it must be a Formulation, such as fp.Penalty(1.5e12, 5e10)")
        numbers = {"force_scale": force_scale, "touch_depth": touch_depth, "step_scale": step_scale}
        for name, value in (numbers | ({} if h_0 is None else {"h_0": h_0})).items():
            if isinstance(value, bool) or not (isinstance(value, Real) and 0 < value < math.inf):
                raise ValueError(f"{name} is {value!r}; it must be a finite number greater than 0")
        if not (callable(shape) or isinstance(shape, TaggedMesh | str | Path)):
            raise ValueError(f"shape is {shape!r}; it must be a shape of fingerpad.geometry, a mesh, or a file of one")
        build = file(shape) if isinstance(shape, str | Path) else shape
        self.mesh = build if isinstance(build, TaggedMesh) else load(comm, build)
        h_0 = getattr(roughness, "h_0", None if roughness else 1.0) if h_0 is None else h_0  # of no effect at 0 V
        if h_0 is None:
            raise ValueError("roughness has no h_0; give Body the effective insulator thickness, h_0=... in m")
        if roughness is not None:
            refuse_thickness(roughness, h_0)
        law = Interface(contact, friction, h_0, ELECTROSTATIC if roughness else None, adhesion=adhesion)
        self._closure = roughness
        made = setup.Body(
            self.mesh, _solids(self.mesh, material), law, roughness, element=element, force_scale=force_scale,
            tolerance=_TOLERANCE, on_accept=self._accepted, touch_depth=touch_depth, step_scale=step_scale,
        )  # fmt: skip
        self.problem, self._made = made.problem, made
        self._nodes = Nodes(self.problem)
        self._points = setup.Points(made)
        self.coordinates, self.triangles = self._nodes.coordinates, self._nodes.triangles
        path = made.continuation
        self._book = EnergyBook(self.problem, path.surface_state, made.solver.bone, made.solver.reaction, self._d_eq)
        self.energy = Energy(0.0, 0.0, 0.0)
        self.states: list[ContactState] = []
        self._load, self._loads = "unloaded", 0
        self.displacement = self._nodes.gather(self.problem)
        self.state = self._present(None)

    # -- loads -------------------------------------------------------------------------------------------
    def press(
        self, f_ext: Quantity | None = None, *, height: Quantity | None = None, seconds: Quantity | None = None
    ) -> "Body":
        """Press the body, by a force or by the height of the bone; return the body.

        Args:
            f_ext: external normal force on the bone (N/m), kept in what follows.
            height: change of the bone's height from the unloaded position (m), negative when pressed, kept likewise.
            seconds: how long the load takes (s), 0 for at once; required where a material is viscous or friction has a
                memory. The same load again is a hold.

        Raises:
            ValueError: not one of the two is given, ``f_ext`` is not positive, or ``seconds`` is negative or missing.
            StepFailed: see :meth:`slide`.
        """
        if (f_ext is None) == (height is None):
            raise ValueError("press takes either f_ext, in N/m, or height, in m")
        if f_ext is None:
            return self._reach(Target("press", bone_height=_finite("height", height, "m")), seconds)
        force = _finite("f_ext", f_ext, "N/m")
        if force <= 0:
            raise ValueError(f"f_ext is {force:g} N/m; it must be positive; lift() takes a body off the screen")
        return self._reach(Target("press", f_ext=force), seconds)

    def lift(self, height: Quantity = 0.0, *, seconds: Quantity | None = None) -> "Body":
        """Lift the bone by displacement; return the body.

        Args:
            height: change of the bone's height from the unloaded position (m). A body that sticks to the screen needs
                more than 0 to come off.
            seconds: see :meth:`press`.

        Raises:
            ValueError: ``seconds`` is negative or missing.
            StepFailed: see :meth:`slide`.
        """
        return self._reach(Target("lift", bone_height=_finite("height", height, "m")), seconds)

    def charge(self, voltage: Quantity, *, seconds: Quantity | None = None) -> "Body":
        """Change the voltage between screen and body, without leakage; return the body.

        Args:
            voltage: U (V), of either sign.
            seconds: see :meth:`press`.

        Raises:
            ValueError: the body has no roughness, or ``seconds`` is negative or missing.
            StepFailed: see :meth:`slide`.
        """
        u = _finite("voltage", voltage, "V")
        if self._closure is None:
            raise ValueError("the body has no roughness, so that it has no air gap to charge; give Body a roughness")
        return self._reach(Target("charge", voltage=u), seconds)

    def slide(
        self, distance: Quantity | None = None, *, until_full_slip: bool = False, seconds: Quantity | None = None
    ) -> "Body":
        """Move the bone sideways; return the body.

        Args:
            distance: how far, from where it is (m), negative towards x < 0.
            until_full_slip: stop as soon as all points in contact slip one way; without a distance, the bone moves
                towards x > 0 by the size of the body at most.
            seconds: see :meth:`press`; of the whole distance, also where full slip ends the slide before.

        Raises:
            ValueError: neither a distance nor ``until_full_slip`` is given, full slip is asked for without friction, or
                ``seconds`` is negative or missing.
            StepFailed: no equilibrium was found, or there was no full slip. The states accepted before are kept, and
                the body is in the last one of them.
        """
        if distance is None and not until_full_slip:
            raise ValueError("slide takes a distance, in m, or until_full_slip=True")
        if until_full_slip and self.problem.anchor is None:
            raise ValueError("the body has no friction, so that it has no full slip; give Body a friction")
        size = float(np.ptp(self.coordinates, axis=0).max())
        far = size if distance is None else _finite("distance", distance, "m")
        if abs(far) > _FARTHEST * size:
            raise ValueError(
                f"distance is {far:g} m; the body of {size:.3g} m slides by {_FARTHEST * size:.3g} m at most"
            )
        x = float(self._made.solver.control.x) + far
        self._reach(Target("slide", bone_x=x, until_full_slip=until_full_slip), seconds)
        if until_full_slip and not self.state.all_slip:
            raise StepFailed(f"slide: there is no full slip within {abs(far):g} m; give a larger distance")
        return self

    def _reach(self, target: Target, seconds: Quantity | None) -> "Body":
        if seconds is None and self.problem.in_time:
            raise ValueError(
                f"{target.name} takes seconds, how long the load lasts, 0 for at once: the state of a body with a "
                "viscous material, or friction with a memory, depends on it"
            )
        duration = 0.0 if seconds is None else _finite("seconds", seconds, "s")
        if duration < 0:
            raise ValueError(f"seconds is {duration:g} s; it must be 0 or more")
        self._load = target.name
        self._loads += 1
        self._made.continuation.run(replace(target, duration=duration))
        return self

    # -- accepted states -----------------------------------------------------------------------------------
    @property
    def skin(self) -> Skin:
        """The skin that can touch, in the last accepted state; arrays of shape (facets, points), from left to right."""
        assert self.state.skin is not None
        return self.state.skin

    @property
    def fields(self) -> Fields:
        """Displacement, stress, strain and energy density inside the body, in the last accepted state; collective."""
        shown = Lines(self.problem).snapshot(self.problem)
        found: Fields = self.problem.mesh.comm.bcast(None if shown is None else of_snapshot(shown))
        return found

    @property
    def cautions(self) -> list[Caution]:
        """Limits of validity that accepted states reach, of the closure and of the contact's stiffness."""
        return cautions.on_states(self.states, self._closure, self.problem.interface.formulation)

    @property
    def _d_eq(self) -> Array:
        return self._made.coupling.d_eq

    def _accepted(self, target: Target, part: float, attempt: Attempt) -> None:
        solver = self._made.solver
        balance = self._book.step(self._made.continuation.surface_state, solver.bone, solver.reaction, self._d_eq)
        record = step_record(self._made.continuation, balance, solver.imbalance(), attempt)
        state = self._present(record)
        if not (state.ridges_in_contact or state.voltage or self.problem.interface.adhesion):
            where, formulation = f"step {state.step} ({self._load})", self.problem.interface.formulation
            refuse_strained(where, record, self.states, solver.force_scale, formulation)
        self.energy = Energy(
            balance.stored, self.energy.dissipated + balance.dissipation, self.energy.released + balance.released
        )
        self.displacement = self._nodes.gather(self.problem)
        self.state = state
        self.states.append(state)

    def _present(self, record: StepRecord | None) -> ContactState:
        path, solver = self._made.continuation, self._made.solver
        found = contact_state(
            path, self._made.observer.ridge_loads(path.surface_state), self._made.surface.ridge_numbers, self._d_eq,
            load=self._load, load_number=self._loads, record=record, skin=self._points.gather(path.surface_state),
            time=path.time if self.problem.in_time else math.nan,
        )  # fmt: skip
        least = force_error(solver.layout.global_size, max(_TOLERANCE, solver.floor), solver.force_scale)
        laws = self.problem.interface
        gap = float(self._d_eq.min()) + laws.h_0 if found.voltage else np.inf
        began, held = full_slip(self.states, found, steady(laws.formulation.tolerance, gap), least)
        return replace(found, slip_began=began, slip_held=held)


def _solids(mesh: TaggedMesh, material: Material | Mapping[str, Material]) -> dict[int, Material]:
    """Return the material of each layer's tag."""
    layers = mesh.layers()
    if isinstance(material, Material):
        return dict.fromkeys(layers.values(), material)
    if not isinstance(material, Mapping):
        raise ValueError(f"material is {material!r}; it must be a Material, or a dictionary of one for each layer")
    listed, found = ", ".join(map(repr, layers)), dict[str, Material]()
    for key, solid in material.items():
        name = key.replace("_", " ") if isinstance(key, str) else key
        if name in found:
            raise ValueError(f"there are two materials for the layer {name!r}, with a space and with _; give it once")
        if name not in layers:
            near = get_close_matches(str(name), layers, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"its layers are {listed}"
            raise ValueError(f"there is a material for {name!r}, which is no layer of the body; {hint}")
        if not isinstance(solid, Material):
            raise ValueError(f"the material of {name!r} is {solid!r}; it must be a Material")
        found[name] = solid
    missing = next((name for name in layers if name not in found), None)
    if missing is not None:
        raise ValueError(f"there is no material for the layer {missing!r}; the body's layers are {listed}")
    return {tag: found[name] for name, tag in layers.items()}


def _finite(name: str, value: Quantity | None, unit: str) -> float:
    """Return a number in SI; a text has a unit of its own."""
    if isinstance(value, str):
        try:
            return to_si(value, unit)
        except ValueError as error:
            raise ValueError(f"{name} is {value!r}; {error}") from None
    if value is None or not math.isfinite(value):
        raise ValueError(f"{name} is {value} {unit}; it must be a finite number")
    return float(value)
