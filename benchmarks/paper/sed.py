"""Fig. 9 and section 5: strain energy density at the receptors, its response to a sine, and the perception claim."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper.statement import Statement, statement
from benchmarks.runs import Array, Run
from fingerpad.io.style import BLACK, VERMILION, count
from geometry import tags


# -- the sine --------------------------------------------------------------------------------------------
def _response(run: Run) -> tuple[Array, Array, Array, Array, Array]:
    """Return voltages, µ_app, ridges and their SED at the states of full slip of Fig. 9B, and which ridges touch."""
    rows = [k for k in range(len(run.loads)) if _ends(run, k)]
    steps = run.steps
    touching = np.array([np.isin(run.receptors["ridge"], run.on_ridges(k, "p_c")[0]) for k in rows])
    return (
        steps["voltage"][rows],
        steps["mu_app"][rows],
        run.receptors["ridge"],
        run.receptors["merkel_sed"][rows],
        touching,
    )


def _ends(run: Run, k: int) -> bool:
    """Whether a step is the last of a load that slides to full slip."""
    last = k + 1 == len(run.loads) or run.loads[k + 1] != run.loads[k]
    return last and run.loads[k].split()[0] in ("slide", "sine")


def sine_statements(run: Run) -> list[Statement]:
    """Return the statements on the response to a sine."""
    voltage, mu_app, ridges, sed, touching = _response(run)
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
    kinds = (classes["enter"], classes["leave"], classes["stay and fall by more than 5 %"], classes["stay within 5 %"])
    return [
        statement(
            "frequency",
            f"µ_app rises and falls once over half a period ({turned} turn)",
            {"turns": turned},
            turned == 1,
        ),
        statement(
            "sites",
            f"between 0 and {voltage[top]:.0f} V: " + ", ".join(f"{n} {words}" for words, n in classes.items()),
            {words: n for words, n in classes.items()},
            all(kinds),
            sum(n > 0 for n in kinds) > 1,
        ),
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
    touching = np.isin(r["ridge"], run.on_ridges(normal, "p_c")[0]) & np.isin(r["ridge"], run.on_ridges(slip, "p_c")[0])
    fall = float((r["merkel_sed"][slip][touching] < r["merkel_sed"][normal][touching]).mean())
    papillae = {
        row: (r["meissner_left"][row] + r["meissner_right"][row])[touching].mean() / 2 for row in (normal, slip)
    }
    layers = _changes(run)
    sc, ve, dermis = layers.values()
    sites = np.abs(r["merkel_sed"][normal][touching] / r["merkel_sed"][run.pressed][touching] - 1)
    merkel, away = r["merkel_sed"][normal], ~np.isin(r["ridge"], run.on_ridges(normal, "p_c")[0])
    return [
        statement(
            "layers",
            f"mean change (without sign) over mean SED: {100 * sc:.2g} % in it, {100 * ve:.2g} % in the viable "
            f"epidermis, {100 * dermis:.2g} % in the dermis; at Merkel sites {100 * np.median(sites):.2g} % (median)",
            {"sc": sc, "ve": ve, "dermis": dermis, "merkel": np.median(sites)},
            ve < 0.1 * sc and sites.max() < 0.05,
            ve < 0.5 * sc,
        ),
        statement(
            "Merkel",
            f"on average {merkel[~away].mean():.3g} J/m³ there, {merkel[away].mean():.3g} J/m³ at the others",
            {"contact": merkel[~away].mean(), "others": merkel[away].mean()},
            merkel[~away].min() > merkel[away].max(),
            merkel[~away].mean() > merkel[away].max(),
        ),
        statement(
            "fall", f"at {100 * fall:.0f} % of the sites that stay in contact", {"share": fall}, fall > 0.5, fall > 0.3
        ),
        statement(
            "papillae",
            f"on average from {papillae[normal]:.3g} to {papillae[slip]:.3g} J/m³",
            {"normal": papillae[normal], "slip": papillae[slip]},
            papillae[slip] > papillae[normal],
        ),
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
    worst = int(np.argmax(np.abs(off)))
    return statement(
        "claim",
        f"median difference (without sign) {100 * np.median(np.abs(off)):.2g} %, largest {100 * off[worst]:.2g} % at "
        f"ridge {sites['ridge'][worst]}; {int((np.abs(off) < 0.05).sum())} of {len(off)} sites within 5 %",
        {"median": np.median(np.abs(off)), "largest": off[worst]},
        (np.abs(off) < 0.05).all(),
        np.median(np.abs(off)) < 0.05,
    )
