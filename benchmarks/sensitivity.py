"""What the assumptions change: the default scene with one assumption or parameter changed at a time.

environment/run python3 -m benchmarks.sensitivity [--jobs 2] [--draw]     some hours

Friction, contact length, its reduction by sliding, and the energy density at the central Merkel site. Writes
docs/sensitivity.json and docs/sensitivity.md.
"""

import sys
from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from typing import Any

from benchmarks import harness
from benchmarks.runs import Run
from fingerpad.model.check import check
from fingerpad.model.touching import by_rule
from fingerpad.scene import Scene, SceneError, load

_LIMIT = 3600.0  # s of processor time for one run
SIZE = 10e-6  # m, contact size
_POISSON = [f"materials.{layer}.poisson" for layer in ("subcutis", "dermis", "viable_epidermis", "stratum_corneum")]
_DEFAULTS = Scene()


def _scaled(key: str) -> dict[str, dict[str, Any]]:
    """Return a parameter 20 % lower and higher."""
    return {f"{sign} 20 %": {key: attrgetter(key)(_DEFAULTS) * part} for sign, part in (("−", 0.8), ("+", 1.2))}


# What is changed: one or two ways of changing it, each values by key. A ridge with the second coefficient c has 1 + 4 c
# times the curvature at its tip that a sinusoid of its height has.
CHOICES: Mapping[str, Mapping[str, dict[str, Any]]] = {
    "curvature of a ridge's tip": {
        way: {"geometry.ridge_profile": [1.0, c]} for way, c in (("half", -0.125), ("one and a half", 0.125))
    },
    "bone's width": _scaled("geometry.bone_width"),
    "bone's height": _scaled("geometry.bone_height"),
    "nail's thickness": _scaled("geometry.nail_thickness"),
    "thickness of the stratum corneum": _scaled("geometry.sc_thickness"),
    "E_SC of the roughness": _scaled("roughness.young"),
    "h_rms": _scaled("roughness.h_rms"),
    "permittivity of the stratum corneum": _scaled("electric.eps_sc"),
    "friction coefficient µ0": {"0.2": {"friction": 0.2}, "0.3": {"friction": 0.3}},
    "exponent of the stretches": {"+α": {"materials.exponent": "abaqus"}},
    "Poisson's ratio": {f"{value:g}": dict.fromkeys(_POISSON, value) for value in (0.46, 0.49)},
    "p_floor": {"0.5 kPa": {"roughness.p_floor": 500.0}, "2 kPa": {"roughness.p_floor": 2000.0}},
    "length L_R of Eq. 4": {"where y < d_eq": {"contact.length": "gap"}},
    "depth of the Merkel sites": {f"{d * 1e6:g} µm": {"geometry.merkel_offset": d} for d in (10e-6, 40e-6)},
    "200 V read as amplitude": {"peak to peak, 100 V": {"voltage": 100.0}},
}
QUANTITIES = ("µ_app", "contact length", "reduction of it by sliding", "SED at the central site")


def scenes() -> dict[tuple[str, str], Scene]:
    """Return all scenes by choice and way, the default one first.

    Raises:
        SceneError: a changed finger cannot be built; with the choice.
    """
    found = {}
    for choice, ways in {"default": {"": dict[str, Any]()}, **CHOICES}.items():
        for way, changes in ways.items():
            scene = found[choice, way] = by_rule(load(None, {"mesh.contact": SIZE} | changes))
            try:
                check(scene)
            except SceneError as error:
                raise SceneError(f"{choice} {way}: {error}") from None
    return found


def values(run: Run) -> list[float]:
    """Return µ_app, the contact length in charged normal contact (mm), its reduction (%) and the SED (J/m^3)."""
    mu, length, sed = run.steps["mu_app"], run.steps["contact_length"], run.receptors["merkel_sed"]
    reduction = 100 * (1 - length[run.slip] / length[run.normal])
    centre = sed[run.slip, (len(run.receptors["ridge"]) - 1) // 2]
    return [float(value) for value in (mu[run.slip], length[run.normal] * 1e3, reduction, centre)]


def compute(args: Any) -> None:
    """Run what is missing and keep the numbers."""
    wanted = {f"{choice} {way}".strip(): (choice, way, scene) for (choice, way), scene in scenes().items()}
    summaries = harness.run({name: scene for name, (_, _, scene) in wanted.items()}, args, _LIMIT)
    lost = {name: s["failure"] for name, s in summaries.items() if "failure" in s}
    found = [(c, way, values(Run(scene, args.out))) for name, (c, way, scene) in wanted.items() if name not in lost]
    default = found[0][2]
    numbers = {
        "default": default,
        "mesh": {"contact": SIZE, "receptor": _DEFAULTS.mesh.receptor},
        "changes": [{"choice": c, "way": way, "values": v, "base": default} for c, way, v in found[1:]],
        "lost": [f"{name}: {failure}" for name, failure in lost.items()],
    }
    harness.keep("sensitivity", numbers, harness.made(summaries.values()), args.docs)


# -- page ----------------------------------------------------------------------------------------------------
def _changed(change: Mapping[str, Any]) -> list[float]:
    """Return the changes of the quantities: per cent, and percentage points of the reduction."""
    pairs = list(zip(change["values"], change["base"], strict=True))
    return [v - b if k == 2 else 100 * (v / b - 1) for k, (v, b) in enumerate(pairs)]


def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    kept, text = harness.kept("sensitivity", docs), harness.prose("sensitivity")
    numbers, rows = kept.numbers, [(c["choice"], c["way"], _changed(c)) for c in kept.numbers["changes"]]
    most = {choice: max(abs(d[0]) for c, _, d in rows if c == choice) for choice, _, _ in rows}
    rows.sort(key=lambda row: -most[row[0]])
    first = [f"{choice} ({most[choice]:.1f} %)" for choice in list(dict.fromkeys(c for c, _, _ in rows))[:4]]
    none = [choice for choice, change in most.items() if change < 0.05]
    finding = f"The apparent friction depends most on these choices: {', '.join(first)}. "
    finding += f"It does not depend on {', '.join(none)}." if none else ""
    fine = [c["base"][3] for c in numbers["changes"] if c["base"] != numbers["default"]]
    head = ["choice", "changed to", *(f"{q} ({'points' if k == 2 else '%'})" for k, q in enumerate(QUANTITIES))]
    body = ["## Changes", harness.table(head, ([c, way, *(f"{x:+.1f}" for x in d)] for c, way, d in rows))]
    body += [text["fine"].format(fine[0])] * bool(fine) + [f"Not reached: {words}" for words in numbers["lost"]]
    how = text["how"].format(*numbers["default"], **{name: 1e6 * size for name, size in numbers["mesh"].items()})
    path, title, command = docs / "sensitivity.md", "What the assumptions change", "python3 -m benchmarks.sensitivity"
    return harness.page(path, title, finding, how, body, command, kept.made, ["sensitivity"])


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
