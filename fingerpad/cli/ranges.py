"""Several values of a quantity in one text, written alike for every option and in every study.

``75`` is one value, ``0, 50, 200`` are three, ``0:200:5`` are five from 0 to 200 at equal distances, both ends among
them, and ``1e3:1e6:4:log`` are four at equal ratios. Values between the ends are rounded to 12 digits, so that 0.3 is
0.3. A unit may follow, ``0:0.2:5 kV``, and in a list also each value: ``1 um, 5 um``.
"""

import math
import re
from collections.abc import Sequence

import numpy as np

from fingerpad.scene.messages import SceneError, clip

_MAX_VALUES = 10_000  # values of one range
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_UNIT = r"(?![eE][-+]?\d)[A-Za-zµμ°%][^,:]*"
_HOW = (
    "write one value, several as 0, 50, 200, or first:last:count as in 0:200:5 (1e3:1e6:4:log for equal ratios), with "
    "a unit at the end or after each value of a list"
)


def read(name: str, text: str) -> list[float | str]:
    """Return the values of a text: numbers, whole ones as such, or texts of a number and a unit where one is given.

    Args:
        name: of the key or option, for a refusal.
        text: one value, several, or a range.

    Raises:
        SceneError: a text that is none of the three.
    """
    each = [re.fullmatch(rf"({_NUMBER})\s*({_UNIT})", part.strip()) for part in text.split(",")]
    if len(each) > 1 and all(each):
        return [f"{part[1]} {part[2]}" for part in each if part]
    found = re.fullmatch(rf"([-+0-9.,:\seE]*?(?::log)?)\s*({_UNIT})?", text.strip())
    numbers, unit = (found[1].strip(), (found[2] or "").strip()) if found else ("", "")
    values = _range(name, numbers) if ":" in numbers else _list(numbers)
    if not values:
        raise SceneError(f"{name} is {clip(text) or 'empty'}; {_HOW}")
    _refuse_infinite(name, text, values)
    return [f"{float(value)!r} {unit}" for value in values] if unit else [*values]


def _list(text: str) -> list[float]:
    parts = [part.strip() for part in text.split(",")]
    return [_number(part) for part in parts] if all(re.fullmatch(_NUMBER, part) for part in parts) else []


def _number(text: str) -> float:
    return int(text) if re.fullmatch(r"[-+]?\d{1,300}", text) else float(text)


def _range(name: str, text: str) -> list[float]:
    found = re.fullmatch(rf"({_NUMBER}):({_NUMBER}):(\d+)(:log)?", text.replace(" ", ""))
    if found is None:
        return []
    first, last, count = _number(found[1]), _number(found[2]), int(found[3][:9])
    _refuse_infinite(name, text, (first, last))
    if not 1 <= count <= _MAX_VALUES:
        raise SceneError(f"{name} is {clip(text)}, of {count} values; it must be of 1 to {_MAX_VALUES}")
    if count == 1 and first != last:
        raise SceneError(f"{name} is {clip(text)}, one value with two ends; give a count of 2 or more")
    if found[4] and not (first > 0 and last > 0):
        raise SceneError(f"{name} is {clip(text)}; both ends must be greater than 0 for equal ratios")
    space = np.geomspace if found[4] else np.linspace
    between = [_number(f"{value:.12g}") for value in space(first, last, count)][1:-1]
    values = [first, *between, last] if count > 1 else [first]
    return values if all(isinstance(value, int) for value in values) else [*map(float, values)]


def _refuse_infinite(name: str, text: str, values: Sequence[float]) -> None:
    if not all(map(math.isfinite, values)):
        raise SceneError(f"{name} is {clip(text)}; each value must be a finite number, at most 1.8e308")
