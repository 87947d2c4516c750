"""Where numbers come from: all that can change one of them and is not in the scene.

An option that PETSc refuses is found before a run, and one that it does not read before the first step is written.
"""

import contextlib
import ctypes
import json
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
from mpi4py import MPI
from petsc4py import PETSc

from fingerpad.launcher import source, version
from fingerpad.scene import SceneError
from variational import jit
from variational.element import ELEMENTS
from variational.solvers.iteration import DEFAULTS, PREFIX

# Threads and kernels of the linear algebra, MPI's and PETSc's settings, compilers of the forms, what is loaded.
_VARIABLES = re.compile(
    r"(BLIS|GOTO|MKL|OMP|OMPI_MCA|OPENBLAS|PETSC|UCX)_.*|CC|CFLAGS|CPPFLAGS|LDFLAGS|LD_PRELOAD|LD_LIBRARY_PATH"
)
_LIBRARIES = re.compile(r"lib(openblas|blas|cblas|lapack|mkl|blis|d?mumps|scotch|metis|parmetis|scalapack)[^/]*")


def provenance() -> dict[str, Any]:
    """Return versions, PETSc's options, compiler's options, the environment and the processor, ready for JSON."""
    libraries = _loaded()
    model = re.search(r"^model name\s*: (.*)$", _system("/proc/cpuinfo"), re.MULTILINE)
    mumps = (re.search(r"dmumps\D*(\d[\d.]*\d)", file.name) for file in libraries)
    return {
        "versions": _versions() | {"mumps": next((found[1] for found in mumps if found), None)},
        "libraries": [file.name for file in libraries],
        "blas": _openblas(libraries),
        "petsc_options": _in_use(),
        "jit_options": json.loads(json.dumps(dolfinx.jit.get_options(jit.OPTIONS), default=str)),
        "ffcx_options": json.loads(json.dumps(ffcx.options.get_options(), default=str)),
        "environment": {name: value for name, value in sorted(os.environ.items()) if _VARIABLES.fullmatch(name)},
        "processor": model[1] if model else platform.processor() or platform.machine(),
        "system": platform.platform(),
    }


def _versions() -> dict[str, str]:
    found = {"fingerpad": version(), "source": source(), "petsc": ".".join(map(str, PETSc.Sys.getVersion()))}
    found |= {each.__name__: each.__version__ for each in (dolfinx, basix, ffcx, ufl, gmsh, np, scipy)}
    return found | {"python": platform.python_version()}


def _loaded() -> list[Path]:
    """Return the files of the linear algebra's libraries in this process; none where there is no /proc."""
    files = {Path(line.split()[-1]) for line in _system("/proc/self/maps").splitlines() if "/" in line}
    return sorted({file.resolve() for file in files if _LIBRARIES.fullmatch(file.name)})


def _system(file: str) -> str:
    return Path(file).read_text() if Path(file).exists() else ""


def _openblas(libraries: list[Path]) -> str | None:
    """Return what OpenBLAS says of itself, the processor that its kernels are for included."""
    for file in libraries:
        with contextlib.suppress(OSError, AttributeError):
            say = ctypes.CDLL(str(file)).openblas_get_config
            say.restype = ctypes.c_char_p
            return str(say().decode())
    return None


class OptionError(SceneError):
    """An option that PETSc refuses or does not know; one sentence."""


def _in_use() -> dict[str, str]:
    """Return PETSc's options from all sources (command line, environment), the solver's defaults included."""
    given = PETSc.Options().getAll()
    return {f"-{name}": "" if value is None else str(value) for name, value in sorted(given.items())}


def check_options(comm: MPI.Comm = MPI.COMM_SELF, element: str = "P2") -> None:
    """Have PETSc set up its solver with the options, on two equations a rank; collective.

    The kind of the matrix depends on the element of the run, and no package factorises every kind.

    Raises:
        OptionError: PETSc refuses a value, or has no such package.
    """
    options, mixed = PETSc.Options(PREFIX), ELEMENTS[element].mixed
    for name, value in DEFAULTS.items():
        if not options.hasName(name):
            options.setValue(name, value)
    matrix = PETSc.Mat().create(comm)
    matrix.setSizes(((2, None), (2, None)), bsize=1 if mixed else 2)
    matrix.setType(PETSc.Mat.Type.AIJ if mixed else PETSc.Mat.Type.BAIJ)  # as variational.solvers.layout has it
    matrix.setUp()
    for row in range(*matrix.getOwnershipRange()):
        matrix.setValue(row, row, 1.0)
    matrix.assemble()
    try:
        snes = PETSc.SNES().create(comm)
        snes.setOptionsPrefix(PREFIX)
        snes.setFromOptions()
        snes.getKSP().setOperators(matrix)
        snes.getKSP().setUp()
    except PETSc.Error as error:
        raise OptionError(_refusal(error)) from None


def refuse_unread() -> None:
    """Refuse the solver's options that PETSc has not read; to be called when it has solved.

    Raises:
        OptionError: the first of them.
    """
    used = ctypes.CDLL(PETSc.__file__).PetscOptionsUsed  # which petsc4py does not offer
    for option, value in _in_use().items():
        name, was_read = option.removeprefix(f"-{PREFIX}"), ctypes.c_int(0)
        if name == option or name in DEFAULTS or used(None, option[1:].encode(), ctypes.byref(was_read)):
            continue
        if not was_read.value:
            given = f"{option} {value}".strip()[:100]
            raise OptionError(f"PETSc does not read the option {given}; its manual has the names for SNES, KSP and PC")


def _refusal(error: PETSc.Error) -> str:
    """Return the last line of PETSc's message, and the options whose values it names."""
    words = str(error).splitlines()[-1].split("] ", 1)[-1].strip()
    own = {o: v for o, v in _in_use().items() if o.startswith(f"-{PREFIX}")}
    options = {o: v for o, v in own.items() if DEFAULTS.get(o.removeprefix(f"-{PREFIX}")) != v}
    named = [o for o, v in options.items() if v and v.lower() in re.findall(r"[\w.-]+", words.lower())]
    given = ", ".join(f"{option} {options[option]}".strip() for option in named or options)
    return f"PETSc refuses {given[:150] or 'its options'}: {words[:120]}"
