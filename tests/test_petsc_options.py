"""Options of PETSc that it refuses or does not know end a run before it starts, with one sentence."""

import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fingerpad.results import provenance as module
from fingerpad.results.provenance import OptionError, check_options


@pytest.fixture
def given():
    """Return a function that gives options as a command line does; they are gone afterwards."""
    check_options()
    options, before = PETSc.Options(), PETSc.Options().getAll()

    def give(text: str) -> None:
        options.insertString(text)

    yield give
    for name in options.getAll():
        options.delValue(name)
    for name, value in before.items():
        options.setValue(name, value)


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("-fingerpad_snes_max_it abc", "-fingerpad_snes_max_it abc"),
        ("-fingerpad_snes_type nonsense", "-fingerpad_snes_type nonsense"),
        ("-fingerpad_pc_factor_mat_solver_type superlu_dist", "-fingerpad_pc_factor_mat_solver_type superlu_dist"),
    ],
)
def test_values_that_petsc_refuses(given, text, named):
    given(text)
    with pytest.raises(OptionError) as refusal:
        check_options(MPI.COMM_WORLD)
    assert str(refusal.value).startswith(f"PETSc refuses {named}: ")
    assert len(str(refusal.value)) < 300 and "\n" not in str(refusal.value)


@pytest.mark.mpi
@pytest.mark.parametrize("option", ["-fingerpad_snes_max_itt 5", "-fingerpad_mg_levels_9_ksp_typo cg"])
def test_misspelt(given, option):
    """Judged when all is solved: a multigrid of two equations may have no coarser level."""
    given(option)
    check_options(element="P2-P1")
    with pytest.raises(OptionError, match=f"PETSc does not read the option {option}"):
        module.refuse_unread()
