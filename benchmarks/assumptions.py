"""What the open choices change: readings, parameters and ridge profiles beside the default scene.

environment/run python3 -m benchmarks.assumptions [--jobs 2] [--draw]     half an hour

Full runs at 75 N/m, most of them at a contact size of 10 um. Each row of the page is the command of one run. Writes
docs/assumptions.json and docs/assumptions.md.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
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
LIGHT = ("flat, 10 N/m, 200 V", "flat, 10 N/m, 0 V")
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
def _command(case: Case, mesh: bool = True) -> str:
    """Return the options of a run's command; those of the mesh on demand."""
    words = [f"demos/scenes/{case.file}.toml"] if case.file else []
    for change in (*case.changes, *(case.mesh if mesh else ())):
        words += ["--set", f'"{change}"' if " " in change else change]
    return f"`{' '.join(words)}`" if words else "none"


class Comparison:
    """The rows of all runs, and what the page's sentences and tables have of them.

    Attributes:
        rows: by name.
        near: at 200 V, of ridge profiles that are not flat.
        close: air gaps (m) of those of them that have the paper's friction.
        met: voltages (V) at which the flattest profile has both of the paper's numbers.
    """

    def __init__(self, found: Mapping[str, Any]) -> None:
        """Take the kept numbers."""
        self.rows: dict[str, Any] = found["full"] | found["profiles"]
        shaped = found["profiles"].items()
        self.near = [row for name, row in shaped if name.endswith("200 V") and "flat" not in name]
        self.close = [row["d_eq"] for row in self.near if abs(row["mu_app"] / PAPER - 1) <= NEAR]
        flattest = [(float(name.split()[-2]), row) for name, row in shaped if name.startswith(_SHOWN[-1])]
        both = (u for u, row in flattest if row["d_eq"] >= LEAST_GAP and abs(row["mu_app"] / PAPER - 1) <= NEAR)
        self.met = list(both)

    def change(self, name: str, other: str = "reference", key: str = "mu_app") -> float:
        """Return by how much a run differs from another (%)."""
        return float(100 * (self.rows[name][key] / self.rows[other][key] - 1))

    def off(self, name: str) -> float:
        """Return by how much the friction of a run is above the paper's (%)."""
        return float(100 * (self.rows[name]["mu_app"] / PAPER - 1))

    def gaps(self, name: str) -> Array:
        """Return the air gaps of both states (m)."""
        return np.concatenate([self.rows[name]["gaps"][state] for state in ("charged", "full_slip")])

    def counts(self, name: str) -> tuple[int, int, int]:
        """Return how many air gaps are in the paper's range, how many below it, and how many there are."""
        gaps = self.gaps(name)
        return int(within(gaps).sum()), int((gaps < LEAST_GAP).sum()), len(gaps)

    def friction(self, name: str) -> str:
        """Return µ_app of a run, with its error where the page states it."""
        row = self.rows[name]
        return plus_minus(row["mu_app"], row["error"]) if row["error"] else f"{row['mu_app']:.4f}"

    def line(self, name: str) -> str:
        """Return the cells of a run: friction and lengths."""
        row = self.rows[name]
        return f"{self.friction(name)} | {row.f_t:.2f} | {1e3 * row.contact_length:.3f} | {1e3 * row.charged:.3f}"


def _span(lengths: Sequence[float]) -> str:
    """Return the least and the largest of lengths (m) in µm, or the only one."""
    return " to ".join(f"{1e6 * each:.2f}" for each in dict.fromkeys((min(lengths), max(lengths))))


def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    found = Comparison(harness.kept("assumptions", docs).numbers)
    shown = [
        (profile, voltage, found.rows[f"{profile} at {voltage} V"])
        for profile in _SHOWN
        for voltage in sorted({200, *_BY_VOLTAGE.get(profile, ())}, reverse=True)
    ]
    names = {name: getattr(found, name) for name in dir(found) if not name.startswith("_")}
    names |= {"command": _command, "span": _span, "shown": shown, "HALF": next(iter(PARAMETERS))}
    names["option"] = lambda name: _command(Case("", () if name == "reference" else (name,)), mesh=False)
    return harness.page(docs, "assumptions", "python3 -m benchmarks.assumptions", globals() | names)


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
