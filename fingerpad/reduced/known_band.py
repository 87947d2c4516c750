"""About how far a friction coefficient is known: what the assumptions of its scene move it by, each a part.

The ± of a result is what mesh and penalty leave unsolved. Its assumptions move µ_app by more (docs/assumptions.md,
docs/microscale.md). Each part changes one of them, and the charged cylinders give the ratio of µ_app:

- closure: the other models of roughness of the package (:mod:`fingerpad.reduced.closure_band`);
- tips: ridge tips half as curved, and one and a half times. The length of a contact follows the root of the radius;
- roughness: h_rms 20 % smaller and larger, of the result's closure;
- coating: the effective thickness h_0 of coating and skin 20 % smaller and larger;
- slices: the sum of slices beside a finger in three dimensions; of a whole finger alone.

The changes of 20 % and of the tips are conventions, those of docs/assumptions.md. The parts are independent: the band
is the root of the sum of their squares, in the logarithm of µ_app and to either side.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.reduced.closure_band import band, friction
from fingerpad.results.closures import KNOWN, RECORD
from fingerpad.scene.messages import SceneError
from fingerpad.slices.errors import known_at
from variational.roughness.bam import BearingArea
from variational.roughness.closure import Closure
from variational.roughness.tabulated import TabulatedClosure

if TYPE_CHECKING:
    from fingerpad.results.result import Result
    from fingerpad.scene import Scene

_CHANGE, _TIPS = (0.8, 1.2), (2.0, 1 / 1.5)  # factors of a value, and of the radius of a tip
Part = tuple[str, list[float]]
"""Name of an assumption, and µ_app over that of the result with it changed."""


def with_band(result: "Result") -> "Result":
    """Return a result with its bands in its record, where it has some: over closures, and over all assumptions."""
    found = band(result)
    all_parts = known(result, found.get("mu_app", {}))
    more = ({RECORD: found} if found else {}) | ({KNOWN: all_parts} if all_parts else {})
    return replace(result, record=result.record | more) if more else result


def known(result: "Result", closures: dict[str, float | None]) -> dict[str, Any]:
    """Return the band of µ_app at full slip and its parts, the largest first, ready for JSON; empty without a band.

    Args:
        result: with full slip under a voltage.
        closures: µ_app of its section by each model of roughness; empty where there is none.
    """
    slip = result.full_slip
    if slip is None or not slip.voltage or not slip.mu_app > 0 or result.scene.history is not None:
        return {}
    whole = result.whole and result.finger is not None and "full_slip" in result.finger.states
    mu = result.finger.states["full_slip"].mu_app if whole and result.finger is not None else slip.mu_app
    try:
        parts = [*_parts(result, closures)]
    except SceneError:
        return {}
    ends = [(name, min(1.0, *ratios), max(1.0, *ratios)) for name, ratios in parts if ratios]
    if not ends:
        return {}
    ends.sort(key=lambda each: -np.log(each[2] / each[1]))
    below, above = (float(np.sqrt(sum(np.log(each[k]) ** 2 for each in ends))) for k in (1, 2))
    return {
        "mu_app": mu, "low": mu * float(np.exp(-below)), "high": mu * float(np.exp(above)), "whole": whole,
        "parts": [{"name": name, "low": mu * low, "high": mu * high} for name, low, high in ends],
    }  # fmt: skip


def _parts(result: "Result", closures: dict[str, float | None]) -> Iterator[Part]:
    scene, slip, press = result.scene, result.full_slip, result.uncharged
    assert slip is not None
    own = scene.closure()
    found = [value / slip.mu_app for value in closures.values() if value is not None]
    yield "closure", found
    here = friction(scene, slip, own, press)
    if here is None:
        return

    def ratios(changed: "Iterator[tuple[Scene, Closure, float]]") -> list[float]:
        values = (friction(each, slip, law, press, tips) for each, law, tips in changed)
        return [value / here for value in values if value is not None]

    yield "tips", ratios((scene, own, tips) for tips in _TIPS)
    if isinstance(own, BearingArea | TabulatedClosure):
        yield "roughness", ratios((scene, replace(own, h_rms=factor * own.h_rms), 1.0) for factor in _CHANGE)
        yield "coating", ratios((*_coated(scene, own, factor), 1.0) for factor in _CHANGE)
    if result.whole and result.finger is not None and "f_t" in (ends := known_at(result.finger.f_ext)):
        yield "slices", [1 / (1 + end) for end in ends["f_t"]]


def _coated(scene: "Scene", own: "BearingArea | TabulatedClosure", factor: float) -> "tuple[Scene, Closure]":
    """Return a scene and its closure with a multiple of the effective insulator thickness."""
    electric = scene.electric
    changed = electric.model_copy(update={"d_i": factor * electric.d_i, "eps_sc": electric.eps_sc / factor})
    other = scene.model_copy(update={"electric": changed})
    return other, replace(own, h_0=other.h_0)
