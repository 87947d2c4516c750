"""Figs. 2, 4, 5 and 9B and section 5: tractions and air gaps, the microscale, and the receptors' energy density."""

import numpy as np
from numpy.typing import NDArray

from benchmarks.paper.sine import by_kind, steady
from benchmarks.paper.statement import HALF, Statement, statement
from benchmarks.runs import Array, Run
from fingerpad.scene import Scene
from fingerpad.scene.remarks import coefficient
from variational.roughness.bam import BearingArea

Which = NDArray[np.bool_]
Ridge = tuple[Array, Array, Array, Array]
"""Place (m), pressure, attraction and shear (Pa) at the points of a ridge under pressure, from left to right."""
_CONE = 1 - 1e-6  # of the friction limit, from which on a point slips


# -- Figs. 2, 4 and 5 ----------------------------------------------------------------------------------------
def touching(run: Run, state: str) -> list[Ridge]:
    """Return the ridges under pressure."""
    a = {name: values for name, values in run.arrays("surface").items() if name.startswith(state)}
    under = np.nan_to_num(a[f"{state}_p"]) > 0
    ridges = [under & (a[f"{state}_ridge"] == k) for k in np.unique(a[f"{state}_ridge"][under])]
    x, p, p_el, t = (a[f"{state}_{name}"] for name in ("x", "p", "p_el", "t"))
    return [(x[mine], p[mine], p_el[mine], t[mine]) for mine in ridges]


def section(run: Run, stiffer: Run) -> list[Statement]:
    """Return the statements on the tractions in normal contact and on the path to full slip.

    Args:
        run: to full slip.
        stiffer: to the same normal contact, with stiffer springs where points stick.
    """
    normal, partial, slip = (touching(run, state) for state in ("charged", "partial", "full_slip"))
    # The paper normalises by f_ext / L_R.
    scale = run.steps["f_ext"][run.charged] / run.steps["contact_length"][run.charged]
    x, _, _, t = map(np.concatenate, zip(*normal, strict=True))
    even = np.linalg.norm(t + np.interp(-x, x, t)) / np.linalg.norm(t) / 2  # shear at x and at -x
    shear = {"even": even, "most": np.abs(t).max() / scale}
    return [
        _central(run),
        _tension([*normal, *partial, *slip], scale),
        statement("symmetric", shear, even < 0.05 and shear["most"] > 0.05, even < 0.2),
        _edges(*([_slips(each, *ridge) for ridge in touching(each, "charged")] for each in (run, stiffer))),
        _leading(np.concatenate([x for x, *_ in partial]), np.concatenate([_slips(run, *ridge) for ridge in partial])),
    ]


def _tension(ridges: list[Ridge], scale: float) -> Statement:
    """Judge the points under pressure: those in tension are in the outer quarters of their ridges."""
    stress = np.concatenate([p - p_el for _, p, p_el, _ in ridges])
    k = [np.arange(len(x)) for x, *_ in ridges]
    place = np.concatenate([np.minimum(each, each[::-1]) / len(each) for each in k])
    tensile, near = stress < 0, (stress < 0) & (place < 0.25)
    edges = np.concatenate([(p - p_el)[[0, -1]] for _, p, p_el, _ in ridges])
    numbers = {"points": tensile.sum(), "near": near.sum(), "of": stress.size, "most": -stress.min() / scale}
    numbers |= {"edges": (edges < 0).sum(), "of_edges": edges.size}
    return statement("tension", numbers, tensile.any() and (near == tensile).all(), near.sum() > tensile.sum() / 2)


def _slips(run: Run, x: Array, p: Array, p_el: Array, t: Array) -> Which:
    return np.abs(t) >= (coefficient(run.scene) or 0.0) * p * _CONE


def _central(run: Run) -> Statement:
    """Judge normal contact and full slip: the middle third of the ridges in contact, and two on either side."""
    means, inside = dict[str, float](), list[bool]()
    for state in ("charged", "full_slip"):
        d_eq = run.on_ridges(getattr(run, state), "d_eq")[1]
        third = len(d_eq) // 3
        central, outer = d_eq[third:-third], np.r_[d_eq[:2], d_eq[-2:]]
        means |= {f"{state}_central": central.mean(), f"{state}_outer": outer.mean()}
        inside.append(central.min() == d_eq.min() and central.mean() < outer.mean())
    return statement("central", means, all(inside), any(inside))


def _edges(*runs: list[Which]) -> Statement:
    """Judge the points of each ridge from left to right: slip at both ends, and stick at more than half of them.

    The first run is judged; the second, with stiffer springs, is shown beside it.
    """
    ends = [np.array([(slips[0], slips[-1]) for slips in ridges]) for ridges in runs]
    stick = [np.array([slips.mean() < 0.5 for slips in ridges]) for ridges in runs]
    small = [end.all(axis=1) & inside for end, inside in zip(ends, stick, strict=True)]
    numbers = {f"ridges_{k}": good.sum() for k, good in enumerate(small)} | {"of": small[0].size}
    numbers |= {f"ends_{k}": end.sum() for k, end in enumerate(ends)} | {"ends": ends[0].size}
    return statement("edges", numbers, small[0].all(), small[0].mean() >= HALF)


def _leading(x: Array, slips: Which) -> Statement:
    middle = (x.min() + x.max()) / 2
    leading, trailing = (float(slips[side].mean()) for side in (x > middle, x < middle))
    halves = {"leading": leading, "trailing": trailing}
    return statement("leading", halves, leading > 1.2 * trailing, leading > trailing)


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


# -- Fig. 9B -------------------------------------------------------------------------------------------------
def sine(run: Run) -> list[Statement]:
    """Return the statements on the response to a sine."""
    rows = steady(run)
    sed, sites = run.receptors["merkel_sed"][rows], run.receptors["ridge"]
    mu_app, top = run.steps["mu_app"][rows], int(np.argmax(run.steps["voltage"][rows]))
    turned = int((np.diff(np.sign(np.diff(mu_app))) != 0).sum())
    before, after = (np.isin(sites, run.on_ridges(rows[k], "p_c")[0]) for k in (0, top))
    return [
        statement("frequency", {"turns": turned}, turned == 1),
        _sites(sites, sed[top] / sed[0], before, after, int(np.argmax(sed[0])), run.steps["voltage"][rows[top]]),
    ]


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


# -- section 5 -----------------------------------------------------------------------------------------------
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
