"""Rung 2: a smooth layered finger with elements of ridge size, and a ridge's law as its contact.

The outline is the ridged skin's mean line; the junctions below, and the epidermis's ridges in them, are as they were.
One papillary ridge was pressed, charged, slid and lifted by itself (:mod:`fingerpad.ridge_cell`); its tables are the
contact (:mod:`variational.ridge_law`): of normal contact without voltage while the finger is pressed, of normal contact
at the scene's voltage once it is charged, and of sliding from the moment the bone moves. Charging is one step. There is
no strain energy at receptors, since near the skin the field is not that of ridges.
"""

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fingerpad import ridge_cell
from fingerpad.reach import by_rule
from fingerpad.rungs import Answer, Cost, Stopwatch, at_rest, at_slip, refuse_history
from fingerpad.scene import Scene, SceneError
from fingerpad.simulation import solids
from geometry import fingertip, tags
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import Profiles
from variational.continuation import Attempt, Continuation, StepFailed, Target
from variational.coupling import Coupling
from variational.problem import Interface, Problem
from variational.quantities import Observer
from variational.ridge_law import RidgeLaw, RidgeTable
from variational.solver import Solver
from variational.surface import Surface
from variational.transfer import Carried, carry

Array = NDArray[np.float64]
_GROWTH = 0.5
_COARSEST = 1e-3  # m
_STEPS = 2.0  # largest steps of the loads, over those with which ridges are followed


def smoothed(finger: Fingertip) -> Fingertip:
    """Return the finger without ridges, its outline the mean line of the ridged one's, lowered to the screen."""
    depth = ridge_cell.mean_depth(finger)
    changes = {
        "width": finger.width - 2 * depth,
        "height": finger.height - 2 * depth,
        "bone_centre": finger.bone_centre - depth + Profiles(finger).lowered,
        "ridge_amplitude": 1e-9,
    }
    return Fingertip.model_validate(finger.model_dump() | changes)


def sizes(scene: Scene) -> MeshSize:
    """Return element sizes of a quarter of a ridge where the skin can touch."""
    quarter = scene.geometry.ridge_wavelength / 4
    return MeshSize(
        contact=quarter, receptor=quarter, interface=quarter, coarsest=_COARSEST, growth=_GROWTH,
        touching_half_arc=by_rule(scene).mesh.touching_half_arc, touching_fraction=1.0,
    )  # fmt: skip


def solve(scene: Scene, folder: Path, comm: MPI.Comm = MPI.COMM_WORLD) -> Answer:
    """Return rung 2's answer; collective.

    Args:
        scene: press, charge and slide.
        folder: of the ridges' tables, which are kept.
        comm: communicator of the mesh.

    Raises:
        SceneError: a scene with a history, or one this rung finds no equilibrium for.
    """
    clock = Stopwatch()
    refuse_history(scene, 2)
    try:
        finger = _SmoothFinger(scene, folder, comm)
        normal = finger.press()
        slip = finger.slide()
    except StepFailed as error:
        raise SceneError(f"rung 2 found no equilibrium: {error}; use another rung") from error
    counts = finger.solver.counts
    took = clock.seconds()
    used = {tables.name: tables for tables in (finger.uncharged, finger.charged)}.values()
    made_in = sum(tables.seconds for tables in used)
    made = f"tables of the ridge took {made_in:.2f} s of processor time when they were made; kept in {folder}"
    summary = at_rest(scene.f_ext, normal)
    counted = "ridges are counted by their mean height, which misses some that barely touch"
    notes = [made, "receptors are not known to this rung", counted]
    if slip is None:
        notes.append(f"no full slip within {scene.slide_length:g} m of sliding")
        summary["full_slip"] = False
    else:
        summary |= at_slip(scene.f_ext, scene.friction, slip)
    more = {
        "table_seconds": made_in,
        "table_factorisations": sum(tables.factorisations for tables in used),
        "table_version": ridge_cell.VERSION,
    }
    return Answer(2, summary, Cost(took, counts.factorisations, finger.solver.layout.global_size), tuple(notes), more)


@dataclass(frozen=True)
class Slipping:
    """Rung 2's full slip, as a guess of the ridged finger's."""

    carried: Carried
    """In the ridged finger's place, by its ridges and at its voltage."""
    ridges: int
    """In contact."""
    factorisations: int
    unknowns: int


def full_slip(scene: Scene, folder: Path, comm: MPI.Comm = MPI.COMM_WORLD) -> Slipping:
    """Return rung 2's full slip for the full model to start from; collective.

    Args:
        scene: press, charge and slide.
        folder: of the ridges' tables, which are kept.
        comm: communicator of the mesh.

    Raises:
        StepFailed: there is none, or rung 2 does not come to it.
    """
    if scene.history is not None or scene.numerics.element == "P2-P1" or scene.friction == 0:
        raise StepFailed("rung 2 has no full slip of a scene with a history, without friction or with element 'P2-P1'")
    finger = _SmoothFinger(scene, folder, comm)
    finger.press()
    found = finger.slide()
    if found is None:
        raise StepFailed(f"rung 2 does not come to full slip within {scene.slide_length:g} m of sliding")
    return Slipping(
        finger.carried(),
        found["ridges_in_contact"],
        finger.solver.counts.factorisations,
        finger.solver.layout.global_size,
    )


class _SmoothFinger:
    """The smooth finger and its loads."""

    def __init__(self, scene: Scene, folder: Path, comm: MPI.Comm) -> None:
        self.scene = scene
        self.charged = charged = ridge_cell.tables(scene, folder)
        self.uncharged = uncharged = ridge_cell.tables(scene.model_copy(update={"voltage": 0.0}), folder)
        finger = smoothed(scene.geometry)
        body = load(comm, partial(fingertip.build, finger, sizes(scene)), tags.LAYERS.values())
        ridges = {j: tags.ridge(j) for j in body.ridges()}
        surface = Surface(body.mesh, body.facet_tags, ridges, scene.numerics.quadrature_points)
        self.law = RidgeLaw(uncharged.normal, charged.period, charged.tangential / charged.period)
        interface = Interface(self.law, scene.friction, scene.h_0)
        numerics = scene.numerics
        problem = Problem(body.mesh, body.cell_tags, surface, solids(scene), interface, numerics.element)
        rim = body.facet_tags.find(tags.BONE_RIM)
        self.solver = Solver(problem, rim, scene.f_ext, numerics.tolerance)
        self.observer = Observer(problem)
        # Without a voltage of the problem's own the air gaps do not act: they are inside the law.
        coupling = Coupling(self.solver, self.observer, scene.roughness.bearing_area(scene.h_0))
        self.walk = Continuation(coupling, self._accepted, step_scale=_STEPS)

    def press(self) -> dict[str, Any]:
        """Press and charge the finger and return its normal contact."""
        self.walk.run(Target("press", f_ext=self.scene.f_ext))
        if self.scene.voltage:
            self.law.set(self.charged.normal)
            self.walk.run(Target("charge", f_ext=self.scene.f_ext))
        return self._contact()

    def slide(self) -> dict[str, Any] | None:
        """Slide it and return its contact at full slip, None if it does not come to that."""
        self.law.set(self.charged.slip)
        self.walk.run(Target("slide", bone_x=self.scene.slide_length, until_full_slip=True))
        return self._contact() if self.walk.slip[1] else None

    def carried(self) -> Carried:
        """Return the present state in the ridged finger's place, its air gaps those of the law's mean pressures."""
        found = carry(self.walk.coupling, self.walk.surface_state)
        force, _, length = self.law.table.at(self._mean_height())
        pressure = np.divide(force, length, out=np.zeros_like(force), where=length > 0)
        closure = self.scene.roughness.bearing_area(self.scene.h_0)
        d_eq = closure(pressure).d_eq if self.scene.voltage else np.full_like(pressure, np.nan)
        finger = self.scene.geometry
        up = np.array([0.0, ridge_cell.mean_depth(finger) - Profiles(finger).lowered])
        return replace(
            found,
            corners=found.corners + up,
            skin={j: replace(ridge, origin=ridge.origin + up, position=None) for j, ridge in found.skin.items()},
            d_eq=dict(zip(found.d_eq, map(float, d_eq), strict=True)),
            gain=dict.fromkeys(found.gain, np.nan),
            voltage=self.scene.voltage,
        )

    def _mean_height(self) -> Array:
        """Return each ridge's mean height (m), shape (ridges,)."""
        surface, y = self.observer.surface, self.walk.surface_state.y
        return np.asarray(surface.per_ridge(y) / surface.per_ridge(np.ones_like(y)))

    def _accepted(self, target: Target, part: float, attempt: Attempt) -> None:
        """Stop where the law ends."""
        comm = self.solver.layout.comm
        lowest = float(np.min(comm.allgather(float(self.walk.surface_state.y.min(initial=np.inf)))))
        if lowest < self.law.table.y[0]:
            raise StepFailed(
                f"step {self.walk.steps} ({target.name}): a ridge is pressed by {-lowest:.3g} m and its table ends at "
                f"{-self.law.table.y[0]:.3g} m"
            )

    def _contact(self) -> dict[str, Any]:
        surface, y, period = self.observer.surface, self.walk.surface_state.y, self.charged.period
        contact, attraction, length = (
            surface.per_ridge(np.asarray(value / period, dtype=float)) for value in self.law.table.at(y)
        )
        mean = self._mean_height()
        if mean[0] < 0 or mean[-1] < 0:
            raise StepFailed("the skin touches beyond mesh.touching_half_arc, which must be larger")
        return {
            "f_contact": float(contact.sum()),
            "f_electrostatic": float(attraction.sum()),
            "bone_height": float(self.solver.bone[1]),
            "ridges_in_contact": int((_in_contact(self.law.table, mean)).sum()),
            "contact_length": float(length.sum()),
        }


def _in_contact(table: RidgeTable, height: Array) -> NDArray[np.bool_]:
    """Return whether ridges of a mean height (m) touch."""
    return np.asarray(table.at(height)[2] > 0)
