"""One ridge of a scene as a periodic cell, pressed, charged, slid and lifted: the tables of the ridge law.

The cell is a ridge of the scene's skin on flat layers between faces that move sideways with the bone. Its
path, at the scene's voltage from the first touch on: pressed by force (normal contact), slid until every point slips,
lifted by displacement as it slips until it lets go (full slip; also the end of normal contact, below the lightest force
pressed). How far the flat layers under it yield is one equation a layer, uniaxial compression between rigid walls: it
is taken off the bone's height, and what remains, the ridge's own, does not depend on how much of the layers there is.

The flat junctions leave out that intermediate ridges stiffen the dermis: that is no property of the ridge, and the
model that uses the law has it.
"""

import hashlib
import json
import signal
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import ufl
from basix.ufl import element
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.optimize import brentq
from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering
from ufl.algorithms.apply_derivatives import apply_derivatives

from fingerpad.io.files import read_object, replace_json
from fingerpad.io.interrupt import Interrupted
from fingerpad.reduced.answer import Stopwatch
from fingerpad.scene import Scene
from fingerpad.scene.laws import coefficient
from geometry import strip, tags
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import Profiles
from variational.attraction.insulator import VACUUM_PERMITTIVITY
from variational.body import Body
from variational.contact.ridge_law import KNOTS, RidgeTable
from variational.materials.material import Material
from variational.materials.ogden import Ogden
from variational.problem import Interface
from variational.solvers.continuation import Attempt, StepFailed, Target

Array = NDArray[np.float64]
VERSION = 2  # of the tables; another one makes the old ones forgotten
_DERMIS = 100e-6  # m, of the cell: none of it matters
_LIGHT = 0.02  # N/m, at which the cell is charged
_NUDGE = 0.5e-6  # m, over which the tangential stiffness is taken
_LIFTS = 16  # heights at which the sliding ridge is recorded
_SNAP = 2e-6  # m, height over which a ridge's forces fall when it lets go
_APART = np.array([12e-6, 20e-6, 40e-6, 80e-6, 160e-6])  # m, heights of a ridge that has let go
_NOWHERE = 500e-6  # m, height at which the attraction is no more


@dataclass(frozen=True)
class Tables:
    """The tables of a cell's ridge."""

    name: str
    """Of the file."""
    normal: RidgeTable
    slip: RidgeTable
    period: float
    """lambda (m)."""
    tangential: float
    """Friction over the bone's way at first (N/m per m of displacement, per ridge) = Pa."""
    seconds: float
    """Processor time it took to make them (s)."""
    factorisations: int
    unknowns: int


def tables(
    scene: Scene,
    folder: Path,
    comm: MPI.Comm = MPI.COMM_WORLD,
    deeper: int = 1,
    pause: Callable[[], None] = lambda: None,
) -> Tables:
    """Return the tables of a scene's ridge, made now or read from a folder; collective.

    Args:
        scene: a scene.
        folder: of tables, each a JSON file named by a hash of what it depends on, which it holds.
        comm: communicator of the ranks that want them.
        deeper: how many times the force that suffices for the default finger the ridge is pressed to.
        pause: called after each step; may raise to stop.

    Raises:
        StepFailed: the cell could not be pressed or slid.
        Interrupted: ``pause`` raised it on a rank.
    """
    made_of, file = _place(scene, folder, comm, deeper)
    data: dict[str, Any] = {}
    if comm.rank == 0:
        with suppress(OSError, ValueError):  # no file, or one that was damaged
            data = read_object(file)
    data = comm.bcast(data)
    if data.get("made_of") != json.loads(json.dumps(made_of)):
        # Every rank makes it by itself; what differs, if only the time it took, is rank 0's.
        number = 0
        try:
            data = {"made_of": made_of} | _Cell(scene, made_of["f_max"], pause).tabulate()
        except Interrupted as stopped:
            number = int(stopped.signal)
        if number := comm.allreduce(number, op=MPI.MAX):  # a signal on any rank stops all
            raise Interrupted(signal.Signals(number), 0)
        data = comm.bcast(data)
        if comm.rank == 0:
            folder.mkdir(parents=True, exist_ok=True)
            replace_json(file, data)
    normal, slip = (RidgeTable(**{k: np.array(v) for k, v in data[state].items()}) for state in ("normal", "slip"))
    rest = {k: data[k] for k in ("period", "tangential", "seconds", "factorisations", "unknowns")}
    return Tables(file.stem, normal, slip, **rest)


def are_kept(scene: Scene, folder: Path, comm: MPI.Comm, deeper: int) -> bool:
    """Return whether the tables of a scene's ridge are in a folder; collective."""
    file = _place(scene, folder, comm, deeper)[1]
    return bool(comm.bcast(file.exists() if comm.rank == 0 else None))


def _place(scene: Scene, folder: Path, comm: MPI.Comm, deeper: int) -> tuple[dict[str, Any], Path]:
    """Return what a table depends on, and its file; collective."""
    made_of = comm.bcast(_made_of(scene, deeper))  # a law without a source counts by the process that it is in
    name = hashlib.sha256(json.dumps(made_of, sort_keys=True).encode()).hexdigest()[:16]
    return made_of, folder / f"{name}.json"


def _made_of(scene: Scene, deeper: int = 1) -> dict[str, Any]:
    """Return what a table depends on."""
    parameters = scene.parameters()
    skin = ("sc_thickness", "ve_thickness", "ridge_wavelength", "ridge_amplitude", "ridge_profile")
    layers = ("stratum_corneum", "viable_epidermis", "dermis", "exponent")
    return {
        "version": VERSION,
        "voltage": scene.voltage,
        "friction": coefficient(scene),
        "f_max": deeper * _largest(scene.f_ext),
        "geometry": {name: parameters["geometry"][name] for name in skin},
        "materials": {name: parameters["materials"][name] for name in layers},
        "contact_size": scene.mesh.contact,
        "touching_fraction": scene.mesh.touching_fraction,
        **{name: parameters[name] for name in ("electric", "roughness", "contact", "numerics")},
    }


def _largest(f_ext: float) -> float:
    """Return a force (N/m) that no ridge of the default finger exceeds, of few values: tables serve many scenes.

    In its full runs the central ridge bears up to 0.33 (f_ext / 1 N/m)^0.73.
    """
    needed = 1.5 * 0.33 * f_ext**0.73
    return float(2.5 * 2 ** max(0, np.ceil(np.log2(needed / 2.5))))


class _Cell:
    """A ridge and its path."""

    def __init__(self, scene: Scene, f_max: float, pause: Callable[[], None] = lambda: None) -> None:
        self.pause = pause
        self.clock, self.scene, self.f_max = Stopwatch(), scene, f_max
        finger = flat_junction(scene.geometry)
        top = mean_depth(finger) + finger.sc_thickness + finger.ve_thickness + _DERMIS
        size = MeshSize(
            contact=scene.mesh.contact, interface=max(60e-6, scene.mesh.contact), growth=0.4,
            touching_fraction=scene.mesh.touching_fraction,
        )  # fmt: skip
        # A rank by itself makes the whole of it: it is small.
        body = load(MPI.COMM_SELF, partial(strip.build, finger, size, 1, top), strip.LAYERS)
        skins = {tag: s for tag, s in scene.solids().items() if tag in strip.LAYERS}
        interface = Interface(scene.contact.law, scene.friction_law(), scene.h_0)
        numerics = scene.numerics
        self.closure = scene.closure()
        made = Body(
            body, skins, interface, self.closure, element=numerics.element, points=numerics.quadrature_points,
            moving_sides=body.facets(tags.SIDES), coupling_tolerance=numerics.coupling_tolerance,
            coupling_cap=numerics.coupling_cap, by_gap=scene.contact.length == "gap", on_accept=self._accepted,
            touch_depth=2e-6,
        )  # fmt: skip
        self.solver, self.observer, self.walk = made.solver, made.observer, made.continuation
        self.finger, self.period = finger, finger.ridge_wavelength
        thicknesses = finger.sc_thickness, finger.ve_thickness, _DERMIS
        self.layers = [(skins[tag], t) for tag, t in zip(strip.LAYERS, thicknesses, strict=True)]
        self.rows: dict[str, list[tuple[float, ...]]] = {}

    def _accepted(self, target: Target, part: float, attempt: Attempt) -> None:
        self.pause()
        loads = self.observer.ridge_loads(self.walk.surface_state)
        f_ext = float(loads.f_contact[0] - loads.f_attraction[0])
        yields = sum((t * (1 - confined(solid, f_ext / self.period)) for solid, t in self.layers), 0.0)
        row = float(self.solver.bone[1]) + yields, *(float(v[0]) for v in (loads.f_contact, loads.f_attraction))
        self.rows.setdefault(target.name, []).append((*row, float(loads.length[0]), float(loads.f_friction[0])))

    def tabulate(self) -> dict[str, Any]:
        """Go the path; return what a file holds."""
        run = self.walk.run
        run(Target("touch", f_ext=_LIGHT))
        if self.scene.voltage:
            run(Target("charge", voltage=self.scene.voltage))
        run(Target("press", f_ext=self.f_max))
        pressed = self.rows.get("charge", self.rows["touch"])[-1:] + self.rows["press"]
        run(Target("nudge", bone_x=_NUDGE))
        tangential = abs(self.rows["nudge"][-1][4] - pressed[-1][4]) / _NUDGE
        run(Target("slide", bone_x=5e-3, until_full_slip=True))
        lifted = self._lift()
        lightest = max(row[0] for row in pressed)
        normal = pressed + [row for row in lifted if row[0] > lightest]
        return {
            "normal": self._table(normal),
            "slip": self._table(self.rows["slide"][-1:] + lifted),
            "period": self.period,
            "tangential": tangential,
            "seconds": self.clock.seconds(),
            "factorisations": self.solver.counts.factorisations,
            "unknowns": self.solver.layout.global_size,
        }

    def _lift(self) -> list[tuple[float, ...]]:
        """Lift the sliding ridge until it lets go; return its states in contact."""
        start = float(self.solver.bone[1])
        heights = [start * (1 - k / _LIFTS) ** 2 for k in range(1, _LIFTS + 1)] + list(1e-6 * np.arange(1, 13))
        for height in heights:
            try:
                self.walk.run(Target("lift", bone_height=height))
            except Interrupted:
                raise
            except StepFailed:  # the jump off the screen: nothing in contact comes after it
                break
            if self.rows["lift"][-1][3] == 0:
                break
        return [row for row in self.rows.get("lift", []) if row[3] > 0]

    def _table(self, rows: list[tuple[float, ...]]) -> dict[str, list[float]]:
        """Return columns over the height, a ridge that has let go at the end."""
        found = np.array(sorted(rows))[:, :4]
        found = found[np.concatenate([[True], np.diff(found[:, 0]) > 1e-9])]
        last = found[-1, 0]
        # It lets go at once. On the smooth skin, whose Gauss points are micrometres of height apart at the edge of
        # contact, a fall steeper than that would leave each of them on or off, with no equilibrium between.
        apart = np.concatenate([[last + _SNAP], _APART[_APART > last + 2 * _SNAP]])
        pull = [_unpressed(self.finger, self.closure(0.0).d_eq, self.scene, y) for y in apart]
        free = np.stack([apart, 0 * apart, pull, 0 * apart], axis=1)
        found = thinned(found, KNOTS - len(free) - 1)
        everything = np.concatenate([found, free, [[_NOWHERE, 0.0, 0.0, 0.0]]])
        return {name: list(map(float, column)) for name, column in zip(_COLUMNS, everything.T, strict=True)}


_COLUMNS = ("y", "contact", "attraction", "length")


def thinned(rows: Array, most: int) -> Array:
    """Return no more rows of a table, those left out that a line between their neighbours comes nearest to.

    Args:
        rows: heights and values, shape (rows, 1 + values), the heights ascending.
        most: rows, at least 2; the first and the last stay.
    """
    scale = np.abs(rows[:, 1:]).max(axis=0)
    scale[scale == 0] = 1.0
    while len(rows) > most:
        before, here, after = rows[:-2], rows[1:-1], rows[2:]
        part = ((here - before)[:, :1]) / ((after - before)[:, :1])
        off = np.abs(before + part * (after - before) - here)[:, 1:] / scale
        rows = np.delete(rows, 1 + int(off.max(axis=1).argmin()), axis=0)
    return rows


def flat_junction(finger: Fingertip) -> Fingertip:
    """Return the skin with the mean plane of its VE-D junction in its place."""
    return finger.model_copy(update={"intermediate_ridge_height": 1e-9, "limiting_ridge_height": 1e-9})


def mean_depth(finger: Fingertip) -> float:
    """Return the depth of the skin's mean plane below its tips (m)."""
    s = np.linspace(0, finger.ridge_wavelength, 4096, endpoint=False)
    return float(Profiles(finger).skin(s).mean())


def _unpressed(finger: Fingertip, d_eq: float | Array, scene: Scene, height: float) -> float:
    """Return the attraction (N/m) of an undeformed ridge whose tip is at a height (m)."""
    s = np.linspace(0, finger.ridge_wavelength, 4096, endpoint=False)
    gap = np.maximum(height + Profiles(finger).skin(s), float(d_eq))
    pressure = VACUUM_PERMITTIVITY * scene.voltage**2 / 2 / (scene.h_0 + gap) ** 2
    return float(pressure.mean() * finger.ridge_wavelength)


def confined(solid: Material, pressure: float) -> float:
    r"""Return the stretch J of a layer between rigid walls under a pressure (Pa).

    With one stretch J and none sideways -p is dW/dJ. Of Ogden's solid
    :math:`W(J) = 2 G_0 / \alpha^2 (2 J^{-a/3} + J^{2a/3} - 3) + K (J-1)^2 / 2`; another's density is differentiated.
    """
    if type(solid) is not Ogden:  # of a derived class too
        stress = _confined_stress(solid)
        return float(brentq(lambda J: stress(J) + pressure, 0.05, 5.0, xtol=1e-14))
    a, shear, bulk = solid.a, solid.shear_modulus, solid.bulk

    def excess(J: float) -> float:
        shape = 4 * shear / (3 * a) * (J ** (2 * a / 3 - 1) - J ** (-a / 3 - 1))
        return float(shape + bulk * (J - 1) + pressure)

    return float(brentq(excess, 0.05, 5.0, xtol=1e-14))


def _confined_stress(solid: Material) -> Callable[[float], float]:
    """Return dW/dJ (Pa) of a solid with one stretch J and none sideways, as a function of J."""
    given = ufl.Constant(ufl.Mesh(element("Lagrange", "triangle", 1, shape=(2,))))
    J = ufl.variable(given)
    slope = ufl.diff(solid.density(ufl.as_matrix([[1, 0], [0, J]])), J)
    compiled = apply_derivatives(apply_algebra_lowering(slope))
    return lambda value: float(compiled((0.0, 0.0), {given: value}))
