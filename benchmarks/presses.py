"""Presses of the fingers by name, and the closed form of flat tips beside the full model.

environment/run python3 -m benchmarks.presses [--draw]     half an hour of processor time, mostly full slip

Makes the presses of the fingers by name that the package has not (``fingerpad/reduced/presses.json``). Full slip of
:data:`FINGERS` is then solved for over :data:`FORCES` and :data:`VOLTAGES`, each state from a neighbour without a path,
and once more on facets that are fine where its contact ends. States that were not found are left out. Writes
docs/presses.json, the errors known of these fingers (``fingerpad/reduced/finger_errors.json``) and a table of
docs/closed_form.md.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import harness
from fingerpad.reduced import press
from fingerpad.reduced.cylinder_errors import PULL
from fingerpad.reduced.cylinders import over_forces
from fingerpad.results.files import replace
from fingerpad.scene import Scene, from_data
from fingerpad.scene.fingers import FINGERS as NAMES

REDUCED = Path(press.__file__).parent
FINGERS = ("fitted", "moist")
FORCES, VOLTAGES = (20.0, 50.0, 100.0, 150.0), (0.0, 100.0, 150.0, 200.0)  # N/m, V
PULLS = (1.2, 3.0, 10.0)
"""Attraction over force up to which an error is known: under a stronger one the finger rolls off."""
MARGIN = 1.2
"""Factor on the largest difference, since few states make an error."""
_KEPT = ("mu_app", "f_t", "f_electrostatic", "contact_length", "ridges_in_contact", "bone_height")
_MESH = {"contact": 20e-6, "receptor": 60e-6, "interface": 120e-6, "growth": 0.5, "touching_fraction": 0.8}
_REACH = 19  # ridges on either side that can touch
Data = dict[str, Any]


def ship() -> None:
    """Put the presses that the package has not into it, from the cache or made now."""
    from fingerpad.runs.press import press as pressed

    file = REDUCED / "presses.json"
    kept = json.loads(file.read_text(encoding="utf-8"))
    for finger in sorted(NAMES, key=lambda name: name not in FINGERS):
        scene = Scene(finger=finger)
        if press.name(scene) not in kept:
            kept[press.name(scene)] = asdict(pressed(scene))
            replace(file, harness.text(kept) + "\n")


def scene_of(finger: str, f_ext: float, voltage: float) -> Scene:
    """Return a scene of the full model."""
    wave = Scene(finger=finger).geometry.ridge_wavelength  # type: ignore[arg-type]
    mesh, quick = _MESH | {"touching_half_arc": _REACH * wave}, {"errors": False, "receptors": False}
    return from_data({"finger": finger, "f_ext": f_ext, "voltage": voltage, "mesh": mesh, "output": quick})


def solve(finger: str, file: Path) -> None:
    """Write full slip of a finger by the full model into a file, which grows beside it until it is whole."""
    from fingerpad.accuracy.solves import StateRecorder, solve_again
    from fingerpad.model.full_slip import Conditions, FullSlips, Solved
    from fingerpad.model.options import FingerModel, by_rule, plan
    from fingerpad.model.simulation import Simulation
    from fingerpad.startup import MPI
    from variational.solvers.continuation import StepFailed

    options = plan(scene_of(finger, FORCES[0], VOLTAGES[-1]))

    def model(f_ext: float, voltage: float) -> FingerModel:
        return FingerModel(by_rule(scene_of(finger, f_ext, voltage)), options)

    first = model(FORCES[0], 0.0)
    simulation = Simulation(first, MPI.COMM_WORLD)
    if simulation.run() is not None:
        raise RuntimeError("the path asks for another mesh")
    slips, recorder, found = FullSlips(simulation), StateRecorder(simulation), list[Data]()
    known: dict[tuple[float, float], Solved] = {}

    def keep(at: tuple[float, float], state: Solved) -> None:
        known[at] = state
        recorder.keep("full_slip")
        try:
            fine = solve_again(model(*at), recorder.states, MPI.COMM_WORLD).states["full_slip"].state
        except StepFailed:
            return
        found.append({"f_ext": at[0], "voltage": at[1]} | {key: getattr(fine, key) for key in _KEPT})
        replace(file.with_suffix(".part"), json.dumps(found) + "\n")
        print(f"{finger} {at[0]:g} N/m {at[1]:g} V: {fine.mu_app:.4f}", flush=True)

    keep((FORCES[0], 0.0), slips.first(Conditions.of(first)))
    for voltage in VOLTAGES:
        for k, f_ext in enumerate(FORCES):
            at, below = (f_ext, voltage), VOLTAGES[VOLTAGES.index(voltage) - 1]
            starts = [(f_ext, below)] if voltage else [(FORCES[k - 1], voltage)]
            for start in starts if at not in known else ():
                if start in known:
                    try:
                        keep(at, slips.reach(Conditions.of(model(*at)), known[start]))
                        break
                    except StepFailed as error:
                        simulation.restart = None
                        print(f"{finger} {f_ext:g} N/m {voltage:g} V: {error}", flush=True)
    file.with_suffix(".part").rename(file)


def compute(args: argparse.Namespace) -> None:
    """Make what is missing and keep the numbers."""
    import fingerpad.startup  # noqa: F401

    args.out.mkdir(parents=True, exist_ok=True)
    numbers = {}
    for finger in FINGERS:
        file = args.out / f"press_{finger}.json"
        if not file.exists():
            solve(finger, file)
        states = json.loads(file.read_text(encoding="utf-8"))
        numbers[finger] = [{k: float(f"{v:.6g}") for k, v in each.items()} for each in states]
    ship()
    harness.keep("presses", numbers, harness.made(), args.docs)
    replace(REDUCED / "finger_errors.json", harness.text(regions(numbers)) + "\n")


# -- beside the closed form ------------------------------------------------------------------------------------
def closed(finger: str, each: Mapping[str, Any]) -> Any:
    """Return full slip by the closed form."""
    scene = scene_of(finger, each["f_ext"], each["voltage"])
    return over_forces(scene, [each["f_ext"]], "full_slip")[0]


def errors(finger: str, states: Sequence[Mapping[str, Any]]) -> Iterator[Data]:
    """Yield states with the full model's values over those of the closed form, less 1."""
    for each in states:
        found = closed(finger, each)
        off = {key: each[key] / getattr(found, key) - 1 for key in ("mu_app", "contact_length")}
        off |= {"f_electrostatic": each["f_electrostatic"] / found.f_electrostatic - 1 if each["voltage"] else 0.0}
        yield {**each, "closed": found, "off": off, PULL: found.f_electrostatic / each["f_ext"]}


def regions(numbers: Mapping[str, Sequence[Mapping[str, Any]]]) -> list[Data]:
    """Return the errors that the program has of these fingers: :class:`fingerpad.reduced.cylinder_errors.Region`."""
    found = []
    for finger, states in numbers.items():
        every = [*errors(finger, states)]
        for pull in PULLS:
            some = [each for each in every if each[PULL] <= pull]
            most = {
                key: float(np.ceil(1e3 * MARGIN * max(abs(each["off"][key]) for each in some)) / 1e3)
                for key in ("f_electrostatic", "contact_length")
            }
            ends = (("f_ext", FORCES), ("voltage", VOLTAGES), (PULL, (0.0, max(each[PULL] for each in some))))
            ranges = {key: (float(values[0]), float(f"{values[-1]:.3g}")) for key, values in ends}
            found.append({"runs": len(some), "ranges": ranges, "errors": {"full_slip": most}, "finger": finger})
    return found


def draw(docs: Path) -> Path:
    """Put the numbers in place in docs/closed_form.md."""
    numbers = harness.kept("presses", docs).numbers
    every = {finger: [*errors(finger, states)] for finger, states in numbers.items()}

    def at(finger: str, f_ext: float) -> list[float | None]:
        there = {
            each["voltage"]: 100 / (1 + each["off"]["mu_app"]) - 100 for each in every[finger] if each["f_ext"] == f_ext
        }
        return [there.get(voltage) for voltage in VOLTAGES]

    def worst(finger: str) -> float:
        return max(abs(value) for f_ext in FORCES for value in at(finger, f_ext) if value is not None)

    names = {"every": every, "at": at, "worst": worst}
    return harness.page(docs, "presses", "python3 -m benchmarks.presses", globals() | names)


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
