"""What the open choices change: readings, parameters and ridge profiles beside the default scene.

environment/run python3 -m benchmarks.assumptions [--jobs 2] [--missing] [--draw]     half an hour of one core

Full runs with errors, most of them at 75 N/m and with 20 um at the Merkel sites, on which friction hardly depends. Each
row of the page is the command of one run; ``--missing`` runs those alone that docs/assumptions.json lacks. Writes
docs/assumptions.json and docs/assumptions.md.
"""

import argparse
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import harness
from benchmarks.paper.friction import within
from benchmarks.runs import Array, Run
from fingerpad.results.quantities import plus_minus
from fingerpad.runs.batch import Summary
from fingerpad.scene import Scene, load
from fingerpad.scene.reading import override
from fingerpad.scene.remarks import coefficient

_MU_0 = coefficient(Scene()) or 0.0
_LIMIT = 3600.0  # s of processor time for one run
PAPER, NEAR, LEAST_GAP = 0.55, 0.05, 1.7e-6  # µ_app, what counts as equal to it; m


def _set(*changes: str) -> str:
    return " ".join(f'--set "{change}"' if " " in change else f"--set {change}" for change in changes)


_COARSE = _set("mesh.receptor=20e-6")
_FLAT = "demos/scenes/flat_ridges.toml"


def scene(command: str) -> Scene:
    """Return the scene of a command's options."""
    words = [word for word in shlex.split(command) if word != "--set"]
    files, changes = ([word for word in words if word.endswith(".toml") is is_file] for is_file in (True, False))
    path = harness.ROOT / files[0] if files else None
    return load(path, dict(map(override, changes)))


# -- full runs, by name: their options ---------------------------------------------------------------------------
READINGS = {
    "finest": "",
    "reference": _COARSE,
    "abaqus": f"demos/scenes/abaqus_exponent.toml {_COARSE}",
    "gap": f"demos/scenes/length_by_gap.toml {_COARSE}",
    "soft": f"demos/scenes/soft_screen.toml {_COARSE}",
}
PARAMETERS = {  # change: in words, if it needs any
    "geometry.ridge_profile=[1, -0.125]": "tips half as curved",
    "geometry.ridge_profile=[1, 0.125]": "one and a half times",
    "roughness.h_rms=3.72e-6": "20 % more",
    "roughness.h_rms=2.48e-6": "20 % less",
    "electric.eps_sc=1320": "20 % less",
    "electric.eps_sc=1980": "20 % more",
    "geometry.sc_thickness=340e-6": "20 % less",
    "geometry.sc_thickness=510e-6": "20 % more",
    "friction=0.2": "",
    "friction=0.3": "",
    "voltage=100": "200 V are read as peak to peak",
}
LITTLE = {
    "geometry.bone_width=6.4e-3": "20 % less",
    "geometry.bone_width=9.6e-3": "20 % more",
    "materials.nail.young=136e6": "20 % less",
    "materials.nail.young=204e6": "20 % more",
    "roughness.p_floor=500": "half",
    "roughness.p_floor=2000": "twice",
    "geometry.merkel_offset=10e-6": "half",
    "geometry.merkel_offset=40e-6": "twice",
}
FLAT = {
    "flat": _FLAT,
    "flat 170": f"{_FLAT} {_COARSE}",
    "flat 200": f"{_FLAT} --set voltage=200 {_COARSE}",
}
STRESS = {75: 12.7e3, 25: 7.9e3}
"""Shear stress on the ridges (Pa), by force (N/m): about the friction of Coulomb's law without voltage."""


def _shear(force: int, voltage: int) -> str:
    law = f"friction={{law='Derjaguin', mu_f=0, tau_0={STRESS[force]}}}"
    return f"{_set(law, f'f_ext={force}', f'voltage={voltage}')} {_COARSE}"


LAWS = {
    "Coulomb 25": f"{_set('f_ext=25')} {_COARSE}",
    **{f"shear {force}{', 0 V' * (not u)}": _shear(force, u) for force in STRESS for u in (200, 0)},
}
COATING = {
    "electric.d_i=0.8e-6 electric.eps_sc=2062.5": "20 % less",
    "electric.d_i=1.2e-6 electric.eps_sc=1375": "20 % more",
}
BESIDE = {
    "flat 0": f"{_FLAT} --set voltage=0 {_COARSE}",
    "both": f"{_set('geometry.ridge_profile=[1, -0.11]')} {_COARSE}",
    "blunt 25": f"{_set('geometry.ridge_profile=[1, -0.125]', 'f_ext=25')} {_COARSE}",
}


def runs() -> dict[str, str]:
    """Return the options of all full runs by name."""
    coatings = {change: f"{_set(*change.split())} {_COARSE}" for change in COATING}
    single = {change: f"{_set(change)} {_COARSE}" for change in (*PARAMETERS, *LITTLE)}
    return {**READINGS, **single, **coatings, **LAWS, **FLAT, **BESIDE}


# -- ridge profiles ------------------------------------------------------------------------------------------
_SHOWN = ("[1]", "[1, 0, -0.11]", "[1, -0.125]", "[1, -0.25]", "[1, -0.48, 0.13]")
_OTHERS = ("[1, -0.0625]", "[1, 0, -0.05]")
LIGHT = ("flat, 10 N/m, 200 V", "flat, 10 N/m, 0 V")
_BY_VOLTAGE = {"[1, -0.25]": (150, 165), "[1, -0.48, 0.13]": (165, 170, 172)}


def _profile(profile: str, voltage: float, *more: str) -> str:
    wide = ["mesh.touching_fraction=0.6"] * (profile.count(",") > 1)
    return f"{_set(f'geometry.ridge_profile={profile}', f'voltage={voltage:g}', *more)} {_COARSE} {_set(*wide)}".strip()


def profiles() -> dict[str, str]:
    """Return the options of the runs of ridge profiles: at 200 V and other voltages, the flat one at 10 N/m."""
    pairs = [(profile, 200) for profile in (*_SHOWN, *_OTHERS)]
    pairs += [(profile, u) for profile, voltages in _BY_VOLTAGE.items() for u in voltages]
    light = {name: _profile(_SHOWN[-1], u, "f_ext=10") for name, u in zip(LIGHT, (200.0, 0.0), strict=True)}
    return {f"{profile} at {u} V": _profile(profile, u) for profile, u in pairs} | light


# -- numbers -------------------------------------------------------------------------------------------------
_KEYS = ("mu_app", "f_t", "contact_length")


def _row(summary: Summary) -> dict[str, float | None]:
    """Return the numbers of a summary at full slip, of the whole finger µ_app, and the length of normal contact; SI."""
    found = {key: summary[f"full_slip_{key}"] for key in _KEYS}
    whole = (summary.get("finger") or {}).get("states", {}).get("full_slip", {}).get("mu_app")
    more = {"error": summary.get("full_slip_mu_app_error"), "charged": summary["charged_contact_length"]}
    return found | more | {"whole": whole}


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep the numbers."""
    found: dict[str, dict[str, Any]] = {"full": {}, "profiles": {}}
    if args.missing:
        before = harness.kept("assumptions", args.docs)
        found = {key: dict(before.numbers[key]) for key in found}
    scenes = {name: scene(options) for name, options in runs().items() if name not in found["full"]}
    shapes = {name: scene(options) for name, options in profiles().items() if name not in found["profiles"]}
    full, shaped = harness.run(scenes, args, _LIMIT), harness.run(shapes, args, _LIMIT)
    if failed := [name for name, summary in (full | shaped).items() if "failure" in summary]:
        raise SystemExit(f"no numbers are kept: {'; '.join(failed)} failed; the other runs are kept in {args.out}")
    for name, its in scenes.items():
        run = Run(its, args.out)
        gaps = {state: run.final(state, "ridges")["d_eq"].tolist() for state in ("charged", "full_slip")}
        found["full"][name] = _row(full[name]) | {"gaps": gaps, "penetration": float(run.steps["penetration"].max())}
    for name, its in shapes.items():
        pressure = shaped[name]["full_slip_f_contact"] / shaped[name]["full_slip_contact_length"]
        more = {"pressure": pressure, "d_eq": float(its.closure()(pressure).d_eq)}
        found["profiles"][name] = _row(shaped[name]) | more
    by = harness.made([*full.values(), *shaped.values()])
    if args.missing:
        by = replace(by, commit="", source=", ".join(dict.fromkeys([before.made.source, *by.source.split(", ")])))
    harness.keep("assumptions", found, by, args.docs)


# -- page ----------------------------------------------------------------------------------------------------
def sentences(found: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the page's sentences have of the kept numbers, by their words in the template."""
    rows = found["full"] | found["profiles"]

    def change(name: str, other: str = "reference", key: str = "mu_app") -> float:
        """Return by how much a run differs from another (%)."""
        return float(100 * (rows[name][key] / rows[other][key] - 1))

    def growth(name: str, bare: str | None, key: str = "mu_app") -> float:
        """Return how many times a voltage multiplies friction; without a run without voltage, by Coulomb's law."""
        return float(rows[name][key] / (rows[bare][key] if bare else _MU_0))

    def gaps(name: str) -> Array:
        """Return the air gaps of both states (m)."""
        return np.concatenate([rows[name]["gaps"][state] for state in ("charged", "full_slip")])

    def counts(name: str) -> tuple[int, int, int]:
        """Return how many air gaps are in the paper's range, how many below it, and how many there are."""
        return int(within(gaps(name)).sum()), int((gaps(name) < LEAST_GAP).sum()), len(gaps(name))

    return {
        "rows": rows, "change": change, "growth": growth, "gaps": gaps, "counts": counts,
        "off": lambda name: 100 * (rows[name]["mu_app"] / PAPER - 1),
    }  # fmt: skip


def _span(lengths: Sequence[float]) -> str:
    """Return the least and the largest of lengths (m) in µm, or the only one."""
    return " to ".join(f"{1e6 * each:.2f}" for each in dict.fromkeys((min(lengths), max(lengths))))


def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    names = sentences(harness.kept("assumptions", docs).numbers)
    rows = names["rows"]

    def friction(name: str) -> str:
        row = rows[name]
        return plus_minus(row["mu_app"], row["error"]) if row["error"] else f"{row['mu_app']:.4f}"

    def line(name: str) -> str:
        row = rows[name]
        return f"{friction(name)} | {row.f_t:.2f} | {1e3 * row.contact_length:.3f} | {1e3 * row.charged:.3f}"

    shown = [
        (profile, voltage, rows[f"{profile} at {voltage} V"])
        for profile in _SHOWN
        for voltage in sorted({200, *_BY_VOLTAGE.get(profile, ())}, reverse=True)
    ]
    names |= {"friction": friction, "line": line, "span": _span, "shown": shown, "HALF": next(iter(PARAMETERS))}
    return harness.page(docs, "assumptions", "python3 -m benchmarks.assumptions", globals() | names)


if __name__ == "__main__":
    missing = {"action": "store_true", "help": "run only what docs/assumptions.json lacks"}
    sys.exit(harness.main(__doc__, compute, draw, missing=missing))
