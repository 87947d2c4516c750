"""What is installed: this package's version; libraries and the compiler of forms, whose absence is one sentence."""

import functools
import hashlib
import os
import shlex
import shutil
import sysconfig
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

COMPILER = "C compiler"
_PACKAGES = ("geometry", "variational", "fingerpad")
OPTIONAL = ("dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "gmsh", "matplotlib", COMPILER)


@functools.cache
def version() -> str:
    """Return the version: that of the folder of sources, or of the package that is installed."""
    project = Path(__file__).parents[1] / "pyproject.toml"
    if project.is_file():
        return str(tomllib.loads(project.read_text(encoding="utf-8"))["project"]["version"])
    from importlib import metadata  # which imports mail's parser

    return metadata.version("fingerpad")


@functools.cache
def source() -> str:
    """Return a hash of the program's own files, which tells two states of one version apart."""
    root, found = Path(__file__).resolve().parents[1], hashlib.sha256()
    for file in sorted(file for package in _PACKAGES for file in (root / package).rglob("*.py")):
        found.update(str(file.relative_to(root)).encode() + file.read_bytes())
    return found.hexdigest()[:12]


@contextmanager
def needed_by(what: str) -> Iterator[None]:
    """Name the library that is missing, and how to install it.

    Raises:
        ImportError: a library of :data:`OPTIONAL` is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing not in OPTIONAL:
            raise
        raise ImportError(
            f"{what} needs {missing}, which is not installed; finite elements come by conda env create -f "
            "environment.yml, by pip install '.[pip]' (Python 3.12 or newer, Linux on x86_64), or with environment/run",
            name=missing,
        ) from error


def need_compiler() -> None:
    """Refuse to begin where the forms of finite elements cannot be compiled.

    Raises:
        ImportError: there is no C compiler, or no headers of Python; its name is :data:`COMPILER`.
    """
    words = shlex.split(os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc")
    headers = Path(sysconfig.get_path("include"))
    if shutil.which(words[0]) is None:
        missing, package = f"a C compiler, and {words[0]} is not on the path", "gcc"
    elif not (headers / "Python.h").is_file():
        missing, package = f"Python's headers, and {headers / 'Python.h'} is not there", "python3-dev"
    else:
        return
    raise ImportError(
        f"finite elements are compiled for each form, which needs {missing}; Debian and Ubuntu have it in {package}",
        name=COMPILER,
    )
