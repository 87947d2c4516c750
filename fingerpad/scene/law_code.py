"""Code of laws of one's own: from installed packages or a folder that the user names, known by a hash of its files.

A scene is from anyone, and the path of a law in it names code to run. Where each part of that path lies is found
before any of it is imported; :func:`imported` has the rules. The folders of the user are those of ``--laws``, kept in
the variable ``FINGERPAD_LAWS`` for processes of a sweep, and of ``PYTHONPATH``, the checkout of this program excepted.
"""

import hashlib
import os
import site
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any
from uuid import uuid4

from variational.coefficients import said

LAWS = "FINGERPAD_LAWS"
"""Variable of the environment with the folders of ``--laws``."""
_PROGRAM = {"fingerpad", "variational", "geometry"}
_UNCODED = {"abc", "typing"} | _PROGRAM
_ROOT = Path(__file__).resolve().parents[2]
_CHECKOUT = {str(_ROOT)} if (_ROOT / "environment" / "run").exists() else set[str]()
_BESIDE = {"benchmarks", "conftest", "demos", "setup", "test", "tests"}  # no part of a law's path
_SCENES = set[Path]()  # folders of the scenes and results that this process has read
_HOW = "name the folder of the module by --laws FOLDER, or in Python import it first"


def foreign(folder: str | Path) -> None:
    """Import no law from below a folder, of a scene or of results, but from folders of ``--laws`` in it."""
    _SCENES.update({Path(folder).absolute(), Path(folder).resolve()})


def allow(folder: Path) -> None:
    """Import laws from a folder that the user names.

    Raises:
        ValueError: it is no folder, or its path cannot stand in a list of paths.
    """
    if not folder.is_dir() or os.pathsep in str(folder.absolute()):
        raise ValueError(f"it must be a folder, without {os.pathsep!r} in its path")
    os.environ[LAWS] = os.pathsep.join([*dict.fromkeys([*entries(LAWS), str(folder.absolute())])])


def entries(variable: str) -> list[str]:
    """Return the paths of a variable of the environment; Python takes an empty one for the current folder."""
    return [each for each in os.environ.get(variable, "").split(os.pathsep) if each]


def imported(module: str, name: str) -> Any:
    """Return what an import path names.

    A module that is imported already has been chosen by the user's program. Another one is a file of an installed
    package or in a folder of the user, and so is the ``__init__`` of each package around it. Python's own modules,
    ``__main__``, tests, demos and what lies below the folder of a scene are refused.

    Raises:
        ValueError: it cannot be imported; to follow the path and a semicolon.
    """
    if module == "__main__" or "<locals>" in name:
        raise ValueError("the class is known to the program that made it alone; put it into a module on Python's path")
    if module.partition(".")[0] in sys.stdlib_module_names:
        raise ValueError("the module is one of Python's own")
    try:
        with _search_path():
            if module not in sys.modules:
                _refuse_foreign(module)
            found: Any = import_module(module)
    except _Refused as error:
        raise ValueError(f"{error}; {_HOW}") from None
    except ModuleNotFoundError as error:
        raise ValueError(f"Python finds no module {error.name}, which it imports") from None
    except (Exception, SystemExit) as error:
        raise ValueError(f"the module cannot be imported: {said(error)}") from None
    for part in name.split("."):
        found = getattr(found, part, None)
    if found is None:
        raise ValueError(f"the module {module} has no {name}")
    return found


class _Refused(Exception):
    """Why a module is not imported."""


def _refuse_foreign(module: str) -> None:
    """Refuse a module by its path and the places of its files; nothing is imported."""
    parts, places = module.split("."), None
    for k, part in enumerate(parts, start=1):
        name = ".".join(parts[:k])
        if part in _BESIDE or part.startswith("__"):
            raise _Refused(f"{part} is a name of programs and tests, which hold no laws; move the law elsewhere")
        if name in sys.modules:
            file, places = getattr(sys.modules[name], "__file__", None), getattr(sys.modules[name], "__path__", None)
        else:
            spec = _found(name, places)
            if spec is None or (k > 1 and places is None):
                raise _Refused(f"Python finds no module {name} in installed packages and folders of yours")
            file, places = spec.origin if spec.has_location else None, spec.submodule_search_locations
        if file is None:
            raise _Refused(f"{name} is a folder without __init__.py")
        _refuse_beside(Path(file))


def _found(name: str, places: Any) -> Any:
    """Return where a module lies in a package's folders, without an import; None where it does not."""
    try:
        return next((spec for finder in sys.meta_path if (spec := finder.find_spec(name, places))), None)
    except KeyError:  # Python's own search wants the package of a folder without __init__.py to be imported
        raise _Refused(f"{name} is a folder without __init__.py") from None


def _refuse_beside(file: Path) -> None:
    """Refuse a file below the folder of a scene or a package around it, but for what is named there or installed."""
    installed = [*site.getsitepackages(), site.getusersitepackages()]
    chosen = {Path(each).resolve() for each in (*entries(LAWS), *installed)}
    for path in (file.absolute(), file.resolve()):
        for scene in _SCENES:
            around = path.stem == "__init__" and scene.is_relative_to(path.parent)
            if not (around or path.is_relative_to(scene)):
                continue
            mine = [each for each in chosen if path.resolve().is_relative_to(each)]
            if not any(around or each.is_relative_to(scene.resolve()) for each in mine):
                raise _Refused(f"{path} lies in the folder of a scene{' or around it' * around}")


@contextmanager
def _search_path() -> Iterator[None]:
    """Leave the folders of checkout, shell and script out of Python's path in the block, unless the user names them."""
    before, script = sys.path, getattr(sys.modules.get("__main__"), "__file__", None)
    named = {os.path.realpath(each) for each in entries("PYTHONPATH")} - _CHECKOUT
    given = {os.path.realpath(os.curdir), *([os.path.dirname(os.path.realpath(script))] if script else [])} - named
    kept = [each for each in before if os.path.realpath(each) not in given | _CHECKOUT]
    sys.path = [*kept, *entries(LAWS)]
    try:
        yield
    finally:
        sys.path = [*before, *(each for each in entries(LAWS) if each not in before)]


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
