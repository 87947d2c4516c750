"""The rules of the verdicts, the same for every row of a kind; their words are in ``benchmarks/prose/measured.md``."""

from collections.abc import Sequence

HIT, PART, MISS = "hit", "partly", "miss"
BUILT = "hit by construction"
"""The model's equations or inputs leave nothing else: such a row tests nothing."""
EXPONENT = 0.25  # from the measured exponent: what 10 % of scatter makes of a factor of 2 in voltage
RATIO, VALUE = 1.25, 2.0  # largest factors of a ratio that is hit, and of a number that is met partly
MISFIT = 0.1  # rms of a fitted curve
STRIKING, SIMILAR = 0.25, 0.1  # relative changes that count as strikingly higher, and as similar
CHANGED = 0.03  # relative change from which on a gross area counts as another: half a ridge of 17


def by_share(share: float) -> str:
    """Return the verdict on a statement that holds at a part of the loads: all, half of them or more, or fewer."""
    return HIT if share == 1 else PART if share >= 0.5 else MISS


def by_factor(low: float, high: float, least: float, most: float, allowed: float = 1.0) -> str:
    """Return the verdict on numbers from ``low`` to ``high`` beside measured ones from ``least`` to ``most``.

    All positive; ``allowed`` is the factor by which a number that is hit can be outside.
    """
    beyond = max(least / low, high / most, 1.0)
    return HIT if beyond <= allowed else PART if beyond <= VALUE else MISS


def by_form(misfits: Sequence[float], others: Sequence[float]) -> str:
    """Return the verdict on a measured form of a curve, beside another form with as many parameters.

    Args:
        misfits: rms of the fitted form, by each measure of it.
        others: rms of the other form, in the same order. Where it fits too, the curve cannot show which form it has.
    """
    found = by_share(sum(each <= MISFIT for each in misfits) / len(misfits))
    return PART if found == HIT and all(each <= MISFIT for each in others) else found
