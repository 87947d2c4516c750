"""What people and nerves were measured to do, a row a statement, hit or miss by a rule.

environment/run python3 -m benchmarks.feel [--draw]     also: make feel

The rules are in benchmarks/feel/rules.py. Runs are kept in results/feel; some 10 minutes of processor
time. Writes docs/feel.json, and from it docs/measured.md and its picture.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import fingerpad as fp
from benchmarks import harness
from benchmarks.feel import rules, scenes
from benchmarks.harness import keep, kept, made, page, picture
from fingerpad.results import fields
from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.pictures import style
from fingerpad.results.spikes import Spikes
from fingerpad.scene import Scene
from geometry.profiles import Profiles
from variational.state import ContactState

Array = NDArray[np.float64]
THRESHOLDS: dict[str, dict[float, float]] = {
    "SA1": {2: 26.7, 5: 21.1, 10: 24.9, 20: 32.0, 40: 39.9},
    "RA1": {2: 26.0, 5: 11.1, 10: 5.56, 20: 1.82, 40: 1.18, 80: 1.58},
    "PC": {10: 33.0, 20: 3.89, 40: 0.538, 80: 0.113, 100: 0.077, 150: 0.048, 200: 0.042, 250: 0.046, 300: 0.070,
           350: 0.111},
}  # fmt: skip
"""Thresholds of nerves (µm) by frequency (Hz): curves of previous literature, digitised, ± 3 dB."""
_ANSWER = 0.03  # s, after the begin of a step of the voltage, in which spikes are those of the step
_SETTLED = 0.05  # s, after which a hold has settled
_FLANK = (1 / 8, 3 / 8)  # of the ridges' wavelength from a ridge's middle, within which its flank is
_KEPT = 1.5e-3  # m, of the response under a line load that is drawn


def compute(args: argparse.Namespace) -> None:
    """Compute and keep the numbers."""
    from benchmarks.feel import subfield  # finite elements

    summaries: list[dict[str, Any]] = []

    def run(name: str, scene: Scene) -> fp.Result:
        found = scenes.run(name, scene, args.out.parent / "feel")
        summaries.append(found.record)
        return found

    onset = run("onset", scenes.onset())
    charged = run("charged", scenes.charged(scenes.VOLTS, 0.25))
    mu_app = charged.steps[-1].mu_app
    same = run("same", scenes.charged(0.0, mu_app))
    arcs, values = subfield.response()
    near = np.abs(arcs) < _KEPT
    numbers: dict[str, Any] = {
        "thresholds": {law: thresholds(law) for law in THRESHOLDS},
        "subfield": {"width": subfield.width(arcs, values), "s": arcs[near].tolist(), "stress": values[near].tolist()},
        "onset": at_onset(onset),
        "hold": in_hold(onset),
        "shear": shear(onset),
        "same": {**differing(charged, same), "mu_app": mu_app},
        "steps": {
            f"{f:g}": of_step(run(f"viscous_step_{f:g}", scenes.step(f, scenes.VISCOSITY))) for f in scenes.LOADS
        },
        "elastic": {f"{f:g}": of_step(run(f"step_{f:g}", scenes.step(f))) for f in scenes.LOADS},
        "gratings": [
            {"load": f, "period": p, **of_grating(run(f"grating_{f:g}_{1e3 * p:g}", scenes.grating(f, p)))}
            for f in scenes.GRATING_LOADS
            for p in scenes.PERIODS
        ],
    }
    keep("feel", numbers, made(summaries), args.docs)


def thresholds(law: str) -> dict[str, Any]:
    """Return thresholds of a class by its linear filter (µm), the gain between them and the measured, and the rms."""
    ours = 1e6 * fp.afferents.threshold(law, list(THRESHOLDS[law]))
    gain, rms = rules.log_gain(ours, list(THRESHOLDS[law].values()))
    return {"ours": ours.tolist(), "gain": 10**gain, "rms": rms}


def _span(spikes: Spikes, load: str) -> tuple[float, float]:
    return next((span.begin, span.end) for span in spikes.loads if span.name == load)


def at_onset(result: fp.Result) -> dict[str, float]:
    """Return spikes of a unit from the begin of the slide to full slip, and of SA1 in as long a time before it."""
    spikes = result.afferents(["SA1", "RA1", "RA1 strain"])
    begin, _ = _span(spikes, "slide")
    end = next(state.time for state in result.steps if state.load == "slide" and state.all_slip)
    found = {law: spikes.between(law, begin, end) / len(spikes.of(law)) for law in spikes.laws}
    before = spikes.between("SA1", 2 * begin - end, begin) / len(spikes.of("SA1"))
    return found | {"SA1 before": before, "seconds": end - begin}


def in_hold(result: fp.Result) -> dict[str, float]:
    """Return spikes of RA1 in the settled hold, and the ratio of the last to the first interval of SA1 units."""
    spikes = result.afferents(["SA1", "RA1"])
    begin, end = _span(spikes, "hold")
    held = [train[(train > begin) & (train <= end)] for train in spikes.of("SA1")]
    ratios = [float(np.diff(train)[-1] / np.diff(train)[0]) for train in held if len(train) >= 3]
    silent = spikes.between("RA1", begin + _SETTLED, end)
    return {"RA1": silent, "least": min(ratios), "most": max(ratios), "units": len(ratios)}


def shear(result: fp.Result) -> dict[str, Any]:
    """Return the largest shears of the flanks of a ridge in contact that sliding adds: vertical, horizontal.

    They are half the difference of the means over the two flanks: a rotation of the ridge is left out. A second pair
    has it.
    """
    assert result.folder is not None
    loads, _ = fields.views_of(result.folder, result.steps, result.named)
    before, after = (vars(loads[name].snapshot) for name in ("hold", "slide"))
    profiles, finger = Profiles(result.scene.geometry), result.scene.geometry
    x, cells = after["x"], after["triangles"]
    change = (after["u"] - before["u"])[cells]
    edges = x[cells][:, 1:] - x[cells][:, :1]
    gradient = np.linalg.solve(edges, change[:, 1:] - change[:, :1]).swapaxes(1, 2)  # du_i / dx_j
    middle, outer = x[cells].mean(axis=1), after["tag"] == 1  # the stratum corneum
    last = result.steps[-1].ridges
    assert last is not None
    most, whole = np.zeros(2), np.zeros(2)
    for number in last.number[last.length > 0]:
        s = np.array([number * finger.ridge_wavelength])
        skin, below = profiles.point(s, profiles.skin(s))[0], profiles.point(s, profiles.sc_ve(s))[0]
        means = []
        for side in (-1, 1):
            off = side * (middle[:, 0] - skin[0]) / finger.ridge_wavelength
            near = outer & (off > _FLANK[0]) & (off < _FLANK[1]) & (middle[:, 1] < (skin[1] + below[1]) / 2)
            area = np.abs(np.linalg.det(edges[near]))
            means.append((gradient[near] * area[:, None, None]).sum(axis=0) / area.sum())
        whole = np.maximum(whole, np.abs([[mean[1, 0], mean[0, 1]] for mean in means]).max(axis=0))
        half = (means[1] - means[0]) / 2
        most = np.maximum(most, np.abs([half[1, 0], half[0, 1]]))
    return {"vertical": float(most[0]), "horizontal": float(most[1]), "with_rotation": whole.tolist()}


def differing(charged: fp.Result, same: fp.Result) -> dict[str, Any]:
    """Return the spikes of two runs in sliding by class, in how many their units differ, and of the SED at the end."""
    every = [result.afferents(["SA1", "RA1"]) for result in (charged, same)]
    found: dict[str, Any] = {}
    for law in ("SA1", "RA1"):
        one, other = (_by_unit(spikes, law) for spikes in every)
        common = set(one) & set(other)  # of the ridges that can touch in both
        apart = sum(abs(one[unit] - other[unit]) for unit in common)
        counts = (sum(of[unit] for unit in common) for of in (one, other))
        found[law] = dict(zip(("charged", "same", "apart"), (*counts, apart), strict=True))
    sites, ridges = charged.steps[-1].sites, charged.steps[-1].ridges
    assert sites is not None and ridges is not None
    touching = np.isin(sites.number, ridges.number[ridges.length > 0])
    ratio = same.steps[-1].sites.merkel[touching] / sites.merkel[touching]  # type: ignore[union-attr]
    return found | {"sed": float(np.median(np.abs(ratio - 1)))}


def _by_unit(spikes: Spikes, law: str) -> dict[tuple[int | None, str], int]:
    """Return the number of spikes in sliding of each unit of a class, by its ridge and side."""
    begin, end = _span(spikes, "slide")
    pairs = [(unit, train) for unit, train in zip(spikes.units, spikes.trains, strict=True) if unit.law == law]
    return {(u.ridge, u.side): int(((train > begin) & (train <= end)).sum()) for u, train in pairs}


def of_step(result: fp.Result) -> dict[str, Any]:
    """Return changes of friction, length and surface strain in the rise and the fall of a voltage, and spikes.

    Time begins with the state before the load of the voltage; what the skin has from before is steady.
    """
    first = next(k for k, state in enumerate(result.steps) if state.load == "step") - 1
    start = max(result.steps[first].time, 0.0)
    states = [replace(state, time=max(state.time, 0.0) - start) for state in result.steps[first:]]
    spikes = replace(result, steps=tuple(states)).afferents(["RA1", "SA1"])

    def at(time: float) -> ContactState:
        return [state for state in states if state.time <= time + 1e-9][-1]

    found = {}
    for name, begin, last in (("rise", scenes.RISE, scenes.FALL), ("fall", scenes.FALL, scenes.LAST)):
        one, other = at(begin), at(last)
        strains = (
            np.concatenate([state.stimuli.surface_strain_left, state.stimuli.surface_strain_right])
            for state in (one, other)
            if state.stimuli is not None
        )
        before, after = strains
        found[name] = {
            "f_t": abs(other.f_t - one.f_t),
            "length": abs(other.contact_length - one.contact_length),
            "strain": float(np.sqrt(np.nanmean((after - before) ** 2))),
            **{law: spikes.between(law, begin, begin + _ANSWER) for law in spikes.laws},
        }
    return found | {"slips": all(state.all_slip for state in states)}


def of_grating(result: fp.Result) -> dict[str, float]:
    """Return mean friction (N/m), the mean of |dF_T/dt| (N/(m s)), and spikes a second of RA1 below touching ridges."""
    states = without_parts_of_jumps([state for state in result.steps if state.load == "grating"])
    spikes, seconds = result.afferents("RA1"), result.loads[-1].over_time
    assert seconds is not None
    change = np.abs(np.diff([state.f_t for state in states])).sum()
    touch = {int(j) for s in states if s.ridges is not None for j in s.ridges.number[s.ridges.length > 0]}
    count = sum(len(train) for unit, train in zip(spikes.units, spikes.trains, strict=True) if unit.ridge in touch)
    return {"f_t": seconds.mean["f_t"], "rate": float(change / seconds.seconds), "RA1": count / seconds.seconds}


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Write docs/measured.md and its picture from docs/feel.json."""
    numbers = kept("feel", docs).numbers
    picture(docs / "feel.png", (9, 3.8), lambda figure: _paint(figure, numbers))
    judged = rules.judge(numbers)
    count = {verdict: sum(row.verdict == verdict for row in judged) for verdict in (rules.HIT, rules.MISS, rules.OPEN)}
    more = {"judged": judged, "count": count, "site_error": site_error(kept("errors").numbers)}
    return page(docs, "feel", "make feel", {**globals(), **more})


def site_error(errors: Any) -> float:
    """Return the largest known error of energy densities at Merkel sites, over their value, on the default's path mesh.

    Args:
        errors: numbers of docs/errors.json.
    """
    found, limits = errors["again"]["path"]["values"], errors["reference"]
    return float(max(abs(found[key] / limits[key]["value"] - 1) for key in limits if "_sed_" in key))


def _paint(figure: Figure, numbers: Any) -> None:
    left, right = figure.subplots(1, 2)
    _paint_thresholds(left, numbers["thresholds"])
    field = numbers["subfield"]
    right.plot(1e3 * np.array(field["s"]), field["stress"], color=style.BLUE)
    right.axvspan(-0.2, 0.2, color=style.ORANGE, alpha=0.3, lw=0, label="measured subfield, 0.4 mm")
    right.set(xlabel="place of the line load along the skin (mm)", ylabel="stress at the Merkel site (–)")
    right.set_title("B  one Merkel site under a moving line load")
    right.legend(loc="lower center")


def _paint_thresholds(ax: Axes, found: Any) -> None:
    looks = {"SA1": (style.BLUE, "o"), "RA1": (style.VERMILION, "s"), "PC": (style.BLACK, "^")}
    for law, (colour, marker) in looks.items():
        f = np.array(list(THRESHOLDS[law]))
        fine = np.geomspace(f[0], f[-1], 100)
        ax.loglog(f, list(THRESHOLDS[law].values()), marker, color=colour, ms=5, label=f"{law} measured")
        ax.loglog(fine, 1e6 * fp.afferents.threshold(law, fine) / found[law]["gain"], color=colour, lw=1.3)
    ax.set(xlabel="frequency (Hz)", ylabel="threshold displacement (µm)")
    ax.set_title("A  lines: filters of the classes, one gain each")
    ax.legend()


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
