"""A statement of the paper beside this model's number."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

HOLDS, IN_PART, NOT = "holds", "holds in part", "does not hold"


@dataclass(frozen=True)
class Statement:
    """A statement of the paper and what this model computes.

    Attributes:
        figure: of the paper.
        paper: the statement.
        ours: the computed counterpart, in words.
        numbers: from which the verdict is made, unrounded.
        verdict: whether the statement holds.
        why: reason of a verdict that is not a plain yes.
    """

    figure: str
    paper: str
    ours: str
    numbers: dict[str, float]
    verdict: str
    why: str = ""


@cache
def _texts() -> dict[str, dict[str, str]]:
    with (Path(__file__).parent / "statements.csv").open(encoding="utf-8", newline="") as file:
        return {row.pop("key"): row for row in csv.DictReader(file)}


def statement(key: str, ours: str, numbers: Mapping[str, Any], whole: object, part: object = False) -> Statement:
    """Return a statement of ``statements.csv`` with its verdict.

    Args:
        key: of the statement.
        ours: the computed counterpart, in words.
        numbers: from which the verdict is made.
        whole: whether the statement holds as a whole.
        part: whether it holds in part.
    """
    verdict = HOLDS if whole else IN_PART if part else NOT
    plain = {name: float(value) for name, value in numbers.items()}
    return Statement(ours=ours, numbers=plain, verdict=verdict, **_texts()[key])
