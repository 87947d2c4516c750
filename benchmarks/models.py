"""Which model when: the two reduced models beside full runs, over forces and voltages.

environment/run python3 -m benchmarks.models [--jobs 2] [--draw]     some hours, mostly full runs

The full runs have a contact size of 10 um. Writes docs/models.json, from which the command ``estimate`` has its known
error and ``check`` its rule of the cost, and docs/models.md.
"""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import harness
from benchmarks.runs import FORCES, SITES, VOLTAGES, trace
from fingerpad.io.states import PREFIXES, WORDS
from fingerpad.model.touching import by_rule
from fingerpad.reduced import cylinders
from fingerpad.runs.batch import Summary
from fingerpad.scene import Scene, load
from variational.state import RESULTS

_LIMIT = 3600.0  # s of processor time for one run
SIZE = 10e-6  # m, contact size
MODELS = {"cylinders": "charged cylinders", "smooth": "smooth finger"}
QUANTITIES = {
    "slip_mu_app": f"µ_app, {WORDS['full_slip']}",
    "slip_contact_length": f"contact length, {WORDS['full_slip']}",
    "normal_contact_length": f"contact length, {WORDS['charged']}",
    "normal_f_electrostatic": f"attraction, {WORDS['charged']}",
}
_LAYERS = ("subcutis", "dermis", "viable_epidermis", "stratum_corneum")


# -- numbers -------------------------------------------------------------------------------------------------
def name(f_ext: float, voltage: float) -> str:
    """Return the name of a scene in docs/models.json."""
    return f"{f_ext:g} N/m, {voltage:g} V"


def scenes() -> dict[str, Scene]:
    """Return the scenes by name."""
    return {name(f, u): trace(f, u, SIZE) for f in FORCES for u in VOLTAGES}


def extremes() -> dict[str, Scene]:
    """Return scenes at the ends of the range of use."""
    soft = {layer: {"poisson": 0.499} for layer in _LAYERS}
    unload = load(harness.ROOT / "demos" / "scenes" / "unload.toml", {"mesh.contact": SIZE, "mesh.receptor": SITES})
    return {
        "200 V at 2 N/m": trace(2.0, 200.0, SIZE),
        "friction coefficient 1": trace(75.0, 200.0, SIZE, friction=1.0),
        "Poisson's ratio 0.499": trace(75.0, 200.0, SIZE, materials=soft),
        "400 V at 10 N/m": trace(10.0, 400.0, SIZE),
        "unloaded at 200 V": by_rule(unload),
    }


def answer(summary: Summary) -> dict[str, Any]:
    """Return the numbers of a run or of a reduced model that docs/models.json has."""
    if "failure" in summary:
        return {"failure": summary["failure"]}
    keys = (f"{PREFIXES[state]}_{key}" for state in ("charged", "full_slip") for key in RESULTS)
    found = {"full_slip": summary["full_slip"]} | {key: summary[key] for key in keys if summary[key] is not None}
    cost = {"seconds": summary["processor_seconds"]} | {key: summary[key] for key in ("factorisations", "unknowns")}
    more = {key: summary[key] for key in ("table_version",) if key in summary}
    return {"summary": found, "cost": cost, "more": more}


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep the numbers."""
    wanted, ends = scenes(), extremes()
    full = harness.run(wanted | ends, args, _LIMIT)
    own = argparse.Namespace(**vars(args) | {"out": args.out.parent / "smooth"})
    smooth = harness.run(wanted, own, _LIMIT, "smooth")
    found = {
        key: {
            "cylinders": answer(cylinders.solve(scene).to_dict()),
            "smooth": answer(smooth[key]),
            "full": answer(full[key]),
        }
        for key, scene in wanted.items()
    }
    rows = [
        {"scene": key, "mu_app": full[key].get("slip_mu_app"), "end": full[key].get("failure", "reaches its end")}
        for key in ends
    ]
    harness.keep("models", {"scenes": found, "extremes": rows}, harness.made(full.values()), args.docs)


def error(found: Mapping[str, Any], model: str, key: str) -> float | None:
    """Return a model's relative error against the full run, None where either is not known."""
    own, full = (found.get(each, {}).get("summary", {}).get(key) for each in (model, "full"))
    return None if own is None or not full else own / full - 1


# -- page ----------------------------------------------------------------------------------------------------
_HOW = """Forty scenes of the default finger were pressed to {forces} N/m, charged to {voltages} V and slid to full
slip. Errors are relative to the full model at a contact size of 10 µm and 20 µm at the Merkel sites; the full model's
own errors are in [errors.md](errors.md). Seconds are processor time; those of the kept full runs are wall time on a
shared machine. The smooth finger's table of one ridge takes some seconds more, once for each voltage and friction
coefficient.

The charged cylinders take the uncharged contact length from the full runs at 0 V. Their errors at 0 V are zero by
construction. They miss ridges that jump onto the screen with the voltage: two of thirteen at 25 N/m and 200 V. The
smooth finger uses no full run. It counts ridges by their mean height, which misses some that barely touch."""


def _percents(scenes: Mapping[str, Any], model: str, key: str) -> str:
    """Return the largest error of a model."""
    found = [abs(e) for each in scenes.values() if (e := error(each, model, key)) is not None]
    return f"{100 * max(found):.1f} %" if found else "–"


def _takes(scenes: Mapping[str, Any], model: str) -> str:
    costs = [each[model]["cost"] for each in scenes.values() if "cost" in each.get(model, {})]
    keys = ("seconds", "factorisations", "unknowns")
    seconds, factorisations, unknowns = (float(np.median([c[key] for c in costs])) for key in keys)
    words = f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"
    return f"{words}, {factorisations:.0f} factorisations, {unknowns:.0f} unknowns" if unknowns else words


def _which(scenes: Mapping[str, Any]) -> str:
    """Return the table that chooses a model."""
    head = ["model", "for", "answers", "largest error of µ_app", "of the contact length at full slip", "takes"]
    forces = "forces, friction and contact length"
    rows = [
        ["`cylinders`", "the default finger, or one whose uncharged contact length is known", forces],
        ["`smooth`", "any finger", f"{forces}, height of the bone"],
        ["`full`", "any finger", "everything, receptors too", "–", "–", _takes(scenes, "full")],
    ]
    for row, model in zip(rows, MODELS, strict=False):
        row += [_percents(scenes, model, key) for key in ("slip_mu_app", "slip_contact_length")] + [
            _takes(scenes, model)
        ]
    return harness.table(head, rows)


def _matrix(scenes: Mapping[str, Any], model: str, key: str) -> str:
    """Return a table over force and voltage: errors (%) of a reduced model, or the value of the full one."""
    rows = []
    for f in FORCES:
        cells = []
        for u in VOLTAGES:
            found = scenes.get(name(f, u), {})
            if model == "full":
                cells.append(found["full"]["summary"].get(key) if "summary" in found.get("full", {}) else None)
            else:
                e = error(found, model, key)
                cells.append(None if e is None else f"{1e2 * e:+.1f}")
        rows.append([f"{f:g}", *cells])
    return harness.table(["f_ext (N/m)", *(f"{u:g} V" for u in VOLTAGES)], rows)


def _section(scenes: Mapping[str, Any], model: str) -> list[str]:
    """Return the parts of the page on a reduced model."""
    failed = [key for key, each in scenes.items() if "failure" in each.get(model, {})]
    parts = [f"## Errors of the {MODELS[model]} (`{model}`), in per cent of the full model"]
    parts += [f"No answer at {'; '.join(failed)}."] * bool(failed)
    versions = [
        each[model]["more"].get("table_version", 0) for each in scenes.values() if "more" in each.get(model, {})
    ]
    old = sum(version < max(versions) for version in versions)
    if model == "smooth" and old:
        parts.append(
            f"{old} of the answers are by an older law of one ridge, whose forces fall over 0.5 µm of height when the "
            "ridge lets go (2 µm now)."
        )
    for key, words in QUANTITIES.items():
        text = f"**{words}**\n\n{_matrix(scenes, model, key)}"
        parts.append(text if key == "slip_mu_app" else harness.folded(words, _matrix(scenes, model, key)))
    return parts


def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    kept = harness.kept("models", docs)
    scenes, ends = kept.numbers["scenes"], kept.numbers["extremes"]
    largest = {model: _percents(scenes, model, "slip_mu_app") for model in MODELS}
    full = [each["full"] for each in scenes.values() if "full" in each]
    slips = sum(bool(each.get("summary", {}).get("full_slip")) for each in full)
    finding = (
        "For friction alone the reduced models suffice: the charged cylinders give µ_app within "
        f"{largest['cylinders']} of the full model at once, the smooth finger within {largest['smooth']} in seconds. "
        f"Pressures, air gaps and receptors need the full model, which reached full slip in {slips} of {len(full)} "
        f"scenes.\n\n{_which(scenes)}\n\n"
        "`fingerpad compare scene.toml --model cylinders smooth full` runs them side by side."
    )
    lists = (", ".join(f"{value:g}" for value in each) for each in (FORCES, VOLTAGES))
    body = [part for model in MODELS for part in _section(scenes, model)]
    body += ["## Full runs", f"**{QUANTITIES['slip_mu_app']}**\n\n{_matrix(scenes, 'full', 'slip_mu_app')}"]
    rows = [[row["scene"], row["mu_app"], row["end"]] for row in ends]
    body += ["At the ends of the range of use:", harness.table(["scene", "µ_app, full slip", "end"], rows)]
    how = _HOW.format(**dict(zip(("forces", "voltages"), lists, strict=True)))
    command = "python3 -m benchmarks.models"
    return harness.page(docs / "models.md", "Which model when", finding, how, body, command, kept.made, ["models"])


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
