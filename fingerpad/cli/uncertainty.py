r"""``fingerpad uncertainty``: what the spread of friction comes from, by Sobol's indices on the closed form.

µ_app at full slip is computed for fingers that differ in all of these at once:

- people: the spreads of :mod:`fingerpad.scene.people`;
- rough contact: the models of roughness that have a number, each as likely;
- friction law: that of the scene, Coulomb's, or a shear stress, with the same friction without voltage, each as likely;
- coating: its thickness 20 % smaller to larger;
- solution: the known error of the closed form, to either side.

The indices are parts of the variance of :math:`\ln \mu_{app}`: the *first* is that of one factor alone, the *total*
that with all that it has in common with others. I. M. Sobol' 2001, Math. Comput. Simul. 55, 271; estimators of Saltelli
et al. 2010, doi 10.1016/j.cpc.2009.09.018, by SALib (Herman and Usher 2017, doi 10.21105/joss.00097, MIT licence).
"""

import itertools
import time
from collections.abc import Callable, Sequence
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
from fingerpad.results.quantities import Output
from fingerpad.results.result import Result
from fingerpad.results.terminal import Console
from fingerpad.runs.solve import run
from fingerpad.scene.messages import SceneError
from fingerpad.scene.people import SPREADS

Array = NDArray[np.float64]
_EXAMPLES = """
    fingerpad uncertainty
    fingerpad uncertainty scene.toml --set force="0.5 N" --plot parts.png --csv parts.csv
"""
POINTS = 256
"""Points of Sobol's sequence. There are as many fingers for each factor, and twice as many besides."""
_SEED = 1  # of scrambling and of resampling
_COATING = (0.8, 1.2)
_PEOPLE, _MODELS, _LAW, _COATED, _SOLUTION = "people", "rough contact", "friction law", "coating", "solution"
_OF_PEOPLE = f"{_PEOPLE}: "
_PRESSURES = np.array([1e3, 1e5])  # Pa, at which two laws are the same
_COLUMNS = tuple(Output(name, "", digits=2) for name in ("factor", "first", "first_error", "total", "total_error"))


def main(argv: Sequence[str]) -> int:
    """Print what the spread of friction comes from; return the exit code."""
    parser = Parser("uncertainty", _EXAMPLES)
    parser.add_scene()
    output.add_files(parser, _COLUMNS, "picture of the total indices")
    args = parser.read(argv)
    begin, result = time.perf_counter(), run(scene_of(args, meshed=False), model="cylinders")
    with closing(Console(Serial(), lines=False)) as console:  # type: ignore[arg-type]  # its rank
        study, head = Study(result, partial(console.phase, "fingers by the closed form")), result.headline
        rows = indices(study, [_PEOPLE if name in SPREADS else name for name in study.names])
        place = next(k for k, row in enumerate(rows) if row["factor"] == _PEOPLE) + 1
        each = [row for row in indices(study, study.names) if row["factor"] in SPREADS]
    rows[place:place] = [row | {"factor": _OF_PEOPLE + row["factor"]} for row in each]
    echo(f"Parts of the variance of ln {head.symbol} of the {head.of}, {head.at}, about {head.value:.3g}:")
    echo(output.text(_COLUMNS, rows))
    echo("\n".join(study.words()))
    echo(f"{study.count} fingers by the closed form in {time.perf_counter() - begin:.2g} s; errors are for 95 %.")
    output.write_files(args, _COLUMNS, rows, _draw)
    return 0


class Study:
    """The fingers about a result of the closed form, as a function of numbers from 0 to 1: ``names`` of factors."""

    def __init__(self, result: Result, progress: Callable[[float], object] = float) -> None:
        """Find the models of roughness and the laws of friction that have a number.

        Args:
            result: of the closed form.
            progress: takes the part of the fingers of :func:`main` that is done, from 0 on.

        Raises:
            SceneError: the result has no friction at full slip, or its own closure has no number.
        """
        scene, slip, law = result.scene, result.full_slip, result.scene.friction_law()
        if slip is None or law is None or not slip.mu_app > 0:
            raise SceneError("the scene has no friction at full slip; give a friction and a load that slides")
        own, self.result, self.laws = scene.closure(), result, [law]
        if why := friction(scene, slip, own, None).why:
            raise SceneError(f"friction at full slip is not known: by the scene's own roughness {why}")
        for each in laws_beside(scene, slip):
            other: Any = scene.model_copy(update={"friction": each}).friction_law()
            if not any(np.allclose(other.limit(_PRESSURES), one.limit(_PRESSURES), rtol=1e-3) for one in self.laws):
                self.laws.append(other)
        models = closures(own) or {"its own model": own}
        self.missing = {name: why for name, law in models.items() if (why := friction(scene, slip, law, None).why)}
        self.closures = {name: law for name, law in models.items() if name not in self.missing}
        known = [_SOLUTION] if np.isfinite(result.headline.error) else []
        self.names = [*entering(own), *([_MODELS, _COATED] if own.shared else []), _LAW, *known]
        self._progress = progress
        self._every = POINTS * (5 + 2 * len(self.names) - len(entering(own)))  # of both analyses
        self.count = self.lost = 0  # fingers that were computed, and those of them without a number

    def __call__(self, points: Array) -> Array:
        """Return ln µ_app at points, shape (points, factors); that of the largest number where a finger has none."""
        part: Any = dict(zip(self.names, points.T, strict=True))
        factors = {name: SPREADS[name].factor(part[name]) for name in self.names if name in SPREADS}
        if _COATED in part:
            factors[_COATED] = np.interp(part[_COATED], [0, 1], _COATING)
        result, head, mu_app = self.result, self.result.headline, np.empty(len(points))
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
                mu_app[mine] = Fingers(scene, slip, None, head.of == WHOLE, own).mu_app()
        self.count, self.lost = self.count + len(mu_app), self.lost + int(np.isinf(mu_app).sum())
        mu_app = np.minimum(mu_app, mu_app[np.isfinite(mu_app)].max())
        share = head.error / head.value if _SOLUTION in part else 0.0
        return np.log(mu_app * (1 + share * (2 * part.get(_SOLUTION, 0.5) - 1)))

    def words(self) -> list[str]:
        """Return sentences on what is in the factors, and what is not."""
        spreads = ", ".join(f"{name} {SPREADS[name].cv:.3g}" for name in self.names if name in SPREADS)
        found = [f"People, by coefficients of variation: {spreads}.", f"Rough contact: {', '.join(self.closures)}."]
        found += [f"Left out: {words}, since {why}." for words, why in self.missing.items()]
        found += [f"Friction law: {', '.join(type(law).__name__ for law in self.laws)}."]
        if _SOLUTION not in self.names:
            found.append("Left out: the error of the closed form, which is not known here.")
        if self.lost:
            found.append(f"{self.lost} fingers have no number, since ridges adhere; they take the largest of others.")
        return found


def indices(model: Callable[[Array], Array], groups: Sequence[str], points: int = POINTS) -> list[dict[str, Any]]:
    """Return first and total indices with their errors (95 %) by group of factors, the largest total first.

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
    columns = zip(dict.fromkeys(groups), *(found[key] for key in ("S1", "S1_conf", "ST", "ST_conf")), strict=True)
    rows = [{each.name: value for each, value in zip(_COLUMNS, row, strict=True)} for row in columns]
    return sorted(rows, key=lambda row: -row["total"])


def _draw(file: Path, rows: Sequence[dict[str, Any]]) -> None:
    """Draw the total indices as bars, those of a person's traits lighter."""
    from fingerpad.results.pictures import style

    with output.panels(file, "What the spread of µ_app at full slip comes from") as (_, (ax,)):
        colours = ["0.7" if row["factor"].startswith(_OF_PEOPLE) else style.CATEGORIES[0] for row in rows]
        totals, errors = ([row[key] for row in rows] for key in ("total", "total_error"))
        ax.barh([row["factor"].removeprefix(_OF_PEOPLE) for row in rows], totals, xerr=errors, color=colours)
        ax.invert_yaxis()
        ax.set(xlabel=style.plain("total index: part of the variance of ln µ_app"), xlim=(0, None))
