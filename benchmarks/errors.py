"""Discretisation error of the default scene: its limit under refinement, and the effect of each size and the penalty.

environment/run python3 -m benchmarks.errors [--jobs 2] [--draw]     some hours

The default scene to full slip with one setting changed at a time, and its states solved again on meshes with all sizes
halved (benchmarks/limits.py). Writes docs/errors.json, from which docs/errors.md, docs/errors.png and the errors on
other pages are drawn.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks import harness
from benchmarks.convergence import Limit, limit
from benchmarks.runs import Array, Run
from benchmarks.traces import SITES as AT_SITES
from fingerpad.accuracy.rigid_screen import ORDER
from fingerpad.io import style
from fingerpad.io.states import PREFIXES, WORDS
from fingerpad.model.touching import by_rule
from fingerpad.richardson import plus_minus
from fingerpad.scene import Scene, from_data

_LIMIT = 10800.0  # s of processor time for one run
LEVELS = 4  # meshes of the limit
DEFAULT = by_rule(Scene())
AT = 10e-6  # m, contact size of the studies that change another setting
STATES = {prefix: WORDS[state] for state, prefix in PREFIXES.items()}  # "uncharged", "normal", "slip"
SITES = (-5, 0, 5)  # ridges whose Merkel sites are shown: a trailing, the central and a leading one
QUANTITIES: Mapping[str, tuple[str, float]] = {  # name: words, and the value of its unit in SI
    "slip_mu_app": ("µ_app, full slip", 1),
    "slip_f_t": ("f_T, full slip (N/m)", 1),
    **{f"{state}_contact_length": (f"contact length, {words} (mm)", 1e-3) for state, words in STATES.items()},
    **{f"{state}_ridges_in_contact": (f"ridges, {STATES[state]}", 1) for state in ("normal", "slip")},
    **{f"{state}_sed_{j}": (f"SED at ridge {j}, {words} (J/m³)", 1) for state, words in STATES.items() for j in SITES},
}
KINDS = {"mu_app": "µ_app", "contact_length": "contact length", "sed_": "energy density"}
_OTHERS = {"mesh": {"contact": AT, "receptor": AT_SITES}}


def _sizes(name: str, *sizes: float) -> dict[float, dict[str, Any]]:
    return {size: {"mesh": _OTHERS["mesh"] | {name: size}} for size in sizes}


_PENALTIES = {eps_n: _OTHERS | {"contact": {"eps_n": eps_n}} for eps_n in (0.5e12, 1.5e12, 5e12)}
STUDIES: dict[str, tuple[str, float, str, dict[float, dict[str, Any]]]] = {  # heading, unit, its name, settings
    "contact": ("Contact size", 1e-6, "µm", _sizes("contact", 20e-6, 10e-6, 5e-6, 2.5e-6)),
    "growth": ("Growth of the elements with depth", 1, "", _sizes("growth", 0.5, 0.25, 0.125)),
    "receptor": ("Size at the Merkel sites", 1e-6, "µm", _sizes("receptor", 40e-6, 20e-6, 10e-6, 5e-6, 2.5e-6)),
    "penalty": ("Penalty stiffness", 1e9, "MPa/mm", _PENALTIES),
}


# -- numbers -------------------------------------------------------------------------------------------------
def study(name: str) -> dict[float, Scene]:
    """Return the scenes of a study by the value of its setting, from coarse to fine."""
    return {value: by_rule(from_data(data)) for value, data in STUDIES[name][3].items()}


def values(scene: Scene, out: Path) -> dict[str, float] | None:
    """Return the quantities of a run and its cost, None where it is missing or did not reach full slip."""
    try:
        run = Run(scene, out)
    except FileNotFoundError:
        return None
    if not run.summary["full_slip"]:
        return None
    found = {
        name: float(run.summary[name]) for name in (*QUANTITIES, "unknowns", "factorisations") if "sed" not in name
    }
    for state in STATES:
        sed = dict(zip(run.receptors["ridge"], run.receptors["merkel_sed"][run.row(state)], strict=True))
        found |= {f"{state}_sed_{j}": float(sed[j]) for j in SITES}
    return found


def lengths(run: Run) -> dict[str, Array]:
    """Return the lengths in contact (m) by quantity, shape (ridges,)."""
    found: dict[str, Array] = {}
    for state in STATES:
        of_all = np.zeros(run.scene.geometry.ridge_count)
        ridges, length = run.on_ridges(run.row(state), "contact_length")
        of_all[ridges.astype(int) + len(of_all) // 2] = length
        found[f"{state}_contact_length"] = of_all
    return found


def reference(again: Mapping[str, Any], whole: Mapping[str, float]) -> dict[str, Limit]:
    """Return the limits of the default scene's quantities.

    Args:
        again: its states solved again, of :func:`benchmarks.limits.ask`.
        whole: its whole run. What the coarse path changes on the default mesh is added to the error bar.
    """
    found = {}
    for name in QUANTITIES:
        end = limit([level["values"][name] for level in again["levels"]])
        path = abs(again["own"]["values"][name] - whole[name])
        found[name] = Limit(end.value, end.bar + path, end.order)
    return found


def compute(args: Any) -> None:
    """Run what is missing and keep the numbers."""
    from benchmarks import limits

    scenes = {f"{name} {value:g}": scene for name in STUDIES for value, scene in study(name).items()}
    # The finest first: it takes longest.
    summaries = harness.run({"default": DEFAULT} | dict(reversed(scenes.items())), args, _LIMIT)
    again = limits.ask_all({"default scene": DEFAULT}, LEVELS, args.out.parent / "limits", 1)["default scene"]
    whole = values(DEFAULT, args.out)
    if whole is None or "failure" in again:
        raise SystemExit(f"the default scene has no limit: {again.get('failure', 'its run did not reach full slip')}")
    studies: dict[str, list[dict[str, Any]]] = {}
    for name in STUDIES:
        for value, scene in study(name).items():
            quantities = values(scene, args.out)
            if quantities is not None:
                of_ridges = {k: list(v) for k, v in lengths(Run(scene, args.out)).items()}
                row = {"value": value, "quantities": quantities, "lengths": of_ridges, "scene": scene.parameters()}
                studies.setdefault(name, []).append(row)
    ends = {name: vars(each) for name, each in reference(again, whole).items()}
    numbers = {"default": whole, "again": again, "studies": studies, "reference": ends}
    harness.keep("errors", numbers, harness.made(summaries.values()), args.docs)


def known(docs: Path = harness.DOCS) -> dict[str, Limit]:
    """Return the limits of the default scene's quantities from docs/errors.json."""
    return {name: Limit(**each) for name, each in harness.kept("errors", docs).numbers["reference"].items()}


def stiffer(docs: Path = harness.DOCS) -> dict[str, tuple[float, float]]:
    """Return, by state, the change of the contact length (m) over a stiffer screen: predicted, and found.

    The prediction for the stiffest penalty is the law of order :data:`ORDER` through the two softer ones.
    """
    rows = harness.kept("errors", docs).numbers["studies"]["penalty"]
    soft, middle, stiff = (row["value"] ** -ORDER for row in rows)
    found = {}
    for state in STATES:
        length = [row["quantities"][f"{state}_contact_length"] for row in rows]
        slope = (length[1] - length[0]) / (middle - soft)
        found[state] = slope * (stiff - middle), length[2] - length[1]
    return found


# -- page ----------------------------------------------------------------------------------------------------
_HOW = """The default scene is pressed to 75 N/m, charged to 200 V and slid to full slip. Its states were solved again
on four meshes. Each has half of all sizes of the one before: the contact size (table head), growth, the size at the
Merkel sites and the size at the junctions. The limit is Richardson's extrapolation from the three finest meshes, ± the
error bar after Roache (`benchmarks/convergence.py`). An order above 2 counts as 2. Without an order the limit is the
finest value with a larger bar. SED is the strain energy density at a Merkel site.

The states start from a path on a coarse mesh. Full slip does not depend on the load path: on the default mesh, f_T
solved again differs from f_T of the whole run by at most {apart:.0e} of itself. Normal contact depends on the path; the
difference on the default mesh is part of the error bar. The limit is that of the model over its screen, whose penalty
yields; the last table of this page shows the effect of the penalty."""
_ONE = """Each table changes one size and keeps the others: contact size 10 µm, growth 0.25, 20 µm at the Merkel
sites. The **one-parameter limit** is extrapolated in this size alone. It keeps the error of the other sizes and is not
the limit of the model, which the first table gives."""
_PENALTY = """A stiffer screen shortens the contact. The default is 1500 MPa/mm. A run prints the effect of a rigid
screen by a law of order {order:g} (`fingerpad/accuracy/rigid_screen.py`). Through 500 and 1500 MPa/mm this law predicts
the change at 5000 to a factor of {factor:.1f}."""


def _bar(found: Limit, unit: float) -> str:
    return plus_minus(found.value / unit, found.bar / unit) if found.bar else f"{found.value / unit:.5g}"


def _order(found: Limit) -> str:
    return "–" if found.order is None else f"{found.order:.1f}"


def _limits(numbers: Mapping[str, Any], ends: Mapping[str, Limit]) -> str:
    whole, levels = numbers["default"], numbers["again"]["levels"]
    sizes = [f"{level['mesh']['contact'] * 1e6:.3g} µm" for level in levels]
    rows = []
    for name, (words, unit) in QUANTITIES.items():
        cells = [f"{value / unit:.5g}" for value in (whole[name], *(level["values"][name] for level in levels))]
        rows.append([words, *cells, _bar(ends[name], unit), _order(ends[name]), _percent(whole[name], ends[name])])
    rows += [
        [n, f"{whole[n]:.0f}", *(level[n] for level in levels), "", "", ""] for n in ("unknowns", "factorisations")
    ]
    return harness.table(["quantity", "default mesh", *sizes, "limit", "order", "error of the default mesh"], rows)


def _percent(value: float, end: Limit) -> str:
    return f"{100 * (value / end.value - 1):.2g} ± {100 * end.bar / abs(end.value):.1g} %"


def _study(name: str, rows: Sequence[Mapping[str, Any]]) -> str:
    heading, size, unit_name, _ = STUDIES[name]
    head = ["quantity", *(f"{row['value'] / size:g} {unit_name}".strip() for row in rows)]
    head += ["largest difference"] if name == "penalty" else ["one-parameter limit", "order"]
    lines = []
    for quantity, (words, unit) in QUANTITIES.items():
        found = [row["quantities"][quantity] for row in rows]
        if name == "penalty":
            last = [f"{100 * (max(found) / min(found) - 1):.2g} %"]
        else:
            end = limit(found) if len(found) > 2 else None
            last = ["–", "–"] if end is None else [_bar(end, unit), _order(end)]
        lines.append([words, *(f"{value / unit:.5g}" for value in found), *last])
    return f"### {heading}\n\n{harness.table(head, lines)}"


def paint(figure: Figure, numbers: Mapping[str, Any], ends: Mapping[str, Limit]) -> None:
    """Draw the distance from the limit over the mesh size, a panel a kind of quantity, with the limits' error bars."""
    panels = ("mu_app", "contact_length", "sed_0")
    axes = figure.subplots(1, len(panels), sharey=True)
    for ax, kind, title in zip(
        axes, panels, ("apparent friction", "contact length", "SED at the central site"), strict=True
    ):
        for k, state in enumerate(STATES):
            if (name := f"{state}_{kind}") in ends:
                _curve(ax, k, name, numbers, ends[name])
        ax.set(title=title, xlabel="contact size (µm)", xscale="log", yscale="log", ylim=(1e-5, 0.3))
        ax.set_xticks([1.25, 2.5, 5, 10], ["1.25", "2.5", "5", "10"])
        ax.minorticks_off()
        ax.grid(alpha=0.3)
    axes[0].set_ylabel("relative distance from the limit")
    axes[1].legend(loc="lower right")


def _curve(ax: Axes, k: int, name: str, numbers: Mapping[str, Any], end: Limit) -> None:
    """Draw a quantity of a state with the error bars of its limit, which are cut off at the axis, and the default."""
    colour, marker = list(style.STATE.values())[k], style.MARKERS[k]
    levels, beside, bar = numbers["again"]["levels"], 1 + 0.05 * (k - 1), end.bar / abs(end.value)
    sizes = [level["mesh"]["contact"] * 1e6 * beside for level in levels]
    error = np.array([abs(level["values"][name] / end.value - 1) for level in levels])
    bars = np.stack([np.minimum(bar, 0.999 * error), np.full(len(error), bar)])
    words = list(STATES.values())[k]
    ax.errorbar(sizes, error, bars, color=colour, capsize=2, marker=marker, ms=5, label=words)
    default = abs(numbers["default"][name] / end.value - 1)
    ax.plot([5 * beside], [default], "*", color=colour, ms=13, mec="black", mew=0.5)


def draw(docs: Path) -> Path:
    """Draw page and picture from the kept numbers."""
    kept, ends = harness.kept("errors", docs), known(docs)
    numbers, whole = kept.numbers, kept.numbers["default"]
    errors = {name: abs(whole[name] / end.value - 1) for name, end in ends.items()}
    worst = {kind: 100 * max(e for name, e in errors.items() if kind in name) for kind in KINDS}
    rows = numbers["studies"]["penalty"]
    rigid = [100 * (b / a - 1) for a, b in ((r[1], r[2]) for r in _penalty(rows))]
    mu, length = ends["slip_mu_app"], ends["normal_contact_length"]
    finding = (
        f"On its default mesh the default scene has a discretisation error of {worst['mu_app']:.2g} % in the apparent "
        f"friction, of at most {worst['contact_length']:.2g} % in the contact lengths and of at most "
        f"{worst['sed_']:.2g} % in the energy densities at the Merkel sites.\n\nThe limits are "
        f"µ_app = {_bar(mu, 1)} at full slip and a contact length of {_bar(length, 1e-3)} mm in charged normal "
        f"contact. The penalty acts beside the mesh: from 1500 to 5000 MPa/mm the contact lengths change by "
        f"{min(rigid[1:]):.1f} to {max(rigid[1:]):.1f} % and the friction by {rigid[0]:+.2f} %."
    )
    factor = max(max(predicted / change, change / predicted) for predicted, change in stiffer(docs).values())
    again = numbers["again"]["own"]["values"]["slip_f_t"]
    caption = (
        "Every error falls with the mesh size. Stars: the default mesh. Bars: error of the limit. "
        "One size stands for all sizes, which are halved together."
    )
    body = [
        harness.picture(docs / "errors.png", (9, 3.6), lambda figure: paint(figure, numbers, ends), caption),
        "## Limits",
        _limits(numbers, ends),
        "## One-parameter limits",
        _ONE,
        *(_study(name, numbers["studies"][name]) for name in ("contact", "growth", "receptor")),
        "## Effect of the penalty",
        _PENALTY.format(order=ORDER, factor=factor),
        _study("penalty", rows),
    ]
    how = _HOW.format(apart=max(abs(again / whole["slip_f_t"] - 1), 1e-8))
    return harness.page(
        docs / "errors.md",
        "Discretisation error of the default scene",
        finding,
        how,
        body,
        "make chart",
        kept.made,
        ["errors"],
    )


def _penalty(rows: Sequence[Mapping[str, Any]]) -> list[list[float]]:
    """Return friction and the contact lengths over the penalties."""
    names = ["slip_mu_app", *(f"{state}_contact_length" for state in STATES)]
    return [[row["quantities"][name] for row in rows] for name in names]


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
