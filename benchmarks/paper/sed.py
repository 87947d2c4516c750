"""Fig. 9 and section 5: strain energy density at the receptors, its response to a sine, and the perception claim."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from benchmarks.paper.statement import Statement, verdict
from benchmarks.paper.style import BLUE, GREEN, PURPLE, VERMILION
from benchmarks.runs import Array, Run
from fingerpad.io.finger_picture import interfaces
from geometry import tags

_MM, _UM, _KPA = 1e-3, 1e-6, 1e3
_NUMBERED = 2  # every so many Merkel sites carry their number in the maps


def number(run: Run, ridge: int) -> str:
    """Return the name of a ridge's Merkel site, counted along the arc as the paper does."""
    return f"M{int(ridge) + (run.scene.geometry.ridge_count + 1) // 2}"


# -- maps ------------------------------------------------------------------------------------------------
def figure_9a(figure: Figure, without: Run, with_voltage: Run) -> None:
    """Maps of the energy density near the contact: normal and sliding, without and with voltage."""
    axes = figure.subplots(4, 1)
    states = [(run, load, words) for load, words in (("charge", "normal contact"), ("slide", "sliding"))
              for run in (without, with_voltage)]  # fmt: skip
    for ax, (run, load, words) in zip(axes, states, strict=True):
        _map(figure, ax, run, load)
        ax.set_title(f"{words}, {run.scene.voltage:g} V", loc="left")
    axes[-1].set_xlabel("x (mm)")


def _map(figure: Figure, ax: Axes, run: Run, load: str) -> None:
    a = run.arrays(f"finger_{load}")
    xy = (a["x"] + a["u"]) / _MM
    low = xy[xy[:, 1] <= 0.5e-3, 0]
    left, right, top = low.min() - 0.8, low.max() + 0.8, 1.05
    centre = xy[a["triangles"]].mean(axis=1)
    near = (centre[:, 0] > left) & (centre[:, 0] < right) & (centre[:, 1] < top)
    norm = LogNorm(0.02, 20)
    triangles = Triangulation(xy[:, 0], xy[:, 1], a["triangles"][near])
    shown = np.clip(a["sed"][near] / _KPA, norm.vmin, norm.vmax)
    drawn = ax.tripcolor(triangles, facecolors=shown, cmap="viridis", norm=norm, rasterized=True)
    ax.add_collection(LineCollection(list(xy[interfaces(a["triangles"], a["tag"])[0]]), colors="white", linewidths=0.5))
    sites = a["merkel"] / _MM
    inside = (sites[:, 0] > left) & (sites[:, 0] < right) & (sites[:, 1] < top)
    ax.plot(*sites[inside].T, "o", ms=3, mfc="white", mec="black", mew=0.6)
    half = (len(sites) - 1) // 2
    for k in np.flatnonzero(inside):
        if (k - half) % _NUMBERED == 0:
            ax.annotate(number(run, k - half), sites[k], xytext=(0, 4), textcoords="offset points", fontsize=6,
                        ha="center", color="white")  # fmt: skip
    ax.axhline(0, color="black", lw=1.5)
    ax.set(xlim=(left, right), ylim=(-0.03, top), aspect="equal", ylabel="y (mm)")
    figure.colorbar(drawn, ax=ax, extend="both", label="SED (kJ/m³)")


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


def _chosen(run: Run) -> dict[str, int]:
    """Return four sites' positions in the response: one that enters, leaves, bends, and hardly changes."""
    voltage, _, ridges, sed, touching = _response(run)
    top = int(np.argmax(voltage))
    change = sed[top] / sed[0] - 1
    enters, leaves = touching[top] & ~touching[0], touching[0] & ~touching[top]
    stays = touching.all(axis=0)
    leading = stays & (ridges > 0)
    falls = int(np.argmin(np.where(stays, change, np.inf)))
    found = {"bends": falls, "hardly changes": int(np.argmin(np.where(stays, abs(change), np.inf)))}
    # Where no ridge comes or goes, the ones at either end of the contact.
    edge_in = np.flatnonzero(enters) if enters.any() else np.flatnonzero(leading)[-1:]
    edge_out = np.flatnonzero(leaves) if leaves.any() else np.flatnonzero(stays)[:1]
    words_in = "enters" if enters.any() else "leading edge"
    words_out = "leaves" if leaves.any() else "trailing edge"
    return {words_in: int(edge_in[-1]), words_out: int(edge_out[0])} | found


def figure_9b(figure: Figure, run: Run) -> None:
    """Apparent friction and SED at four sites over the phase of the voltage."""
    voltage, mu_app, ridges, sed, _ = _response(run)
    phase = np.linspace(0, 180, len(voltage))
    first, second, third = figure.subplots(3, 1, sharex=True)
    first.plot(phase, voltage, "o-", color="black", ms=3)
    first.set_ylabel("U (V)")
    second.plot(phase, mu_app, "o-", color=BLUE, ms=3)
    second.set_ylabel("µ_app (–)")
    largest = sed[0].max()
    looks = ((VERMILION, "s", "-"), (GREEN, "^", "--"), (PURPLE, "D", "-."), (BLUE, "o", ":"))
    for (words, k), (colour, marker, dashes) in zip(_chosen(run).items(), looks, strict=True):
        label = f"{number(run, ridges[k])} {words}"
        third.plot(phase, sed[:, k] / largest, color=colour, marker=marker, ls=dashes, ms=3, label=label)
    third.set(xlabel="phase of the voltage (°), half a period", ylabel="SED over the\nlargest at 0 V (–)")
    third.legend(ncols=4, loc="upper center", bbox_to_anchor=(0.5, -0.45))


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
        Statement(
            "9B",
            "the response has twice the voltage's frequency",
            f"µ_app rises and falls once over half a period ({turned} turn)",
            {"turns": float(turned)},
            verdict(turned == 1),
            "" if turned == 1 else "sliding on between the voltages leaves its path",
        ),
        Statement(
            "9B",
            "sites enter, leave, bend or stay",
            f"between 0 and {voltage[top]:.0f} V: " + ", ".join(f"{n} {words}" for words, n in classes.items()),
            {words: float(n) for words, n in classes.items()},
            verdict(all(kinds), sum(n > 0 for n in kinds) > 1),
            "not every kind is found",
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
        Statement(
            "9A",
            "in normal contact voltage changes SED only in the stratum corneum",
            f"mean change (without sign) over mean SED: {100 * sc:.2g} % in it, {100 * ve:.2g} % in the viable "
            f"epidermis, {100 * dermis:.2g} % in the dermis; at Merkel sites {100 * np.median(sites):.2g} % (median)",
            {"sc": sc, "ve": ve, "dermis": dermis, "merkel": float(np.median(sites))},
            verdict(ve < 0.1 * sc and sites.max() < 0.05, ve < 0.5 * sc),
            "layers above share some of what the outer one feels",
        ),
        Statement(
            "9A",
            "SED is largest at the Merkel sites below contacting ridges",
            f"on average {merkel[~away].mean():.3g} J/m³ there, {merkel[away].mean():.3g} J/m³ at the others",
            {"contact": float(merkel[~away].mean()), "others": float(merkel[away].mean())},
            verdict(bool(merkel[~away].min() > merkel[away].max()), bool(merkel[~away].mean() > merkel[away].max())),
            "next to the contact's edge the sites share the load",
        ),
        Statement(
            "9A",
            "in sliding most Merkel sites' SED falls",
            f"at {100 * fall:.0f} % of the sites that stay in contact",
            {"share": fall},
            verdict(fall > 0.5, fall > 0.3),
            "the leading ridges are pressed, the trailing ones relieved",
        ),
        Statement(
            "9A",
            "SED in the dermal papillae (Meissner sites) rises in sliding",
            f"on average from {papillae[normal]:.3g} to {papillae[slip]:.3g} J/m³",
            {"normal": float(papillae[normal]), "slip": float(papillae[slip])},
            verdict(bool(papillae[slip] > papillae[normal])),
        ),
    ]


# -- the perception claim ----------------------------------------------------------------------------------
def figure_claim(figure: Figure, with_voltage: Run, rougher: Run) -> None:
    """SED at each Merkel site: voltage at µ_0 against no voltage at µ_app."""
    ridges, a, b = claim(with_voltage, rougher)
    ax = figure.subplots()
    ax.plot(
        ridges,
        a,
        "v-",
        color=VERMILION,
        ms=4,
        label=f"{with_voltage.scene.voltage:g} V, µ0 = {with_voltage.scene.friction:g}",
    )
    ax.plot(ridges, b, "o--", color="black", ms=4, label=f"0 V, µ0 = {rougher.scene.friction:g}")
    ax.set(xlabel="ridge (Merkel site)", ylabel="SED at full slip (J/m³)")
    ax.legend()


def claim(with_voltage: Run, rougher: Run) -> tuple[Array, Array, Array]:
    """Return the ridges in contact in either run, and their SED with voltage and with friction instead."""
    touching = {*with_voltage.on_ridges(with_voltage.slip, "p_c")[0], *rougher.on_ridges(rougher.slip, "p_c")[0]}
    mine = np.isin(with_voltage.receptors["ridge"], list(touching))
    return (
        with_voltage.receptors["ridge"][mine],
        with_voltage.receptors["merkel_sed"][with_voltage.slip][mine],
        rougher.receptors["merkel_sed"][rougher.slip][mine],
    )


def claim_statement(with_voltage: Run, rougher: Run) -> Statement:
    """Return the verdict on the paper's central claim, site by site."""
    ridges, a, b = claim(with_voltage, rougher)
    off = b / a - 1
    worst = int(np.argmax(np.abs(off)))
    return Statement(
        "section 5",
        "SED with voltage at µ0 equals SED without voltage at µ0 = µ_app",
        f"median difference (without sign) {100 * np.median(np.abs(off)):.2g} %, largest {100 * off[worst]:.2g} % at "
        f"{number(with_voltage, ridges[worst])}; {int((np.abs(off) < 0.05).sum())} of {len(off)} sites within 5 %",
        {"median": float(np.median(np.abs(off))), "largest": float(off[worst])},
        verdict(bool((np.abs(off) < 0.05).all()), bool(np.median(np.abs(off)) < 0.05)),
        "at the ends of the contact the attraction holds ridges that friction alone lets go",
    )
