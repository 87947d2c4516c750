"""What must hold at every full slip, checked after each run: the balance of forces, and friction at its limit."""

from collections.abc import Mapping
from typing import Any

from variational.friction import CONE_ROUNDOFF


def broken(summary: Mapping[str, Any], friction: float) -> str:
    """Return what does not hold at the last full slip of a run, one sentence; empty where all does, or without slip.

    The bone's load is what the screen bears less the attraction, and friction is mu_0 times the contact force. Bone and
    screen are compared by sums of nodal forces, of which the solves' tolerance leaves ``force_error``; points count as
    slipping within roundoff of the cone.

    Args:
        summary: of the run, with the forces in N/m.
        friction: mu_0.
    """
    if not summary.get("full_slip"):
        return ""
    contact, error = summary["slip_f_contact"], summary["force_error"]
    balance = contact - summary["slip_f_electrostatic"] - summary["slip_f_ext"]
    if abs(balance) > error:
        return (
            f"the forces at full slip are out of balance by {balance:.3g} N/m, more than the {error:.3g} N/m that the "
            "solver's tolerance leaves; this is a defect of the program, please report it"
        )
    cone = friction * contact
    if abs(abs(summary["slip_f_t"]) - cone) > error + CONE_ROUNDOFF * cone:
        return (
            f"friction at full slip is {abs(summary['slip_f_t']):.9g} N/m and its limit {cone:.9g} N/m; "
            "this is a defect of the program, please report it"
        )
    return ""
