"""What moves friction: exact slopes of the default and the fitted finger, beside whole solves, and how smooth they are.

environment/run python3 -m benchmarks.sensitivities     prints them; some 20 minutes

On the final mesh of each run, at full slip, numbers of the scene are changed a little to both sides, and the state is
solved for again as a whole. Answers are kept in ``results/sensitivities``.
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
CASES: dict[str, Any] = {f"default, {volts:g} V": {"voltage": volts} for volts in (0.0, 100.0, 200.0)}
CASES |= {f"fitted, {volts:g} V": {"finger": "fitted", "voltage": volts} for volts in (0.0, 100.0, 200.0)}
CASES |= {"default with a shear stress, 200 V": {"voltage": 200.0, "friction": DERJAGUIN}}
LAYER = "materials.stratum_corneum"
KEYS = (
    "f_ext", "voltage", "friction", "friction.mu_f", "friction.tau_0", "roughness.young", "roughness.h_rms",
    "roughness.wavelength", "electric.d_i", "electric.eps_i", f"{LAYER}.shear_modulus", f"{LAYER}.alpha",
    "materials.dermis.shear_modulus", "contact.eps_n",
)  # fmt: skip
PARTS = (1e-4, 1e-5)  # of a number to both sides; the smaller where points come or go, or slopes differ
VOLTS = (-2.0, -1.0, -0.5, -0.25, 0.25, 0.5, 1.0, 2.0)  # V about the voltage, between which steps are seen
BEHIND = 3e-3  # m, of the anchors of friction, so that no point can stick
NUMERICS = {"tolerance": 1e-12, "coupling_tolerance": 1e-11}
LIMIT = 1800.0  # s of processor time, of each case
_AGREES = 1e-6


def whole(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Return slopes at full slip of a scene's run, those of whole solves, and the friction around its voltage."""
    import fingerpad as fp
    from fingerpad.accuracy import solves

    found: dict[str, Any] = {}

    def compared(model: Any, finger: Any, number: int) -> Any:
        begin = time.process_time()
        slopes = kept_slopes(model, finger, number)
        if not slopes.why:
            found["seconds"], found["unknowns"] = time.process_time() - begin, finger.unknowns
            found.update(_compared(model, finger, number, slopes))
        return slopes

    kept_slopes = solves.state_slopes
    solves.state_slopes = compared  # type: ignore[assignment]
    begin = time.process_time()
    output = {"receptors": False, "sensitivities": True}
    result = fp.run(fp.Scene(**scene, output=output, numerics=NUMERICS))
    rest = time.process_time() - begin - found.get("compared", 0.0)
    rows = result.sensitivities().to_dataframe().reset_index()[["number", "value", "elasticity"]]
    return found | {"run": rest, "rows": rows.to_dict("records"), "mu_app": result.number("full_slip", "mu_app").value}


def _compared(model: Any, finger: Any, number: int, slopes: Any) -> dict[str, Any]:
    """Return what whole solves give, from the present state of a finger, which stays."""
    from fingerpad.model.slopes import numbers_of, quantities_of
    from variational.sensitivity import impose
    from variational.solvers.coupling import AcceptedState

    begin, place = time.process_time(), AcceptedState.of(finger.coupling)
    touching = finger.observer.state().p_n > 0

    def at(key: str, value: float) -> tuple[dict[str, float], int]:
        solver, history = finger.solver, finger.problem.history
        impose(finger.coupling, numbers_of(model.with_number(key, value), finger, number))
        history.accept({"anchor": history.accepted["anchor"] + np.sign(solver.reaction[0]) * BEHIND})
        solver.new_load(replace(solver.control), float(finger.problem.voltage.value), slipping=True, on_cone=False)
        try:
            finger.coupling.solve()
            skin = finger.observer.state()
            return quantities_of(finger, skin, solver.bone), int(((skin.p_n > 0) != touching).sum())
        finally:
            impose(finger.coupling, numbers_of(model, finger, number))
            place.restore(finger.coupling)

    apart = {}
    for key in (key for key in KEYS if slopes.slopes["mu_app"].get(key)):
        value, slope = slopes.values[key], {name: each[key] for name, each in slopes.slopes.items()}
        for part in PARTS:
            (more, came), (less, went) = at(key, value * (1 + part)), at(key, value * (1 - part))
            relative = {
                q: (more[q] - less[q]) / (2 * part * value) / slope[q] - 1 for q in ("mu_app", "contact_length")
            }
            apart[key] = {"part": part, "points": came + went, **relative}
            if abs(relative["mu_app"]) <= _AGREES and not came + went:
                break
        print(key, apart[key], file=sys.stderr, flush=True)
    volts = model.given["voltage"]
    stairs = {step: at("voltage", volts + step)[0]["mu_app"] for step in VOLTS} if volts else {}
    exact = {"exact": slopes.slopes["mu_app"]["voltage"], "stairs": {str(k): mu for k, mu in stairs.items()}}
    return {"apart": apart, "compared": time.process_time() - begin, **exact}


def chords(case: Mapping[str, Any]) -> dict[float, float]:
    """Return the slopes of friction by the voltage between voltages on both sides, by their distance (V)."""
    mu = {float(step): value for step, value in case["stairs"].items()}
    return {step: (mu[step] - mu[-step]) / (2 * step) for step in mu if step > 0}


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
        print(
            f"\n{name}: µ_app {case['mu_app']:.6g}, {case['unknowns']} unknowns; slopes took {case['seconds']:.3g} of "
        )
        print(f"{case['run']:.3g} processor s. Elasticities (% for 1 %), and the relative distance from whole solves:")
        for row in case["rows"]:
            apart = case["apart"].get(row["number"], {})
            words = f"{apart['mu_app']:9.1e} {apart['contact_length']:9.1e}, {apart['points']} points" if apart else ""
            print(f"  {row['number']:42s} {row['elasticity']:10.6f}  {words}")
        if case["stairs"]:
            print(f"  slope by the voltage {case['exact']:.4e} per V; between voltages {chords(case)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
