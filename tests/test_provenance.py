"""The summary holds what can change a number."""

import importlib.util
import json
import re

from petsc4py import PETSc

from fingerpad.results.provenance import provenance

PETSC_ALONE = importlib.util.find_spec("dolfinx_solver") is not None


def test_versions():
    versions = provenance()["versions"]
    names = "fingerpad source dolfinx basix ffcx ufl petsc mumps gmsh numpy scipy python"
    assert set(versions) == set(names.split())
    linked = PETSC_ALONE and versions.pop("mumps") is None  # into PETSc's own file, which names no version of it
    assert linked == PETSC_ALONE
    assert all(re.match(r"\d+\.\d+", version) for name, version in versions.items() if name != "source")


def test_nothing_else_of_the_environment(monkeypatch):
    monkeypatch.setenv("MY_TOKEN", "secret")
    assert "secret" not in json.dumps(provenance())


def test_options():
    """The solver's, and those that PETSc does not read."""
    PETSC, name = PETSc.Options(), "fingerpad_ksp_rtol"
    PETSC.setValue(name, "1e-3")
    try:
        assert provenance()["petsc_options"][f"-{name}"] == "1e-3"
    finally:
        PETSC.delValue(name)
