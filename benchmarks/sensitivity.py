"""What each open choice moves: the default scene with one assumption or parameter changed at a time.

environment/run python3 benchmarks/sensitivity.py [--jobs 2] [--contact-size 10e-6] [--draw]

Friction, contact length, its reduction by sliding, and strain energy density at the central Merkel site, as a table
and tornado plots in docs/sensitivity.md. Runs are kept in results/traces by a hash of their parameters.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from benchmarks import arguments, traces
from benchmarks.paper.style import BLUE, VERMILION, draw
from benchmarks.runs import Run
from fingerpad.cli.arguments import positive
from fingerpad.io.files import replace
from fingerpad.model.check import check
from fingerpad.model.touching import by_rule
from fingerpad.runs.batch import result, sweep
from fingerpad.scene import Scene, SceneError, from_data

_LAYERS = ("subcutis", "dermis", "viable_epidermis", "stratum_corneum")
_DEFAULTS = Scene()


def _scaled(table: str, name: str) -> dict[str, dict[str, Any]]:
    """Return a parameter 20 % lower and higher."""
    value = getattr(getattr(_DEFAULTS, table), name)
    return {f"{sign} 20 %": {table: {name: value * part}} for sign, part in (("−", 0.8), ("+", 1.2))}


def _poisson(value: float) -> dict[str, Any]:
    return {"materials": {layer: {"poisson": value} for layer in _LAYERS}}


# Elements of 20 um at the Merkel sites leave the energy density there too low by much the same part in all scenes, but
# not where the depth of the sites is what is changed: these scenes have finer ones, and are compared with one that has.
SITES, DEPTH = "elements at the Merkel sites", "depth of the Merkel sites"
_FINE_SITES = {"mesh": {"receptor": 5e-6}}

# What is changed: one or two ways of changing it. A ridge with the second coefficient c has 1 + 4 c times the curvature
# at its tip that a sinusoid of its height has.
CHOICES: Mapping[str, Mapping[str, dict[str, Any]]] = {
    "ridge's tip": {
        "half as curved": {"geometry": {"ridge_profile": [1.0, -0.125]}},
        "half again as curved": {"geometry": {"ridge_profile": [1.0, 0.125]}},
    },
    "bone's width": _scaled("geometry", "bone_width"),
    "bone's height": _scaled("geometry", "bone_height"),
    "nail's thickness": _scaled("geometry", "nail_thickness"),
    "thickness of the stratum corneum": _scaled("geometry", "sc_thickness"),
    "E_SC of the roughness": _scaled("roughness", "young"),
    "h_rms": _scaled("roughness", "h_rms"),
    "permittivity of the stratum corneum": _scaled("electric", "eps_sc"),
    "µ0": {"0.2": {"friction": 0.2}, "0.3": {"friction": 0.3}},
    "exponent of the stretches": {"+α": {"materials": {"exponent": "abaqus"}}},
    "Poisson's ratio": {"0.46": _poisson(0.46), "0.49": _poisson(0.49)},
    "p_floor": {"0.5 kPa": {"roughness": {"p_floor": 500.0}}, "2 kPa": {"roughness": {"p_floor": 2000.0}}},
    "L_R of Eq. 4": {"where y < d_eq": {"contact": {"length": "gap"}}},
    SITES: {"5 µm": _FINE_SITES},
    DEPTH: {
        "10 µm": {"geometry": {"merkel_offset": 10e-6}} | _FINE_SITES,
        "40 µm": {"geometry": {"merkel_offset": 40e-6}} | _FINE_SITES,
    },
    "200 V": {"peak to peak, 100 V": {"voltage": 100.0}},
}
QUANTITIES = ("µ_app", "L_R, normal (mm)", "reduction of L_R (%)", "SED at the central site (J/m³)")


@dataclass(frozen=True)
class Change:
    """A choice made otherwise, and what the quantities become."""

    choice: str
    way: str
    values: tuple[float, ...]


def scene(size: float, changed: Mapping[str, Any]) -> Scene:
    """Return the default scene at a contact size (m), some of it changed."""
    mesh = {"contact": size, "receptor": traces.SITES} | changed.get("mesh", {})
    return by_rule(from_data({**changed, "mesh": mesh}))


def scenes(size: float) -> dict[tuple[str, str], Scene]:
    """Return all scenes by choice and way, the default one first.

    Raises:
        SceneError: a changed finger that cannot be built, with the choice.
    """
    found = {("default", ""): scene(size, {})}
    for choice, ways in CHOICES.items():
        for way, changed in ways.items():
            found[choice, way] = scene(size, changed)
            try:
                check(found[choice, way])
            except SceneError as error:
                raise SceneError(f"{choice} {way}: {error}") from None
    return found


def values(run: Run) -> tuple[float, ...]:
    """Return the quantities of a run that reached full slip."""
    steps, normal, slip = run.steps, run.normal, run.slip
    length = steps["contact_length"]
    centre = int((len(run.receptors["ridge"]) - 1) // 2)
    return (
        float(steps["mu_app"][slip]),
        float(length[normal]) * 1e3,
        100 * float(1 - length[slip] / length[normal]),
        float(run.receptors["merkel_sed"][slip, centre]),
    )


def collect(out: Path, size: float) -> list[Change]:
    """Return what has been run; the default is the first."""
    found = []
    for (choice, way), each in scenes(size).items():
        try:
            found.append(Change(choice, way, values(Run(each, out))))
        except FileNotFoundError:
            continue
    return found


def failures(out: Path, size: float) -> list[str]:
    """Return the runs that failed, and how."""
    found = {f"{choice} {way}": result(each, out) or {} for (choice, way), each in scenes(size).items()}
    return [f"{name}: {summary['failure']}" for name, summary in found.items() if "failure" in summary]


def tornado(figure: Figure, changes: Sequence[Change]) -> None:
    """Draw a bar for each choice and quantity, the choice that moves friction most at the top."""
    default, others = changes[0], changes[1:]
    names = list(dict.fromkeys(c.choice for c in others))
    finer = next((c for c in others if c.choice == SITES), None)

    def span(name: str, k: int) -> dict[str, float]:
        """Return how far the ways of a choice move a quantity; per cent of it, or what it is in per cent itself."""
        compared = finer.values if finer is not None and name == DEPTH else default.values
        base = compared[k] if k != 2 else 100.0
        return {c.way: 100 * (c.values[k] - compared[k]) / base for c in others if c.choice == name}

    names.sort(key=lambda name: max(abs(v) for v in span(name, 0).values()))
    axes = figure.subplots(1, len(QUANTITIES), sharey=True)
    for k, (ax, quantity) in enumerate(zip(axes, QUANTITIES, strict=True)):
        for row, name in enumerate(names):
            for way, value in span(name, k).items():
                first = way == next(iter(CHOICES[name]))
                ax.barh(row, value, color=BLUE if first else VERMILION, height=0.7, alpha=0.85)
        ax.axvline(0, color="black", lw=0.8)
        ax.set_title(quantity)
        ax.set_xlabel("change (percentage points)" if k == 2 else "change (%)")
    axes[0].set_yticks(range(len(names)), names)


def write(changes: Sequence[Change], lost: Sequence[str], total: int, size: float, docs: Path) -> None:
    """Write page and picture from what has been run, and what of it did not reach full slip."""
    head = ["choice", "changed to", *QUANTITIES]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    lines += [f"| {c.choice} | {c.way} | " + " | ".join(f"{v:.4g}" for v in c.values) + " |" for c in changes]
    parts = [
        f"# What the open choices move\n\nMade by `environment/run python3 benchmarks/sensitivity.py`; do not edit. "
        f"75 N/m, 200 V, contact size {size * 1e6:g} µm, one thing changed at a time; {len(changes)} of {total} runs.",
        "\n".join(lines),
        *(f"Not reached: {words}." for words in lost),
    ]
    if len(changes) > 1 and changes[0].choice == "default":
        draw(docs / "sensitivity.png", (12, 5.5), lambda figure: tornado(figure, changes))
        parts.append("![Tornado plots: the first way blue, the second one red](sensitivity.png)")
        parts.append("*Blue: the first way of the table, red: the second.*")
    replace(docs / "sensitivity.md", "\n\n".join(parts) + "\n")


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing and write the page."""
    parser = arguments.parser(__doc__)
    parser.add_argument("--contact-size", type=positive(float), default=10e-6, help="m")
    parser.add_argument("--draw", action="store_true", help="run nothing, draw what is there")
    args = parser.parse_args(given)
    try:
        wanted = scenes(args.contact_size)
    except SceneError as error:
        parser.error(str(error))
    if not args.draw:
        sweep({f"{choice} {way}".strip(): each for (choice, way), each in wanted.items()}, args.out, args.jobs)
    changes = collect(args.out, args.contact_size)
    write(changes, failures(args.out, args.contact_size), len(wanted), args.contact_size, args.docs)
    print(f"{len(changes)} of {len(wanted)} runs; {args.docs / 'sensitivity.md'}")
    return 0 if len(changes) == len(wanted) else 1


if __name__ == "__main__":
    sys.exit(main())
