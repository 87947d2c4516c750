"""Fig. 9B: apparent friction and energy density at Merkel sites over a sine of the voltage."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.paper import scenes
from benchmarks.runs import Run, computed
from fingerpad.results.pictures import style

Array = NDArray[np.float64]
Which = NDArray[np.bool_]
_WORDS = {
    "highest": "highest at 0 V",
    "enters": "enters the contact",
    "leaves": "leaves the contact",
    "changes least": "changes least",
}


def steady(run: Run) -> list[int]:
    """Return the rows at the ends of the loads that slide to full slip."""
    loads = run.steps["load"]
    last = np.r_[loads[1:] != loads[:-1], True]
    return [k for k in np.flatnonzero(last) if str(loads[k]).split()[0] in ("slide", "sine")]


def by_kind(ratio: Array, before: Which, after: Which, highest: int) -> dict[str, NDArray[np.int64]]:
    """Return the sites by what the voltage does to them, as indices; kinds of :data:`scenes.NAMED`.

    Args:
        ratio: energy density at the peak over that at 0 V, shape (sites,).
        before: whether the ridge is in contact at 0 V.
        after: whether it is at the peak.
        highest: the site with the highest energy density at 0 V.
    """
    stay = np.flatnonzero(before & after)
    still = stay[np.argmin(np.abs(ratio[stay] - 1))]
    found = {"highest": [highest], "enters": np.flatnonzero(after & ~before), "leaves": np.flatnonzero(before & ~after)}
    return {kind: np.asarray(sites, dtype=np.int64) for kind, sites in (found | {"changes least": [still]}).items()}


def numbers(out: Path, jobs: int) -> dict[str, Any]:
    """Return phase (rad), voltage (V), µ_app and energy densities over the highest at 0 V, at full slip; by site."""
    run = computed({"sine": scenes.sine()}, out, jobs)["sine"]
    rows = steady(run)
    sed, ridges, voltage = run.receptors["merkel_sed"][rows], run.receptors["ridge"], run.steps["voltage"][rows]
    top, highest = int(np.argmax(voltage)), int(np.argmax(sed[0]))
    before, after = (np.isin(ridges, run.on_ridges(rows[k], "p_c")[0]) for k in (0, top))
    kinds = by_kind(sed[top] / sed[0], before, after, highest)
    sites = [
        {"kind": kind, "ridge": int(ridges[k]), "sed": (sed[:, k] / sed[0, highest]).tolist()}
        for kind, found in kinds.items() for k in found
    ]  # fmt: skip
    mu_app = run.steps["mu_app"][rows].tolist()
    columns = {"phase": scenes.PHASES.tolist(), "voltage": voltage.tolist(), "mu_app": mu_app}
    return {"f_ext": scenes.MAP, "sites": sites} | columns


def paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    """Draw half a period, which is a whole one of the voltage's square; the second half is the same."""
    above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=(1, 1.2, 2))
    phase = np.array(numbers["phase"]) / (2 * np.pi)
    above.plot(phase, numbers["voltage"], color=style.BLACK, marker="o", ms=4)
    middle.plot(phase, numbers["mu_app"], color=style.VERMILION, marker="o", ms=4)
    for k, site in enumerate(numbers["sites"]):
        look = {"color": style.CATEGORIES[k % len(style.CATEGORIES)], "marker": style.MARKERS[k % len(style.MARKERS)]}
        paper = scenes.NAMED[site["kind"]]
        words = f"ridge {site['ridge']}: {_WORDS[site['kind']]} (the paper's M{paper})".replace("-", "−")
        below.plot(phase, site["sed"], ms=4, **look, label=words)
    above.set(ylabel="voltage (V)", title=f"Full slip at {numbers['f_ext']:g} N/m, on half a period of the voltage")
    middle.set_ylabel("µ_app (–)")
    below.set(xlabel="phase, in periods of the voltage", ylabel="energy density at site\nover the highest at 0 V (–)")
    below.set_ylim(0, None)
    below.legend(fontsize=8)
