"""The page: every program beside fingerpad, state by state, and a picture of the tractions."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.harness import kept, page, picture, table
from benchmarks.peers import speed
from benchmarks.peers.exchange import TASKS, Answer, Array, Ridge, answer_path, cases
from benchmarks.peers.quantities import differences, values
from fingerpad.results.style import BLUE, GREEN, ORANGE, VERMILION

FORCE, SHAPE = 5e-4, 1e-2  # bars: relative differences of forces, and of half-width and peak pressure
_BARS = (FORCE, FORCE, SHAPE, SHAPE)
_HEAD = ["program", "F_n (N/mm)", "F_t (N/mm)", "half-width (mm)", "peak pressure (MPa)"]
# Colour, marker, and whether it is filled: a variant that explains a program lies in the middle of its marker.
_STYLES = {"NGSolve": (BLUE, "o", False), "GetFEM": (GREEN, "x", False), "FElupe": (ORANGE, "s", False),
           "NGSolve, as FElupe": (ORANGE, "s", True), "CalculiX": (VERMILION, "^", False),
           "NGSolve, as CalculiX": (VERMILION, "^", True)}  # fmt: skip
_HOW = """One papillary ridge, 0.483 mm wide and 0.6 mm high, is pressed by 0.06 mm on a rigid plane in 20 equal steps,
without friction and with a coefficient of 0.25. Its top and sides are then moved sideways by 5 µm in 10 steps and on to
50 µm in 15. The material is the paper's stratum corneum: G_0 = 0.08676 MPa, exponent 14.53 of the modified stretches,
ν = 0.48, plane strain. The penalty is 1000 N/mm³, the tangential one 100 N/mm³, both per reference area. All programs
read the same mesh of six-node triangles and take the same steps. Each uses its own assembly, differentiation and
contact, or weak forms written anew in its own language. Half the contact's current length is found from the skin's
displaced nodes in the same way for all. The peak pressure is the largest at a program's own contact points.

Differences are from fingerpad; **!** marks one above 0.05 % of a force or 1 % of half-width or peak pressure. Friction
is zero by symmetry in the pressed ridge, and its difference there is not judged."""


# -- numbers -------------------------------------------------------------------------------------------------
def numbers(folder: Path) -> dict[str, Any]:
    """Return what the page shows of the answers in a folder, ready for JSON."""
    programs, meshes = dict[str, list[str]](), []
    for size in sorted((float(path.stem) for path in folder.glob("*.npz")), reverse=True):
        ridge = Ridge.read(folder / f"{size:g}.npz")
        mesh: dict[str, Any] = {"size": size, "triangles": len(ridge.triangles), "states": [], "iterations": {}}
        for name in cases():
            tasks = [("", "ours"), *((variant, peer) for case, variant, peer in TASKS if case == name)]
            paths = [(variant, answer_path(folder, size, name, variant, peer)) for variant, peer in tasks]
            answers = [(variant, Answer.read(path)) for variant, path in paths if path.exists()]
            programs |= {a.program: [a.program, a.version, a.licence] for _, a in answers}
            mesh["iterations"][name] = {a.program: a.iterations for variant, a in answers if not variant}
            mesh["states"] += [_state(k, answers, ridge) for k in range(len(answers[0][1].states))]
        meshes.append(mesh)
    return {"programs": list(programs.values()), "meshes": meshes}


def _state(k: int, answers: Sequence[tuple[str, Answer]], ridge: Ridge) -> dict[str, Any]:
    rows = list[dict[str, Any]]()
    for variant, answer in answers:
        found, label = values(answer.states[k], ridge), f"{answer.program}, {variant}" if variant else answer.program
        compared = {"differences": differences(found, rows[0]["values"])} if rows else {}
        rows.append({"program": label, "values": found} | compared)
    return {"name": answers[0][1].states[k].name, "rows": rows}


# -- page ----------------------------------------------------------------------------------------------------
def line(row: dict[str, Any]) -> list[str]:
    """Return a row of a table, with differences from fingerpad."""
    cells = [row["program"]]
    for value, difference, bar in zip(row["values"], row.get("differences", [None] * 4), _BARS, strict=True):
        mark = "**!** " if difference is not None and abs(difference) > bar else ""
        cells.append(f"{value:.6f}" + ("" if difference is None else f" ({mark}{100 * difference:+.4f} %)"))
    return cells


def largest(rows: Iterable[dict[str, Any]]) -> list[list[str]]:
    """Return a row a program of its largest differences in all states, variants apart."""
    found = dict[str, Array]()
    for row in rows:
        if "differences" in row:
            sizes = np.array([abs(d or 0.0) for d in row["differences"]])
            found[row["program"]] = np.maximum(sizes, found.get(row["program"], 0.0))
    return [[program, *(f"{100 * d:.2g} %" if d > 5e-7 else "0" for d in some)] for program, some in found.items()]


def paint(figure: Figure, states: Sequence[dict[str, Any]]) -> None:
    """Draw the differences of each program over the states, and the variants that explain them; a panel a quantity."""
    axes = figure.subplots(1, 4, sharex=True)
    for k, (ax, name, bar) in enumerate(zip(axes, _HEAD[1:], _BARS, strict=True)):
        ax.axhspan(-100 * bar, 100 * bar, color="0.9", lw=0, label="agreement, as judged here")
        for program, (colour, marker, face) in _STYLES.items():
            rows = [(n, row) for n, state in enumerate(states) for row in state["rows"] if row["program"] == program]
            known = [(n, row["differences"][k]) for n, row in rows if row["differences"][k] is not None]
            x, y = np.reshape(known, (-1, 2)).T
            look = {"color": colour, "mfc": colour if face else "none", "ms": 5 if face else 9, "label": program}
            ax.plot(x, 100 * y, marker, **look)
        ax.set_yscale("symlog", linthresh=0.01)
        ax.set_xticks(range(len(states)), [state["name"].replace(" with", "\nwith") for state in states], rotation=60)
        ax.set(title=name.split(" (")[0], ylim=(-5, 5))
    axes[0].set_ylabel("difference from fingerpad (%)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)


def draw(docs: Path) -> Path:
    """Write docs/peers.md and its picture from docs/peers.json."""
    found = kept("peers", docs)
    told = found.numbers
    every = [row for mesh in told["meshes"] for state in mesh["states"] for row in state["rows"]]
    summary = largest(row for row in every if "," not in row["program"])
    exact = " and ".join(row[0] for row in summary if set(row[1:]) == {"0"}) or "no program"
    finding = (
        f"Of {len(summary)} other programs that solve the same ridge on the same mesh, {exact} agree with fingerpad "
        "in all printed digits. The others define their contact differently, and this explains their differences. The "
        f"largest ones of all states and meshes are:\n\n{table(_HEAD, summary)}"
    )
    caption = "Differences on the finest mesh. A filled marker inside a hollow one explains the difference."
    finest = told["meshes"][-1]["states"]
    body = [
        table(["program", "version", "licence"], told["programs"]),
        speed.section(told["speed"]) if "speed" in told else "",
        (Path(__file__).parent / "reasons.md").read_text(encoding="utf-8"),
        picture(docs / "peers.png", (13, 5), lambda figure: paint(figure, finest), caption),
    ]
    for mesh in told["meshes"]:
        body.append(f"## Facets of {mesh['size']:g} µm ({mesh['triangles']} triangles)")
        body += [f"**{s['name'].capitalize()}**\n\n{table(_HEAD, map(line, s['rows']))}" for s in mesh["states"]]
        rows = [[name, *some.values()] for name, some in mesh["iterations"].items()]
        body.append(table(["iterations", *next(iter(mesh["iterations"].values()))], rows))
    title, command = "Other codes, same problem", "benchmarks/peers/run"
    return page(docs / "peers.md", title, finding, _HOW, body, command, found.made, ["peers"])
