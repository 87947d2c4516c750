"""Fig. 9 and section 5: strain energy density at the receptors, its response to a sine, and the perception claim."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper.statement import Statement, statement
from benchmarks.runs import Run
from fingerpad.io.style import BLACK, VERMILION, count
from geometry import tags


# -- the sine --------------------------------------------------------------------------------------------
def _ends(run: Run, k: int) -> bool:
    """Whether a step is the last of a load that slides to full slip."""
    last = k + 1 == len(run.loads) or run.loads[k + 1] != run.loads[k]
    return last and run.loads[k].split()[0] in ("slide", "sine")


def sine_statements(run: Run) -> list[Statement]:
    """Return the statements on the response to a sine."""
    rows = [k for k in range(len(run.loads)) if _ends(run, k)]
    sed, sites = run.receptors["merkel_sed"][rows], run.receptors["ridge"]
    voltage, mu_app = run.steps["voltage"][rows], run.steps["mu_app"][rows]
    touching = np.array([np.isin(sites, run.on_ridges(k, "p_c")[0]) for k in rows])
    top = int(np.argmax(voltage))
    turned = int((np.diff(np.sign(np.diff(mu_app))) != 0).sum())
    change = sed[top] / sed[0] - 1
    stays = touching.all(axis=0)
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


# -- statements on the maps --------------------------------------------------------------------------------
def _changes(run: Run) -> dict[str, float]:
    """Return by how much the voltage changes a layer's energy near the contact, in normal contact (relative)."""
    before, after = run.arrays("finger_press"), run.arrays("finger_charge")
    centre = (before["x"] + before["u"])[before["triangles"]].mean(axis=1)
    row = run.normal
    touching, _ = run.on_ridges(row, "p_c")
    reach = (np.abs(touching).max() + 0.5) * run.scene.geometry.ridge_wavelength
    near = np.abs(centre[:, 0]) < reach
    found = {}
    for name in ("stratum corneum", "viable epidermis", "dermis"):
        mine = near & (before["tag"] == tags.LAYERS[name])
        corners = before["x"][before["triangles"][mine]]
        e, f = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = np.abs(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]) / 2
        found[name] = float((area @ np.abs(after["sed"][mine] - before["sed"][mine])) / (area @ before["sed"][mine]))
    return found


def statements(run: Run) -> list[Statement]:
    """Return the statements on the maps, of a run with voltage."""
    r, normal, slip = run.receptors, run.normal, run.slip
    in_contact, sliding = (np.isin(r["ridge"], run.on_ridges(row, "p_c")[0]) for row in (normal, slip))
    both = in_contact & sliding
    fall = float((r["merkel_sed"][slip][both] < r["merkel_sed"][normal][both]).mean())
    meissner = (r["meissner_left"] + r["meissner_right"]) / 2
    papillae = {"normal": meissner[normal][both].mean(), "slip": meissner[slip][both].mean()}
    sites = np.abs(r["merkel_sed"][normal][both] / r["merkel_sed"][run.pressed][both] - 1)
    sc, ve, dermis = _changes(run).values()
    layers = {"sc": sc, "ve": ve, "dermis": dermis, "merkel": np.median(sites)}
    here, away = r["merkel_sed"][normal][in_contact], r["merkel_sed"][normal][~in_contact]
    means = {"contact": here.mean(), "others": away.mean()}
    return [
        statement("layers", layers, ve < 0.1 * sc and sites.max() < 0.05, ve < 0.5 * sc),
        statement("Merkel", means, here.min() > away.max(), here.mean() > away.max()),
        statement("fall", {"share": fall}, fall > 0.5, fall > 0.3),
        statement("papillae", papillae, papillae["slip"] > papillae["normal"]),
    ]


# -- the perception claim ----------------------------------------------------------------------------------
def gather(with_voltage: Run, rougher: Run) -> dict[str, Any]:
    """Return the ridges in contact in either run, and their energy density (J/m^3) by voltage and by friction."""
    touching = {*with_voltage.on_ridges(with_voltage.slip, "p_c")[0], *rougher.on_ridges(rougher.slip, "p_c")[0]}
    mine = np.isin(with_voltage.receptors["ridge"], list(touching))
    runs = {"voltage": with_voltage, "friction": rougher}
    found = {name: run.receptors["merkel_sed"][run.slip][mine].tolist() for name, run in runs.items()}
    return {"ridge": with_voltage.receptors["ridge"][mine].astype(int).tolist()} | found


def paint(figure: Figure, sites: Mapping[str, Any]) -> None:
    """Draw the energy density at each Merkel site at full slip, by voltage and by friction, and the difference."""
    values, change = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    ridge, voltage, friction = (np.array(sites[name]) for name in ("ridge", "voltage", "friction"))
    values.plot(ridge, voltage, "o-", color=VERMILION, ms=4, label="with voltage, at the usual friction coefficient")
    values.plot(ridge, friction, "o--", color=BLACK, ms=4, label="without voltage, at the friction coefficient µ_app")
    values.set(ylabel="energy density (J/m³)", ylim=(0, None))
    values.legend()
    change.bar(ridge, 100 * (friction / voltage - 1), color=BLACK, width=0.5)
    change.set(xlabel="ridge (0 is at the centre)", ylabel="difference (%)")
    count(change.xaxis)


def claim_statement(sites: Mapping[str, Any]) -> Statement:
    """Return the verdict on the paper's central claim, site by site."""
    off = np.array(sites["friction"]) / np.array(sites["voltage"]) - 1
    worst, median, near = int(np.argmax(np.abs(off))), np.median(np.abs(off)), np.abs(off) < 0.05
    words = {"ridge": sites["ridge"][worst], "within": near.sum(), "count": len(off)}
    return statement("claim", {"median": median, "largest": off[worst]}, near.all(), median < 0.05, **words)
