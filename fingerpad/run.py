"""Run a scene into a folder."""

import signal
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import fingerpad.started  # noqa: F401
from fingerpad import petsc_options
from fingerpad.accuracy import Keeper, Search
from fingerpad.advice import advice
from fingerpad.ending import all_together, no_room
from fingerpad.entry import MPI
from fingerpad.estimate import plus_minus
from fingerpad.interrupt import Interrupt, Interrupted
from fingerpad.needs import plan
from fingerpad.place import Place
from fingerpad.reach import decide
from fingerpad.report import Report
from fingerpad.scene import Scene, SceneError
from fingerpad.simulation import Simulation
from fingerpad.steps import Step
from fingerpad.zone import Woken
from geometry.profiles import GeometryError
from variational import jit
from variational.continuation import StepFailed

_FINEST_START = 5e-6  # m, contact size of a mesh to start from


def run(scene: Scene, folder: Path, comm: MPI.Comm) -> dict[str, Any]:
    """Reach every load of a scene, reporting into ``folder``; refine where it asks for an accuracy.

    A scene that asks for an accuracy starts coarse. Where the path cannot be followed so, it starts again finer.

    Where the scene does not say how many ridges can touch, a coarse finger does. Where what was left out turns out to
    matter, all loads are gone through again with it: ridges that come near the screen and could not touch, the other
    half of a finger that may not stay symmetric.

    Returns:
        The summary, the same on every rank; with a key ``failure`` if a load or an accuracy could not be reached, in
        which case every step before is in the folder all the same, and a key ``interrupted``, the signal's name, if
        it was asked to stop.

    Raises:
        PlaceError: the folder is in use, holds another scene's results, or cannot be written to.
        OptionError: PETSc refuses an option.
        SceneError: the finger cannot be meshed; on every rank.
        DiskFull: there is no more room for results; on the ranks that found out, which end the others.
    """
    all_together(comm)
    petsc_options.check()
    with Place(folder, scene, comm) as place:
        try:
            return _refine_start(scene, place, comm)
        except GeometryError as error:
            raise SceneError(f"the finger cannot be meshed: {error}") from error


def exit_code(summary: Mapping[str, Any]) -> int:
    """Return what a program ends with after a run: 0, 1 after a failure, or what the shell calls a signal."""
    if "interrupted" in summary:
        return 128 + signal.Signals[summary["interrupted"]]
    return 1 if "failure" in summary else 0


def _refine_start(scene: Scene, place: Place, comm: MPI.Comm) -> dict[str, Any]:
    """Run a scene, from a finer mesh again where the path of a coarse one cannot be followed."""
    starts: list[dict[str, Any]] = []
    while True:
        summary = _run(scene, place, comm, starts)
        finer = scene.mesh.contact / 2
        asked = scene.accuracy is not None
        lost = "failure" in summary and "accuracy" not in summary and "interrupted" not in summary
        if not (asked and lost and finer >= _FINEST_START):
            return summary
        starts.append({name: summary[name] for name in ("failure", "unknowns", "factorisations", "processor_seconds")})
        mesh = scene.mesh.model_copy(update={"contact": finer})
        scene = scene.model_copy(update={"mesh": mesh})


def _run(scene: Scene, place: Place, comm: MPI.Comm, failed_starts: list[dict[str, Any]]) -> dict[str, Any]:
    """Run a scene once, from the mesh that it gives."""
    report = Report(scene, place, comm)
    ended: dict[str, Any] = {}
    jit.sweep(comm)
    try:
        with Interrupt(comm) as interrupt:
            keeper: Keeper | None = None

            def on_step(step: Step, done: float) -> None:
                petsc_options.refuse_unread()
                report.step(step, done)
                if keeper is not None:
                    keeper.see(step)
                interrupt.stop_if_asked(step.row["step"])

            decision = decide(scene, comm)
            present, needed, again = decision.scene, plan(scene), True
            while again:
                search: Search | None = None  # one that was woken from is of another finger
                simulation = Simulation(present, decision.plan(needed, present), comm, on_step, report.load_reached)
                report.open(simulation)
                keeper = Keeper(simulation) if needed.errors else None
                again = False
                try:
                    simulation.run()
                    if keeper is not None:
                        pause = partial(interrupt.stop_if_asked, simulation.continuation.steps)
                        look = report.look if present.accuracy is not None else None
                        search = Search(present, needed, keeper.solve(), comm, report.say, pause, look)
                        search.run()
                except Woken as wake:
                    present, needed, again = wake.scene, wake.needed, True
                    report.restart(wake)
                except StepFailed as error:
                    ended = {"failure": "; ".join(filter(None, (str(error), advice(error))))}
                    if isinstance(error, Interrupted):
                        ended["interrupted"] = error.signal.name
            if search is not None:
                ended = search.summary() | ({"failure": search.failure} if search.failure else {}) | ended
                ended["unknowns"] = search.base.unknowns
                report.finer(search.base.views)
            ended["coarse_solve"] = decision.cost or None
            if failed_starts:
                ended["failed_starts"] = failed_starts
            if "failure" in ended:
                report.say(f"fingerpad: {ended['failure']}")
                report.log.error(ended["failure"])
            report.load_reached()
            report.draw()
            summary = report.summary(ended)
            report.say(_sentence(summary, place.folder))
            report.close()
            return summary
    except BaseException as error:
        # On more ranks than this, or not: what waits for the others would never return.
        report.close(whole=comm.size == 1 and no_room(error) is None)
        full = no_room(error)
        if full is None:
            raise
        raise full from error


def _sentence(s: dict[str, Any], folder: Path) -> str:
    end = "full slip" if s["full_slip"] else "no full slip"
    if s["slip_mu_app"] is not None:
        end += f" under {s['slip_f_ext']:.4g} N/m and {s['slip_voltage']:.4g} V: mu_app {_show(s, 'mu_app', 4)}"
        end += f", f_T {_show(s, 'f_t', 3)} N/m"
        end += f", contact length {_show(s, 'contact_length', 3, 1e3)} mm"
        end += " (±: estimated discretisation error)" if s.get("slip_mu_app_error") is not None else ""
        penalty = s.get("slip_contact_length_penalty")
        end += "" if penalty is None else f"; penalty: contact length {1e3 * penalty:+.2g} mm with a rigid screen"
    work = f"{s['newton_iterations']} Newton iterations, {s['factorisations']} factorisations, {s['memory_mb']:.0f} MB"
    return f"{end}; {work}, {s['wall_seconds']:.0f} s; results in {folder}"


def _show(s: dict[str, Any], name: str, digits: int, unit: float = 1.0) -> str:
    """Return a quantity of full slip, with its error where that was estimated."""
    value, error = s[f"slip_{name}"] * unit, s.get(f"slip_{name}_error")
    return f"{value:.{digits}f}" if error is None else plus_minus(value, error * unit)
