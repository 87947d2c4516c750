"""Variables of a dataset: dimensions, values and attributes by name."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from fingerpad.io.columns import Column

Variable = tuple[tuple[str, ...], Any, dict[str, str]]
"""Dimensions, values, and attributes."""
Variables = dict[str, Variable]
"""By name."""


def array(values: Sequence[Any]) -> Any:
    """Return values of one kind as NetCDF 3 holds them."""
    if isinstance(values[0], str):
        return np.array(values, object)
    kind = np.bool_ if isinstance(values[0], bool) else np.int32 if isinstance(values[0], int) else np.float64
    return np.array(values, kind)


def described(column: Column) -> dict[str, str]:
    """Return the attributes of a variable: its unit and its meaning."""
    return {"units": column.unit, "long_name": column.meaning}
