"""Does the error estimate find the error? One knob at a time, on the default scene, against finer whole runs.

environment/run python3 benchmarks/accuracy.py

From the runs of benchmarks/errors.py (which makes them; this page takes what is there). Each run's error is estimated
as fingerpad/estimate.py does it in a run with an ``[accuracy]``: from the next finer run, and from the coarser one
where there is one, of which the order is observed. That the state of full slip solved again on a finer mesh is the
whole run's there, so that whole runs can stand for it, is tests/test_transfer.py's.
"""

import itertools
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks import arguments
from benchmarks.convergence import limit
from benchmarks.errors import QUANTITIES, STUDIES, study, values
from fingerpad.estimate import Knob

_LOW, _HIGH = 0.5, 3.0  # effectivities that are good enough
_KNOBS = ("contact", "growth", "receptor")
# Counts, and what is f_T over the prescribed force.
_LEFT_OUT = ("slip_mu_app", "normal_ridges_in_contact", "slip_ridges_in_contact")
_HEADER = f"""# Does the error estimate find the error?

Made by `environment/run python3 benchmarks/accuracy.py`; do not edit. The default scene (75 N/m, 200 V, slid to full
slip), one knob at a time. *Estimate*: that knob's share in `fingerpad/estimate.py`, from the runs before and after.
*Error*: the distance from the limit, for the contact size Richardson's with its error bar
(`benchmarks/convergence.py`), for the others from the finest run alone, which makes errors look smaller than they are.
*Effectivity*: estimate over error, wanted between {_LOW:g} and {_HIGH:g}; one in brackets is of an error below its own
bar, which says nothing. No estimate is judged that was made with the finest run. Numbers are per cent of the limit;
the error of µ_app is that of f_T."""


def shares(found: Sequence[Mapping[str, float]], name: str) -> list[float]:
    """Return the estimated error of a quantity in each run but the coarsest, in its unit."""
    knob, estimates = Knob(), []
    for coarse, fine in itertools.pairwise(found):
        knob.see({name: coarse[name]}, {name: fine[name]})
        estimates.append(knob.share(name))
    return estimates


def table(name: str, out: Path) -> tuple[str, list[float]]:
    """Return a knob's section, and the effectivities that say something."""
    heading, unit, words = STUDIES[name]
    runs = {value: run for value, scene in study(name).items() if (run := values(scene, out)) is not None}
    if len(runs) < len(study(name)):
        return f"## {heading}\n\nNot all of its runs were made.", []
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
        # An estimate made with the finest run would be compared with its own difference.
        judged = list(zip(runs, sequence, shares(found, quantity), strict=False))[:-1]
        for value, q, share in judged:
            error = abs(q - exact)
            effectivity = share / error if error > 0 else float("inf")
            cell = f"{effectivity:.2f}" if error > bar else f"({effectivity:.2f})"
            if error > bar:
                telling.append(effectivity)
            of = 100 / abs(exact)
            at, within = f"{value / unit:g} {words}".strip(), f" ± {bar * of:.2g}" if bar else ""
            cells = [title.rsplit(" (", 1)[0], at, f"{share * of:.3g}", f"{error * of:.3g}{within}", cell]
            lines.append("| " + " | ".join(cells) + " |")
    return f"## {heading}\n\n" + "\n".join(lines), telling


def page(out: Path) -> str:
    """Return the page of what has been run."""
    sections, telling = zip(*(table(name, out) for name in _KNOBS), strict=True)
    every = [e for part in telling for e in part]
    good = sum(_LOW <= e <= _HIGH for e in every)
    under = sum(e < _LOW for e in every)
    verdict = (
        f"**{good} of {len(every)} effectivities are between {_LOW:g} and {_HIGH:g}**, {under} below, "
        f"{len(every) - good - under} above."
    )
    return "\n\n".join([_HEADER, verdict, *sections]) + "\n"


def main(given: Sequence[str] | None = None) -> int:
    """Write the page."""
    args = arguments.parser(__doc__).parse_args(given)
    (args.docs / "accuracy.md").write_text(page(args.out), encoding="utf-8")
    print(args.docs / "accuracy.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())
