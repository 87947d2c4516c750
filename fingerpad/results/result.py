"""Result of a model: the states of a run by name and in order, their errors and costs, as values, text and one file."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad import launcher
from fingerpad.results import dataset, loading, printing, slopes
from fingerpad.results.data import ResultData, checked, valued
from fingerpad.results.headline import Headline, headline
from fingerpad.results.quantities import Output
from fingerpad.results.states import load_results
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.remarks import coefficient

if TYPE_CHECKING:
    import pyvista
    import xarray
    from matplotlib.figure import Figure

    from fingerpad.afferents.afferent import Afferent
    from fingerpad.results.fields import StateFields
    from fingerpad.results.pictures.drawing import Drawing
    from fingerpad.results.spikes import Spikes

_KINDS = ("surface", "finger", "history", "footprint", "time", "field", "solid")
"""Pictures of a result."""


@dataclass(frozen=True, eq=False, repr=False)
class Result(ResultData):
    """Result of a model for a scene: what it holds, with pictures, text and one file."""

    # -- pictures and fields ---------------------------------------------------------------------------
    def _drawn(self) -> "Drawing | None":
        """Return what pictures are drawn from, of a result that was read from its folder; None off rank 0."""
        if self.drawing is None and self.steps and self.folder is not None and launcher.rank() == 0:
            from fingerpad.results.pictures.drawing import read  # Matplotlib

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
        if kind not in _KINDS:
            raise ValueError(f"kind is {kind!r}; it must be one of {', '.join(_KINDS)}")
        if kind in ("footprint", "solid"):
            if self.finger is None:
                raise ValueError("the result has no whole finger to draw: a history has none, else a note says why")
            from fingerpad.results.pictures.solid import draw  # Matplotlib

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
        from fingerpad.results.spikes import afferents  # SciPy's signals

        return afferents(self, laws)

    def sensitivities(self, quantity: str = "mu_app", state: str = "") -> "xarray.Dataset":
        """Return the derivatives of a quantity by every number of the scene, the largest elasticities first.

        They are those of the equations, without a second run (:mod:`variational.sensitivity`), for the points in
        contact as they are. A number without effect has the slope 0.

        Args:
            quantity: ``mu_app``, ``f_t``, ``f_electrostatic``, ``contact_length``, ``p_max``, and ``bone_height`` under
                a force or ``f_ext`` under a prescribed height.
            state: a named state; by default full slip.

        Returns:
            Along ``number``, the dotted keys: ``value``, ``slope`` (SI), ``elasticity`` (% per %), and ``lowest`` and
            ``highest``, between which the same ridges touch, by straight extrapolation.

        Raises:
            SceneError: the run was without ``output.sensitivities``, or the state or quantity has no slopes.
        """
        return slopes.dataset(self, quantity, state)

    def animate(self, path: "str | Path") -> Path:
        """Write the run as a moving picture, WebP or GIF by the end of the file's name; return the file.

        Raises:
            SceneError: the run has no motion in its folder, or the name another ending.
        """
        from fingerpad.results.pictures.animation import animate  # Matplotlib

        return animate(self, Path(path))

    def with_outputs(self, outputs: Iterable[Output]) -> "Result":
        """Return the result with further outputs, computed from its states; files are not written again.

        Raises:
            SceneError: one is no output, or cannot be computed.
        """
        new = checked(outputs)
        named: dict[str, Any] = {name: valued(state, new) for name, state in self.named.items()}
        steps = tuple(valued(state, new) for state in self.steps)
        stable = {load.end.step: load.stable for load in self.loads}
        loads = load_results(steps, self.scene.loads(), lambda end: stable.get(end.step), coefficient(self.scene))
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
        return cls(**loading.parts(data), folder=folder)

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
