"""Our numbers beside measured ones, and a verdict each; all words are in ``rows.csv`` and ``sources.csv``.

What is compared is the quantity that was measured. The apparent area is the gross area of the whole finger, a sum of
slices (:mod:`benchmarks.measured.fingers`). The real area is the contact length of the ridges, of the paper's page
(docs/paper.json: default mesh); over the voltage it is the area of asperities of whole fingers. Attraction is of
docs/models.json, at a contact size of 10 µm. The stated error is the difference of the two meshes. Whole fingers of the
finer mesh have its contact lengths and counts of ridges, over the indentations of the coarser one. Of trends the other
mesh has a count.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks import models
from benchmarks.measured import drives, fingers, rules
from benchmarks.measured.rules import (
    CHANGED,
    EXPONENT,
    RATIO,
    SIMILAR,
    STRIKING,
    by_factor,
    by_form,
    by_share,
)
from benchmarks.runs import FORCES, VOLTAGES
from fingerpad.scene import Scene
from fingerpad.scene.remarks import coefficient
from variational.attraction.dielectric import VACUUM_PERMITTIVITY

Array = NDArray[np.float64]
Numbers = dict[str, float]
Row = tuple[Numbers, str]
"""Numbers of a row by name, and its verdict."""
AMPLITUDES = ((100.0, 150.0), (50.0, 100.0))
"""Voltages (V) within an amplitude of 75 to 150 V: as a constant voltage, and as that of a sine's mean square."""

SHOWN = 0.5  # N, of the areas of asperities in mm²


class Grid(NamedTuple):
    """Kept numbers over force and voltage; arrays of shape (forces, voltages), SI units."""

    fine: Mapping[str, Array]
    """Default mesh: ``charged_…`` and ``full_slip_…`` of ``f_t``, ``contact_length`` and ``ridges_in_contact``."""
    coarse: Mapping[str, Array]
    """Contact size of 10 µm: the same, and ``f_electrostatic``."""
    gaps: tuple[float, float]
    """Least and largest air gap (m) of all runs with a voltage."""
    full_finger: fingers.Sums
    """The whole finger in newtons, from the full model at a contact size of 10 µm."""
    fine_finger: fingers.Sums
    """The same with the contact lengths and counts of ridges of the default mesh."""


DRAWN, DRAWN_FORCES = ("f_t", "contact_length"), (10.0, 75.0)  # N/m, of the curves over the voltage
_KEPT = ("f_t", "contact_length", "ridges_in_contact", "f_electrostatic")  # of docs/models.json


def grid(paper: Mapping[str, Any], known: Mapping[str, Any]) -> Grid:
    """Return the grid from the numbers of docs/paper.json and docs/models.json."""
    fine = {name: np.array(values) for name, values in paper["grid"].items()}
    low, high = fine["gaps_range"]
    return Grid(fine, _of(known), (float(low), float(high)), fingers.sums(known), fingers.sums(known, fine))


def _of(known: Mapping[str, Any]) -> dict[str, Array]:
    """Return the full model's numbers over force and voltage."""
    found = {}
    for name in (f"{state}_{key}" for state in ("charged", "full_slip") for key in _KEPT):
        values = [[models.value(known["scenes"][models.name(f, u)], "full", name) for u in VOLTAGES] for f in FORCES]
        found[name] = np.array(values, dtype=float)
    return found


# -- over the voltage ----------------------------------------------------------------------------------------
def exponents(values: Array, voltages: tuple[float, ...]) -> Array:
    """Return the exponent of the rise over the value at 0 V, fitted to logarithms, at each force; shape (forces,)."""
    at = [VOLTAGES.index(u) for u in voltages]
    rise = values[:, at] - values[:, :1]
    return np.polyfit(np.log(voltages), np.log(np.maximum(rise, 1e-15)).T, 1)[0]


def _power(g: Grid, name: str, *ranges: tuple[float, ...]) -> Row:
    """Judge whether a rise is as the square of the voltage, at each force and in each of the ranges (V)."""
    found, other = (np.array([exponents(a[name], voltages) for voltages in ranges]) for a in (g.fine, g.coarse))
    near = (np.abs(found - 2) <= EXPONENT).all(axis=0)
    numbers = {"holds": near.sum(), "loads": near.size, "error": np.abs(found - other).max()}
    numbers |= {"low": found[0].min(), "high": found[0].max(), "other_low": found[-1].min()}
    return numbers | {"other_high": found[-1].max()}, by_share(float(near.mean()))


def _real_area(g: Grid) -> Row:
    """Judge the area of asperities of whole fingers at full slip, by exact contact.

    The numbers also have this area in mm², by both closures, and the exponents of the ridges' contact length.
    """

    def areas(of: fingers.Sums, closure: str) -> Mapping[str, Array]:
        return {"real": np.array([of[f"full_slip_{u:g}_{closure}_area"] for u in VOLTAGES]).T}

    fine, coarse = (areas(of, "exact") for of in (g.fine_finger, g.full_finger))
    numbers, verdict = _power(g._replace(fine=fine, coarse=coarse), "real", *AMPLITUDES)
    for name in fingers.CLOSURES:
        area = 1e6 * areas(g.full_finger, name)["real"][fingers.NEWTONS.index(SHOWN)]
        numbers |= {f"{name}_{u:g}": float(value) for u, value in zip(VOLTAGES, area, strict=True)}
    length, _ = _power(g, "full_slip_contact_length", *AMPLITUDES)
    numbers |= {f"length_{key}": length[key] for key in ("holds", "loads")}
    numbers |= {"length_low": min(length["low"], length["other_low"])}
    return numbers | {"length_high": max(length["high"], length["other_high"])}, verdict


def _trend(g: Grid, holds: Callable[[Mapping[str, Array]], NDArray[np.bool_]], **more: float) -> Row:
    """Return at how many loads a statement holds, on either mesh, and the verdict by the finer one."""
    fine, coarse = holds(g.fine), holds(g.coarse)
    return {"holds": fine.sum(), "other": coarse.sum(), "loads": fine.size} | more, by_share(float(fine.mean()))


def _friction_slip(g: Grid) -> Row:
    f_t = g.fine["full_slip_f_t"]
    return _trend(
        g, lambda a: a["full_slip_f_t"][:, -1] > a["full_slip_f_t"][:, 0], least=(f_t[:, -1] / f_t[:, 0]).min() - 1
    )


# -- of the whole finger -------------------------------------------------------------------------------------
def _apparent(g: Grid, state: str, before: str, holds: Callable[[Array], NDArray[np.bool_]]) -> Row:
    """Judge the change of the gross area from a state to another, as ``full_slip_0``, at each force (N)."""
    change, other = (f[f"{state}_gross_area"] / f[f"{before}_gross_area"] - 1 for f in (g.full_finger, g.fine_finger))
    numbers = {"low": change.min(), "high": change.max(), "error": np.abs(change - other).max()}
    counts = {"holds": holds(change).sum(), "other": holds(other).sum(), "loads": change.size}
    return numbers | counts, by_share(float(holds(change).mean()))


def _same(change: Array) -> NDArray[np.bool_]:
    return np.abs(change) < CHANGED


def _falls(change: Array) -> NDArray[np.bool_]:
    return change <= -CHANGED


def _area_load(g: Grid) -> Row:
    def grow(sums: fingers.Sums) -> NDArray[np.bool_]:
        areas = [np.diff(np.log(sums[f"charged_0_{name}"])) for name in ("gross_area", "contact_area")]
        return np.asarray((areas[0] >= np.log1p(CHANGED)) & (areas[1] > 0))

    full, fine = grow(g.full_finger), grow(g.fine_finger)
    return {"holds": full.sum(), "other": fine.sum(), "loads": full.size}, by_share(float(full.mean()))


def _force_depth(g: Grid) -> Row:
    """Judge an exponential beside a power law, by the misfit of each force and by that of the largest."""
    depth, force = g.full_finger["charged_0_depth"], np.array(fingers.NEWTONS)
    fits = {
        form: [fit(form, depth, force) for fit in (rules.of_each, rules.of_largest)]
        for form in (rules.exponential, rules.power)
    }
    (each, largest), (other_each, other_largest) = ([fit.misfit for fit in fits[form]] for form in fits)
    numbers = {"each": each, "largest": largest, "other_each": other_each, "other_largest": other_largest}
    return numbers, by_form((each, largest), (other_each, other_largest))


def _area_power(g: Grid) -> Row:
    """Judge a power law beside a straight line, at the forces of the source; the exponent is that of all forces.

    The exponent is the slope of logarithms. A search for the least misfit has it to the root of roundoff alone, too
    little for the difference of two meshes.
    """
    force, area = np.array(fingers.NEWTONS), g.full_finger["charged_0_gross_area"]
    theirs = force >= 0.5
    misfit, other = (rules.of_each(form, force[theirs], area[theirs]).misfit for form in (rules.power, rules.line))
    areas = (f["charged_0_gross_area"] for f in (g.full_finger, g.fine_finger))
    exponent, fine = (float(np.polyfit(np.log(force), np.log(each), 1)[0]) for each in areas)
    power, line = (rules.of_each(form, force, area).misfit for form in (rules.power, rules.line))
    numbers = {"misfit": misfit, "line": other, "exponent": exponent, "all": power, "all_line": line}
    return numbers | {"error": abs(fine - exponent)}, by_form((misfit,), (other,))


def _ridges(g: Grid) -> Row:
    found, other = (f["charged_0_contact_area"] / f["charged_0_gross_area"] for f in (g.full_finger, g.fine_finger))
    low, high = float(found.min()), float(found.max())
    numbers = {"low": low, "high": high, "error": float(np.abs(found - other).max())}
    return numbers, by_factor(low, high, 0.67, 0.67, RATIO)


# -- over the load -------------------------------------------------------------------------------------------
def _shear(a: Mapping[str, Array]) -> Array:
    """Return the relative change of the contact length from rest to full slip at 0 V, shape (forces,)."""
    return np.asarray(a["full_slip_contact_length"][:, 0] / a["charged_contact_length"][:, 0] - 1)


def _friction_load(g: Grid) -> dict[str, Row]:
    """Judge by µ without voltage over the load whether it depends on the load, falls, and by how much."""
    mu = g.fine["full_slip_f_t"][:, 0] / np.array(FORCES)
    factor, fall = float(mu.max() / mu.min()), float(1 - mu[-1] / mu[0])
    depends = factor - 1 > SIMILAR
    verdicts = {
        "friction_load": by_share(float(not depends)),
        "friction_acrylic": by_share(float(fall > SIMILAR)),
        "friction_power": by_share(float(depends)),
        "friction_occluded": by_factor(factor, factor, 5.0, 5.0, RATIO),
    }
    return {key: ({"factor": factor}, verdict) for key, verdict in verdicts.items()}


def _plates(a: Mapping[str, Array], state: str) -> tuple[Array, Array]:
    """Return air gap (m) and length (m) of equal plates that attract as the ridges do, at each force and voltage."""
    length, voltages = a[f"{state}_contact_length"][:, 1:], np.array(VOLTAGES[1:])
    pressure = a[f"{state}_f_electrostatic"][:, 1:] / length
    return voltages * np.sqrt(VACUUM_PERMITTIVITY / 2 / pressure) - Scene().h_0, length


# -- runs of this page ---------------------------------------------------------------------------------------
def _pressure(runs: Mapping[str, Any]) -> Row:
    """Judge a paraboloid beside half an ellipse, over the largest pressure."""
    fits = {}
    for size in fingers.SIZES:
        place, pressure = (np.array(runs[fingers.name("dry", size)][key]) for key in ("place", "pressure"))
        fits[size] = [rules.of_largest(form, place, pressure).misfit for form in (rules.paraboloid, rules.ellipse)]
    (coarse, _), (fine, other) = fits.values()
    numbers = {"misfit": fine, "error": abs(fine - coarse), "other": other}
    return numbers | {"ridges": runs[fingers.name("dry", fingers.SIZES[-1])]["ridges"]}, by_form((fine,), (other,))


def _change(runs: Mapping[str, Any], kind: str, value: Callable[[Mapping[str, Any]], float]) -> tuple[float, float]:
    """Return a kind's relative change from the dry finger on the finer mesh, and its error."""
    pairs = ([value(runs[fingers.name(each, size)]) for each in (kind, "dry")] for size in fingers.SIZES)
    coarse, fine = (mine / dry - 1 for mine, dry in pairs)
    return fine, abs(fine - coarse)


def _length(run: Mapping[str, Any]) -> float:
    return float(run["length"])


def _softer(runs: Mapping[str, Any]) -> Row:
    """Judge either area at each softening of the stratum corneum."""
    real, gross = ([_change(runs, f"soft {s:g}", of) for s in fingers.SOFTER] for of in (_length, fingers.gross))
    holds = [change >= STRIKING for change, _ in real] + [abs(change) <= SIMILAR for change, _ in gross]
    (less, less_error), (more, error) = real
    numbers = {"less": less, "less_error": less_error, "more": more, "error": error}
    numbers |= {"gross": max(change for change, _ in gross), "least": fingers.SOFTER[0], "most": fingers.SOFTER[-1]}
    return numbers, by_share(sum(holds) / len(holds))


def _modulus(runs: Mapping[str, Any]) -> Row:
    """Judge a softening of the stratum corneum beside as large a change of friction."""
    (soft, error), (rough, _) = (_change(runs, kind, _length) for kind in (f"soft {fingers.SOFTER[-1]:g}", "rough"))
    numbers = {"soft": soft, "rough": rough, "error": error, "most": fingers.SOFTER[-1], "friction": fingers.ROUGHER}
    return numbers, by_share(float(abs(soft) > abs(rough)))


# -- all -----------------------------------------------------------------------------------------------------
def numbers(g: Grid, runs: Mapping[str, Any]) -> dict[str, Row]:
    """Return our numbers and the verdict of every row of ``rows.csv`` that has some, by its key."""
    mu_0 = coefficient(Scene()) or 0.0
    low, high = (1e6 * each for each in g.gaps)
    of_load = _friction_load(g)
    return {
        "friction_voltage": _power(g, "full_slip_f_t", VOLTAGES[1:]),
        "friction_range": _power(g, "full_slip_f_t", *AMPLITUDES),
        "real_area": _real_area(g),
        "friction_slip": _friction_slip(g),
        "area_before": _apparent(g, "charged_200", "charged_0", _same),
        "area_after": _apparent(g, "full_slip_200", "full_slip_0", _falls),
        "area_shear": _apparent(g, "full_slip_0", "charged_0", _falls),
        "apparent_sliding": _apparent(g, "full_slip_0", "charged_0", _falls),
        "real_sliding": _trend(g, lambda a: _shear(a) > 0),
        "area_load": _area_load(g),
        "force_depth": _force_depth(g),
        "area_power": _area_power(g),
        "pressure_shape": _pressure(runs),
        "friction_load": of_load["friction_load"],
        "friction_acrylic": of_load["friction_acrylic"],
        "friction_power": of_load["friction_power"],
        "softer": _softer(runs),
        "ridges": _ridges(g),
        "gap_sliding": drives.sliding(*(_plates(g.coarse, state) for state in ("charged", "full_slip"))),
        "friction_occluded": of_load["friction_occluded"],
        "gap": ({"low": low, "high": high}, by_factor(low, high, 1.5, 2.5)),
        "friction_input": ({"mu": mu_0}, by_factor(mu_0, mu_0, 0.25, 0.25)),
        "friction_glass": ({"mu": mu_0}, by_factor(mu_0, mu_0, 0.4, 0.8)),
        "modulus": _modulus(runs),
    }


def curves(g: Grid) -> dict[str, list[float]]:
    """Return what the page draws: values at full slip over the voltages, by name and force; depth (m) and force (N)."""
    shown = {
        f"{name} {f:g}": g.fine[f"full_slip_{name}"][FORCES.index(f)].tolist() for name in DRAWN for f in DRAWN_FORCES
    }
    return shown | {"depth": g.full_finger["charged_0_depth"].tolist(), "force": list(fingers.NEWTONS)}
