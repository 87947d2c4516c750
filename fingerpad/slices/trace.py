"""What one slice bears over its indentation, from states of the cross-section at growing forces."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from fingerpad.results.quantities import SLICES, Output, in_table
from fingerpad.scene.messages import SceneError
from variational.state import ContactState

Array = NDArray[np.float64]
NAMES = tuple(in_table("trace", SLICES))
"""Columns of every trace: N/m the forces, m the lengths. Others are of outputs with a rule of sums."""
ADHESION = "f_adhesion"
"""A further column, of skin that adheres without a voltage (N/m)."""
LEAST = 3
"""Least number of points of a trace. A power law needs two, and the error of the interpolation leaves one out."""
_NO_FORCE = 1e-12  # of the largest external force: values below it are roundoff
_SAME_POINT = 1e-4  # relative distance of two points: slopes of closer ones are made by solvers' tolerances (1e-6)


class TraceError(SceneError):
    """States of which no trace can be made; one sentence."""


def refuse_floating(states: Iterable[ContactState], model: str) -> None:
    """Refuse states of a model that do not have the height of their bone.

    Raises:
        TraceError: one has none.
    """
    if any(np.isnan(state.bone_height) for state in states):
        raise TraceError(
            f"the model {model!r} gives its states no bone_height, which forces in newtons on the whole finger need; "
            "give f_ext in place of force, or the model's states a bone_height"
        )


@dataclass(frozen=True)
class Trace:
    """One slice over its indentation: power laws between points, by monotone cubics in logarithms.

    So forces grow with the indentation, and a power law such as Hertz's is interpolated to roundoff. Below the first
    point the power law of the first two goes on: to no force at no indentation. Friction is interpolated as its ratio
    to the contact force, which is the friction coefficient under Coulomb's law; then the sum's friction is the
    coefficient times the sum's contact force to roundoff.
    """

    depth: Array
    """Indentations (m), growing, greater than 0; shape (points,)."""
    columns: dict[str, Array]
    """By :data:`NAMES` and the names of :attr:`own`; shape (points,)."""
    ridges: Array | None = None
    """Ridges in contact at the points, shape (points,); None where a trace is not known to be smooth between two points
    with the same ridges."""
    own: tuple[Output, ...] = ()
    """Outputs of one's own that have a column, none of both signs."""

    def __post_init__(self) -> None:
        """Refuse what is no trace.

        Raises:
            TraceError: less than two points, or depths or forces that do not grow.
        """
        force = self.columns["f_ext"]
        grows = len(self.depth) > 1 and bool(np.all(np.diff(self.depth) > 0) and np.all(np.diff(force) > 0))
        if not (grows and self.depth[0] > 0 and force[0] > 0):
            raise TraceError(
                f"a trace has {len(self.depth)} points; it must have two at least, with indentations and forces that "
                "are greater than 0 and grow"
            )

    @property
    def end(self) -> tuple[float, float]:
        """The last indentation (m) and its external force (N/m)."""
        return float(self.depth[-1]), float(self.columns["f_ext"][-1])

    def halves(self) -> tuple["Trace", "Trace"]:
        """Return the trace on every second point, the even and the odd ones, each with both ends."""
        every, last = np.arange(len(self.depth)), len(self.depth) - 1
        ends = (every == 0) | (every == last)
        return self._on(ends | (every % 2 == 0)), self._on(ends | (every % 2 == 1))

    def later(self) -> "Trace":
        """Return the trace from twice its first indentation, or on its last two points."""
        return self._on((self.depth >= 2 * self.depth[0]) | (np.arange(len(self.depth)) >= len(self.depth) - 2))

    def _on(self, kept: NDArray[np.bool_]) -> "Trace":
        columns = {name: values[kept] for name, values in self.columns.items()}
        return Trace(self.depth[kept], columns, None if self.ridges is None else self.ridges[kept], self.own)

    def at(self, depth: Array) -> dict[str, Array]:
        """Return the columns at indentations (m); nothing where a slice does not touch, at 0 and less.

        Raises:
            TraceError: an indentation beyond the last one.
        """
        depth = np.asarray(depth, dtype=float)
        if np.any(depth > self.depth[-1] * (1 + 1e-12)):
            raise TraceError(
                f"an indentation of {depth.max():.4g} m is beyond the trace, which ends at {self.depth[-1]:.4g} m "
                f"under {self.end[1]:.4g} N/m"
            )
        touches, first = depth > 0, np.log(self.depth[0])
        at = np.log(depth, where=touches, out=np.full_like(depth, first))
        names, cubics, slopes, there = self._powers
        values = np.exp(cubics(np.clip(at, first, np.log(self.depth[-1]))).T)
        values = np.where(touches, there * values * np.exp(slopes * np.minimum(at - first, 0.0)), 0.0)
        found = dict(zip(names, values, strict=True))
        return found | {"f_t": found.pop("f_t/f_c") * borne(found)}

    def under(self, force: float) -> float:
        """Return the indentation (m) at an external force (N/m) between the first point and the end."""

        def excess(x: float) -> float:
            return float(np.log(self.at(np.exp([x]))["f_ext"][0] / force))

        return float(np.exp(brentq(excess, *np.log(self.depth[[0, -1]]), xtol=1e-14)))

    @cached_property
    def _powers(self) -> tuple[list[str], PchipInterpolator, Array, Array]:
        """Names of the columns, logarithms of their amounts over that of the indentation, slopes below it, and signs.

        The sign of a column that is zero is 0.
        """
        columns = self.columns | {"f_t/f_c": self.columns["f_t"] / borne(self.columns)}
        names = [name for name in columns if name != "f_t"]
        slopes = {name: self._slope(abs(columns[name])) for name in names} | {"f_t/f_c": 0.0}
        # No shorter contact than one in which the mean pressure falls with the forces, and no other length within it.
        forces = [slopes[name] for name in ("f_ext", "f_electrostatic") if columns[name].any()]
        slopes["contact_length"] = min(slopes["contact_length"], *forces)
        for name in ("gross_width", *(each.name for each in self.own if each.si == "m")):
            slopes[name] = min(slopes[name], slopes["contact_length"])
        values = np.array([columns[name] for name in names])
        least = np.array([[0.0 if name in {each.name for each in self.own} else _NO_FORCE] for name in names])
        most = abs(values).max(axis=1, keepdims=True)
        signs = np.sign(values.sum(axis=1, keepdims=True)) * (most > least * columns["f_ext"].max())
        cubics = PchipInterpolator(np.log(self.depth), np.log(np.maximum(abs(values), np.finfo(float).tiny)).T)
        return names, cubics, np.array([[slopes[name]] for name in names]), signs

    def _slope(self, values: Array) -> float:
        """Return the exponent of the power law of the first two points; 0 where values fall, or are 0."""
        if values[0] <= 0 or values[1] <= 0:
            return 0.0
        return max(float(np.log(values[1] / values[0]) / np.log(self.depth[1] / self.depth[0])), 0.0)


def borne(columns: dict[str, Array]) -> Array:
    """Return what slices bear of a trace's columns (N/m): force, electrostatic attraction, and adhesion if there."""
    return columns["f_ext"] + columns["f_electrostatic"] + columns.get(ADHESION, 0.0)


def trace(
    states: Iterable[ContactState], wavelength: float, smooth: bool = False, outputs: Iterable[Output] = ()
) -> Trace:
    """Return the trace of a cross-section.

    Args:
        states: of one kind: uncharged, charged, or at full slip. States without contact and those that go back, as
            behind a jump, are left out; so are repetitions up to the tolerances of solvers, of which full slip under a
            constant force has several.
        wavelength: of a ridge (m).
        smooth: whether states with the same ridges in contact are on one smooth curve.
        outputs: of one's own; see :func:`columns`.

    Raises:
        TraceError: less than :data:`LEAST` states are left.
    """
    kept: list[ContactState] = []
    for state in sorted(states, key=lambda state: state.f_ext):
        depth, force = (-kept[-1].bone_height, kept[-1].f_ext) if kept else (0.0, 0.0)
        deeper, more = -state.bone_height > depth * (1 + _SAME_POINT), state.f_ext > force * (1 + _SAME_POINT)
        if state.contact_length > 0 and deeper and more:
            kept.append(state)
    if len(kept) < LEAST:
        raise TraceError(
            f"{len(kept)} states with growing indentation and force are no trace, which must have {LEAST} at least"
        )
    ridges = np.array([float(state.ridges_in_contact) for state in kept]) if smooth else None
    found = columns(kept, wavelength, outputs := tuple(outputs))
    own = tuple(each for each in outputs if each.name in found)
    return Trace(np.array([-state.bone_height for state in kept]), found, ridges, own)


def columns(states: Sequence[ContactState], wavelength: float, outputs: Iterable[Output] = ()) -> dict[str, Array]:
    """Return the columns of a trace by name, shape (states,).

    Outputs with a rule of sums have a column, unless a state lacks what is needed, or values have both signs.
    """
    found = {name: [abs(getattr(state, name)) for state in states] for name in NAMES if name != "gross_width"}
    found["gross_width"] = [gross_width(state, wavelength) for state in states]
    if not any(np.isnan(state.f_adhesion) for state in states):
        found[ADHESION] = [state.f_adhesion for state in states]
    for each in outputs:
        with suppress(SceneError):
            values = [each.of(state) for state in states] if each.sum and each.compute else [np.nan]
            if np.isfinite(values).all() and (min(values) >= 0 or max(values) <= 0):
                found[each.name] = values
    return {name: np.array(values, dtype=float) for name, values in found.items()}


def gross_width(state: ContactState, wavelength: float) -> float:
    """Return the width (m) between the outer edges of the outermost touching ridges, a wavelength (m) apart.

    Half a ridge's mean contact length lies beyond their middles on either side.
    """
    if state.ridges_in_contact == 0:
        return 0.0
    apart = state.ridges_in_contact - 1
    if state.ridges is not None:
        touching = state.ridges.number[state.ridges.length > 0]
        apart = int(touching[-1] - touching[0])
    return apart * wavelength + state.contact_length / state.ridges_in_contact
