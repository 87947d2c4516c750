"""The process of the program: its rank under a launcher of MPI, Ctrl-C before and after runs, and what is installed.

All of it is known before MPI has started, and without it. Libraries that are being imported lose a KeyboardInterrupt,
or turn it into another error; Python prints a traceback of one that comes before the program's first line or at its
end. So programs end at once at SIGINT while nothing has to be cleaned up. SIGINT that the caller has ignored stays
ignored.
"""

import functools
import hashlib
import os
import shlex
import shutil
import signal
import sysconfig
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

RANKS = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "MV2_COMM_WORLD_RANK", "SLURM_PROCID")
"""Variables of the environment in which launchers give the rank of a process."""
_SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE")
COMPILER = "C compiler"
_PACKAGES = ("geometry", "variational", "fingerpad")
OPTIONAL = ("dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "gmsh", "matplotlib", COMPILER)


# -- ranks ---------------------------------------------------------------------------------------------
def rank() -> int:
    """Return the rank of this process under a launcher of MPI, 0 without one."""
    return _number(RANKS) or 0


def ranks() -> int:
    """Return the number of processes that a launcher of MPI has started, 1 without one."""
    return _number(_SIZES) or 1


def launched() -> bool:
    """Return whether a launcher of MPI has started this process."""
    return _number(RANKS) is not None


def _number(variables: tuple[str, ...]) -> int | None:
    given = (os.environ.get(name, "") for name in variables)
    return next((int(text) for text in given if text.isdecimal()), None)


# -- Ctrl-C --------------------------------------------------------------------------------------------
def end_at_ctrl_c() -> None:
    """End the process with exit code 130 at SIGINT, in place of raising KeyboardInterrupt; for programs alone."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


@contextmanager
def raising_at_ctrl_c() -> Iterator[None]:
    """Let Ctrl-C raise KeyboardInterrupt inside the block, so that the block can clean up."""
    before = signal.getsignal(signal.SIGINT)
    try:
        if before is _end:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        yield
    finally:
        if before is _end:
            signal.signal(signal.SIGINT, _end)


def _end(number: int, frame: FrameType | None) -> None:
    os._exit(128 + number)


# -- what is installed ---------------------------------------------------------------------------------
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
    compiler = shlex.split(os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc")[0]
    header = Path(sysconfig.get_path("include"), "Python.h")
    if shutil.which(compiler) and header.is_file():
        return
    missing, package = f"Python's headers, and {header} is not there", "python3-dev"
    if shutil.which(compiler) is None:
        missing, package = f"a C compiler, and {compiler} is not on the path", "gcc"
    raise ImportError(
        f"finite elements are compiled for each form, which needs {missing}; Debian and Ubuntu have it in {package}",
        name=COMPILER,
    )
