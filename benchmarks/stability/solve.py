"""Run one case of the stability map in this process.

python3 -m benchmarks.stability.solve CASE LIMIT

CASE is JSON, and so is the outcome, the last line printed; after LIMIT seconds of processor time the process ends.

The bone's rim is the strip's flat top. The lateral faces move sideways with the bone and freely up and down, as those
of one of many equal ridges: a free stump of soft dermis under a stiff epidermis tips over before it slips, and faces
glued to the bone would hold the epidermis up. They are free only where a ridge is to snap off, or dermis to bulge.
"""

import json
import sys
import time
from collections import Counter
from dataclasses import asdict
from functools import partial

import basix
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

from benchmarks.stability import strip
from benchmarks.stability.plan import FORMULATIONS, Case, Outcome
from fingerpad.runs.processes import limit_processor_time
from geometry import tags
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from variational import compat
from variational.body import Body
from variational.contact.interface import Interface
from variational.kinematics import deformation_gradient
from variational.materials.ogden import Ogden
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import Attempt, Continuation, StepFailed, Target
from variational.solvers.coupling import Coupling
from variational.solvers.iteration import EXACT, StopRule
from variational.solvers.newton import Solver
from variational.solvers.outcome import NotConverged

_H_0 = 0.514e-6  # m
_SKIN = {tags.STRATUM_CORNEUM: 86.76e3, tags.VIABLE_EPIDERMIS: 61.75e3, tags.DERMIS: 2.55e3}  # Pa
_ALPHA = -14.53


class NewtonAlone(Solver):
    """Never turns to pseudo-transient continuation, whoever asks for it."""

    def solve(self, pseudo_transient: bool = False, stop: StopRule = EXACT, tried: bool = False) -> None:
        super().solve(False, stop, tried)


class Recorder(Coupling):
    """Counts failed solves in which steps would have turned elements inside out, by the layer nearest to it."""

    def __init__(self, body: Body, pseudo_transient: bool) -> None:
        solver = body.solver if pseudo_transient else NewtonAlone(body.solver.equations, body.solver.force_scale)
        super().__init__(solver, body.observer, BearingArea(_H_0))
        points, _ = basix.make_quadrature(basix.CellType.triangle, 2)
        self._jacobian = fem.Expression(ufl.det(deformation_gradient(ufl.grad(body.problem.u))), np.asarray(points))
        self.inverted = Counter[str]()

    def _least_j(self, layer: str) -> float:
        problem = self.solver.problem
        cells = problem.cell_tags.find(tags.LAYERS[layer])
        return float(compat.evaluate_on_cells(self._jacobian, problem.mesh, cells).min())

    def solve(self, pseudo_transient: bool = False) -> None:
        try:
            super().solve(pseudo_transient)
        except NotConverged as failure:
            if failure.inverted:
                layers = [name for name, tag in tags.LAYERS.items() if tag in strip.LAYERS]
                self.inverted[min(layers, key=self._least_j)] += 1
            raise


def make(case: Case) -> Body:
    """Return the strip of a case; interfaces' elements follow the contact's, between 20 and 80 um."""
    size = MeshSize(contact=case.contact_size, interface=float(np.clip(4 * case.contact_size, 20e-6, 80e-6)))
    mesh = load(MPI.COMM_WORLD, partial(strip.build, Fingertip(), size, case.ridges, case.height), strip.LAYERS)
    return Body(
        mesh,
        {tag: Ogden(shear, _ALPHA, case.nu) for tag, shear in _SKIN.items()},
        Interface(FORMULATIONS[case.formulation].law(case.parameter), case.mu_f, _H_0),
        element=case.element,
        force_scale=case.force * case.ridges,
        moving_sides=mesh.facets(tags.SIDES) if case.sides == "carried" else None,
    )


def targets(case: Case) -> list[Target]:
    """Return the loads of a case, one after the other."""
    pressed = Target("press", bone_height=-case.indentation)
    loads = [pressed if case.indentation else Target("press", f_ext=case.force * case.ridges)]
    loads += [Target("charge", voltage=voltage) for voltage in (case.detour, case.voltage) if voltage]
    if case.slide:
        loads.append(Target("slide", bone_x=case.slide, until_full_slip=True))
    return loads


def run(case: Case) -> Outcome:
    """Reach the loads of a case; a failure is an outcome like any other."""
    start = time.process_time()
    body, out = make(case), Outcome("converged")
    coupling = Recorder(body, case.pseudo_transient)
    solver = coupling.solver

    def accepted(target: Target, part: float, attempt: Attempt) -> None:
        state = walk.surface_state
        loads = body.observer.ridge_loads(state)
        out.steps, out.cutbacks = walk.steps, out.cutbacks + len(attempt.cutbacks)
        out.jumps += attempt.pseudo_transient
        out.penetration = float(np.max(-state.y[state.p_n > 0], initial=0.0))
        out.f_ext = float(solver.reaction[1])
        # What the screen exerts on the skin: carried faces bear a part that the bone does not bear.
        out.f_t = float((loads.f_attraction_x - loads.f_friction).sum())
        out.contact_length = float(loads.length.sum())

    walk = Continuation(coupling, accepted, step_scale=case.step_scale)
    try:
        for target in targets(case):
            out.load = target.name
            walk.run(target)
    except StepFailed as failure:
        cause = failure.__cause__
        out.status, out.message = "failed", str(failure)
        out.reason = cause.reason if isinstance(cause, NotConverged) else str(failure)
    else:
        out.status = "continuation" if out.jumps else "converged"
    out.newton, out.factorisations = solver.counts.newton, solver.counts.factorisations
    out.full_slip, out.inverted = walk.slip[1], dict(coupling.inverted)
    out.seconds = time.process_time() - start
    return out


if __name__ == "__main__":
    limit_processor_time(float(sys.argv[2]))
    print(json.dumps(asdict(run(Case(**json.loads(sys.argv[1]))))))
