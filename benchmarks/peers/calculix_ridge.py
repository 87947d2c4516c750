"""The ridge in CalculiX: an input deck of CPE6 elements, its Ogden law and its face-to-face penalty contact.

CalculiX makes a solid one element thick of the plane strain elements, prescribes its displacements in z and presses it on
a rigid block. Its contact stiffness is per current area. Every load is a step of the deck without any subdivision.
Ogden's exponent has Abaqus's sign, so that the printed alpha = -14.53 is 14.53 here; D = 2/K.
"""

import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from benchmarks.peers.exchange import Answer, Case, Ridge, State, main, steps

_BLOCK = np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.0], [-1.0, 0.0]])  # mm, the screen
_JOB = "ridge"


def deck(case: Case, ridge: Ridge) -> str:
    """Return the input deck."""
    count = len(ridge.points)
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k}, {x:.15g}, {y:.15g}, 0" for k, (x, y) in enumerate(np.vstack([ridge.points, _BLOCK]), start=1)]
    lines.append("*ELEMENT, TYPE=CPE6, ELSET=BODY")
    lines += [f"{k}, " + ", ".join(map(str, cell + 1)) for k, cell in enumerate(ridge.triangles, start=1)]
    last = len(ridge.triangles) + 1
    lines += ["*ELEMENT, TYPE=CPE4, ELSET=BLOCK", f"{last}, " + ", ".join(str(count + k) for k in range(1, 5))]
    for name, nodes in {
        "TOP": ridge.top,
        "HELD": np.union1d(ridge.top, ridge.sides),
        "SKIN": np.unique(ridge.skin),
        "SCREEN": count + np.arange(4),
    }.items():
        lines += [f"*NSET, NSET={name}", *(f"{k + 1}," for k in nodes)]
    faces = {frozenset(pair) for pair in ridge.skin[:, :2].tolist()}
    lines.append("*SURFACE, NAME=SLAVE")
    for k, (a, b, c) in enumerate(ridge.triangles[:, :3].tolist(), start=1):
        lines += [f"{k}, S{s}" for s, edge in enumerate(((a, b), (b, c), (c, a)), start=1) if frozenset(edge) in faces]
    law = f"{case.shear_modulus:.15g}, {case.exponent:.15g}, {2 / case.bulk_modulus:.15g}"
    lines += [
        "*SURFACE, NAME=MASTER",
        f"{last}, S3",
        "*MATERIAL, NAME=SKIN",
        "*HYPERELASTIC, OGDEN, N=1",
        law,
        "*MATERIAL, NAME=RIGID",
        "*ELASTIC",
        "1000, 0.3",
        "*SOLID SECTION, ELSET=BODY, MATERIAL=SKIN",
        "1",
        "*SOLID SECTION, ELSET=BLOCK, MATERIAL=RIGID",
        "1",
        "*SURFACE INTERACTION, NAME=TOUCH",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{case.eps_n:.15g}",
    ]
    if case.mu_f:
        lines += ["*FRICTION", f"{case.mu_f:.15g}, {case.eps_t:.15g}"]
    lines += ["*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER"]
    lines += ["*BOUNDARY", "SCREEN, 1, 2"]
    for _, load in steps(case):
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC, DIRECT", "1, 1"]
        lines += ["*BOUNDARY", f"HELD, 1, 1, {load.x:.15g}", f"TOP, 2, 2, {load.y:.15g}"]
        if load.name:
            lines += ["*NODE PRINT, NSET=SKIN", "U", "*NODE PRINT, NSET=HELD", "RF"]
            lines += ["*CONTACT PRINT", "CDIS, CSTR"]
        else:
            lines += ["*NODE PRINT, NSET=SKIN, FREQUENCY=999", "U", "*CONTACT PRINT, FREQUENCY=999", "CDIS"]
        lines.append("*END STEP")
    return "\n".join(lines) + "\n"
