"""What people and nerves were measured to do, beside spikes of the default finger on coarse elements.

Viscous or elastic skin under a voltage that rises and falls in sliding, the onset of sliding, and virtual gratings on
the small finger of the demos. Their verdicts are in :mod:`.felt_rows`.
"""

import argparse
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import fingerpad as fp
from benchmarks import harness
from benchmarks.measured.fingers import SOFT
from benchmarks.runs import Run
from fingerpad.afferents import threshold
from fingerpad.results import fields
from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.spikes import Spikes
from fingerpad.scene import Scene
from fingerpad.scene import load as load_scene
from geometry.profiles import Profiles
from variational.state import ContactState

Array = NDArray[np.float64]
LOADS = (25.0, 75.0, 150.0)  # N/m
LOAD, VOLTS = 75.0, 200.0  # N/m, V
PRESS, HOLD, SPEED = 0.04, 0.3, 20e-3  # s, s, m/s
RISE, FALL, STEP, LAST = 0.02, 0.07, 0.01, 0.12  # s: when a voltage rises and falls, in what time, and the end
RELAXED, SLOW = 5.0, 2e-3  # s, m/s: viscous skin relaxes held, and in a slow slide, before the voltage rises
SKINS = {"viscous": "fingerpad", "elastic": None}  # preset of the soft layers
PERIODS, GRATING_LOADS, GRATING_SPEED = (1.0e-3, 2.5e-3), (4.0, 10.0), 50e-3  # m, N/m, m/s
_LIMIT = 1500.0  # s of processor time for one run
_KEPT = 1.5e-3  # m, of the response under a line load that is drawn
SMALL = Path(__file__).parents[2] / "demos" / "scenes" / "small_finger.toml"
_GRATINGS = 3  # periods of a grating that are passed
THRESHOLDS: dict[str, dict[float, float]] = {
    "SA1": {2: 26.7, 5: 21.1, 10: 24.9, 20: 32.0, 40: 39.9},
    "RA1": {2: 26.0, 5: 11.1, 10: 5.56, 20: 1.82, 40: 1.18, 80: 1.58},
    "PC": {10: 33.0, 20: 3.89, 40: 0.538, 80: 0.113, 100: 0.077, 150: 0.048, 200: 0.042, 250: 0.046, 300: 0.070,
           350: 0.111},
}  # fmt: skip
"""Thresholds of nerves (µm) by frequency (Hz): curves of previous literature, digitised, ± 3 dB."""
_ANSWER, _SETTLED = 0.03, 0.05  # s: in which spikes are those of a step of the voltage; after which a hold has settled
_FLANK = (1 / 8, 3 / 8)  # of the ridges' wavelength from a ridge's middle, within which its flank is
_COARSE: dict[str, Any] = {
    "mesh": {"contact": 20e-6, "receptor": 20e-6, "growth": 0.5},
    "numerics": {"step_scale": 0.5},
    "output": {"errors": False, "receptors": True},
}
_SLIDE = {"name": "slide", "bone_x": 2.5e-3, "until_full_slip": True}


def _scene(*loads: Mapping[str, Any], **more: Any) -> Scene:
    return Scene(**_COARSE, history=[dict(load) for load in loads], **more)


def _press(f_ext: float, **more: Any) -> dict[str, Any]:
    return {"name": "press", "f_ext": f_ext} | more


def onset() -> Scene:
    """A press, a hold, and the onset of sliding without voltage."""
    hold, slide = {"name": "hold", "bone_x_by": 0.0, "duration": HOLD}, {"bone_x": 1.2e-3, "speed": SPEED}
    return _scene(_press(LOAD, duration=PRESS), hold, {"name": "slide"} | slide)


def step(f_ext: float, preset: str | None = None) -> Scene:
    """A voltage that rises, stays and falls in sliding under a load (N/m); layers of a viscous preset relax before."""
    times = [0.0, RISE, RISE + STEP, FALL, FALL + STEP, LAST]
    table = {"waveform": "file", "times": times, "values": [0.0, 0.0, VOLTS, VOLTS, 0.0, 0.0]}
    last = {"name": "step", "bone_x_by": SPEED * LAST, "voltage": table}
    if preset is None:
        return _scene(_press(f_ext), _SLIDE, last)
    hold = {"name": "hold", "bone_x_by": 0.0, "duration": RELAXED}
    settle = {"name": "settle", "bone_x_by": SLOW * RELAXED, "duration": RELAXED}
    materials = {layer: {"viscosity": {"preset": preset}} for layer in SOFT}
    return _scene(_press(f_ext, duration=PRESS), hold, _SLIDE | {"speed": SPEED}, settle, last, materials=materials)


def grating(f_ext: float, period: float) -> Scene:
    """A virtual grating on the small finger: the voltage is on in half of each period (m), under a load (N/m)."""
    frequency = GRATING_SPEED / period
    wave = {"waveform": "square", "amplitude": VOLTS / 2, "offset": VOLTS / 2, "frequency": frequency}
    load = {"name": "grating", "bone_x_by": _GRATINGS * period, "duration": _GRATINGS / frequency, "voltage": wave}
    loads = [_press(f_ext), _SLIDE | {"bone_x": 1.5e-3}, load]
    return load_scene(SMALL).replace(history=loads, **_COARSE | {"mesh": {"contact": 40e-6}})


def charged(volts: float, friction: float) -> Scene:
    """A press, a wait in which a voltage may be switched on, and the onset of sliding."""
    wait = {"name": "wait", "bone_x_by": 0.0, "voltage": volts, "duration": 0.02}
    slide = {"name": "slide", "bone_x": 2.5e-3, "speed": 2 * SPEED}
    return _scene(_press(LOAD, duration=PRESS), wait, slide, friction=friction)


def scenes() -> dict[str, Scene]:
    """Return all scenes by name, but one of ``same_energy``, which needs the friction of another."""
    found = {"onset": onset(), "charged": charged(VOLTS, 0.25)}
    for f in LOADS:
        found |= {f"{skin} {f:g}": step(f, preset) for skin, preset in SKINS.items()}
    return found | {_grating(f, p): grating(f, p) for f in GRATING_LOADS for p in PERIODS}


def _grating(f_ext: float, period: float) -> str:
    return f"grating {f_ext:g} {1e3 * period:g}"


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
    return {
        "vertical": float(most[0]),
        "horizontal": float(most[1]),
        "rotated": float(whole[0]),
        "rotated_x": float(whole[1]),
    }


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
    return found | {"sed": float(np.median(np.abs(ratio - 1))), "mu_app": charged.steps[-1].mu_app}


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
    for name, begin, last in (("rise", RISE, FALL), ("fall", FALL, LAST)):
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


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep the numbers of all findings in docs/felt.json."""
    wanted = scenes()
    summaries = harness.run(wanted, args, _LIMIT)
    runs = {name: Run(scene, args.out).result for name, scene in wanted.items()}
    same = charged(0.0, runs["charged"].steps[-1].mu_app)
    summaries |= harness.run({"same": same}, args, _LIMIT)
    numbers = {
        "thresholds": gains(),
        "subfield": line(),
        "onset": at_onset(runs["onset"]),
        "hold": in_hold(runs["onset"]),
        "shear": shear(runs["onset"]),
        "same": differing(runs["charged"], Run(same, args.out).result),
        "gratings": [
            {"load": f, "period": p, **of_grating(runs[_grating(f, p)])} for f in GRATING_LOADS for p in PERIODS
        ],
        **{skin: {f"{f:g}": of_step(runs[f"{skin} {f:g}"]) for f in LOADS} for skin in SKINS},
    }
    harness.keep("felt", numbers, harness.made(summaries.values()), args.docs)


def gains() -> dict[str, tuple[float, float]]:
    """Return by class the gain of the filters' thresholds over those of nerves, and the rms of log10 that it leaves."""
    every = {law: np.log10(1e6 * threshold(law, list(f)) / list(f.values())) for law, f in THRESHOLDS.items()}
    return {law: (float(10 ** apart.mean()), float(apart.std())) for law, apart in every.items()}


def line() -> dict[str, Any]:
    """Return the stress at a Merkel site over the places (m) of a line load near it, and its width (m)."""
    from benchmarks.measured import subfield  # finite elements

    arcs, values = subfield.response()
    near = np.abs(arcs) < _KEPT
    return {"s": arcs[near].tolist(), "stress": values[near].tolist(), "width": subfield.width(arcs, values)}
