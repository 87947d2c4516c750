"""Code of laws of one's own: imported from Python's path alone, and known by a hash of the files it stands in."""

import hashlib
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any
from uuid import uuid4

from variational.coefficients import said

_PROGRAM = {"fingerpad", "variational", "geometry"}
_UNCODED = {"abc", "typing"} | _PROGRAM


def imported(module: str, name: str) -> Any:
    """Return what an import path names.

    Raises:
        ValueError: it cannot be imported; to follow the path and a semicolon.
    """
    if module == "__main__" or "<locals>" in name:
        raise ValueError("the class is known to the program that made it alone; put it into a module on Python's path")
    if module.partition(".")[0] in sys.stdlib_module_names:
        raise ValueError("the module is one of Python's own")
    try:
        with _python_path():
            found: Any = import_module(module)
    except ModuleNotFoundError as error:
        where = "put its folder on PYTHONPATH" if module.startswith(error.name or ".") else "which it imports"
        raise ValueError(f"Python finds no module {error.name}; {where}") from None
    except Exception as error:
        raise ValueError(f"the module cannot be imported: {said(error)}") from None
    for part in name.split("."):
        found = getattr(found, part, None)
    if found is None:
        raise ValueError(f"the module {module} has no {name}")
    return found


@contextmanager
def _python_path() -> Iterator[None]:
    """Import nothing from the current folder inside the block, unless ``PYTHONPATH`` names it."""
    before, here = sys.path, os.path.abspath(os.curdir)
    named = {os.path.abspath(each) for each in os.environ.get("PYTHONPATH", "").split(os.pathsep) if each}
    sys.path = before if here in named else [each for each in before if os.path.abspath(each) != here]
    try:
        yield
    finally:
        sys.path = before


@cache
def digest(law: Any) -> str:
    """Return a hash of the files that a class and its bases of one's own stand in; empty for those of the package.

    Code without a file, as of an interactive session, counts as itself alone, in this process alone.
    """
    own = [each for each in law.__mro__ if each is not object and each.__module__.partition(".")[0] not in _UNCODED]
    found = hashlib.sha256()
    for module in dict.fromkeys(each.__module__ for each in own):
        file = getattr(sys.modules.get(module), "__file__", None)
        try:
            found.update(Path(file or "").read_bytes())
        except OSError:
            found.update(uuid4().bytes)
    return found.hexdigest()[:16] if own else ""


def folder_of(law: type) -> str:
    """Return the folder from which the module of a class is imported; empty where there is none."""
    package, *_ = law.__module__.split(".")
    file = getattr(sys.modules.get(package), "__file__", None)
    if file is None:
        return ""
    folder = Path(file).absolute().parent
    return str(folder.parent if Path(file).stem == "__init__" else folder)
