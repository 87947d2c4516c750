"""The discretisation error of the default scene: what meshes and penalty change, and what the results tend to.

environment/run python3 benchmarks/errors.py [--jobs 2] [--only contact growth receptor penalty reference]

The default scene to full slip, with one setting changed at a time, and its limit: its states solved again on meshes
with all sizes halved together (benchmarks/limits.py). Runs are kept with those of benchmarks/traces.py; what has been
run is written to docs/errors.md, docs/errors.png and, as the reference later work is compared with, docs/errors.json.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks import arguments, limits
from benchmarks.convergence import Limit, limit
from benchmarks.runs import Run
from benchmarks.traces import SITES as AT_SITES
from fingerpad.io.files import replace, replace_json
from fingerpad.io.states import WORDS
from fingerpad.model.touching import by_rule
from fingerpad.richardson import plus_minus
from fingerpad.runs.batch import sweep
from fingerpad.scene import Scene, from_data

_LIMIT = 10800.0  # s of processor time for one run; the finest mesh takes far longer than a trace
CONTACT = (20e-6, 10e-6, 5e-6, 2.5e-6)
AT = 10e-6  # m, contact size of the other studies
GROWTH = (0.5, 0.25, 0.125)
RECEPTOR = (40e-6, 20e-6, 10e-6, 5e-6, 2.5e-6)
PENALTY = (0.5e12, 1.5e12, 5e12)
SIZES = ("contact", "growth", "receptor")  # studies of the mesh
LEVELS = 4  # meshes of the reference
DEFAULT = by_rule(Scene())
SITES = (-5, 0, 5)  # ridges whose Merkel sites are looked at: trailing, central and leading ones in contact
QUANTITIES: Mapping[str, tuple[str, float]] = {  # name: what it is, and what its unit is worth
    "press_contact_length": (f"contact length, {WORDS['uncharged']} (mm)", 1e-3),
    "normal_contact_length": (f"contact length, {WORDS['charged']} (mm)", 1e-3),
    "normal_ridges_in_contact": (f"ridges, {WORDS['charged']}", 1),
    "slip_f_t": ("f_T, full slip (N/m)", 1),
    "slip_mu_app": ("µ_app, full slip", 1),
    "slip_contact_length": ("contact length, full slip (mm)", 1e-3),
    "slip_ridges_in_contact": ("ridges, full slip", 1),
} | {
    f"{state}_sed_{j}": (f"SED at ridge {j}, {WORDS[name]} (J/m³)", 1.0)
    for state, name in (("press", "uncharged"), ("normal", "charged"), ("slip", "full_slip"))
    for j in SITES
}
_HEADER = """# Discretisation error of the default scene

Made by `environment/run python3 benchmarks/errors.py`; do not edit. The default scene (75 N/m, 200 V, slid to full
slip) with one setting changed at a time; SED is the strain energy density at a Merkel site. The numbers unrounded, with
the scene of each run: [errors.json](errors.json).
"""


_REFERENCE = """## What the results tend to

The default scene's states, solved again on meshes of which each has half of all sizes of the one before: contact,
growth, sites and junctions {first} on the first. *Solved again* is the same on the default mesh, from a path followed
on a coarse one, beside the whole run there: full slip knows no path, and what normal contact keeps of the coarse one is
in its error bar. {costs}
"""


_LIMITS = """Limits are Richardson's extrapolation from the three finest meshes with Roache's error bar. An order
above 2 is taken for an accident of the last change and counts as 2. Where there is no order, since changes hardly
shrink (an order below a half) or not with one sign, the finest value stands, and the bar is three times the last change
if they shrink from side to side, else the larger of the last two (`benchmarks/convergence.py`)."""


def study(name: str) -> dict[float, Scene]:
    """Return the scenes of a study by the value of its setting, from coarse to fine."""
    scenes: dict[str, Any] = {
        "contact": {size: {"mesh": {"contact": size, "receptor": AT_SITES}} for size in CONTACT},
        "growth": {growth: {"mesh": {"contact": AT, "growth": growth, "receptor": AT_SITES}} for growth in GROWTH},
        "receptor": {size: {"mesh": {"contact": AT, "receptor": size}} for size in RECEPTOR},
        "penalty": {
            eps_n: {"mesh": {"contact": AT, "receptor": AT_SITES}, "contact": {"eps_n": eps_n}} for eps_n in PENALTY
        },
    }
    return {value: by_rule(from_data(data)) for value, data in scenes[name].items()}


STUDIES = {  # name: heading, the setting's unit
    "contact": ("Contact size, all else as by default", 1e-6, "µm"),
    "growth": (f"Growth of the elements, at a contact size of {AT * 1e6:g} µm", 1.0, ""),
    "receptor": (f"Size at the Merkel sites, at a contact size of {AT * 1e6:g} µm", 1e-6, "µm"),
    "penalty": (f"Penalty stiffness, at a contact size of {AT * 1e6:g} µm", 1e9, "MPa/mm"),
}


def values(scene: Scene, out: Path) -> dict[str, float] | None:
    """Return the quantities of a scene that was run to full slip, None of another."""
    try:
        run = Run(scene, out)
    except FileNotFoundError:
        return None
    if not run.summary["full_slip"]:
        return None
    found = {name: float(run.summary[name]) for name in QUANTITIES if name in run.summary}
    found["press_contact_length"] = float(run.steps["contact_length"][run.pressed])
    for state, row in (("press", run.pressed), ("normal", run.normal), ("slip", run.slip)):
        sed = dict(zip(run.receptors["ridge"], run.receptors["merkel_sed"][row], strict=True))
        found |= {f"{state}_sed_{j}": float(sed[j]) for j in SITES}
    return found | {name: float(run.summary[name]) for name in ("unknowns", "factorisations")}


def _runs(name: str, out: Path) -> dict[float, dict[str, float] | None]:
    return {value: values(scene, out) for value, scene in study(name).items()}


def folder_of_limits(out: Path) -> Path:
    """Return where the states solved again are kept, beside a folder of runs."""
    return out.parent / "limits"


def reference(out: Path) -> dict[str, Limit]:
    """Return what the quantities tend to as all of the mesh is refined; empty before it was run.

    The error bar is that of the extrapolation and what the path on a coarse mesh changes on the default one.
    """
    found, whole = limits.kept(DEFAULT, LEVELS, folder_of_limits(out)), values(DEFAULT, out)
    if found is None or whole is None:
        return {}
    ends = limits.limits(found)
    path = {name: abs(found["own"]["values"][name] - whole[name]) for name in QUANTITIES}
    return {name: Limit(ends[name].value, ends[name].bar + path[name], ends[name].order) for name in QUANTITIES}


def _bar(found: Limit, unit: float) -> str:
    return plus_minus(found.value / unit, found.bar / unit) if found.bar else f"{found.value / unit:.5g}"


def _reference_table(out: Path) -> str:
    ends, found, whole = reference(out), limits.kept(DEFAULT, LEVELS, folder_of_limits(out)), values(DEFAULT, out)
    if not ends or found is None or whole is None:
        return ""
    meshes = [level["mesh"]["contact"] for level in found["levels"]]
    columns = ["default", "solved again", *(f"{size * 1e6:.3g} µm" for size in meshes), "limit", "order"]
    lines = ["| | " + " | ".join([*columns, "default's error"]) + " |", "|---" * (len(columns) + 2) + "|"]
    for quantity, (words, unit) in QUANTITIES.items():
        end, again = ends[quantity], [found["own"], *found["levels"]]
        cells = [f"{value / unit:.5g}" for value in (whole[quantity], *(s["values"][quantity] for s in again))]
        cells += [_bar(end, unit), "–" if end.order is None else f"{end.order:.1f}"]
        cells += [f"{100 * (whole[quantity] / end.value - 1):.2g} %"]
        lines.append(f"| {words} | " + " | ".join(cells) + " |")
    for count in ("unknowns", "factorisations"):
        cells = [f"{s[count]}" for s in (found["own"], *found["levels"])]
        lines.append(f"| {count} | {whole[count]:.0f} | " + " | ".join([*cells, "", "", ""]) + " |")
    m = found["levels"][0]["mesh"]
    sizes = [f"{m[name] * 1e6:g} µm" for name in ("contact", "receptor", "interface")]
    first = f"{sizes[0]}, {m['growth']:g}, {sizes[1]} and {sizes[2]}"
    path = found["path"]
    apart = abs(found["own"]["values"]["slip_f_t"] / whole["slip_f_t"] - 1)
    costs = f"Followed and solved again, f_T differs by {apart:.1g} of itself. "
    costs += f"The coarse path took {path['factorisations']} factorisations of {path['unknowns']} unknowns."
    return _REFERENCE.format(first=first, costs=costs) + "\n" + "\n".join(lines)


def _cells(name: str, runs: Mapping[float, dict[str, float] | None], unit: float) -> list[str]:
    return ["–" if run is None else f"{run[name] / unit:.5g}" for run in runs.values()]


def estimate(name: str, runs: Mapping[float, dict[str, float] | None]) -> Limit | None:
    """Return a quantity's limit; None before all meshes were run."""
    found = [run[name] for run in runs.values() if run is not None]
    return limit(found) if len(found) == len(runs) else None


def _table(name: str, out: Path) -> str:
    heading, size, size_unit = STUDIES[name]
    runs = _runs(name, out)
    extrapolates = name in SIZES
    head = ["", *(f"{value / size:g} {size_unit}".strip() for value in runs)]
    head += ["limit", "order"] if extrapolates else ["largest difference"]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for quantity, (words, unit) in QUANTITIES.items():
        cells = _cells(quantity, runs, unit)
        found = estimate(quantity, runs)
        present = [run[quantity] for run in runs.values() if run is not None]
        if not extrapolates:
            cells.append(f"{100 * (max(present) / min(present) - 1):.2g} %" if len(present) > 1 else "–")
        elif found is None:
            cells += ["–", "–"]
        else:
            cells.append(_bar(found, unit))
            cells += ["–" if found.order is None else f"{found.order:.1f}"]
        lines.append(f"| {words} | " + " | ".join(cells) + " |")
    for count in ("unknowns", "factorisations"):
        lines.append(f"| {count} | " + " | ".join([*_cells(count, runs, 1), *[""] * (1 + extrapolates)]) + " |")
    return f"## {heading}\n\n" + "\n".join(lines)


def draw(out: Path, path: Path) -> None:
    """Draw the distance from the limit: forces and lengths over the contact size, SED over the size at its sites."""
    figure = Figure(figsize=(7.5, 3.8), layout="constrained")
    groups = {
        "contact": ("slip_f_t", "normal_contact_length", "slip_contact_length"),
        "receptor": tuple(f"slip_sed_{j}" for j in SITES),
    }
    for ax, (study_name, names) in zip(figure.subplots(1, 2), groups.items(), strict=True):
        runs = _runs(study_name, out)
        for k, name in enumerate(names):
            found = estimate(name, runs)
            if found is None:
                continue
            errors = np.array([abs(run[name] / found.value - 1) for run in runs.values() if run is not None])
            errors[errors == 0] = np.nan  # the finest run is the limit
            ax.loglog([1e6 * h for h in runs], errors, "osD"[k] + "-", color=f"C{k}", label=QUANTITIES[name][0])
            ax.axhline(found.bar / found.value, color=f"C{k}", ls=":", lw=1)
        ax.set(xlabel={"contact": "contact size (µm)", "receptor": "size at the Merkel sites (µm)"}[study_name])
        ax.set_xticks([1e6 * h for h in runs], [f"{1e6 * h:g}" for h in runs])
        ax.minorticks_off()
        if ax.has_data():
            ax.legend(fontsize=7)
    figure.supylabel("distance from the limit, relative\n(dotted: the limit's error bar)", fontsize=9)
    figure.savefig(path, dpi=110)


def write(out: Path, docs: Path) -> None:
    """Write page, picture and data from what has been run."""
    data: dict[str, Any] = {"made by": "benchmarks/errors.py", "unit": "SI", "studies": {}}
    for name in STUDIES:
        scenes, runs = study(name), _runs(name, out)
        data["studies"][name] = [
            {"value": value, "quantities": run, "scene": scenes[value].parameters()}
            for value, run in runs.items()
            if run
        ]
    data["reference"] = {quantity: vars(found) for quantity, found in reference(out).items()}
    replace_json(docs / "errors.json", data)
    parts = [_HEADER, _reference_table(out), _table("contact", out), _LIMITS]
    if estimate("slip_f_t", _runs("contact", out)):
        draw(out, docs / "errors.png")
        parts.append("![Distance from the limit over the sizes](errors.png)")
    parts += [_table(name, out) for name in list(STUDIES)[1:]]
    replace(docs / "errors.md", "\n\n".join(filter(None, parts)) + "\n")


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing of the studies asked for and write the page."""
    parser = arguments.parser(__doc__)
    parser.add_argument(
        "--only", nargs="*", choices=[*STUDIES, "reference"], default=[*STUDIES, "reference"], help="studies to run"
    )
    args = parser.parse_args(given)
    studies = [name for name in args.only if name in STUDIES]
    scenes = {f"{name} {value:g}": scene for name in studies for value, scene in study(name).items()}
    # The finest first: it takes longest.
    summaries = dict[str, Any](sweep(dict(reversed(scenes.items())), args.out, args.jobs, _LIMIT))
    if "reference" in args.only:
        summaries |= sweep({"default": DEFAULT}, args.out, args.jobs, _LIMIT)
        summaries |= limits.ask_all({"reference": DEFAULT}, LEVELS, folder_of_limits(args.out), 1)
    write(args.out, args.docs)
    failed = [name for name, summary in summaries.items() if "failure" in summary]
    print(f"{len(summaries) - len(failed)} of {len(summaries)} reached their end; {args.docs / 'errors.md'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
