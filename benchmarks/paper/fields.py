"""Figs. 4, 5 and 9B and section 5: the microscale, and the receptors' energy density."""

import numpy as np
from numpy.typing import NDArray

from benchmarks.paper.sine import by_kind, steady
from benchmarks.paper.statement import Statement, statement
from benchmarks.runs import Array, Run
from fingerpad.scene import Scene
from variational.roughness.bam import BearingArea

Which = NDArray[np.bool_]


def microscale() -> list[Statement]:
    """Return the statements on the least air gap and on the threshold of stickiness, in both readings."""
    scene = Scene()
    bam = BearingArea(scene.h_0)
    least, estimate, exact = float(bam.air_gap(0.0)), bam.threshold(approximate=True), bam.threshold()
    near = abs(estimate / 155 - 1) < 0.01 and abs(exact / 155 - 1) < 0.1
    return [
        statement("limit", {"d_eq": least}, abs(least / 1.49e-6 - 1) < 0.005),
        statement("threshold", {"eq_15": estimate, "eq_9": exact}, near),
    ]


def sine(run: Run) -> Statement:
    """Return the statement on the sites that the paper names, on the response to a sine."""
    rows = steady(run)
    sed, sites = run.receptors["merkel_sed"][rows], run.receptors["ridge"]
    top = int(np.argmax(run.steps["voltage"][rows]))
    before, after = (np.isin(sites, run.on_ridges(rows[k], "p_c")[0]) for k in (0, top))
    return _sites(sites, sed[top] / sed[0], before, after, int(np.argmax(sed[0])), run.steps["voltage"][rows[top]])


def _sites(sites: Array, ratio: Array, before: Which, after: Which, highest: int, peak: float) -> Statement:
    """Judge the sites by what the voltage does to them; those of ``scenes.NAMED`` are numbers by kind and ridge.

    Args:
        sites: ridge of each, shape (sites,), as all arrays.
        ratio: energy density at the peak over that at 0 V.
        before: whether the ridge is in contact at 0 V.
        after: whether it is at the peak.
        highest: index of the site with the highest energy density at 0 V.
        peak: voltage (V).
    """
    new, lost, stay = after & ~before, before & ~after, before & after
    bend, same = stay & (ratio < 0.95), stay & (np.abs(ratio - 1) <= 0.05)
    rise = stay & (ratio > 1.05)
    counts = {"enter": new.sum(), "leave": lost.sum(), "bend": bend.sum(), "same": same.sum(), "rise": rise.sum()}
    kinds = {
        "enter and rise": new.any() and (ratio[new] > 1).all(),
        "leave and fall": lost.any() and (ratio[lost] < 1).all(),
        "bend and fall": bend.any(),
        "hardly change": same.any(),
    }
    failing = ", ".join(kind for kind, there in kinds.items() if not there)
    ours = by_kind(ratio, before, after, highest)
    mapped = {f"{kind} {sites[k]:g}": ratio[k] for kind, found in ours.items() for k in found}
    return statement("sites", counts | mapped, not failing, sum(kinds.values()) > 1, peak=peak, failing=failing)


def claim(with_voltage: Run, rougher: Run) -> Statement:
    """Return the verdict on the paper's central claim, at the sites of the ridges in contact in either run.

    It is whole where all Merkel and Meissner sites agree, and in part by the median of the Merkel sites.
    """
    runs, ridges = (with_voltage, rougher), with_voltage.receptors["ridge"]
    mine = np.isin(ridges, [ridge for run in runs for ridge in run.on_ridges(run.full_slip, "p_c")[0]])

    def difference(name: str) -> Array:
        by_voltage, by_friction = (run.receptors[name][run.full_slip][mine] for run in runs)
        return by_friction / by_voltage - 1

    off, papillae = difference("merkel_sed"), np.r_[difference("meissner_left"), difference("meissner_right")]
    worst, median, near = int(np.argmax(np.abs(off))), np.median(np.abs(off)), np.abs(off) < 0.05
    also = np.abs(papillae) < 0.05
    numbers = {"median": median, "largest": off[worst], "papillae": np.median(np.abs(papillae))}
    numbers |= {"least": papillae.min(), "most": papillae.max()}
    words = {"ridge": int(ridges[mine][worst]), "within": near.sum(), "count": near.size}
    words |= {"papillae_within": also.sum(), "papillae_count": also.size}
    return statement("claim", numbers, near.all() and also.all(), median < 0.05, **words)
