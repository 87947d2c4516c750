"""Finished runs as arrays, from their folders; runs that are missing are computed; scenes that several studies run."""

from collections.abc import Hashable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fingerpad.model.options import by_rule
from fingerpad.results.dataset import OF_RIDGES, OF_SITES
from fingerpad.results.fields import views_of
from fingerpad.results.result import Result
from fingerpad.runs import batch
from fingerpad.scene import Scene, from_data
from variational.state import ContactState

Array = NDArray[np.float64]
VOLTAGES = (0.0, 50.0, 100.0, 150.0, 200.0)
FORCES = (5.0, 10.0, 25.0, 50.0, 75.0, 100.0, 120.0, 150.0)  # N/m
SITES = 20e-6  # m, size at the Merkel sites: coarser than the default of 5 um; energy densities come out 12 % low
_LIMIT = 3600.0  # s of processor time for one run; the sine takes longest
Name = TypeVar("Name", bound=Hashable)


class Unfinished(FileNotFoundError):
    """A run is not there or did not reach its end."""


class Run:
    """A run of ``scene`` in a sweep's folder that reached its end; numbers in SI."""

    def __init__(self, scene: Scene, out: Path) -> None:
        """Open a run; Unfinished if it has not been run or did not reach its end."""
        summary = batch.result(scene, out)
        if summary is None or "failure" in summary:
            why = "is not there" if summary is None else str(summary["failure"])
            raise Unfinished(f"run {out / batch.key(scene)} did not reach its end: {why}")
        self.scene, self.folder, self.summary = scene, out / batch.key(scene), summary

    @cached_property
    def result(self) -> Result:
        """The result of the run."""
        return Result.load(self.folder)

    @cached_property
    def steps(self) -> dict[str, NDArray[Any]]:
        """Columns of the accepted steps, shape (steps,); ``load`` is the name of the load that each belongs to."""
        rows = [state.row() for state in self.result.steps]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}

    @cached_property
    def ridges(self) -> dict[str, NDArray[Any]]:
        """Columns of the ridges in contact, one row a step and ridge."""
        return _ridges(self.result.steps)

    @cached_property
    def receptors(self) -> dict[str, Array]:
        """Strain energy density at the receptors (J/m^3), columns of shape (steps, ridges); ``ridge`` has (ridges,)."""
        columns, count = _sites(self.result.steps), len(self.result.steps)
        return {k: v.reshape(count, -1) if k != "ridge" else v[: len(v) // count] for k, v in columns.items()}

    def row(self, state: str) -> int:
        """Return the row in :attr:`steps` of ``uncharged``, ``charged`` or ``full_slip``, as in ``summary.json``."""
        return int(np.flatnonzero(self.steps["step"] == self.summary[f"{state}_step"])[0])

    pressed = property(lambda self: self.row("uncharged"), doc="Row of uncharged normal contact.")
    charged = property(lambda self: self.row("charged"), doc="Row of charged normal contact.")
    full_slip = property(lambda self: self.row("full_slip"), doc="Row of full slip.")

    def on_ridges(self, row: int, name: str) -> tuple[Array, Array]:
        """Return numbers and a value of the ridges in contact in a row of :attr:`steps`."""
        mine = self.ridges["step"] == self.steps["step"][row]
        return self.ridges["ridge"][mine], self.ridges[name][mine]

    def final(self, state: str, table: str) -> dict[str, NDArray[Any]]:
        """Return a named state's rows of ``ridges`` or ``receptors``, on the final mesh where there are two meshes."""
        if state not in self.result.named:
            raise FileNotFoundError(f"run {self.folder.name} has no {table} of {state}")
        return {"ridges": _ridges, "receptors": _sites}[table]([self.result.named[state]])

    def arrays(self, name: str) -> dict[str, NDArray[Any]]:
        """Return the arrays of ``surface``, or of ``finger_LOAD``; FileNotFoundError if the run did not keep them."""
        loads, states = views_of(self.folder, self.result.steps, self.result.named)
        found: dict[str, Any] = {}
        if name == "surface":
            for state, view in states.items():
                skin: Any = view.skin or {}
                found |= {f"{state}_{key}": values for key, values in skin.items()}
        elif (end := loads.get(name.removeprefix("finger_"))) is not None and end.snapshot is not None:
            found = vars(end.snapshot) | ({} if end.merkel is None else {"merkel": end.merkel})
        if not found:
            raise FileNotFoundError(f"run {self.folder.name} has no arrays of {name}: run it again in a new folder")
        return found


def _ridges(states: Sequence[ContactState]) -> dict[str, NDArray[Any]]:
    """Return the columns of ridges in contact, one row a state and ridge."""
    found: dict[str, list[Any]] = {}
    for state in states:
        if (each := state.ridges) is not None:
            touches, names = each.length > 0, {name: key for name, key in OF_RIDGES.items() if name != "note"}
            columns = {name: getattr(each, key)[touches] for name, key in names.items()}
            columns |= {"step": np.full(touches.sum(), state.step), "ridge": each.number[touches]}
            for name, values in columns.items():
                found.setdefault(name, []).append(values)
    return {name: np.concatenate(values) for name, values in found.items()}


def _sites(states: Sequence[ContactState]) -> dict[str, NDArray[Any]]:
    """Return the columns of receptor sites, one row a state and ridge."""
    every = [state.sites for state in states if state.sites is not None]
    columns = {"ridge": "number"} | OF_SITES
    return {name: np.concatenate([getattr(each, attribute) for each in every]) for name, attribute in columns.items()}


def known(scene: Scene, out: Path) -> bool:
    """Return whether a folder has a scene's run to its end."""
    try:
        Run(scene, out)
    except Unfinished:
        return False
    return True


def computed(scenes: Mapping[Name, Scene], out: Path, jobs: int) -> dict[Name, Run]:
    """Return runs by name, of which those that are missing in a folder are computed.

    Raises:
        Unfinished: one did not reach its end.
    """
    named = {_words(name): scene for name, scene in scenes.items()}
    batch.sweep(named, out, jobs, _LIMIT)
    return {name: Run(scene, out) for name, scene in scenes.items()}


def _words(name: Hashable) -> str:
    """Return the name of a run on the screen: of a force and a voltage, of a voltage, or a word."""
    if isinstance(name, tuple):
        return f"{name[0]:g} N/m, {name[1]:g} V"
    return f"{name:g} V" if isinstance(name, float) else str(name)


def plain(data: Mapping[str, Any]) -> Scene:
    """Return a scene, with a number of ridges that can touch."""
    return by_rule(from_data(data))


def trace(f_ext: float, voltage: float, size: float, **more: Any) -> Scene:
    """Return the default finger pressed (N/m), charged (V) and slid, with a contact size (m) and more of its tables."""
    return plain({"f_ext": f_ext, "voltage": voltage, "mesh": {"contact": size, "receptor": SITES}} | more)


def finished(scene: Scene, out: Path) -> Run | None:
    """Return a run that reached full slip, None where there is none."""
    try:
        run = Run(scene, out)
    except FileNotFoundError:
        return None
    return run if run.summary["full_slip"] else None
