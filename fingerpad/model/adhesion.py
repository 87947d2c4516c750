"""Ridges that adhere without a load: a sentence for a load that was not reached, and a caution on states that were.

A ridge adheres where its attraction is all that the screen bears. On closures of rough contact ridges can do so at a
voltage at which the bearing area model has none; the states then depend on the path, and one may not be found.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from variational.roughness.closure import PAST_THE_FOLD, Closure
from variational.state import ContactState

_NO_LOAD = 1e-6  # of the contact force: what the balance of forces leaves of a force of zero


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
    """Return which ridge of a state adheres without a load, or is about to come down or let go; empty for none.

    Below the voltage from which a flat ridge adheres the closure may have folds already, where a path can be lost.

    Args:
        state: the last one that was found.
        closure: see :func:`sticking`.
    """
    if closure is None or state is None or state.ridges is None:
        return ""
    ridges, at = state.ridges, f"at {state.voltage:.4g} V"
    inside = np.flatnonzero(ridges.length > 0)
    folded = [k for k in inside if closure.state(float(ridges.p_c[k]), state.voltage) == PAST_THE_FOLD]
    words = sticking(closure, state.voltage)
    if not words and not folded:
        return ""
    most = _most(state)
    if most is not None and most[1] >= 0:
        return f"ridge {most[0]} adheres without a load {at}{f': {words}' if words else ''}; take a smaller voltage"
    if folded:
        k = max(folded, key=lambda k: ridges.f_contact[k])
        name = type(closure).__name__
        by = f": {words}" if words else f" of the closure {name}, where it comes down or lets go at once"
        return f"ridge {ridges.number[k]} is past the fold {at}{by}; take a smaller voltage or another roughness.law"
    nearest = at if most is None else f"ridge {most[0]} is nearest to adhering without a load {at}:"
    return f"{nearest} {words}; take a smaller voltage or another roughness.law"


def lost(error: Exception | str, state: ContactState | None, closure: Closure | None) -> str:
    """Return why a state was not found: the words of a failure, and the ridge of a state before it that adheres.

    Args:
        error: the failure.
        state: see :func:`adhering`.
        closure: see :func:`sticking`.
    """
    return "; ".join(filter(None, (str(error), adhering(state, closure))))


def without_slip(states: Sequence[ContactState], closure: Closure | None) -> list[str]:
    """Return that a slide ended without full slip where ridges adhere, as a caution; none where they do not.

    Args:
        states: of the path.
        closure: see :func:`sticking`.
    """
    words = adhering(states[-1], closure) if states else ""
    return [f"full slip was not reached, or not held: {words}"] if words else []


def without_load(states: Iterable[ContactState], closure: Closure | None) -> list[str]:
    """Return in how many charged states attraction alone holds the finger, and the ridge that adheres most.

    Args:
        states: in contact, in any order.
        closure: see :func:`sticking`.
    """
    charged = [state for state in states if state.voltage]
    held = [state for state in charged if state.f_ext <= _NO_LOAD * state.f_contact]
    if not held:
        return []
    last, most = held[-1], _most(held[-1])
    pull, words = min(last.f_ext, 0.0) + 0.0, sticking(closure, last.voltage)
    ridge = "" if most is None else f", most by ridge {most[0]}"
    return [
        f"in {len(held)} of {len(charged)} charged states the finger adheres without a load{ridge}, at {pull:.3g} N/m "
        f"and {last.voltage:.4g} V" + (f"; {words}" if words else "")
    ]


def _most(state: ContactState) -> tuple[int, float] | None:
    """Return the ridge in contact whose attraction exceeds its contact force most, and by how much (N/m)."""
    if state.ridges is None or not (state.ridges.length > 0).any():
        return None
    excess = np.where(state.ridges.length > 0, state.ridges.f_electrostatic - state.ridges.f_contact, -np.inf)
    return int(state.ridges.number[int(excess.argmax())]), float(excess.max())
