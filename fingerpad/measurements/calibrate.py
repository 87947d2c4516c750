"""Values of a scene's keys by one's own table of whole fingers: ``fp.calibrate``.

Keys are fitted as logarithms to the logarithms of all quantities of the table, by the closed form
(:mod:`fingerpad.measurements.prediction`), with a weak prior about the scene's own values, and with a spread between
participants where there are enough (:mod:`fingerpad.measurements.estimation`). Each closure of the package and each
friction law without memory is fitted in place of the scene's. Full runs at some rows have the error of the closed form.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from fingerpad.measurements import prediction
from fingerpad.measurements.estimation import Data, Estimate, estimate, slopes
from fingerpad.measurements.prediction import ClosedForm, Powers
from fingerpad.measurements.table import Observations, observations
from fingerpad.reduced.closure_band import closures, laws_like
from fingerpad.reduced.cylinders import over_forces
from fingerpad.report import calibration_page
from fingerpad.results.files import below, check_folder
from fingerpad.results.result import Result
from fingerpad.results.terminal import Console
from fingerpad.runs import batch
from fingerpad.runs.solve import checked
from fingerpad.scene import Scene, value_of, with_values
from fingerpad.scene.keys import by_name
from fingerpad.scene.law_keys import parameters
from fingerpad.scene.messages import SceneError, clip, counted, show
from fingerpad.startup import MPI
from variational.contact.friction import Derjaguin

Array = NDArray[np.float64]
PRIOR = math.log(3.0)
"""Standard deviation of the prior: from a third of the scene's value to three times it."""
_REACH = math.log(100.0)  # of values, from those of the scene
_NO_EFFECT = 1e-6  # change of a row over that of a key, both relative
_OPEN = math.log(2.0)  # standard error of a combination of keys that a table cannot tell apart
_LIMIT = 4 * 3600.0  # s of processor time of a full run
_CONDITIONS = ["force", "voltage", "frequency"]
_EVIDENCE = ["kind", "name", "AICc", "values"]


@dataclass(frozen=True, eq=False)
class Calibration:
    """What a table says of keys of a scene; SI units."""

    scene: Scene
    """With the fitted values."""
    values: pd.DataFrame
    """Of each key ``value``, ``low`` and ``high``, the ends of its 95 % region, and ``spread`` between participants."""
    correlation: pd.DataFrame
    """Of the logarithms of the keys."""
    rows: pd.DataFrame
    """Of :func:`fingerpad.measurements.table.observations`, with ``fitted``, the 95 % band ``low`` to ``high`` of a
    measured value, ``deviation`` in standard deviations of the row, and ``held_out``."""
    noise: float
    """Relative standard deviation of rows that is estimated; NaN where it is given."""
    ties: tuple[str, ...]
    """Combinations of keys that the table cannot tell apart, a sentence each."""
    evidence: pd.DataFrame
    """Of each closure and friction law: ``kind``, ``name``, ``AICc``, ``difference`` to the least of its kind,
    ``weight``, and ``values`` of its keys, or why it has none."""
    state: str
    """Of quantities other than friction."""
    full: pd.DataFrame = field(default_factory=pd.DataFrame)
    """Full runs at the fitted values: conditions, ``quantity``, ``closed`` and ``full``."""
    failures: tuple[str, ...] = ()
    """Of full runs."""

    def __str__(self) -> str:
        """Return all of it as text."""
        return "\n".join(calibration_page.lines(self))


def calibrate(
    table: str | Path | pd.DataFrame,
    scene: Scene | None = None,
    fit: Sequence[str] = (),
    *,
    spread: float | None = None,
    columns: Mapping[str, str | None] | None = None,
    hold_out: Mapping[str, Any] | None = None,
    evidence: bool = True,
    full: int = 3,
    out: str | Path | None = "results/calibration",
    jobs: int = 2,
    quiet: bool = False,
) -> Calibration:
    """Return values of a scene's keys by a table of measurements on whole fingers.

    Args:
        table: a CSV file or a DataFrame of several quantities (:func:`fingerpad.measurements.table.observations`).
        scene: all other values, the start, and the centre of the prior; by default the default scene.
        fit: dotted keys of numbers above 0, as ``"friction"`` or ``"roughness.h_rms"``.
        spread: relative standard deviation of rows without one; by default it is estimated from the rows.
        columns: names of this program by heads of the table.
        hold_out: rows that are predicted and not fitted, by a condition in SI units: ``{"participant": 7}``.
        evidence: whether other closures and friction laws are fitted too.
        full: number of conditions at which the full model is run at the fitted values.
        out: folder of ``scene.toml``, ``rows.csv``, ``report.html`` and the full runs, which are kept; None for no file
            and no full run.
        jobs: full runs at a time.
        quiet: whether to print no line of a full run, and show no progress bar.

    Raises:
        SceneError: the table or a key cannot be used, in one sentence.
    """
    if out is not None:
        check_folder(Path(out), "out")
    seen = observations(table, columns)
    held = _held(seen, hold_out or {})
    with closing(Console(MPI.COMM_SELF, lines=False, bar=not quiet)) as console:
        problem = _Problem(checked(scene).resolved(), tuple(fit), seen, held, spread, console)
        found = problem.calibration(evidence)
    if out is None:
        return found
    found = with_full_runs(found, full, Path(out), jobs, quiet)
    calibration_page.write(found, Path(out))
    return found


def _held(seen: Observations, hold_out: Mapping[str, Any]) -> NDArray[np.bool_]:
    """Return which rows are held out."""
    held = np.full(len(seen.rows), bool(hold_out))
    for key, value in hold_out.items():
        if key not in (*_CONDITIONS, "participant"):
            raise SceneError(f"hold_out has {show(key)}; it must be participant, {', '.join(_CONDITIONS)}")
        try:
            held &= seen.rows[key] == str(value) if key == "participant" else np.isclose(seen.rows[key], float(value))
        except (TypeError, ValueError):
            raise SceneError(f"hold_out has {key} {show(value)}; it must be a number") from None
        if not held.any():
            raise SceneError(f"hold_out has {key} {show(value)}, which no row of {seen.name} has")
    return held


class _Problem:
    """A table, keys of a scene and rows that are held out."""

    def __init__(
        self, scene: Scene, keys: tuple[str, ...], seen: Observations, held: NDArray[np.bool_], spread: float | None,
        console: Console,
    ) -> None:  # fmt: skip
        """Refuse what cannot be fitted whatever the values."""
        self.console = console
        self.scene, self.keys, self.seen, self.held = scene, keys, seen, held
        self.rows, self.fitted, name = seen.rows, seen.rows[~held], seen.name
        self.names = list(dict.fromkeys(self.fitted.participant))
        if not keys:
            raise SceneError("fit has no key; give keys of the scene, as friction and roughness.h_rms")
        if twice := [key for key in keys if keys.count(key) > 1]:
            raise SceneError(f"fit has {clip(twice[0])} twice; give each key once")
        if len(self.fitted) < len(keys):
            rows = counted(len(self.fitted), "value")
            raise SceneError(f"{name} has {rows} to fit and fit has {len(keys)} keys; give at most as many keys")
        if spread is not None and not (isinstance(spread, int | float) and 0 < spread < math.inf):
            raise SceneError(f"spread is {show(spread)}; it must be a relative standard deviation above 0")
        volts, charged = self.fitted.voltage.unique(), [k for k in keys if k.startswith(("electric.", "roughness."))]
        if len(volts) == 1 and charged and not self.fitted.quantity.isin(["air gap", "threshold ratio"]).any():
            at = "the scene's voltage" if math.isnan(volts[0]) else f"{volts[0]:g} V"
            raise SceneError(
                f"all values of {name} are at {at}, and {charged[0]} acts by the voltage; give rows at another one"
            )
        spreads = self.rows.spread.fillna(spread or math.nan)
        self.known = bool(spreads.notna().any())
        self.spreads = (spreads if self.known else spreads.fillna(1.0)).to_numpy()
        if not (self.spreads > 0).all():
            line = self.rows.line[~(self.spreads > 0)].iloc[0]
            raise SceneError(f"{name} has no spread above 0 in line {line}; give one, or spread for all such rows")

    def fit(self, scene: Scene, keys: Sequence[str], known: Powers | None = None) -> tuple[ClosedForm, Estimate]:
        """Return the closed form over keys of a scene, and their estimate from its values; ``known`` is its argument.

        The prior is about the values that keys have at first.

        Raises:
            SceneError: a key cannot be fitted, or the closed form has no answer at the scene.
        """
        start = np.log([_value_of(scene, key) for key in keys])
        centre = np.log([_value_of(self.scene if key in self.keys else scene, key) for key in keys])
        low, high = np.log([(_key(key).limits.low, _key(key).limits.high) for key in keys]).T
        form = ClosedForm(scene, keys, self.rows, self.seen.state, known)
        form.rows(scene)  # refuses what has no answer
        bounds = np.maximum(low, centre - _REACH), np.minimum(high, centre + _REACH)
        people = [np.flatnonzero(self.fitted.participant == name) for name in self.names]
        y = np.log(self.fitted.measured.to_numpy())
        data = Data(y, self.spreads[~self.held], self.known, people, centre, PRIOR, bounds)
        try:
            found = estimate(lambda x: form(x)[~self.held], start, data)
        except ValueError as error:
            raise SceneError(f"the closed form has no answer near the scene, where it is varied: {error}") from None
        effects = abs(found.jacobian).max(axis=0)
        if effects.min() < _NO_EFFECT:
            raise SceneError(f"{keys[effects.argmin()]} has no effect on any row of {self.seen.name}; fit without it")
        return form, found

    def calibration(self, evidence: bool) -> Calibration:
        """Return what the table says."""
        self.console.phase(f"fit of {counted(len(self.fitted), 'value')}")
        form, best = self.fit(self.scene, self.keys)
        if form.exponents:  # once more about the press of the fitted finger
            form, best = self.fit(form.at(best.theta), self.keys, form.exponents)
        error = np.sqrt(np.diag(best.covariance))
        wide, keys = best.quantile * error, list(self.keys)
        ends = {"value": best.theta, "low": best.theta - wide, "high": best.theta + wide}
        values = pd.DataFrame({name: np.exp(each) for name, each in ends.items()}, keys).assign(spread=best.omega)
        correlation = pd.DataFrame(best.covariance / np.outer(error, error), keys, keys)
        scene = form.at(best.theta)
        tried = self._evidence(scene, best, form.exponents) if evidence else pd.DataFrame(columns=_EVIDENCE)
        return Calibration(
            scene, values, correlation, self._rows(form, best),
            math.nan if self.known else best.sigma, tuple(self._ties(best)), tried, self.seen.state,
        )  # fmt: skip

    def _rows(self, form: ClosedForm, best: Estimate) -> pd.DataFrame:
        """Return the rows with fitted values, bands and deviations."""
        values = form(best.theta)
        jacobian, fitted, error = slopes(form, best.theta, values), np.empty_like(values), np.empty_like(values)
        for name, mine in self.rows.groupby("participant").indices.items():
            person = self.names.index(name) if name in self.names else None
            fitted[mine], error[mine] = best.predicted(values[mine], jacobian[mine], self.spreads[mine], person)
        wide, off = best.quantile * error, np.log(self.rows.measured) - fitted
        ends = {"fitted": np.exp(fitted), "low": np.exp(fitted - wide), "high": np.exp(fitted + wide)}
        return self.rows.assign(**ends, deviation=off / (best.sigma * self.spreads), held_out=self.held)

    def _ties(self, best: Estimate) -> Iterator[str]:
        """Yield combinations of keys that the table cannot tell apart."""
        for error, vector in zip(*best.directions, strict=True):
            if error > _OPEN:
                powers = vector / vector[abs(vector).argmax()]  # type: ignore[index]
                named = [(key, p) for key, p in zip(self.keys, powers, strict=True) if abs(p) > 0.1]
                product = " × ".join(f"{key}^{p:.2g}".removesuffix("^1") for key, p in named)
                far = "not known" if error > _REACH else f"known to a factor of {math.exp(error):.2g}"
                yield f"The table cannot tell apart {' and '.join(key for key, _ in named)}: {product} is {far}."

    # -- evidence ----------------------------------------------------------------------------------------------
    def _evidence(self, scene: Scene, best: Estimate, known: Powers) -> pd.DataFrame:
        """Return how well each closure and each friction law describes the rows, with its keys fitted."""
        found, laws = [], (*self._closures(scene), *self._friction_laws(scene))
        for k, (kind, name, other, keys) in enumerate(laws):
            self.console.phase(f"{kind}: {name}", k / len(laws))
            try:
                fitted = best if other == scene and keys == self.keys else self.fit(other, keys, known)[1]
                values = zip(keys, np.exp(fitted.theta), strict=True)
                words = ", ".join(f"{key} {value:.4g} {_key(key).unit}".rstrip() for key, value in values)
                found.append((kind, name, fitted.criterion, words))
            except SceneError as error:
                found.append((kind, name, math.nan, f"not fitted: {error}"))
        rows = pd.DataFrame(found, columns=_EVIDENCE)
        difference = rows.AICc - rows.groupby("kind").AICc.transform("min")
        weight = np.exp(-difference / 2)
        return rows.assign(difference=difference, weight=weight / weight.groupby(rows.kind).transform("sum"))

    def _closures(self, scene: Scene) -> Iterator[tuple[str, str, Scene, tuple[str, ...]]]:
        """Yield each closure on the fitted surface: its scene and the keys that it has."""
        for name, law in closures(scene.closure()).items() if (self.fitted.voltage != 0).any() else ():
            there = {f"roughness.{each}" for each in parameters(law)}
            keys = (key for key in self.keys if not key.startswith("roughness.") or key in there)
            yield "closure", name, scene.replace(roughness=law), tuple(keys)

    def _friction_laws(self, scene: Scene) -> Iterator[tuple[str, str, Scene, tuple[str, ...]]]:
        """Yield each friction law without memory, with the friction of the fitted one at a ridge of the centre."""
        rest = tuple(key for key in self.keys if key.partition(".")[0] != "friction")
        if len(rest) < len(self.keys) and self.fitted.quantity.str.startswith("friction").any():
            section = scene.model_copy(update={"force": None})
            (at,) = over_forces(section, [section.f_ext], "full_slip")
            mu, stress = laws_like(scene.friction_law(), at.f_contact / at.contact_length)
            laws = {"Coulomb": (mu, ["friction"]), "shear stress": (stress, ["friction.tau_0"])}
            laws["both"] = Derjaguin(mu / 2, stress.tau_0 / 2), ["friction.mu_f", "friction.tau_0"]
            for name, (law, keys) in laws.items():
                yield "friction law", name, scene.replace(friction=law), (*keys, *rest)


def _key(name: str) -> Any:
    return by_name(Scene).get(name)


def _value_of(scene: Scene, name: str) -> float:
    """Return the value of a key that is fitted; refuse one that cannot be."""
    key = _key(name)
    if key is None or key.limits is None or name.partition(".")[0] in ("force", "f_ext", "voltage", "mesh", "numerics"):
        if not any(each.startswith(f"{name}.") for each in by_name(Scene)):  # not a table
            with_values(scene, {name: 1.0})  # refuses a key that is not there
        raise SceneError(f"fit has {clip(name)}; it must be a number of the finger, its friction or the screen")
    try:
        value = value_of(scene, name)
    except AttributeError:
        with_values(scene, {name: key.limits.high})  # refuses a key that the scene's law does not have
        value = None
    if not (isinstance(value, int | float) and value > 0):
        raise SceneError(f"fit has {name}, and it is {show(value)} in the scene; give it a start above 0 there")
    return float(value)


# -- full runs -------------------------------------------------------------------------------------------------
def with_full_runs(found: Calibration, count: int, folder: Path, jobs: int, quiet: bool) -> Calibration:
    """Return a calibration with full runs at some conditions of its rows, from the first to the last; kept ones too."""
    every = found.rows[_CONDITIONS].drop_duplicates().sort_values(_CONDITIONS)
    chosen = every.iloc[np.unique(np.linspace(0, len(every) - 1, min(count, len(every))).round().astype(int))]
    if chosen.empty:
        return found
    kinds = found.rows[["quantity"]].drop_duplicates()
    rows = chosen.merge(kinds, "cross").assign(full=math.nan)
    rows["closed"] = np.exp(ClosedForm(found.scene, (), rows, found.state).rows(found.scene))
    scenes = {
        f"{force:g} N, {voltage:g} V": prediction.under(found.scene.replace(force=force), voltage, frequency)
        for force, voltage, frequency in chosen.itertuples(index=False)
    }
    place, failures = below(folder, "full"), list[str]()
    summaries = batch.sweep(scenes, place, jobs, _LIMIT, quiet=quiet)
    for k, (name, scene) in enumerate(scenes.items()):
        finger = None if set(summaries[name]) == {"failure"} else Result.load(place / batch.key(scene)).finger
        if finger is None:
            failures.append(f"{name}: {summaries[name].get('failure', 'no whole finger')}")
            continue
        for n in range(k * len(kinds), (k + 1) * len(kinds)):
            quantity = rows.quantity[n]
            state = prediction.state_of(quantity, found.state)
            if state in finger.states and quantity != "threshold ratio":
                rows.loc[n, "full"] = prediction.value(scene, quantity, finger.traces[state], finger.states[state])
    return replace(found, full=rows.dropna(subset="full"), failures=tuple(failures))
