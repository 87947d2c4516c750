"""One ridge by this package and by the plain dolfinx script at equal error: what each takes, and how far it is off.

The ridge is pressed and moved to full slip, with curved facets for both programs. The script has facets of one length
wherever skin can touch, straight or curved. This package follows the same steps on facets twice as long as a given
size; it solves the pressed state and the last one again on facets of that size, which are a sixteenth where the contact
of the two ends, as a run of a finger does (:mod:`fingerpad.accuracy`).
"""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from benchmarks.peers import ours, plain
from benchmarks.peers.compared import CURVED, OURS, STRAIGHT, values
from benchmarks.peers.exchange import Case, timed
from fingerpad.accuracy.states import contact_ends, edge_places
from geometry.bodies import ridge
from geometry.mesh import TaggedMesh, load
from geometry.parameters import MeshSize
from variational.body import Body
from variational.solvers.state_snapshot import StateSnapshot, take_snapshot
from variational.solvers.transfer import restore

Array = NDArray[np.float64]
STATES = ("pressed 25 µm", "moved 17.5 µm")
SIZES = (20.0, 14.0, 10.0, 7.0, 5.0)  # µm, of this package's facets
UNIFORM = (10.0, 5.0, 3.5, 2.5, 1.8, 1.25, 0.9, 0.625, 0.45)  # µm, of the script's
LIMIT, REPEATS = 0.625, 3  # µm
_UM = 1e-6  # m
_BEHIND = 0.2e-3  # m, how far the anchors of a state of full slip are behind


def case() -> Case:
    """Return the history that is timed on the page, of which the pressed and the last state are reported."""
    loads = timed().loads
    return replace(timed(), loads=tuple(each if each.name in STATES else replace(each, name="") for each in loads))


def uniform(size: float, curved: bool) -> TaggedMesh:
    """Return the ridge with facets of one length (µm)."""
    return load(MPI.COMM_SELF, ridge(size * _UM)) if curved else ours.make(1e-3 * size)


def by_script(case: Case, size: float, curved: bool) -> dict[str, Any]:
    """Return the two states on a uniform mesh by the plain script, and what they took."""
    begun = time.process_time()
    tagged = uniform(size, curved)
    meshed = time.process_time() - begun
    mesh = ours.for_peers(tagged)  # in a form that a script does without
    begun = time.process_time()
    answer = plain.solve(case, mesh)
    seconds = time.process_time() - begun
    states = [[v for k, v in enumerate(values(state, mesh)) if k != 1] for state in answer.states]
    work = {"unknowns": 2 * len(mesh.points), "factorisations": answer.iterations}
    return {"values": states, "seconds": meshed + seconds, **work}


def by_package(case: Case, size: float) -> dict[str, Any]:
    """Return the two states by this package, solved again on a mesh that is finest where their contact ends."""
    begun = time.process_time()
    path = ours.create(case, load(MPI.COMM_SELF, ridge(2 * size * _UM)))
    kept = [take_snapshot(path.coupling, s) for now, s in ours.follow(case, path) if now.name]
    found = [contact_ends(state, lambda places: places[:, 0], 2 * size * _UM) for state in kept]
    places = edge_places([(ends, 2 * size * _UM) for ends in found], MeshSize(contact=size * _UM))
    sharp = ours.create(case, load(MPI.COMM_SELF, ridge(size * _UM, ends=[*places, *(-x for x in places)])))
    states = [_again(sharp, state, name) for state, name in zip(kept, STATES, strict=True)]
    return {
        "values": states,
        "seconds": time.process_time() - begun,
        "unknowns": unknowns(sharp),
        "factorisations": sharp.solver.counts.factorisations,
        "path": {"unknowns": unknowns(path), "factorisations": path.solver.counts.factorisations},
    }


def unknowns(made: Body) -> int:
    """Return the number of displacements."""
    return 2 * int(made.problem.V.dofmap.index_map.size_global)


def _again(sharp: Body, state: StateSnapshot, name: str) -> list[float]:
    """Return the quantities of a state that is solved again on another mesh."""
    slips = name == STATES[1]
    restore(state, sharp.coupling, _BEHIND if slips else 0.0)
    sharp.continuation.re_equilibrate(name)
    s = sharp.continuation.surface_state
    if slips and not sharp.continuation.slip[1]:
        raise RuntimeError(f"{name}: not every point slips")
    length = sharp.observer.ridge_loads(s).length[0]
    return [float(sharp.solver.reaction[1]) / 1e3, float(length) * 1e3 / 2, float(s.p_n.max()) / 1e6]


# -- numbers -------------------------------------------------------------------------------------------------
def numbers() -> dict[str, Any]:
    """Solve everything, programs in turn, and return what the page shows, ready for JSON."""
    history, loads = case(), [os.getloadavg()[0]]
    solves: dict[tuple[str, float], Callable[[], dict[str, Any]]] = {}
    for size in UNIFORM:
        solves[CURVED, size] = partial(by_script, history, size, True)
        solves[STRAIGHT, size] = partial(by_script, history, size, False)
    solves |= {(OURS, size): partial(by_package, history, size) for size in SIZES}
    for program in (CURVED, STRAIGHT):  # forms are compiled, or loaded, once
        solves[program, max(UNIFORM)]()
    coarser, limit = (np.array(by_package(history, size)["values"]) for size in (2 * LIMIT, LIMIT))
    found: dict[tuple[str, float], list[dict[str, Any]]] = {key: [] for key in solves}
    for repeat in range(REPEATS):
        for (program, size), solve in solves.items():
            answer = solve()
            found[program, size].append(answer)
            print(f"repeat {repeat + 1}: {program}, {size:g} µm, {answer['seconds']:.2f} s", flush=True)
        loads.append(os.getloadavg()[0])
    rows = [_row(program, size, answers, limit) for (program, size), answers in found.items()]
    change = np.abs(coarser / limit - 1).max(axis=0).tolist()
    found_by = {"limit_size": LIMIT, "limit": limit.tolist(), "change": change, "repeats": REPEATS}
    return found_by | {"load": [min(loads), max(loads)], "rows": rows}


def _row(program: str, size: float, answers: Sequence[dict[str, Any]], limit: Array) -> dict[str, Any]:
    """Return the least time of a program's repeats, its work, and the larger errors of the two states."""
    errors = np.abs(np.array(answers[0]["values"]) / limit - 1).max(axis=0).tolist()
    work = {key: answers[0][key] for key in ("unknowns", "factorisations", "path") if key in answers[0]}
    return {"program": program, "size": size, "seconds": min(a["seconds"] for a in answers), "errors": errors} | work
