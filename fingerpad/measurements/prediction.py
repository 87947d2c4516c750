r"""What the closed form answers for the rows of a table of whole fingers, at other values of a scene's keys.

Each voltage has one trace of the cross-section per state (:mod:`fingerpad.slices.traces`), on which the force of each
row is found. Traces of constant voltages are computed together. The air gap is that of the closure at the mean contact
pressure of the finger's centre.

Keys of shape, layers and contact change the press of the finger (:mod:`fingerpad.reduced.press`). Rows y are power laws
of them about the scene's own values :math:`k_0`, with exponents from two presses each, 25 % to either side:

.. math:: \ln y = \ln y(k_0) + \sum_k \frac{\partial \ln y}{\partial \ln k} \ln \frac{k}{k_0} .
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from fingerpad.reduced import cylinders
from fingerpad.reduced.detection import thresholds
from fingerpad.scene import Scene, value_of, with_values
from fingerpad.scene.messages import SceneError
from fingerpad.scene.parameters import centre_force
from fingerpad.slices import traces
from fingerpad.slices.total import BeyondTrace, Total, at_force, at_indentation, profile
from fingerpad.slices.trace import Trace, trace
from fingerpad.slices.traces import MARGIN

Array = NDArray[np.float64]
Powers = Mapping[str, Array]
MODEL = cylinders.Cylinders()
_CLOSE, _STEPS = 1e-9, 8  # of the logarithm of a force; steps of the secant method
_MORE, _FURTHEST = 1.5, 10.0  # of the largest force of a trace that is too short: a factor, and the largest one
_PRESSED, _PART = ("geometry.", "materials.", "contact."), 0.25  # keys of a press, and part of a logarithm to a side
_SUMS = {"friction force": "f_t", "gross area": "gross_area", "contact area": "contact_area"}
_RATIO = {"threshold ratio"}  # the quantity without a trace
_CONDITIONS = ["force", "voltage", "frequency", "state", "quantity"]


class ClosedForm:
    """Rows of a table as functions of keys of a scene."""

    def __init__(
        self, scene: Scene, keys: Sequence[str], rows: pd.DataFrame, state: str, known: Powers | None = None
    ) -> None:
        """Take rows of :func:`fingerpad.measurements.table.observations`.

        Args:
            scene: has all other values; of a table without a voltage its own is taken.
            keys: dotted, of numbers greater than 0.
            rows: with force, voltage, frequency and quantity.
            state: of quantities other than friction.
            known: exponents of the rows by key of a press; by default they are from two presses each.

        Raises:
            SceneError: the finger has no closed form, or its press fails.
        """
        self.scene, self.keys = scene, keys
        MODEL.check(scene)  # has its finger pressed
        of = rows.assign(state=[state_of(quantity, state) for quantity in rows.quantity])[_CONDITIONS]
        self._different = of.drop_duplicates(ignore_index=True)
        self._groups = [*self._different.groupby(_CONDITIONS[1:4], dropna=False)]
        self._row = of.groupby(_CONDITIONS, dropna=False, sort=False).ngroup().to_numpy()
        self._depths, self._further, self.exponents = dict[Any, float](), 1.0, dict(known or {})
        for key in (key for key in keys if key.startswith(_PRESSED) and key not in self.exponents):
            value, ends = value_of(scene, key), list[Array]()
            for factor in (math.exp(_PART), math.exp(-_PART)):
                other = with_values(scene, {key: value * factor})
                ends.append(ClosedForm(other, (), rows, state).rows(other))
            self.exponents[key] = np.asarray((ends[0] - ends[1]) / (2 * _PART), dtype=float)

    def at(self, values: Array) -> Scene:
        """Return the scene with values of the keys, given as logarithms."""
        return with_values(self.scene, dict(zip(self.keys, np.exp(values).tolist(), strict=True)))

    def __call__(self, values: Array) -> Array:
        """Return the logarithms of the rows at logarithms of the keys; NaN without an answer."""
        changes = dict(zip(self.keys, np.exp(values).tolist(), strict=True))
        powers = {key: by for key, by in self.exponents.items() if key in changes}
        moved = sum(by * math.log(changes.pop(key) / value_of(self.scene, key)) for key, by in powers.items())
        try:
            return np.asarray(self.rows(with_values(self.scene, changes) if changes else self.scene) + moved)
        except SceneError:
            return np.full(len(self._row), np.nan)

    def rows(self, scene: Scene) -> Array:
        """Return the logarithms of the rows of a scene.

        Raises:
            SceneError: the scene, or the closed form there, is refused.
        """
        found = np.empty(len(self._different))
        fingers = [under(scene, *key[:2]).model_copy(update={"force": None}) for key, _ in self._groups]
        made = self._together(fingers)
        for n, ((_, frequency, state), group) in enumerate(self._groups):
            totals = dict[float, tuple[Trace, Total]]()
            for k, force, quantity in zip(group.index, group.force, group.quantity, strict=True):
                if quantity == "threshold ratio":
                    found[k] = thresholds(fingers[n], [frequency])[0].sine
                    continue
                totals = totals or self._totals(fingers[n], state, sorted(set(group.force), reverse=True), made.get(n))
                found[k] = value(fingers[n], quantity, *totals[force])
        return np.asarray(np.log(found))[self._row]

    def _together(self, fingers: Sequence[Scene]) -> dict[int, Trace]:
        """Return the traces of groups with a constant voltage, by number, those of one state computed together."""
        found = dict[int, Trace]()
        for state in ("charged", "full_slip"):
            of = [n for n, (key, group) in enumerate(self._groups) if key[2] == state and set(group.quantity) - _RATIO]
            same = [n for n in of if fingers[n].drive is None]
            grids = [traces.grid(*self._ends(fingers[n], self._groups[n][1].force)) for n in same]
            volts = [fingers[n].volts for n, grid in zip(same, grids, strict=True) for _ in grid]
            if len(same) > 1:
                states = cylinders.over_forces(fingers[same[0]], np.concatenate(grids), state, voltage=volts)  # type: ignore[arg-type]
                parts = iter(cylinders.press.of(fingers[0]).lowered(states, state))
                wave = fingers[0].geometry.ridge_wavelength
                found |= {n: trace([next(parts) for _ in grid], wave) for n, grid in zip(same, grids, strict=True)}
        return found

    def _ends(self, scene: Scene, forces: Sequence[float]) -> tuple[float, float]:
        """Return the expected force (N/m) and the largest of the trace for forces (N)."""
        expected, largest = (centre_force(force, scene.geometry.width) for force in (min(forces), max(forces)))
        return expected, self._further * MARGIN * largest

    def _totals(
        self, scene: Scene, state: str, forces: Sequence[float], made: Trace | None
    ) -> dict[float, tuple[Trace, Total]]:
        """Return the finger under forces (N), the largest first, with the trace, which may be made already."""
        while True:
            made = made or MODEL.of_points(scene, cylinders.solve, state, *self._ends(scene, forces)).trace
            found = dict[float, tuple[Trace, Total]]()
            try:
                for force in forces:
                    place = (scene.volts, state, force)
                    found[force] = (made, _under_force(scene, made, force, self._depths.get(place)))
                    self._depths[place] = math.log(found[force][1].delta)
                return found
            except BeyondTrace:
                if self._further > _FURTHEST:
                    raise
                self._further, made = self._further * _MORE, None


def _under_force(scene: Scene, trace: Trace, force: float, x: float | None) -> Total:
    """Return the finger under a force (N), by the secant method from the logarithm of a depth (m) nearby."""
    finger, count, slope, before = profile(scene.slices), scene.slices.count, 2.0, (0.0, 0.0)
    for step in range(_STEPS if x is not None else 0):
        try:
            total = at_indentation(finger, trace, math.exp(x), count)  # type: ignore[arg-type]
        except BeyondTrace:
            break
        off = math.log(total.totals["f_ext"] / force)
        if abs(off) < _CLOSE:
            return total
        slope = (off - before[1]) / (x - before[0]) if step else slope  # type: ignore[operator]
        before, x = (x, off), x - off / slope  # type: ignore[assignment, operator]
    return at_force(finger, trace, force, count)


def state_of(quantity: str, other: str) -> str:
    """Return the state of a quantity: full slip of friction, and another one of all others."""
    return "full_slip" if quantity.startswith("friction") else other


def value(scene: Scene, quantity: str, trace: Trace, total: Total) -> float:
    """Return a quantity of a finger (SI)."""
    if quantity in _SUMS:
        return total.totals[_SUMS[quantity]]
    if quantity == "share":
        return total.totals["contact_area"] / total.totals["gross_area"]
    if quantity == "air gap":
        at = trace.at(np.array([total.delta / profile(scene.slices).centre_scale]))
        return float(scene.closure()((at["f_ext"] + at["f_electrostatic"]) / at["contact_length"]).d_eq[0])
    return {"friction": total.mu_app, "depth": total.delta}[quantity]


def under(scene: Scene, voltage: float, frequency: float) -> Scene:
    """Return a scene with the voltage (V rms) and the frequency (Hz) of a row; NaN for those of the scene."""
    if scene.drive is None or voltage == 0:
        return scene if math.isnan(voltage) else scene.model_copy(update={"voltage": voltage})
    given = {"voltage.rms": voltage, "voltage.frequency": frequency}
    return with_values(scene, {key: value for key, value in given.items() if not math.isnan(value)})
