"""Our numbers beside measured ones, and a verdict each; all words are in ``rows.csv`` and ``sources.csv``.

The friction, contact lengths and ridges are those of the paper's page (docs/paper.json: default mesh). Depths and
attraction are of docs/models.json, at a contact size of 10 µm. The stated error is the difference of the two meshes, or
of the full model and the smooth finger where one mesh alone has a number. Of trends the other mesh has a count.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from benchmarks import models
from benchmarks.measured import scenes
from benchmarks.measured.verdict import EXPONENT, MISS, RATIO, by_factor, by_fit, by_share
from benchmarks.runs import FORCES, VOLTAGES
from fingerpad.scene import Scene
from fingerpad.slices.profile import profile
from fingerpad.slices.total import at_indentation
from fingerpad.slices.trace import NAMES, Trace

Array = NDArray[np.float64]
Numbers = dict[str, float]
_FITS = (0.95, 0.8)  # R² that is a hit, and one that is met partly
_MISFIT = 0.1  # rms of a fitted curve: of its logarithm, and of the largest value
_MORE, _SAME = 0.25, 0.1  # relative changes that count as strikingly higher, and as similar


class Grid(NamedTuple):
    """Kept numbers over force and voltage; arrays of shape (forces, voltages), SI units."""

    fine: Mapping[str, Array]
    """Default mesh: ``normal_…`` and ``slip_…`` of ``f_t``, ``contact_length`` and ``ridges_in_contact``."""
    coarse: Mapping[str, Array]
    """Contact size of 10 µm: the same, and ``f_electrostatic`` and ``bone_height``."""
    smooth: Mapping[str, Array]
    """The smooth finger: likewise."""
    gaps: tuple[float, float]
    """Least and largest air gap (m) of all runs with a voltage."""


DRAWN, DRAWN_FORCES = ("f_t", "contact_length"), (10.0, 75.0)  # N/m, of the curves over the voltage
_KEPT = ("f_t", "contact_length", "ridges_in_contact", "f_electrostatic", "bone_height")  # of docs/models.json


def grid(paper: Mapping[str, Any], known: Mapping[str, Any]) -> Grid:
    """Return the grid from the numbers of docs/paper.json and docs/models.json."""
    fine = {name: np.array(values) for name, values in paper["grid"].items()}
    low, high = fine["gaps_range"]
    return Grid(fine, _of(known, "full"), _of(known, "smooth"), (float(low), float(high)))


def _of(known: Mapping[str, Any], model: str) -> dict[str, Array]:
    """Return a model's numbers over force and voltage."""
    found = {}
    for name in (f"{state}_{key}" for state in ("normal", "slip") for key in _KEPT):
        values = [[models.value(known["scenes"][models.name(f, u)], model, name) for u in VOLTAGES] for f in FORCES]
        found[name] = np.array(values, dtype=float)
    return found


def _width(ridges: Any) -> Any:
    """Return the width (m) over a number of touching ridges."""
    return ridges * Scene().geometry.ridge_wavelength


# -- over the voltage ----------------------------------------------------------------------------------------
def exponents(values: Array, voltages: tuple[float, ...]) -> Array:
    """Return the exponent of the rise over the value at 0 V, fitted to logarithms, at each force; shape (forces,)."""
    at = [VOLTAGES.index(u) for u in voltages]
    rise = values[:, at] - values[:, :1]
    return np.polyfit(np.log(voltages), np.log(np.maximum(rise, 1e-15)).T, 1)[0]


def _power(g: Grid, name: str, voltages: tuple[float, ...]) -> tuple[Numbers, str]:
    found, other = exponents(g.fine[name], voltages), exponents(g.coarse[name], voltages)
    near = np.abs(found - 2) <= EXPONENT
    numbers = {"low": found.min(), "high": found.max(), "error": np.abs(found - other).max()}
    return numbers | {"holds": near.sum(), "loads": near.size}, by_share(near.mean())


def _trend(g: Grid, holds: Callable[[Mapping[str, Array]], NDArray[np.bool_]], **more: float) -> tuple[Numbers, str]:
    """Return at how many loads a statement holds, on either mesh, and the verdict by the finer one."""
    fine, coarse = holds(g.fine), holds(g.coarse)
    return {"holds": fine.sum(), "other": coarse.sum(), "loads": fine.size} | more, by_share(float(fine.mean()))


def _friction_slip(g: Grid) -> tuple[Numbers, str]:
    f_t = g.fine["slip_f_t"]
    return _trend(g, lambda a: a["slip_f_t"][:, -1] > a["slip_f_t"][:, 0], least=(f_t[:, -1] / f_t[:, 0]).min() - 1)


def _area_before(g: Grid) -> tuple[Numbers, str]:
    def change(a: Mapping[str, Array]) -> Array:
        ridges = a["normal_ridges_in_contact"]
        return np.asarray(ridges[:, -1] / ridges[:, 0] - 1)

    return _trend(g, lambda a: change(a) == 0, most=np.abs(change(g.fine)).max())


def _area_after(g: Grid) -> tuple[Numbers, str]:
    return _trend(g, lambda a: a["slip_ridges_in_contact"][:, -1] < a["slip_ridges_in_contact"][:, 0])


# -- over the load -------------------------------------------------------------------------------------------
def _shear(a: Mapping[str, Array]) -> Array:
    """Return the relative change of the contact length from rest to full slip at 0 V, shape (forces,)."""
    return np.asarray(a["slip_contact_length"][:, 0] / a["normal_contact_length"][:, 0] - 1)


def _area_shear(g: Grid) -> tuple[Numbers, str]:
    return _trend(g, lambda a: _shear(a) < 0, most=-_shear(g.fine).min())


def _area_load(g: Grid) -> tuple[Numbers, str]:
    def grow(a: Mapping[str, Array]) -> NDArray[np.bool_]:
        steps = [np.diff(a[f"normal_{name}"][:, 0]) for name in ("contact_length", "ridges_in_contact")]
        return np.asarray((steps[0] > 0) & (steps[1] > 0))

    return _trend(g, grow)


def exponential(depth: Array, force: Array) -> tuple[float, float]:
    """Fit a (exp(b depth) - 1) to forces by logarithms; return b (1/m) and the rms of the logarithm's misfit."""

    def misfit(b: float) -> float:
        return float(np.std(np.log(force) - np.log(np.expm1(b * depth))))

    return _least(misfit, depth)


def absolute(depth: Array, force: Array) -> tuple[float, float]:
    """Fit the same to the forces themselves; return b (1/m) and the rms misfit over the largest force."""

    def misfit(b: float) -> float:
        curve = np.expm1(b * depth)
        rest = force - curve * (curve @ force) / (curve @ curve)
        return float(np.sqrt(np.mean(rest**2)) / force.max())

    return _least(misfit, depth)


def _least(misfit: Callable[[float], float], depth: Array) -> tuple[float, float]:
    found = minimize_scalar(misfit, bounds=(1e-3 / depth.max(), 50 / depth.max()), method="bounded")
    return float(found.x), float(found.fun)


def whole(a: Mapping[str, Array]) -> tuple[Array, Array, Array]:
    """Return depth (m), force (N) and gross area (m²) of the uncharged finger, as a sum of slices; (forces,) each.

    The finger has the default profile along its axis. Its radius scales force and area alike and leaves their shapes.
    """
    length, ridges = a["normal_contact_length"][:, 0], a["normal_ridges_in_contact"][:, 0]
    width = (ridges - 1) * Scene().geometry.ridge_wavelength + length / ridges
    columns: dict[str, Array] = {name: np.zeros(len(FORCES)) for name in NAMES}
    columns |= {"f_ext": np.array(FORCES), "contact_length": length, "gross_width": width}
    section = Trace(-a["normal_bone_height"][:, 0], columns)
    along, count = profile(Scene().slices), Scene().slices.count
    depth = section.depth * (1 - 1e-9)  # the last one is the end of the trace
    totals = [at_indentation(along, section, float(each), count).totals for each in depth]
    return depth, np.array([t["f_ext"] for t in totals]), np.array([t["gross_area"] for t in totals])


def power(x: Array, y: Array) -> tuple[float, float]:
    """Return the exponent of a power law fitted by logarithms, and the rms of the logarithm's misfit."""
    line = np.polyfit(np.log(x), np.log(y), 1)
    return float(line[0]), float(np.std(np.log(y) - np.polyval(line, np.log(x))))


def _force_depth(g: Grid) -> tuple[Numbers, str]:
    (depth, force, _), (other_depth, other, _) = whole(g.coarse), whole(g.smooth)
    misfit, error = exponential(depth, force)[1], absolute(depth, force)[1]
    numbers = {"exponential": misfit, "error": abs(exponential(other_depth, other)[1] - misfit), "absolute": error}
    numbers |= {"power": power(depth, force)[1], "least": force[0], "most": force[-1]}
    return numbers, by_share(((misfit <= _MISFIT) + (error <= _MISFIT)) / 2)


def _area_power(g: Grid) -> tuple[Numbers, str]:
    (_, force, area), (_, other, other_area) = whole(g.coarse), whole(g.smooth)
    exponent, misfit = power(force, area)
    numbers = {"exponent": exponent, "error": abs(power(other, other_area)[0] - exponent), "misfit": misfit}
    return numbers | {"least": force[0], "most": force[-1]}, by_share(float(misfit <= _MISFIT))


def _ridges(g: Grid) -> tuple[Numbers, str]:
    found, other = (
        each["normal_contact_length"][:, 0] / _width(each["normal_ridges_in_contact"][:, 0])
        for each in (g.fine, g.coarse)
    )
    low, high = float(found.min()), float(found.max())
    numbers = {"low": low, "high": high, "error": float(np.abs(found - other).max())}
    return numbers, by_factor(low, high, 0.67, 0.67, RATIO)


def _gap_sliding(g: Grid) -> tuple[Numbers, str]:
    """Impedance of equal plates: attraction F over length L gives the capacitance, in proportion to (F L)^(1/2)."""

    def rise(a: Mapping[str, Array]) -> Array:
        plates = [np.sqrt(a[f"{s}_f_electrostatic"] * a[f"{s}_contact_length"])[:, 1:] for s in ("normal", "slip")]
        return np.asarray(plates[0] / plates[1] - 1)

    found = rise(g.coarse)
    low, high, error = float(found.min()), float(found.max()), float(np.abs(found - rise(g.smooth)).max())
    seen = max(low, 1e-9), max(high, 1e-9)
    return {"low": low, "high": high, "error": error}, by_factor(seen[0], seen[1], 1.0, 10.0, RATIO)


# -- runs of this page ---------------------------------------------------------------------------------------
def paraboloid(place: Array, pressure: Array) -> tuple[float, float, float]:
    """Fit p_0 (1 - (x/a)²) to pressures; return p_0, a and the coefficient of determination."""
    slope, top = np.polyfit(place**2, pressure, 1)
    rest = pressure - np.polyval((slope, top), place**2)
    r2 = 1 - (rest**2).sum() / ((pressure - pressure.mean()) ** 2).sum()
    return float(top), float(np.sqrt(-top / slope)), float(r2)


def _pressure(runs: Mapping[str, Any]) -> tuple[Numbers, str]:
    pressed = (runs[f"dry {size * 1e6:.0f}"] for size in scenes.SIZES)
    coarse, fine = (paraboloid(np.array(run["place"]), np.array(run["pressure"]))[2] for run in pressed)
    numbers = {"r2": fine, "error": abs(fine - coarse), "ridges": runs["dry 20"]["ridges"]}
    return numbers, by_fit(fine, *_FITS)


def _change(runs: Mapping[str, Any], kind: str, name: str = "length") -> tuple[float, float]:
    """Return a kind's relative change from the dry finger on the finer mesh, and its error."""
    coarse, fine = (runs[f"{kind} {s * 1e6:.0f}"][name] / runs[f"dry {s * 1e6:.0f}"][name] - 1 for s in scenes.SIZES)
    return fine, abs(fine - coarse)


def _softer(runs: Mapping[str, Any]) -> tuple[Numbers, str]:
    (real, error), (gross, _) = _change(runs, "soft"), _change(runs, "soft", "ridges")
    numbers = {"real": real, "gross": gross, "error": error, "softer": scenes.SOFTER}
    return numbers, by_share(((real >= _MORE) + (abs(gross) <= _SAME)) / 2)


def _modulus(runs: Mapping[str, Any]) -> tuple[Numbers, str]:
    (soft, error), (rough, _) = _change(runs, "soft"), _change(runs, "rough")
    numbers = {"soft": soft, "rough": rough, "error": error, "softer": scenes.SOFTER}
    return numbers, by_share(float(abs(soft) > abs(rough)))


# -- all -----------------------------------------------------------------------------------------------------
def _constant(verdict: str) -> tuple[Numbers, str]:
    return {}, verdict


def numbers(g: Grid, runs: Mapping[str, Any]) -> dict[str, tuple[Numbers, str]]:
    """Return our numbers and the verdict of every row, by its key."""
    mu_0 = Scene().friction
    low, high = (1e6 * each for each in g.gaps)
    return {
        "friction_voltage": _power(g, "slip_f_t", VOLTAGES[1:]),
        "friction_range": _power(g, "slip_f_t", VOLTAGES[1:4]),
        "area_voltage": _power(g, "slip_contact_length", VOLTAGES[1:4]),
        "frequency": _constant(by_share(1.0)),
        "frequency_wide": _constant(MISS),
        "friction_slip": _friction_slip(g),
        "area_before": _area_before(g),
        "area_after": _area_after(g),
        "area_shear": _area_shear(g),
        "real_sliding": _trend(g, lambda a: _shear(a) > 0),
        "area_load": _area_load(g),
        "force_depth": _force_depth(g),
        "area_power": _area_power(g),
        "pressure_shape": _pressure(runs),
        "friction_load": _constant(by_share(1.0)),
        "friction_acrylic": _constant(by_share(0.0)),
        "softer": _softer(runs),
        "modulus": _modulus(runs),
        "time": _constant(MISS),
        "relaxation": _constant(MISS),
        "speed": _constant(MISS),
        "ridges": _ridges(g),
        "gap_sliding": _gap_sliding(g),
        "friction_occluded": _constant(by_factor(1.0, 1.0, 5.0, 5.0, RATIO)),
        "gap": ({"low": low, "high": high}, by_factor(low, high, 1.5, 2.5)),
        "friction_input": _constant(by_factor(mu_0, mu_0, 0.25, 0.25)),
        "friction_glass": _constant(by_factor(mu_0, mu_0, 0.4, 0.8)),
        "adhesion": _constant(MISS),
    }


def curves(g: Grid) -> dict[str, list[float]]:
    """Return what the page draws: values at full slip over the voltages, by name and force; depth (m) and force (N)."""
    depth, force, _ = whole(g.coarse)
    shown = {f"{name} {f:g}": g.fine[f"slip_{name}"][FORCES.index(f)].tolist() for name in DRAWN for f in DRAWN_FORCES}
    return shown | {"depth": depth.tolist(), "force": force.tolist()}
