"""The model "smooth": a smooth layered finger with elements of ridge size, and a ridge's law as its contact.

The outline is the ridged skin's mean line; the junctions below, and the epidermis's ridges in them, are as they were.
One papillary ridge was pressed, charged, slid and lifted by itself (:mod:`fingerpad.reduced.ridge_cell`); its tables
are the contact (:mod:`variational.contact.ridge_law`): of normal contact without voltage while the finger is pressed,
of normal contact at the scene's voltage once it is charged, and of sliding from the moment the bone moves. Charging is
one step. There is no strain energy at receptors, since near the skin the field is not that of ridges.

The discretisation error is that of the tables. Under attraction the pressure at an edge of contact falls over the air
gap and insulators, a micrometre or two, so that on facets of ``mesh.contact`` an edge moves by fits and starts, and a
ridge that is lifted may not be followed to where it lets go. So the finger is solved with the tables of facets of half
the size as well. The change, and the error estimated from it by :mod:`fingerpad.richardson`, make the estimated error.
The finger's own elements, a quarter of a ridge, have no part in it: halving all of them changes friction and contact
lengths by 0.1 % and the bone's height by 0.13 % (default finger, 15 and 75 N/m, 200 V).
"""

import math
from collections.abc import Mapping
from dataclasses import fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fingerpad.io import petsc_options
from fingerpad.io.console import Console
from fingerpad.io.interrupt import Interrupt, Interrupted
from fingerpad.io.result import Cost, Result
from fingerpad.io.states import WORDS
from fingerpad.model.cautions import on_states
from fingerpad.model.touching import by_rule
from fingerpad.reduced import known, ridge_cell
from fingerpad.reduced.answer import Stopwatch, TooLight, at_rest, at_slip, refuse_others
from fingerpad.reduced.stages import Stages, ridges
from fingerpad.richardson import MeshParameter
from fingerpad.scene import Scene, SceneError, laws
from fingerpad.scene.remarks import leakage, remarks
from geometry import fingertip, tags
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import Profiles
from variational.body import Body
from variational.contact.friction import Coulomb
from variational.contact.ridge_law import RidgeLaw, RidgeTable
from variational.problem import Interface
from variational.solvers.continuation import Attempt, StepFailed, Target
from variational.state import ContactState, Errors

Array = NDArray[np.float64]
_GROWTH = 0.5
_COARSEST = 1e-3  # m
_STEPS = 2.0  # largest steps of the loads, over those with which ridges are followed
_LARGEST = 0.5
"""Largest error of an answer, over its value: beyond it the answer is not known to a factor of three, and an estimate
of first order, the first term of a series in the size of the facets, leaves out a square of a quarter."""
_PRESSED = 0.01
"""Force that a table's last ridge in contact may bear, over the largest in it. A ridge lets go when it is pulled or,
without attraction, when nothing presses it."""
_HALF_ARC = 5e-3  # m, of the skin that can touch
_FEW = 3  # ridges
_DEEPEST = 1024  # times the force to which a ridge is first pressed
_JUDGED = "mu_app", "contact_length", "f_electrostatic"


def smoothed(finger: Fingertip) -> Fingertip:
    """Return the finger without ridges, its outline the mean line of the ridged one's, lowered to the screen."""
    depth = ridge_cell.mean_depth(finger)
    changes = {
        "width": finger.width - 2 * depth,
        "height": finger.height - 2 * depth,
        "bone_centre": finger.bone_centre - depth + Profiles(finger).lowered,
        "ridge_amplitude": 1e-9,
    }
    return finger.model_copy(update=changes)  # computed, and so not in the ranges of what is typed


def sizes(scene: Scene) -> MeshSize:
    """Return element sizes of a quarter of a ridge where the skin can touch, :data:`_HALF_ARC` at least by itself."""
    quarter, half_arc = scene.geometry.ridge_wavelength / 4, scene.mesh.touching_half_arc
    if half_arc is None:  # wider than the rule of thumb: no restart adds ridges here
        half_arc = max(_HALF_ARC, by_rule(scene).mesh.touching_half_arc or 0.0)
    return MeshSize(
        contact=quarter, receptor=quarter, interface=quarter, coarsest=_COARSEST, growth=_GROWTH,
        touching_half_arc=half_arc, touching_fraction=1.0,
    )  # fmt: skip


def solve(scene: Scene, folder: Path, comm: MPI.Comm = MPI.COMM_WORLD, console: Console | None = None) -> Result:
    """Return the answer of the smooth finger; collective.

    Args:
        scene: press, charge and slide.
        folder: of the ridges' tables, which are kept.
        comm: communicator of the mesh.
        console: shows what is being done and the time left.

    Raises:
        SceneError: a scene with a history, with a mesh or another friction law than Coulomb's of its own, one this
            model finds no equilibrium for, one under whose force less than a ridge touches, or one whose mesh.contact
            is too large for the answer to mean anything.
    """
    clock = Stopwatch()
    refuse_others(scene, "smooth")
    _refuse_friction(scene)
    petsc_options.check(comm, scene.numerics.element)
    half = scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"contact": scene.mesh.contact / 2})})
    stages = Stages((scene, half), folder, comm, console)
    with Interrupt(comm) as interrupt, interrupt.ends_the_program():
        first = _solved(scene, folder, comm, stages, interrupt, 1)
        second = _solved(half, folder, comm, stages, interrupt, first[0].deeper)
    fingers, answers = (first[0], second[0]), (first[1], second[1])
    errors = {state: estimated(answers[0][state], answers[1].get(state)) for state in answers[0]}
    _refuse_coarse(scene, answers[0], errors)
    named = {state: replace(value, error=errors[state]) for state, value in answers[0].items()}
    counts = [finger.solver.counts.factorisations for finger in fingers]
    used = {tables.name: tables for finger in fingers for tables in (finger.uncharged, finger.charged)}.values()
    made_in = sum(tables.seconds for tables in used)
    made = f"tables of the ridge took {made_in:.2f} s of processor time when they were made; kept in {folder}"
    counted = "ridges are counted by their mean height, which misses some that barely touch"
    bands = known.errors("smooth", scene)
    notes = [made, known.in_words(bands), "receptors are not in this model", counted, *leakage(scene)]
    least = min(finger.touching for finger in fingers)
    cautions = [*remarks(scene), *known.cautions(scene), *on_states(named.values(), scene.closure())]
    if least < _FEW:
        cautions.append(
            f"the skin touches over {math.floor(10 * least) / 10:g} ridges; fewer than {_FEW} stand apart, and this "
            "model spreads them: friction and contact length may be off by more than the error given"
        )
    if "full_slip" not in named:
        notes.append(f"no full slip within {scene.slide_length:g} m of sliding")
    more: dict[str, Any] = {
        "table_seconds": made_in,
        "table_factorisations": sum(tables.factorisations for tables in used),
        "table_version": ridge_cell.VERSION,
    }
    size = fingers[0].solver.layout.global_size
    cost = Cost(processor_seconds=clock.seconds(), factorisations=sum(counts), unknowns=size, ranks=comm.size)
    states = (None, named["charged"], named.get("full_slip"))
    more |= {"laws": laws.used(scene), "model_error": bands}
    return Result(
        scene, "smooth", *states, cost=cost, notes=tuple(notes), cautions=tuple(cautions), record=more
    )  # fmt: skip


def _solved(
    scene: Scene, folder: Path, comm: MPI.Comm, stages: Stages, interrupt: Interrupt, deeper: int
) -> tuple["_SmoothFinger", dict[str, ContactState]]:
    """Return the finger at the end of its loads, and its states by name; its tables are so deep, or deeper.

    Raises:
        SceneError: the ridge could not be followed to where it lets go, less than a ridge touches, or no equilibrium
            was found.
    """
    try:
        finger = _SmoothFinger(scene, folder, comm, stages, deeper, interrupt)
        _refuse_lost(scene, finger.charged.slip)
        found = {"charged": at_rest(scene, finger.press())}
        slip = finger.slide()
    except Interrupted:
        raise
    except StepFailed as error:
        if isinstance(error, _TableEnds) and deeper < _DEEPEST:
            stages.again(scene, folder, comm, 2 * deeper)
            return _solved(scene, folder, comm, stages, interrupt, 2 * deeper)
        raise SceneError(
            f"the model 'smooth' found no equilibrium with the ridge's tables at mesh.contact {scene.mesh.contact:g} "
            f"m: {error}; use another model"
        ) from error
    return finger, found if slip is None else found | {"full_slip": at_slip(scene, slip)}


def _refuse_friction(scene: Scene) -> None:
    """Refuse a law of friction that is not proportional to the contact force, all that a ridge's table has."""
    law = scene.friction_law()
    if not (law is None or isinstance(law, Coulomb)):
        raise SceneError(
            f"friction is {law}; the model 'smooth' has a ridge's contact force and not its pressures, so that it "
            "takes a friction coefficient alone: use another model"
        )


def _refuse_lost(scene: Scene, table: RidgeTable) -> None:
    """Refuse a table that ends with a ridge that has not let go."""
    force = table.contact - table.attraction
    last = np.flatnonzero(table.length > 0)[-1]
    if force[last] > _PRESSED * force.max():
        raise SceneError(
            f"mesh.contact is {scene.mesh.contact:g} m, on which the ridge of the model 'smooth', lifted as it slides, "
            f"is lost at {force[last]:.3g} N/m, before it lets go; "
            f"give a mesh.contact of {scene.mesh.contact / 2:g} m or less"
        )


def estimated(coarse: ContactState, fine: ContactState | None) -> Errors:
    """Return the estimated discretisation errors of a state, from one by tables of facets of half the size.

    Args:
        coarse: the state.
        fine: the other one; None where it is not known, and so are the errors.
    """
    if fine is None:
        return Errors()
    names = [field.name for field in fields(Errors)]
    before, after = ({name: getattr(state, name) for name in names} for state in (coarse, fine))
    parameter = MeshParameter()
    parameter.record(before, after)
    return Errors(**{name: parameter.changes[0][name] + parameter.safe(name) for name in names})


def _refuse_coarse(scene: Scene, states: Mapping[str, ContactState], errors: Mapping[str, Errors]) -> None:
    """Refuse an answer whose error is too large for it to mean anything, or is not known."""
    remedy = f"give a mesh.contact of {scene.mesh.contact / 2:g} m or less, or use another model"
    wanted = [(state, name) for state in states for name in _JUDGED]
    unknown = next(((state, name) for state, name in wanted if np.isnan(getattr(errors[state], name))), None)
    if unknown is not None:
        raise SceneError(
            f"mesh.contact is {scene.mesh.contact:g} m, and {_named(*unknown)} in the model 'smooth' is not known with "
            f"facets of half the size, so that its discretisation error is not either; {remedy}"
        )

    def share(of: tuple[str, str]) -> float:
        return float(getattr(errors[of[0]], of[1]) / (abs(getattr(states[of[0]], of[1])) or np.inf))

    worst = max(wanted, key=share)
    value, error = (getattr(each[worst[0]], worst[1]) for each in (states, errors))
    if error > _LARGEST * abs(value) > 0:
        raise SceneError(
            f"mesh.contact is {scene.mesh.contact:g} m, with which {_named(*worst)} in the model 'smooth' is "
            f"{value:.3g} with an estimated discretisation error of {error:.2g}, more than {_LARGEST:g} of it; {remedy}"
        )


def _named(state: str, name: str) -> str:
    return f"{name} of {WORDS[state]}"


class _TableEnds(StepFailed):
    """A ridge is pressed more deeply than its table goes."""


class _SmoothFinger:
    """The smooth finger and its loads."""

    def __init__(
        self, scene: Scene, folder: Path, comm: MPI.Comm, stages: Stages, deeper: int, interrupt: Interrupt
    ) -> None:
        self.scene, self.interrupt, self.deeper = scene, interrupt, deeper
        pause = partial(interrupt.stop_if_asked, alone=True)
        tables = []
        for each in ridges(scene):
            size = f"facets of {each.mesh.contact * 1e6:.3g} µm"
            stages.begin(f"one ridge pressed, slid and lifted at {each.voltage:g} V, {size}")
            tables.append(ridge_cell.tables(each, folder, comm, deeper, pause))
        self.charged, self.uncharged = charged, uncharged = tables[0], tables[-1]
        stages.begin(f"the smooth finger with the law of this ridge, {size}")
        finger = smoothed(scene.geometry)
        body = load(comm, partial(fingertip.build, finger, sizes(scene)), tags.LAYERS.values())
        self.law = RidgeLaw(uncharged.normal, charged.period, charged.tangential / charged.period)
        interface = Interface(self.law, scene.friction_law(), scene.h_0)
        numerics = scene.numerics
        # Without a voltage of the problem's own the air gaps do not act: they are inside the law.
        made = Body(
            body, scene.solids(), interface, scene.closure(), element=numerics.element,
            points=numerics.quadrature_points, force_scale=scene.f_ext, tolerance=numerics.tolerance,
            on_accept=self._accepted, step_scale=_STEPS,
        )  # fmt: skip
        self.solver, self.observer, self.walk = made.solver, made.observer, made.continuation
        self.touching = np.inf  # least width over which skin touches, in ridges

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

    def _mean_height(self) -> Array:
        """Return each ridge's mean height (m), shape (ridges,)."""
        surface, y = self.observer.surface, self.walk.surface_state.y
        return np.asarray(surface.per_ridge(y) / surface.per_ridge(np.ones_like(y)))

    def _accepted(self, target: Target, part: float, attempt: Attempt) -> None:
        """Stop where the law ends, and after a signal."""
        self.interrupt.stop_if_asked(self.walk.steps)
        comm = self.solver.layout.comm
        lowest = float(np.min(comm.allgather(float(self.walk.surface_state.y.min(initial=np.inf)))))
        if lowest < self.law.table.y[0]:
            raise _TableEnds(
                f"step {self.walk.steps} ({target.name}): a ridge is pressed by {-lowest:.3g} m and its table ends at "
                f"{-self.law.table.y[0]:.3g} m"
            )

    def _contact(self) -> dict[str, Any]:
        surface, y, period = self.observer.surface, self.walk.surface_state.y, self.charged.period
        contact, attraction, length = (
            surface.per_ridge(np.asarray(value / period, dtype=float)) for value in self.law.table.at(y)
        )
        width = float(surface.per_ridge(np.asarray(self.law.table.at(y)[2] > 0, dtype=float)).sum())
        self.touching = min(self.touching, width / period)
        if width < period:
            raise TooLight(
                f"f_ext is {self.scene.f_ext:g} N/m, under which the finger of the model 'smooth' touches over "
                f"{1e3 * width:.2g} mm, less than a ridge of {1e3 * period:.3g} mm, which it spreads evenly over that "
                "length; use the model 'full'"
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
