"""Modules that are imported when something of theirs is first used, so that laws can be read without finite elements.

A law is a value: its numbers, their units and their ranges. Scenes, folders and reports hold laws where UFL may be
missing; only what writes a weak form needs it.
"""

from importlib import import_module
from typing import Any


class Lazy:
    """A module by its name."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        """Return an attribute of the module."""
        return getattr(import_module(self._name), attribute)


ufl: Any = Lazy("ufl")
kinematics: Any = Lazy("variational.kinematics")
