"""Coverage of the printed error: the estimate with its factor of safety against all known errors.

The known cases are in docs/accuracy.json, made by benchmarks/accuracy.py. fingerpad/richardson.py takes its factors of
safety from them, and tests/test_calibration.py checks the coverage. All cases are of the discretisation alone: limits
and runs have the same penalty.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks import harness
from fingerpad.richardson import MORE, ONCE

WANTED = 0.9  # of the cases of each kind
KINDS = {"friction": ("µ_app", "f_T"), "contact length": ("contact length",), "energy density": ("SED",)}
LOW, HIGH = 0.5, 3.0  # range of a good effectivity
WHOLE, HERTZ = "whole run", "Hertz"  # sources; the others are studies of benchmarks/errors.py


@dataclass(frozen=True)
class Case:
    """An estimate whose error is known; numbers in per cent of the limit."""

    source: str
    """:data:`WHOLE`, :data:`HERTZ` or the mesh parameter that was varied alone."""
    scene: str
    quantity: str
    once: bool
    """Whether every size was halved or doubled once."""
    estimate: float
    """Without a factor of safety."""
    error: float
    bar: float
    """Of the error."""
    allowed: float | None = None
    """Requested accuracy, None without a request."""

    @property
    def kind(self) -> str:
        """Kind of the quantity, of :data:`KINDS`."""
        return next(kind for kind, words in KINDS.items() if any(word in self.quantity for word in words))

    @property
    def clear(self) -> bool:
        """Whether the error is larger than its uncertainty."""
        return self.error > self.bar

    @property
    def factor(self) -> float:
        """The smallest factor of safety of its sizes."""
        return ONCE if self.once else MORE

    @property
    def effectivity(self) -> float:
        """Estimate over error."""
        return self.estimate / self.error if self.error else float("inf")

    @property
    def met(self) -> str:
        """Whether the error is within the request; ``likely`` if its bar leaves that open, empty without a request."""
        if self.allowed is None:
            return ""
        if self.error > self.allowed:
            return "no"
        return "yes" if self.error + self.bar <= self.allowed else "likely"

    def covered(self, factor: float) -> bool:
        """Return whether the error is at most ``factor`` times the estimate."""
        return self.error <= factor * self.estimate


def kept(docs: Path = harness.DOCS) -> list[Case]:
    """Return the cases of docs/accuracy.json."""
    return [Case(**case) for case in harness.kept("accuracy", docs).numbers["cases"]]


def coverage(cases: Iterable[Case], kind: str | None = None, once: bool | None = None) -> tuple[int, int, int]:
    """Return the numbers of clear cases, of those covered by the estimate, and of those covered with its factor.

    Args:
        cases: all.
        kind: of :data:`KINDS`; None for all.
        once: of those whose sizes were changed once, or more often; None for both.
    """
    mine = [case for case in cases if case.clear and kind in (None, case.kind) and once in (None, case.once)]
    return len(mine), sum(case.covered(1.0) for case in mine), sum(case.covered(case.factor) for case in mine)


def coverages(cases: Sequence[Case]) -> str:
    """Return the table of the coverage by kind and factor."""
    rows = []
    for kind in KINDS:
        for once, words in ((True, f"once: factor {ONCE:g}"), (False, f"more often: factor {MORE:g}")):
            n, bare, safe = coverage(cases, kind, once)
            rows.append([kind, words, n, *(f"{k} ({100 * k / n:.0f} %)" if n else "–" for k in (bare, safe))])
    return harness.table(["quantity", "sizes changed", "cases", "covered by the estimate", "with its factor"], rows)


def tally(cases: Iterable[Case]) -> str:
    """Return a sentence on how many effectivities of clear cases are in the good range."""
    found = [case.effectivity for case in cases if case.clear]
    good, under = sum(LOW <= e <= HIGH for e in found), sum(e < LOW for e in found)
    return (
        f"{good} of {len(found)} effectivities are between {LOW:g} and {HIGH:g}, {under} are below and "
        f"{len(found) - good - under} above."
    )


def table(cases: Iterable[Case]) -> str:
    """Return cases as a table; effectivities of errors that are not clear are in brackets."""
    rows = []
    for c in cases:
        error = f"{c.error:.2g} ± {c.bar:.1g}" if c.bar else f"{c.error:.2g}"
        effectivity = f"{c.effectivity:.2f}" if c.clear else f"({c.effectivity:.2f})"
        rows.append([c.scene, c.quantity, "" if c.allowed is None else f"{c.allowed:.2g}", f"{c.estimate:.2g}", error])
        rows[-1] += [effectivity, c.met]
    return harness.table(
        ["scene", "quantity", "requested (%)", "estimate (%)", "error (%)", "effectivity", "met"], rows
    )
