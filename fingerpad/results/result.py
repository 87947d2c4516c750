"""Result of a model: the states of a run by name and in order, their errors and costs, as values, files and text."""

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad import launcher
from fingerpad.results import dataset, printing
from fingerpad.results.answer import Answer, Cost
from fingerpad.results.files import FORMAT, read_object, refuse_other_format
from fingerpad.results.headline import Headline, headline
from fingerpad.results.quantities import CHANGES, STABILITY, Output, checked, valued
from fingerpad.results.quantities import read as read_outputs
from fingerpad.results.states import STATES, LoadResult, load_results
from fingerpad.scene.law_code import foreign
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.reading import DEFAULT_MODEL, model_name
from fingerpad.scene.remarks import coefficient
from fingerpad.scene.scene import as_kept
from variational.files import read
from variational.state import CONDITIONS, PATH, RESULTS, ContactState, Errors

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from fingerpad.afferents.afferent import Afferent
    from fingerpad.results.spikes import Spikes
    from fingerpad.scene import Scene

KINDS = ("surface", "finger", "history", "footprint", "time", "field", "solid")
"""Pictures of a result."""


@dataclass(frozen=True, eq=False, repr=False)
class Result(Answer):
    """Result of a model for a scene: its answer with pictures, text and files."""

    def plot(self, kind: str = "surface", path: str | Path | None = None) -> "Figure | None":
        """Draw the skin, the deformed finger, the history of sliding, or the footprint of the whole finger.

        Loads over time have another picture, ``"time"``, charged states the electric field of a ridge, ``"field"``, and
        whole fingers one in three dimensions, ``"solid"``.

        Args:
            kind: ``"surface"``, ``"finger"``, ``"history"``, ``"footprint"``, ``"time"``, ``"field"`` or ``"solid"``.
            path: PNG file to write; None for the figure alone.

        Returns:
            The Matplotlib figure on rank 0, None on the others.

        Raises:
            ValueError: another kind, or a kind without data in this result.
        """
        if kind not in KINDS:
            raise ValueError(f"kind is {kind!r}; it must be one of {', '.join(KINDS)}")
        if kind in ("footprint", "solid"):
            if self.finger is None:
                raise ValueError("the result has no whole finger to draw: a history has none, else a note says why")
            from fingerpad.results.whole_picture import draw  # Matplotlib

            place = None if path is None else Path(path)
            return draw(self, kind, place) if launcher.rank() == 0 else None
        if (drawing := self._drawn()) is not None:
            return drawing.figure(kind, None if path is None else Path(path))
        if not self.steps:
            raise ValueError(f"the result of the model {self.model!r} has no steps to draw; those of model='full' have")
        return None  # on the other ranks

    @property
    def headline(self) -> Headline:
        """The finding: a sentence, one number with the error of its solution, and what it is of.

        It is of the whole finger wherever ``finger`` is known, else of the middle section, which a history has alone.
        """
        return headline(self)

    def to_xarray(self) -> "xarray.Dataset":
        """Return steps, loads, ridges, sites and named states as one dataset with units, as ``result.nc`` has it."""
        return dataset.dataset(self)

    def afferents(self, laws: "str | Afferent | Iterable[str | Afferent] | None" = None) -> "Spikes":
        """Return the spikes of mechanoreceptive afferents below the ridges that can touch, over a run in time.

        Args:
            laws: names of ``fingerpad.afferents.LAWS``, or laws of one's own; by default SA1, RA1 and PC, of which
                those are left out for which two states are too far apart.

        Raises:
            SceneError: the run has no load over time, or no receptor sites; there is no such class; or two states are
                too far apart for one that is named.
        """
        from fingerpad.results.felt import afferents  # SciPy's signals

        return afferents(self, laws)

    def animate(self, path: "str | Path") -> Path:
        """Write the run as a moving picture, WebP or GIF by the end of the file's name; return the file.

        Raises:
            SceneError: the run has no motion in its folder, or the name another ending.
        """
        from fingerpad.results.animation import animate  # Matplotlib

        return animate(self, Path(path))

    def with_outputs(self, outputs: Iterable[Output]) -> "Result":
        """Return the result with further outputs, computed from its states; files are not written again.

        Raises:
            SceneError: one is no output, or cannot be computed.
        """
        new = checked(outputs)
        named: dict[str, Any] = {name: valued(state, new) for name, state in self.named.items()}
        steps = tuple(valued(state, new) for state in self.steps)
        loads = _loads(self.scene, steps, [load.stable for load in self.loads])
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

    def to_dict(self, headline: bool = True) -> dict[str, Any]:
        """Return the content of ``summary.json``, ready for JSON, by default with the headline; SI units."""
        found: dict[str, Any] = {"headline": self.headline.to_dict()} if headline else {}
        found |= self._numbers() | self.record
        found |= {name: text for name in ("failure", "interrupted") if (text := getattr(self, name))}
        found |= {name: list(kept) for name in ("notes", "cautions") if (kept := getattr(self, name))}
        found |= {"outputs": [each.to_dict() for each in self.outputs]} if self.outputs else {}
        return found | ({"finger": self.finger.to_dict()} if self.finger is not None else {})

    def _numbers(self) -> dict[str, Any]:
        """Return what ``summary.json`` holds of every result."""
        last, values = self.last, self.values()
        nested = {
            name: {key: values[f"{name}_{key}"] for key in self._kept()}
            | {kind: getattr(state, kind).known() for kind in CHANGES}
            | ({} if state.reached == PATH else {"reached": state.reached})
            for name, state in self.named.items()
        }
        return {
            "format": FORMAT,
            "model": self.model,
            "f_ext": 0.0 if last is None else last.f_ext,
            "voltage": 0.0 if last is None else last.voltage,
            "full_slip": self.full_slip is not None,
            **asdict(self.cost),
            **values,
            "states": nested,
            "loads": [load.to_dict() for load in self.loads],
            "parameters": self.scene.parameters(),
        }

    @classmethod
    def from_dict(cls, summary: Mapping[str, Any], folder: Path | None = None) -> "Result":
        """Return the result of a ``summary.json``, without the states on the loading path.

        Raises:
            SceneError: its parameters are no valid scene.
        """
        from fingerpad.slices.finger import WholeFinger  # it takes names of this module's wing

        parameters, named = summary["parameters"], summary.get("states", {})
        bare = cls(as_kept(parameters), model_name(summary.get("model", DEFAULT_MODEL)), None, None, None)
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
        used = {*bare._numbers(), "headline", "failure", "interrupted", "notes", "cautions", "outputs", "finger"}
        changed = [*(each.name for each in fields(Errors)), *(each.name for each in bare.outputs)]
        used |= {f"{name}_{key}_{kind}" for name in STATES for key in changed for kind in CHANGES}
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
        foreign(folder)
        try:
            summary = read_object(folder / "summary.json")
            if set(summary) == {"failure"}:
                raise SceneError(f"the run in {name} was refused and has no results: {summary['failure']}")
            refuse_other_format(summary, f"the run in {name}")
            found = cls.from_dict(summary, folder)
            if (kept := dataset.read(folder, [each.name for each in found.outputs])) is not None:
                ways = {name: state.reached for name, state in found.named.items()}
                named = {name: replace(s, reached=ways.get(name, PATH)) for name, s in kept[1].items()}
                found = replace(found, steps=kept[0], **named)  # type: ignore[arg-type]
            elif (folder / "steps.csv").exists():
                found = replace(found, steps=steps_of(folder))
            if not found.steps:
                return found  # of no path, or of one without an accepted step
            stable = [load.get("stable") for load in summary.get("loads", ())]
            return replace(found, loads=_loads(found.scene, found.steps, stable))
        except (OSError, ValueError, KeyError, TypeError, AttributeError, csv.Error) as error:  # JSON of other things
            if isinstance(error, SceneError) and name in str(error):
                raise
            if isinstance(error, FileNotFoundError | NotADirectoryError) and not (folder / "summary.json").exists():
                raise SceneError(f"{name} is not a folder of a finished run") from None
            raise SceneError(f"run {name} cannot be read: its files are not whole, or not of a run ({error})") from None

    def __str__(self) -> str:
        """Return the text *Result* at the end of a run: the named states side by side, with units and errors."""
        return printing.text(self, f"{self.headline}")

    __repr__ = __str__
    """In a console, too: the values of all steps are hundreds of pages."""

    def _repr_html_(self) -> str:
        """Return the text for a notebook: headline, tables, and remarks to unfold."""
        return printing.page(self, f"{self.headline}")


def _loads(scene: "Scene", steps: Sequence[ContactState], stable: Sequence[bool | None]) -> tuple[LoadResult, ...]:
    """Return the result of each load, with the stability of its end as far as that is known."""
    known = (*stable, *[None] * (len(scene.loads()) + 1))
    return tuple(load_results(steps, scene.loads(), lambda k, end: known[k], coefficient(scene)))


def steps_of(folder: Path) -> tuple[ContactState, ...]:
    """Return the states of ``steps.csv`` of a folder; a last row that is cut short is left out.

    Raises:
        OSError: there is no such file.
        ValueError: it is not of a run.
    """
    rows = csv.DictReader(io.StringIO(read(folder / "steps.csv").decode(), newline=""))
    return tuple(ContactState.from_row(row) for row in rows if None not in row.values())


def _state(name: str, kept: Mapping[str, Any]) -> ContactState:
    """Return a named state of ``summary.json``.

    Args:
        name: of the state.
        kept: its values and errors.
    """
    values = {key: value for key, value in kept.items() if key not in CHANGES and value is not None}
    texts = ("load", "reached")
    if wrong := [key for key, value in values.items() if not isinstance(value, int | float) and key not in texts]:
        raise TypeError(f"{wrong[0]} of {name} is no number")
    more: dict[str, Any] = {kind: Errors.of(kept.get(kind, {})) for kind in CHANGES}
    more |= {key: values.pop(key) for key in (*STABILITY, "reached") if key in values}
    slip = {"all_slip": True, "slip_held": True} if name == "full_slip" else {}
    return replace(ContactState.from_row({"mu_app": math.nan} | values | slip), **more)
