"""The present state of a path of loads, and the energies and work of the step to it, in plain numbers."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.model.balance import BALANCED
from variational.energy import Balance
from variational.quantities import RidgeLoads
from variational.state import ContactState, RidgeStates, StepRecord

if TYPE_CHECKING:
    from variational.solvers.continuation import Attempt, Continuation


def contact_state(
    path: "Continuation",
    loads: RidgeLoads,
    ridges: list[int],
    d_eq: NDArray[np.float64],
    notes: Sequence[str] = (),
    **more: Any,
) -> ContactState:
    """Return the present state.

    Args:
        path: that is in the state.
        loads: resultants of the ridges that can touch.
        ridges: their numbers.
        d_eq: their air gaps (m), shape (ridges,).
        notes: remarks on their places on the closure, mostly empty.
        **more: further attributes of the state.
    """
    solver, (slipping, all_slip) = path.solver, path.slip
    f_ext, f_t = float(solver.reaction[1]), 0.0 - float(solver.reaction[0])  # no negative zero
    return ContactState(
        step=path.steps,
        f_ext=f_ext,
        voltage=float(path.problem.voltage.value),
        bone_x=float(solver.bone[0]),
        bone_height=float(solver.bone[1]),
        f_t=f_t,
        mu_app=f_t / f_ext if f_ext > BALANCED * solver.force_scale else math.nan,
        f_contact=float(loads.f_contact.sum()),
        f_electrostatic=float(loads.f_attraction.sum()),
        ridges_in_contact=int((loads.length > 0).sum()),
        contact_length=float(loads.length.sum()),
        slipping=slipping,
        all_slip=all_slip,
        ridges=RidgeStates(
            np.array(ridges), loads.length, loads.f_contact, loads.f_friction, loads.f_attraction, loads.p_c,
            np.array(d_eq), tuple(notes),
        ),
        **more,
    )  # fmt: skip


def step_record(path: "Continuation", energy: Balance, imbalance: float, attempt: "Attempt") -> StepRecord:
    """Return energies and work of the step to the present state; collective.

    Args:
        path: that is in the state.
        energy: of the step.
        imbalance: largest force left at a node, over the solver's force scale.
        attempt: how the step was solved.
    """
    return StepRecord(
        penetration=path.observer.penetration(path.surface_state),
        imbalance=imbalance,
        floor=path.solver.floor,
        stored=energy.stored,
        dissipation=energy.dissipation,
        energy_released=energy.released,
        released_error=energy.released_error,
        newton_iterations=attempt.newton,
        factorisations=attempt.factorisations,
        coupling_iterations=attempt.coupling_iterations,
        cutbacks=len(attempt.cutbacks),
        jump=attempt.jump,
    )
