"""The values of keys at which quantities at full slip have targets, by the closed form and by the full model.

The closed form is the model "cylinders" (:mod:`fingerpad.reduced.cylinders`). One key is varied over its range, and
each crossing of the target is refined; several keys have one solution (:mod:`fingerpad.runs.roots`). From there the
full model goes on by Newton's method with the slopes of whole runs (:mod:`fingerpad.results.slopes`); without these,
with those of the closed form and with differences. Without an answer of the closed form it starts at the scene's own
values.

Quantities are those of the whole finger, as in the headline of a result; those of the middle section where ``f_ext`` is
varied, the target has a unit per metre, or the full model has no force. The closed form takes the force whose centre
bears ``f_ext`` where none is given.
"""

import math
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fingerpad import launcher
from fingerpad.reduced import press
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.reduced.model import Model
from fingerpad.results.data import Number
from fingerpad.results.quantities import FINGER, plus_minus_of
from fingerpad.results.result import Result
from fingerpad.results.slopes import rows
from fingerpad.runs import batch
from fingerpad.runs.context import RunContext
from fingerpad.runs.roots import EQUAL, TOLERANCE, Array, Axis, Roots, Target, newton
from fingerpad.runs.solve import checked, find, solved, stopped
from fingerpad.scene import Scene, value_of, with_values
from fingerpad.scene.messages import SceneError, show
from fingerpad.scene.remarks import drive_in_short, other_under_a_drive
from fingerpad.slices import errors

_STATE = "full_slip"


@dataclass(frozen=True)
class Root:
    """Values of the keys at which the quantities have their targets."""

    keys: tuple[float, ...]
    """In SI."""
    numbers: tuple[Number, ...]
    """The quantities with their errors; not relative."""
    margins: tuple[float, ...]
    """Errors of the keys (SI) by those of the quantities; NaN where these are not known."""
    scene: Scene
    """With the keys."""
    results: tuple[Result, ...]
    """Of each target."""


@dataclass(frozen=True)
class Solution:
    """All values of a key over its range, or values of several keys, at which quantities have their targets."""

    targets: tuple[Target, ...]
    axes: tuple[Axis, ...]
    scene: Scene
    roots: tuple[Root, ...]
    """In growing order of the key."""
    notes: tuple[str, ...]
    states: tuple[Result, ...] = ()
    """Of the full model, all that were computed."""

    @property
    def values(self) -> list[Any]:
        """The values of the key (SI); of several keys tuples of values."""
        return [root.keys if len(root.keys) > 1 else root.keys[0] for root in self.roots]

    def __str__(self) -> str:
        """Return the values of each key and the quantities there, with their errors."""
        of = [f"{t.quantity.words} of the {'whole finger' if t.whole else 'middle section'}" for t in self.targets]
        model = f"{len(self.states)} states of the full model" if self.states else "the closed form"
        lines = [
            f"{' and '.join(f'{each.words} = {each.shown(each.value)}' for each in self.targets)} over "
            f"{' and '.join(f'{axis.key} from {axis.shown(axis.low, axis.high)}' for axis in self.axes)}: "
            f"{' and '.join(dict.fromkeys(of))} at full slip, by {model}, under "
            f"{drive_in_short(each.scene for root in self.roots for each in root.results)}."
        ]
        for root in self.roots:
            keys = zip(self.axes, root.keys, root.margins, strict=True)
            values = ", ".join(f"{axis.key} = {axis.shown(value, error=margin)}" for axis, value, margin in keys)
            known = f", ± by the error of the {'model' if self.states else 'closed form'}"
            pairs = [(target.quantity, number) for target, number in zip(self.targets, root.numbers, strict=True)]
            shown = (f"{q.symbol} {q.shown(number.value, number.error)} {q.unit}".rstrip() for q, number in pairs)
            lines.append(f"  {values}{known * (root.margins[0] == root.margins[0])}: {', '.join(shown)}")
        return "\n".join([*lines, *other_under_a_drive(each.scene for each in self.roots), *self.notes])


def solve(
    scene: Scene | None = None,
    over: str | Sequence[str] = "voltage",
    *,
    at: Mapping[str, Sequence[Any]] | None = None,
    relative: bool = False,
    between: Sequence[Any] | None = None,
    model: str = Cylinders.name,
    **target: float | str | Sequence[float | str],
) -> Solution:
    """Return the values of a key at which a quantity at full slip has a target, or of several keys with as many.

    ``fp.solve(mu_app=0.4)`` is the voltage for a friction coefficient of 0.4. ``fp.solve(scene, ("friction",
    "electric.d_i"), f_t=("0.1 N", "0.2 N"), at={"voltage": (0, 200)})`` has a friction force without and one with a
    voltage.

    Args:
        scene: the scene; by default press, charge and slide of the default finger.
        over: the key that is varied, as in :func:`fingerpad.runs.sweep.sweep`, or several keys.
        at: values of other keys by dotted key, one for each target in order.
        relative: whether targets are multiples of the values without voltage: 2 for twice the friction.
        between: first and last value of the key, in SI or as texts with a unit, or such a pair for each of several
            keys; by default that of :data:`fingerpad.runs.roots.RANGES`, or a tenth to ten times the scene's value.
        model: a name of :data:`fingerpad.runs.solve.MODELS`. The full model meets targets to 1e-4 by whole runs; where
            it cannot, there is a warning and a note, and the root is the nearest state.
        **target: a quantity and its value, in SI or as a text with a unit, or several values: ``mu_app=0.4``,
            ``f_t="0.3 N"``.

    Returns:
        All values of the key in the range; of several keys one solution.

    Raises:
        SceneError: impossible targets, keys or ranges; a key without effect; or a target that is not reached in the
            range, with what is.
        KeyboardInterrupt, SystemExit: as of :func:`fingerpad.runs.solve.run`.
    """
    scene, way = checked(scene).resolved(), find(model)
    keys, given = _listed(over), [(name, each) for name, values in target.items() for each in _listed(values)]
    if not given or len(given) != len(keys):
        many = f"{len(given)} targets are given over {' and '.join(map(str, keys))}; give as many as keys"
        none = "no target is given; give a quantity and its value, such as mu_app=0.4"
        raise SceneError(many if given else none)
    if twice := [key for key in keys if keys.count(key) > 1 or key in (at or {})]:
        raise SceneError(f"{twice[0]} is varied, and is given once more; it must be there once")
    way.check(scene)
    if "voltage" in keys and scene.drive is not None:
        raise SceneError("voltage is a drive and over is voltage; give one of its keys, as voltage.rms")
    section = "f_ext" in keys
    newtons = "force" in keys or (scene.force is not None and not section)
    whole = not section and (newtons or not way.path) and set(target) <= set(FINGER)
    goals = [Target.of(*each, relative, whole, _state_of(at or {}, len(given), k)) for k, each in enumerate(given)]
    for goal in goals:
        kind, other = ("whole finger", "force") if goal.whole else ("section", "f_ext")
        why = f"over is {' and '.join(keys)}" if section or "force" in keys else "force is given"
        if section and goal.whole or newtons and not goal.whole:
            raise SceneError(f"{goal.quantity.symbol} is of the {kind} and {why}; give {other} in its place")
        if goal.whole != goals[0].whole:
            raise SceneError(f"{goal.quantity.symbol} is of the {kind} and {goals[0].words} is not; give both of one")
    pairs = [between] if len(keys) == 1 else _listed(between) if between else [None] * len(keys)
    if len(pairs) != len(keys):
        raise SceneError(f"between is {show(between)}; it must be a first and a last value for each of {show(keys)}")
    axes, notes = [Axis.of(scene, *pair) for pair in zip(keys, pairs, strict=True)], list[str]()
    if goals[0].whole and not newtons:
        uncharged = _solved(scene.replace(voltage=0.0), Cylinders())
        _number(uncharged, goals[0])  # refuses a finger that is too short
        assert uncharged.finger is not None
        force = uncharged.finger.f_ext
        bears = f"the section at the finger's centre then bears the scene's f_ext, {scene.f_ext:g} N/m, at full slip"
        notes.append(f"No force is given. It is {force:.4g} N: {bears}.")
        scene = scene.replace(force=force)
    elif not goals[0].whole and set(target) <= set(FINGER):
        notes.append(f"The whole finger has another value; {'vary' if section else 'give'} force for it.")
    return _Problem(scene, goals, axes, way).solution(notes)


def _listed(given: Any) -> list[Any]:
    return [*given] if isinstance(given, list | tuple) else [given]


def _state_of(at: Mapping[str, Any], count: int, k: int) -> dict[str, Any]:
    """Return the values of other keys of a target, the number k of a count; refuse another count of values."""
    if wrong := [key for key, values in at.items() if len(_listed(values)) != count]:
        key = wrong[0]
        raise SceneError(f"at {key} is {show(at[key])}; it must have one value for each target, {count} in all")
    return {key: _listed(values)[k] for key, values in at.items()}


def _solved(scene: Scene, model: Model) -> Result:
    """Return the result of a scene, of the closed form without its bands over assumptions."""
    result = solved(scene, model, RunContext(report=False))
    if result.failure:
        raise stopped(result) if result.interrupted else SceneError(result.failure)
    return result


def _number(result: Result, target: Target) -> Number:
    """Return the quantity of a target with its error.

    Raises:
        SceneError: the result has no full slip, or no whole finger.
    """
    if target.whole and result.finger is None:
        raise SceneError(result.notes[-1].partition(": ")[2])
    if _STATE not in (result.finger.states if target.whole and result.finger is not None else result.named):
        raise SceneError(f"the {'whole finger' if target.whole else 'section'} has no full slip with friction")
    return result.number(_STATE, target.quantity.name, target.whole)


class _NoStart(SceneError):
    """The closed form has no answer, or none that depends on a key."""


@dataclass
class _Problem:
    """Targets, and the keys that are varied for them; places are arrays, one of each key from 0 to 1."""

    scene: Scene
    targets: Sequence[Target]
    axes: Sequence[Axis]
    model: Model
    starts: bool = False
    """Whether it is the closed form from which a full model starts, for which no finger is pressed."""
    results: dict[str, Result] = field(default_factory=dict)
    """By the parameters of scenes, each computed once."""

    def solution(self, notes: list[str]) -> Solution:
        """Return the solution, with its notes after others.

        Raises:
            SceneError: the targets are not reached, with what is.
        """
        full, keys = self.model.path, [axis.key for axis in self.axes]
        closed = replace(self, model=Cylinders(), starts=True, results={}) if full else self
        unknown = np.full([len(keys)] * 2, math.nan)
        try:
            places, more = closed.places() if len(keys) == 1 else ([self._own()], [])
            found = [newton(closed.state, place, unknown, keys) for place in places]
        except SceneError as error:
            if not full or (len(keys) == 1 and not isinstance(error, _NoStart)):
                raise
            found, more = [(self._own(), unknown, "")], []
        if full:
            found, more = [newton(self.state, *each[:2], keys) for each in found], []
        missed = [f"Targets are not met to {TOLERANCE:g}: {self.reached(x)}; {why}." for x, _, why in found if why]
        if missed and not full:  # of several keys
            raise SceneError(f"{missed[0][0].lower()}{missed[0][1:-1]}")
        for text in missed if launcher.rank() == 0 else []:
            warnings.warn(text, stacklevel=3)
        roots = tuple(self._root(place, slopes) for place, slopes, _ in found)
        notes = [*(f"! {each}" for each in missed), *notes]
        for root in roots:  # the parts of its errors; where they are not known there is a caution
            notes += [plus_minus_of(each.parts) for each in root.numbers if each.error == each.error]
            notes += errors.remarks([root.scene.force or 0.0]) if self.targets[0].whole else []
            more += [f"! {caution}" for result in root.results for caution in result.cautions]
        states, every = tuple(self.results.values() if full else ()), tuple(dict.fromkeys([*notes, *more]))
        return Solution(tuple(self.targets), tuple(self.axes), self.scene, roots, every, states)

    # -- what is reached -----------------------------------------------------------------------------------
    def _at(self, place: Array, target: Target | None = None) -> Scene:
        values = {axis.key: axis.value(x) for axis, x in zip(self.axes, place, strict=True)}
        return with_values(self.scene, {**values, **(target.at if target else {})})

    def _result(self, scene: Scene) -> Result:
        """Return the result of a scene, with slopes where it can have them."""
        if (key := batch.key(scene)) not in self.results:
            if self.starts and press.known(scene) is None:
                raise SceneError("the finger has no press")
            if self.model.path:
                with suppress(SceneError):  # a scene that cannot have them
                    scene = scene.replace(output={"sensitivities": True})
            self.results[key] = _solved(scene, self.model)
        return self.results[key]

    def _values(self, target: Target, scene: Scene) -> Array:
        """Return a quantity and its derivatives by the keys, NaN where not known."""
        result, slopes = self._result(scene), dict[str, float]()
        value = _number(result, target).value
        if not target.whole:
            with suppress(SceneError):
                slopes = {row.key: row.slope for row in rows(result, target.quantity.name, _STATE)}
        return np.array([value, *(slopes.get(axis.key, math.nan) for axis in self.axes)])

    def _compared(self, target: Target, place: Array) -> Array:
        """Return the quantity, or its ratio to that without voltage, and the derivatives by the keys."""
        scene = self._at(place, target)
        found = self._values(target, scene)
        if not target.relative:
            return found
        base = self._values(target, scene.replace(voltage=0.0, electric=self.scene.electric))
        if base[0] == 0:
            raise SceneError(f"{target.quantity.symbol} is 0 without voltage, of which there is no multiple")
        ratio = found[0] / base[0]
        return np.array([ratio, *(found[1:] - ratio * base[1:]) / base[0]])

    def state(self, place: Array) -> tuple[Array, Array]:
        """Return relative distances from the targets, and their derivatives by the places."""
        found = np.array([self._compared(target, place) for target in self.targets])
        wanted = np.array([target.value for target in self.targets])
        scale = np.where(wanted == 0, 1.0, np.abs(wanted))
        by_place = [axis.slope(x) for axis, x in zip(self.axes, place, strict=True)]
        return (found[:, 0] - wanted) / scale, found[:, 1:] * by_place / scale[:, None]

    def reached(self, place: Array) -> str:
        """Return in words what is reached at a place."""
        at = " and ".join(f"{axis.key} {axis.shown(axis.value(x))}" for axis, x in zip(self.axes, place, strict=True))
        found = (f"{target.words} is {target.shown(self._compared(target, place)[0])}" for target in self.targets)
        return f"at {at} {' and '.join(found)}"

    def _own(self) -> Array:
        """Return the place of the scene's own values."""
        try:
            values = [(axis, float(value_of(self.scene, axis.key))) for axis in self.axes]
        except (AttributeError, TypeError):
            return np.full(len(self.axes), 0.5)
        return np.array([axis.place(min(max(value, axis.low), axis.high)) for axis, value in values])

    def _root(self, place: Array, slopes: Array) -> Root:
        results = tuple(self._result(self._at(place, target)) for target in self.targets)
        numbers = tuple(_number(*pair) for pair in zip(results, self.targets, strict=True))
        relative = [number.error / (number.value or math.nan) for number in numbers]
        inverse = np.linalg.inv(slopes) if np.linalg.det(slopes) else np.full_like(slopes, math.nan)
        pairs = [*zip(self.axes, place, np.abs(inverse) @ relative, strict=True)]
        margins = ((float(axis.slope(x) * error), axis.high - axis.low) for axis, x, error in pairs)
        known = tuple(margin if margin < width else math.nan for margin, width in margins)  # where a slope vanishes
        return Root(tuple(axis.value(x) for axis, x, _ in pairs), numbers, known, self._at(place), results)

    # -- by the closed form --------------------------------------------------------------------------------
    def places(self) -> tuple[list[Array], list[str]]:
        """Return the places of one key at which the closed form has the target, and notes.

        Raises:
            _NoStart: it has no answer, or none that depends on the key.
            SceneError: it does not reach the target, with what it does.
        """
        axis, target = self.axes[0], self.targets[0]
        name = target.quantity.name
        search = Roots(lambda x: float(self._compared(target, np.array([x]))[0]), 0.0, 1.0, target.value)
        try:
            places = search.find()
        except SceneError as error:
            raise _NoStart(str(error)) from error
        low, high = min(search.values.values()), max(search.values.values())
        if high - low <= EQUAL * max(abs(low), abs(high)):
            raise _NoStart(f"{name} does not depend on {axis.key} here: it is {target.shown(low)}")
        notes = [f"{name} jumps over it at {axis.shown(axis.value(x))}" for x in search.jumps]
        if search.refusals:  # nearest to where there are answers
            x = min(search.refusals, key=lambda x: min(abs(x - each) for each in search.values))
            notes.append(f"at {axis.shown(axis.value(x))} there is no answer: {search.refusals[x]}")
        if not places:
            ends = axis.shown(axis.value(min(search.values)), axis.value(max(search.values)))
            wanted = target.shown(target.value).removesuffix("s its value without voltage") + "s" * target.relative
            words = f"at {axis.key} {ends} {name} is {target.shown(low, high)}; {wanted} is not reached"
            raise SceneError("; ".join([words, *notes[:1]]))
        return [np.array([x]) for x in places], [f"{text[0].upper()}{text[1:]}." for text in notes]
