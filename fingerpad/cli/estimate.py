"""``fingerpad estimate``, a sweep by the closed form without a folder, and ``fingerpad solve``, its inverse."""

import inspect
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad.cli import output, ranges
from fingerpad.cli.arguments import PICTURE, Kind, Parser, echo, refuse_file, refuse_twice, scene_of
from fingerpad.model.cautions import examine
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.results.quantities import FINGER, QUANTITIES, Output
from fingerpad.runs import inverse
from fingerpad.runs.roots import Axis
from fingerpad.runs.solve import MODELS
from fingerpad.runs.sweep import sweep
from fingerpad.runs.sweep_columns import head_of, printed
from fingerpad.runs.sweep_results import Sweep
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError, clip, show

_EXAMPLES = """
    fingerpad estimate --force "0.1, 0.3, 0.5 N" --voltage 0,100,200
    fingerpad estimate --force "0.5 N" --voltage 0:200:41 --plot mu.png
    fingerpad estimate --over voltage --over electric.d_i --target 0.5 --plot map.png --csv map.csv
    fingerpad estimate --set friction=0.3 --f-ext 50 --voltage 0,100,200 --csv mu.csv
"""
_SOLVE = """
    fingerpad solve --target mu_app=0.4 --over voltage
    fingerpad solve --target "f_t=0.3 N" --set force="0.5 N"
    fingerpad solve --target mu_app=1.1 --relative --over electric.d_i --from "0.5 um" --to "5 um"
"""
_KEYS = ("force", "f_ext", "voltage")
_COUNT = 11  # values of a key without a range of its own
_CURVES = 6  # values of a key up to which each has a curve; two keys with more are a heat map
_RATIO = 8.0  # of values, from which on the colours have equal ratios


def main(argv: Sequence[str]) -> int:
    """Estimate friction over a grid; return the exit code."""
    parser = Parser("estimate", _EXAMPLES)
    parser.add_scene()
    parser.add_ranges(*_KEYS)
    words = f"a further key and its values, as voltage=0:400:11; without them {_COUNT} of its default range"
    parser.add_argument("--over", action="append", default=[], metavar="KEY[=RANGE]", help=words)
    words = "quantity of the picture (default: %(default)s)"
    parser.add_argument("--quantity", choices=[*dict.fromkeys([*FINGER, *QUANTITIES])], default="mu_app", help=words)
    parser.add_argument("--target", type=float, metavar="VALUE", help="value (SI) of it that is drawn as a line")
    parser.add_file("--plot", PICTURE, "picture over one key or two: curves, or a heat map")
    parser.add_file("--csv", Kind("a table", (".csv",)), "table in SI units; results are unrounded")
    args = parser.read(argv)
    scene = scene_of(args, meshed=False)
    Cylinders().check(scene)
    over = _over(args, scene)
    if own := next((key for key in over if key in inspect.signature(sweep).parameters), None):
        raise SceneError(f"{own} is varied and is no key of a scene")
    if args.plot and len(over) > 2:
        raise SceneError(f"--plot is given, and {len(over)} keys are varied; a picture is over one key or two")
    if args.csv:
        refuse_file(args.csv, Kind("a table", (".csv",), f"{next(iter(over))},"))
    options: dict[str, Any] = {"model": Cylinders.name, **over}
    found = sweep(scene.replace(force=None) if "f_ext" in over else scene, None, **options)
    if all(result.failure for result in found.results):
        last = found.results[-1]
        raise SceneError("; ".join(map(str, (last.failure, *examine("load", last.scene)))))
    echo(str(found))
    if args.csv:
        found.to_csv(args.csv)
    if args.plot:
        draw(found, args.plot, args.quantity, args.target)
    for file in (args.csv, args.plot):
        if file is not None:
            echo(f"Written: {file}")
    return 0


def _over(args: Any, scene: Scene) -> dict[str, list[Any]]:
    """Return the values of each key that options vary; without any, the force of the scene.

    Raises:
        SceneError: a key is given twice, or a range is none.
    """
    found = dict[str, list[Any]]()
    for key in _KEYS:
        option = f"--{key.replace('_', '-')}"
        refuse_twice(args, key, option)
        if getattr(args, key) is not None:
            found[key] = ranges.read(option, getattr(args, key))
    for text in args.over:
        key, equals, values = (part.strip() for part in text.partition("="))
        if not key or (equals and not values):
            raise SceneError(f"--over is {clip(text) or 'empty'}; write it as --over voltage or --over voltage=0:200:5")
        if key in found:
            raise SceneError(f"--over {clip(key)} is given, and its values are given already; give all in one")
        found[key] = ranges.read(f"--over {key}", values) if equals else Axis.of(scene, key).spread(_COUNT)
    if {"force", "f_ext"} <= found.keys():
        raise SceneError("--force is given and --f-ext too; give newtons on the whole finger or N/m at its centre")
    here = "f_ext" if scene.force is None else "force"
    return found or {here: [getattr(scene, here)]}


# -- pictures ------------------------------------------------------------------------------------------------
def draw(found: Sweep, file: Path, name: str = "mu_app", target: float | None = None) -> None:
    """Draw a quantity at full slip over one key or two: a curve for each value of one, or a heat map.

    Args:
        found: a sweep over one key or two.
        file: picture.
        name: of a quantity; it is that of the whole finger where it has that.
        target: value (SI) that is drawn as a line.

    Raises:
        SceneError: the quantity is not there, or neither key has numbers.
    """
    rows = found.rows()
    whole = any(f"full_slip_finger_{name}" in row for row in rows)
    column, quantity = f"full_slip_{'finger_' * whole}{name}", FINGER[name] if whole else QUANTITIES[name]
    values, errors = (
        np.array([row.get(key, math.nan) for row in rows], dtype=float).reshape([len(v) for v in found.axes.values()])
        for key in (column, f"{column}_error")
    )
    if not np.isfinite(values).any():
        raise SceneError(f"{name} is at no point of the table; take another quantity for the picture")
    over = sorted(found.axes, key=lambda key: (_numeric(found.axes[key]), len(found.axes[key])))  # the last is across
    if over != list(found.axes):
        values, errors = values.T, errors.T
    x = found.axes[over[-1]]
    if not _numeric(x):
        raise SceneError(f"{over[-1]} has no numbers; a picture is over a key that has")
    title = f"{quantity.symbol} of the {'whole finger' if whole else 'section'} at full slip, closed form"
    with output.panels(file, title) as (figure, (ax,)):
        of = [found.axes[key] for key in over[:-1]]
        if of and len(of[0]) > _CURVES and _numeric(of[0]):
            _map(figure, ax, (np.array(x), np.array(of[0])), quantity, values, errors, target)
            ax.set(ylabel=head_of(over[0]))
        else:
            for k, (value, error) in enumerate(zip(np.atleast_2d(values), np.atleast_2d(errors), strict=True)):
                label = printed(of[0][k]) if of else "_"
                output.curve(ax, k, x, value * quantity.scale, label, error=np.nan_to_num(error) * quantity.scale)
            if target is not None:
                ax.axhline(target * quantity.scale, color="0.4", ls=":")
            ax.set(ylabel=quantity.title)
            if of:
                ax.legend(title=head_of(over[0]))
        ax.set(
            xlabel=head_of(over[-1]) + ("" if np.isfinite(errors).all() else "\n(hatched, or no band: error not known)")
        )


def _numeric(values: Sequence[Any]) -> bool:
    return all(isinstance(value, int | float) for value in values)


def _map(figure: Any, ax: Any, at: Any, quantity: Output, values: Any, errors: Any, target: float | None) -> None:
    """Draw a heat map, hatched where the error is not known, with a line at a target."""
    from fingerpad.results.pictures import style

    shown = np.ma.masked_invalid(values * quantity.scale)
    low, high = float(shown.min()), float(shown.max())
    shading = "nearest" if np.ma.is_masked(shown) else "gouraud"
    norm = "log" if low > 0 and high > _RATIO * low else "linear"
    mesh = ax.pcolormesh(*at, shown, shading=shading, cmap=style.MAGNITUDE, norm=norm)
    if not (known := np.isfinite(errors)).all():
        ax.contourf(*at, known, levels=[-1, 0.5], colors="none", hatches=["/"])
    if target is not None and low <= target * quantity.scale <= high:
        ax.contour(*at, shown, levels=[target * quantity.scale], colors=style.VERMILION, linewidths=3)
    for set_scale, each in zip((ax.set_xscale, ax.set_yscale), at, strict=True):
        set_scale("log" if each.min() > 0 and each.max() > _RATIO * each.min() else "linear")
    figure.colorbar(mesh, ax=ax, label=style.plain(quantity.title))


# -- the inverse -----------------------------------------------------------------------------------------------
def solve(argv: Sequence[str]) -> int:
    """Find the values of a key; return the exit code."""
    parser = Parser("solve", _SOLVE)
    parser.add_scene()
    words = "at full slip, as mu_app=0.4 or 'f_t=0.3 N'; as many as keys"
    parser.add_argument("--target", action="append", default=[], metavar="QUANTITY=VALUE", help=words)
    words = "the targets are multiples of values without voltage: mu_app=2 is twice the friction"
    parser.add_argument("--relative", action="store_true", help=words)
    words = "key that is varied (default: voltage); may be given again"
    parser.add_argument("--over", action="append", default=[], metavar="KEY", help=words)
    words = "value of another key for each target in order, as voltage=0,200; one --at for each key"
    parser.add_argument("--at", action="append", default=[], metavar="KEY=RANGE", help=words)
    words = "value of the key, also with a unit; of several keys in order"
    parser.add_argument("--from", action="append", default=[], dest="low", metavar="VALUE", help=f"first {words}")
    parser.add_argument("--to", action="append", default=[], dest="high", metavar="VALUE", help=f"last {words}")
    words = "full: from the closed form on by whole runs (default: %(default)s)"
    parser.add_argument("--model", choices=MODELS, default=Cylinders.name, help=words)
    args = parser.read(argv)
    over, targets = args.over or ["voltage"], dict[str, list[float | str]]()
    for name, value in _pairs("target", args.target, "a quantity and its value, as --target mu_app=0.4"):
        if name in inspect.signature(inverse.solve).parameters:
            raise SceneError(f"target is {show(f'{name}={value}')}; {name} is no quantity, such as mu_app")
        targets.setdefault(name, []).append(_number(value))
    if len(args.low) != len(args.high) or len(args.low) not in (0, len(over)):
        raise SceneError(f"one of --from and --to is given without the other; give both, or none for {clip(over[0])}")
    between: list[Any] = [[_number(low), _number(high)] for low, high in zip(args.low, args.high, strict=True)]
    at = {key: ranges.read(f"--at {key}", text) for key, text in _pairs("at", args.at, "a key and its values")}
    options: dict[str, Any] = {"relative": args.relative, "model": args.model, "at": at, **targets}
    options["between"] = between if len(over) > 1 else between[0] if between else None
    echo(str(inverse.solve(scene_of(args, meshed=False), over, **options)))
    return 0


def _pairs(option: str, given: Sequence[str], what: str) -> list[tuple[str, str]]:
    """Return the two sides of each text of an option."""
    found = [tuple(part.strip() for part in text.partition("=")[::2]) for text in given]
    for text, (name, value) in zip(given, found, strict=True):
        if not (name and value):
            raise SceneError(f"{option} is {show(text)}; give {what}")
    return found  # type: ignore[return-value]


def _number(text: str) -> float | str:
    """Return a number, or a text that may have a unit."""
    try:
        return float(text)
    except ValueError:
        return text
