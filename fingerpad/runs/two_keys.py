"""A quantity at full slip over two keys of a scene, by the closed form: what a heat map is drawn from.

The closed form is the model "cylinders" (:mod:`fingerpad.reduced.cylinders`), by the state of full slip alone
(:mod:`fingerpad.runs.closed_form`). A target (:mod:`fingerpad.runs.target`) is a line on the map: the places at which
the quantity has its value.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingerpad.reduced import cylinder_errors
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.runs.axis import Axis, axis, refuse_many
from fingerpad.runs.closed_form import ClosedForm
from fingerpad.runs.target import Target, read
from fingerpad.scene import Scene, value_of, with_values
from fingerpad.scene.messages import SceneError, clip

COUNT = 11
"""Values of a key without a range of its own."""
Array = NDArray[np.float64]
Over = Mapping[str, Sequence[float | str]]
"""Values by key, in SI or as texts with a unit; none for :data:`COUNT` of the default range."""
Point = tuple[int, ...]
Points = Sequence[Point]


@dataclass(frozen=True, eq=False)
class TwoKeys:
    """A quantity over two keys; arrays have shape (values of the first key, values of the second key)."""

    target: Target
    """The quantity, and the value that is drawn as a line."""
    axes: tuple[Axis, Axis]
    scene: Scene
    """With all other keys."""
    keys: tuple[list[float], list[float]]
    """Values of the keys (SI)."""
    values: Array
    """Of the quantity (SI); NaN where there is no answer."""
    reached: Array
    """The quantity as the target has it: in SI, or over its value without voltage."""
    known: NDArray[np.bool_]
    """Whether the error of the closed form is known there, for this quantity."""
    lost: tuple[str, ...]
    """Why there is no answer, a sentence for each such place."""

    @property
    def crossed(self) -> bool:
        """Whether the target's value is between those of the map."""
        return bool(np.nanmin(self.reached) <= self.target.value <= np.nanmax(self.reached))

    def rows(self) -> Iterator[dict[str, float]]:
        """Yield the values of both keys and of the quantity (SI), and 1 where its error is known, else 0."""
        names = (self.axes[0].key, self.axes[1].key)
        for j, one in enumerate(self.keys[0]):
            for k, other in enumerate(self.keys[1]):
                value = {} if np.isnan(self.values[j, k]) else {self.target.quantity.name: float(self.values[j, k])}
                yield dict(zip(names, (one, other), strict=True)) | value | {"error_known": float(self.known[j, k])}


def two_keys(scene: Scene, over: Over, target: str = "", watch: Callable[[Points], Iterable[Point]] = iter) -> TwoKeys:
    """Return a quantity at full slip over two keys.

    Args:
        scene: all other keys. Without a ``force`` it gets the one whose centre bears ``f_ext``, unless ``f_ext`` is
            varied: quantities are then those of the section.
        over: values by key, of two keys that a search may vary (:mod:`fingerpad.runs.axis`).
        target: a quantity and its value, as :func:`fingerpad.runs.target.read` takes it; by default µ_app, without a
            line.
        watch: goes through the places of the points, as a progress bar does.

    Raises:
        SceneError: no pair of keys, too many points, an impossible key, value or target, or a map without any answer.
    """
    if len(over) != 2:
        count = f"{len(over)} keys are" if len(over) > 1 else "one key is"
        raise SceneError(f"{count} varied; a map is over two, and fingerpad sweep varies any number")
    if {"f_ext", "force"} <= set(over):
        raise SceneError("f_ext and force are both varied; give one of the two, and another key")
    form, scene = ClosedForm(Cylinders()), scene.resolved()
    form.model.check(scene)
    whole = "f_ext" not in over
    if whole and "force" not in over and scene.force is None:
        scene = scene.replace(force=form.newtons(scene))
    if not whole:
        scene = scene.replace(force=None)
    goal = read(target or "mu_app=1", whole)
    if goal.whole != whole:
        raise SceneError(f"{goal.name} is a quantity of the {'section' if whole else 'whole finger'}, "
                         f"and the map is of the {'whole finger' if whole else 'section'}; "
                         f"{'vary f_ext' if whole else 'vary force'} for it")  # fmt: skip
    axes = [axis(scene, key, _ends(key, values)) for key, values in over.items()]
    keys = [_values(scene, each, over[each.key]) for each in axes]
    found = _Map(scene, goal, (axes[0], axes[1]), (keys[0], keys[1]), form)
    refuse_many(len(keys[0]) * len(keys[1]), "map")
    return found.made(watch)


def _ends(key: str, values: Sequence[float | str]) -> Sequence[float | str] | None:
    """Return the first and the last value; None without a range."""
    if not values:
        return None
    if len(values) < 2:
        raise SceneError(f"{clip(key)} has one value; a map needs at least two")
    return values[0], values[-1]


def _values(scene: Scene, axis: Axis, given: Sequence[float | str]) -> list[float]:
    """Return the values of a key (SI), of its default range where none is given.

    Raises:
        SceneError: one that the key cannot have, or values that do not grow.
    """
    if not given:
        places = np.linspace(axis.place(axis.low), axis.place(axis.high), COUNT)
        return [axis.low, *(float(f"{axis.value(x):.6g}") for x in places[1:-1]), axis.high]
    found = [float(value_of(with_values(scene, {axis.key: each}), axis.key)) for each in given]
    if any(b <= a for a, b in zip(found, found[1:], strict=False)):
        raise SceneError(f"the values of {axis.key} do not grow; give each once, the smallest first")
    return found


@dataclass(frozen=True)
class _Map:
    """A map while it is made."""

    scene: Scene
    target: Target
    axes: tuple[Axis, Axis]
    keys: tuple[list[float], list[float]]
    form: ClosedForm

    def made(self, watch: Callable[[Points], Iterable[Point]]) -> TwoKeys:
        shape = (len(self.keys[0]), len(self.keys[1]))
        values, reached, known = np.full(shape, np.nan), np.full(shape, np.nan), np.zeros(shape, dtype=bool)
        lost, base = list[str](), dict[tuple[float, ...], float]()
        for j, k in watch([*np.ndindex(shape)]):
            at = (self.keys[0][j], self.keys[1][k])
            try:
                scene = with_values(self.scene, dict(zip((axis.key for axis in self.axes), at, strict=True)))
                names = [self.target.quantity.name, "f_electrostatic"]
                values[j, k], attraction = self.form.values(scene, names, self.target.whole)
                known[j, k] = names[0] in cylinder_errors.at_full_slip(scene, attraction)
                reached[j, k] = values[j, k] / self._base(scene, at, base)
            except SceneError as error:
                words = " and ".join(f"{axis.key} {axis.shown(v)}" for axis, v in zip(self.axes, at, strict=True))
                lost.append(f"At {words}: {error}.")
        if len(lost) == values.size:
            raise SceneError(lost[0].partition(": ")[2].rstrip("."))
        return TwoKeys(self.target, self.axes, self.scene, self.keys, values, reached, known, tuple(lost))

    def _base(self, scene: Scene, at: tuple[float, float], found: dict[tuple[float, ...], float]) -> float:
        """Return the quantity without voltage, on which voltage and coating have no influence; 1 if it is not asked."""
        if not self.target.relative:
            return 1.0
        electric = [each.key.startswith(("voltage", "electric.")) for each in self.axes]
        others = tuple(value for value, is_electric in zip(at, electric, strict=True) if not is_electric)
        if others not in found:
            found[others] = self.form.value(scene.replace(voltage=0.0), self.target.quantity, self.target.whole)
        return found[others] or np.nan  # nothing has no multiple
