"""Where numbers come from: all that can change one of them and is not in the scene."""

import contextlib
import ctypes
import os
import platform
import re
from pathlib import Path
from typing import Any

import basix
import dolfinx
import ffcx
import ffcx.options
import gmsh
import numpy as np
import scipy
import ufl
from petsc4py import PETSc

from fingerpad.installed import source, version
from fingerpad.results.petsc_options import in_use
from variational import jit

# Threads and kernels of the linear algebra, MPI's and PETSc's settings, compilers of the forms, what is loaded.
_VARIABLES = re.compile(
    r"(BLIS|GOTO|MKL|OMP|OMPI_MCA|OPENBLAS|PETSC|UCX)_.*|CC|CFLAGS|CPPFLAGS|LDFLAGS|LD_PRELOAD|LD_LIBRARY_PATH"
)
_LIBRARIES = re.compile(r"lib(openblas|blas|cblas|lapack|mkl|blis|d?mumps|scotch|metis|parmetis|scalapack)[^/]*")


def provenance() -> dict[str, Any]:
    """Return versions, PETSc's options, compiler's options, the environment and the processor, ready for JSON."""
    libraries = _loaded()
    return {
        "versions": _versions() | {"mumps": _mumps(libraries)},
        "libraries": sorted(file.name for file in libraries),
        "blas": _openblas(libraries),
        "petsc_options": in_use(),
        "jit_options": {name: _plain(value) for name, value in jit.options().items()},
        "ffcx_options": {name: _plain(value) for name, value in ffcx.options.get_options().items()},
        "environment": {name: value for name, value in sorted(os.environ.items()) if _VARIABLES.fullmatch(name)},
        "processor": _processor(),
        "system": platform.platform(),
    }


def _versions() -> dict[str, str]:
    return {
        "fingerpad": version(),
        "source": source(),
        "dolfinx": dolfinx.__version__,
        "basix": basix.__version__,
        "ffcx": ffcx.__version__,
        "ufl": ufl.__version__,
        "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        "gmsh": gmsh.__version__,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "python": platform.python_version(),
    }


def _loaded() -> set[Path]:
    """Return the files of the linear algebra's libraries in this process; none where there is no /proc."""
    with contextlib.suppress(OSError):
        files = {Path(line.split()[-1]) for line in Path("/proc/self/maps").read_text().splitlines() if "/" in line}
        return {file.resolve() for file in files if _LIBRARIES.fullmatch(file.name)}
    return set()


def _mumps(libraries: set[Path]) -> str | None:
    """Return the version that MUMPS' file is named for."""
    names = (re.search(r"dmumps\D*(\d[\d.]*\d)", file.name) for file in libraries)
    return next((found[1] for found in names if found), None)


def _openblas(libraries: set[Path]) -> str | None:
    """Return what OpenBLAS says of itself, the processor that its kernels are for included."""
    for file in sorted(libraries):
        with contextlib.suppress(OSError, AttributeError):
            say = ctypes.CDLL(str(file)).openblas_get_config
            say.restype = ctypes.c_char_p
            return str(say().decode())
    return None


def _processor() -> str:
    with contextlib.suppress(OSError):
        found = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
        if found:
            return found[1]
    return platform.processor() or platform.machine()


def _plain(value: Any) -> Any:
    return value if value is None or isinstance(value, bool | int | float | str | list) else str(value)
