r"""Explicit dynamics, as the paper used them, beside the implicit solution: one ridge pressed, charged and slid.

Central differences with a lumped mass lead the same forms along the same loads: :math:`M \dot v = -r(u) - \alpha M v`.
Each load follows a smooth step over a number of periods of the slowest mode, which is doubled until the kinetic energy
stays below 1 % of the strain energy. Time counts in steps alone: a density raised everywhere raises period and critical
step by one factor. Scaled mass gives each element the mass with which its own critical step is that of all others. The
critical step is 2 over the largest frequency of the tangent in the charged state; both frequencies are Lanczos's.
"""

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc
from scipy.sparse.linalg import eigsh

from fingerpad.model.finger import Finger
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.scene import Scene
from geometry import tags
from geometry.bodies import ridge
from geometry.mesh import load
from variational import compat
from variational.attraction.electroadhesion import ELECTROSTATIC
from variational.body import Body
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.problem import Interface, Problem
from variational.solvers.continuation import Target
from variational.solvers.equations import Equations
from variational.solvers.target import Control

Array = np.ndarray[Any, np.dtype[Any]]
Numbers = dict[str, Any]
SIZES = (20e-6, 10e-6, 5e-6)  # m, of facets
_LOADS, _GAP = np.array([60e-6, 200.0**2, 10e-6]), 2e-6  # depth (m), voltage squared, slide (m); fixed air gap (m)
_SKIN = Ogden(0.08676e6, -14.53, 0.48)  # as in benchmarks/peers
_STEPS = 20  # of the implicit solution, a load
_PERIODS, _MOST = 2.0, 64.0  # of the slowest mode, over which a load is applied
_QUASI_STATIC, _FROM = 0.01, 0.1  # kinetic over strain energy, judged from this part of the pressing on
SAFETY, _EVERY = 0.8, 20  # part of the critical step; steps between updates of the friction's history
_LUMPED = np.array([1 / 19] * 3 + [16 / 57] * 3)  # parts of a P2 triangle's mass, by its consistent diagonal
_PRESSED, _REPEATS = 50e-6, 20  # m, of the default finger's bone; residuals that are timed


class Ridge:
    """The ridge on its screen.

    Attributes:
        body: with its solver.
        held: facets of the sides.
    """

    def __init__(self, size: float) -> None:
        """Mesh it with facets of a size (m)."""
        tagged = load(MPI.COMM_SELF, ridge(size))
        law = Interface(Penalty(1e12, 1e11), 0.25, 0.514e-6, ELECTROSTATIC)
        self.held = tagged.facets(tags.SIDES)
        self.body = Body(tagged, {tags.STRATUM_CORNEUM: _SKIN}, law, held=self.held)
        self.body.problem.set_air_gaps(np.array([_GAP]))
        self._slid = 0.0

    def mass(self, scaled: bool) -> Array:
        """Return the mass of each node, see :func:`masses`."""
        cells = len(self.body.problem.V.dofmap.list)
        return masses(self.body.problem, np.full(cells, _SKIN.constrained_modulus), scaled)

    def slide(self, to: float) -> float:
        """Move the screen sideways to a place (m), by the anchors of friction; return how far it moved."""
        history, moved = self.body.problem.history, to - self._slid
        history.accept(history.translated(-moved))
        self._slid = to
        return moved

    def accept(self) -> list[float]:
        """Accept the history of the present fields; return contact force, friction (N/m) and contact length (m)."""
        state = self.body.observer.state()
        loads = self.body.observer.ridge_loads(state)
        self.body.problem.history.accept(state.history)
        return [float(values[0]) for values in (loads.f_contact, loads.f_friction[:1], loads.length)]


def implicit(size: float) -> Numbers:
    """Lead a ridge along the loads in equilibria; return answers and work, and the charged state's frequencies."""
    made, answers, rates, seconds = Ridge(size), [], list[tuple[float, float]](), 0.0
    solver = made.body.solver
    for k in range(1, 3 * _STEPS + 1):
        start = time.process_time()
        depth, squared, slid = np.clip(k / _STEPS - np.arange(3), 0.0, 1.0) * _LOADS
        solver.x.array_w[-2] -= made.slide(slid)  # of the bone and all that is relative to it: no point slips at first
        solver.new_load(Control(0.0, -depth), np.sqrt(squared), slipping=slid > 0)
        solver.solve()
        answers.append(made.accept())
        seconds += time.process_time() - start
        if k == 2 * _STEPS:
            rates = [frequencies(solver.equations, made.mass(scaled)) for scaled in (False, True)]
    work = {"steps": len(answers), "iterations": solver.counts.newton, "seconds": seconds}
    return work | {"answers": answers[_STEPS - 1 :: _STEPS], "frequencies": rates}


def masses(problem: Problem, modulus: Array, scaled: bool) -> Array:
    """Return the lumped mass of each node, shape (nodes,): of density one, or of elements with one critical step.

    Args:
        problem: whose mesh it is, of P2 triangles.
        modulus: of each cell (Pa), to which the scaled mass is proportional.
        scaled: whether the mass is scaled.
    """
    corners = problem.mesh.geometry.x[compat.cell_geometry(problem.mesh)][:, :3, :2]
    area = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 2
    found = np.zeros(len(problem.displacement()))
    np.add.at(found, problem.V.dofmap.list, np.outer(modulus if scaled else area, _LUMPED))
    return found


def frequencies(equations: Equations, mass: Array) -> tuple[float, float]:
    """Return the least and the largest circular frequency of the present tangent with a mass of each node."""
    A, m = equations.layout.create_matrix(), equations.layout.create_vector()
    equations.assemble_tangent(A)
    indptr, indices, values = A.convert(PETSc.Mat.Type.AIJ, PETSc.Mat()).getValuesCSR()
    equations.layout.from_nodes(np.repeat(mass, 2), np.ones(2), m)
    free = np.setdiff1d(np.arange(m.getSize()), equations.prescribed_rows())
    root = sp.diags(1 / np.sqrt(m.array_r[free]))
    K = root @ sp.csr_matrix((values, indices, indptr))[free][:, free] @ root
    K = ((K + K.T) / 2).tocsc()
    least, most = (
        eigsh(K, 1, return_eigenvectors=False, tol=1e-3, **how)[0] for how in ({"sigma": 0}, {"which": "LA"})
    )
    return float(np.sqrt(least)), float(np.sqrt(most))


def lead(size: float, scaled: bool, rates: Sequence[float], periods: float) -> Numbers:
    """Lead a ridge along the loads by central differences; return answers, steps and the ratio of energies."""
    made, low, dt = Ridge(size), rates[0], SAFETY * 2 / rates[1]
    problem, mass, load_steps = made.body.problem, np.repeat(made.mass(scaled), 2), int(periods * 2 * np.pi / low / dt)
    free = np.ones_like(mass)
    free.reshape(-1, 2)[made.body.solver.layout.rim] = 0.0
    free[2 * fem.locate_dofs_topological(problem.V, 1, made.held)] = 0.0
    # Damping is half of the slowest mode's critical one: alpha is its frequency.
    keep, push = (1 - low * dt / 2) / (1 + low * dt / 2), dt / (1 + low * dt / 2) * free / mass
    w, f, v = problem.w.x.array, np.zeros_like(mass), np.zeros_like(mass)
    answers, ratio, start = [], 0.0, time.process_time()
    for k in range(1, 3 * load_steps + 1):
        part = np.clip(k / load_steps - np.arange(3), 0.0, 1.0)
        depth, squared, slid = part**3 * (10 - 15 * part + 6 * part**2) * _LOADS
        problem.bone.value[1], problem.voltage.value = -depth, np.sqrt(squared)
        f[:] = 0.0
        fem.assemble_vector(f, problem.residual)
        v *= keep
        v -= push * f
        w += dt * v
        if k % _EVERY == 0 or k % load_steps == 0:
            made.slide(slid)
            found = made.accept()
            answers += [found] if k % load_steps == 0 else []
            problem.voltage.value = 0.0  # the strain energy alone
            if depth > _FROM * _LOADS[0]:
                ratio = max(ratio, float(mass @ v**2) / 2 / fem.assemble_scalar(problem.energy))
    seconds = time.process_time() - start
    return {"answers": answers, "steps": 3 * load_steps, "periods": periods, "ratio": ratio, "seconds": seconds}


def quasi_static(size: float, scaled: bool, rates: Sequence[float]) -> Numbers:
    """Return the fastest of the runs, each over twice the periods of the one before, that is quasi-static."""
    periods, found = _PERIODS, lead(size, scaled, rates, _PERIODS)
    while found["ratio"] > _QUASI_STATIC and periods < _MOST:
        periods *= 2
        found = lead(size, scaled, rates, periods)
    return found


def default_finger() -> Numbers:
    """Return the frequencies of the default finger, pressed a little, by both masses, and the time of one residual."""
    scene = by_rule(Scene())
    model = FingerModel(scene, plan(scene))
    finger = Finger(model, MPI.COMM_SELF, lambda target, part, attempt: False)
    finger.continuation.run(Target("press", bone_height=-_PRESSED))
    problem, modulus = finger.problem, np.zeros(len(finger.problem.V.dofmap.list))
    for tag, solid in model.solids.items():
        modulus[finger.mesh.cell_tags.find(tag)] = solid.constrained_modulus
    rates = [frequencies(finger.solver.equations, masses(problem, modulus, scaled)) for scaled in (False, True)]
    f, start = np.zeros_like(problem.w.x.array), time.process_time()
    for _ in range(_REPEATS):
        fem.assemble_vector(f, problem.residual)
    return {"frequencies": rates, "residual": (time.process_time() - start) / _REPEATS, "unknowns": finger.unknowns}


def measure() -> Numbers:
    """Return all that the page shows."""
    ridges = []
    for size in SIZES:
        base = implicit(size)
        runs = [quasi_static(size, scaled, base["frequencies"][scaled]) for scaled in (False, True)]
        ridges.append({"size": size, "implicit": base, "explicit": runs})
    return {"ridges": ridges, "finger": default_finger(), "safety": SAFETY, "every": _EVERY}
