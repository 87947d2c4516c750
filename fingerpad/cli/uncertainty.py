r"""``fingerpad uncertainty``: what the spread of friction comes from, by Sobol's indices on the closed form.

µ_app at full slip is computed for fingers that differ in all of these at once:

- people: the spreads of :mod:`fingerpad.scene.people`;
- rough contact: the models of roughness that have a number, each as likely;
- friction law: that of the scene, Coulomb's, or a shear stress, with the same friction without voltage, each as likely;
- coating: its thickness 20 % smaller to larger.

The indices are parts of the variance of :math:`\ln \mu_{app}`: the *first* is that of one factor alone, the *total*
that with all that it has in common with others. I. M. Sobol' 2001, Math. Comput. Simul. 55, 271; estimators of Saltelli
et al. 2010, doi 10.1016/j.cpc.2009.09.018, by SALib (Herman and Usher 2017, doi 10.21105/joss.00097, MIT licence).

The *uncertainty* is a budget of µ_app. A factor has a standard deviation, whose square is the mean of both indices
times the variance: where no more than two factors interact that is Shapley's value, and the squares add up to the
variance (A. B. Owen 2014, doi 10.1137/130936233); else they are scaled to it. The parts of the result's ±, and its
solver's tolerance, are bounds. Bounds add by magnitude, standard deviations by squares; the total is the sum of both.
"""

import argparse
import itertools
import math
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.cli import output
from fingerpad.cli.arguments import Parser, echo, scene_of
from fingerpad.reduced.closure_band import closures, friction, laws_beside
from fingerpad.reduced.people_band import Fingers, entering
from fingerpad.results.folder import Serial
from fingerpad.results.headline import WHOLE
from fingerpad.results.quantities import MESH, MODEL, PENALTY, Output
from fingerpad.results.result import Result
from fingerpad.results.terminal import Console
from fingerpad.runs.solve import run
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.people import SPREADS
from fingerpad.slices.errors import POINTS as OF_TRACES

Array = NDArray[np.float64]
_EXAMPLES = """
    fingerpad uncertainty
    fingerpad uncertainty scene.toml --set force="0.5 N" --plot parts.png --csv parts.csv
    fingerpad uncertainty results/mine --plot results/mine/uncertainty.png
"""
POINTS = 256
"""Points of Sobol's sequence. There are as many fingers for each factor, and twice as many besides."""
_SEED = 1  # of scrambling and of resampling
_COATING = (0.8, 1.2)
_PEOPLE, _MODELS, _LAW, _COATED = "people", "rough contact", "friction law", "coating"
_TOLERANCE, _TOTAL = "tolerance of the solver", "total"
_OF_PEOPLE = f"{_PEOPLE}: "
_ROUNDOFF = 1e-12  # of µ_app, up to which a part is none
_PRESSURES = np.array([1e3, 1e5])  # Pa, at which two laws are the same
_COLUMNS = (
    *(Output(name, "", digits=2) for name in ("factor", "first", "first_error", "total", "total_error")),
    Output("uncertainty", "", digits=4),
)
_RULE = "Uncertainty of µ_app: standard deviations add by squares, bounds (no indices) as they are; the total is both."


def main(argv: Sequence[str]) -> int:
    """Print what friction is uncertain by; return the exit code."""
    parser = Parser("uncertainty", _EXAMPLES)
    parser.add_scene()
    output.add_files(parser, _COLUMNS, "picture of the uncertainties")
    args = parser.read(argv)
    begin, result = time.perf_counter(), _result(args)
    with closing(Console(Serial(), lines=False)) as console:  # type: ignore[arg-type]  # its rank
        study, head = Study(result, partial(console.phase, "fingers by the closed form")), result.headline
        rows = indices(study, [_PEOPLE if name in SPREADS else name for name in study.names])
        place = next(k for k, row in enumerate(rows) if row["factor"] == _PEOPLE) + 1
        each = [row for row in indices(study, study.names) if row["factor"] in SPREADS]
    sizes = np.array([row["uncertainty"] for row in each])
    sizes *= rows[place - 1]["uncertainty"] / np.linalg.norm(sizes)
    traits = zip(each, sizes.tolist(), strict=True)
    rows[place:place] = [row | {"factor": _OF_PEOPLE + row["factor"], "uncertainty": size} for row, size in traits]
    rows = _budget([row | {"uncertainty": head.value * row["uncertainty"]} for row in rows], _bounds(result))
    echo(f"Parts of the variance of ln {head.symbol} of the {head.of}, {head.at}, about {head.value:.3g}:")
    echo(output.text(_COLUMNS, rows))
    echo("\n".join([_RULE, *study.words()]))
    echo(f"{study.count} fingers by the closed form in {time.perf_counter() - begin:.2g} s; errors are for 95 %.")
    output.write_files(args, _COLUMNS, rows, _draw)
    return 0


def _result(args: argparse.Namespace) -> Result:
    """Return the result of a folder, or that of the closed form for a scene."""
    if args.scene is None or not args.scene.is_dir():
        return run(scene_of(args, meshed=False), model="cylinders")
    if args.set:
        raise SceneError(f"--set {clip(args.set[0])} is given with the folder of a run; give the scene instead")
    return Result.load(args.scene)


def _bounds(result: Result) -> dict[str, float]:
    """Return the parts of the numerical error of a result's µ_app at full slip, as bounds; none that is not known.

    The tolerance of the solver is what it leaves of a sum of forces per length, that of friction and the normal one
    (:func:`fingerpad.model.state.force_error`), in each slice in contact. The attraction has that of d_eq, twice.
    """
    head, slip, finger, found = result.headline, result.full_slip, result.finger, dict[str, float]()
    state: Any = slip
    length = 1.0
    if head.of == WHOLE and finger is not None:
        state, length = finger.full_slip, float(finger.states["full_slip"].thickness.sum())
        carried = finger.carried.get("full_slip", {})
        found = {part: head.value * known.get("mu_app", 0.0) for part, known in carried.items()}
        found[OF_TRACES] = head.error - sum(size for part, size in found.items() if part != OF_TRACES)
    elif head.error > 0:
        springs = abs(np.nan_to_num(state.penalty.mu_app))
        found = {MODEL if MODEL in head.parts else MESH: head.error - springs, PENALTY: springs}
    if left := result.record.get("force_error"):
        pulled = 2 * result.scene.numerics.coupling_tolerance * state.f_electrostatic
        found[_TOLERANCE] = (1 + head.value) * (length * left + pulled) / state.f_ext
    return {part: float(size) for part, size in found.items() if size > _ROUNDOFF * head.value}


def _budget(rows: Sequence[dict[str, Any]], numerical: Mapping[str, float]) -> list[dict[str, Any]]:
    """Return rows of standard deviations with those of bounds, the largest first, and their total."""
    spread = math.hypot(*(row["uncertainty"] for row in rows if not row["factor"].startswith(_OF_PEOPLE)))
    more = sorted(numerical.items(), key=lambda pair: -pair[1])
    more.append((_TOTAL, spread + sum(numerical.values())))
    return [*rows, *({"factor": part, "uncertainty": size} for part, size in more)]


class Study:
    """The fingers about a result, as a function of numbers from 0 to 1: ``names`` of factors."""

    def __init__(self, result: Result, progress: Callable[[float], object] = float) -> None:
        """Find the models of roughness and the laws of friction that have a number.

        Args:
            result: with friction at full slip.
            progress: takes the part of the fingers of :func:`main` that is done, from 0 on.

        Raises:
            SceneError: the result has no friction at full slip, or its own closure has no number.
        """
        scene, slip, law = result.scene, result.full_slip, result.scene.friction_law()
        if slip is None or law is None or not slip.mu_app > 0:
            raise SceneError("the scene has no friction at full slip; give a friction and a load that slides")
        own, self.result, self.laws = scene.closure(), result, [law]
        beside, press = laws_beside(scene, slip, result.uncharged), result.uncharged
        if why := friction(scene, slip, own, press).why:
            raise SceneError(f"friction at full slip is not known: by the scene's own roughness {why}")
        for each in beside:
            other: Any = scene.model_copy(update={"friction": each}).friction_law()
            if not any(np.allclose(other.limit(_PRESSURES), one.limit(_PRESSURES), rtol=1e-3) for one in self.laws):
                self.laws.append(other)
        models = closures(own, scene.finger) or {"its own model": own}
        self.missing = {name: why for name, law in models.items() if (why := friction(scene, slip, law, press).why)}
        self.closures = {name: law for name, law in models.items() if name not in self.missing}
        self.names = [*entering(own), *([_MODELS, _COATED] if own.shared else []), _LAW]
        self._progress = progress
        self._every = POINTS * (5 + 2 * len(self.names) - len(entering(own)))  # of both analyses
        self.count = self.lost = 0  # fingers that were computed, and those of them without a number

    def __call__(self, points: Array) -> Array:
        """Return ln µ_app at points, shape (points, factors); that of the largest number where a finger has none."""
        part: Any = dict(zip(self.names, points.T, strict=True))
        factors = {name: SPREADS[name].factor(part[name]) for name in self.names if name in SPREADS}
        if _COATED in part:
            factors[_COATED] = np.interp(part[_COATED], [0, 1], _COATING)
        result, whole, mu_app = self.result, self.result.headline.of == WHOLE, np.empty(len(points))
        chosen = (
            np.minimum(len(of) * part.get(name, 0 * mu_app), len(of) - 1).astype(int)
            for name, of in ((_MODELS, self.closures), (_LAW, self.laws))
        )
        group = np.ravel_multi_index(tuple(chosen), (len(self.closures), len(self.laws)))
        for k, (model, law) in enumerate(itertools.product(self.closures.values(), self.laws)):
            scene = result.scene.model_copy(update={"roughness": model, "friction": law})
            slip: Any = result.full_slip
            self._progress((self.count + (group < k).sum()) / self._every)
            if (mine := group == k).any():
                own = {name: each[mine] for name, each in factors.items()}
                mu_app[mine] = Fingers(scene, slip, result.uncharged, whole, own).mu_app()
        self.count, self.lost = self.count + len(mu_app), self.lost + int(np.isinf(mu_app).sum())
        return np.log(np.minimum(mu_app, mu_app[np.isfinite(mu_app)].max()))

    def words(self) -> list[str]:
        """Return sentences on what is in the factors, and what is not."""
        spreads = ", ".join(f"{name} {SPREADS[name].cv:.3g}" for name in self.names if name in SPREADS)
        found = [f"People, by coefficients of variation: {spreads}.", f"Rough contact: {', '.join(self.closures)}."]
        found += [f"Left out: {words}, since {why}." for words, why in self.missing.items()]
        found += [f"Friction law: {', '.join(type(law).__name__ for law in self.laws)}."]
        if math.isnan(self.result.headline.error):
            found.append("Left out: the error of the solution, which is not known here.")
        if self.lost:
            found.append(f"{self.lost} fingers have no number, since ridges adhere; they take the largest of others.")
        return found


def indices(model: Callable[[Array], Array], groups: Sequence[str], points: int = POINTS) -> list[dict[str, Any]]:
    """Return first and total indices with their errors (95 %) by group of factors, the largest total first.

    The uncertainty of a group is a standard deviation, in the unit of the values.

    Args:
        model: takes numbers from 0 to 1, shape (points, factors), and returns a value for each point.
        groups: name of the group of each factor.
        points: of Sobol's sequence, a power of 2.

    Raises:
        SceneError: SALib is not installed, or all values are the same.
    """
    try:
        from SALib.analyze.sobol import analyze
        from SALib.sample.sobol import sample
    except ImportError:
        raise SceneError(
            "fingerpad uncertainty needs SALib, which is not installed; get it with: pip install "
            "'fingerpad[uncertainty]', or in a clone environment/wheels"
        ) from None
    names = [f"x{k}" for k in range(len(groups))]
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names), "groups": [*groups]}
    values = model(sample(problem, points, calc_second_order=False, seed=_SEED))
    if np.ptp(values) == 0:
        raise SceneError("friction is the same for all fingers; its spread comes from nothing")
    found = analyze(problem, values, calc_second_order=False, seed=_SEED)
    parts = np.maximum(found["S1"] + found["ST"], 0.0)
    sizes = np.std(values) * np.sqrt(parts / parts.sum())
    columns = (found[key].tolist() for key in ("S1", "S1_conf", "ST", "ST_conf"))
    every = zip(dict.fromkeys(groups), *columns, sizes.tolist(), strict=True)
    rows = [{each.name: value for each, value in zip(_COLUMNS, row, strict=True)} for row in every]
    return sorted(rows, key=lambda row: -row["total"])


def _draw(file: Path, rows: Sequence[dict[str, Any]]) -> None:
    """Draw the uncertainties as bars, those of a person's traits lighter, bounds and their part of the total red."""
    from fingerpad.results.pictures import style

    sizes, bounds = [row["uncertainty"] for row in rows], ["total" not in row for row in rows]
    spread = sizes[-1] - np.dot(sizes[:-1], bounds[:-1])
    with output.panels(file, "Budget of µ_app at full slip") as (_, (ax,)):
        names = [row["factor"].removeprefix(_OF_PEOPLE) for row in rows]
        colours = [
            (style.CATEGORIES[bound], 0.4 if row["factor"] not in names else 1.0)
            for row, bound in zip(rows, bounds, strict=True)
        ]
        ax.bar_label(ax.barh(names, sizes, color=colours), fmt="%.2g", padding=2)
        ax.barh(names[-1:], [spread], color=style.CATEGORIES[0])
        ax.invert_yaxis()
        ax.set(xlabel=style.plain("spread (blue) or bound (red) of µ_app"), xlim=(0, 1.15 * max(sizes)))
