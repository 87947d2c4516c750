"""The numbers that a state of equilibrium depends on, and how a problem is given others where it stands."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from variational.contact.interface import Interface
from variational.materials.material import Material
from variational.roughness.closure import Closure
from variational.solvers.coupling import Coupling
from variational.solvers.target import Control

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Numbers:
    """All that a state of equilibrium depends on; the voltage in V."""

    solids: Mapping[int, Material]
    """Material of each layer's tag."""
    interface: Interface
    closure: Closure | None
    control: Control
    voltage: float
    places: Array
    """Of the mesh's nodes on this rank (m), shape (nodes, 3)."""


def impose(coupling: Coupling, numbers: Numbers) -> None:
    """Give a problem other numbers, at the unknowns and air gaps that it has; collective.

    Raises:
        ValueError: a law is of another kind than before.
    """
    problem = coupling.solver.problem
    if any(problem.mesh.comm.allgather(not np.array_equal(problem.mesh.geometry.x, numbers.places))):
        problem.mesh.geometry.x[:] = numbers.places
        problem.surface.follow()
    problem.set_interface(numbers.interface)
    problem.set_solids({tag: numbers.solids[tag] for tags in problem.laws for tag in tags})
    problem.voltage.value, coupling.solver.control = numbers.voltage, replace(numbers.control)
    coupling.closure = numbers.closure
    coupling.set_air_gaps(coupling.d_eq)
