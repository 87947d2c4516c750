"""The harness of all studies: runs that are kept, numbers that go into git, pages and pictures drawn from them.

A study has three steps:

1. :func:`run` computes those of its scenes that are missing in ``results/traces``, kept by their parameters, and
   :func:`solve` other problems;
2. :func:`keep` writes the numbers that its page shows to ``docs/NAME.json``, with the version that made them;
3. its function ``draw(docs)`` reads them by :func:`kept`, draws its pictures by :func:`picture` and puts the numbers
   in place in the pages of docs/ by :func:`page`. ``python3 -m benchmarks.pages`` does so for all, without a run.
"""

import argparse
import json
import math
import subprocess
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import date
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks import fill
from fingerpad.cli.arguments import positive
from fingerpad.results.files import replace
from fingerpad.results.pictures import style
from fingerpad.runs import processes
from fingerpad.runs.batch import Summary, sweep
from fingerpad.runs.processes import End
from fingerpad.scene import Scene

ROOT = Path(__file__).resolve().parents[1]
DOCS, RESULTS = ROOT / "docs", ROOT / "results"
PACKAGES = ("geometry", "variational", "fingerpad")
Compute = Callable[[argparse.Namespace], None]
Draw = Callable[[Path], Path]
_LINE = 400  # characters of a record that is kept on one line


# -- runs ----------------------------------------------------------------------------------------------------
def parser(description: str | None, out: str = "traces") -> argparse.ArgumentParser:
    """Return a parser of ``--out``, a folder below ``results``, ``--docs``, ``--jobs`` and ``--draw``."""
    found = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    found.add_argument("--out", type=Path, default=RESULTS / out, help="folder of runs")
    found.add_argument("--docs", type=Path, default=DOCS, help="folder of the page, its pictures and its numbers")
    found.add_argument("--jobs", type=positive, default=2, help="runs at a time")
    found.add_argument("--draw", action="store_true", help="compute nothing, draw the page from the kept numbers")
    return found


def run(scenes: Mapping[str, Scene], args: argparse.Namespace, limit: float) -> dict[str, Summary]:
    """Run the scenes that are missing in ``args.out``, each for at most ``limit`` (s); return all summaries by name."""
    return sweep(scenes, args.out, args.jobs, limit)


def solve(
    module: str, cases: Mapping[str, Any], folder: Path, jobs: int, limit: float, hours: float = math.inf
) -> dict[str, Any]:
    """Solve cases by ``python3 -m MODULE CASE LIMIT``, each in a process of its own, unless its answer is kept.

    Args:
        module: which prints the answer to a case as JSON in its last line.
        cases: data of JSON by name.
        folder: of the answers.
        jobs: processes at a time.
        limit: of the processor time of each (s).
        hours: after which none is started; such cases have no answer.

    Returns:
        The answers by name; of a process that failed its ``failure``, the reason, and ``message``.
    """
    folder.mkdir(parents=True, exist_ok=True)
    texts = {name: json.dumps(case, sort_keys=True) for name, case in cases.items()}
    files = {name: folder / f"{sha256(text.encode()).hexdigest()[:12]}.json" for name, text in texts.items()}
    found = {name: json.loads(file.read_text(encoding="utf-8")) for name, file in files.items() if file.exists()}

    def done(name: str, end: End, left: int) -> None:
        if end.reason != "STOPPED":
            failure = {"failure": end.reason, "message": end.message}
            found[name] = failure if end.reason else json.loads(end.stdout.splitlines()[-1])
            replace(files[name], json.dumps(found[name]) + "\n")
        print(f"{left:4d} left  {name}: {end.reason or 'done'} {end.message}", flush=True)

    stop = time.monotonic() + 3600 * hours

    def case(name: str) -> End:
        if time.monotonic() > stop:
            return End(0, "STOPPED", "no time is left", "")
        return processes.run(module, [texts[name], str(limit)], limit)

    processes.finish({name: partial(case, name) for name in cases if name not in found}, done, jobs)
    return found


def main(
    description: str | None,
    compute: Compute,
    draw: Draw,
    given: Sequence[str] | None = None,
    out: str = "traces",
    **options: Mapping[str, Any],
) -> int:
    """Run the command of a study: compute and keep the numbers, unless ``--draw`` is given, then draw the page.

    Args:
        description: of the study.
        compute: takes the options that were given.
        draw: of a folder of pages.
        given: words of the command; by default the program's own.
        out: folder of runs, below ``results``.
        options: of the study alone by name, as argparse takes them.
    """
    asked = parser(description, out)
    for name, form in options.items():
        asked.add_argument(f"--{name}", **form)
    args = asked.parse_args(given)
    if not args.draw:
        compute(args)
    print(draw(args.docs))
    return 0


# -- numbers -------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Made:
    """Which program made numbers, and when."""

    version: str
    commit: str
    """Empty where the runs are of several states of the program, or git is not there to name it."""
    date: str
    source: str = ""
    """Hash of the program's files; empty for older numbers, whose commit is the one that brought them into git."""

    def __str__(self) -> str:
        """Return the sentence at the end of a page."""
        if not self.source:
            return f"Numbers by version {self.version} before {self.date}, in git since commit {self.commit}."
        several = ", several commits," * (", " in self.source)
        state = f", commit {self.commit}," if self.commit else several
        return f"Numbers by version {self.version}{state} of {self.date} (source {self.source})."


def made(summaries: Iterable[Summary] = ()) -> Made:
    """Return the present program, or several commits if some of the runs were made by another state of it."""
    from fingerpad.results.provenance import provenance  # needs dolfinx, which drawing does not

    now = provenance()["versions"]
    sources = {s["provenance"]["versions"]["source"] for s in summaries if "provenance" in s} | {now["source"]}
    commit = _git("log", "-1", "--format=%h") if len(sources) == 1 else ""
    changed = " with changes" * bool(commit and _git("status", "--porcelain", "--", *PACKAGES))
    return Made(now["fingerpad"], commit + changed, date.today().isoformat(), ", ".join(sorted(sources)))


def _git(*words: str) -> str:
    try:
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""


class Record(dict[str, Any]):
    """A record of kept numbers, whose values are its attributes too."""

    def __getattr__(self, name: str) -> Any:
        return self[name]


@dataclass(frozen=True)
class Kept:
    """Numbers of a page, as JSON holds them, and who made them."""

    numbers: Any
    made: Made


def keep(name: str, numbers: Any, by: Made, docs: Path = DOCS) -> None:
    """Write numbers to ``docs/NAME.json``, short records a line each; values that are not finite become null."""
    finite = json.loads(json.dumps({"made": asdict(by), "numbers": numbers}), parse_constant=lambda _: None)
    replace(docs / f"{name}.json", text(finite) + "\n")


def text(data: Any, indent: str = "") -> str:
    """Return data as JSON, short records a line each."""
    line = json.dumps(data, ensure_ascii=False)
    if not isinstance(data, list | dict) or len(line) <= _LINE:
        return line
    inner, named = indent + " ", data.items() if isinstance(data, dict) else (("", value) for value in data)
    parts = [f'"{key}": {text(value, inner)}' if key else text(value, inner) for key, value in named]
    return f"{line[0]}\n{inner}" + f",\n{inner}".join(parts) + f"\n{indent}{line[-1]}"


def kept(name: str, docs: Path = DOCS) -> Kept:
    """Return the numbers of ``docs/NAME.json``."""
    data = json.loads((docs / f"{name}.json").read_text(encoding="utf-8"), object_hook=Record)
    return Kept(data["numbers"], Made(**data["made"]))


# -- pages ---------------------------------------------------------------------------------------------------
def page(docs: Path, name: str, command: str, names: Mapping[str, Any], *others: str) -> Path:
    """Put the numbers of a study in place in the pages that show them; return the first of these (``fill``).

    Args:
        docs: folder of the pages, the pictures and the numbers.
        name: of the study and its numbers.
        command: which computes the numbers anew.
        names: what expressions may use beside ``numbers``, the kept ones, :func:`cell`, :func:`cells` and ``origin``.
        others: names of further numbers that the study shows.

    Raises:
        ValueError: no page shows numbers of the study.
    """
    found, files = kept(name, docs), ", ".join(f"[{each}.json]({each}.json)" for each in (name, *others))
    origin = f"{found.made} Computed by `{command}` into {files}."
    if not (paths := fill.pages(docs, name)):
        raise ValueError(f"no page in {docs} has the comment <!--numbers {name}-->")
    for path in paths:
        given = {**names, "numbers": found.numbers, "cell": cell, "cells": cells, "origin": origin}
        replace(path, fill.filled(path.read_text(encoding="utf-8"), name, given))
    return paths[0]


def table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return a Markdown table; numbers have four digits, None is a dash."""
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return "\n".join([*lines, *("| " + " | ".join(map(cell, row)) + " |" for row in rows)])


def cell(value: Any, spec: str = ".4g") -> str:
    """Return a value as a table has it: a number as specified, None as a dash."""
    if value is None:
        return "–"
    return format(value, spec) if isinstance(value, float) else str(value).replace("|", "\\|").replace("\n", " ")


def cells(*values: Any, spec: str = ".4g") -> str:
    """Return values as neighbouring cells of a table."""
    return " | ".join(cell(value, spec) for value in values)


# -- pictures ------------------------------------------------------------------------------------------------
def picture(path: Path, size: tuple[float, float], paint: Callable[[Figure], None]) -> None:
    """Have a figure of width and height (inches) painted into a PNG."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with style.look():
        figure = style.figure(size[1], width=size[0])
        paint(figure)
        figure.savefig(path)


def ticks(ax: Axes, values: Sequence[float]) -> None:
    """Label the given values alone on a horizontal logarithmic axis, with a grid."""
    ax.set_xscale("log")
    ax.set_xticks(values, [f"{value:g}" for value in values])
    ax.minorticks_off()
    ax.grid(alpha=0.3)
