"""Findings on human fingers beside this model's numbers, row by row.

environment/run python3 -m benchmarks.measured [ROW … | FINGER …] [--jobs 2] [--draw]     also: make measured ROW=softer
environment/run python3 -m benchmarks.measured --felt       the numbers of what is felt, ten minutes

Rows are those of data/findings.toml. Each is computed with the finger that it names, from runs that rows share and that
are kept in results/traces, so that an interrupted command goes on. With names of rows or fingers it prints these
and keeps nothing. Otherwise it writes docs/measured.json, and from it docs/measured.md and its picture. Numbers of what
is felt are those of docs/felt.json, and those of viscous skin of docs/viscosity.json (make viscosity).
"""

import argparse
import sys
import tomllib
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from benchmarks import harness
from benchmarks.harness import cells
from benchmarks.measured import drives, felt, felt_rows, findings, fingers, rows, rules
from benchmarks.measured.findings import Finding
from benchmarks.measured.fingers import Case
from benchmarks.runs import Unfinished
from fingerpad.results.pictures import style
from fingerpad.scene import Scene

_LIMIT = 1500.0  # s of processor time for one run
_OF_DRY = ("stuck_wet", "friction_humid", "friction_moist_palm", "friction_time")
_BESIDE = {"gap_sliding": "held", **dict.fromkeys(_OF_DRY, "fitted")}
"""Fingers whose runs a row needs too."""
STATES = {
    "fitted": "dry",
    "moist": "sweating or wetted",
    "held": "some 10 s and more on glass",
    "paper": "the default finger: the finding names no state, or its runs would be too long for another",
}
"""Of the fingers that findings name."""
_KEPT = {"felt": felt_rows.ROWS, "viscosity": rows.TIMED}
"""Rows of the numbers that other commands keep."""
_COMPUTED: dict[str, Any] = {**rows.ROWS, **felt_rows.ROWS, **rows.TIMED}


# -- runs ------------------------------------------------------------------------------------------------------
def chosen(names: Collection[str], every: Mapping[str, Finding]) -> list[Finding]:
    """Return the computable findings of the names of rows and fingers, all without one."""
    found = [row for row in every.values() if row.id in _COMPUTED]
    return [row for row in found if not names or {row.id, row.finger} & set(names)]


def scenes(wanted: Sequence[Finding]) -> dict[str, Scene]:
    """Return the scenes that findings need, by finger and kind."""
    needed = {row.finger for row in wanted if row.id in rows.ROWS and row.id not in drives.WITHOUT_RUNS}
    names = [name for name in fingers.NAMES if name in needed | {_BESIDE.get(row.id) for row in wanted}]
    return {f"{name}: {kind}": scene for name in names for kind, scene in fingers.scenes(name).items()}


def judged(wanted: Sequence[Finding], out: Path, docs: Path) -> Iterator[tuple[str, dict[str, float], str]]:
    """Yield for each finding its name, numbers and verdict; without its runs it is not computed."""
    every = fingers.fingers(fingers.NAMES, out)
    beside = {each: harness.kept(name, docs).numbers for name, part in _KEPT.items() for each in part}
    for row in wanted:
        try:
            if row.id in rows.ROWS:
                found = rows.ROWS[row.id](Case(row, every[row.finger], every))
            else:
                found = _COMPUTED[row.id](beside[row.id])
        except Unfinished as error:
            print(f"{row.id}: {error}")
            found = {}, rules.OPEN
        yield row.id, {name: float(value) for name, value in found[0].items()}, found[1]


def compute(args: argparse.Namespace) -> None:
    """Run what is missing; print the rows that are named, or keep all."""
    every, _ = findings.read()
    if unknown := set(args.names) - {row.id for row in chosen((), every)} - set(fingers.NAMES):
        raise SystemExit(f"{min(unknown)} is neither a row that is computed nor one of {', '.join(fingers.NAMES)}")
    wanted = chosen(args.names, every)
    summaries = harness.run(scenes(wanted), args, _LIMIT)
    found = {}
    for name, numbers, verdict in judged(wanted, args.out, args.docs):
        found[name] = {"numbers": numbers, "verdict": verdict}
        print(f"{verdict:>12}  {name}: {_ours(name, numbers)}")
    if not args.names:
        missing = [name for name, summary in summaries.items() if "failure" in summary]
        harness.keep("measured", {"rows": found, "missing": missing}, harness.made(summaries.values()), args.docs)


# -- page ------------------------------------------------------------------------------------------------------
class Row(NamedTuple):
    """A finding with its verdict and its texts."""

    finding: Finding
    ours: str
    verdict: str
    cause: str
    source: str


with (Path(__file__).parent / "words.toml").open("rb") as _file:
    WORDS: dict[str, dict[str, str]] = tomllib.load(_file)
"""By finding ``ours``, a template of its numbers, and ``cause``: of what is not a hit, with what would meet it."""


def _ours(name: str, numbers: Mapping[str, float]) -> str:
    if not numbers and "{" in WORDS[name]["ours"]:
        return "–"
    return WORDS[name]["ours"].format(**numbers).replace("%", " %")


def table(docs: Path) -> list[Row]:
    """Return all rows of the page from the kept numbers of a folder."""
    every, sources = findings.read()
    kept, places = harness.kept("measured", docs).numbers["rows"], {name: k for k, name in enumerate(sources, start=1)}
    found = []
    for name, row in every.items():
        numbers, verdict = kept[name].values() if name in kept else ({}, rules.OPEN)
        link = f"[{places[row.source]}]({sources[row.source].link or '#sources'})"
        ours = _ours(name, numbers) if name in kept else "–"
        missed = verdict in (rules.PART, rules.MISS)
        cause = row.why if row.role == "context" else WORDS[name].get("cause", "") if missed else ""
        found.append(Row(row, ours, verdict, cause, link))
    return found


def line(row: Row) -> str:
    """Return a row of the page's tables."""
    finding = row.finding
    role = {"fit": " (fitted)", "context": " (context)"}.get(finding.role, " (by construction)" * finding.built)
    area = f" [{finding.area}]" if finding.area else ""
    verdict = f"**{row.verdict}**{role}{f': {row.cause}' if row.cause else ''}"
    words = f"{finding.quantity}{area}; {finding.condition} {row.source}"
    return cells(words, finding.measured, f"`{finding.finger}`", row.ours, verdict)


def judges(every: Sequence[Row], finger: str = "") -> Counter[str]:
    """Return how many rows have each verdict, of those that judge and are no hits by construction."""
    own = [row for row in every if row.finding.role == "judge" and finger in ("", row.finding.finger)]
    return Counter(row.verdict for row in own if not (row.finding.built and row.verdict == rules.HIT))


def side(row: Row) -> str:
    """Return a row's part of the table of contradictions."""
    finding = row.finding
    return cells(f"{finding.quantity}, {finding.measured} {row.source}, `{finding.finger}`", f"**{row.verdict}**")


def site_error(errors: Any) -> float:
    """Return the largest known error of energy densities at Merkel sites on the default path mesh, over their value."""
    found, limits = errors["again"]["path"]["values"], errors["reference"]
    return float(max(abs(found[key] / limits[key]["value"] - 1) for key in limits if "_sed_" in key))


def draw(docs: Path) -> Path:
    """Write docs/measured.md and its picture from docs/measured.json."""
    every, field = table(docs), harness.kept("felt", docs).numbers["subfield"]
    harness.picture(docs / "measured.png", (10, 4), lambda figure: _paint(figure, field, every))
    by_name, (rows_, sources) = {row.finding.id: row for row in every}, findings.read()
    names: dict[str, Any] = {"every": every, "sources": sources, "count": judges(every)}
    names |= {"pairs": [[by_name[each.id] for each in pair] for pair in findings.pairs(rows_)]}
    names |= {"site_error": site_error(harness.kept("errors", docs).numbers)}
    names |= {"fits": [row for row in every if row.finding.role == "fit"], "judging": [*filter(_judges, every)]}
    return harness.page(docs, "measured", "make measured", globals() | names, "felt", "viscosity")


def _judges(row: Row) -> bool:
    return row.finding.role == "judge"


def _paint(figure: Figure, field: Mapping[str, Any], every: Sequence[Row]) -> None:
    """Draw the verdicts by topic, and the stress of one site under a moving line load."""
    left, right = figure.subplots(1, 2)
    topics = list(dict.fromkeys(row.finding.topic for row in filter(_judges, every)))
    found, start = [judges([row for row in every if row.finding.topic == topic]) for topic in topics], [0] * len(topics)
    looks = {rules.HIT: style.BLUE, rules.PART: style.ORANGE, rules.MISS: style.VERMILION, rules.OPEN: "lightgrey"}
    for verdict, colour in looks.items():
        left.barh(topics, [each[verdict] for each in found], left=start, color=colour, label=verdict)
        start = [before + each[verdict] for before, each in zip(start, found, strict=True)]
    left.set(xlabel="findings that judge", title="A  verdicts by topic")
    left.invert_yaxis()
    left.legend(fontsize=8)
    right.plot(1e3 * np.array(field["s"]), field["stress"], color=style.BLUE)
    right.axvspan(-0.2, 0.2, color=style.ORANGE, alpha=0.3, lw=0, label="measured subfield, 0.4 mm")
    right.set(xlabel="place of the line load along the skin (mm)", title="B  stress at a Merkel site, line load")
    right.legend(loc="lower center", fontsize=8)


def main(given: Sequence[str] | None = None) -> int:
    """Run the command."""
    parser = harness.parser(__doc__)
    parser.add_argument("names", nargs="*", metavar="ROW", help="rows or fingers; all without a name")
    parser.add_argument("--felt", action="store_true", help="compute the numbers of what is felt alone")
    args = parser.parse_args(given)
    if args.felt:
        felt.compute(args)
    elif not args.draw:
        compute(args)
    if not args.names:
        print(draw(args.docs))
    return 0


if __name__ == "__main__":
    sys.exit(main())
