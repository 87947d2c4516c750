r"""A layer that relaxes: a block that is pressed at once and then held, with the mouse's set of branches.

The set is :math:`G(t) / G(0) = 0.351 + 0.154\, e^{-t / 1.111 s} + 0.495\, e^{-t / 0.092 s}` (skin in compression,
behind doi 10.1371/journal.pone.0120897). **A block** between frictionless sides, at a stretch s that is held, bears

.. math:: p(t) = -K (s - 1) - \left[ P_2(s) - K (s - 1) \right] \frac{G(t)}{G(\infty)}

with the long-time stress P_2 of Ogden's law in principal stretches (:mod:`.constitutive`) and the bulk modulus K.
"""

import numpy as np

from benchmarks.verification import constitutive
from benchmarks.verification.bodies import over_screen
from benchmarks.verification.case import Case, Row
from geometry.bodies import block
from variational.contact.interface import Interface
from variational.contact.nitsche import Nitsche
from variational.materials.ogden import Ogden
from variational.materials.qlv import QLV
from variational.materials.viscoelastic import Viscoelastic
from variational.solvers.continuation import Continuation, Target

_SHEAR, _ALPHA, _NU = 86.76e3, -14.53, 0.48
_BRANCHES = QLV((0.154, 0.495), (1.111, 0.092))
_TIMES = (0.05, 0.5, 2.0)  # s


def _left(t: float) -> float:
    """Return G(t) / G(0)."""
    return float(0.351 + 0.154 * np.exp(-t / 1.111) + 0.495 * np.exp(-t / 0.092))


def _held(run: Continuation, depth: float) -> list[float]:
    """Press a body at once and hold it; return the force (N/m) at once and at the times."""
    run.run(Target("press", bone_height=-depth))
    found, before = [abs(float(run.solver.reaction[1]))], 0.0
    for t in _TIMES:
        run.run(Target("hold", bone_height=-depth, duration=t - before))
        found.append(abs(float(run.solver.reaction[1])))
        before = t
    return found


def held_block(small: bool) -> list[Row]:
    """Pressure of a block in confined compression of 4 %."""
    width, height, depth = 1e-3, 0.5e-3, 20e-6
    law = Viscoelastic(Ogden(_SHEAR, _ALPHA, _NU), _BRANCHES)
    run = over_screen(block(width, height, 0.25e-3), law, Interface(Nitsche(10.0, 0), 0.0, 1e-6), 1.0, sides_held=True)
    forces, stretch = _held(run, depth), 1 - depth / height
    solid = constitutive.LAYERS[0]
    whole = float(constitutive.nominal(solid, (1.0, stretch, 1.0))[1])
    volume = solid.bulk * (stretch - 1)
    rows = []
    for t, force in zip((0.0, *_TIMES), forces, strict=True):
        exact = -(volume + (whole - volume) * _left(t) / 0.351)
        rows.append(Row(f"pressure after {t:g} s (kPa)", force / width / 1e3, exact / 1e3, 1e-6, "the end of solves"))
    return rows


_SET = "relaxation of the set in closed form"
CASES = (Case("Block that is held", f"{_SET}; Ogden 1984 in principal stretches", held_block),)
