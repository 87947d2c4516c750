"""What must hold at every full slip, checked after each run: the balance of forces, and friction at its limit."""

from variational.contact.friction import CONE_ROUNDOFF
from variational.state import ContactState

_DEFECT = "this is a defect of the program, please report it"


def broken(slip: ContactState | None, error: float, mu_0: float | None) -> str:
    """Return what does not hold at the last full slip of a run, one sentence; empty where all does, or without slip.

    The bone's load is what the screen bears less the attraction, and Coulomb friction is mu_0 times the contact force.
    Points count as slipping within roundoff of the cone.

    Args:
        slip: full slip.
        error: what the solver's tolerance leaves of a sum of nodal forces (N/m).
        mu_0: friction coefficient; None where the law of friction is not Coulomb's.
    """
    if slip is None:
        return ""
    balance = slip.f_contact - slip.f_electrostatic - slip.f_ext
    if abs(balance) > error:
        return (
            f"the forces at full slip are out of balance by {balance:.3g} N/m, more than the {error:.3g} N/m that the "
            f"solver's tolerance leaves; {_DEFECT}"
        )
    cone = 0.0 if mu_0 is None else mu_0 * slip.f_contact
    if mu_0 is not None and abs(abs(slip.f_t) - cone) > error + CONE_ROUNDOFF * cone:
        return f"friction at full slip is {abs(slip.f_t):.9g} N/m and its limit {cone:.9g} N/m; {_DEFECT}"
    return ""
