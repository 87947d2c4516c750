"""What moves friction: slopes of the default and the fitted finger, beside whole solves, and how smooth they are.

environment/run python3 -m benchmarks.sensitivities     prints them; some 40 minutes

On the final mesh of each run, at full slip, the state is solved for again as a whole with other numbers. A small change
to both sides, within which no point comes into contact or leaves it, shows the exact slope of the stair. A cubic
through wide changes is what a designer means. Answers are kept in ``results/sensitivities``.
"""

import json
import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.harness import parser, solve

DERJAGUIN = {"law": "Derjaguin", "mu_f": 0.2, "tau_0": 2e3}
CASES: dict[str, Any] = {f"default, {volts:g} V": {"voltage": volts} for volts in (200.0, 100.0, 0.0)}
CASES |= {f"fitted, {volts:g} V": {"finger": "fitted", "voltage": volts} for volts in (200.0, 100.0, 0.0)}
CASES |= {"default, 200 V, elements half as large": {"voltage": 200.0, "mesh": {"contact": 5e-6}}}
CASES |= {"default with a shear stress, 200 V": {"voltage": 200.0, "friction": DERJAGUIN}}
LAYER = "materials.stratum_corneum"
KEYS = (
    "f_ext", "voltage", "friction", "friction.mu_f", "friction.tau_0", "roughness.young", "roughness.h_rms",
    "roughness.wavelength", "electric.d_i", "electric.eps_i", f"{LAYER}.shear_modulus", f"{LAYER}.alpha",
    "materials.dermis.shear_modulus", "geometry.ridge_amplitude", "geometry.sc_thickness",
)  # fmt: skip
PART = 2.5e-6  # of a number to both sides, for exact slopes
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

    apart, wide = {}, {}
    keys = [key for key in KEYS if key in slopes.values and np.all(np.abs(slope(slopes.slopes, key)) > LEAST)]
    for key in keys:
        (more, came), (less, went) = at(key, PART), at(key, -PART)
        relative = np.subtract(more, less) / (2 * PART) / slope(slopes.stairs, key) - 1
        apart[key] = {"points": came + went, **dict(zip(OF, relative.tolist(), strict=True))}
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


def main() -> int:
    """Compute the cases that are missing, and print them; or one case, for :func:`benchmarks.harness.solve`."""
    if len(sys.argv) > 2 and not sys.argv[1].startswith("-"):
        import fingerpad.startup  # noqa: F401

        print(json.dumps(whole(json.loads(sys.argv[1]))))
        return 0
    args = parser(__doc__, "sensitivities").parse_args()
    for name, case in solve("benchmarks.sensitivities", CASES, args.out, args.jobs, LIMIT).items():
        if "failure" in case:
            continue
        cost = f"slopes took {case['seconds']:.3g} of {case['run']:.3g} processor s"
        print(f"\n{name}: µ_app {case['mu_app']:.6g}, {case['unknowns']} unknowns; {cost}.")
        print(
            "Elasticity (% for 1 %); exact slopes of µ_app and the contact length, relative distance from whole solves:"
        )
        for row in case["rows"]:
            apart = case["apart"].get(row["number"], {})
            words = "".join(f" {apart[name]:9.1e}" for name in OF) + f", {apart['points']} points" if apart else ""
            print(f"  {row['number']:42s} {row['elasticity']:10.6f} {words}")
        for key, each in case["wide"].items():
            pairs = zip(OF, each["chord"], each["slope"], each["stair"], strict=True)
            parts = (
                f"{of} {chord:.5g}, slope {a / chord - 1:+.1%}, one stair {b / chord - 1:+.1%}"
                for of, chord, a, b in pairs
            )
            print(f"  between whole solves over ±{4 * WIDE[key]:.1%} of {key}: {'; '.join(parts)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
