"""Ridges that adhere without a load: a sentence for a load that was not reached, by the closure's sticking voltage.

A ridge adheres where its attraction is all that the screen bears. On closures of rough contact ridges can do so at a
voltage at which the bearing area model has none; the states then depend on the path, and one may not be found.
"""

from variational.roughness.closure import Closure
from variational.state import ContactState


def sticking(closure: Closure | None, voltage: float) -> str:
    """Return that ridges adhere without a load at a voltage (V), in words; empty where they do not.

    Args:
        closure: one of the package; of others it is not known.
        voltage: (V), of either sign.
    """
    least = getattr(closure, "sticking_voltage", lambda: None)()
    if least is None or not abs(voltage) >= least:
        return ""
    return f"by the closure {type(closure).__name__} ridges adhere without a load from {least:.3g} V on"


def adhering(state: ContactState | None, closure: Closure | None) -> str:
    """Return which ridge of a state adheres without a load, and from which voltage on ridges do; empty for none.

    Args:
        state: the last one that was found.
        closure: see :func:`sticking`.
    """
    if state is None or state.ridges is None or not (words := sticking(closure, state.voltage)):
        return ""
    ridges = state.ridges
    excess = (ridges.f_electrostatic - ridges.f_contact)[ridges.length > 0]
    if not excess.size or excess.max() < 0:
        return f"at {state.voltage:.4g} V {words}; take a smaller voltage or another roughness.law"
    number = int(ridges.number[ridges.length > 0][int(excess.argmax())])
    return f"ridge {number} adheres without a load at {state.voltage:.4g} V: {words}; take a smaller voltage"
