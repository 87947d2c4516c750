"""What tests measure of a meshed body, on any number of ranks, and of a folder of results."""

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.mesh import entities_to_geometry

from fingerpad.results.dataset import OF_RIDGES, OF_SITES
from fingerpad.results.result import Result
from variational import compat
from variational.state import ContactState


def integral(body, tag, integrand=1.0, kind="dx") -> float:
    """Integrate over a layer, or with the kind "ds" over a group of facets, on all ranks."""
    data = body.cell_tags if kind == "dx" else body.facet_tags
    measure = ufl.Measure(kind, body.mesh, subdomain_data=data, metadata={"quadrature_degree": 7})  # the skin's
    form = fem.form(fem.Constant(body.mesh, 1.0) * integrand * measure(tag))
    return body.mesh.comm.allreduce(fem.assemble_scalar(form))


def vertices(body, facets):
    """Return the vertices of facets, each once; shape (n, 2)."""
    body.mesh.topology.create_connectivity(1, 0)
    body.mesh.topology.create_connectivity(0, 2)
    if not len(facets):  # on a rank that has none
        return np.empty((0, 2))
    links = body.mesh.topology.connectivity(1, 0)
    points = np.unique(np.concatenate([links.links(f) for f in facets]))
    return body.mesh.geometry.x[entities_to_geometry(body.mesh, 0, points.astype(np.int32)).ravel(), :2]


def straightened(body):
    """Return a body whose edges have been made straight in place, as those of a mesh of first order."""
    cells, x = compat.cell_geometry(body.mesh), body.mesh.geometry.x
    for k, (a, b) in enumerate(((1, 2), (0, 2), (0, 1))):
        x[cells[:, 3 + k]] = (x[cells[:, a]] + x[cells[:, b]]) / 2
    return body


def contact_state(**values) -> ContactState:
    """Return a state in contact; what is not given does not matter, or is that of a press by 1 N/m."""
    given = {"f_ext": 1.0, "voltage": 0.0, "f_t": 0.0, "mu_app": 0.0, "f_contact": 1.0, "f_electrostatic": 0.0}
    return ContactState(**given | {"ridges_in_contact": 3, "contact_length": 1e-3} | values)


def rows_of(folder: Path, name: str = "steps") -> list[dict[str, str]]:
    """Return the rows of a table of a run; of ``ridges``, ``receptors`` and ``coupling`` those of its steps."""
    if name in ("ridges", "receptors", "coupling"):
        return [
            {"step": str(state.step)} | {key: str(value) for key, value in row.items()}
            for state in Result.load(folder).steps
            for row in _rows(state, name)
        ]
    with (folder / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def tables(folder: Path) -> dict[str, list[dict[str, str]]]:
    """Return all tables of a run as text, without the time that steps took."""
    rows = {name: rows_of(folder, name) for name in ("steps", "ridges", "coupling")}
    return {name: [{k: v for k, v in row.items() if "seconds" not in k} for row in of] for name, of in rows.items()}


def _rows(state: ContactState, name: str) -> Iterator[dict[str, Any]]:
    if name == "coupling":
        yield from ({"iteration": k, "change": change} for k, change in enumerate(state.changes, start=1))
    elif (group := getattr(state, {"ridges": "ridges", "receptors": "sites"}[name])) is not None:
        names = OF_RIDGES if name == "ridges" else OF_SITES
        for k, number in enumerate(group.number):
            if name == "receptors" or group.length[k] > 0:
                yield {"ridge": number} | {key: getattr(group, each)[k] for key, each in names.items()}


def accepted(folder: Path) -> list[dict[str, str]]:
    """Return the accepted steps that are on disk, each complete."""
    if not (folder / "steps.csv").exists():
        return []
    rows = rows_of(folder)
    assert all(None not in row and None not in row.values() for row in rows)
    return rows
