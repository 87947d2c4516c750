"""Viscous skin: how the force of a held finger relaxes, energy of random histories, friction after a step of voltage.

environment/run python3 -m benchmarks.viscosity [--draw]     also: make viscosity

Writes docs/viscosity.json, and from it docs/laws.md and its picture; some 25 minutes, a line for each part done.
"""

import argparse
import sys
import time
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.harness import ROOT, keep, kept, made, main, page, picture
from fingerpad.results.pictures import style
from fingerpad.scene import Scene
from fingerpad.scene.materials import LAYERS
from fingerpad.scene.viscosity import PRESETS

SOFT = [name for name in LAYERS if not name.startswith("nail")]
TIMES = (4e-3, 70e-3, 1.4)  # s, of the force of a pressed fingerpad (Pawluk and Howe 1999)
DEPTH, HOLD = -0.7e-3, 10.0  # m, s
COARSE = {"contact": 60e-6, "receptor": 100e-6, "interface": 200e-6, "growth": 1.0}  # m, but for the growth
FACETS = 10e-6  # m, of the finger under a step of voltage
HISTORIES, STEPS = 200, 8  # of each length, and targets in each
LENGTHS = (1e-3, 0.2)  # s
SPEEDS = (20e-3, 100e-3)  # m/s
PIECES, PIECE = 25, 1e-6  # loads with which sliding begins after the step of voltage, and the way of each (m)
LATE = 50e-3  # s after the step of voltage
NO_OUTPUT = {"receptors": False, "errors": False}


def compute(args: argparse.Namespace) -> None:
    """Compute and keep the numbers."""
    import fingerpad.startup  # noqa: F401

    numbers = {}
    for name, part in {
        "held": _held,
        "energy": _energy,
        "steps": _voltage_steps,
    }.items():
        _say(name)
        numbers[name] = part()
    keep("viscosity", numbers, made(), args.docs)


def _say(what: str) -> None:
    """Print what is computed now, with the processor time so far."""
    print(f"{time.process_time():5.0f} s  {what}", flush=True)


def _states(scene: Scene) -> list[Any]:
    """Return the states of the path of a scene."""
    from fingerpad.model.options import FingerModel, by_rule, plan
    from fingerpad.model.simulation import Simulation
    from fingerpad.startup import MPI

    asked = by_rule(scene)
    path = Simulation(FingerModel(asked, plan(asked)), MPI.COMM_SELF)
    restart = path.run()
    while restart is not None:
        path = Simulation(restart.model, MPI.COMM_SELF)
        restart = path.run()
    return path.states


def _layers(preset: str | None) -> dict[str, Any]:
    return {} if preset is None else {name: {"viscosity": {"preset": preset}} for name in SOFT}


def _held() -> dict[str, Any]:
    """Return the force of a finger at a held depth, over its last one, and the three exponentials that it is."""
    from scipy.optimize import least_squares

    press = {"name": "press", "bone_height": DEPTH}
    history = [press, press | {"name": "hold", "duration": HOLD}]
    scene = Scene(mesh=COARSE, output=NO_OUTPUT, friction=0.0, materials=_layers("fingerpad"), history=history)
    states = _states(scene)
    begin = [state for state in states if state.load == "press"][-1]
    t = np.array([0.0, *(state.time for state in states if state.load == "hold")])
    F = np.array([begin.f_ext, *(state.f_ext for state in states if state.load == "hold")])

    def off(x: np.ndarray) -> np.ndarray:
        return np.asarray(x[0] * (1 + sum(np.exp(x[1 + k] - t / np.exp(x[4 + k])) for k in range(3))) / F - 1)

    found = least_squares(off, [F[-1], *np.log([0.4] * 3), *np.log(TIMES)], xtol=1e-14, ftol=1e-14)
    x, law = found.x, PRESETS["fingerpad"]
    return {
        "time": t.tolist(),
        "force": (F / x[0]).tolist(),
        "law": (law.relaxation(t) / law.relaxation(np.inf)).tolist(),
        "at_once": F[0] / x[0],
        "weights": np.exp(x[1:4]).tolist(),
        "times": np.exp(x[4:]).tolist(),
        "fit": float(np.abs(found.fun).max()),
    }


def _energy() -> list[dict[str, float]]:
    """Return what random histories of each length leave over."""
    body = _ridge()
    return [_left_over(body, seconds) for seconds in LENGTHS]


def _left_over(body: Any, seconds: float) -> dict[str, float]:
    """Return what is left over in the steps of random histories, over what is stored, and the least dissipation."""
    from fingerpad.model.state import least_dissipation
    from variational.energy import Balance, EnergyBook
    from variational.solvers.continuation import Target

    left, least = list[float](), list[float]()
    path = body.continuation
    place, found = path.place(), list[Balance]()

    def now() -> tuple[Any, ...]:
        return path.surface_state, body.solver.bone, body.solver.reaction, body.coupling.d_eq

    for seed in range(HISTORIES):
        if seed % 20 == 0:
            _say(f"{seed} of {HISTORIES} histories of {seconds:g} s")
        path.go_to(place)
        book, found = EnergyBook(body.problem, *now()), []

        def accepted(target: Any, part: float, attempt: Any, book: Any = book, found: Any = found) -> None:
            found.append(book.step(*now()))
            least.append(least_dissipation(path))

        path.on_accept = accepted
        sines, w = np.random.default_rng(seed).uniform(-1, 1, (3, 3)), 2 * np.pi * np.arange(1, 4)
        for k in range(STEPS):
            f, U, x = np.sin(w * (k + 1) * seconds / STEPS) @ sines.T
            at = {"f_ext": 4.0 * (1 + 0.1 * f), "voltage": 60 * (1 + 0.3 * U), "bone_x": 20e-6 * x}
            path.run(Target("random", **at, duration=seconds / STEPS))
        left += [abs(each.released) / each.stored for each in found]
    path.go_to(place)
    return {"steps": len(left), "median": float(np.median(left)), "most": max(left), "least": min(least)}


def _ridge() -> Any:
    """Return a charged, viscous ridge under friction, pressed by 4 N/m."""
    from fingerpad.startup import MPI
    from geometry import tags
    from geometry.bodies import ridge
    from geometry.mesh import load
    from variational.body import Body
    from variational.contact.interface import Interface
    from variational.contact.penalty import Penalty
    from variational.materials.ogden import Ogden
    from variational.materials.viscoelastic import Viscoelastic
    from variational.roughness.bam import BearingArea
    from variational.solvers.continuation import Target

    solids = {tags.STRATUM_CORNEUM: Viscoelastic(Ogden(86.76e3, -14.53), PRESETS["skin, mouse"])}
    laws = Interface(Penalty(), 0.3, 0.5e-6), BearingArea(0.5e-6)
    mesh = load(MPI.COMM_SELF, ridge(30e-6))
    found = Body(mesh, solids, *laws, tolerance=1e-10, coupling_tolerance=1e-10)
    found.continuation.run(Target("press", f_ext=4.0))
    found.continuation.run(Target("charge", voltage=60.0))
    return found


def _voltage_steps() -> dict[str, Any]:
    """Return friction over time after a step of voltage in sliding, over its last one."""
    found = {}
    for preset in (None, "skin, mouse", "fingerpad"):
        for speed in SPEEDS:
            _say(f"{preset or 'elastic'} at {1e3 * speed:g} mm/s")
            found[f"{preset or 'elastic'} at {1e3 * speed:g} mm/s"] = _voltage_step(preset, speed)
    return found


def _voltage_step(preset: str | None, speed: float) -> dict[str, Any]:
    """Return friction after the step, and the sliding way (m) to full slip, which short loads resolve."""
    small = tomllib.loads((ROOT / "demos/scenes/small_finger.toml").read_text(encoding="utf-8"))
    history = [
        {"name": "press", "f_ext": 1.0},
        {"name": "rest", "f_ext": 1.0, "duration": 10.0},
        {"name": "slide", "bone_x_by": 1e-3, "speed": speed},
        {"name": "charge", "voltage": 100.0},
        *({"name": f"on {k}", "bone_x_by": PIECE, "speed": speed} for k in range(PIECES)),
        {"name": "on", "bone_x_by": LATE * speed - PIECES * PIECE, "speed": speed},
    ]
    scene = Scene(
        geometry=small["geometry"], mesh=small["mesh"] | {"contact": FACETS}, output=NO_OUTPUT,
        materials=_layers(preset), history=history, numerics={"step_scale": 0.5},
    )  # fmt: skip
    states = _states(scene)
    before = [state for state in states if state.load == "slide"][-1]
    at_once = [state for state in states if state.load == "charge"][-1]
    after = [state for state in states if state.load.startswith("on")]
    last = float(after[-1].f_t)
    t = [0.0, *(state.time - at_once.time for state in after)]
    f = np.array([at_once.f_t, *(state.f_t for state in after)])
    rise = (f - before.f_t) / (last - before.f_t)
    slips = 1 + next(k for k, state in enumerate(after) if state.all_slip)
    return {
        "time": t, "rise": rise.tolist(), "from": before.f_t, "to": last,
        "way": t[slips] * speed, "way_before": t[slips - 1] * speed, "rise_at_slip": rise[slips],
    }  # fmt: skip


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Write docs/laws.md and its picture from docs/viscosity.json."""
    picture(docs / "viscosity.png", (10, 4), lambda figure: _paint(figure, kept("viscosity", docs).numbers))
    return page(docs, "viscosity", "make viscosity", globals())


def _paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    held, steps = figure.subplots(1, 2)
    found = numbers["held"]
    t = np.array(found["time"])[1:]
    held.semilogx(t, found["force"][1:], color=style.BLUE, marker="o", ms=3, label="force of the finger")
    held.semilogx(t, found["law"][1:], color=style.BLACK, ls=":", label="relaxation of its layers")
    for tau in TIMES:
        held.axvline(tau, color=style.VERMILION, lw=0.8, ls="--")
    held.set(xlabel="time since the press (s)", ylabel="over the lasting value (–)")
    held.set_title("A  held at a depth of 0.7 mm")
    held.legend(loc="upper right", framealpha=1.0)
    colours = {"elastic": style.BLACK, "skin, mouse": style.GREEN, "fingerpad": style.BLUE}
    for name, each in numbers["steps"].items():
        preset, _, speed = name.partition(" at ")
        dash = "-" if speed.startswith("20 ") else "--"
        t = 1e3 * np.array(each["time"])[1:]
        steps.semilogx(t, each["rise"][1:], color=colours[preset], ls=dash, label=name)
    steps.set(xlabel="time since the step of voltage (ms)", ylabel="rise of friction, over that after 50 ms (–)")
    steps.set_title("B  voltage switched on in sliding")
    steps.legend(fontsize=7)
    for ax in (held, steps):
        ax.grid(alpha=0.3)


if __name__ == "__main__":
    sys.exit(main(__doc__, compute, draw))
