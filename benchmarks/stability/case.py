"""One run of the stability map as plain data."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Literal

from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty

Status = Literal["converged", "continuation", "failed"]
REFERENCE_SIZE = 1.25e-6  # m, contact size of the run with which others are compared


@dataclass(frozen=True)
class Treatment:
    """A formulation of the contact, with its one numerical parameter: five decades of it are on the map."""

    label: str
    default: float
    values: tuple[float, ...]
    law: Callable[[float], Formulation]
    everywhere: bool = True  # on every chart, not on that of its parameter alone


_EPS_N = (1.5e10, 1.5e11, 1.5e12, 1.5e13, 1.5e14, 1.5e15)
_GAMMA_0 = (0.1, 1.0, 10.0, 100.0, 1e3, 1e4)
_STIFFNESS, _OVER_SKIN = r"$\epsilon_n$ (Pa/m)", r"$\gamma_0$ (–)"
# One line to add a formulation: all maps and tables follow.
FORMULATIONS = {
    "penalty": Treatment(_STIFFNESS, 1.5e12, _EPS_N, lambda eps_n: Penalty(eps_n, 5e10)),
    "augmented": Treatment(_STIFFNESS, 1.5e13, _EPS_N, lambda eps_n: AugmentedLagrangian(eps_n, eps_n / 30, 5e-9)),
    "Nitsche, θ = 0": Treatment(_OVER_SKIN, 10.0, _GAMMA_0, lambda gamma_0: Nitsche(gamma_0, 0)),
    "Nitsche, θ = 1": Treatment(_OVER_SKIN, 100.0, _GAMMA_0, lambda gamma_0: Nitsche(gamma_0, 1), everywhere=False),
    "Nitsche, θ = -1": Treatment(_OVER_SKIN, 10.0, _GAMMA_0, lambda gamma_0: Nitsche(gamma_0, -1), everywhere=False),
}
ELEMENTS = ("P1", "P2", "P2 reduced", "P2-P1")
"""Names in :mod:`variational.element`."""


@dataclass(frozen=True)
class Case:
    """A strip pressed, charged and dragged to full slip; SI units, forces per ridge and out-of-plane length."""

    formulation: str = "penalty"
    parameter: float = 1.5e12
    element: str = "P2"
    contact_size: float = 5e-6
    force: float = 4.4  # the finger's 75 N/m over its 17 ridges in contact
    indentation: float = 0.0  # if not zero, the bone is lowered by so much instead of being pressed by the force
    voltage: float = 200.0
    detour: float = 0.0  # if not zero, a voltage reached between the press and the final voltage
    nu: float = 0.48  # Poisson's ratio of all layers
    mu_f: float = 0.25
    step_scale: float = 1.0  # factor on the largest steps of force, voltage and sliding
    slide: float = 1e-3  # farthest the bone slides towards full slip; zero for no sliding
    ridges: int = 1
    height: float = 1.5e-3
    sides: Literal["carried", "free"] = "carried"  # lateral faces: moved sideways with the bone, free up and down
    pseudo_transient: bool = True  # whether pseudo-transient continuation is allowed

    @property
    def changed(self) -> dict[str, Any]:
        """Fields that are not the default's: the case as it is kept."""
        return {name: value for name, value in asdict(self).items() if value != getattr(Case(), name)}

    @property
    def reference(self) -> "Case":
        """The run on the finest mesh with the same physical parameters and default numerical ones."""
        numerical = ("formulation", "parameter", "element", "step_scale", "pseudo_transient", "detour")
        return replace(self, contact_size=REFERENCE_SIZE, **{name: getattr(Case(), name) for name in numerical})


@dataclass
class Outcome:
    """What became of a case; lengths in m, forces per out-of-plane length in N/m, of the last accepted state."""

    status: Status  # reached by Newton's method, with the help of pseudo-transient continuation, or not at all
    reason: str = ""  # name of the failure, for example that of SNES
    message: str = ""
    load: str = ""  # in which the run ended
    full_slip: bool = False
    seconds: float = 0.0
    steps: int = 0
    newton: int = 0
    factorisations: int = 0
    cutbacks: int = 0
    jumps: int = 0  # solves that needed pseudo-transient continuation
    # Failed solves in which steps led to J <= 0, by the layer with the least J in the end.
    inverted: dict[str, int] = field(default_factory=dict)
    penetration: float = 0.0
    f_ext: float = 0.0
    f_t: float = 0.0
    contact_length: float = 0.0
