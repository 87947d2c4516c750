"""The quantities of a result, each described once: name, unit, meaning, dimensions, how it is computed and printed.

Tables, ``result.nc``, JSON, text, reports and sweeps are made from these lists. An output of the package is one entry
of :data:`OUTPUTS`; one of a user is the same, given to ``fingerpad.run(scene, outputs=[Output(…)])``.
"""

import math
import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from fingerpad.scene.messages import SceneError
from geometry.units import in_si
from variational.state import ContactState

_NOTHING = 1e-6  # in the units of tables: below it all is roundoff
_UNITS = {
    "": ("1", 1.0), "%": ("1", 100.0), "mm": ("m", 1e3), "µm": ("m", 1e6), "mm²": ("m^2", 1e6), "kPa": ("Pa", 1e-3)
} | {unit: (unit, 1.0) for unit in ("N/m", "V", "N", "m", "Pa", "J/m", "J/m^3", "s", "Hz", "Pa/m")}  # fmt: skip
"""Unit in files and factor from SI, by unit of tables; others are those of :func:`geometry.units.in_si`."""
SUMS = {"N/m": ("N", 1), "J/m": ("J", 2), "m": ("mm²", 1), "m^2": ("m^3", 2)}
"""Of quantities per metre of finger: the unit of their sum, and :attr:`Output.power`."""
TABLES = frozenset({"result", "sweep"})
"""Tables that an output of one's own may stand in: the printed result, and those of sweeps."""
SYMBOL = re.compile(r"(?<![\w.-])([µdfFhLp])_(app|eq|ext|el|max|[0cRT])(?![\w(=])")
"""A symbol in words, which pages and pictures typeset: its letter and its subscript."""


@dataclass(frozen=True)
class Output:
    """A quantity of a state, of a ridge or of the skin.

    One's own is computed from each accepted state: ``Output("p_mean", "kPa", lambda state: state.p_c.mean())``.
    """

    name: str
    """In files and tables, and as an attribute of states."""
    unit: str
    """In which it is printed. Files have it in SI."""
    compute: Callable[[ContactState], float] | None = None
    """Returns the value in SI from a :class:`ContactState`; None for what a state has by itself."""
    meaning: str = ""
    """In words, for files."""
    words: str = ""
    """With which it is printed, by default its name; the last of them is a symbol, such as µ_app."""
    digits: int = 3
    """Digits after the point, where no error is estimated."""
    sum: str = ""
    """``"slices"`` to integrate a quantity per metre of finger, such as N/m, over the slices of the whole finger."""
    error: str = ""
    """Of a quantity of the whole finger: the quantity of the section whose relative error it has."""
    tables: Collection[str] = TABLES
    """Where it stands, by the names of :data:`TABLES`; an output of one's own stands everywhere."""

    def __post_init__(self) -> None:
        """Take the tables as a set, also of a file."""
        object.__setattr__(self, "tables", frozenset(self.tables))

    @property
    def _in_files(self) -> tuple[str, float]:
        return _UNITS.get(self.unit) or in_si(self.unit)

    @property
    def si(self) -> str:
        """Unit in files; 1 for a number without a unit."""
        return self._in_files[0]

    @property
    def scale(self) -> float:
        """Factor from SI to the unit."""
        return self._in_files[1]

    @property
    def power(self) -> int:
        """Exponent of the width of similar slices, with which the quantity grows at equal stress."""
        return SUMS.get(self.si, ("", 1))[1]

    @property
    def whole(self) -> "Output":
        """The sum over the slices of a whole finger, of a quantity per metre of it."""
        return replace(self, unit=SUMS[self.si][0])

    @property
    def symbol(self) -> str:
        """The last of the words where it is a symbol, such as µ_app, else all words but the state of ridges."""
        words = self.words or self.name
        last = words.split()[-1]
        return last if len(last) == 1 or "_" in last else words.removesuffix(" in contact")

    @property
    def head(self) -> str:
        """Symbol and unit."""
        return f"{self.symbol} ({self.unit})" if self.unit else self.symbol

    @property
    def title(self) -> str:
        """Words and unit."""
        return f"{self.words or self.name} ({self.unit})" if self.unit else self.words or self.name

    def shown(self, value: float | None, error: float | None = None) -> str:
        """Return a value in the unit of tables, with its error where that is half a digit shown, or half a per cent.

        Args:
            value: in SI; None or NaN where it is not computed.
            error: in SI; None or NaN where it is not estimated.
        """
        if value is None or math.isnan(value):
            return "–"
        shown, wide = value * self.scale, math.nan if error is None else error * self.scale
        if wide >= 0.5 * 10.0**-self.digits or (abs(shown) > _NOTHING and wide > 5e-3 * abs(shown)):
            return plus_minus(shown, wide)
        small = _NOTHING < abs(shown) < 0.5 * 10.0**-self.digits
        return f"{shown:.2g}" if small else f"{shown:z.{self.digits}f}"  # z: no minus before a zero

    def about(self, prefix: str = "") -> dict[str, str]:
        """Return the attributes of its variable in a dataset: its unit in SI, and its meaning after a prefix."""
        return {"units": self.si, "long_name": prefix + (self.meaning or self.words or self.name)}

    def to_dict(self) -> dict[str, Any]:
        """Return all but how it is computed, ready for JSON."""
        found = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "compute"}
        return found | {"tables": sorted(self.tables)}

    def of(self, state: ContactState) -> float:
        """Return the value of a state (SI).

        Raises:
            SceneError: it cannot be computed, or is no number.
        """
        assert self.compute is not None
        try:
            return float(self.compute(state))
        except Exception as error:
            what = f"{type(error).__name__}: {error}"
            raise SceneError(
                f"the output {self.name} of step {state.step} cannot be computed ({what}); its function must return a "
                "number from a ContactState"
            ) from error


def _listed(*rows: tuple[Any, ...], error: Mapping[str, str] | None = None, **tables: str) -> dict[str, Output]:
    """Return quantities that states have, by name.

    Args:
        rows: of each its name, unit, meaning, and words and digits of tables.
        error: the quantity of the section whose relative error each has.
        tables: names of the quantities of a table, in one text.
    """
    found = {}
    for name, unit, *more in rows:
        mine = (table for table, names in tables.items() if name in names.split())
        given: dict[str, Any] = {"tables": frozenset(mine), "error": (error or {}).get(name, "")}
        found[name] = Output(name, unit, **dict(zip(("meaning", "words", "digits"), more, strict=False)), **given)
    return found


STEPS = _listed(
    ("step", "", "number of the accepted step"),
    ("load", "", "name of the load"),
    ("load_number", "", "number of the load, from 1"),
    ("f_ext", "N/m", "external normal force on the bone per metre of finger", "external force f_ext", 2),
    ("voltage", "V", "instantaneous voltage", "voltage U", 1),
    ("bone_x", "mm", "horizontal position of the bone", "bone x", 4),
    ("bone_height", "mm", "change of the bone's height from the unloaded position", "height of the bone", 4),
    ("f_t", "N/m", "friction force on the bone per metre of finger", "friction force f_T", 3),
    (
        "mu_app", "", "apparent friction coefficient f_t / f_ext; none where no force presses",
        "apparent friction µ_app", 4,
    ),
    ("f_contact", "N/m", "contact force of the screen per metre of finger", "contact force f_c", 3),
    ("f_electrostatic", "N/m", "electrostatic attraction per metre of finger", "attraction f_el", 3),
    ("ridges_in_contact", "", "number of ridges in contact", "ridges in contact", 0),
    ("contact_length", "mm", "sum of the lengths in contact", "contact length L_R", 4),
    ("p_max", "kPa", "highest contact pressure on the skin per current area", "highest pressure p_max", 1),
    ("slipping", "", "part of the points in contact that slip"),
    ("all_slip", "", "whether all points in contact slip one way"),
    ("slip_began", "", "first step of the full slip that the state belongs to; 0 without full slip"),
    ("slip_held", "", "whether this full slip was held over a further 0.2 mm"),
    ("penetration", "m", "largest depth of the skin in the screen"),
    ("imbalance", "", "largest nodal force left, relative to the largest f_ext of all loads, or to 1 N/m without one"),
    ("floor", "", "residual at which the last solve ended at roundoff, on the same scale; 0 if converged"),
    ("stored", "J/m", "stored energy per metre of finger"),
    ("dissipation", "J/m", "energy dissipated by friction in the step per metre of finger"),
    (
        "energy_released", "J/m",
        "energy released by a jump per metre of finger; in a step without a jump the error of the work's quadrature",
    ),
    ("released_error", "J/m", "error of the energy released by a jump"),
    ("newton_iterations", "", "Newton iterations of the step"),
    ("factorisations", "", "factorisations of the step"),
    ("coupling_iterations", "", "coupling iterations of the step"),
    ("cutbacks", "", "number of times that the step was cut"),
    ("jump", "", "whether skin or an air gap moved without the loads"),
    ("processor_seconds", "s", "processor time of all ranks since the start of the run"),
    ("viscous", "J/m", "work done in the step on the branches of viscous layers, which store and dissipate it"),
    ("viscous_dissipation", "J/m", "energy dissipated in the step by the branches of viscous layers"),
    ("viscous_least", "", "least dissipation of a branch at a point over the largest in the step; < 0: energy made"),
    ("mesh_contact", "m", "contact size of the mesh"),
    ("time", "s", "time since the start of the first load over time"),
    ("f_adhesion", "N/m", "adhesion without a voltage per metre of finger", "adhesion f_ad", 3),
    result="f_ext voltage bone_height mu_app f_t f_electrostatic f_adhesion f_contact contact_length p_max "
           "ridges_in_contact",
    given="step load f_ext voltage bone_x",
    found="f_t mu_app f_electrostatic f_contact bone_height ridges_in_contact contact_length p_max",
    load="f_ext bone_height mu_app f_t contact_length f_electrostatic",
    target="mu_app f_t contact_length f_electrostatic",
    sweep="mu_app f_t contact_length f_electrostatic ridges_in_contact",
    short="mu_app f_t contact_length",
    slip="mu_app f_t",
    sliding="bone_x f_t mu_app contact_length ridges_in_contact",
    chart="bone_x mu_app contact_length",
    work="newton_iterations factorisations cutbacks jump",
    estimated="f_t mu_app f_electrostatic contact_length p_max bone_height",
    edges="contact_length f_t mu_app f_electrostatic bone_height",
    summed="cutbacks dissipation",
    largest="penetration imbalance floor",
)  # fmt: skip
"""Of a state, in the order of ``steps.csv``."""
STABILITY = _listed(
    ("stable", "", "whether the state is stable: 1 yes, 0 no, -1 not examined"),
    ("lambda_min", "Pa/m", "least eigenvalue of the tangent at frozen air gaps"),
    ("gain", "", "largest gain of a ridge's loop over the two scales"),
)
"""Of a named state."""
RIDGES = _listed(
    ("contact_length", "m", "length of the ridge in contact"),
    ("f_contact", "N/m", "contact force of the ridge per metre of finger"),
    ("f_friction", "N/m", "friction force on the ridge per metre of finger, positive towards x > 0"),
    ("f_electrostatic", "N/m", "attraction of the ridge per metre of finger"),
    ("p_c", "Pa", "mean contact pressure of the ridge over its length in contact"),
    ("d_eq", "m", "equivalent air gap of the ridge"),
    ("note", "", "remark on the place of the ridge on the closure; mostly empty"),
)
"""Of the ridges of a state."""
SITES = _listed(
    ("merkel_sed", "J/m^3", "strain energy density at the Merkel site of the ridge, per reference volume"),
    ("meissner_left", "J/m^3", "strain energy density at the left Meissner site of the ridge"),
    ("meissner_right", "J/m^3", "strain energy density at the right Meissner site of the ridge"),
)
"""Of the receptor sites of a state, by ridge."""
STIMULI = _listed(
    ("merkel_stress", "Pa", "compressive stress normal to the screen at the Merkel site of the ridge"),
    ("meissner_stress_left", "Pa", "compressive stress normal to the screen at the left Meissner site of the ridge"),
    ("meissner_stress_right", "Pa", "compressive stress normal to the screen at the right Meissner site of the ridge"),
    ("pacinian_stress", "Pa", "compressive stress normal to the screen below the dermis, under the ridge's middle"),
    ("surface_strain_left", "", "mean strain along the surface of the left half of the ridge, negative in compression"),
    ("surface_strain_right", "", "mean strain along the surface of the right half of the ridge"),
)
"""Of the receptor sites of a state of a run over time, by ridge."""
SKIN = _listed(
    ("x", "m", "current abscissa of the skin"),
    ("y", "m", "current height of the skin above the screen"),
    ("p_n", "Pa", "contact pressure per current area"),
    ("t_t", "Pa", "shear traction on the skin per current area, positive towards x > 0"),
    ("p_el", "Pa", "electrostatic pressure per current area"),
)
"""Of the skin of a named state, by facet and point."""
SPECTRUM = _listed(
    ("frequency", "Hz", "frequency of the amplitude of friction"),
    ("f_t_amplitude", "N/m", "amplitude of the friction force at the frequency per metre of finger"),
)
"""Of a load over time, by harmonic."""
FINGER = _listed(
    ("f_ext", "N", "external normal force on the whole finger", "external force F_ext", 4),
    ("mu_app", "", "apparent friction coefficient of the whole finger", "apparent friction µ_app", 4),
    ("f_t", "N", "friction force on the whole finger", "friction force F_T", 4),
    ("f_electrostatic", "N", "electrostatic attraction of the whole finger", "attraction F_el", 4),
    ("f_adhesion", "N", "adhesion of the whole finger without a voltage", "adhesion F_ad", 4),
    ("gross_area", "mm²", "area between the outermost touching ridges of the slices", "gross area", 1),
    ("contact_area", "mm²", "area in contact, of the ridges", "ridge contact area", 2),
    ("real_over_gross", "", "contact area of the ridges over the gross area", "ridge over gross area", 3),
    ("shear_stress", "kPa", "friction force over the contact area of the ridges", "shear stress on ridges", 1),
    ("indentation", "mm", "lowering of the bone since the finger first touched", "indentation δ", 3),
    (
        "effective_width", "mm", "external force of the finger over that of its centre, the slice that touches first",
        "F_ext over f_ext of the centre", 2,
    ),
    error={"contact_area": "contact_length", "indentation": "bone_height"}
          | {name: name for name in ("mu_app", "f_t", "f_electrostatic")},
    sweep="mu_app f_t f_electrostatic gross_area contact_area",
    file="f_ext mu_app f_t f_electrostatic gross_area contact_area indentation",
    first="f_ext mu_app f_t contact_area",
)  # fmt: skip
"""Of the whole finger in a named state."""
SLICES = _listed(
    ("z", "m", "place of the slice along the finger"),
    ("thickness", "m", "thickness of the slice, its weight in the sum"),
    ("indentation", "m", "indentation of the slice"),
    ("f_ext", "N/m", "external normal force of the slice per metre of finger"),
    ("f_t", "N/m", "friction force of the slice per metre of finger"),
    ("f_electrostatic", "N/m", "electrostatic attraction of the slice per metre of finger"),
    ("f_adhesion", "N/m", "adhesion of the slice without a voltage per metre of finger"),
    ("contact_length", "m", "length of the slice in contact, of the ridges"),
    ("gross_width", "m", "width between the outermost touching ridges of the slice"),
    ("pressure", "Pa", "mean contact pressure of the slice over its length in contact"),
    ("real_over_gross", "", "length of the slice in contact over its gross width"),
    trace="f_ext f_t f_electrostatic contact_length gross_width",
)
"""Of the slices of a whole finger."""
OUTPUTS: tuple[Output, ...] = (
    Output("stuck_share", "", lambda state: 1 - state.slipping, "part of the points in contact that stick", tables=()),
    Output(
        "shear_stress", "kPa", lambda state: abs(state.f_t) / state.contact_length if state.contact_length else 0.0,
        "friction force over the contact length", "shear stress on ridges", 1, tables=("result",),
    ),
)  # fmt: skip
"""Outputs of the package that are computed from a state, as those of a user are. A new one is an entry here."""

_ORDER = "f_ext voltage mu_app f_t f_electrostatic f_contact contact_length p_max ridges_in_contact".split()


def in_table(table: str, of: Mapping[str, Output] = STEPS) -> dict[str, Output]:
    """Return the quantities of a table, by default of a state, in the order in which they are printed."""
    mine = {key: each for key, each in of.items() if table in each.tables}
    return mine if of is not STEPS else {key: mine[key] for key in dict.fromkeys((*_ORDER, *mine)) if key in mine}


QUANTITIES = in_table("result")
"""The quantities of a state that are printed, in this order."""
CONDITIONS, RESULTS = in_table("given"), in_table("found")
"""Those of a named state in ``summary.json``."""
EXTREMES = in_table("load")
"""Those of a load of which extremes and means are kept, beside outputs of one's own."""
SWEPT = in_table("sweep")
"""Those of a named state in the table of a sweep, beside outputs of one's own."""
FRICTION = in_table("slip")
"""Those that are printed at full slip alone."""
CHANGES = {"error": "whole known error", "penalty": "estimated change for a rigid screen"}
BAND, PEOPLE = "closures", "people"
"""Keys of the bands of friction in a record: over models of roughness, and over people."""
MESH, PENALTY, MODEL = "mesh", "penalty", "closed form"
"""Parts of the error of a section, in words; those of a whole finger are in :mod:`fingerpad.slices.errors`."""
PER_LENGTH = (
    "N/m: force per metre of finger out of the plane of the cross-section; 75 N/m at its centre correspond to about "
    "0.5 N on the whole default finger."
)


def plus_minus(value: float, error: float) -> str:
    """Return a value with its error, which is given to two digits: ``0.4750 ± 0.0041``."""
    digits = max(0, 1 - math.floor(math.log10(error))) if error > 0 else 6
    return f"{value:z.{digits}f} ± {error:.{digits}f}"


def plus_minus_of(parts: Iterable[str]) -> str:
    """Return what the ± beside numbers are of, a sentence; empty without a part."""
    words = ", ".join(dict.fromkeys(parts))
    said = f"±: error by {words}; what the finger and the model assume is not in it (docs/assumptions.md)."
    return said if words else ""
