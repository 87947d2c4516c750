"""Run a scene into a folder."""

from pathlib import Path
from typing import Any

from mpi4py import MPI

from fingerpad.advice import advice
from fingerpad.interrupt import Interrupt, Interrupted
from fingerpad.needs import plan
from fingerpad.report import Report
from fingerpad.scene import Scene
from fingerpad.simulation import Simulation, Step
from fingerpad.zone import Woken
from variational import jit
from variational.continuation import StepFailed


def run(scene: Scene, folder: Path, comm: MPI.Comm) -> dict[str, Any]:
    """Reach every load of a scene, reporting into ``folder``.

    Where what was left out turns out to matter, all loads are gone through again with it: ridges that come near the
    screen and could not touch, the other half of a finger that may not stay symmetric.

    Returns:
        The summary, the same on every rank; with a key ``failure`` if a load could not be reached, in which
        case every step before is in the folder all the same, and a key ``interrupted`` if it was asked to stop.
    """
    report = Report(scene, folder, comm)
    ended: dict[str, Any] = {}
    jit.sweep(comm)
    try:
        with Interrupt(comm) as interrupt:

            def on_step(step: Step, done: float) -> None:
                report.step(step, done)
                interrupt.stop_if_asked(step.row["step"])

            present, needed, again = scene, plan(scene), True
            while again:
                simulation = Simulation(present, needed, comm, on_step, report.load_reached)
                report.open(simulation)
                again = False
                try:
                    simulation.run()
                except Woken as wake:
                    present, needed, again = wake.scene, wake.needed, True
                    report.restart(wake)
                except StepFailed as error:
                    ended = {"failure": "; ".join(filter(None, (str(error), advice(error))))}
                    if isinstance(error, Interrupted):
                        ended["interrupted"] = True
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
        end += f" at mu_app {s['slip_mu_app']:.4f}, f_T {s['slip_f_t']:.3f} N/m"
        end += f", contact length {s['slip_contact_length'] * 1e3:.3f} mm"
    work = f"{s['newton_iterations']} Newton iterations, {s['factorisations']} factorisations, {s['memory_mb']:.0f} MB"
    return f"{end}; {work}, {s['wall_seconds']:.0f} s; results in {folder}"
