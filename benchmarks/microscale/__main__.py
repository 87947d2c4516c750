"""Closures of rough contact side by side, and what they make of friction.

environment/run python3 -m benchmarks.microscale [--jobs 2] [--draw]     some ten minutes: contacts, a few full runs

Air gap, area and attraction over pressure of every closure; µ_app of charged cylinders over force and voltage with
each, and of a few full runs; the independent numbers that the tables of gaps must reproduce; and the contact whose
attraction deforms. Writes docs/microscale.json, and from it docs/microscale.md and its picture.
"""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks import harness
from benchmarks.microscale import contacts, readings
from benchmarks.microscale.readings import GAPS, LOAD, PAPER
from fingerpad.reduced import cylinders
from fingerpad.results.pictures import style
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from variational.attraction.electroadhesion import VACUUM_PERMITTIVITY
from variational.roughness.bam import BearingArea
from variational.roughness.boundary_elements import BoundaryElements
from variational.roughness.persson import Persson
from variational.roughness.tabulated import TabulatedClosure

_LIMIT = 3600.0  # s of processor time for one run
PRESSURES = (2e3, 5e3, 10e3, 20e3, 50e3, 100e3, 200e3)
FORCES, VOLTAGES = (25.0, 75.0, 150.0), tuple(float(u) for u in range(0, 201, 10))
NUMBER = 200.0  # V, of the paper's screen
READINGS = {"rms": 1.0, "amplitude": 0.5**0.5, "peak to peak": 0.125**0.5}
"""Effective voltage of a sine over the number that is read in this way."""
CIRCUIT = {
    f"{name}, circuit": {"waveform": "sine", key: NUMBER, "frequency": 1e3}
    for name, key in (("rms", "rms"), ("amplitude", "amplitude"), ("peak to peak", "peak_to_peak"))
}
"""Drives of a sine of 1 kHz over screen, leaking gap and skin, the electric table below."""
ELECTRIC = {"tissue": "dry", "leak": "sliding dry"}
_FINE = 100e-6 / 64
Law = BearingArea | TabulatedClosure


def laws() -> dict[str, Law]:
    """Return the closures of the page by words."""
    h_0 = Scene().h_0
    return {
        "bearing area": BearingArea(h_0),
        "boundary elements": BoundaryElements(h_0),
        "boundary elements, no field in contact": BoundaryElements(h_0, field_in_contact=False),
        "boundary elements, waves to 1.6 µm": BoundaryElements(h_0, shortest_wave=_FINE),
        "boundary elements, waves to 1.6 µm, no field in contact": BoundaryElements(
            h_0, shortest_wave=_FINE, field_in_contact=False
        ),
        "Persson's theory": Persson(h_0),
        "Persson's theory, no field in contact": Persson(h_0, field_in_contact=False),
    }


FULL = {  # words: closure and rms voltage
    "bearing area, rms": ("bearing area", NUMBER),
    "boundary elements, peak to peak": ("boundary elements", round(NUMBER * READINGS["peak to peak"], 1)),
    "boundary elements, no field in contact, amplitude": (
        "boundary elements, no field in contact",
        round(NUMBER * READINGS["amplitude"], 1),
    ),
}


def full_scenes() -> dict[str, Scene]:
    """Return the scenes of the full runs by words."""
    mesh = {"contact": 10e-6, "receptor": 20e-6}
    output = {"errors": False, "receptors": False}
    return {
        words: Scene(roughness=laws()[law], voltage=voltage, mesh=mesh, output=output)
        for words, (law, voltage) in FULL.items()
    }


# -- numbers -------------------------------------------------------------------------------------------------
def over_pressure(law: Law) -> dict[str, Any]:
    """Return what a closure has at the pressures of the page, and from which voltage a ridge would stick."""
    p = np.array(PRESSURES)
    gaps = law.statistics(p, NUMBER)
    spread = law.spread(p) if isinstance(law, TabulatedClosure) else np.zeros_like(p)
    found = {"d_eq": gaps.d_eq, "spread": spread, "area": gaps.area, "u_bar": gaps.u_bar, "broken": gaps.broken_down}
    found["pull"] = VACUUM_PERMITTIVITY / 2 * gaps.inverse_square  # Pa/V²
    return {name: values.tolist() for name, values in found.items()} | {"sticking": law.sticking_voltage()}


def friction(law: Law, f_ext: float, voltage: float | Mapping[str, Any]) -> dict[str, float] | None:
    """Return full slip of the charged cylinders under a voltage (V) or a drive, None without an equilibrium."""
    electric: dict[str, Any] = ELECTRIC if isinstance(voltage, Mapping) else {}
    try:
        scene = Scene(roughness=law, f_ext=f_ext, voltage=voltage, electric=electric)  # type: ignore[arg-type]
        found = cylinders.solve(scene)
    except SceneError:
        return None
    slip = found.full_slip
    assert slip is not None
    p_c, d_eq = (found.record[f"full_slip_{name}"] for name in ("p_c", "d_eq"))
    effective = slip.voltage if scene.drive is None else float(scene.drive.effective(np.array(d_eq)))
    inside = law.statistics(np.clip(p_c, *law.pressures))
    beyond, balanced = False, 0.0
    if isinstance(law, TabulatedClosure):
        beyond, balanced = p_c > law.pressures[1], float(law.balanced(p_c, effective))
    return {
        "mu_app": slip.mu_app, "p_c": p_c, "d_eq": d_eq, "area": float(inside.area),
        "beyond": float(beyond), "balanced": balanced,
    }  # fmt: skip


def _given() -> dict[str, float | Mapping[str, Any]]:
    """Return the rms voltage (V) or the drive of each reading of the paper's number."""
    return {**{name: NUMBER * part for name, part in READINGS.items()}, **CIRCUIT}


def compute(args: argparse.Namespace) -> None:
    """Compute and keep the numbers."""
    exact = {"direct": contacts.direct(), "grids": contacts.grids(), "adhesive": contacts.adhesive()}
    full = harness.run(full_scenes(), args, _LIMIT)
    closures = laws()
    keys = ("full_slip_mu_app", "full_slip_contact_length", "full_slip_f_electrostatic", "failure")
    found = {
        "closures": {words: over_pressure(law) for words, law in closures.items()},
        "read": {
            words: {reading: {f"{f:g}": friction(law, f, given) for f in FORCES} for reading, given in _given().items()}
            for words, law in closures.items()
        },
        "curves": {
            words: {f"{f:g}": [_mu(friction(law, f, u)) for u in VOLTAGES] for f in FORCES}
            for words, law in closures.items()
        },
        "full": {words: {key: summary.get(key) for key in keys} for words, summary in full.items()},
    }
    harness.keep("microscale", found | exact, harness.made(full.values()), args.docs)


def _mu(found: Mapping[str, float] | None) -> float | None:
    return None if found is None or found["beyond"] else found["mu_app"]


# -- page ----------------------------------------------------------------------------------------------------
FULL_OF = {words: (words.rpartition(", ")[0], words.rpartition(", ")[2]) for words in FULL}
"""Closure and reading of each full run."""


def _reaches(values: list[float | None]) -> float | None:
    """Return the voltage (V) at which a curve over VOLTAGES passes the paper's friction."""
    known = [(u, mu) for u, mu in zip(VOLTAGES, values, strict=True) if mu is not None]
    u, mu = (np.array(each) for each in zip(*known, strict=True))
    return float(np.interp(PAPER, mu, u)) if mu.max() >= PAPER else None


def _inside(numbers: Mapping[str, Any]) -> list[bool]:
    """Return whether each number of another program that has a scatter is within it here."""
    inside = []
    for size, found in numbers["direct"].items():
        for one, other in zip(found, contacts.KNOWN[size], strict=False):
            pairs = zip(one, other, strict=True)
            inside += [abs(mine[0] - mean) <= scatter for mine, (mean, scatter) in pairs if scatter is not None]
    return inside


def draw(docs: Path) -> Path:
    """Draw the page and its picture from the kept numbers."""
    numbers = harness.kept("microscale", docs).numbers
    harness.picture(docs / "microscale.png", (10, 5), lambda figure: _paint(figure, numbers))
    read = readings.read(numbers)
    solved = [found for each in read if each.words != "bearing area" for found in each.states.values() if found]
    inside = _inside(numbers)
    needed = [_reaches(curves["75"]) for words, curves in numbers["curves"].items() if words != "bearing area"]
    deformed = [row for row in numbers["adhesive"] if row["in_contact"] and row["voltage"] >= 70]
    areas = {row["pixels"]: row["values"][2] for row in numbers["grids"] if row["p_c"] == PRESSURES[1]}
    names = {
        "read": read,
        "exact": [found["d_eq"] * 1e6 for found in solved],
        "loads": [found["p_c"] * 1e-3 for found in solved],
        "span": lambda reading: readings.span(read, reading),
        "others": lambda reading: readings.span([each for each in read if each.words != "bearing area"], reading),
        "mu": lambda words, reading: numbers["read"][words][reading][LOAD]["mu_app"],
        "gap": lambda found, k: _gap(found["d_eq"][k] * 1e6, found["spread"][k] * 1e6),
        "pull": _pull,
        "reaches": _reaches, "inside": sum(inside), "known_pairs": inside,
        "least_voltage": min(u for u in needed if u), "most_voltage": max(u for u in needed if u),
        "flat": lambda found: Scene().friction * (1 + found["attraction"] / contacts.P_EXT),
        "broken": [part for found in numbers["closures"].values() for part in found["broken"]],
        "first_off": deformed[0], "area_error": areas[min(areas)] / areas[max(areas)],
        "kPa": 1e-3,
    }  # fmt: skip
    return harness.page(docs, "microscale", "python3 -m benchmarks.microscale", globals() | names)


def _gap(value: float, spread: float) -> str:
    return f"{value:.2f}" + (f" ± {spread:.2f}" if spread else "")


def _pull(found: Mapping[str, list[float]], k: int) -> str:
    """Return the attraction (kPa) at 100 V and a pressure of the page, ± 2 / (h_0 + d_eq) times the scatter of d_eq."""
    value = found["pull"][k] * 1e4 * 1e-3
    spread = 2 * value * found["spread"][k] / (Scene().h_0 + found["d_eq"][k])
    return f"{value:.1f}" + (f" ± {spread:.1f}" if spread else "")


def _paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    gap, area, mu = figure.subplots(1, 3)
    p = np.array(PRESSURES) * 1e-3
    for k, (words, found) in enumerate(numbers["closures"].items()):
        look = {"color": style.CATEGORIES[k], "marker": style.MARKERS[k], "ms": 4}
        d_eq, spread = (np.array(found[name]) * 1e6 for name in ("d_eq", "spread"))
        gap.plot(p, d_eq, label=words, **look)
        gap.fill_between(p, d_eq - spread, d_eq + spread, color=look["color"], alpha=0.25, lw=0)
        if "no field" not in words:  # the area does not depend on the field
            area.plot(p, 100 * np.array(found["area"]), **look)
        values = [np.nan if value is None else value for value in numbers["curves"][words]["75"]]
        mu.plot(VOLTAGES, values, markevery=2, **look)
    gap.axhspan(GAPS[0] * 1e6, GAPS[1] * 1e6, color="0.85", zorder=0)
    gap.set(xscale="log", yscale="log", ylabel="equivalent air gap (µm)", title="A  grey: published gaps")
    area.set(xscale="log", yscale="log", ylabel="area in contact (% of the ridge's)", title="B")
    for ax, marks in ((gap, (0.2, 0.5, 1, 2, 5)), (area, (0.5, 1, 2, 5, 10, 20, 50))):
        ax.set_yticks(marks, [f"{mark:g}" for mark in marks])
        ax.set_xticks((2, 5, 10, 20, 50, 100, 200), ("2", "5", "10", "20", "50", "100", "200"))
        ax.minorticks_off()
        ax.grid(alpha=0.3)
    mu.grid(alpha=0.3)
    mu.axhline(PAPER, color="0.5", ls="--", zorder=0)
    mu.set(
        xlabel="rms voltage (V)",
        ylabel="µ_app at full slip (–)",
        ylim=(0.2, 1.2),
        title="C  75 N/m; dashed: 0.55",
    )
    for ax in (gap, area):
        ax.set(xlabel="mean contact pressure (kPa)")
    figure.legend(*gap.get_legend_handles_labels(), loc="outside lower center", ncols=2)


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
