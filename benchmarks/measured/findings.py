"""Findings on human fingers: the rows of data/findings.toml, whose head has their keys, read and checked."""

import tomllib
from pathlib import Path
from typing import Annotated, Literal

import pint
from pydantic import AfterValidator, BaseModel, ConfigDict, model_validator

FILE = Path(__file__).parents[2] / "data" / "findings.toml"
Words = Annotated[str, AfterValidator(str.strip)]


def _unit(text: str) -> str:
    """Return a unit that pint has."""
    try:
        pint.Unit(text)
    except (pint.UndefinedUnitError, ValueError) as error:
        raise ValueError(f"unit is {text!r}, which is no unit of pint") from error
    return text


class Source(BaseModel):
    """Where findings were read."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    words: Words
    link: str
    """Empty where no address was read."""


class Finding(BaseModel):
    """A finding, its value, and how a computed number is judged by it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: str
    topic: Words
    quantity: Words
    condition: Words
    value: float | tuple[float, float] | str
    unit: Annotated[str, AfterValidator(_unit)]
    people: int | Literal["not read", "none"]
    source: str
    read: Literal["R", "C", "A", "F", "B", "Q", "N"]
    role: Literal["fit", "judge", "context"]
    finger: Literal["fitted", "moist", "held", "paper"]
    rule: Literal["trend", "exponent", "form", "ratio", "range", "spread", "bar", "none"]
    spread: float | None = None
    bar: str = ""
    why: str = ""
    built: bool = False
    area: Literal["", "ridges", "asperities", "shear strength"] = ""
    against: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _complete(self) -> "Finding":
        """Refuse a row whose rule lacks what it compares with."""
        number = not isinstance(self.value, str)
        lacks = {
            "a rule and judges": self.rule == "none" and self.role != "context",
            "a why and is of no use": not self.why and self.role == "context",
            "a spread": self.rule == "spread" and self.spread is None,
            "the words of its bar": (self.rule == "bar") != bool(self.bar),
            "a range": self.rule == "range" and not isinstance(self.value, tuple),
            "a number": self.rule in ("exponent", "ratio", "spread") and not number,
        }
        if missing := [words for words, is_missing in lacks.items() if is_missing]:
            raise ValueError(f"finding {self.id} lacks {missing[0]}")
        return self

    @property
    def bounds(self) -> tuple[float, float]:
        """The least and the largest measured number."""
        assert not isinstance(self.value, str)
        return self.value if isinstance(self.value, tuple) else (self.value, self.value)

    @property
    def measured(self) -> str:
        """The value with spread and unit, as a table has it."""
        if isinstance(self.value, str):
            return self.value
        low, high = self.bounds
        number = f"{low:g}" if low == high else f"{low:g} to {high:g}"
        unit = f"{pint.Unit(self.unit):~P}".replace("um", "µm") if self.unit else ""
        return f"{number}{'' if self.spread is None else f' ± {self.spread:g}'} {unit}".strip()


def read(path: Path = FILE) -> tuple[dict[str, Finding], dict[str, Source]]:
    """Return findings and sources by name.

    Raises:
        ValueError: a row is not complete, a source has no words, or a pair of contradictions is named by one alone.
    """
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    sources = {name: Source(**source) for name, source in data["source"].items()}
    findings = {name: Finding(id=name, **row) for name, row in data["finding"].items()}
    for name, row in findings.items():
        if row.source not in sources:
            raise ValueError(f"finding {name} has the source {row.source!r}, which is not in {path.name}")
        for other in row.against:
            if other not in findings or name not in findings[other].against:
                raise ValueError(f"finding {name} is against {other!r}, which is not against it")
    if unused := sources.keys() - {row.source for row in findings.values()}:
        raise ValueError(f"no finding has the source {min(unused)!r} of {path.name}")
    return findings, sources


def pairs(findings: dict[str, Finding]) -> list[tuple[Finding, Finding]]:
    """Return each contradiction once, in the order of the rows."""
    place = list(findings).index
    every = ((row, findings[other]) for row in findings.values() for other in row.against)
    return [(one, other) for one, other in every if place(one.id) < place(other.id)]
