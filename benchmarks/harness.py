"""The harness of all studies: runs that are kept, numbers that go into git, pages and pictures drawn from them.

A study has three steps:

1. :func:`run` computes those of its scenes that are missing in ``results/traces``, kept by their parameters;
2. :func:`keep` writes the numbers that its page shows to ``docs/NAME.json``, with the version that made them;
3. its function ``draw(docs)`` reads them by :func:`kept` and writes page and pictures by :func:`page` and
   :func:`picture`, its texts by :func:`prose`. No run is needed: ``python3 -m benchmarks.pages`` draws all again.
"""

import argparse
import json
import math
import re
import subprocess
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import date
from functools import cache
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fingerpad.cli.arguments import positive
from fingerpad.io import style
from fingerpad.io.files import replace
from fingerpad.runs.batch import Summary, sweep
from fingerpad.scene import Scene

ROOT = Path(__file__).resolve().parents[1]
DOCS, RESULTS = ROOT / "docs", ROOT / "results"
PACKAGES = ("geometry", "variational", "fingerpad")
_LINE = 400  # characters of a record that is kept on one line
# Names of the palette for the studies.
BLACK, BLUE, GREEN, GREY = style.BLACK, style.BLUE, style.GREEN, style.GREY
ORANGE, PURPLE, SKY, VERMILION = style.ORANGE, style.PURPLE, style.SKY, style.VERMILION


# -- runs ----------------------------------------------------------------------------------------------------
def parser(description: str | None, out: str = "traces") -> argparse.ArgumentParser:
    """Return a parser of ``--out``, ``--docs``, ``--jobs`` and ``--draw``, which every long command has.

    Args:
        description: docstring of the command.
        out: folder of its runs below ``results``; scenes of the finger share the default.
    """
    found = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    found.add_argument("--out", type=Path, default=RESULTS / out, help="folder of runs")
    found.add_argument("--docs", type=Path, default=DOCS, help="folder of the page, its pictures and its numbers")
    found.add_argument("--jobs", type=positive(int), default=2, help="runs at a time")
    found.add_argument("--draw", action="store_true", help="compute nothing, draw the page from the kept numbers")
    return found


def run(scenes: Mapping[str, Scene], args: argparse.Namespace, limit: float, model: str = "full") -> dict[str, Summary]:
    """Run the scenes that are missing in ``args.out``; return the summaries of all by name.

    Args:
        scenes: by the name that is printed.
        args: of :func:`parser`.
        limit: processor time (s) of one run.
        model: as for :func:`fingerpad.runs.batch.sweep`.
    """
    return sweep(scenes, args.out, args.jobs, limit, model)


def main(
    description: str | None,
    compute: Callable[[argparse.Namespace], None],
    draw: Callable[[Path], Path],
    given: Sequence[str] | None = None,
) -> int:
    """Run the command of a study: compute and keep the numbers, unless ``--draw`` is given, then draw the page."""
    args = parser(description).parse_args(given)
    if not args.draw:
        compute(args)
    print(draw(args.docs))
    return 0


# -- numbers -------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Made:
    """Which program made numbers, and when.

    Attributes:
        version: of fingerpad.
        commit: of the program; empty where the runs are of several states of it.
        date: on which the numbers were kept, ISO 8601.
        source: hash of the program's files; empty for numbers older than this record, whose commit is the one that
            brought them into git.
    """

    version: str
    commit: str
    date: str
    source: str = ""

    def __str__(self) -> str:
        """Return the sentence at the end of a page."""
        if not self.source:
            return f"Numbers by version {self.version} before {self.date}, in git since commit {self.commit}."
        state = f"commit {self.commit}" if self.commit else "several commits"
        return f"Numbers by version {self.version}, {state}, of {self.date} (source {self.source})."


def made(summaries: Iterable[Summary] = ()) -> Made:
    """Return the present program, or several commits if some runs were made by another state of it.

    Args:
        summaries: of the runs from which the numbers are taken.
    """
    from fingerpad.io.provenance import provenance  # needs dolfinx, which drawing does not

    versions = provenance()["versions"]
    sources = {s["provenance"]["versions"]["source"] for s in summaries if "provenance" in s} | {versions["source"]}
    return Made(
        versions["fingerpad"],
        _commit() if len(sources) == 1 else "",
        date.today().isoformat(),
        ", ".join(sorted(sources)),
    )


def _commit() -> str:
    commit = _git("log", "-1", "--format=%h")
    return f"{commit} with changes" if commit and _git("status", "--porcelain", "--", *PACKAGES) else commit


def _git(*words: str) -> str:
    try:
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""


@dataclass(frozen=True)
class Kept:
    """Numbers of a page, as JSON holds them, and who made them."""

    numbers: Any
    made: Made


def keep(name: str, numbers: Any, by: Made, docs: Path = DOCS) -> None:
    """Write numbers to ``docs/NAME.json``, short records a line each; values that are not finite become null."""
    finite = json.loads(json.dumps({"made": asdict(by), "numbers": numbers}), parse_constant=lambda _: None)
    replace(docs / f"{name}.json", _text(finite) + "\n")


def _text(data: Any, indent: str = "") -> str:
    line = json.dumps(data, ensure_ascii=False)
    if not data or not isinstance(data, list | dict) or len(line) <= _LINE:
        return line
    inner = indent + " "
    if isinstance(data, list):
        left, right, parts = "[", "]", [_text(value, inner) for value in data]
    else:
        left, right, parts = "{", "}", [f'"{key}": {_text(value, inner)}' for key, value in data.items()]
    return f"{left}\n{inner}" + f",\n{inner}".join(parts) + f"\n{indent}{right}"


def kept(name: str, docs: Path = DOCS) -> Kept:
    """Return the numbers of ``docs/NAME.json``.

    Raises:
        FileNotFoundError: the study has not been computed.
    """
    data = json.loads((docs / f"{name}.json").read_text(encoding="utf-8"))
    return Kept(data["numbers"], Made(**data["made"]))


def moved(before: Any, after: Any, relative: float = 1e-3) -> list[str]:
    """Return what differs in JSON data by more than a relative difference, as ``place: before, after``.

    Runs of one scene differ by the solver's tolerance and by which steps were cut: a thousandth is neither.
    """
    old = dict(_leaves(before))
    return [
        f"{place}: was {old[place]}, is {value}"
        for place, value in _leaves(after)
        if place in old and not _same(old[place], value, relative)
    ]


def _same(a: Any, b: Any, relative: float) -> bool:
    if isinstance(a, int | float) and isinstance(b, int | float):
        return math.isclose(a, b, rel_tol=relative, abs_tol=1e-12)
    return bool(a == b)


def _leaves(data: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(data, list):
        data = dict(enumerate(data))
    if not isinstance(data, Mapping):
        yield place, data
        return
    for key, value in data.items():
        yield from _leaves(value, f"{place}/{key}")


# -- pages ---------------------------------------------------------------------------------------------------
def page(
    path: Path, title: str, finding: str, how: str, body: Iterable[str], command: str, by: Made, names: Iterable[str]
) -> Path:
    """Write a page that starts with its finding; return its path.

    Args:
        path: of the Markdown file.
        title: heading.
        finding: what the numbers show, one or a few short paragraphs.
        how: how it was found: scenes, settings, definitions.
        body: sections, tables and pictures in Markdown; empty ones are left out.
        command: computes the numbers anew, for example ``make paper``.
        by: who made the numbers.
        names: of the files of numbers, ``docs/NAME.json``.
    """
    files = ", ".join(f"[{name}.json]({name}.json)" for name in names)
    origin = f"{by} Computed by `{command}` into {files}; drawn from there by `make pages`: do not edit this page."
    parts = [f"# {title}", finding, "## How the numbers were found", how, *body, f"---\n\n{origin}"]
    replace(path, "\n\n".join(part.strip() for part in parts if part.strip()) + "\n")
    return path


@cache
def prose(name: str) -> dict[str, str]:
    """Return the texts of a page by their headings in ``benchmarks/prose/NAME.md``, with places to fill in braces."""
    text = (ROOT / "benchmarks" / "prose" / f"{name}.md").read_text(encoding="utf-8")
    parts = re.split(r"^# (\w+)\n", text, flags=re.MULTILINE)
    return {heading: words.strip() for heading, words in zip(parts[1::2], parts[2::2], strict=True)}


def table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return a Markdown table; numbers have four digits, None is a dash."""
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return "\n".join([*lines, *("| " + " | ".join(map(_cell, row)) + " |" for row in rows)])


def _cell(value: Any) -> str:
    if value is None:
        return "–"
    return f"{value:.4g}" if isinstance(value, float) else str(value).replace("|", "\\|").replace("\n", " ")


def folded(summary: str, body: str) -> str:
    """Return a part of a page that opens on a click, for long tables."""
    return f"<details><summary>{summary}</summary>\n\n{body}\n\n</details>"


# -- pictures ------------------------------------------------------------------------------------------------
def picture(path: Path, size: tuple[float, float], paint: Callable[[Figure], None], caption: str) -> str:
    """Have a figure painted, keep it as a PNG and return the Markdown that shows it on a page beside it.

    Args:
        path: of the PNG.
        size: width and height (inches).
        paint: draws into the figure; axes are labelled with units.
        caption: one sentence that says what the picture shows.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with style.look():
        figure = style.figure(size[1], size[0])
        paint(figure)
        figure.savefig(path)
    return f"![{caption}]({path.name})\n\n*{caption}*"


def ticks(ax: Axes, values: Sequence[float], grid: bool = True) -> None:
    """Label the given values alone on a horizontal logarithmic axis."""
    ax.set_xscale("log")
    ax.set_xticks(values, [f"{value:g}" for value in values])
    ax.minorticks_off()
    if grid:
        ax.grid(alpha=0.3)
