"""The bands of friction in the record of a result, as words: over models of roughness, and over all assumptions.

:mod:`fingerpad.reduced.closure_band` computes them.
"""

from collections.abc import Mapping
from typing import Any

RECORD = "closures"
"""Key of the band in a result's record and in ``summary.json``."""
KNOWN = "known"
"""Key of the band over all assumptions there."""


def in_words(kept: Mapping[str, Any]) -> str:
    """Return a kept band as a sentence; empty without one."""
    if not kept:
        return ""
    found = {words: value for words, value in kept["mu_app"].items() if value is not None}
    low, high = (pick(found, key=lambda words: found[words]) for pick in (min, max))
    bounds = {words: share for words, share in kept.get("upper_bounds", {}).items() if words == high}
    ends = f"{found[low]:.2f} ({low}) to {found[high]:.2f} ({high})" + " and more" * bool(kept.get("no_number"))
    words = (
        f"models of roughness: µ_app of the middle section {ends} at full slip, by the ratio of charged cylinders; "
        "which one holds for a finger is open (docs/microscale.md)"
    )
    return "; ".join([words, *notes({**kept, "upper_bounds": bounds})])


def known_in_words(kept: Mapping[str, Any]) -> str:
    """Return a kept band over all assumptions as a sentence, the largest part first; empty without one."""
    if not kept or kept["low"] is None:
        return ""
    parts = ", ".join(f"{part['name']} {_with_notes(part)}" for part in kept["parts"])
    of = "whole finger" if kept["whole"] else "middle section"
    words = f"known to about {span(kept)}, by the cheaper model of charged cylinders: µ_app of the {of} by {parts}"
    lacks = ", ".join(kept["not_known"])
    return words + (f"; not in it: {lacks}, whose error is not known at this force" if lacks else "")


def why_not_known(kept: Mapping[str, Any]) -> str:
    """Return why the result's own closure has no number, of a kept band over all assumptions; empty where it has."""
    if not kept or kept["low"] is not None:
        return ""
    return "; ".join(f"by {words} {why}" for words, why in kept["no_number"].items())


def span(part: Mapping[str, Any]) -> str:
    """Return the ends of a band or of a part: "and more" where the upper one is open."""
    if part["high"] is None:
        return f"{part['low']:.2f} and more"
    return f"{part['low']:.2f} to {part['high']:.2f}"


def notes(part: Mapping[str, Any]) -> list[str]:
    """Return which changes of a part, or closures of a band, have no number, and which number is an upper bound."""
    reasons: dict[str, list[str]] = {}
    for words, why in part.get("no_number", {}).items():
        reasons.setdefault(why, []).append(words)
    return [f"by {' and '.join(those)} {why}: no number" for why, those in reasons.items()] + [
        f"the largest number, by {words}, is an upper bound: attraction balances {100 * min(share, 1.0):.0f} % of the "
        "pressure in contact"
        for words, share in part.get("upper_bounds", {}).items()
    ]


def _with_notes(part: Mapping[str, Any]) -> str:
    """Return the ends of a part, its largest number where they are open, and why, in brackets."""
    low, most = part["low"], part.get("at_least", part["low"])
    ends = f"{low:.2f} to {most:.2f} and more" if most > low else span(part)
    return f"{ends} ({'; '.join(of_ends)})" if (of_ends := notes(part)) else ends
