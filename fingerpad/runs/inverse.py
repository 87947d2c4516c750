"""The values of a key at which a quantity at full slip has a target, by the closed form.

The closed form is the model "cylinders" (:mod:`fingerpad.reduced.cylinders`). The key is varied
over a range, and each crossing of the target is refined (:mod:`fingerpad.runs.roots`). The full model confirms a value
by a run of the scene there.

Quantities are those of the whole finger, as in the headline of a result; those of the middle section where ``f_ext`` is
varied, or the target has a unit per metre. A scene without a force gets the one whose centre bears its ``f_ext``.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from fingerpad.reduced.cylinders import Cylinders
from fingerpad.reduced.model import Model
from fingerpad.results.data import Number
from fingerpad.results.quantities import FINGER, QUANTITIES, Output, in_table, plus_minus_of
from fingerpad.results.result import Result
from fingerpad.runs.context import RunContext
from fingerpad.runs.roots import EQUAL, Axis, Roots, axis
from fingerpad.runs.solve import checked, find, solved
from fingerpad.scene import Scene, with_values
from fingerpad.scene.messages import SceneError, clip, show
from fingerpad.scene.remarks import drive_in_short, other_under_a_drive
from fingerpad.slices import errors
from geometry.units import to_si

_STATE = "full_slip"


# -- the target ----------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Target:
    """A quantity at full slip and the value that it is to have."""

    quantity: Output
    whole: bool
    """Whether it is of the whole finger, else of the section at its centre."""
    value: float
    """In SI, or relative to the value without voltage."""
    relative: bool

    def shown(self, *values: float) -> str:
        """Return one or two values of the kind of :attr:`value` in the unit of tables."""
        scale, unit = (
            (1.0, "times its value without voltage") if self.relative else (self.quantity.scale, self.quantity.unit)
        )
        return f"{' to '.join(f'{value * scale:.4g}' for value in values)} {unit}".rstrip()

    def number(self, number: Number) -> str:
        """Return the quantity with its error and unit."""
        return f"{self.quantity.shown(number.value, number.error)} {self.quantity.unit}".rstrip()


def _target(name: str, given: float | str, relative: bool, whole: bool) -> Target:
    """Return a target.

    Args:
        name: of the quantity.
        given: its value in SI, or a text with a unit.
        relative: whether the value is a multiple of that without voltage.
        whole: whether a name of both is that of the whole finger; the unit of a text decides first.

    Raises:
        SceneError: no such quantity, no number, or a unit that does not fit.
    """
    tables = {True: {key: each for key, each in FINGER.items() if key != "f_ext"},
              False: {key: QUANTITIES[key] for key in in_table("target")}}  # fmt: skip
    found = [(table[name], of) for of in (whole, not whole) if name in (table := tables[of])]
    if not found:
        known = ", ".join(dict.fromkeys([*tables[False], *tables[True]]))
        raise SceneError(f"{clip(name)} is not a quantity of a target; it must be one of {known}")
    why = "it must be a finite number"
    if isinstance(given, str) and not relative:
        for quantity, of in found if found[0][0].unit else ():  # f_t may be N/m or N
            try:
                return Target(quantity, of, to_si(given, quantity.si), False)
            except ValueError as error:
                why = str(error) if why.endswith("number") else why
    elif isinstance(given, int | float) and not isinstance(given, bool) and math.isfinite(given):
        return Target(*found[0], float(given), relative)
    raise SceneError(f"target {name} is {show(given)}; {why}")


# -- the solution --------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Root:
    """A value of the key at which the closed form has the target."""

    key: float
    """In SI."""
    number: Number
    """The quantity with its error; not relative."""
    margin: float
    """Error of the key (SI) by that of the closed form; NaN where this is not known."""
    scene: Scene
    """With the key."""
    closed: Result
    """Of the closed form: the section and, where the scene has a force, the whole finger."""


@dataclass(frozen=True)
class Solution:
    """All values of a key over its range at which the closed form has the target."""

    target: Target
    axis: Axis
    scene: Scene
    roots: tuple[Root, ...]
    """In growing order of the key."""
    notes: tuple[str, ...]

    @property
    def values(self) -> list[float]:
        """The values of the key (SI)."""
        return [root.key for root in self.roots]

    def __str__(self) -> str:
        """Return each value of the key and the quantity there, with their errors."""
        quantity, axis, target = self.target.quantity, self.axis, self.target
        of = " of the whole finger" if target.whole else " of the middle section"
        lines = [
            f"{quantity.name} = {target.shown(target.value)} over {axis.key} from {axis.shown(axis.low, axis.high)}: "
            f"{quantity.words}{of} at full slip, by the closed form, under "
            f"{drive_in_short(each.scene for each in self.roots)}."
        ]
        for root in self.roots:
            known = ", ± by the error of the closed form" * (root.margin == root.margin)
            value = axis.shown(root.key, error=root.margin)
            lines.append(f"  {axis.key} = {value}{known}: {quantity.symbol} {target.number(root.number)}")
        return "\n".join([*lines, *other_under_a_drive(each.scene for each in self.roots), *self.notes])


def solve(
    scene: Scene | None = None,
    over: str = "voltage",
    *,
    relative: bool = False,
    between: Sequence[float | str] | None = None,
    model: str = Cylinders.name,
    **target: float | str,
) -> Solution:
    """Return the values of a key at which a quantity at full slip has a target.

    ``fp.solve(mu_app=0.4)`` is the voltage for a friction coefficient of 0.4.

    Args:
        scene: the scene; by default press, charge and slide of the default finger.
        over: the key that is varied, as in :func:`fingerpad.runs.sweep.sweep`.
        relative: whether the target is a multiple of the value without voltage: 2 for twice the friction.
        between: first and last value of the key, in SI or as texts with a unit; by default that of
            :data:`fingerpad.runs.roots.RANGES`, or a tenth to ten times the scene's value.
        model: a name of :data:`fingerpad.runs.solve.MODELS`, of a model without a path.
        **target: one quantity and its value, in SI or as a text with a unit: ``mu_app=0.4``, ``f_t="0.3 N"``.

    Returns:
        All values of the key in the range.

    Raises:
        SceneError: an impossible target, key or range; or a target that is not reached in the range, with what is.
    """
    scene, way = checked(scene).resolved(), find(model)
    if len(target) != 1:
        given = f"{' and '.join(target)} are targets" if target else "no target is given"
        raise SceneError(f"{given}; give one quantity and its value, such as mu_app=0.4")
    if way.path:
        raise SceneError(f"model is {model!r}, too slow for a search; run it at the scene of a value of 'cylinders'")
    way.check(scene)
    if over == "voltage" and scene.drive is not None:
        raise SceneError("voltage is a drive and over is voltage; give one of its keys, as voltage.rms")
    newtons = over == "force" or (scene.force is not None and over != "f_ext")
    ((name, value),), notes = target.items(), list[str]()
    goal = _target(name, value, relative, over != "f_ext")
    if over == "f_ext" and goal.whole or newtons and not goal.whole:
        kind, other = ("whole finger", "force") if goal.whole else ("section", "f_ext")
        given = f"over is {over}" if over in ("f_ext", "force") else "force is given"
        raise SceneError(f"{goal.quantity.symbol} is of the {kind} and {given}; give {other} in its place")
    if goal.whole and not newtons:
        uncharged = _result(scene.replace(voltage=0.0), way)
        _number(uncharged, goal)  # refuses a finger that is too short
        assert uncharged.finger is not None
        force = uncharged.finger.f_ext
        at = f"the section at the finger's centre then bears the scene's f_ext, {scene.f_ext:g} N/m, at full slip"
        notes.append(f"No force is given. It is {force:.4g} N: {at}.")
        scene = scene.replace(force=force)
    elif over == "f_ext" and name in FINGER:
        notes.append("The whole finger has another value; vary force for it.")
    return _Problem(scene, goal, axis(scene, over, between), way).solution(notes)


def _result(scene: Scene, model: Model) -> Result:
    """Return the result of a scene without its bands over assumptions."""
    return solved(scene, model, RunContext(report=False))


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


@dataclass
class _Problem:
    """A target, the key that is varied for it, and the value without voltage."""

    scene: Scene
    target: Target
    axis: Axis
    model: Model
    base: float | None = None

    def solution(self, notes: Sequence[str]) -> Solution:
        """Return the solution, with its notes after others.

        Raises:
            SceneError: the target is not reached, with what is.
        """
        axis, target, name = self.axis, self.target, self.target.quantity.name
        search = Roots(self._reached, axis.place(axis.low), axis.place(axis.high), target.value)
        places = search.find()
        low, high = min(search.values.values()), max(search.values.values())
        if high - low <= EQUAL * max(abs(low), abs(high)):
            raise SceneError(f"{name} does not depend on {axis.key} here: it is {target.shown(low)}")
        jumps = [f"{name} jumps over it at {axis.shown(axis.value(x))}" for x in search.jumps]
        refused = self._refused(search)
        if not places:
            ends = axis.shown(axis.value(min(search.values)), axis.value(max(search.values)))
            wanted = target.shown(target.value).removesuffix("s its value without voltage") + "s" * target.relative
            words = f"at {axis.key} {ends} {name} is {target.shown(low, high)}; {wanted} is not reached"
            raise SceneError("; ".join([words, *[*jumps, *refused][:1]]))
        roots = tuple(self._root(search, place) for place in places)
        known = [note for root in roots for note in self._known(root)]
        more = [f"{text[0].upper()}{text[1:]}." for text in (*jumps, *refused)]
        cautions = (f"! {caution}" for root in roots for caution in root.closed.cautions)
        return Solution(target, axis, self.scene, roots, tuple(dict.fromkeys([*notes, *known, *more, *cautions])))

    def _at(self, place: float) -> Scene:
        return with_values(self.scene, {self.axis.key: self.axis.value(place)})

    def _value(self, scene: Scene) -> float:
        return _number(_result(scene, self.model), self.target).value

    def _reached(self, place: float) -> float:
        """Return what is compared with the target: the quantity, or its ratio to that without voltage."""
        scene = self._at(place)
        value = self._value(scene)
        if not self.target.relative:
            return value
        if self.base is None or not self.axis.key.startswith(("voltage", "electric.")):
            self.base = self._value(scene.replace(voltage=0.0))
        if self.base == 0:
            raise SceneError(f"{self.target.quantity.symbol} is 0 without voltage, of which there is no multiple")
        return value / self.base

    def _root(self, search: Roots, place: float) -> Root:
        scene, axis = self._at(place), self.axis
        closed = _result(scene, self.model)
        number = _number(closed, self.target)
        margin = abs(number.error / (number.value or math.nan) * search.values[place] / search.slope(place))
        margin *= axis.value(place) if axis.logarithmic else 1.0
        margin = margin if margin < axis.high - axis.low else math.nan  # where the slope vanishes
        return Root(axis.value(place), number, margin, scene, closed)

    def _known(self, root: Root) -> list[str]:
        """Return the parts of the error of a root; none where it is not known, of which its result has a caution."""
        known = [plus_minus_of(root.number.parts)] if root.number.error == root.number.error else []
        return known + (errors.remarks([root.scene.force or 0.0]) if self.target.whole else [])

    def _refused(self, search: Roots) -> list[str]:
        """Return where the closed form has no value, nearest to those that there are, and why; empty where it has."""
        if not search.refusals:
            return []
        place = min(search.refusals, key=lambda x: min(abs(x - each) for each in search.values))
        return [f"at {self.axis.shown(self.axis.value(place))} there is no answer: {search.refusals[place]}"]
