"""How often is the printed error large enough? The estimate against all errors that are known.

environment/run python3 benchmarks/calibration.py

The known cases are the rows of docs/accuracy.md: whole runs against the limits of their scenes, one size at a time,
and Hertz's contact. This program reads them, keeps them in docs/calibration.json and writes the last section of the
page, with what docs/errors.json says of the penalty; it runs no scene. fingerpad/richardson.py takes its factors of
safety from here; tests/test_calibration.py holds them to the coverage wanted. All but the last table is of the
discretisation alone: limits and runs have the same penalty.
"""

import json
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks import arguments
from fingerpad.accuracy.rigid_screen import ORDER
from fingerpad.io.files import replace, replace_json
from fingerpad.io.states import WORDS
from fingerpad.richardson import MORE, ONCE

WANTED = 0.9  # of the cases of each kind
KINDS = {"friction": ("µ_app", "f_T"), "contact length": ("contact length",), "energy density": ("SED",)}
_HEADING = "## Calibration of the estimate"
_SECTION = """{heading}

Made by `environment/run python3 benchmarks/calibration.py` from the tables above; each case is in
[calibration.json](calibration.json). A run prints the estimate times a factor of safety as its *estimated
discretisation error*: {once:g} for the share of a size that was halved or doubled once, {more:g} for one that was
halved more often (`fingerpad/richardson.py`). *Covered*: the factor times the estimate is at least the error. Where a
run has sizes of both sorts, the smaller factor is taken here for all of them, so that the run prints more. Cases whose
error is below its own bar are left out. A scene gives several cases, so that they are not independent. The lengths not
covered with sizes changed once are Hertz's, of one contact with two edges that are off alike. The penalty has no part
in any of this: limits and runs have the same.

| quantity | sizes changed | cases | covered by the estimate | with its factor |
|---|---|---|---|---|
{rows}

Beside it a run tells what a rigid screen would change (`fingerpad/accuracy/rigid_screen.py`), from its states over a
screen of twice the stiffness. In the default scene at a contact size of 10 µm, what 500 and 1500 MPa/mm predict of 5000
by that law of order {order:g}, and what 5000 changes ([errors.json](errors.json)):

| contact length | from 1500 to 5000 MPa/mm, predicted (mm) | found (mm) |
|---|---|---|
{stiffer}"""
_STATES = {"press": WORDS["uncharged"], "normal": WORDS["charged"], "slip": WORDS["full_slip"]}
_SCENE, _KNOB, _HERTZ = 7, 5, 5  # columns of the tables
_FIRST = {"Contact size": "10 µm", "Growth": "0.25", "Size at": "20 µm"}  # of a knob, with one coarser run before it
_ALONE = "default scene as it is"


@dataclass(frozen=True)
class Case:
    """An estimate whose error is known; numbers in per cent of the limit."""

    source: str
    """Section of docs/accuracy.md."""
    scene: str
    quantity: str
    kind: str
    """Of :data:`KINDS`."""
    once: bool
    """Whether every size was halved or doubled once."""
    estimate: float
    """Without a factor of safety."""
    error: float
    bar: float
    """Of the error."""

    @property
    def clear(self) -> bool:
        """Whether the error is known to be one."""
        return self.error > self.bar

    @property
    def factor(self) -> float:
        """The smallest factor of safety of its sizes."""
        return ONCE if self.once else MORE

    def covered(self, factor: float) -> bool:
        """Return whether the error is within so many times the estimate."""
        return self.error <= factor * self.estimate


def read(page: str) -> list[Case]:
    """Return the cases of docs/accuracy.md."""
    found = list[Case]()
    for heading, rows in _sections(page):
        first = next((at for words, at in _FIRST.items() if heading.startswith(words)), None)
        if heading.startswith("Accuracy asked for"):
            found += _loops(heading, rows)
        elif first is not None:
            for name, at, estimate, error, _ in (row for row in rows if len(row) == _KNOB and _number(row[2])):
                found.append(_case(heading, at, name, at == first, estimate, error))
        elif heading.startswith("Hertz"):
            widths = set[str]()
            for a, facets, estimate, error, _ in (row for row in rows if len(row) == _HERTZ and "." in row[0]):
                found.append(_case(heading, f"{a} mm, {facets} facets", "contact length", a not in widths,
                                   estimate, f"{error} ± 0.04"))  # fmt: skip
                widths.add(a)
    return found


def _sections(page: str) -> Iterator[tuple[str, list[list[str]]]]:
    for part in re.split(r"^#+ ", page.split(_HEADING)[0], flags=re.MULTILINE):
        lines = part.splitlines()
        rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
        yield (lines[0] if lines else ""), rows


def _loops(heading: str, rows: Iterable[list[str]]) -> Iterator[Case]:
    rows = [row for row in rows if len(row) == _SCENE]
    solves = {row[0]: int(row[5]) for row in rows if _number(row[1])}
    for scene, name, _, estimate, error, _, _ in (row for row in rows if " ± " in row[4]):
        sites, lengths = "SED" in scene, "SED" in scene or "contact length" in scene
        knobs = 2 + sites + lengths  # contact, bulk; sites; steps, which lengths and sites of normal contact feel
        once = scene == _ALONE or solves[scene] == 1 + knobs
        yield _case(heading, scene, name, once, estimate, error)


def _case(source: str, scene: str, quantity: str, once: bool, estimate: str, error: str) -> Case:
    kind = next(kind for kind, words in KINDS.items() if any(word in quantity for word in words))
    value, _, bar = error.partition(" ± ")
    return Case(source, scene, quantity, kind, once, float(estimate), float(value), float(bar or 0))


def _number(text: str) -> bool:
    return re.fullmatch(r"[\d.]+(e-\d+)?", text) is not None


def coverage(cases: Sequence[Case], kind: str, once: bool | None = None) -> tuple[int, int, int]:
    """Return how many cases of a kind there are, how many the estimate covers, and how many with its factor.

    Args:
        cases: all.
        kind: of :data:`KINDS`.
        once: of those whose sizes were changed once, or more often; None for both.
    """
    mine = [case for case in cases if case.clear and case.kind == kind and once in (None, case.once)]
    return len(mine), sum(case.covered(1.0) for case in mine), sum(case.covered(case.factor) for case in mine)


def kept(docs: Path) -> list[Case]:
    """Return the cases of docs/calibration.json."""
    return [Case(**case) for case in json.loads((docs / "calibration.json").read_text(encoding="utf-8"))["cases"]]


def stiffer(docs: Path) -> dict[str, tuple[float, float]]:
    """Return, by state, how much shorter (m) the contact is over a stiffer screen: as predicted, and as found."""
    study = json.loads((docs / "errors.json").read_text(encoding="utf-8"))["studies"]["penalty"]
    soft, middle, stiff = (run["value"] ** -ORDER for run in study)
    found = {}
    for state in _STATES:
        length = [run["quantities"][f"{state}_contact_length"] for run in study]
        slope = (length[1] - length[0]) / (middle - soft)
        found[state] = slope * (stiff - middle), length[2] - length[1]
    return found


def section(cases: Sequence[Case], docs: Path) -> str:
    """Return the section of the page."""
    lines = []
    for kind in KINDS:
        for once, words in ((True, f"once: factor {ONCE:g}"), (False, f"more often: factor {MORE:g}")):
            n, bare, safe = coverage(cases, kind, once)
            share = [f"{k} ({100 * k / n:.0f} %)" if n else "–" for k in (bare, safe)]
            lines.append(f"| {kind} | {words} | {n} | {share[0]} | {share[1]} |")
    found = stiffer(docs).items()
    springs = [f"| {_STATES[s]} | {1e3 * predicted:.3f} | {1e3 * change:.3f} |" for s, (predicted, change) in found]
    return _SECTION.format(
        heading=_HEADING, once=ONCE, more=MORE, order=ORDER, rows="\n".join(lines), stiffer="\n".join(springs)
    )


def write(docs: Path) -> list[Case]:
    """Read the page, keep its cases and write its last section; return the cases."""
    page = (docs / "accuracy.md").read_text(encoding="utf-8").split(_HEADING)[0].rstrip()
    cases = read(page)
    replace_json(docs / "calibration.json", {"made by": "benchmarks/calibration.py", "unit": "per cent of the limit",
                                             "cases": [asdict(case) for case in cases]})  # fmt: skip
    replace(docs / "accuracy.md", f"{page}\n\n{section(cases, docs)}\n")
    return cases


def main(given: Sequence[str] | None = None) -> int:
    """Write what is to be written."""
    args = arguments.parser(__doc__).parse_args(given)
    cases = write(args.docs)
    print(section(cases, args.docs))
    return 0


if __name__ == "__main__":
    sys.exit(main())
