"""A law's numbers as fields or constants of a compiled form, which then stays as it is when they change.

A law is a frozen dataclass that computes with its own numbers. A form is written with a copy of the law that carries
UFL coefficients in the place of the numbers.
"""

import copy
from collections.abc import Callable, Mapping
from dataclasses import MISSING, field, fields, is_dataclass, replace
from importlib import import_module
from typing import Any, ClassVar, Self

import numpy as np


class _Lazy:
    """A module by its name, imported when something of it is first used.

    A law is a value: its numbers, their units and their ranges. Scenes, folders and reports hold laws where UFL may be
    missing; only what writes a weak form needs it.
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        """Return an attribute of the module."""
        return getattr(import_module(self._name), attribute)


ufl: Any = _Lazy("ufl")
kinematics: Any = _Lazy("variational.kinematics")

OF_SCENE = {"of scene": True}
"""Metadata of a field that a scene gives by itself, such as the thickness of its insulators; no key of the law."""


def parameter(
    low: float, high: float, unit: str = "", *, zero: bool = False, sides: int = 1, default: Any = MISSING
) -> Any:
    """Return the field of a law's number, with what scenes and their reference read of it.

    Args:
        low: smallest value that a scene may give, of the amount where ``sides`` is 2.
        high: largest value.
        unit: in SI; empty for a number without.
        zero: whether zero is allowed too.
        sides: 2 where the sign is free.
        default: of the field; without it, the number must be given.
    """
    return field(default=default, metadata={"range": (low, high, unit, zero, sides)})


def between(first: Any, last: Any, part: float) -> Any:
    """Return a law whose numbers are a part of the way from one law's to another's of the same kind, else the last."""
    if part >= 1 or type(first) is not type(last) or not is_dataclass(first):
        return last
    names = [f.name for f in fields(first) if f.type in (float, "float") and f.init]
    numbers = {name: (1 - part) * getattr(first, name) + part * getattr(last, name) for name in names}
    return replace(last, **numbers)  # type: ignore[type-var]


class LawError(ValueError):
    """A law of one's own that the weak form cannot take; one sentence."""


def said(error: BaseException) -> str:
    """Return the message of an error in a user's law, in one line."""
    return " ".join(str(error).split()) or type(error).__name__


def refuse_not_positive(law: Any, zero: bool = False) -> None:
    """Refuse a dataclass with a ``float`` that is not greater than 0 and finite.

    Args:
        law: the dataclass.
        zero: whether 0 is allowed.

    Raises:
        ValueError: in one sentence.
    """
    for each in fields(law):
        value = getattr(law, each.name)
        number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
        number = number and (0 < value < np.inf or (zero and value == 0))
        if each.type in (float, "float") and not number:
            allowed = "0 or more" if zero else "greater than 0"
            raise ValueError(f"{each.name} of {type(law).__name__} is {value!r}; it must be finite and {allowed}")


class Named:
    """A class of dataclasses that refuse a parameter they do not have in one sentence, with those that they have."""

    def __new__(cls, *_: Any, **given: Any) -> Self:
        """Return an instance.

        Raises:
            LawError: a name that is none of the dataclass.
        """
        names = [f.name for f in fields(cls) if f.init] if is_dataclass(cls) else [*given]
        wrong = next((name for name in given if name not in names), None)
        if wrong is not None:
            raise LawError(f"{cls.__name__} has no parameter {wrong!r}; its parameters are {', '.join(names)}")
        return super().__new__(cls)


class Law(Named):
    """A law with numbers; derive a frozen dataclass from one of the laws' bases."""

    coefficients: ClassVar[tuple[str, ...] | None] = None
    """Names of the numbers that a form reads; None for all fields that are annotated as ``float``.

    A law that names its own may name attributes made by ``functools.cached_property`` from its fields. A form reads
    these alone: no other number may stand in what the law writes.
    """

    def names(self) -> tuple[str, ...]:
        """Return the names of the numbers that a form reads."""
        return self._numbers() if self.coefficients is None else self.coefficients

    def number(self, name: str) -> Any:
        """Return one of the numbers that a form reads."""
        return getattr(self, name)

    def with_values(self, values: Mapping[str, Any]) -> Self:
        """Return a copy that carries ``values`` in the place of its numbers; other numbers it has no longer."""
        found = copy.copy(self)
        mine = {field.name for field in fields(self)}  # type: ignore[arg-type]
        for name in [name for name in vars(found) if name not in mine]:
            del vars(found)[name]  # made from the numbers of the original
        for name in self._numbers():
            object.__setattr__(found, name, None)
        for name, value in values.items():
            object.__setattr__(found, name, value)
        return found

    def with_constants(self, constant: Callable[[float], Any]) -> Self:
        """Return the law with what ``constant`` makes of each of its numbers."""
        return self.with_values({name: constant(self.number(name)) for name in self.names()})

    def kind(self) -> tuple[Any, ...]:
        """Return what two laws must share to be written as one form: the type, and all that is no number."""
        left = set(self._numbers()) | set(self.names())
        return (type(self), *(getattr(self, f.name) for f in fields(self) if f.name not in left))  # type: ignore[arg-type]

    def refuse_numbers(self) -> None:
        """Refuse a law that is no frozen dataclass of finite numbers.

        Raises:
            ValueError: in one sentence.
        """
        kind = type(self)
        if not (is_dataclass(self) and kind.__dataclass_params__.frozen and hasattr(self, "__dict__")):  # type: ignore[attr-defined]
            raise ValueError(f"{kind.__name__} is a law; it must be a @dataclass(frozen=True) without slots")
        for name in self._numbers():
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not np.isfinite(value):
                raise ValueError(f"{self}: {name} is {value!r}; it must be a finite number")

    def _numbers(self) -> tuple[str, ...]:
        return tuple(f.name for f in fields(self) if f.type in (float, "float"))  # type: ignore[arg-type]
