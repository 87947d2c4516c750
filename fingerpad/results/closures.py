"""The band of friction over models of roughness in the record of a result, as words.

:mod:`fingerpad.reduced.closure_band` computes it.
"""

from collections.abc import Mapping
from typing import Any

RECORD = "closures"
"""Key of the band in a result's record and in ``summary.json``."""


def in_words(kept: Mapping[str, Any]) -> str:
    """Return a kept band as a sentence; empty without one."""
    if not kept:
        return ""
    found = {words: value for words, value in kept["mu_app"].items() if value is not None}
    none = [words for words, value in kept["mu_app"].items() if value is None]
    low, high = (pick(found, key=lambda words: found[words]) for pick in (min, max))
    text = (
        f"models of roughness: µ_app {found[low]:.2f} ({low}) to {found[high]:.2f} ({high}) at full slip, by the ratio "
        "of charged cylinders; which one holds for a finger is open (docs/microscale.md)"
    )
    return text + (f"; no equilibrium by {', '.join(none)}" if none else "")
