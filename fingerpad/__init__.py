"""fingerpad: how a fingertip sticks and slides on a touchscreen under electroadhesion, and spikes of its nerve fibres.

    import fingerpad as fp

    result = fp.run(fp.Scene(f_ext=75.0, voltage=200.0, friction=0.25))
    print(result)

Importing this package imports nothing heavy; what needs finite elements is imported when it is used. The names and
where they come from are in ``__init__.pyi``; laws of :mod:`fingerpad.scene.materials` are names too.
"""

import ast
import os
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

# A notebook's backend is inherited by programs of its terminal. Matplotlib cannot even be imported where it is missing.
if (_KERNEL := os.environ.get("MPLBACKEND", "")).startswith("module://"):
    if find_spec(_KERNEL.removeprefix("module://").partition(".")[0]) is None:
        del os.environ["MPLBACKEND"]

_LIST = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")).body
_HOMES = {name.name: str(line.module) for line in _LIST if isinstance(line, ast.ImportFrom) for name in line.names}
_PACKAGES = {"afferents": "fingerpad.afferents", "geometry": "geometry"}
__all__ = list(dict.fromkeys([*_HOMES, *_PACKAGES]))


def __getattr__(name: str) -> Any:
    """Import what is asked for."""
    from fingerpad.launcher import needed_by, version

    if name == "__version__":
        return version()
    if name in _PACKAGES:
        return import_module(_PACKAGES[name])
    with needed_by(f"fingerpad.{name}"):
        if name == "Body":  # with the configuration of the user alone, before any other import
            import_module("fingerpad.startup")
        if name in _HOMES:
            return getattr(import_module(_HOMES[name]), name)
        laws = import_module("fingerpad.scene").laws_by_name() if name[:1].isupper() else {}  # which are classes
    if name in laws:
        return laws[name]
    raise AttributeError(f"module 'fingerpad' has no attribute {name!r}; it has {', '.join(__all__)}")


def __dir__() -> list[str]:
    return __all__
