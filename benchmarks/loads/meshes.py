"""What the coarse meshes change in attraction and contact length, and states without it.

Beside full runs of docs/models.json the attraction on these meshes is too large and the contact too short, the more so
the smaller the contact force is: facets are then long beside the contact of a ridge. The relative errors are
interpolated over the logarithm of the contact force between the loads that were checked, and held beyond them. A
state's attraction and length are divided by 1 plus them.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from benchmarks.loads.scenes import MESHES, Data, checked, mesh_of
from benchmarks.models import name


class Checked(NamedTuple):
    """A load on one of the meshes beside the full run."""

    f_ext: float
    """N/m."""
    voltage: float
    f_contact: float
    """N/m, on the coarse mesh."""
    attraction: float
    """Relative error."""
    friction: float
    """Relative error of µ_app."""
    length: float
    """Relative error of the contact length."""


def errors(states: Iterable[Data], full: Mapping[str, Any]) -> list[list[Checked]]:
    """Return the errors of each mesh, by growing contact force.

    Args:
        states: of the checked loads, in the order of :func:`benchmarks.loads.scenes.checked` and of the meshes.
        full: the scenes of docs/models.json.
    """
    found, each = [], iter(states)
    for which in range(len(MESHES)):
        of_mesh = []
        for f_ext, voltage in checked(which):
            run, state = full[name(f_ext, voltage)]["full"]["summary"], next(each)
            keys = ("f_electrostatic", "mu_app", "contact_length")
            parts = (state[key] / run[f"full_slip_{key}"] - 1 for key in keys)
            of_mesh.append(Checked(f_ext, voltage, f_ext + state["f_electrostatic"], *parts))
        found.append(sorted(of_mesh, key=lambda one: one.f_contact))
    return found


def error(of_mesh: Sequence[Checked], f_contact: float, of: str = "attraction") -> float:
    """Return the relative error of the attraction, or of the ``length``, at a contact force (N/m)."""
    known, values = zip(*((each.f_contact, getattr(each, of)) for each in of_mesh), strict=True)
    return float(np.interp(np.log(f_contact), np.log(known), values))


def without(kept: Iterable[Data], known: Sequence[Sequence[Checked]]) -> list[Data]:
    """Return kept scenes whose states have attraction, f_T, µ_app and length without the error of their mesh."""
    return [
        each | {"states": [_without(state, known[mesh_of(each["values"])]) for state in each["states"]]}
        for each in kept
    ]


def _without(state: Data, of_mesh: Sequence[Checked]) -> Data:
    if not state.get("f_electrostatic"):
        return state
    f_ext, f_el = state["f_ext"], state["f_electrostatic"]
    better = f_el / (1 + error(of_mesh, f_ext + f_el))
    factor = (f_ext + better) / (f_ext + f_el)
    length = state["contact_length"] / (1 + error(of_mesh, f_ext + f_el, "length"))
    found = {"f_electrostatic": better, "contact_length": length}
    return state | found | {key: factor * state[key] for key in ("f_t", "mu_app")}
