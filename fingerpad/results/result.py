"""Result of a model: the states of a run by name and in order, their errors and costs, as values, files and text."""

import csv
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad.results import dataset, terminal
from fingerpad.results.files import read_object
from fingerpad.results.quantities import (
    CHANGES,
    FRICTION,
    QUANTITIES,
    STABILITY,
    Output,
    checked,
    valued,
)
from fingerpad.results.quantities import read as read_outputs
from fingerpad.results.states import STATES, LoadResult, load_results
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.scene import Scene, as_kept
from variational.state import CONDITIONS, RESULTS, ContactState, Errors

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from fingerpad.results.drawing import Drawing
    from fingerpad.slices.finger import WholeFinger

KINDS = ("surface", "finger", "history", "footprint", "time")
"""Pictures of a result."""


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
class Result:
    """Result of a model for a scene, with pictures, text and files; the same on every rank but for the drawing."""

    scene: Scene
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
    cautions: tuple[str, ...] = ()
    """Why the numbers may be further off than their errors say: limits of validity that the scene reaches."""
    record: dict[str, Any] = field(default_factory=dict)
    """Further content of ``summary.json``: omissions, restarts, refinement, laws, provenance."""
    folder: Path | None = None
    """Folder of tables, plots and fields, an absolute path; None where nothing was written."""
    drawing: "Drawing | None" = None
    """Data of the pictures; None for a model without them."""
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
    def whole(self) -> bool:
        """Whether the scene has a force on the whole finger; the named states are then those of its centre."""
        return self.scene.force is not None

    @property
    def last(self) -> ContactState | None:
        """The last accepted state; without a loading path the last named state."""
        return self.steps[-1] if self.steps else (self.full_slip or self.charged or self.uncharged)

    @property
    def printed(self) -> dict[str, Output]:
        """Quantities of a state that are printed, with outputs of one's own, by name."""
        return QUANTITIES | {each.name: each for each in self.outputs}

    def cells(self, key: str) -> list[str]:
        """Return a printed quantity in each named state, with its error; a dash where it is not shown."""
        of, shown = self.printed[key], []
        for name, state in self.named.items():
            error = getattr(state.error, key, math.nan)
            shown.append("–" if key in FRICTION and name != "full_slip" else of.shown(getattr(state, key), error))
        return shown

    # -- pictures and datasets ---------------------------------------------------------------------------
    def plot(self, kind: str = "surface", path: str | Path | None = None) -> "Figure | None":
        """Draw the skin, the deformed finger, the history of sliding, or the footprint of the whole finger.

        Loads over time have a fourth picture: ``"time"``.

        Args:
            kind: ``"surface"``, ``"finger"``, ``"history"``, ``"footprint"`` or ``"time"``.
            path: PNG file to write; None for the figure alone.

        Returns:
            The Matplotlib figure on rank 0, None on the others.

        Raises:
            ValueError: another kind, or a kind without data in this result.
        """
        if kind not in KINDS:
            raise ValueError(f"kind is {kind!r}; it must be one of {', '.join(KINDS)}")
        if kind == "footprint":
            if self.finger is None:
                raise ValueError("the result has no whole finger to draw: a history has none, else a note says why")
            from fingerpad.results.finger_picture import footprint  # Matplotlib

            return footprint(self.finger, None if path is None else Path(path)) if terminal.rank() == 0 else None
        if (drawing := self.drawing) is None and self.steps and self.folder is not None and terminal.rank() == 0:
            from fingerpad.results.drawing import read  # Matplotlib

            drawing = read(self)
        if drawing is not None:
            return drawing.figure(kind, None if path is None else Path(path))
        if not self.steps:
            raise ValueError(f"the result of the model {self.model!r} has no steps to draw; those of model='full' have")
        return None  # on the other ranks

    def to_xarray(self) -> "xarray.Dataset":
        """Return steps, loads, ridges, sites and named states as one dataset with units, as ``result.nc`` has it."""
        return dataset.dataset(self)

    def with_outputs(self, outputs: Iterable[Output]) -> "Result":
        """Return the result with further outputs, computed from its states; files are not written again.

        Raises:
            SceneError: one is no output, or cannot be computed.
        """
        new = checked(outputs)
        named: dict[str, Any] = {name: valued(state, new) for name, state in self.named.items()}
        steps = tuple(valued(state, new) for state in self.steps)
        loads = tuple(load_results(steps, self.scene.loads(), lambda k, end: self.loads[k].stable)) if steps else ()
        kept = tuple(each for each in self.outputs if each.name not in {one.name for one in new})
        return replace(self, steps=steps, loads=loads, outputs=(*kept, *new), **named)

    # -- files -----------------------------------------------------------------------------------------
    def values(self) -> dict[str, Any]:
        """Return what is known of the named states, flat: ``full_slip_mu_app``; None where a state is missing."""
        found: dict[str, Any] = {}
        for name in STATES:
            state = getattr(self, name)
            found |= {f"{name}_{key}": None if state is None else getattr(state, key) for key in self._kept()}
            for kind in CHANGES if state is not None else ():
                found |= {f"{name}_{key}_{kind}": value for key, value in getattr(state, kind).known().items()}
        return {key: None if value != value else value for key, value in found.items()}

    def _kept(self) -> tuple[str, ...]:
        """Return the names of the quantities of a named state in ``summary.json``."""
        return *CONDITIONS, *RESULTS, *STABILITY, *(each.name for each in self.outputs)

    def to_dict(self) -> dict[str, Any]:
        """Return the content of ``summary.json``, ready for JSON; SI units."""
        last, values = self.last, self.values()
        nested = {
            name: {key: values[f"{name}_{key}"] for key in self._kept()}
            | {kind: getattr(state, kind).known() for kind in CHANGES}
            for name, state in self.named.items()
        }
        found: dict[str, Any] = {
            "model": self.model,
            "f_ext": 0.0 if last is None else last.f_ext,
            "voltage": 0.0 if last is None else last.voltage,
            "full_slip": self.full_slip is not None,
            **asdict(self.cost),
            **values,
            "states": nested,
            "loads": [load.to_dict() for load in self.loads],
            "parameters": self.scene.parameters(),
            **self.record,
        }
        found |= {name: text for name in ("failure", "interrupted") if (text := getattr(self, name))}
        found |= {name: list(kept) for name in ("notes", "cautions") if (kept := getattr(self, name))}
        found |= {"outputs": [each.to_dict() for each in self.outputs]} if self.outputs else {}
        return found | ({"finger": self.finger.to_dict()} if self.finger is not None else {})

    @classmethod
    def from_dict(cls, summary: Mapping[str, Any], folder: Path | None = None) -> "Result":
        """Return the result of a ``summary.json``, without the states on the loading path.

        Raises:
            SceneError: its parameters are no valid scene.
        """
        from fingerpad.slices.finger import WholeFinger  # it takes names of this module's wing

        parameters, named = summary["parameters"], summary.get("states", {})
        bare = cls(as_kept(parameters), summary.get("model", DEFAULT_MODEL), None, None, None)
        states: dict[str, Any] = {name: _state(name, named[name]) for name in STATES if name in named}
        bare = replace(
            bare,
            **states,
            cost=Cost(**{f.name: summary.get(f.name, f.default) for f in fields(Cost)}),
            failure=summary.get("failure", ""),
            interrupted=summary.get("interrupted", ""),
            notes=tuple(summary.get("notes", ())),
            cautions=tuple(summary.get("cautions", ())),
            outputs=read_outputs(summary.get("outputs", ())),
            folder=folder,
            finger=WholeFinger.from_dict(summary["finger"], bare.scene.slices) if "finger" in summary else None,
        )
        used = {*bare.to_dict(), "failure", "interrupted", "notes", "cautions", "outputs", "finger"}
        used |= {f"{name}_{each.name}_{kind}" for name in STATES for each in fields(Errors) for kind in CHANGES}
        record = {key: value for key, value in summary.items() if key not in used}
        if "laws" in parameters:  # objects of Python, of which only the names are kept
            record["parameters"] = parameters
        return replace(bare, record=record)

    @classmethod
    def load(cls, folder: str | Path) -> "Result":
        """Return the result of a run from its folder: its states from ``result.nc``, all else from ``summary.json``.

        Where there is no whole ``result.nc``, the states are those of ``steps.csv`` and ``summary.json``, without
        ridges, sites and skin.

        Raises:
            SceneError: the folder holds no result that can be read.
        """
        folder, name = Path(folder), clip(str(folder), 80)
        try:
            summary = read_object(folder / "summary.json")
            if set(summary) == {"failure"}:
                raise SceneError(f"the run in {name} was refused and has no results: {summary['failure']}")
            found = cls.from_dict(summary, folder)
            if (kept := dataset.read(folder, [each.name for each in found.outputs])) is not None:
                found = replace(found, steps=kept[0], **kept[1])  # type: ignore[arg-type]
            elif (folder / "steps.csv").exists():
                found = replace(found, steps=steps_of(folder))
            if not found.steps:
                return found  # of no path, or of one without an accepted step
            stable = [load.get("stable") for load in summary.get("loads", ())]
            loads = load_results(found.steps, found.scene.loads(), lambda k, end: (*stable, *[None] * (k + 1))[k])
            return replace(found, loads=tuple(loads))
        except (OSError, ValueError, KeyError, TypeError, AttributeError, csv.Error) as error:  # JSON of other things
            if isinstance(error, SceneError) and name in str(error):
                raise
            if isinstance(error, FileNotFoundError | NotADirectoryError) and not (folder / "summary.json").exists():
                raise SceneError(f"{name} is not a folder of a finished run") from None
            raise SceneError(f"run {name} cannot be read: its files are not whole, or not of a run ({error})") from None

    def __str__(self) -> str:
        """Return the text *Result* at the end of a run: the named states side by side, with units and errors."""
        return terminal.text_of(self)

    __repr__ = __str__
    """In a notebook, too: the values of all steps are hundreds of pages."""


def steps_of(folder: Path) -> tuple[ContactState, ...]:
    """Return the states of ``steps.csv`` of a folder; a last row that is cut short is left out.

    Raises:
        OSError: there is no such file.
        ValueError: it is not of a run.
    """
    with (folder / "steps.csv").open(encoding="utf-8", newline="") as file:
        return tuple(ContactState.from_row(row) for row in csv.DictReader(file) if None not in row.values())


def _state(name: str, kept: Mapping[str, Any]) -> ContactState:
    """Return a named state of ``summary.json``.

    Args:
        name: of the state.
        kept: its values and errors.
    """
    values = {key: value for key, value in kept.items() if key not in CHANGES and value is not None}
    if wrong := [key for key, value in values.items() if not isinstance(value, int | float) and key != "load"]:
        raise TypeError(f"{wrong[0]} of {name} is no number")
    more: dict[str, Any] = {kind: Errors(**kept.get(kind, {})) for kind in CHANGES}
    more |= {key: values.pop(key) for key in STABILITY if key in values}
    slip = {"all_slip": True, "slip_held": True} if name == "full_slip" else {}
    return replace(ContactState.from_row({"mu_app": math.nan} | values | slip), **more)
