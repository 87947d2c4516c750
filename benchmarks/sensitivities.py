"""What moves friction: slopes of the default and the fitted finger, beside whole solves, and how smooth they are.

environment/run python3 -m benchmarks.sensitivities [--jobs 2] [--draw]     some ten minutes of processor time a case
python3 -m benchmarks.sensitivities CASE LIMIT     JSON of a scene, prints JSON

On the final mesh of each run, at full slip, the state is solved for again as a whole with other numbers. A small change
to both sides, within which no point comes into contact or leaves it, shows the exact slope of the stair. A cubic
through wide changes is what a designer means. Writes docs/sensitivities.json and docs/sensitivities.md.
"""

import argparse
import json
import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import harness

DEFAULT, DRY, HALVED = "default, 200 V", "fitted, 200 V", "default, 200 V, facets half as long"
CASES: dict[str, Any] = {
    DEFAULT: {"voltage": 200.0},
    DRY: {"finger": "fitted", "voltage": 200.0},
    "default, 100 V": {"voltage": 100.0},
    HALVED: {"voltage": 200.0, "mesh": {"contact": 5e-6}},
    "fitted, 100 V": {"finger": "fitted", "voltage": 100.0},
    "default, 0 V": {"voltage": 0.0},
    "fitted, 0 V": {"finger": "fitted", "voltage": 0.0},
}
LAYER = "materials.stratum_corneum"
KEYS = (
    "f_ext", "voltage", "friction", "roughness.young", "roughness.h_rms",
    "roughness.wavelength", "electric.d_i", "electric.eps_i", f"{LAYER}.shear_modulus", f"{LAYER}.alpha",
    "materials.dermis.shear_modulus", "geometry.ridge_amplitude",
    "geometry.ridge_wavelength", "geometry.sc_thickness",
)  # fmt: skip
PART = 2.5e-6  # of a number to both sides, for exact slopes; also twice as much where two do not agree
_AGREES = 1e-6
WIDE = {"voltage": 2e-3, "friction": 2e-3}  # of a number, four times to both sides
BEHIND = 3e-3  # m, of the anchors of friction, so that no point can stick
NUMERICS = {"tolerance": 1e-12, "coupling_tolerance": 1e-11}
LIMIT = 3000.0  # s of processor time, of each case
OF = ("mu_app", "contact_length")
LEAST = 1e-9  # slopes below it are roundoff (m of the contact length)


def whole(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Return slopes at full slip of a scene's run, and those of whole solves."""
    import fingerpad as fp
    from fingerpad.accuracy import solves

    found: dict[str, Any] = {}

    def compared(model: Any, finger: Any, number: int) -> Any:
        begin = time.process_time()
        slopes = of_state(model, finger, number)
        if not slopes.why:
            found["seconds"], found["unknowns"] = time.process_time() - begin, finger.unknowns
            found.update(_compared(model, finger, number, slopes))
            found["compared"] = time.process_time() - begin - found["seconds"]
        return slopes

    of_state = solves.state_slopes
    solves.state_slopes = compared  # type: ignore[assignment]
    begin = time.process_time()
    output = {"receptors": False, "sensitivities": True}
    result = fp.run(fp.Scene(**scene, output=output, numerics=NUMERICS))
    rest = time.process_time() - begin - found.get("compared", 0.0)
    rows = result.sensitivities().to_dataframe().reset_index()[["number", "value", "elasticity"]]
    return found | {"run": rest, "rows": rows.to_dict("records"), "mu_app": result.number("full_slip", "mu_app").value}


def _compared(model: Any, finger: Any, number: int, slopes: Any) -> dict[str, Any]:
    """Return what whole solves give, from the present state of a finger, which stays."""
    from fingerpad.model.slopes import follower, numbers_of, quantities_of
    from variational.numbers import impose
    from variational.solvers.coupling import AcceptedState

    place, places, observer = AcceptedState.of(finger.coupling), follower(finger), finger.observer
    touching = observer.state().p_n > 0

    def at(key: str, part: float) -> tuple[list[float], int]:
        solver, history, value = finger.solver, finger.problem.history, slopes.values[key] * (1 + part)
        impose(finger.coupling, numbers_of(model.with_number(key, value), finger, number, places))
        history.accept({"anchor": history.accepted["anchor"] + np.sign(solver.reaction[0]) * BEHIND})
        solver.new_load(replace(solver.control), float(finger.problem.voltage.value), slipping=True, on_cone=False)
        try:
            finger.coupling.solve()
            skin = observer.state()
            values = quantities_of(finger, skin, observer.ridge_loads(skin), solver.bone)
            return [values[name] for name in OF], int(((skin.p_n > 0) != touching).sum())
        finally:
            impose(finger.coupling, numbers_of(model, finger, number, places))
            place.restore(finger.coupling)

    def slope(of: Any, key: str) -> np.ndarray:
        return np.array([of[name][key] * slopes.values[key] for name in OF])

    def quotient(key: str, part: float) -> tuple[np.ndarray, int]:
        (more, came), (less, went) = at(key, part), at(key, -part)
        return np.subtract(more, less) / (2 * part), came + went

    apart, wide = {}, {}
    keys = [key for key in KEYS if key in slopes.values and np.all(np.abs(slope(slopes.slopes, key)) > LEAST)]
    for key in keys:
        near, points = quotient(key, PART)
        relative = near / slope(slopes.stairs, key) - 1
        if abs(relative[0]) > _AGREES and not points:  # of fourth order, by Richardson's extrapolation
            far, points = quotient(key, 2 * PART)
            relative = (4 * near - far) / 3 / slope(slopes.stairs, key) - 1
        apart[key] = {"points": points, **dict(zip(OF, relative.tolist(), strict=True))}
        print(key, apart[key], file=sys.stderr, flush=True)
    for key in (key for key in WIDE if key in keys):
        parts = WIDE[key] * np.arange(-4, 5)
        values = np.array([at(key, part)[0] for part in parts])
        chord = np.polyfit(parts, values, 3)[2]
        wide[key] = {
            "chord": chord.tolist(),
            "slope": slope(slopes.slopes, key).tolist(),
            "stair": slope(slopes.stairs, key).tolist(),
        }
        print(key, wide[key], file=sys.stderr, flush=True)
    return {"apart": apart, "wide": wide}


def show(elasticity: float) -> str:
    """Return an elasticity for a page; 0 where it is roundoff."""
    return f"{elasticity:.2g}".replace("-", "−") if abs(elasticity) > 1e-9 else "0"


# -- numbers -------------------------------------------------------------------------------------------------
def compute(args: argparse.Namespace) -> None:
    """Solve the cases that are not kept yet, and keep their numbers."""
    found = harness.solve("benchmarks.sensitivities", CASES, args.out, args.jobs, LIMIT)
    harness.keep("sensitivities", {name: found[name] for name in CASES}, harness.made(), args.docs)


def draw(docs: Path) -> Path:
    """Put the numbers in place in docs/sensitivities.md."""
    cases = {name: case for name, case in harness.kept("sensitivities", docs).numbers.items() if "failure" not in case}
    slopes = {name: {row["number"]: row["elasticity"] for row in case["rows"]} for name, case in cases.items()}

    def by(number: str, name: str = DEFAULT) -> float:
        return slopes[name].get(number, 0.0)

    def apart(quantity: str) -> list[float]:
        """Return the relative distances of exact slopes from whole solves in which no point came or went."""
        every = (each for case in cases.values() for each in case["apart"].values())
        return [abs(each[quantity]) for each in every if not each["points"]]

    def wide(name: str, key: str, way: str, quantity: str = "mu_app") -> float:
        """Return by how many per cent a slope is off the one between whole solves over a wide range."""
        each, k = cases[name]["wide"][key], OF.index(quantity)
        return 100 * (each[way][k] / each["chord"][k] - 1)

    order = sorted(slopes[DEFAULT], key=lambda key: -abs(by(key)))
    cost = {name: case["seconds"] / case["run"] for name, case in cases.items()}
    pairs = [(name, key) for name, case in cases.items() for key in case["wide"] if "200" in name]
    finer = [100 * abs(by(key, HALVED) / by(key) - 1) for key in WIDE]
    names = {
        "by": by,
        "apart": apart,
        "wide": wide,
        "order": order,
        "cost": cost,
        "cases": cases,
        "pairs": pairs,
        "finer": finer,
    }
    return harness.page(docs, "sensitivities", "python3 -m benchmarks.sensitivities", globals() | names)


if __name__ == "__main__":
    if len(sys.argv) > 2 and not sys.argv[1].startswith("-"):
        import fingerpad.startup  # noqa: F401

        print(json.dumps(whole(json.loads(sys.argv[1]))))
    else:
        sys.exit(harness.main(__doc__, compute, draw, out="sensitivities"))
