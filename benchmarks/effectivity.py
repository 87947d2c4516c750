"""Does the error estimate find the error? One knob at a time, and Hertz's contact, of which the error is known.

The knobs are those of the runs of benchmarks/errors.py, which makes them: each run's error is estimated as
fingerpad/richardson.py does it, from the coarser runs before it. Written beneath the whole loops
of benchmarks/accuracy.py.
"""

import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from benchmarks import hertz
from benchmarks.convergence import limit
from benchmarks.errors import QUANTITIES, STUDIES, study, values
from benchmarks.runs import Run
from fingerpad.richardson import MeshParameter
from fingerpad.runs.batch import progress
from fingerpad.scene import Scene

Array = NDArray[np.float64]
LOW, HIGH = 0.5, 3.0  # effectivities that are good enough
_EDGES_AT = (10, 20)  # facets to the half-width
_KNOBS = ("contact", "growth", "receptor")
# Counts, and what is f_T over the prescribed force.
_LEFT_OUT = ("slip_mu_app", "normal_ridges_in_contact", "slip_ridges_in_contact")
_LENGTH = "contact_length"
_ONE = """## One knob at a time

The default scene (75 N/m, 200 V, slid to full slip) with one size changed. The estimate is the knob's share
(`fingerpad/richardson.py`), from the coarser runs before. The limit is, for the contact size, Richardson's with its
error bar (`benchmarks/convergence.py`), for the others the finest run alone, which makes errors look smaller than they
are. No estimate is judged of the finest run. The error of µ_app is that of f_T."""


_HERTZ = """## Hertz's contact

A cylinder on meshes of which each has half the facets' length of the one before (`benchmarks/hertz.py`); the contact
length is known but for {bar:.1g} %. Its two edges move facet by facet, so that it converges by fits and starts, and
what halving the facets changes says little of one edge. A finger has some thirty, whose fits cancel."""
_EDGES = """How far an edge is off depends on where in a facet it should be ({places} places, in lengths of a facet;
negative if the contact is too short):

| facets to the half-width | mean | root of the mean square | from | to |
|---|---|---|---|---|
{rows}"""


def shares(found: Sequence[ArrayLike], name: str) -> list[float]:
    """Return the estimated error of a quantity in each run but the coarsest, in its unit.

    Args:
        found: the quantity, or its parts, in each run.
        name: of the quantity.
    """
    knob, estimates = MeshParameter(), []
    for coarse, fine in itertools.pairwise(found):
        knob.record({name: coarse}, {name: fine})
        estimates.append(knob.share(name))
    return estimates


def lengths(scene: Scene, out: Path, state: str) -> Array:
    """Return the lengths in contact (m) of all ridges in a state of a run, shape (ridges,)."""
    run = Run(scene, out)
    found = np.zeros(scene.geometry.ridge_count)
    ridges, length = run.on_ridges({"press": run.pressed, "normal": run.normal, "slip": run.slip}[state], _LENGTH)
    found[ridges.astype(int) + len(found) // 2] = length
    return found


def table(name: str, out: Path) -> tuple[str, list[float]]:
    """Return a knob's section, and the effectivities that say something."""
    heading, unit, words = STUDIES[name]
    scenes = study(name)
    runs = {value: run for value, scene in scenes.items() if (run := values(scene, out)) is not None}
    if len(runs) < len(scenes):
        return f"### {heading}\n\nNot all of its runs were made.", []
    found, telling = list(runs.values()), []
    lines = ["| | at | estimate (%) | error (%) | effectivity |", "|---|---|---|---|---|"]
    for quantity, (title, _) in QUANTITIES.items():
        if quantity in _LEFT_OUT:
            continue
        sequence = [run[quantity] for run in found]
        exact, bar = sequence[-1], 0.0
        if name == "contact":
            best = limit(sequence)
            exact, bar = best.value, best.bar
        # The finest run's would be compared with a limit that its own difference makes.
        state, _, rest = quantity.partition("_")
        parts = [lengths(scene, out, state) for scene in scenes.values()] if rest == _LENGTH else sequence
        judged = list(zip(runs, sequence, [0.0, *shares(parts, quantity)], strict=True))[1:-1]
        for value, q, share in judged:
            error = abs(q - exact)
            effectivity = share / error if error > 0 else float("inf")
            telling += [effectivity] if error > bar else []
            of = 100 / abs(exact)
            at, within = f"{value / unit:g} {words}".strip(), f" ± {bar * of:.2g}" if bar else ""
            cells = [title.rsplit(" (", 1)[0], at, f"{share * of:.3g}", f"{error * of:.3g}{within}"]
            cells.append(cell(effectivity, error > bar))
            lines.append("| " + " | ".join(cells) + " |")
    return f"### {heading}\n\n" + "\n".join(lines), telling


def hertz_table() -> str:
    """Return the section of Hertz's contact, which takes a minute."""
    lines, telling = ["| half-width (mm) | facets | estimate (%) | error (%) | effectivity |", "|---" * 5 + "|"], []
    with progress() as bar:
        for a in bar.track(hertz.HALF_WIDTHS, description="Hertz's contact"):
            found = [hertz.contact_length(a, facets) for facets in hertz.FACETS]
            for facets, length, share in zip(hertz.FACETS[1:], found[1:], shares(found, _LENGTH), strict=True):
                error, of = abs(length - 2 * a), 100 / (2 * a)
                clear = error > hertz.BAR * 2 * a
                telling += [share / error] if clear else []
                cells = [f"{1e3 * a:.3f}", f"{a / hertz.HALF_WIDTH * facets:.1f}"]
                cells += [f"{share * of:.2g}", f"{error * of:.2g}", cell(share / error, clear)]
                lines.append("| " + " | ".join(cells) + " |")
    return "\n\n".join([_HERTZ.format(bar=100 * hertz.BAR), tally(telling), "\n".join(lines), _edges()])


def _edges() -> str:
    rows = []
    with progress() as bar:
        for facets in _EDGES_AT:
            tracked = bar.track(hertz.places(facets), description=f"edges at {facets} facets")
            e = np.array([hertz.edge_error(a, facets) for a in tracked])
            cells = [e.mean(), np.sqrt(np.mean(e**2)), e.min(), e.max()]
            rows.append(f"| {facets} | " + " | ".join(f"{value:.3f}" for value in cells) + " |")
    return _EDGES.format(places=hertz.PLACES, rows="\n".join(rows))


def knob_tables(out: Path) -> str:
    """Return the sections of the knobs, of what has been run."""
    sections, telling = zip(*(table(name, out) for name in _KNOBS), strict=True)
    return "\n\n".join([_ONE, tally([e for part in telling for e in part]), *sections])


def cell(effectivity: float, clear: bool) -> str:
    """Return an effectivity, in brackets if its error is not clear of its own bar."""
    return f"{effectivity:.2f}" if clear else f"({effectivity:.2f})"


def tally(effectivities: Sequence[float]) -> str:
    """Say how many effectivities are good enough."""
    good, under = (sum(test(e) for e in effectivities) for test in (lambda e: LOW <= e <= HIGH, lambda e: e < LOW))
    return (
        f"{good} of {len(effectivities)} effectivities are between {LOW:g} and {HIGH:g}, {under} below, "
        f"{len(effectivities) - good - under} above."
    )
