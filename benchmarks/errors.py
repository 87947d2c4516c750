"""Discretisation error of the default scene: its limit under refinement, and the effect of the penalty.

environment/run python3 -m benchmarks.errors [--jobs 2] [--draw]     twenty minutes of one core

The default scene to full slip by penalty, and its states solved again on meshes with all sizes
halved (benchmarks/limits.py). Writes docs/errors.json, from which docs/errors.md, docs/errors.png and the errors on
other pages are drawn.
"""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks import harness, limits
from benchmarks.limits import Limit
from benchmarks.runs import SITES as AT_SITES
from benchmarks.runs import Run, finished
from fingerpad.accuracy.richardson import ORDER
from fingerpad.model.options import by_rule
from fingerpad.results.pictures import style
from fingerpad.results.quantities import plus_minus
from fingerpad.results.states import WORDS
from fingerpad.scene import Scene, from_data, load

_LIMIT = 10800.0  # s of processor time for one run
LEVELS = 4  # meshes of the limit
DEFAULT = by_rule(Scene())
_COARSER = {"mesh.contact": 10e-6, "mesh.receptor": AT_SITES}  # m, of the study of the penalty
STATES = WORDS
SITES = (-5, 0, 5)  # ridges whose Merkel sites are shown: a trailing, the central and a leading one
QUANTITIES: Mapping[str, tuple[str, float]] = {  # name: words, and the value of its unit in SI
    "full_slip_mu_app": ("µ_app, full slip", 1),
    "full_slip_f_t": ("f_T, full slip (N/m)", 1),
    **{f"{state}_contact_length": (f"contact length, {words} (mm)", 1e-3) for state, words in STATES.items()},
    "full_slip_p_max": ("highest pressure, full slip (kPa)", 1e3),
    **{f"{state}_ridges_in_contact": (f"ridges, {STATES[state]}", 1) for state in ("charged", "full_slip")},
    **{f"{state}_sed_{j}": (f"SED at ridge {j}, {words} (J/m³)", 1) for state, words in STATES.items() for j in SITES},
}
PRESSED = by_rule(
    from_data(
        {"history": [{"name": "press", "bone_height": -0.74e-3}], "friction": 0.0, "output": {"receptors": False}}
    )
)
"""The default finger at a given indentation, that of the default scene, of which the force is judged."""
LENGTHS = [f"{state}_contact_length" for state in STATES]
FORCE = "charged_f_contact"  # that is judged
_COST = ("unknowns", "factorisations")
_DOME = 6  # degree of the polynomial through the pressures of a ridge
PENALTIES = (0.5e12, 1.5e12, 5e12)  # Pa/m


def parted(name: str) -> tuple[str, str]:
    """Return the state and the quantity of a key such as ``full_slip_mu_app``."""
    state = next(state for state in STATES if name.startswith(f"{state}_"))
    return state, name.removeprefix(f"{state}_")


# -- numbers -------------------------------------------------------------------------------------------------
def penalties() -> dict[float, Scene]:
    """Return the scenes by the stiffness of the screen (Pa/m)."""
    return {eps_n: by_rule(load(None, _COARSER | {"contact.eps_n": eps_n})) for eps_n in PENALTIES}


def values(run: Run) -> dict[str, float]:
    """Return the quantities of a run and its cost."""
    found = {name: float(run.summary[name]) for name in (*QUANTITIES, *_COST) if "sed" not in name}
    for state in STATES:
        rows = run.final(state, "receptors")
        sed = dict(zip(rows["ridge"], rows["merkel_sed"], strict=True))
        found |= {f"{state}_sed_{j}": float(sed[j]) for j in SITES}
    return found


def saw(run: Run) -> float:
    """Return how far the pressure at full slip goes up and down, rms over the peak, of the ridge where this is largest.

    The points that bear more than half of a ridge's highest pressure are compared with a polynomial of degree six
    through them, which follows the dome and no single facet.
    """
    a = run.arrays("surface")
    found = []
    for ridge in np.unique(a["full_slip_ridge"][np.isfinite(a["full_slip_ridge"])]):
        mine = a["full_slip_ridge"] == ridge
        x, p = a["full_slip_x"][mine], a["full_slip_p"][mine]
        high = p > p.max() / 2
        if p.max() > 0 and high.sum() > 2 * _DOME:
            dome = np.polynomial.Polynomial.fit(x[high], p[high], _DOME)
            found.append(float(np.std(p[high] - dome(x[high])) / p.max()))
    return max(found)


def reference(again: Mapping[str, Any], whole: Mapping[str, float]) -> dict[str, Limit]:
    """Return the limits of the default scene's quantities from its states solved ``again`` and its ``whole`` run.

    What the coarse path changes on the default mesh is added to the error bar.
    """
    ends, own = limits.limits(again), again["own"]["values"]
    return {n: Limit(ends[n].value, ends[n].bar + abs(own[n] - whole[n]), ends[n].order) for n in QUANTITIES}


def compute(args: Any) -> None:
    """Run what is missing and keep the numbers."""
    scenes = {f"penalty {value:g}": scene for value, scene in penalties().items()}
    summaries = harness.run({"default": DEFAULT} | scenes, args, _LIMIT)
    again = limits.solve_all({"default": DEFAULT}, LEVELS, args)["default"]
    pressed = limits.solve_all({"pressed": PRESSED}, LEVELS - 1, args)["pressed"]
    default = finished(DEFAULT, args.out)
    if failed := [found["failure"] for found in (again, pressed) if "failure" in found]:
        raise SystemExit(f"the default scene has no limit: {failed[0]}")
    if default is None:
        raise SystemExit("the default scene has no errors: its run did not reach full slip")
    rows = [
        {"value": value, "quantities": values(run)}
        for value, scene in penalties().items()
        if (run := finished(scene, args.out))
    ]
    whole = values(default)
    ends = {name: vars(end) for name, end in reference(again, whole).items()}
    numbers = {"default": whole, "again": again, "studies": {"penalty": rows}, "reference": ends, "saw": saw(default)}
    numbers |= {"pressed": pressed, "unknowns_path": default.summary["unknowns_path"]}
    numbers["contact"] = DEFAULT.mesh.contact
    harness.keep("errors", numbers, harness.made(summaries.values()), args.docs)


def known(docs: Path = harness.DOCS) -> dict[str, Limit]:
    """Return the limits of the default scene's quantities from docs/errors.json."""
    return {name: Limit(**each) for name, each in harness.kept("errors", docs).numbers["reference"].items()}


def indented(found: Mapping[str, Any]) -> tuple[float, Limit]:
    """Return the force (N/m) of :data:`PRESSED` on the default mesh, and its limit."""
    return float(found["own"]["values"][FORCE]), limits.limits(found)[FORCE]


def stiffer(docs: Path = harness.DOCS) -> dict[str, tuple[float, float]]:
    """Return by state what the stiffest penalty changes of the contact length (m): by the law's order, and found."""
    rows = harness.kept("errors", docs).numbers["studies"]["penalty"]
    soft, middle, stiff = (row["value"] ** -ORDER for row in rows)
    lengths = {state: [row["quantities"][f"{state}_contact_length"] for row in rows] for state in STATES}
    part = (stiff - middle) / (middle - soft)
    return {state: (part * (b - a), c - b) for state, (a, b, c) in lengths.items()}


# -- page ----------------------------------------------------------------------------------------------------
def _end(end: Limit, unit: float = 1.0) -> list[str]:
    """Return a limit with its bar, and its order."""
    value = plus_minus(end.value / unit, end.bar / unit) if end.bar else f"{end.value / unit:.5g}"
    return [value, "–" if end.order is None else f"{end.order:.1f}"]


def _paint(figure: Figure, numbers: Mapping[str, Any], ends: Mapping[str, Limit]) -> None:
    """Draw the distance from the limit over the mesh size, with the limits' error bars cut off at the axis."""
    panels = {"mu_app": "apparent friction", "contact_length": "contact length", "sed_0": "SED at the central site"}
    axes, levels = figure.subplots(1, len(panels), sharey=True), numbers["again"]["levels"]
    for ax, (kind, title) in zip(axes, panels.items(), strict=True):
        for k, (state, colour) in enumerate(zip(STATES, style.STATE.values(), strict=True)):
            if (name := f"{state}_{kind}") not in ends:
                continue
            end, beside = ends[name], 1 + 0.05 * (k - 1)
            sizes = [level["mesh"]["contact"] * 1e6 * beside for level in levels]
            error = np.array([abs(level["values"][name] / end.value - 1) for level in levels])
            bars = np.stack([np.minimum(end.relative, 0.999 * error), np.full(len(error), end.relative)])
            look: dict[str, Any] = {"color": colour, "capsize": 2, "marker": style.MARKERS[k], "ms": 5}
            ax.errorbar(sizes, error, bars, label=STATES[state], **look)
            default = abs(numbers["default"][name] / end.value - 1)
            size = 1e6 * numbers["contact"]
            ax.plot([size * beside], [default], "*", color=colour, ms=13, mec="black", mew=0.5)
        ax.set(title=title, xlabel="contact size (µm)", yscale="log", ylim=(1e-5, 0.3))
        harness.ticks(ax, [1.25, 2.5, 5, 10])
    axes[0].set_ylabel("relative distance from the limit")
    axes[1].legend(loc="lower right")


def draw(docs: Path) -> Path:
    """Draw page and picture from the kept numbers."""
    numbers, ends = harness.kept("errors", docs).numbers, known(docs)
    whole = numbers["default"]

    def study(name: str, quantity: str) -> list[float]:
        rows = numbers["studies"][name]
        return [row["quantities"][quantity] / QUANTITIES[quantity][1] for row in rows]

    def worst(kind: str) -> float:
        return 100 * max(abs(whole[name] / end.value - 1) for name, end in ends.items() if kind in name)

    harness.picture(docs / "errors.png", (9, 3.6), lambda figure: _paint(figure, numbers, ends))
    names = {"whole": whole, "ends": ends, "again": numbers["again"], "penalty": stiffer(docs), "end": _end}
    names |= {"study": study, "worst": worst, "saw": numbers["saw"]}
    names["shown"] = {name: words for name, words in QUANTITIES.items() if name in whole}
    names["force"] = indented(numbers["pressed"])
    return harness.page(docs, "errors", "make chart", globals() | names)


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
