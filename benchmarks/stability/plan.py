"""What the stability map runs: pairs of parameters around the default, named failures, and their references."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from benchmarks.stability.case import ELEMENTS, FORMULATIONS, Case

MOST = 400
"""Solves of the whole map, references included."""
DEFAULT = Case()


@dataclass(frozen=True)
class Axis:
    """Values of one field of :class:`Case`."""

    field: str
    label: str
    values: tuple[float, ...]
    unit: float = 1.0
    """SI value of the unit in which the label counts."""

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
class Chart:
    """A picture: one row of small multiples for each panel."""

    name: str
    title: str
    panels: tuple[Panel, ...]


@dataclass(frozen=True)
class Named:
    """A known failure and the runs that show it, each with the words that tell it from the others."""

    name: str
    says: str
    """What the runs show."""
    cases: tuple[tuple[str, Case], ...]
    referenced: bool = False
    """Whether it takes references to show it."""


VOLTAGE = Axis("voltage", "voltage (V)", (0.0, 50.0, 100.0, 150.0, 200.0, 300.0, 400.0))
FEW_VOLTAGES = Axis("voltage", "voltage (V)", (0.0, 100.0, 200.0, 300.0, 400.0))
FORCE = Axis("force", "force per ridge (N/m)", (0.5, 1.5, 4.4, 12.0, 30.0))
SIZE = Axis("contact_size", "contact size (µm)", (3e-6, 5e-6, 10e-6, 20e-6, 40e-6), 1e-6)
FEW_SIZES = Axis("contact_size", "contact size (µm)", (5e-6, 10e-6, 20e-6, 40e-6), 1e-6)
STEP = Axis("step_scale", "step size / default", (0.25, 0.5, 1.0, 2.0, 4.0))
NU = Axis("nu", "Poisson's ratio", (0.3, 0.4, 0.48, 0.49, 0.499, 0.4999))
HIGH_NU = Axis("nu", "Poisson's ratio", (0.48, 0.499, 0.4999))


def charts() -> list[Chart]:
    """Return the pictures; formulations add rows to all but the last, which compares elements."""
    pairs = [
        ("voltage_force", "Voltage and force", VOLTAGE, FORCE),
        ("size_voltage", "Contact size and voltage", SIZE, FEW_VOLTAGES),
        ("step_voltage", "Step size and voltage", STEP, FEW_VOLTAGES),
    ]
    rows: dict[str, list[Panel]] = {name: [] for name, *_ in pairs}
    parameter_rows = []
    for name, formulation in FORMULATIONS.items():
        base = replace(DEFAULT, formulation=name, parameter=formulation.default)
        main = name == DEFAULT.formulation
        for chart, _, x, y in pairs if formulation.everywhere else ():
            rows[chart].append(Panel(name, base, x, y) if main else Panel(name, base, x.thin(), y.thin()))
        axis = Axis("parameter", formulation.label, formulation.values)
        parameter_rows.append(Panel(name, base, SIZE if main else SIZE.thin(), axis))
    result = [Chart(name, title, tuple(rows[name])) for name, title, *_ in pairs]
    result.append(Chart("size_parameter", "Contact size and parameter of the contact", tuple(parameter_rows)))
    elements = tuple(
        Panel(name, replace(DEFAULT, element=name), NU if name in ("P1", "P2") else HIGH_NU, FEW_SIZES)
        for name in ELEMENTS
    )
    return [*result, Chart("nu_size", "Poisson's ratio and contact size", elements)]


def named() -> list[Named]:
    """Return the known failures with the runs that reproduce them."""
    coarse = replace(DEFAULT, contact_size=10e-6)
    free = replace(coarse, sides="free")
    squeezed = replace(free, indentation=30e-6, voltage=0.0, slide=0.0)
    smooth = replace(DEFAULT, mu_f=0.0, slide=0.0, force=1.0)
    edge = [
        (f"{size * 1e6:g} µm, {element}, {way}", replace(smooth, contact_size=size, element=element, detour=detour))
        for size, element in ((5e-6, "P2"), (20e-6, "P2"), (40e-6, "P2"), (20e-6, "P1"))
        for way, detour in (("up to 200 V", 0.0), ("up to 400 V, down to 200 V", 400.0))
    ]
    trailing = replace(free, ridges=3, force=1.0)
    return [
        Named(
            "locking",
            "Locking of first-order elements near ν = 0.5: force at a given indentation of 30 µm, free sides, 10 µm.",
            tuple((f"{e}, ν = {nu}", replace(squeezed, element=e, nu=nu)) for nu in (0.48, 0.4999) for e in ELEMENTS),
            referenced=True,
        ),
        Named(
            "penalty",
            "Ill-conditioning at high penalty, 10 µm.",
            tuple(
                (f"ε_n = {eps_n:g} Pa/m", replace(coarse, parameter=eps_n))
                for eps_n in (1.5e12, 1.5e14, 1.5e16, 1.5e18)
            ),
        ),
        Named(
            "coercivity",
            "Nitsche's method below its coercivity limit, 10 µm: θ = 0 loses its equilibria, θ = -1 is stable for any "
            "γ_0 in the linear problem.",
            tuple(
                (f"θ = {theta}, γ_0 = {gamma_0:g}", replace(coarse, formulation=name, parameter=gamma_0))
                for theta, name in ((0, "Nitsche, θ = 0"), (-1, "Nitsche, θ = -1"))
                for gamma_0 in (0.01, 0.1, 10.0)
            ),
        ),
        Named(
            "edge",
            "The contact's edge trapped between the nodes of coarse surfaces when voltage should move it: pressed by "
            "1 N/m and charged, without friction and sliding. The way to 200 V should not matter.",
            tuple(edge),
            referenced=True,
        ),
        Named(
            "snap-off",
            "Newton's method cycling when a trailing ridge snaps off: three ridges with free sides, 1 N/m each, 10 µm.",
            (
                ("with pseudo-transient continuation", trailing),
                ("Newton alone, with cutback", replace(trailing, pseudo_transient=False)),
            ),
        ),
        Named(
            "inversion",
            "J <= 0 in the dermis under a large force: three ridges with free sides under 20 N/m each, 0 V, 10 µm.",
            (("20 N/m a ridge", replace(trailing, force=20.0, voltage=0.0)),),
        ),
    ]


def neighbours() -> Named:
    """Return the default, what differs from it in one numerical parameter, and the bias of the reference."""
    others: dict[str, dict[str, Any]] = {
        "ε_n / 10": {"parameter": DEFAULT.parameter / 10},
        "ε_n × 10": {"parameter": DEFAULT.parameter * 10},
        "contact size 3 µm": {"contact_size": 3e-6},
        "contact size 10 µm": {"contact_size": 10e-6},
        "P1": {"element": "P1"},
        "steps × 1/2": {"step_scale": 0.5},
        "steps × 2": {"step_scale": 2.0},
    }
    runs: list[tuple[str, Case]] = [("default", DEFAULT)]
    runs += [(words, replace(DEFAULT, **changed)) for words, changed in others.items()]
    runs.append(("1.25 µm, ε_n × 10", replace(DEFAULT.reference, parameter=DEFAULT.parameter * 10)))
    return Named("default", "", tuple(runs), referenced=True)


def cases() -> list[Case]:
    """Return everything to be run, each once: named runs first, then references, without which others say less.

    Raises:
        ValueError: more than MOST.
    """
    shown = [case for chart in charts() for panel in chart.panels for case in panel.cases()]
    runs = [case for name in [neighbours(), *named()] for _, case in name.cases]
    compared = [case for name in named() if name.referenced for _, case in name.cases] + shown
    unique = list(dict.fromkeys([*runs, *(case.reference for case in compared), *shown]))
    if len(unique) > MOST:
        raise ValueError(f"the map has {len(unique)} solves; at most {MOST}: make the axes shorter")
    return unique
