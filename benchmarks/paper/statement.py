"""A statement of the paper beside our number."""

from dataclasses import dataclass

HOLDS, IN_PART, NOT = "holds", "holds in part", "does not hold"


@dataclass(frozen=True)
class Statement:
    """What the paper says and what we find."""

    figure: str
    paper: str
    ours: str
    numbers: dict[str, float]
    """What the verdict is made from, unrounded."""
    verdict: str
    why: str = ""
    """Of a verdict that is not a plain yes."""


def verdict(whole: bool, part: bool = False) -> str:
    """Return the words for a statement that holds as a whole, in part, or not."""
    return HOLDS if whole else IN_PART if part else NOT
