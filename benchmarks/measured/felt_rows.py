"""Numbers and verdicts of the findings on what is felt, from the numbers that :mod:`.felt` keeps."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from benchmarks.measured.felt import GRATING_LOADS, LOAD, LOADS, PERIODS, SKINS
from benchmarks.measured.fingers import Row
from benchmarks.measured.rules import by_bar, by_share
from fingerpad.afferents import threshold

Numbers = Mapping[str, Any]
MORE, CHANGED, FEW = 1.10, 1.01, 0.10  # of spikes, of a force or a length, and spikes in which rasters may differ
ROUNDOFF = 1e-9  # of a rank correlation
RMS = {"SA1": 0.2, "RA1": 0.2, "PC": 0.3}
"""Largest rms of log10 of the thresholds after one gain a class."""
PEOPLE = {2: 24.3, 5: 11.1, 10: 5.34, 20: 1.87, 40: 0.496, 80: 0.115, 100: 0.079, 150: 0.049, 200: 0.042, 250: 0.046,
          300: 0.070, 350: 0.120}  # fmt: skip
"""Thresholds of people (µm) by frequency (Hz): curves of previous literature, digitised, ± 3 dB."""


def _ratios(numbers: Numbers, key: str, skin: str = "viscous") -> dict[str, float]:
    """Return the change in the rise over that in the fall, by load."""
    return {load: step["rise"][key] / step["fall"][key] for load, step in numbers[skin].items()}


def _numbered(ratios: Mapping[str, float], name: str = "at") -> dict[str, float]:
    return {f"{name}_{load}": value for load, value in ratios.items()}


def _rise_felt(numbers: Numbers) -> Row:
    rise, fall, *elastic = (numbers[skin][f"{LOAD:g}"][change]["RA1"] for skin in SKINS for change in ("rise", "fall"))
    found = {"rise": rise, "fall": fall, "elastic_rise": elastic[0], "elastic_fall": elastic[1]}
    return found, by_share(rise > MORE * fall)


def _rise_friction(numbers: Numbers) -> Row:
    ratios = _ratios(numbers, "f_t")
    found = _numbered(ratios) | _numbered(_ratios(numbers, "f_t", "elastic"), "elastic")
    return found, by_share(min(ratios.values()) > CHANGED)


def _rise_contact(numbers: Numbers) -> Row:
    length, strain = _ratios(numbers, "length"), _ratios(numbers, "strain")
    before = [abs(r - 1) for key in ("length", "strain") for r in _ratios(numbers, key, "elastic").values()]
    found = _numbered(length, "length") | _numbered(strain, "strain") | {"elastic": max(before)}
    return found, by_share(min([*length.values(), *strain.values()]) > CHANGED)


def _rise_low_load(numbers: Numbers) -> Row:
    ratios = _ratios(numbers, "f_t")
    low = ratios[f"{min(LOADS):g}"]
    return _numbered({k: v - 1 for k, v in ratios.items()}), by_share(low > CHANGED and low == max(ratios.values()))


def _gratings(numbers: Numbers, key: str) -> dict[tuple[float, float], float]:
    return {(found["load"], found["period"]): found[key] for found in numbers["gratings"]}


def _gratings_period(numbers: Numbers) -> Row:
    f_t, (short, long) = _gratings(numbers, "f_t"), PERIODS
    ratios = {f"{load:g}": f_t[load, long] / f_t[load, short] for load in GRATING_LOADS}
    return _numbered(ratios), by_share(max(ratios.values()) < 1 / CHANGED)


def _gratings_load(numbers: Numbers) -> Row:
    rate, (light, heavy) = _gratings(numbers, "RA1"), GRATING_LOADS
    found = {f"{k}_{n}": rate[f, p] for k, f in (("light", light), ("heavy", heavy)) for n, p in enumerate(PERIODS)}
    return found, by_share(all(rate[light, p] > MORE * rate[heavy, p] for p in PERIODS))


def _gratings_rate(numbers: Numbers) -> Row:
    rate, force = _gratings(numbers, "RA1"), _gratings(numbers, "rate")
    found = float(spearmanr([rate[k] for k in rate], [force[k] for k in rate]).statistic)
    return {"value": found}, by_share(found >= 0.8 - ROUNDOFF)


def _slip_onset(numbers: Numbers) -> Row:
    found = numbers["onset"]
    strain, more = found["RA1 strain"], found["SA1"] - found["SA1 before"]
    every = {"strain": strain, "stress": found["RA1"], "slow": found["SA1"], "more": more}
    return every, by_share(strain > 0 and strain >= 3 * max(more, 0.0))


def _hold_adapts(numbers: Numbers) -> Row:
    found = numbers["hold"]
    return found, by_share(found["RA1"] == 0 and found["least"] >= 1.5)


def _subfield(numbers: Numbers) -> Row:
    width = numbers["subfield"]["width"]
    return {"width": 1e3 * width}, by_share(0.3e-3 <= width <= 0.5e-3)


def _flanks(numbers: Numbers) -> Row:
    return numbers["shear"], by_share(numbers["shear"]["vertical"] >= 2 * numbers["shear"]["horizontal"])


def _same_energy(numbers: Numbers) -> Row:
    found = numbers["same"]
    parts = {law: found[law]["apart"] / max(found[law]["charged"], 1) for law in ("SA1", "RA1")}
    return parts | {key: found[key] for key in ("sed", "mu_app")}, by_bar(max(parts.values()), FEW)


def _nerve_thresholds(numbers: Numbers) -> Row:
    rms = {law: rms for law, (_, rms) in numbers["thresholds"].items()}
    return rms, by_share(all(rms[law] <= RMS[law] for law in RMS))


def _human_threshold(numbers: Numbers) -> Row:
    """Judge the least threshold of the classes, each with its gain on nerves, by that of people."""
    every = [1e6 * threshold(law, list(PEOPLE)) / gain for law, (gain, _) in numbers["thresholds"].items()]
    rms = float(np.sqrt(np.mean(np.log10(np.min(every, axis=0) / np.array(list(PEOPLE.values()))) ** 2)))
    return {"value": rms}, by_bar(rms, 0.2, 0.3)


_PARTS: tuple[Callable[[Numbers], Row], ...] = (
    *(_rise_felt, _rise_friction, _rise_contact, _rise_low_load, _gratings_period, _gratings_load, _gratings_rate),
    *(_slip_onset, _hold_adapts, _subfield, _flanks, _same_energy, _nerve_thresholds, _human_threshold),
)
ROWS = {part.__name__[1:]: part for part in _PARTS}
"""Computations of findings by name."""
