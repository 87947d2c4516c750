"""What the open choices change: readings, parameters and ridge profiles beside the default scene.

environment/run python3 -m benchmarks.assumptions [--jobs 2] [--draw]     half an hour

Full runs at 75 N/m, most of them at a contact size of 10 um. Each row of the page is the command of one run. Writes
docs/assumptions.json and docs/assumptions.md.
"""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks import harness
from benchmarks.paper.friction import within
from benchmarks.runs import Array, Run
from fingerpad.richardson import plus_minus
from fingerpad.runs.batch import Summary
from fingerpad.scene import Scene, load
from fingerpad.scene.reading import override

_LIMIT = 3600.0  # s of processor time for one run
_SCENES = harness.ROOT / "demos" / "scenes"
_COARSE = ("mesh.contact=10e-6", "mesh.receptor=20e-6")
PAPER, NEAR, LEAST_GAP = 0.55, 0.05, 1.7e-6  # µ_app, what counts as equal to it; m


class Case(NamedTuple):
    """A run by its command: a file of ``demos/scenes``, the changes beside the mesh, the mesh's."""

    file: str = ""
    changes: tuple[str, ...] = ()
    mesh: tuple[str, ...] = _COARSE
    errors: bool = False
    """Whether the row states the estimated error."""

    def scene(self) -> Scene:
        """Return the scene of the command; runs whose errors the page does not state leave them out."""
        changes = (*self.changes, *self.mesh, *([] if self.errors else ["output.errors=false"]))
        path = _SCENES / f"{self.file}.toml" if self.file else None
        return load(path, dict(override(change) for change in changes))


# -- full runs -----------------------------------------------------------------------------------------------
READINGS = {
    "finest": Case(mesh=()),
    "reference": Case(),
    "abaqus": Case("abaqus_exponent"),
    "gap": Case("length_by_gap"),
    "soft": Case("soft_screen"),
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
    "flat": Case("flat_ridges", mesh=(), errors=True),
    "flat 170": Case("flat_ridges", errors=True),
    "flat 200": Case("flat_ridges", ("voltage=200",), errors=True),
}
BESIDE = {"flat 0": Case("flat_ridges", ("voltage=0",)), "both": Case("", ("geometry.ridge_profile=[1, -0.11]",))}


def cases() -> dict[str, Case]:
    """Return all full runs by name."""
    changed = {change: Case("", (change,)) for change in (*PARAMETERS, *LITTLE)}
    return {**READINGS, **changed, **FLAT, **BESIDE}


# -- ridge profiles ------------------------------------------------------------------------------------------
_WIDE = "mesh.touching_fraction=0.6"
_SHOWN = ("[1]", "[1, 0, -0.11]", "[1, -0.125]", "[1, -0.25]", "[1, -0.48, 0.13]")
_OTHERS = ("[1, -0.0625]", "[1, 0, -0.05]")
_BY_VOLTAGE = {"[1, -0.25]": (150, 165), "[1, -0.48, 0.13]": (165, 170, 172)}


def _profile(profile: str, voltage: float, *more: str) -> tuple[str, Case]:
    changes = (f"geometry.ridge_profile={profile}", f"voltage={voltage:g}", *more)
    return f"{profile} at {voltage:g} V", Case("", changes, (*_COARSE, *([_WIDE] if profile.count(",") > 1 else [])))


def profiles() -> dict[str, Case]:
    """Return the runs of ridge profiles by name: at 200 V and other voltages, the flat one at 10 N/m."""
    at_200 = dict(_profile(profile, 200.0) for profile in (*_SHOWN, *_OTHERS))
    others = dict(_profile(profile, u) for profile, voltages in _BY_VOLTAGE.items() for u in voltages)
    light = {f"flat, 10 N/m, {u:g} V": _profile(_SHOWN[-1], u, "f_ext=10")[1] for u in (0.0, 200.0)}
    return at_200 | others | light


# -- numbers -------------------------------------------------------------------------------------------------
_KEYS = ("mu_app", "f_t", "contact_length")


def _row(summary: Summary) -> dict[str, float | None]:
    """Return the numbers of a summary at full slip, and the contact length of normal contact; SI."""
    found = {key: summary[f"full_slip_{key}"] for key in _KEYS}
    return found | {"error": summary.get("full_slip_mu_app_error"), "charged": summary["charged_contact_length"]}


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep the numbers."""
    scenes = {name: case.scene() for name, case in cases().items()}
    shapes = {name: case.scene() for name, case in profiles().items()}
    full, shaped = harness.run(scenes, args, _LIMIT), harness.run(shapes, args, _LIMIT)
    if failed := [name for name, summary in (full | shaped).items() if "failure" in summary]:
        raise SystemExit(f"no numbers are kept: {'; '.join(failed)} failed; the other runs are kept in {args.out}")
    found: dict[str, dict[str, Any]] = {"full": {}, "profiles": {}}
    for name, scene in scenes.items():
        run = Run(scene, args.out)
        gaps = {state: run.on_ridges(run.row(state), "d_eq")[1].tolist() for state in ("charged", "full_slip")}
        found["full"][name] = _row(full[name]) | {"gaps": gaps, "penetration": float(run.steps["penetration"].max())}
    for name, scene in shapes.items():
        pressure = shaped[name]["full_slip_f_contact"] / shaped[name]["full_slip_contact_length"]
        more = {"pressure": pressure, "d_eq": float(scene.closure()(pressure).d_eq)}
        found["profiles"][name] = _row(shaped[name]) | more
    harness.keep("assumptions", found, harness.made([*full.values(), *shaped.values()]), args.docs)


# -- page ----------------------------------------------------------------------------------------------------
_LENGTHS = ("L_R, full slip (mm)", "L_R, normal contact (mm)")
_OF_LENGTHS = ("contact_length", "charged")
_HEAD = ("µ_app", "f_T (N/m)", *_LENGTHS)


def _command(case: Case, mesh: bool = True) -> str:
    """Return the options of a run's command; those of the mesh on demand."""
    words = [f"demos/scenes/{case.file}.toml"] if case.file else []
    for change in (*case.changes, *(case.mesh if mesh else ())):
        words += ["--set", f'"{change}"' if " " in change else change]
    return f"`{' '.join(words)}`" if words else "none"


def _mm(length: float) -> str:
    return f"{1e3 * length:.3f}"


def _micro(*lengths: float) -> str:
    return " to ".join(f"{1e6 * each:.2f}" for each in lengths)


def _friction(row: Mapping[str, Any]) -> str:
    return plus_minus(row["mu_app"], row["error"]) if row["error"] else f"{row['mu_app']:.4f}"


def _lines(full: Mapping[str, Any], named: Mapping[str, str]) -> list[list[str]]:
    """Return a line for each run: its words, friction and lengths."""
    return [
        [words, _friction(full[name]), f"{full[name]['f_t']:.2f}", *(_mm(full[name][key]) for key in _OF_LENGTHS)]
        for name, words in named.items()
    ]


def _changes(full: Mapping[str, Any], changes: Mapping[str, str]) -> str:
    named = {
        change: _command(Case("", (change,)), mesh=False) + (f": {words}" if words else "")
        for change, words in changes.items()
    }
    return harness.table(("option", *_HEAD), _lines(full, {"reference": "none"} | named))


def _profiles(found: Mapping[str, Any]) -> str:
    rows = []
    for profile in _SHOWN:
        for voltage in sorted({200, *_BY_VOLTAGE.get(profile, ())}, reverse=True):
            row = found[f"{profile} at {voltage} V"]
            cells = (f"{row['mu_app']:.3f}", f"{1e3 * row['contact_length']:.2f}", f"{row['pressure'] / 1e3:.0f}")
            rows.append([f"`{profile}`", voltage, *cells, _micro(row["d_eq"])])
    head = ("`ridge_profile`", "U (V)", "µ_app", _LENGTHS[0], "f_c/L_R (kPa)", "d_eq (µm)")
    return harness.table(head, rows)


def _flat(full: Mapping[str, Any]) -> str:
    rows = []
    for name, case in FLAT.items():
        row = full[name]
        gaps = _gaps(row)
        lengths = (_mm(row[key]) for key in _OF_LENGTHS)
        rows.append([_command(case), _friction(row), *lengths, _micro(gaps.min(), gaps.max())])
    return harness.table(("options", "µ_app", *_LENGTHS, "d_eq, both states (µm)"), rows)


def _gaps(row: Mapping[str, Any]) -> Array:
    """Return the air gaps of both states (m)."""
    return np.concatenate([row["gaps"][state] for state in ("charged", "full_slip")])


def _counts(row: Mapping[str, Any]) -> tuple[int, int, int]:
    """Return how many air gaps of both states are in the paper's range, how many below it, and how many there are."""
    gaps = _gaps(row)
    return int(within(gaps).sum()), int((gaps < LEAST_GAP).sum()), len(gaps)


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """Return the numbers in the page's sentences; changes in per cent."""
    full, shaped = found["full"], found["profiles"]

    def change(name: str, other: str = "reference", key: str = "mu_app", of: Mapping[str, Any] = full) -> float:
        return float(100 * (of[name][key] / of[other][key] - 1))

    near = [row for name, row in shaped.items() if name.endswith("200 V") and "flat" not in name]
    close = [row["d_eq"] for row in near if abs(row["mu_app"] / PAPER - 1) <= NEAR]
    gaps, both = _gaps(full["finest"]), full["both"]
    light = "flat, 10 N/m, 200 V", "flat, 10 N/m, 0 V"
    met = [
        float(name.split()[-2])
        for name, row in shaped.items()
        if name.startswith(_SHOWN[-1]) and row["d_eq"] >= LEAST_GAP and abs(row["mu_app"] / PAPER - 1) <= NEAR
    ]
    lowest = _gaps(both)[_gaps(both) < LEAST_GAP]
    return {
        "half": change(next(iter(PARAMETERS))),
        "tops": change("flat 200"),
        "abaqus": -change("abaqus"),
        "abaqus_length": -change("abaqus", key="contact_length"),
        "gap": -change("gap"),
        "soft": change("soft", "gap"),
        "soft_length": change("soft", "gap", "contact_length"),
        "yields": 1e6 * full["soft"]["penetration"],
        "little": max(abs(change(name)) for name in LITTLE),
        "default": full["finest"]["mu_app"],
        "gaps": _micro(gaps.min(), gaps.max()),
        "profiles": len(near),
        "close": len(close),
        "close_gaps": _micro(min(close), max(close)),
        "low": shaped["[1, -0.25] at 150 V"],
        "low_gap": _micro(shaped["[1, -0.25] at 150 V"]["d_eq"]),
        "met_low": min(met),
        "met_high": max(met),
        "flat": _counts(full["flat"]),
        "flat_off": 100 * (full["flat"]["mu_app"] / PAPER - 1),
        "flat_200": _counts(full["flat 200"]),
        "flat_200_off": 100 * (full["flat 200"]["mu_app"] / PAPER - 1),
        "both": both,
        "both_off": 100 * (both["mu_app"] / PAPER - 1),
        "both_gaps": _counts(both),
        "both_range": _micro(lowest.min(), lowest.max()),
        "light_normal": change(*light, "charged", shaped),
        "light_slip": change(*light, "contact_length", shaped),
        "heavy_normal": change("flat 200", "flat 0", "charged"),
        "heavy_slip": change("flat 200", "flat 0", "contact_length"),
    }


def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    kept, text = harness.kept("assumptions", docs), harness.prose("assumptions")
    full, words = kept.numbers["full"], values(kept.numbers)
    readings = {name: _command(case) for name, case in READINGS.items()}
    body = [
        f"## Readings\n\n{harness.table(('options', *_HEAD), _lines(full, readings))}",
        text["readings"].format(**words),
        f"## Parameters\n\n{text['parameters'].format(**words)}\n\n{_changes(full, PARAMETERS)}",
        harness.folded("Parameters that change little", _changes(full, LITTLE)),
        *(text["tips"].format(**words), text["profiles"], _profiles(kept.numbers["profiles"])),
        *(text["other-profiles"].format(**words), text["flat"], _flat(full), text["rest"].format(**words)),
    ]
    title, finding, how = "Assumptions and what they change", text["finding"].format(**words), text["how"]
    command = "python3 -m benchmarks.assumptions"
    return harness.page(docs / "assumptions.md", title, finding, how, body, command, kept.made, ["assumptions"])


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
