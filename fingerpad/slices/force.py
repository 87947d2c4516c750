"""A force on a whole finger as it is given: a number, a text with a unit, or a quantity of pint."""

from typing import Any

from fingerpad.scene import SceneError
from fingerpad.scene.messages import show
from fingerpad.scene.reading import plain
from geometry.bounds import Range
from geometry.units import to_si

NEWTONS = Range(1e-5, 200.0, "N")
"""Forces on a whole finger: the weight of a milligram to that of 20 kg."""


def newtons(force: Any) -> float:
    """Return a force on a whole finger (N), given as a number, a text with a unit, or a quantity of pint.

    Raises:
        SceneError: it is none of these, or out of range.
    """
    given = plain(force, ("force",))
    if isinstance(given, str):
        try:
            value = to_si(given, "N")
        except ValueError as error:
            raise SceneError(f"force is {show(given)}; {error}") from None
    elif isinstance(given, bool) or not isinstance(given, int | float):
        shown = given if isinstance(given, bool) else type(force).__name__
        raise SceneError(f"force is {shown}; it must be a number in N or a text such as '0.5 N'")
    else:
        value = float(given)
    if value not in NEWTONS:
        raise SceneError(f"force {NEWTONS.words(value, slip=not isinstance(given, str))}")
    return value
