"""A statement of the paper beside this model's number; all words are in ``statements.csv``."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from string import Formatter
from typing import Any

HOLDS, IN_PART, NOT = "holds", "holds in part", "does not hold"
BUILT = "holds by construction"
"""The model's symmetry or equations leave nothing else: such a statement checks the program, not the model."""
HALF = 0.5
"""Share of the loads, ridges or sites from which on a statement about all of them holds in part."""


@dataclass(frozen=True)
class Statement:
    """A statement of the paper and what this model computes."""

    figure: str
    paper: str
    ours: str  # the computed counterpart, in words
    numbers: dict[str, float]  # from which the verdict is made, unrounded
    verdict: str
    why: str = ""  # of a verdict that is not a plain yes


class _Units(Formatter):
    """Formats numbers; at the end of a format ``p`` stands for per cent and ``u`` for micrometres."""

    def format_field(self, value: Any, format_spec: str) -> str:
        if format_spec.endswith(("p", "u")):
            return format(value * {"p": 100, "u": 1e6}[format_spec[-1]], format_spec[:-1])
        return format(value, format_spec)


@cache
def _texts() -> dict[str, dict[str, str]]:
    with (Path(__file__).parent / "statements.csv").open(encoding="utf-8", newline="") as file:
        return {row.pop("key"): row for row in csv.DictReader(file)}


def statement(key: str, numbers: Mapping[str, Any], whole: object, part: object = False, **words: Any) -> Statement:
    """Return the statement ``key`` of ``statements.csv``, which holds as a ``whole``, in ``part`` or not at all.

    Its text shows ``numbers``, from which the verdict is made, and other ``words``. Where the text is marked as
    ``built``, a statement that holds does so by construction.
    """
    plain, text = {name: float(value) for name, value in numbers.items()}, _texts()[key]
    verdict = (BUILT if text["built"] else HOLDS) if whole else IN_PART if part else NOT
    ours, why = (_Units().format(text[name], **plain, **words) for name in ("ours", "why"))
    return Statement(text["figure"], text["paper"], ours, plain, verdict, why)
