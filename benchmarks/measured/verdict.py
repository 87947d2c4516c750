"""The rules of the verdicts, the same for every row of a kind; their words are in ``benchmarks/prose/measured.md``."""

HIT, PART, MISS = "hit", "partly", "miss"
BUILT = "hit by construction"
"""The model's equations or inputs leave nothing else: such a row tests nothing."""
EXPONENT = 0.25  # from the measured exponent: what 10 % of scatter makes of a factor of 2 in voltage
RATIO, VALUE = 1.25, 2.0  # largest factors of a ratio that is hit, and of a number that is met partly


def by_share(share: float) -> str:
    """Return the verdict on a statement that holds at a part of the loads: all, half of them or more, or fewer."""
    return HIT if share == 1 else PART if share >= 0.5 else MISS


def by_factor(low: float, high: float, least: float, most: float, allowed: float = 1.0) -> str:
    """Return the verdict on numbers from ``low`` to ``high`` beside measured ones from ``least`` to ``most``.

    All positive; ``allowed`` is the factor by which a number that is hit can be outside.
    """
    beyond = max(least / low, high / most, 1.0)
    return HIT if beyond <= allowed else PART if beyond <= VALUE else MISS


def by_fit(value: float, hit: float, part: float) -> str:
    """Return the verdict on a coefficient of determination, or on another number that is better the larger it is."""
    return HIT if value >= hit else PART if value >= part else MISS
