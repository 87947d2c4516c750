"""The runs behind the figures, by name; those of Figs. 6 to 8 are the grid of ``benchmarks/traces.py``."""

from typing import Any

import numpy as np

from benchmarks.traces import FORCES, VOLTAGES, trace
from fingerpad.scene import Scene

SIZE = 10e-6  # m, contact size
WIDTH = 20e-3  # m, out of plane: F = f WIDTH in Fig. 6
SECTION = (120.0, 150.0)  # N/m, V of Fig. 2
TRANSITION = 120.0  # N/m of Fig. 8
MAP = 75.0  # N/m of Fig. 9
PEAK = 200.0  # V, amplitude of Fig. 9's sine
PHASES = np.linspace(0, np.pi, 13)  # of one half period, of which the square of the voltage is a whole one


def grid(size: float) -> dict[tuple[float, float], Scene]:
    """Return the scenes of Figs. 2, 6, 7, 8 and 9A by force (N/m) and voltage (V)."""
    return {(f, u): trace(f, u, size) for f in FORCES for u in VOLTAGES}


def sine(size: float) -> Scene:
    """Return Fig. 9B's scene: slid to full slip without voltage, then on while the voltage follows a sine.

    At each of its values the finger slides on until every point slips again: the voltage changes slowly.
    """
    slip: dict[str, Any] = {"bone_x": 20e-3, "until_full_slip": True}
    charges = [{"name": "sine", "voltage": float(PEAK * np.sin(phase))} | slip for phase in PHASES[1:-1]]
    history = [
        {"name": "press", "f_ext": MAP},
        {"name": "slide"} | slip,
        *charges,
        {"name": "sine", "voltage": 0.0} | slip,
    ]
    return _scene(size, history=history)


def rougher(size: float, mu_app: float) -> Scene:
    """Return the scene of section 5's claim: no voltage, and the friction coefficient that mimics one.

    Args:
        size: contact size (m).
        mu_app: apparent friction coefficient with voltage.
    """
    return trace(MAP, 0.0, size, friction=round(mu_app, 4))


def _scene(size: float, **data: Any) -> Scene:
    from fingerpad.scene import from_data

    return from_data({"mesh": {"contact": size}} | data)
