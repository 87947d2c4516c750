"""Result of a model: the states of a run by name and in order, their errors and costs, as values, text and one file."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fingerpad import launcher
from fingerpad.results import dataset, loading, printing
from fingerpad.results.headline import BAND, KNOWN, Headline, headline
from fingerpad.results.outputs import checked, valued
from fingerpad.results.quantities import (
    MESH,
    MODEL,
    PENALTY,
    QUANTITIES,
    Output,
)
from fingerpad.results.states import STATES, LoadResult
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.remarks import coefficient
from variational.state import ContactState

if TYPE_CHECKING:
    import pyvista
    import xarray
    from matplotlib.figure import Figure

    from fingerpad.afferents.afferent import Afferent
    from fingerpad.results.drawing import Drawing
    from fingerpad.results.fields import StateFields
    from fingerpad.results.spikes import Spikes
    from fingerpad.scene import Scene
    from fingerpad.slices.finger import WholeFinger

KINDS = ("surface", "finger", "history", "footprint", "time", "field", "solid")
"""Pictures of a result."""
MODEL_ERROR = "model_error"
"""Key of a cheaper model's known errors in a result's record."""


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
class Result:
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
    cautions: tuple[str, ...] = ()
    """Why the numbers may be further off than their errors say: limits of validity that the scene reaches."""
    record: dict[str, Any] = field(default_factory=dict)
    """All else, ready for JSON: omissions, restarts, refinement, laws, provenance."""
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
    def known(self) -> dict[str, Any]:
        """Band of µ_app at full slip over the scene's assumptions: ``low``, ``high`` and ``parts``, the largest first.

        Each part has ``name``, ``low`` and ``high``. ``high`` is None where the upper end is open: a closure has no
        number there; ``low`` too where it is the result's own one. Empty without friction under a voltage.
        """
        return dict(self.record.get(KNOWN, {}))

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

    # -- pictures and fields ---------------------------------------------------------------------------
    def _drawn(self) -> "Drawing | None":
        """Return what pictures are drawn from, of a result that was read from its folder; None off rank 0."""
        if self.drawing is None and self.steps and self.folder is not None and launcher.rank() == 0:
            from fingerpad.results.drawing import read  # Matplotlib

            mu_0 = None if "laws" in self.record.get("parameters", {}) else coefficient(self.scene)
            return read(self.folder, self.steps, self.named, mu_0)
        return self.drawing

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
    def fields(self) -> "StateFields":
        """Displacement, stress, strain and energy density inside the finger, by load or named state; on rank 0.

        A load's name stands for its end. Named states are those of the mesh that their numbers are of. Empty for
        models without a mesh, and on other ranks.
        """
        from fingerpad.results.fields import StateFields

        drawing = self._drawn()
        return StateFields({} if drawing is None else drawing.fields(), self.model)

    def to_pyvista(self) -> "pyvista.MultiBlock":
        """Return :attr:`fields` as blocks of PyVista, each a grid of the unloaded finger in m.

        Raises:
            ImportError: PyVista is not installed.
            ValueError: there are no fields.
        """
        return self.fields.to_pyvista()

    @property
    def headline(self) -> Headline:
        """The finding: a sentence, one number with the error of its solution, and what it is of.

        It is of the whole finger wherever ``finger`` is known, else of the middle section, which a history has alone.
        """
        return headline(self)

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
        loads = loading.loads_of(self.scene, steps, [load.stable for load in self.loads])
        kept = tuple(each for each in self.outputs if each.name not in {one.name for one in new})
        return replace(self, steps=steps, loads=loads, outputs=(*kept, *new), **named)

    # -- files -----------------------------------------------------------------------------------------
    def to_xarray(self) -> "xarray.Dataset":
        """Return all of the result as one dataset with units, as ``result.nc`` has it."""
        return dataset.dataset(self)

    @classmethod
    def from_xarray(cls, data: "xarray.Dataset", folder: Path | None = None) -> "Result":
        """Return the result of a dataset of :meth:`to_xarray`, which may be that of a folder.

        Raises:
            SceneError: it is not of a result.
        """
        return cls(**loading.parts(data, Cost), folder=folder)

    @classmethod
    def load(cls, folder: str | Path) -> "Result":
        """Return the result of a run from ``result.nc`` in its folder.

        Raises:
            SceneError: the folder holds no result that can be read.
        """
        data, name = loading.read(Path(folder)), clip(str(folder), 80)
        try:
            return cls.from_xarray(data, Path(folder))
        except SceneError as error:
            raise error if name in str(error) else SceneError(f"run {name} cannot be read: {error}") from None

    def to_dict(self, headline: bool = True) -> dict[str, Any]:
        """Return the content of ``summary.json``, flat and ready for JSON, by default with the headline; SI units.

        Quantities of named states begin with the state's name, ``full_slip_mu_app``, and those of the whole finger
        with that and ``finger``: ``full_slip_finger_f_t``.
        """
        return ({"headline": self.headline.to_dict()} if headline else {}) | dataset.summary(self)

    def __str__(self) -> str:
        """Return the text *Result* at the end of a run: the named states side by side, with units and errors."""
        return printing.text(self, f"{self.headline}")

    __repr__ = __str__
    """In a console, too: the values of all steps are hundreds of pages."""

    def _repr_html_(self) -> str:
        """Return the text for a notebook: headline, tables, and remarks to unfold."""
        return printing.page(self, f"{self.headline}")
