"""A state of contact: what bone, screen and ridges bear. Plain numbers and NumPy arrays, no finite elements.

Every model of a finger or of one ridge answers with :class:`ContactState`, and so do files of results. SI units;
forces, energies and stiffnesses are per out-of-plane length, since the models are of plane strain: a force is in N/m.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Errors:
    """Changes of a state's quantities, in their units; NaN where a change was not estimated."""

    mu_app: float = math.nan
    f_t: float = math.nan
    contact_length: float = math.nan
    f_contact: float = math.nan
    f_electrostatic: float = math.nan
    bone_height: float = math.nan

    def known(self) -> dict[str, float]:
        """Return the changes that were estimated, by quantity."""
        return {field.name: value for field in fields(self) if not math.isnan(value := getattr(self, field.name))}


@dataclass(frozen=True, eq=False)
class RidgeStates:
    """The ridges that can touch; shape (ridges,) each."""

    number: NDArray[np.int64]
    """0 for the central ridge, negative at x < 0."""
    length: Array
    """Length in contact (m)."""
    f_contact: Array
    """Contact force (N/m)."""
    f_friction: Array
    """Friction on the skin (N/m), positive towards x > 0."""
    f_electrostatic: Array
    """Attraction (N/m)."""
    p_c: Array
    """Mean contact pressure over the length in contact (Pa), zero without contact."""
    d_eq: Array
    """Equivalent air gap (m), NaN where no load has a voltage."""


@dataclass(frozen=True, eq=False)
class Skin:
    """The skin that can touch, at the Gauss points of its facets; shape (facets, points) but for :attr:`ridge`."""

    ridge: NDArray[np.int64]
    """Number of each facet's ridge, shape (facets,)."""
    x: Array
    """Current abscissa (m)."""
    y: Array
    """Current height above the screen (m)."""
    p_n: Array
    """Contact pressure (Pa of current area)."""
    t_t: Array
    """Shear traction on the skin (Pa of current area), positive towards x > 0."""
    p_el: Array
    """Electrostatic pressure (Pa of current area)."""


@dataclass(frozen=True)
class StepRecord:
    """How a state was reached from the one before: energies per length (J/m), balance and work of the solver."""

    penetration: float
    """Largest depth of the skin in the screen (m)."""
    imbalance: float
    """Largest nodal force left, over the force scale of the solver."""
    floor: float
    """Residual at which the last solve ended at roundoff, over the force scale; 0 where the tolerance was met."""
    stored: float
    dissipation: float
    energy_released: float
    released_error: float
    newton_iterations: int
    factorisations: int
    coupling_iterations: int
    cutbacks: int
    jump: bool
    """Whether skin or an air gap moved without the loads."""
    processor_seconds: float = math.nan
    """Of all ranks since the run began."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactState:
    """A state of equilibrium of a finger, or of one ridge, on the screen."""

    step: int = 0
    """Number of the accepted step; 0 where there is no path."""
    load: str = ""
    load_number: int = 0
    f_ext: float
    """External normal force on the bone (N/m)."""
    voltage: float
    """Instantaneous voltage U (V)."""
    bone_x: float = math.nan
    """Horizontal position of the bone (m)."""
    bone_height: float = math.nan
    """Change of the bone's height from the unloaded position (m)."""
    f_t: float
    """Friction force on the bone (N/m), positive where the bone is dragged towards x > 0."""
    mu_app: float
    """Apparent friction coefficient f_t / f_ext; NaN where no force presses the finger."""
    f_contact: float
    """Contact force of the screen (N/m)."""
    f_electrostatic: float
    """Electrostatic attraction (N/m)."""
    ridges_in_contact: int
    contact_length: float
    """Sum over the ridges (m)."""
    slipping: float = math.nan
    """Part of the points in contact that slip."""
    all_slip: bool = False
    """Whether all points in contact slip one way."""
    slip_began: int = 0
    """Step at which the full slip that the state belongs to began; 0 without full slip."""
    slip_held: bool = False
    """Whether this full slip was held over a further 0.2 mm."""
    record: StepRecord | None = None
    mesh_contact: float = math.nan
    """Size of the facets that can touch (m)."""
    time: float = math.nan
    """Time since the start of the run's first load over time (s); NaN where no load of the run is one."""
    ridges: RidgeStates | None = None
    skin: Skin | None = None
    error: Errors = Errors()
    """Estimated discretisation errors."""
    penalty: Errors = Errors()
    """What a rigid screen in place of the penalty's springs would change."""
    stable: bool | None = None
    """Whether the state is stable; None where that was not examined."""
    lambda_min: float | None = None
    """Least eigenvalue of the tangent at frozen air gaps (Pa/m)."""
    gain: float | None = None
    """Largest gain of a ridge's loop over the two scales."""

    @property
    def p_c(self) -> Array:
        """Mean contact pressure of each ridge (Pa), shape (ridges,)."""
        return self._ridges().p_c

    @property
    def d_eq(self) -> Array:
        """Equivalent air gap of each ridge (m), shape (ridges,); NaN where no load has a voltage."""
        return self._ridges().d_eq

    def _ridges(self) -> RidgeStates:
        if self.ridges is None:
            raise ValueError("the state has no values by ridge; they are kept of the named states of a run in memory")
        return self.ridges

    @classmethod
    def from_row(cls, row: Mapping[str, str]) -> "ContactState":
        """Return the state of a row of ``steps.csv``; columns that are missing, in older files, are not known.

        Raises:
            ValueError: a column that must be there is not, or is no number.
        """
        try:
            found = {field.name: _read(row[field.name], field.type) for field in _FIELDS if field.name in row}
            kept = [field.name in row for field in fields(StepRecord)]
            record = {f.name: _read(row[f.name], f.type) for f in fields(StepRecord)} if all(kept) else None
            size, time = (float(row.get(name, math.nan)) for name in ("mesh_contact", "time"))
            return cls(**found, mesh_contact=size, time=time, record=None if record is None else StepRecord(**record))
        except TypeError as error:
            raise ValueError(f"a row of steps has too few columns: {error}") from None

    def row(self) -> dict[str, Any]:
        """Return conditions, results and the record of the step as one flat row, as ``steps.csv`` holds it."""
        row: dict[str, Any] = {name: getattr(self, name) for name in _FLAT}
        if self.record is not None:
            row |= {field.name: getattr(self.record, field.name) for field in fields(StepRecord)}
        if not math.isnan(self.mesh_contact):
            seconds = {"processor_seconds": row.pop("processor_seconds")} if self.record is not None else {}
            row |= {"mesh_contact": self.mesh_contact} | seconds
        if not math.isnan(self.time):
            row["time"] = self.time
        return row


CONDITIONS = ("step", "load", "f_ext", "voltage", "bone_x")
RESULTS = ("f_t", "mu_app", "f_electrostatic", "f_contact", "bone_height", "ridges_in_contact", "contact_length")
_FIELDS = fields(ContactState)[: [field.name for field in fields(ContactState)].index("record")]
_FLAT = tuple(field.name for field in _FIELDS)


def _read(text: str, kind: Any) -> Any:
    """Return the value of a text, of the type of a field."""
    if kind is bool:
        return text == "True"
    return kind(text) if kind in (int, float) else text
