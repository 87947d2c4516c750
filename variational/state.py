"""A state of contact: what bone, screen and ridges bear. Plain numbers and NumPy arrays, no finite elements.

Every model of a finger or of one ridge answers with :class:`ContactState`, and so do files of results. SI units;
forces, energies and stiffnesses are per out-of-plane length, since the models are of plane strain: a force is in N/m.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PATH = "path"
"""How a state of a path was reached."""


class _WithOwn:
    """Has values of outputs that are computed from a state, by name; each is an attribute too."""

    def __getattr__(self, name: str) -> float:
        own = self.__dict__.get("own", {})  # not yet there while a copy is made
        if name in own:
            return float(own[name])
        raise AttributeError(f"{type(self).__name__} has no {name!r}")


@dataclass(frozen=True)
class Errors(_WithOwn):
    """Changes of a state's quantities, in their units; NaN where a change was not estimated."""

    mu_app: float = math.nan
    f_t: float = math.nan
    contact_length: float = math.nan
    p_max: float = math.nan
    f_contact: float = math.nan
    f_electrostatic: float = math.nan
    bone_height: float = math.nan
    own: Mapping[str, float] = field(default_factory=dict)
    """Of outputs that are computed from a state, by name; each is an attribute too."""

    def known(self) -> dict[str, float]:
        """Return the changes that were estimated, by quantity."""
        every = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "own"} | dict(self.own)
        return {name: value for name, value in every.items() if not math.isnan(value)}

    @classmethod
    def of(cls, changes: Mapping[str, float]) -> "Errors":
        """Return changes by quantity; those of other names are of outputs that are computed from a state."""
        names = {f.name for f in fields(cls)}
        own = {name: value for name, value in changes.items() if name not in names}
        return cls(**{name: value for name, value in changes.items() if name in names}, own=own)


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
    note: tuple[str, ...] = ()
    """Remark on the place of each ridge on the closure, mostly empty."""


@dataclass(frozen=True, eq=False)
class Sites:
    """Strain energy densities (J/m³ of reference volume) at receptor sites; shape (ridges,) each."""

    number: NDArray[np.int64]
    """Of the ridge, as in :class:`RidgeStates`; ridges that cannot touch have sites too."""
    merkel: Array
    """At the tip of the intermediate ridge."""
    left: Array
    """At the Meissner site in the papilla to the left, x smaller."""
    right: Array


@dataclass(frozen=True, eq=False)
class Stimuli:
    """What mechanoreceptors are given in a state of a run over time; shape (ridges,) each."""

    number: NDArray[np.int64]
    """Of the ridge, as in :class:`Sites`."""
    merkel_stress: Array
    """Compressive stress at the Merkel site: minus the Cauchy stress normal to the screen (Pa)."""
    meissner_stress_left: Array
    """The same at the Meissner site to the left, x smaller."""
    meissner_stress_right: Array
    pacinian_stress: Array
    """The same below the ridge's middle, just below the junction of dermis and subcutis."""
    surface_strain_left: Array
    """Mean strain along the surface of the left half of the ridge, negative in compression; NaN where it cannot touch.
    """
    surface_strain_right: Array


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
    viscous: float = math.nan
    """Work done on the branches of viscous layers (J/m), which store and dissipate it; NaN without such layers."""
    viscous_dissipation: float = math.nan
    """Dissipated by these branches (J/m)."""
    viscous_least: float = math.nan
    """Least dissipation of a branch at a point in the step over the largest amount; below 0 a branch made energy."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactState(_WithOwn):
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
    p_max: float = math.nan
    """Highest contact pressure on the skin (Pa of current area); NaN where a model has none."""
    slipping: float = math.nan
    """Part of the points in contact that slip."""
    all_slip: bool = False
    """Whether all points in contact slip one way."""
    slip_began: int = 0
    """Step at which the full slip that the state belongs to began; 0 without full slip."""
    slip_held: bool = False
    """Whether this full slip was held over a further 0.2 mm."""
    record: StepRecord | None = None
    reached: str = PATH
    """How the state was reached: by the path of its loads, or from another state of full slip."""
    mesh_contact: float = math.nan
    """Size of the facets that can touch (m)."""
    time: float = math.nan
    """Time since the start of the run's first load over time (s); NaN where no load of the run is one."""
    f_adhesion: float = math.nan
    """Adhesion without a voltage (N/m); NaN where there is no such law."""
    ridges: RidgeStates | None = None
    sites: Sites | None = None
    stimuli: Stimuli | None = None
    """Of runs with a load over time."""
    skin: Skin | None = None
    """Of the named states."""
    changes: tuple[float, ...] = ()
    """Relative change of the air gaps in each coupling iteration of the step."""
    own: Mapping[str, float] = field(default_factory=dict)
    """Values by name of outputs that are computed from a state; each is an attribute too."""
    error: Errors = Errors()
    """Whole known errors: by the mesh and the penalty, or of a cheaper model beside the full one."""
    penalty: Errors = Errors()
    """What a rigid screen in place of the penalty's springs would change."""
    stable: bool | None = None
    """Whether the state is stable; None where that was not examined."""
    lambda_min: float | None = None
    """Least eigenvalue of the tangent at frozen air gaps (Pa/m)."""
    gain: float | None = None
    """Largest gain of a ridge's loop over the two scales."""

    @property
    def f_attraction(self) -> float:
        """All that draws the finger to the screen: electrostatic attraction and adhesion (N/m)."""
        return self.f_electrostatic + (0.0 if math.isnan(self.f_adhesion) else self.f_adhesion)

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
            raise ValueError("the state has no values by ridge; models without a path and unfinished runs have none")
        return self.ridges

    def row(self) -> dict[str, Any]:
        """Return conditions, results and the record of the step as one flat row, as ``steps.csv`` holds it."""
        row: dict[str, Any] = {f.name: getattr(self, f.name) for f in _FIELDS}
        record = {} if self.record is None else {**vars(self.record)}
        for name in _VISCOUS:
            if math.isnan(record.get(name, 0.0)):
                del record[name]
        last = {f.name: value for f in _LAST if not math.isnan(value := getattr(self, f.name))}
        return row | record | last | dict(self.own)


_FIELDS = fields(ContactState)[: [f.name for f in fields(ContactState)].index("record")]
_VISCOUS = tuple(f.name for f in fields(StepRecord) if f.name.startswith("viscous"))  # columns of viscous layers
_LAST = tuple(
    f for f in fields(ContactState) if f.name in ("mesh_contact", "time", "f_adhesion")
)  # columns where they are known
