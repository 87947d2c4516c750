"""Cross-sections of fingertips and of small bodies, meshed with gmsh.

Shapes are values: ``geometry.ridge(size=10e-6)`` says what to mesh. gmsh is imported with the first of them.
"""

import importlib
from typing import Any

_HOMES = {
    "block": "geometry.bodies",
    "ridge": "geometry.bodies",
    "pad": "geometry.bodies",
    "finger": "geometry.fingertip",
    "file": "geometry.meshfile",
}


def __getattr__(name: str) -> Any:
    """Import the module of a shape when it is first asked for."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}; its shapes are {', '.join(_HOMES)}")
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """Return the shapes, too."""
    return sorted({*globals(), *_HOMES})
