"""Coverage of the printed error: the estimate with its factor of safety against all known errors.

The known cases are in docs/accuracy.json, made by benchmarks/accuracy.py, with runs and limits of the same penalty.
fingerpad/richardson.py takes its factors of safety from them, and tests/test_calibration.py checks the coverage.

Hertz's line contact gives lengths whose error is known: the cylinder of benchmarks/verification/normal_contact.py,
pressed to half-widths that end anywhere in a facet. Its contact has two edges, mirror images of one another; a finger's
has some thirty. An edge moves facet by facet: near an edge the pressure falls with the root of the distance, so that
the facet is the only length there.
"""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks import harness
from benchmarks.verification.normal_contact import E_STAR, HALF_WIDTH, RADIUS, SPAN, press
from fingerpad.richardson import MORE, ONCE, MeshParameter
from geometry.bodies import pad

WANTED = 0.9  # of the cases of each kind
KINDS = {"friction": ("µ_app", "f_T"), "contact length": ("contact length",), "energy density": ("SED",)}
LOW, HIGH = 0.5, 3.0  # range of a good effectivity
WHOLE, HERTZ = "whole run", "Hertz"  # sources; the others are studies of benchmarks/errors.py
HALF_WIDTHS = tuple(part * HALF_WIDTH for part in (0.817, 0.893, 0.961, 1.049, 1.137))
FACETS = (5, 10, 20, 40)  # to HALF_WIDTH
_BAR = 100 * (HALF_WIDTH / SPAN) ** 2  # %: the body is a block, not a half-space
_REACH = 1.4  # of the facets that can touch, over HALF_WIDTH


@dataclass(frozen=True)
class Case:
    """An estimate whose error is known; numbers in per cent of the limit."""

    source: str  # WHOLE, HERTZ or the mesh parameter that was varied alone
    scene: str
    quantity: str
    once: bool  # every size was halved or doubled once
    estimate: float  # without a factor of safety
    error: float
    bar: float  # of the error
    allowed: float | None = None  # requested accuracy

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


def _contact_length(a: float, facets: int) -> float:
    """Return the length in contact (m), 2a by Hertz, with ``facets`` facets to :data:`HALF_WIDTH`."""
    size, force = HALF_WIDTH / facets, np.pi * E_STAR * a**2 / (4 * RADIUS)
    run = press(pad(size, int(np.ceil(_REACH * facets)), RADIUS, SPAN), "penalty", size, force)
    return float(run.observer.ridge_loads(run.surface_state).length[0])


def hertz() -> Iterator[Case]:
    """Yield the cases of Hertz's contact on meshes of halved size; a minute of computation."""
    name = "contact_length"
    for a in HALF_WIDTHS:
        found, parameter = [_contact_length(a, facets) for facets in FACETS], MeshParameter()
        for k, (coarse, fine) in enumerate(itertools.pairwise(found), start=1):
            parameter.record({name: coarse}, {name: fine})
            scene = f"half-width {1e3 * a:.3f} mm, {a / HALF_WIDTH * FACETS[k]:.1f} facets"
            estimate, error = (100 / (2 * a) * value for value in (parameter.share(name), abs(fine - 2 * a)))
            yield Case(HERTZ, scene, "contact length", k == 1, estimate, error, _BAR)


# -- page ----------------------------------------------------------------------------------------------------
def coverage(cases: Iterable[Case], kind: str | None = None, once: bool | None = None) -> tuple[int, int, int]:
    """Return the numbers of clear cases, of those covered by the estimate, and of those covered with its factor.

    Only of one ``kind`` of quantity, and of sizes that were changed ``once`` or more often, where given.
    """
    mine = [case for case in cases if case.clear and kind in (None, case.kind) and once in (None, case.once)]
    return len(mine), sum(case.covered(1.0) for case in mine), sum(case.covered(case.factor) for case in mine)


def coverages(cases: Sequence[Case]) -> str:
    """Return the table of the coverage by kind and factor."""
    rows, factors = [], {True: f"once: factor {ONCE:g}", False: f"more often: factor {MORE:g}"}
    for kind, once in itertools.product(KINDS, factors):
        n, *covered = coverage(cases, kind, once)
        rows.append([kind, factors[once], n, *(f"{k} ({100 * k / n:.0f} %)" if n else "–" for k in covered)])
    return harness.table(["quantity", "sizes changed", "cases", "covered by the estimate", "with its factor"], rows)


def tally(cases: Iterable[Case]) -> str:
    """Return a sentence on how many effectivities of clear cases are in the good range."""
    found = [case.effectivity for case in cases if case.clear]
    good, under = sum(LOW <= e <= HIGH for e in found), sum(e < LOW for e in found)
    above = len(found) - good - under
    words = f"{good} of {len(found)} effectivities are between {LOW:g} and {HIGH:g}"
    return f"{words}, {under} are below and {above} above."


def table(cases: Iterable[Case]) -> str:
    """Return cases as a table; effectivities of errors that are not clear are in brackets."""
    rows = []
    for c in cases:
        error = f"{c.error:.2g} ± {c.bar:.1g}" if c.bar else f"{c.error:.2g}"
        effectivity = f"{c.effectivity:.2f}" if c.clear else f"({c.effectivity:.2f})"
        allowed = "" if c.allowed is None else f"{c.allowed:.2g}"
        rows.append([c.scene, c.quantity, allowed, f"{c.estimate:.2g}", error, effectivity, c.met])
    head = ["scene", "quantity", "requested (%)", "estimate (%)", "error (%)", "effectivity", "met"]
    return harness.table(head, rows)
