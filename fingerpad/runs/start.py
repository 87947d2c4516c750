"""The full model's full slip from that of the model "smooth", without its path.

Full slip does not know the path that led there: every point in contact slips one way, and the screen looks the same
everywhere. So it can be solved for from any guess near enough. The smooth finger has one, less its ridges: its
displacement, bone and air gaps are put onto the ridged finger, whose ridges then reach some 20 um into the screen; they
are squeezed out of it (:mod:`variational.solvers.squeeze`), evenly over half a ridge or more, and the state is solved
for at once, in the end by pseudo-transient continuation. What is found is an equilibrium of the unchanged equations,
and is checked: in balance, at full slip, steady when it slides on, stable.

Not every guess is near enough; where it is not, the path is to be followed. Nor need an equilibrium be the one that the
path comes to: where a voltage makes ridges jump there are several, and full slip knows of the path by the ridges that
hang on. The notes say so.

Its discretisation error is estimated as a run's is (:mod:`fingerpad.accuracy.refinement`).

Normal contact is left out, since friction makes it depend on the path, of which the model "smooth" has nothing.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fingerpad.accuracy.recompute import Solve, StateRecorder
from fingerpad.accuracy.refinement import Refinement
from fingerpad.io.result import Cost, Result
from fingerpad.model.options import plan
from fingerpad.model.simulation import Simulation
from fingerpad.model.touching import by_rule
from fingerpad.reduced import ridge_cell, smooth
from fingerpad.reduced.answer import Stopwatch
from fingerpad.scene import Scene, laws
from variational.solvers.continuation import StepFailed
from variational.state import ContactState

# Depth (m) and reach (in ridges) of the squeezes to try; found by trial.
_SQUEEZES = ((0.1e-6, 0.5), (0.3e-6, 5 / 6))


@dataclass(frozen=True)
class Started:
    """A state of full slip without its path."""

    solve: Solve
    """Its state ``full_slip``; factorisations of guesses that were of no use are counted."""
    smooth: smooth.Slipping
    """What it was started from."""
    notes: tuple[str, ...]


def full_slip(scene: Scene, folder: Path, comm: MPI.Comm) -> Started:
    """Return the full model's full slip from the smooth finger's; collective.

    Args:
        scene: press, charge and slide.
        folder: of the ridges' tables, which are kept.
        comm: communicator of the mesh.

    Raises:
        StepFailed: the smooth finger does not come to full slip, or the full model's was not found from there.
    """
    scene = by_rule(scene)  # the smooth finger has these ridges
    guess = smooth.full_slip(scene, folder, comm)
    simulation = Simulation(scene, plan(scene), comm, lambda step, done: None, lambda: None)
    keeper = StateRecorder(simulation)
    failures = []
    for depth, reach in _SQUEEZES:
        squeezed = depth, reach * scene.geometry.ridge_wavelength
        try:
            simulation.adopt(guess.carried, "full slip", direction=1, squeezed=squeezed)
            break
        except StepFailed as error:
            failures.append(str(error))
    else:
        raise StepFailed(f"full slip was not found from that of the model 'smooth': {failures[-1]}")
    keeper.keep("full_slip")
    found = keeper.states["full_slip"].state.ridges_in_contact
    notes = [
        "full slip was solved for from that of the model 'smooth'; normal contact depends on the path, which was not "
        "followed",
        f"{found} ridges are in contact, in the model 'smooth' {guess.ridges}: where a voltage makes ridges jump, the "
        "path may end in another equilibrium, with a ridge more or less",
    ]
    return Started(keeper.solve(), guess, tuple(notes))


def answer(scene: Scene, folder: Path, comm: MPI.Comm) -> Result:
    """Return the full model's full slip from the smooth model's; collective.

    Raises:
        StepFailed: see :func:`full_slip`.
    """
    clock = Stopwatch()
    found = full_slip(scene, folder, comm)
    states = {"full_slip": found.solve.states["full_slip"].state}
    states, notes = _with_errors(by_rule(scene), found.solve, states, comm)
    more: dict[str, Any] = {
        "table_version": ridge_cell.VERSION,
        "rung_2_factorisations": found.smooth.factorisations,
        "rung_2_unknowns": found.smooth.unknowns,
    }
    more["laws"] = laws.used(scene)
    solve, seconds = found.solve, clock.seconds()
    cost = Cost(processor_seconds=seconds, factorisations=solve.factorisations, unknowns=solve.unknowns)
    notes = [*found.notes, *notes]
    return Result(scene, "full", None, None, states["full_slip"], cost=cost, notes=tuple(notes), record=more)


def _with_errors(
    scene: Scene, solve: Solve, states: dict[str, ContactState], comm: MPI.Comm
) -> tuple[dict[str, ContactState], list[str]]:
    """Return states with their estimated discretisation errors, as a run has them, and what is to be said of them."""
    needed = plan(scene)
    if not needed.errors:
        return states, [str(omission) for omission in needed.omitted if omission.what == "discretisation errors"]
    plain = scene.model_copy(update={"accuracy": None})
    search = Refinement(plain, needed, solve, comm, lambda text: None, lambda: None)
    search.run()
    return search.states(states), search.notes
