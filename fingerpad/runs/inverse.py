"""The value of a key at which a scene reaches a target at full slip, by the closed form.

The closed form is the model "cylinders" (:mod:`fingerpad.reduced.cylinders`), of one state alone. The key is varied
over a range (:mod:`fingerpad.runs.axis`), and each place at which the quantity crosses the target is refined
(:mod:`fingerpad.runs.roots`). The full model confirms each value by one run, where it is asked for.

Friction is that of the whole finger, as in the headline of a result; that of the middle section where ``f_ext`` is
varied, or the target has a unit per metre. A scene without a force gets the one whose centre bears its ``f_ext``.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from fingerpad.reduced.cylinders import Cylinders
from fingerpad.reduced.registry import find
from fingerpad.results.answer import Number
from fingerpad.results.quantities import FINGER, plus_minus_of
from fingerpad.results.result import Result
from fingerpad.runs.axis import Axis, axis
from fingerpad.runs.closed_form import STATE, ClosedForm
from fingerpad.runs.context import RunContext
from fingerpad.runs.roots import Roots
from fingerpad.runs.solve import checked, solved, stopped
from fingerpad.runs.target import CONTRAST, Target, read
from fingerpad.scene import Scene, with_values
from fingerpad.scene.messages import SceneError
from fingerpad.scene.remarks import drive_in_short, other_under_a_drive
from fingerpad.slices import errors


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
    full: Result | None = None
    """Of the full model, where it was asked for."""

    @property
    def value(self) -> float:
        """The quantity (SI)."""
        return self.number.value


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

    def confirmed(self, context: RunContext) -> "Solution":
        """Return the solution with a run of the full model at each value, up to one that is stopped; collective.

        Args:
            context: ranks and console.
        """
        way, roots = find("full"), list(self.roots)
        for k, root in enumerate(roots):
            if context.lines and context.ranks.rank == 0:
                words = f"{self.axis.key} = {self.axis.shown(root.key)}, run {k + 1} of {len(roots)} of the full model"
                print(f"\n{words}", flush=True)
            full = solved(root.scene, way, context)
            roots[k] = replace(root, full=full)
            if full.interrupted:
                break
        return replace(self, roots=tuple(roots))

    def __str__(self) -> str:
        """Return each value of the key, what the quantity is there, and what is known of its error."""
        quantity, axis = self.target.quantity, self.axis
        of = " of the whole finger" if self.target.whole else " of the middle section"
        lines = [
            f"{self.target} over {axis.key} from {axis.shown(axis.low, axis.high)}: {quantity.words}{of} at full slip, "
            f"by the closed form, under {drive_in_short(each.scene for each in self.roots)}."
        ]
        if self.target.name == CONTRAST:
            lines.append("contrast is the relative rise of µ_app by the voltage.")
        for root in self.roots:
            known = root.margin == root.margin
            value = axis.with_error(root.key, root.margin) if known else axis.shown(root.key)
            line = f"  {axis.key} = {value}" + ", ± by the error of the closed form" * known
            lines.append(f"{line}: {quantity.symbol} {_cell(self.target, root.number)}")
            if root.full is not None:
                lines.append(f"    {self._beside(root, root.full)}")
        return "\n".join([*lines, *other_under_a_drive(each.scene for each in self.roots), *self.notes])

    def _beside(self, root: Root, full: Result) -> str:
        """Return what the full model has at a root, beside the closed form."""
        if self.target.whole and (full.finger is None or STATE not in full.finger.states) or full.full_slip is None:
            return f"full model: no full slip{f': {full.failure}' if full.failure else ''}"
        found, value = full.number(STATE, self.target.quantity.name, self.target.whole), root.number.value
        off = round(100 * (found.value / value - 1), 1) + 0.0 if value else math.nan  # no -0.0
        ratio = f", {off:+.1f} % from the closed form" if value else ""
        by = f" (± by {', '.join(found.parts)})" if found.error == found.error else ""
        return f"full model: {self.target.quantity.symbol} {_cell(self.target, found)}{by}{ratio}"


def solve(
    scene: Scene | None = None,
    target: str = "",
    over: str = "voltage",
    *,
    between: Sequence[float | str] | None = None,
    model: str = Cylinders.name,
) -> Solution:
    """Return the values of a key at which a scene reaches a target at full slip.

    Args:
        scene: the scene; by default press, charge and slide of the default finger.
        target: a quantity and its value: ``"mu_app=2x"``, twice the value without voltage; ``"F_T=0.3 N"``;
            ``"contrast=10 %"``, the relative rise of µ_app by the voltage.
        over: the key that is varied, as of :func:`fingerpad.runs.sweep.sweep`.
        between: first and last value of the key, in SI or as texts with a unit; by default that of
            :data:`fingerpad.runs.axis.RANGES`, or a tenth to ten times the scene's value.
        model: ``"cylinders"``, or ``"full"`` to confirm each value by a run of the full model.

    Returns:
        All values of the key in the range.

    Raises:
        SceneError: an impossible target, key or range; or a target that is not reached in the range, with what is.
        KeyboardInterrupt, SystemExit: a run of the full model is stopped, as by :func:`fingerpad.runs.solve.run`.
    """
    scene, way = checked(scene).resolved(), find(model)
    form = ClosedForm(Cylinders() if way.path else way)
    form.model.check(scene)
    if over == "voltage" and scene.supply is not None:
        raise SceneError("voltage is a drive and over is voltage; give one of its keys, as voltage.rms")
    newtons = over == "force" or (scene.force is not None and over != "f_ext")
    goal, notes = read(target, over != "f_ext"), list[str]()
    if over == "f_ext" and goal.whole or newtons and not goal.whole:
        kind, other = ("whole finger", "force") if goal.whole else ("section", "f_ext")
        given = f"over is {over}" if over in ("f_ext", "force") else "force is given"
        raise SceneError(f"{goal.name} is a quantity of the {kind} and {given}; give {other} in its place")
    if goal.whole and not newtons:
        force = form.newtons(scene)
        at = f"the section at the finger's centre then bears the scene's f_ext, {scene.f_ext:g} N/m, at full slip"
        notes.append(f"No force is given. It is {force:.4g} N: {at}.")
        scene = scene.replace(force=force)
    elif over == "f_ext" and goal.quantity.name in FINGER:
        notes.append("The whole finger has another value; vary force for it.")
    solution = _Problem(scene, goal, axis(scene, over, between), form).solution(notes)
    solution = solution.confirmed(RunContext()) if way.path else solution
    for root in solution.roots:
        if root.full is not None and root.full.interrupted:
            raise stopped(root.full)
    return solution


class _Problem:
    """A target, the key that is varied for it, and the values that were computed."""

    def __init__(self, scene: Scene, target: Target, axis: Axis, form: ClosedForm) -> None:
        self._scene, self._target, self._axis, self._form = scene, target, axis, form
        self._uncharged: float | None = None

    def solution(self, notes: Sequence[str]) -> Solution:
        """Return the solution, with its notes after others.

        Raises:
            SceneError: the target is not reached, with what is.
        """
        axis, target = self._axis, self._target
        search = Roots(self._relative, axis.place(axis.low), axis.place(axis.high), target.value)
        places = search.find()
        if search.constant:
            least = target.shown(next(iter(search.values.values())))
            raise SceneError(f"{target.name} does not depend on {axis.key} here: it is {least}")
        jumps = [f"At {axis.shown(axis.value(x))} {target.name} jumps over the target." for x in search.jumps]
        if not places:
            raise SceneError(self._out_of_range(search))
        roots = tuple(self._root(search, place) for place in places)
        known = [note for root in roots for note in self._known(root)]
        refused = [f"{text[0].upper()}{text[1:]}." for text in [self._refused(search)] if text]
        cautions = (f"! {caution}" for root in roots for caution in root.closed.cautions)
        return Solution(
            target, axis, self._scene, roots, tuple(dict.fromkeys([*notes, *known, *jumps, *refused, *cautions]))
        )

    def _at(self, place: float) -> Scene:
        return with_values(self._scene, {self._axis.key: self._axis.value(place)})

    def _value(self, scene: Scene) -> float:
        return self._form.value(scene, self._target.quantity, self._target.whole)

    def _relative(self, place: float) -> float:
        """Return what is compared with the target: the quantity, or its ratio to that without voltage."""
        scene = self._at(place)
        value = self._value(scene)
        return value / self._base(scene) if self._target.relative else value

    def _base(self, scene: Scene) -> float:
        """Return the quantity without voltage, on which voltage and coating have no influence."""
        electric = self._axis.key.startswith(("voltage", "electric."))
        if self._uncharged is None or not electric:
            self._uncharged = self._value(scene.replace(voltage=0.0))
        if self._uncharged == 0:
            name = self._target.quantity.symbol
            raise SceneError(f"{name} is 0 without voltage, of which there is no multiple; give a value of {name}")
        return self._uncharged

    def _root(self, search: Roots, place: float) -> Root:
        scene = self._at(place)
        closed = self._form.result(scene)
        number = closed.number(STATE, self._target.quantity.name, self._target.whole)
        margin = abs(number.error / (number.value or math.nan) * search.values[place] / search.slope(place))
        margin *= self._axis.value(place) if self._axis.logarithmic else 1.0
        margin = margin if margin < self._axis.high - self._axis.low else math.nan  # where the slope vanishes
        return Root(self._axis.value(place), number, margin, scene, closed)

    def _known(self, root: Root) -> list[str]:
        """Return what is known of the error of a root; a caution of its result tells where nothing is."""
        known = [plus_minus_of(root.number.parts)] if root.number.error == root.number.error else []
        return known + (errors.remarks([root.scene.force or 0.0]) if self._target.whole else [])

    def _refused(self, search: Roots) -> str:
        """Return where there is no answer, nearest to those that there are, and why; empty where there is one."""
        if not search.refusals:
            return ""
        place = min(search.refusals, key=lambda x: min(abs(x - each) for each in search.values))
        return f"at {self._axis.shown(self._axis.value(place))} there is no answer: {search.refusals[place]}"

    def _out_of_range(self, search: Roots) -> str:
        """Return what the range gives in place of the target, in one sentence."""
        axis, target = self._axis, self._target
        least, most = min(search.values.values()), max(search.values.values())
        ends = (axis.value(min(search.values)), axis.value(max(search.values)))
        found = f"{target.shown(least, unit=False)} to {target.shown(most)}"
        times = " times" if target.relative and target.name != CONTRAST else ""
        wanted = f"{target.shown(target.value, unit=not times)}{times}"
        jump = f"{target.name} jumps over it at {axis.shown(axis.value(search.jumps[0]))}" if search.jumps else ""
        more = [text for text in (jump, self._refused(search)) if text][:1]
        words = f"at {axis.key} {axis.shown(*ends)} {target.name} is {found}; {wanted} is not reached"
        return "; ".join([words, *more])


def _cell(target: Target, number: Number) -> str:
    """Return the quantity of a target with its error and unit."""
    unit = target.quantity.unit
    return target.quantity.shown(number.value, number.error) + (f" {unit}" if unit else "")
