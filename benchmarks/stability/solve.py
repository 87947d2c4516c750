"""Run one case of a layered strip in this process: pressed, charged and dragged to full slip.

python3 -m benchmarks.stability.solve CASE LIMIT

CASE is JSON, and so is the outcome, the last line printed; after LIMIT seconds of processor time the process ends.

The bone's rim is the strip's flat top. The lateral faces move sideways with the bone and freely up and down, as those
of one of many equal ridges: a free stump of soft dermis under a stiff epidermis tips over before it slips, and faces
glued to the bone would hold the epidermis up. They are free only where dermis is to bulge.
"""

import json
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI

from benchmarks.stability import strip
from fingerpad.runs.processes import limit_processor_time
from geometry import tags
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from variational.body import Body
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation
from variational.contact.interface import Interface
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import Attempt, Continuation, StepFailed, Target
from variational.solvers.outcome import NotConverged

FORMULATIONS: dict[str, Callable[[float], Formulation]] = {  # by their one numerical parameter
    "penalty": lambda eps_n: Penalty(eps_n, 5e10),
    "augmented": lambda eps_n: AugmentedLagrangian(eps_n, eps_n / 30, 5e-9),
    **{f"Nitsche, θ = {theta}": partial(Nitsche, theta=theta) for theta in (0, 1, -1)},
}
REFERENCE_SIZE = 2.5e-6  # m, contact size of the run with which others are compared
_H_0 = 0.514e-6  # m
_SKIN = {tags.STRATUM_CORNEUM: 86.76e3, tags.VIABLE_EPIDERMIS: 61.75e3, tags.DERMIS: 2.55e3}  # Pa
_ALPHA = -14.53


@dataclass(frozen=True)
class Case:
    """A strip pressed, charged and dragged to full slip; SI units, forces per ridge and out-of-plane length."""

    formulation: str = "penalty"
    parameter: float = 1.5e12
    element: str = "P2"
    contact_size: float = 10e-6
    force: float = 4.4  # the finger's 75 N/m over its 17 ridges in contact
    indentation: float = 0.0  # if not zero, the bone is lowered by so much instead of being pressed by the force
    voltage: float = 200.0
    nu: float = 0.48  # Poisson's ratio of all layers
    mu_f: float = 0.25
    step_scale: float = 1.0  # factor on the largest steps of force, voltage and sliding
    slide: float = 1e-3  # farthest the bone slides towards full slip; zero for no sliding
    height: float = 1.5e-3
    sides: str = "carried"  # lateral faces: moved sideways with the bone and free up and down, or "free"

    @property
    def changed(self) -> dict[str, Any]:
        """Fields that are not the default's: the case as it is kept."""
        return {name: value for name, value in asdict(self).items() if value != getattr(Case(), name)}

    @property
    def reference(self) -> "Case":
        """The run on the finest mesh with the same physical parameters and default numerical ones."""
        numerical = ("formulation", "parameter", "element", "step_scale")
        return replace(self, contact_size=REFERENCE_SIZE, **{name: getattr(Case(), name) for name in numerical})


@dataclass
class Outcome:
    """What became of a case; lengths in m, forces per out-of-plane length in N/m, of the last accepted state."""

    status: str = "converged"  # by Newton's method; "continuation", pseudo-transient, helped; or "failed"
    reason: str = ""  # name of the failure, for example that of SNES
    message: str = ""
    load: str = ""  # in which the run ended
    full_slip: bool = False
    newton: int = 0
    factorisations: int = 0
    cutbacks: int = 0
    penetration: float = 0.0
    f_ext: float = 0.0
    f_t: float = 0.0
    contact_length: float = 0.0


def make(case: Case) -> Body:
    """Return the strip of a case; interfaces' elements follow the contact's, between 20 and 80 um."""
    size = MeshSize(contact=case.contact_size, interface=float(np.clip(4 * case.contact_size, 20e-6, 80e-6)))
    mesh = load(MPI.COMM_WORLD, partial(strip.build, Fingertip(), size, case.height), strip.LAYERS)
    return Body(
        mesh,
        {tag: Ogden(shear, _ALPHA, case.nu) for tag, shear in _SKIN.items()},
        Interface(FORMULATIONS[case.formulation](case.parameter), case.mu_f, _H_0),
        BearingArea(_H_0),
        element=case.element,
        force_scale=case.force,
        moving_sides=mesh.facets(tags.SIDES) if case.sides == "carried" else None,
    )


def _targets(case: Case) -> list[Target]:
    """Return the loads of a case, one after the other."""
    pressed = Target("press", bone_height=-case.indentation)
    loads = [pressed if case.indentation else Target("press", f_ext=case.force)]
    loads += [Target("charge", voltage=case.voltage)] if case.voltage else []
    return loads + ([Target("slide", bone_x=case.slide, until_full_slip=True)] if case.slide else [])


def run(case: Case) -> Outcome:
    """Reach the loads of a case; a failure is an outcome like any other."""
    body, out, jumps = make(case), Outcome(), list[bool]()
    solver = body.solver

    def accepted(target: Target, part: float, attempt: Attempt) -> None:
        state = walk.surface_state
        loads = body.observer.ridge_loads(state)
        out.cutbacks += len(attempt.cutbacks)
        jumps.append(bool(attempt.pseudo_transient))
        out.penetration = float(np.max(-state.y[state.p_n > 0], initial=0.0))
        out.f_ext = float(solver.reaction[1])
        # What the screen exerts on the skin: carried faces bear a part that the bone does not bear.
        out.f_t = float((loads.f_attraction_x - loads.f_friction).sum())
        out.contact_length = float(loads.length.sum())

    walk = Continuation(body.coupling, accepted, step_scale=case.step_scale)
    try:
        for target in _targets(case):
            out.load = target.name
            walk.run(target)
    except StepFailed as failure:
        cause = failure.__cause__
        out.status, out.message = "failed", str(failure)
        out.reason = cause.reason if isinstance(cause, NotConverged) else str(failure)
    else:
        out.status = "continuation" if any(jumps) else "converged"
    out.newton, out.factorisations = solver.counts.newton, solver.counts.factorisations
    out.full_slip = walk.slip[1]
    return out


if __name__ == "__main__":
    limit_processor_time(float(sys.argv[2]))
    print(json.dumps(asdict(run(Case(**json.loads(sys.argv[1]))))))
