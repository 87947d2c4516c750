"""Where numbers come from: all that can change one of them and is not in the scene; PETSc's options are checked before.

An option that PETSc refuses, or never reads, is found before and not after a run.
"""

import contextlib
import ctypes
import difflib
import io
import os
import platform
import re
import tempfile
from collections.abc import Iterator
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

from fingerpad.installed import source, version
from fingerpad.scene import SceneError
from variational import jit
from variational.element import ELEMENTS
from variational.solvers.iteration import DEFAULTS, PREFIX

# Threads and kernels of the linear algebra, MPI's and PETSc's settings, compilers of the forms, what is loaded.
_VARIABLES = re.compile(
    r"(BLIS|GOTO|MKL|OMP|OMPI_MCA|OPENBLAS|PETSC|UCX)_.*|CC|CFLAGS|CPPFLAGS|LDFLAGS|LD_PRELOAD|LD_LIBRARY_PATH"
)
_LIBRARIES = re.compile(r"lib(openblas|blas|cblas|lapack|mkl|blis|d?mumps|scotch|metis|parmetis|scalapack)[^/]*")
_DIRECT = ("lu", "cholesky")
_KNOWN: set[str] = set()  # options that PETSc's own help has listed, which it does once a process


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


class OptionError(SceneError):
    """An option that PETSc refuses or does not know; one sentence."""


def in_use() -> dict[str, str]:
    """Return PETSc's options from all sources (command line, environment, home), the solver's defaults included."""
    given = PETSc.Options().getAll()
    return {f"-{name}": "" if value is None else str(value) for name, value in sorted(given.items())}


def check_options(comm: MPI.Comm = MPI.COMM_SELF, element: str = "P2") -> None:
    """Try the options out on two equations a rank; collective.

    Args:
        comm: communicator of the run.
        element: of the run, on which the kind of its matrix depends; no package factorises every kind.

    Raises:
        OptionError: PETSc refuses a value, has no such package, or does not read an option.
    """
    options, all_options = PETSc.Options(PREFIX), PETSc.Options()
    for name, value in DEFAULTS.items():
        if not options.hasName(name):
            options.setValue(name, value)
    all_options.setValue("help", "")
    try:
        with _silent():
            for each in (MPI.COMM_SELF, comm)[: comm.size]:  # the first one's help is printed, on every rank
                snes = PETSc.SNES().create(each)
                _solve(snes, blocks=not ELEMENTS[element].mixed)
    except PETSc.Error as error:
        raise OptionError(_refusal(error)) from None
    finally:
        all_options.delValue("help")
    if snes.getKSP().getPC().getType() in _DIRECT:  # others may have options for what two equations do not have
        refuse_unread()


def _solve(snes: PETSc.SNES, blocks: bool) -> None:
    matrix = PETSc.Mat().create(snes.comm)
    matrix.setSizes(((2, None), (2, None)), bsize=2 if blocks else 1)
    matrix.setType(PETSc.Mat.Type.BAIJ if blocks else PETSc.Mat.Type.AIJ)  # as variational.solvers.layout has it
    matrix.setUp()

    def residual(snes: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        f.array_w[:] = x.array_r - 1.0

    def jacobian(snes: PETSc.SNES, x: PETSc.Vec, A: PETSc.Mat, P: PETSc.Mat) -> None:
        for row in range(*P.getOwnershipRange()):
            P.setValue(row, row, 1.0)
        P.assemble()

    x = matrix.createVecRight()
    snes.setOptionsPrefix(PREFIX)
    snes.setFunction(residual, x.duplicate())
    snes.setJacobian(jacobian, matrix)
    snes.setFromOptions()
    snes.solve(None, x)


def refuse_unread() -> None:
    """Refuse the solver's options that PETSc has not read; to be called when it has solved.

    Raises:
        OptionError: the first of them and the nearest one of PETSc's own help.
    """
    used = ctypes.CDLL(PETSc.__file__).PetscOptionsUsed  # which petsc4py does not offer
    for option, value in in_use().items():
        name = option.removeprefix(f"-{PREFIX}")
        was_read = ctypes.c_int(0)
        if name == option or name in DEFAULTS or used(None, option[1:].encode(), ctypes.byref(was_read)):
            continue
        if not was_read.value:
            near = difflib.get_close_matches(option, sorted(_KNOWN), 1, 0.0)
            given = f"{option} {value}".strip()[:100]
            raise OptionError(f"PETSc does not read the option {given}; the nearest known one is {near[0]}")


def _refusal(error: PETSc.Error) -> str:
    """Return what PETSc says last, and of which option as far as its words tell."""
    said = str(error).splitlines()[-1].split("] ", 1)[-1]
    options = {option: value for option, value in in_use().items() if option.startswith(f"-{PREFIX}")}
    words = re.findall(r"[\w.-]+", said.lower())
    blamed = [o for o, v in options.items() if v and v.lower() in words] or list(options)
    named = [f"{o} {options[o]}".strip() for o in blamed if DEFAULTS.get(o.removeprefix(f"-{PREFIX}")) != options[o]]
    return f"PETSc refuses {', '.join(named)[:150] or 'its options'}: {said.strip()[:120]}"


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Keep what PETSc prints from the terminal, and what its help lists."""
    flush, text = ctypes.CDLL(None).fflush, io.StringIO()
    flush(None)
    kept = os.dup(1)
    with tempfile.TemporaryFile() as file:
        try:
            os.dup2(file.fileno(), 1)
            with contextlib.redirect_stdout(text):  # which petsc4py prints to if somebody else has done so
                yield
        finally:
            flush(None)
            os.dup2(kept, 1)
            os.close(kept)
            file.seek(0)
            text.write(file.read().decode(errors="replace"))
            _KNOWN.update(re.findall(rf"-{PREFIX}\w+", text.getvalue()))
