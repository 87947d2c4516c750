"""Meshes, cases and fingerpad's answers before the peers run, numbers and page after; benchmarks/peers/run does both.

environment/run python3 -m benchmarks.peers prepare FOLDER SIZE ... | page FOLDER | prepare-timed FOLDER | timed FOLDER
environment/run python3 -m benchmarks.peers equal

The answers of programs are compared by forces, half-width and peak pressure, the page's picture shows the tractions'.
Processor times are of all programs along the same ten states, beside their errors.
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.polynomial import Polynomial

from benchmarks.harness import DOCS, RESULTS, keep, kept, made, page, picture, table
from benchmarks.peers import at_equal_error
from benchmarks.peers.exchange import TASKS, TIMED, Answer, Array, Ridge, State, answer_path, cases, timed, write
from fingerpad.results.style import BLUE, ORANGE

FORCE, SHAPE = 5e-4, 1e-2  # bars: relative differences of forces, and of half-width and peak pressure
_BARS = (FORCE, FORCE, SHAPE, SHAPE)
_ROUNDED = 5e-7  # a difference that is zero in all printed digits
SIZES, FINEST, REPEATS = (10.0, 2.5), 1.25, ("1", "2", "3")  # µm, of the timed runs
SLOW = ("felupe",)  # run once
UNSTEADY = 0.15  # relative spread of repeats, above which the page says so
OURS, PLAIN = ("fingerpad", "plain dolfinx"), "plain dolfinx"
_HEAD = ["program", "F_n (N/mm)", "F_t (N/mm)", "half-width (mm)", "peak pressure (MPa)"]
# Colour, marker, and whether it is filled: a variant that explains a program lies in the middle of its marker.
_STYLES = {"NGSolve": (BLUE, "o", False), "FElupe": (ORANGE, "s", False), "NGSolve, as FElupe": (ORANGE, "s", True)}


# -- before ----------------------------------------------------------------------------------------------------
def prepare(folder: Path, sizes: list[float]) -> None:
    """Write meshes, cases, the tasks of the peers, and the answers of fingerpad."""
    from benchmarks.peers import ours  # needs dolfinx, which a reader of answers does not

    folder.mkdir(parents=True, exist_ok=True)
    tasks = []
    for size in sizes:
        mesh = folder / f"{size:g}.npz"
        body = ours.make(size * 1e-3)
        ridge = ours.for_peers(body)
        ridge.save(mesh)
        for name, case in cases().items():
            answer = ours.solve(case, body, ridge.points[ridge.skin].reshape(-1, 2))
            write(answer, answer_path(folder, size, name, "", "ours"))
            print(f"fingerpad: {name}, facets of {size:g} µm, {answer.iterations} iterations", flush=True)
        for name, variant, peer in TASKS:
            case_path = folder / f"{name}_{variant}.json".replace(" ", "_")
            write(replace(cases()[name], variant=variant), case_path)
            tasks.append(f"{peer} {case_path} {mesh} {answer_path(folder, size, name, variant, peer)}")
    (folder / "tasks").write_text("\n".join(tasks) + "\n", encoding="utf-8")


def prepare_timed(folder: Path) -> None:
    """Write meshes, the timed case, and the tasks of all programs."""
    from benchmarks.peers import ours

    folder.mkdir(parents=True, exist_ok=True)
    write(timed(), case := folder / "case.json")
    for size in (*SIZES, FINEST):
        ours.for_peers(ours.make(size * 1e-3)).save(folder / f"{size:g}.npz")
    lines = [
        f"{program} {case} {folder / f'{size:g}.npz'} {answer_path(folder, size, 'timed', repeat, program)}"
        for size, repeat, program in _tasks()
    ]
    (folder / "tasks").write_text("\n".join(lines) + "\n", encoding="utf-8")


def _tasks() -> list[tuple[float, str, str]]:
    """Return size (µm), repeat and program of every answer; programs take turns."""
    every = [(size, repeat, program) for repeat in REPEATS for size in SIZES for program in TIMED]
    return [task for task in every if task[1] == "1" or task[2] not in SLOW] + [(FINEST, "1", "ours")]


# -- quantities ------------------------------------------------------------------------------------------------
_TO_POWERS = np.linalg.inv(np.vander([0.0, 1.0, 0.5], increasing=True))  # of the coordinate along an edge


def values(state: State, ridge: Ridge) -> list[float]:
    """Return normal force, friction (N/mm), half-width (mm) and peak pressure (MPa) of a state."""
    return [state.f_n, state.f_t, half_width(ridge, state), max(state.p_n)]


def half_width(ridge: Ridge, state: State) -> float:
    """Return half the current length (mm) of the skin below the plane, its ends located inside edges."""
    places = ridge.points[ridge.skin] + np.array(state.displacement).reshape(-1, 3, 2)
    return sum(_length_below(edge) for edge in places) / 2


def _length_below(edge: Array) -> float:
    """Return the length over which the parabola through an edge's nodes, shape (3, 2), has y < 0."""
    x, y = (Polynomial(_TO_POWERS @ z) for z in edge.T)
    roots = y.roots()
    real = roots[np.abs(np.imag(roots)) < 1e-12].real
    cuts = [0.0, *np.sort(real[(real > 0) & (real < 1)]), 1.0]
    gauss, weights = np.polynomial.legendre.leggauss(6)
    length = 0.0
    for a, b in zip(cuts, cuts[1:], strict=False):
        if y((a + b) / 2) < 0:
            xi = (a + b) / 2 + (b - a) / 2 * gauss
            length += (b - a) / 2 * float(weights @ np.hypot(x.deriv()(xi), y.deriv()(xi)))
    return length


def differences(found: Sequence[float], reference: Sequence[float]) -> list[float | None]:
    """Return relative differences; None for friction that vanishes by symmetry."""
    judged = (True, abs(reference[1]) > 1e-2 * reference[0], True, True)
    return [a / b - 1 if judge else None for a, b, judge in zip(found, reference, judged, strict=True)]


# -- numbers ---------------------------------------------------------------------------------------------------
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


def speeds(folder: Path) -> dict[str, Any]:
    """Return what the section shows of the answers in a folder, ready for JSON; programs that failed are left out."""
    finest = Answer.read(answer_path(folder, FINEST, "timed", "1", "ours"))
    ridge = Ridge.read(folder / f"{FINEST:g}.npz")
    exact = [values(state, ridge) for state in finest.states]
    meshes, loads = [], list[float]()
    for size in SIZES:
        ridge, rows = Ridge.read(folder / f"{size:g}.npz"), []
        for program in TIMED:
            paths = [answer_path(folder, size, "timed", repeat, program) for repeat in REPEATS]
            if answers := [Answer.read(path) for path in paths if path.exists()]:
                rows.append(_timed(answers, ridge, exact))
                loads += [answer.load for answer in answers]
        meshes.append({"size": size, "triangles": len(ridge.triangles), "rows": rows})
    return {"finest": FINEST, "repeats": len(REPEATS), "load": [min(loads), max(loads)], "meshes": meshes}


def _timed(answers: Sequence[Answer], ridge: Ridge, exact: Sequence[Sequence[float]]) -> dict[str, Any]:
    """Return the least times of a program's repeats, its work, and its largest errors of all states."""
    one, seconds = answers[0], [answer.seconds for answer in answers]
    pairs = zip(one.states, exact, strict=True)
    errors = [[abs(d or 0.0) for d in differences(values(state, ridge), best)] for state, best in pairs]
    return {
        "program": one.program,
        "setup": min(answer.setup for answer in answers),
        "seconds": min(seconds),
        "spread": max(seconds) / min(seconds) - 1 if len(seconds) > 1 else None,
        "iterations": one.iterations,
        "factorisations": one.factorisations or one.iterations,
        "errors": np.max(errors, axis=0).tolist(),
    }


# -- page ------------------------------------------------------------------------------------------------------
def _line(row: dict[str, Any]) -> list[str]:
    """Return a row of a table, with differences from fingerpad."""
    cells = [row["program"]]
    for value, difference, bar in zip(row["values"], row.get("differences", [None] * 4), _BARS, strict=True):
        mark = "**!** " if difference is not None and abs(difference) > bar else ""
        cells.append(f"{value:.6f}" + ("" if difference is None else f" ({mark}{100 * difference:+.4f} %)"))
    return cells


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


def _mesh(mesh: dict[str, Any]) -> str:
    """Return the section of a mesh: its states, and the iterations of all programs."""
    parts = [f"## Facets of {mesh['size']:g} µm ({mesh['triangles']} triangles)"]
    parts += [f"**{s['name'].capitalize()}**\n\n{table(_HEAD, map(_line, s['rows']))}" for s in mesh["states"]]
    rows = [[name, *some.values()] for name, some in mesh["iterations"].items()]
    return "\n\n".join([*parts, table(["iterations", *next(iter(mesh["iterations"].values()))], rows)])


def draw(docs: Path) -> Path:
    """Write docs/verification.md and its picture from docs/peers.json."""
    found, summary = kept("peers", docs).numbers, dict[str, Array]()
    for row in (row for mesh in found["meshes"] for state in mesh["states"] for row in state["rows"]):
        if "differences" in row and "," not in row["program"]:
            sizes = np.array([abs(d or 0.0) for d in row["differences"]])
            summary[row["program"]] = np.maximum(
                np.where(sizes > _ROUNDED, sizes, 0.0), summary.get(row["program"], 0.0)
            )
    picture(docs / "peers.png", (13, 5), lambda figure: paint(figure, found["meshes"][-1]["states"]))
    rows = found["equal"]["rows"]
    picture(docs / "peers_equal_error.png", (11, 4), lambda figure: at_equal_error.paint(figure, rows))
    timed = found["speed"]["meshes"]
    names = {
        "summary": summary,
        "speed": found["speed"],
        "equal": found["equal"],
        "ratios": [{row["program"]: row["seconds"] / m["rows"][0]["seconds"] for row in m["rows"]} for m in timed],
        "spread": max(row["spread"] or 0.0 for m in timed for row in m["rows"]),
        "meshes": "\n\n".join(map(_mesh, found["meshes"])),
        **at_equal_error.words(rows),
    }
    return page(docs, "peers", "benchmarks/peers/run", globals() | names)


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=("prepare", "page", "prepare-timed", "timed", "equal"))
    parser.add_argument("folder", type=Path, nargs="?", default=RESULTS / "peers")
    parser.add_argument("sizes", type=float, nargs="*")
    args = parser.parse_args()
    if args.action == "prepare":
        prepare(args.folder, args.sizes)
    elif args.action == "prepare-timed":
        prepare_timed(args.folder)
    else:
        old, by = kept("peers", DOCS), made()
        text = {"made": f"version {by.version} of {by.date} (source {by.source})"}
        if args.action == "page":
            found = {name: old.numbers[name] for name in ("speed", "equal")} | numbers(args.folder)
        elif args.action == "timed":
            found = old.numbers | {"speed": speeds(args.folder) | text}
        else:
            from benchmarks.peers import equal  # needs dolfinx

            found = old.numbers | {"equal": equal.numbers() | text}
        keep("peers", found, by if args.action == "page" else old.made, DOCS)
        print(draw(DOCS))


if __name__ == "__main__":
    main()
