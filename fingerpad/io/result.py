"""Result of a model: the states of a run by name and in order, their errors and costs, as values, files and text."""

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad.io import terminal
from fingerpad.io.files import read_object
from fingerpad.io.states import PREFIXES, STATES, LoadResult, load_results
from fingerpad.scene import Scene, SceneError, as_kept
from fingerpad.scene.laws import coefficient
from fingerpad.scene.messages import clip
from variational.state import CONDITIONS, RESULTS, ContactState, Errors

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from fingerpad.io.drawing import Drawing
    from fingerpad.slices.finger import WholeFinger

_STABILITY = ("stable", "lambda_min", "gain")
_CHANGES = ("error", "penalty")
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
    """Result of a model for a scene; the same on every rank, except for pictures, which rank 0 draws."""

    scene: Scene
    model: str
    """``full`` or ``cylinders``."""
    uncharged: ContactState | None
    """Uncharged normal contact; None where a history or a model does not have this state, as for the next two. All
    three are defined in :mod:`fingerpad.io.states`."""
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
    finger: "WholeFinger | None" = None
    """The whole finger in N and mm²; None where a history or a model does not give it."""

    def __post_init__(self) -> None:
        """Keep the folder where the program may go to another one, in which the same name is another run's."""
        if self.folder is not None:
            object.__setattr__(self, "folder", self.folder.absolute())

    @property
    def named(self) -> dict[str, ContactState]:
        """Named states that are not None, by their names in :data:`fingerpad.io.states.STATES`."""
        return {name: state for name in STATES if (state := getattr(self, name)) is not None}

    @property
    def last(self) -> ContactState | None:
        """The last accepted state; without a loading path the last named state."""
        return self.steps[-1] if self.steps else (self.full_slip or self.charged or self.uncharged)

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
            from fingerpad.io.footprint_picture import footprint  # Matplotlib

            return footprint(self.finger, None if path is None else Path(path)) if terminal.rank() == 0 else None
        if self.drawing is not None:
            return self.drawing.figure(kind, None if path is None else Path(path))
        if self.model != "full":
            raise ValueError(f"the model {self.model!r} has no skin to draw; use model='full'")
        if terminal.rank() == 0:
            raise ValueError("the result has no states to draw")
        return None

    def to_xarray(self) -> "xarray.Dataset":
        """Return steps, loads, ridges, sites and named states as one dataset with units, as ``result.nc`` has it.

        Raises:
            ImportError: xarray is not installed.
        """
        from fingerpad.io import dataset  # it takes a Result

        return dataset.dataset(self)

    # -- files -----------------------------------------------------------------------------------------
    def values(self) -> dict[str, Any]:
        """Return conditions and results of the named states, flat: ``slip_mu_app``; None where a state is missing."""
        found: dict[str, Any] = {}
        for name in STATES:
            state, prefix = getattr(self, name), PREFIXES[name]
            names = (*CONDITIONS, *RESULTS, *_STABILITY)
            found |= {f"{prefix}_{key}": None if state is None else _plain(getattr(state, key)) for key in names}
            for kind in _CHANGES if state is not None else ():
                found |= {f"{prefix}_{key}_{kind}": value for key, value in getattr(state, kind).known().items()}
        return found

    def to_dict(self) -> dict[str, Any]:
        """Return the content of ``summary.json``, ready for JSON; SI units."""
        last = self.last
        found: dict[str, Any] = {
            "model": self.model,
            "f_ext": 0.0 if last is None else last.f_ext,
            "voltage": 0.0 if last is None else last.voltage,
            "full_slip": self.full_slip is not None,
            **{f.name: getattr(self.cost, f.name) for f in fields(Cost)},
            **self.values(),
            "states": {name: _nested(state) for name, state in self.named.items()},
            "loads": [load.to_dict() for load in self.loads],
            "parameters": self.scene.parameters(),
            **self.record,
        }
        for name in ("failure", "interrupted"):
            found |= {name: getattr(self, name)} if getattr(self, name) else {}
        for name in ("notes", "cautions"):
            found |= {name: list(getattr(self, name))} if getattr(self, name) else {}
        return found | ({"finger": self.finger.to_dict()} if self.finger is not None else {})

    @classmethod
    def from_dict(cls, summary: Mapping[str, Any], folder: Path | None = None) -> "Result":
        """Return the result of a ``summary.json``, without the states on the loading path.

        Raises:
            SceneError: its parameters are no valid scene.
        """
        parameters = summary["parameters"]
        scene = as_kept(parameters)
        cost = Cost(**{f.name: summary.get(f.name, f.default) for f in fields(Cost)})
        used = {f.name for f in fields(Cost)} | {"parameters", "states", "loads", "failure", "interrupted", "notes"}
        used |= {"cautions", "model", "f_ext", "voltage", "full_slip", "finger"}
        names = (*CONDITIONS, *RESULTS, *_STABILITY, *(f"{f.name}_{kind}" for f in fields(Errors) for kind in _CHANGES))
        used |= {f"{prefix}_{name}" for prefix in PREFIXES.values() for name in names}
        record = {key: value for key, value in summary.items() if key not in used}
        if "laws" in parameters:  # objects of Python, of which only the names are kept
            record["parameters"] = parameters
        uncharged, charged, full_slip = (_state(summary, PREFIXES[name]) for name in STATES)
        from fingerpad.slices.finger import WholeFinger  # it takes names of this module's wing

        return cls(
            scene,
            summary.get("model", "full"),
            uncharged,
            charged,
            full_slip,
            cost=cost,
            failure=summary.get("failure", ""),
            interrupted=summary.get("interrupted", ""),
            notes=tuple(summary.get("notes", ())),
            cautions=tuple(summary.get("cautions", ())),
            record=record,
            folder=folder,
            finger=WholeFinger.from_dict(summary["finger"], scene.slices) if "finger" in summary else None,
        )

    @classmethod
    def load(cls, folder: str | Path) -> "Result":
        """Return the result of a run from its folder; the skin of its named states is that of ``result.nc`` there.

        Raises:
            SceneError: the folder holds no result that can be read.
        """
        from fingerpad.io import dataset  # it takes a Result
        from fingerpad.io.kept_drawing import KeptDrawing  # Matplotlib, which reading numbers does not need

        folder, name = Path(folder), clip(str(folder), 80)
        try:
            summary = read_object(folder / "summary.json")
            if set(summary) == {"failure"}:
                raise SceneError(f"the run in {name} was refused and has no results: {summary['failure']}")
            found = cls.from_dict(summary, folder)
            skins = dataset.skins(folder)
            known = {name: replace(state, skin=skins.get(name)) for name, state in found.named.items()}
            found = replace(found, **{name: known.get(name) for name in STATES})  # type: ignore[arg-type]
            if found.model != "full" or not (summary.get("steps") or (folder / "steps.csv").exists()):
                return found  # of no path, or of one without an accepted step
            with (folder / "steps.csv").open(encoding="utf-8", newline="") as file:
                steps = tuple(ContactState.from_row(row) for row in csv.DictReader(file))
            mu_0 = None if "laws" in found.record.get("parameters", {}) else coefficient(found.scene)
            asked = found.scene.accuracy is not None
            meshes = (summary.get("path_mesh"), summary.get("accuracy", {}).get("mesh")) if asked else (None, None)
            path, final = (mesh["contact"] if mesh else None for mesh in meshes)
            drawing = KeptDrawing(mu_0, steps, {}, {}, {}, path, found.named, folder.absolute(), final)
            return replace(found, steps=steps, loads=tuple(_loads(steps, found.scene, summary)), drawing=drawing)
        except (OSError, ValueError, KeyError, TypeError, AttributeError, csv.Error) as error:  # JSON of other things
            if isinstance(error, SceneError) and name in str(error):
                raise
            if isinstance(error, FileNotFoundError | NotADirectoryError) and not (folder / "summary.json").exists():
                raise SceneError(f"{name} is not a folder of a finished run") from None
            raise SceneError(f"run {name} cannot be read: its files are not whole, or not of a run ({error})") from None

    def __str__(self) -> str:
        """Return the text at the end of a run, see :func:`fingerpad.io.result_text.text`."""
        from fingerpad.io.result_text import text  # it takes a Result

        return text(self)

    __repr__ = __str__
    """In a notebook, too: the values of all steps are hundreds of pages."""


def _loads(steps: Sequence[ContactState], scene: Scene, summary: Mapping[str, Any]) -> Iterator[LoadResult]:
    """Return the result of each load of a run; the stability of its end comes from the summary."""
    stable = [load.get("stable") for load in summary.get("loads", ())]
    return load_results(steps, scene.loads(), lambda k, end: stable[k] if k < len(stable) else None)


def _plain(value: Any) -> Any:
    """Return a value ready for JSON: None for NaN."""
    return None if isinstance(value, float) and math.isnan(value) else value


def _nested(state: ContactState) -> dict[str, Any]:
    found: dict[str, Any] = {key: _plain(getattr(state, key)) for key in (*CONDITIONS, *RESULTS, *_STABILITY)}
    return found | {kind: getattr(state, kind).known() for kind in _CHANGES}


def _state(summary: Mapping[str, Any], prefix: str) -> ContactState | None:
    if summary.get(f"{prefix}_contact_length") is None:
        return None
    values = {key: summary.get(f"{prefix}_{key}") for key in (*CONDITIONS, *RESULTS, *_STABILITY)}
    given = {"mu_app": math.nan} | {key: value for key, value in values.items() if value is not None}
    if wrong := [key for key, value in given.items() if not isinstance(value, int | float) and key != "load"]:
        raise TypeError(f"{prefix}_{wrong[0]} is no number")
    for key in ("f_ext", "voltage"):  # of the scene itself, in results of models without a loading path
        given.setdefault(key, summary[key] if summary.get("model", "full") != "full" else math.nan)
    if prefix == PREFIXES["full_slip"]:
        given |= {"all_slip": True, "slip_held": True}
    return ContactState(**given, error=_changes(summary, prefix, "error"), penalty=_changes(summary, prefix, "penalty"))


def _changes(summary: Mapping[str, Any], prefix: str, kind: str) -> Errors:
    keys = {field.name: f"{prefix}_{field.name}_{kind}" for field in fields(Errors)}
    return Errors(**{name: summary[key] for name, key in keys.items() if summary.get(key) is not None})
