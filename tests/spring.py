"""A block that is a linear spring over the screen: the body of tests of pull-in, with its closed forms.

Its material does not widen when pressed and its sides do not move sideways, so the skin stays flat; it is
half as wide as it is high or less, so that bending the skin is stiffer than moving it. The bone's height is prescribed
and the skin, at height y, is in equilibrium where k (gap - y) = p_el(y).
"""

import numpy as np
from mpi4py import MPI
from scipy.optimize import brentq

from geometry import tags
from geometry.bodies import block
from geometry.mesh import load
from variational.body import Body
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.materials.saint_venant import SaintVenant
from variational.solvers.equations import Control
from variational.solvers.newton import Solver

WIDTH, HEIGHT, GAP = 0.125e-3, 0.5e-3, 6e-6
YOUNG, VOLTAGE, H_0, D_EQ = 4e6, 200.0, 0.514e-6, 2e-6
STIFFNESS = YOUNG / HEIGHT  # Pa/m
HALF = 8.854e-12 * VOLTAGE**2 / 2
FOLD = (2 * HALF / STIFFNESS) ** (1 / 3) - H_0  # height of the skin (m) where the spring is as stiff as p_el' is steep


def charged() -> Solver:
    """Return the solver of a charged block, its bone unmoved."""
    body = load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, WIDTH / 2, gap=GAP))
    solid, law = {tags.STRATUM_CORNEUM: SaintVenant(YOUNG, 0.0)}, Interface(Penalty(1e12, 1e11), 0.0, H_0)
    made = Body(body, solid, law, held=body.facets(tags.SIDES))
    made.problem.set_air_gaps(np.array([D_EQ]))
    made.problem.voltage.value = VOLTAGE
    return made.solver


def stress(stretch: float) -> float:
    """Return dW/dlambda (Pa) of the confined solid, W = E/8 (lambda^2 - 1)^2."""
    return YOUNG / 2 * (stretch**2 - 1) * stretch


def place(solver: Solver, y: float) -> None:
    """Set solver and bone to the equilibrium in which the skin is at height ``y`` (m), above d_eq."""
    pull = HALF / (H_0 + y) ** 2
    stretch = brentq(lambda s: stress(s) - pull, 0.9, 1.1, xtol=1e-15)
    bone, skin = y + (stretch - 1) * HEIGHT - GAP, y - GAP
    problem = solver.problem
    x = problem.V.tabulate_dof_coordinates()
    u = np.stack([0 * x[:, 0], skin + (bone - skin) * (x[:, 1] - GAP) / HEIGHT], axis=1)
    solver.set_displacement(u, np.array([0.0, bone]))
    solver.control = Control(0.0, bone)
    solver.solve()


def net_stiffness(y: float) -> float:
    """Return the spring's stiffness less the attraction's steepness (Pa/m) with the skin at ``y``, above d_eq."""
    pull = HALF / (H_0 + y) ** 2
    stretch = brentq(lambda s: stress(s) - pull, 0.9, 1.1, xtol=1e-15)
    return YOUNG / 2 * (3 * stretch**2 - 1) / HEIGHT - 2 * HALF / (H_0 + y) ** 3
