"""The discretisation error of the default scene: what meshes and penalty change, and what the results tend to.

environment/run python3 benchmarks/errors.py [--jobs 2] [--only contact growth receptor penalty check]

The default scene to full slip, with one setting changed at a time. Runs are kept with those of benchmarks/traces.py;
what has been run is written to docs/errors.md, docs/errors.png and, as the reference later work is compared with,
docs/errors.json.
"""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks import arguments
from benchmarks.convergence import Limit, limit
from benchmarks.runs import Run
from fingerpad.accuracy import plus_minus
from fingerpad.reach import by_rule
from fingerpad.scene import Scene, from_data
from fingerpad.sweep import sweep

_LIMIT = 10800.0  # s of processor time for one run; the finest mesh takes far longer than a trace
CONTACT = (20e-6, 10e-6, 5e-6, 2.5e-6)
AT = 10e-6  # m, contact size of the other studies
GROWTH = (0.5, 0.25, 0.125)
RECEPTOR = (40e-6, 20e-6, 10e-6, 5e-6, 2.5e-6)
PENALTY = (0.5e12, 1.5e12, 5e12)
SIZES = ("contact", "growth", "receptor")  # studies of the mesh
FINE = {"contact": 5e-6, "growth": 0.125, "receptor": 10e-6}  # that the sum of the studies is checked with
SITES = (-5, 0, 5)  # ridges whose Merkel sites are looked at: trailing, central and leading ones in contact
QUANTITIES: Mapping[str, tuple[str, float]] = {  # name: what it is, and what its unit is worth
    "press_contact_length": ("contact length, uncharged (mm)", 1e-3),
    "normal_contact_length": ("contact length, normal (mm)", 1e-3),
    "normal_ridges_in_contact": ("ridges, normal", 1),
    "slip_f_t": ("f_T, full slip (N/m)", 1),
    "slip_mu_app": ("µ_app, full slip", 1),
    "slip_contact_length": ("contact length, full slip (mm)", 1e-3),
    "slip_ridges_in_contact": ("ridges, full slip", 1),
} | {f"{state}_sed_{j}": (f"SED at ridge {j}, {words} (J/m³)", 1.0) for state, words in
     (("press", "uncharged"), ("normal", "normal"), ("slip", "full slip")) for j in SITES}  # fmt: skip
_HEADER = """# Discretisation error of the default scene

Made by `environment/run python3 benchmarks/errors.py`; do not edit. The default scene (75 N/m, 200 V, slid to full
slip) with one setting changed at a time; SED is the strain energy density at a Merkel site. The numbers unrounded, with
the scene of each run: [errors.json](errors.json).
"""


_REFERENCE = """## What the results tend to

The limit over the contact size, and what growth and the size at the Merkel sites add on the way to theirs, each at its
default value first. *Predicted* is that sum without extrapolation for contact 5 µm, growth 0.125 and 10 µm at the sites
all at once, *found* the run with these. Error bars are the sum of the studies' and of the difference between the two:
growth and the size at the sites refine the same elements, so that they do not simply add up there.
"""


_LIMITS = """Limits are Richardson's extrapolation from the three finest meshes with Roache's error bar; where their
changes do not shrink with one sign there is no order, the finest value stands, and the bar is three times the larger
of the last two changes (`benchmarks/convergence.py`)."""


def study(name: str) -> dict[float, Scene]:
    """Return the scenes of a study by the value of its setting, from coarse to fine."""
    scenes: dict[str, Any] = {
        "contact": {size: {"mesh": {"contact": size}} for size in CONTACT},
        "growth": {growth: {"mesh": {"contact": AT, "growth": growth}} for growth in GROWTH},
        "receptor": {size: {"mesh": {"contact": AT, "receptor": size}} for size in RECEPTOR},
        "penalty": {eps_n: {"mesh": {"contact": AT}, "contact": {"eps_n": eps_n}} for eps_n in PENALTY},
        "check": {FINE["contact"]: {"mesh": FINE}},
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


def _mesh_studies(out: Path) -> dict[str, dict[float, dict[str, float]]]:
    """Return the studies of the mesh; none of them before all were run."""
    studies = {name: {v: run for v, run in _runs(name, out).items() if run is not None} for name in SIZES}
    return studies if all(len(runs) == len(study(name)) for name, runs in studies.items()) else {}


def reference(out: Path) -> dict[str, Limit]:
    """Return what the quantities tend to as all of the mesh is refined; empty before all of it was run.

    To first order the errors that contact size, growth and the size at the sites leave add up: the limit over one, and
    what each other adds between its default and its limit. By how much they do not is seen on the mesh :data:`FINE`,
    and part of the error bar.
    """
    studies, (fine,) = _mesh_studies(out), _runs("check", out).values()
    if not studies or fine is None:
        return {}
    found = {}
    for quantity in QUANTITIES:
        value, bar = 0.0, abs(predicted(quantity, studies) - fine[quantity])
        for name, runs in studies.items():
            end = limit([run[quantity] for run in runs.values()])
            value += end.value - (0.0 if name == "contact" else runs[getattr(Scene().mesh, name)][quantity])
            bar += end.bar
        found[quantity] = Limit(value, bar, None)
    return found


def predicted(quantity: str, studies: Mapping[str, Mapping[float, Mapping[str, float]]]) -> float:
    """Return what the studies of the mesh add up to for :data:`FINE`."""
    default = {name: getattr(Scene().mesh, name) for name in SIZES}
    changes = (runs[FINE[name]][quantity] - runs[default[name]][quantity] for name, runs in studies.items())
    return studies["contact"][default["contact"]][quantity] + sum(changes)


def _bar(found: Limit, unit: float) -> str:
    return plus_minus(found.value / unit, found.bar / unit) if found.bar else f"{found.value / unit:.5g}"


def _reference_table(out: Path) -> str:
    studies, found, (fine,) = _mesh_studies(out), reference(out), _runs("check", out).values()
    if not found or fine is None:
        return ""
    default = studies["contact"][Scene().mesh.contact]
    lines = ["| | default | limit | default's error | predicted | found |", "|---|---|---|---|---|---|"]
    for quantity, (words, unit) in QUANTITIES.items():
        at, end = default[quantity] / unit, found[quantity]
        cells = [f"{at:.5g}", _bar(end, unit)]
        cells += [f"{100 * (at * unit / end.value - 1):.2g} %", f"{predicted(quantity, studies) / unit:.5g}"]
        cells += [f"{fine[quantity] / unit:.5g}"]
        lines.append(f"| {words} | " + " | ".join(cells) + " |")
    return _REFERENCE + "\n" + "\n".join(lines)


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
    for name in (*STUDIES, "check"):
        scenes, runs = study(name), _runs(name, out)
        data["studies"][name] = [
            {"value": value, "quantities": run, "scene": scenes[value].parameters()}
            for value, run in runs.items()
            if run
        ]
    data["reference"] = {quantity: vars(found) for quantity, found in reference(out).items()}
    (docs / "errors.json").write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    parts = [_HEADER, _reference_table(out), _table("contact", out), _LIMITS]
    if estimate("slip_f_t", _runs("contact", out)):
        draw(out, docs / "errors.png")
        parts.append("![Distance from the limit over the sizes](errors.png)")
    parts += [_table(name, out) for name in list(STUDIES)[1:]]
    (docs / "errors.md").write_text("\n\n".join(filter(None, parts)) + "\n", encoding="utf-8")


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing of the studies asked for and write the page."""
    parser = arguments.parser(__doc__)
    parser.add_argument(
        "--only", nargs="*", choices=[*STUDIES, "check"], default=[*STUDIES, "check"], help="studies to run"
    )
    args = parser.parse_args(given)
    scenes = {f"{name} {value:g}": scene for name in args.only for value, scene in study(name).items()}
    # The finest first: it takes longest.
    summaries = sweep(dict(reversed(scenes.items())), args.out, args.jobs, _LIMIT)
    write(args.out, args.docs)
    failed = [name for name, summary in summaries.items() if "failure" in summary]
    print(f"{len(scenes) - len(failed)} of {len(scenes)} reached their end; {args.docs / 'errors.md'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
