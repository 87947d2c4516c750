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
    none = [words for words, value in kept["mu_app"].items() if value is None]
    low, high = (pick(found, key=lambda words: found[words]) for pick in (min, max))
    text = (
        f"models of roughness: µ_app of the middle section {found[low]:.2f} ({low}) to {found[high]:.2f} ({high}) at "
        "full slip, by the ratio of charged cylinders; which one holds for a finger is open (docs/microscale.md)"
    )
    return text + (f"; no equilibrium by {', '.join(none)}" if none else "")


def known_in_words(kept: Mapping[str, Any]) -> str:
    """Return a kept band over all assumptions as a sentence, the largest part first; empty without one."""
    if not kept:
        return ""
    parts = ", ".join(f"{part['name']} {part['low']:.2f} to {part['high']:.2f}" for part in kept["parts"])
    of, ends = "whole finger" if kept["whole"] else "middle section", f"{kept['low']:.2f} to {kept['high']:.2f}"
    words = f"known to about {ends}, by the cheaper model of charged cylinders: µ_app of the {of} by {parts}"
    missing = {"left_out": "without an equilibrium", "not_known": "whose error is not known at this force"}
    lacks = [f"{', '.join(kept[key])}, {why}" for key, why in missing.items() if kept.get(key)]
    return words + (f"; not in it: {'; '.join(lacks)}" if lacks else "")
