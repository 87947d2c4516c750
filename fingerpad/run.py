"""Run a scene into a folder."""

from functools import partial
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fingerpad.accuracy import Keeper, Search, plus_minus
from fingerpad.advice import advice
from fingerpad.interrupt import Interrupt, Interrupted
from fingerpad.needs import plan
from fingerpad.reach import decide
from fingerpad.report import Report
from fingerpad.scene import Scene
from fingerpad.simulation import Simulation
from fingerpad.steps import Step
from fingerpad.zone import Woken
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
        which case every step before is in the folder all the same, and a key ``interrupted`` if it was asked to stop.
    """
    starts: list[dict[str, Any]] = []
    while True:
        summary = _run(scene, folder, comm, starts)
        finer = scene.mesh.contact / 2
        asked = scene.accuracy is not None
        lost = "failure" in summary and "accuracy" not in summary and "interrupted" not in summary
        if not (asked and lost and finer >= _FINEST_START):
            return summary
        starts.append({name: summary[name] for name in ("failure", "unknowns", "factorisations", "processor_seconds")})
        mesh = scene.mesh.model_copy(update={"contact": finer})
        scene = scene.model_copy(update={"mesh": mesh})


def _run(scene: Scene, folder: Path, comm: MPI.Comm, failed_starts: list[dict[str, Any]]) -> dict[str, Any]:
    """Run a scene once, from the mesh that it gives."""
    report = Report(scene, folder, comm)
    ended: dict[str, Any] = {}
    jit.sweep(comm)
    try:
        with Interrupt(comm) as interrupt:
            keeper: Keeper | None = None

            def on_step(step: Step, done: float) -> None:
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
                        ended["interrupted"] = True
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
        report.say(_sentence(summary, folder))
        return summary
    finally:
        report.close()


def _sentence(s: dict[str, Any], folder: Path) -> str:
    end = "full slip" if s["full_slip"] else "no full slip"
    if s["slip_mu_app"] is not None:
        end += f" under {s['slip_f_ext']:.4g} N/m and {s['slip_voltage']:.4g} V: mu_app {_show(s, 'mu_app', 4)}"
        end += f", f_T {_show(s, 'f_t', 3)} N/m"
        end += f", contact length {_show(s, 'contact_length', 3, 1e3)} mm"
    work = f"{s['newton_iterations']} Newton iterations, {s['factorisations']} factorisations, {s['memory_mb']:.0f} MB"
    return f"{end}; {work}, {s['wall_seconds']:.0f} s; results in {folder}"


def _show(s: dict[str, Any], name: str, digits: int, unit: float = 1.0) -> str:
    """Return a quantity of full slip, with its error where that was estimated."""
    value, error = s[f"slip_{name}"] * unit, s.get(f"slip_{name}_error")
    return f"{value:.{digits}f}" if error is None else plus_minus(value, error * unit)
