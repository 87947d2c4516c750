"""PETSc's options: those that it refuses, and those that it never reads, found before and not after a run."""

import contextlib
import ctypes
import difflib
import io
import os
import re
import tempfile
from collections.abc import Iterator

from mpi4py import MPI
from petsc4py import PETSc

from fingerpad.scene import SceneError
from variational.element import ELEMENTS
from variational.solvers.iteration import DEFAULTS, PREFIX

_DIRECT = ("lu", "cholesky")
# What an option that PETSc did not read may have been meant for; any other that PETSc reads is allowed as well.
_KNOWN = sorted(
    {
        *DEFAULTS,
        *("ksp_atol", "ksp_converged_reason", "ksp_max_it", "ksp_monitor", "ksp_rtol", "ksp_view"),
        *("pc_factor_levels", "pc_factor_mat_ordering_type", "pc_factor_shift_type", "pc_view"),
        *("snes_atol", "snes_converged_reason", "snes_divergence_tolerance", "snes_linesearch_damping"),
        *("snes_linesearch_max_it", "snes_linesearch_monitor", "snes_linesearch_order", "snes_max_funcs"),
        *("snes_monitor", "snes_view"),
        *(f"mat_mumps_icntl_{number}" for number in range(1, 59)),
        *(f"mat_mumps_cntl_{number}" for number in range(1, 8)),
    }
)


class OptionError(SceneError):
    """An option that PETSc refuses or does not know; one sentence."""


def in_use() -> dict[str, str]:
    """Return PETSc's options from all sources (command line, environment, home), the solver's defaults included."""
    given = PETSc.Options().getAll()
    return {f"-{name}": "" if value is None else str(value) for name, value in sorted(given.items())}


def check(comm: MPI.Comm = MPI.COMM_SELF, element: str = "P2") -> None:
    """Try the options out on two equations a rank; collective.

    Args:
        comm: communicator of the run.
        element: of the run, on which the kind of its matrix depends; no package factorises every kind.

    Raises:
        OptionError: PETSc refuses a value, has no such package, or does not read an option.
    """
    options = PETSc.Options(PREFIX)
    for name, value in DEFAULTS.items():
        if not options.hasName(name):
            options.setValue(name, value)
    snes = PETSc.SNES().create(comm)
    try:
        with _silent():
            _solve(snes, blocks=not ELEMENTS[element].mixed)
    except PETSc.Error as error:
        raise OptionError(_refusal(error)) from None
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
        OptionError: the first of them and the nearest known one.
    """
    used = ctypes.CDLL(PETSc.__file__).PetscOptionsUsed  # which petsc4py does not offer
    for option, value in in_use().items():
        name = option.removeprefix(f"-{PREFIX}")
        was_read = ctypes.c_int(0)
        if name == option or name in DEFAULTS or used(None, option[1:].encode(), ctypes.byref(was_read)):
            continue
        if not was_read.value:
            near = difflib.get_close_matches(name, _KNOWN, 1, 0.0)[0]
            given = f"{option} {value}".strip()[:100]
            raise OptionError(f"PETSc does not read the option {given}; the nearest known one is -{PREFIX}{near}")


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
    """Keep what PETSc's monitors print from the terminal."""
    flush = ctypes.CDLL(None).fflush
    flush(None)
    kept = os.dup(1)
    try:
        with tempfile.TemporaryFile() as nowhere:
            os.dup2(nowhere.fileno(), 1)
            with contextlib.redirect_stdout(io.StringIO()):  # which petsc4py prints to if somebody else has done so
                yield
            flush(None)
    finally:
        os.dup2(kept, 1)
        os.close(kept)
