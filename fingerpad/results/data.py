"""What a result holds: states by name and in order, loads, costs, remarks, and outputs computed from its states."""

import math
from collections.abc import Iterable, MutableMapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fingerpad.results import quantities
from fingerpad.results.quantities import (
    BAND,
    FINGER,
    MESH,
    MODEL,
    PENALTY,
    PEOPLE,
    QUANTITIES,
    SLICES,
    SUMS,
    TABLES,
    Output,
)
from fingerpad.results.states import STATES, LoadResult
from fingerpad.scene.messages import SceneError, show
from fingerpad.scene.reading import DEFAULT_MODEL
from variational.caution import Caution
from variational.state import ContactState, StepRecord

if TYPE_CHECKING:
    from fingerpad.scene import Scene
    from fingerpad.slices.finger import WholeFinger

MODEL_ERROR, MODEL_WORDS = "model_error", "model_words"
"""Keys of a cheaper model's known errors, and of what it is made of, in a result's record."""
FULL_WORDS = "Every ridge of the cross-section"
"""What the full model is made of."""


class Number(NamedTuple):
    """A quantity with its whole known error; SI."""

    value: float
    error: float
    """NaN where it is not known."""
    parts: tuple[str, ...]
    """What the error is made of, in words."""


@dataclass(frozen=True)
class Cost:
    """Time, memory and work of a result."""

    processor_seconds: float = 0.0
    """Processor time of all ranks (s), meshes, microscale and compiled forms included."""
    wall_seconds: float = 0.0
    """Elapsed time (s)."""
    newton_iterations: int = 0
    factorisations: int = 0
    unknowns: int = 0
    """Unknowns of the largest linear system; with an accuracy, of the final mesh."""
    memory_mb: float = 0.0
    """Memory of all ranks (MB)."""
    ranks: int = 1


@dataclass(frozen=True, eq=False, repr=False)
class ResultData:
    """What a model answers to a scene; the same on every rank, except for the drawing, which rank 0 has."""

    scene: "Scene"
    model: str
    """``full`` or ``cylinders``."""
    uncharged: ContactState | None
    """Uncharged normal contact; None where a history or a model does not have this state, as for the next two. All
    three are defined in :mod:`fingerpad.results.states`."""
    charged: ContactState | None
    """Charged normal contact, the last state in contact before the bone moves sideways; of a run at 0 V uncharged."""
    full_slip: ContactState | None
    """Full slip, held over a further 0.2 mm."""
    steps: tuple[ContactState, ...] = ()
    """Accepted states in order; empty for a model without a loading path."""
    loads: tuple[LoadResult, ...] = ()
    """Each load in order, with the state at its end."""
    cost: Cost = Cost()
    failure: str = ""
    """Reason why a load or an accuracy could not be reached, else empty."""
    interrupted: str = ""
    """Name of the signal that ended the run, else empty."""
    notes: tuple[str, ...] = ()
    """Remarks on the result: sources and omissions."""
    cautions: tuple[Caution, ...] = ()
    """Why the numbers may be further off than their errors say: limits of validity that the scene reaches."""
    record: dict[str, Any] = field(default_factory=dict)
    """All else, ready for JSON: omissions, restarts, refinement, laws, provenance."""
    folder: Path | None = None
    """Folder of tables, plots and fields, an absolute path; None where nothing was written."""
    drawing: Any = None
    """Data of the pictures, a :class:`fingerpad.results.pictures.drawing.Drawing`; None for a model without them."""
    outputs: tuple[Output, ...] = ()
    """Outputs that are computed from a state; of a result that was read their values alone are known."""
    finger: "WholeFinger | None" = None
    """The whole finger in N and mm²; None where a history or a model does not give it."""

    def __post_init__(self) -> None:
        """Keep the folder where the program may go to another one, in which the same name is another run's."""
        if self.folder is not None:
            object.__setattr__(self, "folder", self.folder.absolute())

    @property
    def named(self) -> dict[str, ContactState]:
        """Named states that are not None, by their names in :data:`fingerpad.results.states.STATES`."""
        return {name: state for name in STATES if (state := getattr(self, name)) is not None}

    @property
    def missing_slip(self) -> str:
        """That a slide did not end in full slip, in words; empty where it did, or where nothing slides."""
        if self.full_slip is not None or not any(load.until_full_slip or load.moves for load in self.scene.loads()):
            return ""
        held = any(load.full_slip_reached for load in self.loads)
        return "not held over a further 0.2 mm" if held else "not reached"

    @property
    def parameters(self) -> dict[str, Any]:
        """Parameters of the scene, as its files have them, with names of laws that are not read."""
        kept: dict[str, Any] = self.record.get("parameters") or self.scene.parameters()
        return kept

    @property
    def closures(self) -> dict[str, float | None]:
        """µ_app at full slip by each model of roughness, by the ratio of charged cylinders; None without a number.

        It has none without an equilibrium, and where ridges adhere beyond its table of gaps. Empty without voltage,
        friction or full slip, for a history, and for a closure of one's own.
        """
        return dict(self.record.get(BAND, {}).get("mu_app", {}))

    @property
    def people(self) -> dict[str, Any]:
        """Range of µ_app at full slip over people: ``low`` and ``high``, of nine in ten, and ``spreads``.

        An end is None where it is open. Without a range it has ``why`` alone. Empty without friction.
        """
        return dict(self.record.get(PEOPLE, {}))

    @property
    def whole(self) -> bool:
        """Whether the scene has a force on the whole finger; the named states are then those of its centre."""
        return self.scene.force is not None

    @property
    def follows_path(self) -> bool:
        """Whether the model follows the loads step by step: the full one alone."""
        return self.model == DEFAULT_MODEL

    @property
    def model_words(self) -> str:
        """What the model is made of, a sentence without its full stop."""
        words = FULL_WORDS if self.follows_path else self.record.get(MODEL_WORDS, "A model that is not registered here")
        return str(words)

    @property
    def printed(self) -> dict[str, Output]:
        """Quantities of a state that are printed, with outputs of one's own, by name."""
        return QUANTITIES | {each.name: each for each in self.outputs if "result" in each.tables}

    def number(self, state: str, key: str, whole: bool = False) -> Number:
        """Return a quantity of a named state with its whole known error: the ± at every door.

        Args:
            state: a name of :data:`fingerpad.results.states.STATES`.
            key: a quantity of a state or, of the whole finger, of :data:`fingerpad.results.quantities.FINGER`.
            whole: whether it is of the whole finger.
        """
        if whole:
            assert self.finger is not None
            error = self.finger.error.get(state, {}).get(key, math.nan)
            return Number(self.finger.values(state)[key], error, self.finger.parts(state))
        section = self.named[state]
        value, error = getattr(section, key), getattr(section.error, key, math.nan)
        return Number(value, error, self.parts(state, key=key))

    def parts(self, *states: str, key: str = "") -> tuple[str, ...]:
        """Return what the errors of the section are made of, in words; by default of all named states and quantities.

        Args:
            states: names of states.
            key: a quantity.
        """
        if MODEL_ERROR in self.record:
            return (MODEL,)
        named = [self.named[name] for name in states or self.named]
        kinds = ([each.error for each in named], [each.penalty for each in named])
        known = ({name for each in kind for name in each.known()} for kind in kinds)
        mesh, penalty = (key in names if key else bool(names) for names in known)
        return (*[MESH] * mesh, *[PENALTY] * (mesh and penalty))


# -- outputs of the package and of a user --------------------------------------------------------------------
_OF_FINGER = {*FINGER, *SLICES, "centre", "carried", "slices", "trace"}


def checked(outputs: Any) -> tuple[Output, ...]:
    """Return outputs of the package and of a user.

    Args:
        outputs: of the user.

    Raises:
        SceneError: one is no output, or has a name that a state has.
    """
    given = list(outputs) if isinstance(outputs, Iterable) else [outputs]
    if isinstance(outputs, Output) or not all(isinstance(each, Output) for each in given):
        raise SceneError(f"outputs is {show(outputs)}; it must be a list of fingerpad.Output")
    names = {f.name for each in (ContactState, StepRecord) for f in fields(each)} | set(dir(ContactState))
    every = tuple(dict.fromkeys((*quantities.OUTPUTS, *given)))
    for each in every:
        if not (isinstance(each.name, str) and each.name.isidentifier()) or each.name in names:
            raise SceneError(f"an output is called {show(each.name)}; it must have a name of its own, such as 'p_mean'")
        if not isinstance(each.unit, str) or not callable(each.compute):
            raise SceneError(f"the output {each.name} must have a unit, such as 'kPa', and a function of a state")
        if each.sum not in ("", "slices"):
            raise SceneError(f"the output {each.name} has sum = {show(each.sum)}; it must be 'slices', or left out")
        if not TABLES >= each.tables:
            unknown = show(sorted(each.tables - TABLES)[0])
            raise SceneError(f"the output {each.name} has the table {unknown}; tables are {', '.join(sorted(TABLES))}")
        if each.sum and each.si not in SUMS:
            units = f"the unit {show(each.unit)}; it must be one per metre of finger: {', '.join(SUMS)}"
            raise SceneError(f"the output {each.name} has sum = 'slices' and {units}")
        if each.sum and each.name in _OF_FINGER:
            raise SceneError(f"an output is called {show(each.name)}, as a quantity of the whole finger; rename it")
        names.add(each.name)
    return every


def valued(
    state: ContactState, outputs: Iterable[Output], lost: MutableMapping[str, str] | None = None
) -> ContactState:
    """Return a state with the values of outputs.

    Args:
        state: the state.
        outputs: what is computed from it.
        lost: takes by name why an output has no value, which is NaN then; without it that is an error. A state
            between those of a trace keeps the value that was interpolated.

    Raises:
        SceneError: an output cannot be computed.
    """

    def value(each: Output) -> float:
        try:
            return each.of(state)
        except SceneError as error:
            if each.sum and each.name in state.own:
                return state.own[each.name]
            if lost is None:
                raise
            lost.setdefault(each.name, str(error))
            return math.nan

    return replace(state, own={**state.own, **{each.name: value(each) for each in outputs if each.compute}})
