"""The present state of a path in plain numbers, and what must hold of it: balance of forces, friction at its limit."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from variational.contact.formulation import Formulation
from variational.contact.friction import CONE_ROUNDOFF
from variational.energy import Balance
from variational.resultants import RidgeLoads
from variational.solvers.continuation import Attempt, Continuation, StepFailed
from variational.state import ContactState, RidgeStates, StepRecord

BALANCED = 1e-6
"""Largest part of f_ext that may be left at a node, and by which the reactions of bone and screen may differ."""
_STEADY = 1e-6  # relative change of f_t that sliding on at full slip may cause, beside that of gaps not closed
_AT_REST = 1e-6  # part of the energy stored under loads that is roundoff where nothing loads the body
_DEFECT = "this is a defect of the program, please report it"


def contact_state(
    path: Continuation,
    loads: RidgeLoads,
    ridges: list[int],
    d_eq: NDArray[np.float64],
    notes: Sequence[str] = (),
    **more: Any,
) -> ContactState:
    """Return the present state of a path, and of the ridges that can touch.

    Args:
        path: that is in the state.
        loads: resultants of the ridges.
        ridges: their numbers.
        d_eq: their air gaps (m), shape (ridges,).
        notes: on their places on the closure, mostly empty.
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
        f_adhesion=math.nan if path.problem.interface.adhesion is None else float(loads.f_adhesion.sum()),
        ridges_in_contact=int((loads.length > 0).sum()),
        contact_length=float(loads.length.sum()),
        p_max=float(path.observer.highest_pressures(path.surface_state).max()),
        slipping=slipping,
        all_slip=all_slip,
        ridges=RidgeStates(
            np.array(ridges), loads.length, loads.f_contact, loads.f_friction, loads.f_attraction, loads.p_c,
            np.array(d_eq), tuple(notes),
        ),
        **more,
    )  # fmt: skip


def step_record(path: Continuation, energy: Balance, imbalance: float, attempt: Attempt) -> StepRecord:
    """Return energies and work of the step to the present state; collective.

    Args:
        path: that is in the state.
        energy: of the step.
        imbalance: largest force left at a node, over the solver's force scale.
        attempt: how the step was solved.
    """
    of_branches = {}
    if path.problem.spent is not None:
        of_branches = {"viscous": energy.viscous, "viscous_dissipation": energy.viscous_dissipation}
        of_branches["viscous_least"] = least_dissipation(path)
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
        **of_branches,
    )


def least_dissipation(path: Continuation) -> float:
    """Return the least dissipation of a branch at a point in the last step over the largest amount; collective."""
    least, most = zip(*(each.extremes() for each in path.problem.relaxations.values()), strict=True)
    largest = max(*most, -min(least))
    return min(least) / largest if largest > 0 else 0.0


def force_error(unknowns: int, tolerance: float, force_scale: float) -> float:
    """Return the largest sum (N/m) of the nodal forces in one direction that a converged solve can leave.

    The solve ends where the norm of all of them is the tolerance times the force scale; their sum is at most the root
    of their number times that (Cauchy and Schwarz).

    Args:
        unknowns: their number, at most.
        tolerance: of the solver, over ``force_scale``.
        force_scale: force per length (N/m) in which residuals are measured.
    """
    return float(np.sqrt(unknowns)) * tolerance * force_scale


def steady(tolerance: float, gap: float) -> float:
    """Return the relative change of f_t that is not significant when the body slides on at full slip.

    An augmented Lagrangian leaves gaps of up to its tolerance, which close further with each load; the attraction goes
    with the inverse square of the air gap and the insulator behind it.

    Args:
        tolerance: of the formulation (m).
        gap: least air gap with the insulator behind it (m), infinite without attraction.
    """
    return _STEADY + 2 * tolerance / gap


def refuse_unbalanced(
    where: str,
    left: float,
    loads: RidgeLoads,
    bone: NDArray[np.float64],
    scale: float,
    tolerance: float,
    floor: float,
) -> None:
    """Refuse a state in which forces are left at a node, or the bone does not bear what the screen does.

    Args:
        where: step and load.
        left: largest force left at a node, over ``scale``.
        loads: what each ridge bears.
        bone: reaction of the bone (N/m), shape (2,).
        scale: force (N/m) in which residuals are measured.
        tolerance: of the solver, in that scale.
        floor: roundoff at which the solve ended, in that scale; 0 where it met its tolerance.

    Raises:
        StepFailed: the state is no equilibrium.
    """
    remedy = f"forces are not balanced to {BALANCED:g} of {scale:g} N/m; "
    if floor > tolerance:
        remedy += (
            f"roundoff of the stiffest layer leaves {floor * scale:.2g} N/m, whatever the numerics.tolerance; try a "
            "smaller stiffness, or poisson, of the nail, its bed or the stiffest layer"
        )
    else:
        remedy += f"try a numerics.tolerance below {tolerance:g}, and no PETSc option that ends a solve earlier"
    if not left <= BALANCED:
        raise StepFailed(f"{where}: a force of {left * scale:.4g} N/m is left at a node; {remedy}")
    down = loads.f_attraction + loads.f_adhesion
    screen = np.array([float(loads.f_friction.sum()), float((loads.f_contact - down).sum())])
    worst = int(np.argmax(np.abs(screen - bone)))
    if not abs(screen[worst] - bone[worst]) <= BALANCED * scale:
        raise StepFailed(
            f"{where}: the bone bears {bone[worst]:.9g} N/m {('sideways', 'downwards')[worst]} and the screen "
            f"{screen[worst]:.9g} N/m; {remedy}"
        )


def refuse_strained(
    where: str, record: StepRecord, before: Iterable[ContactState], scale: float, formulation: Formulation
) -> None:
    """Refuse a state that stores energy although nothing touches and attracts, of a step and load in words.

    Some formulations have such equilibria (:attr:`~variational.contact.formulation.Formulation.unloaded_energy`). They
    come where the method is not coercive, and Newton's method may go on to them while the body is loaded.

    Raises:
        StepFailed: the energy is above roundoff of the largest one stored under a load before.
    """
    if not math.isnan(record.viscous):  # whose layers are still on their way back
        return
    loaded = (state.record.stored for state in before if state.record and state.f_contact > BALANCED * scale)
    if record.stored > _AT_REST * max(loaded, default=math.inf):
        own = "a material of one's own may have a second state without stress, else " + _DEFECT
        remedy = formulation.unloaded_energy or own
        raise StepFailed(f"{where}: nothing loads the body, and it stores {record.stored:.3g} J/m; {remedy}")


def broken(slip: ContactState | None, error: float, mu_0: float | None) -> str:
    """Return what does not hold at the last full slip of a run, one sentence; empty where all does, or without slip.

    The bone's load is what the screen bears less the attraction, and Coulomb friction is mu_0 times the contact force
    (None of another law), within the error of a sum of nodal forces (N/m) and roundoff of the cone.
    """
    if slip is None:
        return ""
    balance = slip.f_contact - slip.f_attraction - slip.f_ext
    if abs(balance) > error:
        return (
            f"the forces at full slip are out of balance by {balance:.3g} N/m, more than the {error:.3g} N/m that the "
            f"solver's tolerance leaves; {_DEFECT}"
        )
    cone = 0.0 if mu_0 is None else mu_0 * slip.f_contact
    if mu_0 is not None and abs(abs(slip.f_t) - cone) > error + CONE_ROUNDOFF * cone:
        return f"friction at full slip is {abs(slip.f_t):.9g} N/m and its limit {cone:.9g} N/m; {_DEFECT}"
    return ""
