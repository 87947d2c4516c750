"""Figs. 2, 4, 5 and 9 and section 5: tractions and air gaps, the microscale, and the receptors' energy density."""

import numpy as np

from benchmarks.paper.statement import Statement, statement
from benchmarks.runs import Run
from fingerpad.scene import Scene
from geometry import tags


# -- Figs. 2, 4 and 5 ----------------------------------------------------------------------------------------
def section(run: Run) -> list[Statement]:
    """Return the statements on the tractions in normal contact and on the path to full slip."""
    a = run.arrays("surface")
    x, p, p_el, t = (a[f"normal_{name}"][np.isfinite(a["normal_p"])] for name in ("x", "p", "p_el", "t"))
    # The paper normalises by f_ext / L_R.
    scale = run.steps["f_ext"][run.normal] / run.steps["contact_length"][run.normal]
    tension = float((p - p_el).min() / scale)
    # Shear at -x against -shear at x, on the points in contact.
    order = np.argsort(x)
    mirrored = -np.interp(-x[order], x[order], t[order])
    uneven = float(np.linalg.norm(t[order] - mirrored) / np.linalg.norm(t))
    ridges, d_eq = run.on_ridges(run.normal, "d_eq")
    central, outer = d_eq[np.abs(ridges) <= 2].mean(), d_eq[np.argsort(np.abs(ridges))[-4:]].mean()
    both = np.concatenate([d_eq, run.on_ridges(run.slip, "d_eq")[1]])
    within = float(((both > 1.7e-6) & (both < 3e-6)).mean())
    gaps = {"share": within, "least": both.min(), "largest": both.max()}
    xs, ps, ts = (a[f"partial_{name}"][np.nan_to_num(a["partial_p"]) > 0] for name in ("x", "p", "t"))
    slips, middle = np.abs(ts) >= run.scene.friction * ps * (1 - 1e-6), (xs.min() + xs.max()) / 2
    leading, trailing = (float(slips[side].mean()) for side in (xs > middle, xs < middle))
    halves = {"leading": leading, "trailing": trailing}
    return [
        statement("gaps", gaps, within > 0.9, within > 0.5),
        statement("central", {"central": central, "outer": outer}, central < outer),
        statement("tension", {"tension": tension}, tension < 0),
        statement("symmetric", {"even": uneven / 2}, uneven / 2 < 0.05, uneven / 2 < 0.2),
        statement("leading", halves, leading > 1.2 * trailing, leading > trailing),
    ]


def microscale() -> list[Statement]:
    """Return the statements on the least air gap and on the threshold of stickiness, in both readings."""
    scene = Scene()
    bam = scene.roughness.bearing_area(scene.h_0)
    least, estimate, exact = float(bam.air_gap(0.0)), bam.threshold(approximate=True), bam.threshold()
    near = (abs(voltage / 155 - 1) < 0.01 for voltage in (exact, estimate))
    return [
        statement("limit", {"d_eq": least}, abs(least / 1.49e-6 - 1) < 0.005),
        statement("threshold", {"eq_15": estimate, "eq_9": exact}, *near),
    ]


# -- Fig. 9 --------------------------------------------------------------------------------------------------
def _ends(run: Run, k: int) -> bool:
    """Whether a step is the last of a load that slides to full slip."""
    last = k + 1 == len(run.loads) or run.loads[k + 1] != run.loads[k]
    return last and run.loads[k].split()[0] in ("slide", "sine")


def sine(run: Run) -> list[Statement]:
    """Return the statements on the response to a sine."""
    rows = [k for k in range(len(run.loads)) if _ends(run, k)]
    sed, sites = run.receptors["merkel_sed"][rows], run.receptors["ridge"]
    voltage, mu_app = run.steps["voltage"][rows], run.steps["mu_app"][rows]
    touching = np.array([np.isin(sites, run.on_ridges(k, "p_c")[0]) for k in rows])
    top = int(np.argmax(voltage))
    turned = int((np.diff(np.sign(np.diff(mu_app))) != 0).sum())
    change, stays = sed[top] / sed[0] - 1, touching.all(axis=0)
    classes = {
        "enter": int((touching[top] & ~touching[0]).sum()),
        "leave": int((touching[0] & ~touching[top]).sum()),
        "stay and fall by more than 5 %": int((stays & (change < -0.05)).sum()),
        "stay within 5 %": int((stays & (abs(change) <= 0.05)).sum()),
        "stay and rise by more than 5 %": int((stays & (change > 0.05)).sum()),
    }
    kinds = [n for words, n in classes.items() if "rise" not in words]
    counts = ", ".join(f"{n} {words}" for words, n in classes.items())
    return [
        statement("frequency", {"turns": turned}, turned == 1),
        statement("sites", classes, all(kinds), sum(n > 0 for n in kinds) > 1, peak=voltage[top], counts=counts),
    ]


def changes(run: Run) -> dict[str, float]:
    """Return by how much the voltage changes a layer's energy near the contact, in normal contact (relative)."""
    before, after = run.arrays("finger_press"), run.arrays("finger_charge")
    centre = (before["x"] + before["u"])[before["triangles"]].mean(axis=1)
    touching, _ = run.on_ridges(run.normal, "p_c")
    near = np.abs(centre[:, 0]) < (np.abs(touching).max() + 0.5) * run.scene.geometry.ridge_wavelength
    found = {}
    for name in ("stratum corneum", "viable epidermis", "dermis"):
        mine = near & (before["tag"] == tags.LAYERS[name])
        corners = before["x"][before["triangles"][mine]]
        e, f = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = np.abs(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]) / 2
        found[name] = float((area @ np.abs(after["sed"][mine] - before["sed"][mine])) / (area @ before["sed"][mine]))
    return found


def maps(run: Run) -> list[Statement]:
    """Return the statements on the maps of the energy density, of a run with voltage."""
    r, normal, slip = run.receptors, run.normal, run.slip
    in_contact, sliding = (np.isin(r["ridge"], run.on_ridges(row, "p_c")[0]) for row in (normal, slip))
    both = in_contact & sliding
    fall = float((r["merkel_sed"][slip][both] < r["merkel_sed"][normal][both]).mean())
    meissner = (r["meissner_left"] + r["meissner_right"]) / 2
    papillae = {"normal": meissner[normal][both].mean(), "slip": meissner[slip][both].mean()}
    sites = np.abs(r["merkel_sed"][normal][both] / r["merkel_sed"][run.pressed][both] - 1)
    sc, ve, dermis = changes(run).values()
    layers = {"sc": sc, "ve": ve, "dermis": dermis, "merkel": np.median(sites)}
    here, away = r["merkel_sed"][normal][in_contact], r["merkel_sed"][normal][~in_contact]
    means = {"contact": here.mean(), "others": away.mean()}
    return [
        statement("layers", layers, ve < 0.1 * sc and sites.max() < 0.05, ve < 0.5 * sc),
        statement("Merkel", means, here.min() > away.max(), here.mean() > away.max()),
        statement("fall", {"share": fall}, fall > 0.5, fall > 0.3),
        statement("papillae", papillae, papillae["slip"] > papillae["normal"]),
    ]


# -- section 5 -----------------------------------------------------------------------------------------------
def claim(with_voltage: Run, rougher: Run) -> Statement:
    """Return the verdict on the paper's central claim, at the sites of the ridges in contact in either run."""
    runs, ridges = (with_voltage, rougher), with_voltage.receptors["ridge"]
    mine = np.isin(ridges, [ridge for run in runs for ridge in run.on_ridges(run.slip, "p_c")[0]])
    by_voltage, by_friction = (run.receptors["merkel_sed"][run.slip][mine] for run in runs)
    off = by_friction / by_voltage - 1
    worst, median, near = int(np.argmax(np.abs(off))), np.median(np.abs(off)), np.abs(off) < 0.05
    words = {"ridge": int(ridges[mine][worst]), "within": near.sum(), "count": len(off)}
    return statement("claim", {"median": median, "largest": off[worst]}, near.all(), median < 0.05, **words)
