"""The runs behind the paper's figures; those of Figs. 6 to 8 are a grid of forces and voltages."""

from typing import Any

import numpy as np

from benchmarks.runs import FORCES, VOLTAGES, plain
from fingerpad.scene import Scene

_PATH = {"output": {"errors": False}}  # the default finger on its default mesh; what that leaves of error is known
SECTION = (120.0, 150.0)  # N/m, V of Fig. 2
TRANSITION = 120.0  # N/m of Fig. 8
MAP = 75.0  # N/m of Fig. 9
PEAK = 200.0  # V, amplitude of Fig. 9's sine
NAMED = {"highest": 22, "enters": 27, "leaves": 16, "changes least": 25}
"""The paper's numbers of Merkel sites in Fig. 9B by what they do; from where it counts, it does not say."""
_SLIP = 2e-3  # m, by which the finger slips without voltage (at 1.4 mm)
_BETWEEN = 0.8e-3  # m of sliding from one voltage to the next, half of it while the voltage changes
PHASES = np.linspace(0, np.pi, 13)  # of one half period, of which the square of the voltage is a whole one


def grid() -> dict[tuple[float, float], Scene]:
    """Return the scenes of Figs. 2, 6, 7, 8 and 9A by force (N/m) and voltage (V)."""
    return {(f, u): plain({"f_ext": f, "voltage": u} | _PATH) for f in FORCES for u in VOLTAGES}


def sine() -> Scene:
    """Return Fig. 9B's scene: slid to full slip without voltage, then on to full slip again and again on the sine."""
    history: list[dict[str, Any]] = [
        {"name": "press", "f_ext": MAP},
        {"name": "slide", "bone_x": _SLIP, "until_full_slip": True},
    ]
    for k, phase in enumerate(PHASES[1:], start=1):
        x = _SLIP + k * _BETWEEN
        voltage = float(PEAK * np.sin(phase)) if k < len(PHASES) - 1 else 0.0
        history += [
            {"name": f"change {k}", "voltage": voltage, "bone_x": x - _BETWEEN / 2},
            {"name": f"sine {k}", "bone_x": x, "until_full_slip": True},
        ]
    return plain({"history": history} | _PATH)


def rougher(mu_app: float) -> Scene:
    """Return the scene of section 5's claim: no voltage, and the friction coefficient that voltage led to."""
    return plain({"f_ext": MAP, "voltage": 0.0, "friction": round(mu_app, 4)} | _PATH)
