"""The bands of friction in the record of a result, as words: over models of roughness, and over all assumptions.

:mod:`fingerpad.reduced.closure_band` computes them.
"""

from collections.abc import Mapping
from typing import Any

RECORD = "closures"
"""Key of the band in a result's record and in ``summary.json``."""
KNOWN = "known"
"""Key of the band over all assumptions there."""


_COUNTS = ("none", "one", "two", "three")
_VARIANT = ", "  # before what a model of roughness is computed without
_MODELS = "rough contact"


def in_words(kept: Mapping[str, Any]) -> str:
    """Return a kept band over models of roughness in sentences; empty without one."""
    if not kept:
        return ""
    found = {words: value for words, value in kept["mu_app"].items() if value is not None}
    low, high = (pick(found, key=lambda words: found[words]) for pick in (min, max))
    bounds = {words: share for words, share in kept.get("upper_bounds", {}).items() if words == high}
    first = (
        f"By models of rough contact µ_app of the middle section is {found[low]:.2f} ({low}) to {found[high]:.2f} "
        f"({high}) at full slip."
    )
    last = "Which one holds for a finger is open (docs/microscale.md)."
    return " ".join([first, *notes({**kept, "upper_bounds": bounds}), last])


def known_in_words(kept: Mapping[str, Any]) -> str:
    """Return a kept band over all assumptions, a sentence a line, the largest part first; empty without one."""
    if not kept or kept["low"] is None:
        return ""
    opened = [_opened(part) for part in kept["parts"] if part["high"] is None]
    parts = ", ".join(f"{part['name']} {span(part)}" for part in kept["parts"])
    bounds = [note for part in kept["parts"] for note in notes({"upper_bounds": part.get("upper_bounds", {})})]
    lacks = [f"Not in it: {', '.join(kept['not_known'])}, whose error is not known at this force."]
    lines = ["; ".join([f"Likely range {span(kept)}", *opened]) + ".", f"With one assumption changed: {parts}."]
    return "\n".join([*lines, *bounds, *(lacks if kept["not_known"] else [])])


def _opened(part: Mapping[str, Any]) -> str:
    """Return of which changes of a part there is no upper end, and why, in words."""
    every, why = part["no_number"], " and ".join(dict.fromkeys(part["no_number"].values()))
    if part["name"] != _MODELS:
        return f"no upper end with {' and '.join(every)}, where {why}"
    count = _COUNTS[len({words.partition(_VARIANT)[0] for words in every})]
    return f"no upper end by {count} of three models of rough contact, in which {why}"


def why_not_known(kept: Mapping[str, Any]) -> str:
    """Return why the result's own closure has no number, of a kept band over all assumptions; empty where it has."""
    if not kept or kept["low"] is not None:
        return ""
    return "; ".join(f"by {words} {why}" for words, why in kept["no_number"].items())


def span(part: Mapping[str, Any]) -> str:
    """Return the ends of a band or of a part; of an open one the end that has a number."""
    return f"{part['low']:.2f} to {part['at_least'] if part['high'] is None else part['high']:.2f}"


def notes(part: Mapping[str, Any]) -> list[str]:
    """Return which changes of a part, or closures of a band, have no number, and which number is an upper bound."""
    reasons: dict[str, list[str]] = {}
    for words, why in part.get("no_number", {}).items():
        reasons.setdefault(why, []).append(words)
    return [f"No number by {' and '.join(those)}: {why}." for why, those in reasons.items()] + [
        f"The largest number, by {words}, is an upper bound: attraction balances {100 * min(share, 1.0):.0f} % of the "
        "pressure in contact."
        for words, share in part.get("upper_bounds", {}).items()
    ]
