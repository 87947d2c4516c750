"""What the stability map runs: single runs as plain data, pairs of parameters, named failures, and their references."""

import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty

Status = Literal["converged", "continuation", "failed"]
REFERENCE_SIZE = 2.5e-6  # m, contact size of the run with which others are compared


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
    contact_size: float = 10e-6
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


_NAMED = Path(__file__).parent / "named.toml"
MOST = 400  # solves of the whole map, references included
DEFAULT = Case()


@dataclass(frozen=True)
class Axis:
    """Values of one field of :class:`Case`; ``unit`` is the SI value of the unit in which the label counts."""

    field: str
    label: str
    values: tuple[float, ...]
    unit: float = 1.0

    def thin(self) -> "Axis":
        """Return every other value and the default, for formulations that are not the default one."""
        kept = [v for k, v in enumerate(self.values) if k % 2 == 0 or v == getattr(DEFAULT, self.field)]
        return replace(self, values=tuple(kept))


@dataclass(frozen=True)
class Panel:
    """One map: all pairs of values of two axes around a base."""

    title: str
    base: Case
    x: Axis
    y: Axis

    def case(self, x: float, y: float) -> Case:
        """Return the case at a pair of values."""
        values: dict[str, Any] = {self.x.field: x, self.y.field: y}
        return replace(self.base, **values)

    def cases(self) -> Iterator[Case]:
        """Return all cases, y by y."""
        return (self.case(x, y) for y in self.y.values for x in self.x.values)


@dataclass(frozen=True)
class Named:
    """Runs by name, and whether it takes references to show what they are for."""

    cases: Mapping[str, Case]
    referenced: bool = False


VOLTAGE = Axis("voltage", "voltage (V)", (0.0, 50.0, 100.0, 150.0, 200.0, 300.0, 400.0))
FEW_VOLTAGES = Axis("voltage", "voltage (V)", (0.0, 100.0, 200.0, 300.0, 400.0))
FORCE = Axis("force", "force per ridge (N/m)", (0.5, 1.5, 4.4, 12.0, 30.0))
SIZE = Axis("contact_size", "contact size (µm)", (5e-6, 10e-6, 20e-6, 40e-6), 1e-6)
STEP = Axis("step_scale", "step size / default", (0.25, 0.5, 1.0, 2.0, 4.0))
NU = Axis("nu", "Poisson's ratio", (0.3, 0.4, 0.48, 0.49, 0.499, 0.4999))
HIGH_NU = Axis("nu", "Poisson's ratio", (0.48, 0.499, 0.4999))
PAIRS = {
    "Voltage and force": (VOLTAGE, FORCE),
    "Contact size and voltage": (SIZE, FEW_VOLTAGES),
    "Step size and voltage": (STEP, FEW_VOLTAGES),
}
BY_PARAMETER, BY_ELEMENT = "Contact size and parameter of the contact", "Poisson's ratio and contact size"


def charts() -> dict[str, list[Panel]]:
    """Return the maps by what is varied; formulations add maps to all but the last, which compares elements."""
    found: dict[str, list[Panel]] = {title: [] for title in (*PAIRS, BY_PARAMETER)}
    for name, formulation in FORMULATIONS.items():
        base, main = replace(DEFAULT, formulation=name, parameter=formulation.default), name == DEFAULT.formulation
        for title, (x, y) in PAIRS.items() if formulation.everywhere else ():
            found[title].append(Panel(name, base, x, y) if main else Panel(name, base, x.thin(), y.thin()))
        axis = Axis("parameter", formulation.label, formulation.values)
        found[BY_PARAMETER].append(Panel(name, base, SIZE if main else SIZE.thin(), axis))
    ratios = {name: NU if name in ("P1", "P2") else HIGH_NU for name in ELEMENTS}
    return found | {BY_ELEMENT: [Panel(e, replace(DEFAULT, element=e), nu, SIZE) for e, nu in ratios.items()]}


def named() -> dict[str, Named]:
    """Return the default and its neighbours, and the known failures by name, with the runs that reproduce them."""
    return {
        title: Named(
            {words: replace(DEFAULT, **group.get("all", {}), **changes) for words, changes in group["runs"].items()},
            group.get("referenced", False),
        )
        for title, group in tomllib.loads(_NAMED.read_text(encoding="utf-8")).items()
    }


def cases() -> list[Case]:
    """Return all runs, each once: named ones first, then references; ValueError if they are more than MOST."""
    groups = [*named().values()]
    shown = [case for panels in charts().values() for panel in panels for case in panel.cases()]
    runs = [case for group in groups for case in group.cases.values()]
    compared = [case for group in groups[1:] if group.referenced for case in group.cases.values()] + shown
    unique = list(dict.fromkeys([*runs, *(case.reference for case in compared), *shown]))
    if len(unique) > MOST:
        raise ValueError(f"the map has {len(unique)} solves; at most {MOST}: make the axes shorter")
    return unique
