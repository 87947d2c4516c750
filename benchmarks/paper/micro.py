"""Figs. 4 and 5: the bearing area model, its folds and both readings of the stickiness threshold."""

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper.statement import Statement, verdict
from benchmarks.paper.style import VOLTAGE
from fingerpad.scene import Scene

_UM, _KPA = 1e-6, 1e3


def figure_4(figure: Figure) -> None:
    """Equivalent air gap over mean separation."""
    scene = Scene()
    bam = scene.roughness.bearing_area(scene.h_0)
    u = np.linspace(0, 9 * _UM, 500)
    ax = figure.subplots()
    ax.plot(u / _UM, bam.air_gap(u) / _UM, color="black")
    least = float(bam.air_gap(0.0))
    ax.plot(0, least / _UM, "o", color="#D55E00", label=f"hard limit of Eq. 14, {least / _UM:.3f} µm")
    ax.set(xlabel="mean separation ū (µm)", ylabel="equivalent air gap $d_{eq}$ (µm)", xlim=(0, 9), ylim=(0, 12))
    ax.legend()


def figure_5(figure: Figure) -> None:
    """External pressure over equivalent air gap; the branch between the folds is unstable."""
    scene = Scene()
    bam = scene.roughness.bearing_area(scene.h_0)
    u = np.linspace(bam.h_0 / 2, 16 * _UM, 4000)
    d = bam.air_gap(u)
    left, right = figure.subplots(1, 2)
    for voltage, (colour, _, dashes) in VOLTAGE.items():
        p = bam.external_pressure(u, voltage)
        for ax in (left, right):
            ax.plot(d / _UM, p / _KPA, color=colour, ls=dashes, label=f"{voltage:g} V")
        rising = np.diff(p) > 0
        unstable = np.where(np.append(rising, False), p, np.nan)
        right.plot(d / _UM, unstable / _KPA, color=colour, lw=4, alpha=0.3)
        fold = bam.pull_off_fold(voltage)
        if fold is not None:
            on = int(np.flatnonzero(rising)[-1]) + 1
            for name, at in (("pull-off", fold), ("pull-in", u[on])):
                xy = bam.air_gap(at) / _UM, bam.external_pressure(at, voltage) / _KPA
                right.plot(*xy, "o", color=colour, mfc="white", zorder=4)
                right.annotate(f"{name}, {voltage:g} V", xy, xytext=(6, -10), textcoords="offset points", fontsize=8)
    for ax in (left, right):
        ax.axhline(0, color="0.7", lw=0.8, zorder=0)
        ax.set_xlabel("equivalent air gap $d_{eq}$ (µm)")
    left.set(ylabel="external pressure $p_{ext}$ (kPa)", xlim=(1.4, 5), ylim=(-5, 100))
    right.set(xlim=(1.4, 46), ylim=(-4.5, 6), title="near zero; thick: unstable branch")
    left.legend()


def statements() -> list[Statement]:
    """Return the microscale's statements."""
    scene = Scene()
    bam = scene.roughness.bearing_area(scene.h_0)
    least, estimate, exact = float(bam.air_gap(0.0)), bam.threshold(approximate=True), bam.threshold()
    return [
        Statement(
            "4, Eq. 14",
            "d_eq approaches a hard limit of 1.49 µm",
            f"{least / _UM:.3f} µm at ū = 0",
            {"d_eq": least},
            verdict(abs(least / (1.49 * _UM) - 1) < 0.005),
        ),
        Statement(
            "5, Eq. 15",
            "macroscopic adhesion only above 155 V",
            f"{estimate:.1f} V by Eq. 15, {exact:.1f} V by minimising Eq. 9",
            {"eq_15": estimate, "eq_9": exact},
            verdict(abs(exact / 155 - 1) < 0.01, abs(estimate / 155 - 1) < 0.01),
            "Eq. 15 is an estimate with another prefactor of the repulsion and h_0 << h_rms",
        ),
    ]
