"""``fingerpad estimate --over KEY --over KEY``: a heat map over two keys, as a table and a picture."""

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fingerpad.cli import output, ranges
from fingerpad.cli.arguments import echo, refuse_twice, several
from fingerpad.results.quantities import PER_LENGTH, Output
from fingerpad.results.terminal import watched
from fingerpad.runs.axis import Axis
from fingerpad.runs.batch import progress
from fingerpad.runs.two_keys import TwoKeys, two_keys
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError, clip, show
from fingerpad.scene.remarks import LEAKAGE, remarks
from fingerpad.slices import errors

if TYPE_CHECKING:
    from matplotlib.axis import Axis as MatplotlibAxis

_OPTIONS = ("force", "f_ext", "voltage")
_RATIO = 8.0
"""Of values, from which on the colours have equal ratios."""


def main(args: argparse.Namespace, scene: Scene) -> int:
    """Print a map and write its files; return the exit code.

    Args:
        args: the options of ``fingerpad estimate``, with ``over``.
        scene: of all other keys.
    """
    over = _over(args.over)
    for key in _OPTIONS:
        if getattr(args, key) is None:
            continue
        option = f"--{key.replace('_', '-')}"
        if key in over:
            raise SceneError(f"--over {key} is given and {option} too; write the values as --over {key}=0:200:5")
        if {key, *over} >= {"force", "f_ext"}:
            raise SceneError(f"{option} is given, and --over varies the other force; give one of the two")
        refuse_twice(args, key, option)
        values = several(args, scene, key)
        if len(values) > 1:
            raise SceneError(f"{option} has {len(values)} values beside --over; give one value, or --over {key}=RANGE")
        scene = scene.replace(**{key: values[0]})
    with progress(not watched()) as bar:
        found = two_keys(scene, over, args.target or "", lambda points: bar.track(points, description="points"))
    echo(text(found))
    echo()
    notes = errors.remarks([found.scene.force]) if found.scene.force and "force" not in over else []
    notes = notes if found.target.whole else [PER_LENGTH]
    if args.target and not found.crossed:
        notes = [f"{found.target} is not reached at any point.", *notes]
    for note in (*notes, LEAKAGE, *(f"{each}." for each in remarks(scene)), *_lost(found)):
        echo(note)
    columns = [output.ERROR_KNOWN, *(Output(axis.key, "") for axis in found.axes), found.target.quantity]
    output.write_files(args, columns, [*found.rows()], partial(draw, found, bool(args.target)))
    return 0


def _over(given: Sequence[str]) -> dict[str, list[float | str]]:
    """Return the values of each key of ``--over KEY`` or ``--over KEY=RANGE``; none without a range.

    Raises:
        SceneError: a key is given twice, or there are not two.
    """
    found: dict[str, list[float | str]] = {}
    for text in given:
        key, equals, values = (part.strip() for part in text.partition("="))
        if not key or (equals and not values):
            raise SceneError(f"--over is {show(text)}; write it as --over voltage or --over voltage=0:200:5")
        if key in found:
            raise SceneError(f"--over {clip(key)} is given twice; a map is over two different keys")
        found[key] = ranges.read(f"--over {key}", values) if equals else []
    if len(found) != 2:
        raise SceneError(f"--over is given {len(found)} time{'s' * (len(found) > 1)}; a map is over two keys, and "
                         "fingerpad sweep varies any number")  # fmt: skip
    return found


def text(found: TwoKeys) -> str:
    """Return what the map is of, and its values: a line for each value of the first key."""
    quantity, (down, across) = found.target.quantity, found.axes
    of = " of the whole finger" if found.target.whole else " of the section"
    at = f", {found.scene.force:g} N" if found.scene.force and "force" not in (down.key, across.key) else ""
    title = quantity.title[0].upper() + quantity.title[1:]
    lines = [f"{title}{of} at full slip by a closed form{at}; {down.key} down, {across.key} across."]
    shown = [_shown(axis, keys) for axis, keys in zip(found.axes, found.keys, strict=True)]
    cells = [["", *shown[1]]]
    for j, head in enumerate(shown[0]):
        cells.append([head, *(quantity.shown(float(value)) for value in found.values[j, :])])
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines += ["", *("  ".join(map(str.rjust, row, widths)).rstrip() for row in cells)]
    lines.append(f"\nThe error{of} is known at {found.known.sum()} of {found.known.size} points.")
    return "\n".join(lines)


def _shown(axis: Axis, keys: Sequence[float]) -> list[str]:
    unit, factor = _unit(axis)
    return [f"{key * factor:.4g} {unit}".rstrip() for key in keys]


def _unit(axis: Axis) -> tuple[str, float]:
    """Return the unit in which an axis shows its values, and the factor from SI."""
    unit = axis.shown(axis.high).partition(" ")[2]
    return (unit, 1e6) if unit == "µm" else (unit, 1.0)


def _lost(found: TwoKeys) -> list[str]:
    count = len(found.lost)
    return [] if not count else [f"{count} of {found.values.size} points have no answer. {found.lost[0]}"]


def draw(found: TwoKeys, line: bool, file: Path, _: Sequence[dict[str, Any]]) -> None:
    """Draw the map: colours, the target's line, hatched where the error is not known.

    Args:
        found: the map.
        line: whether its target is drawn.
        file: picture.
    """
    quantity, of = found.target.quantity, "whole finger" if found.target.whole else "section"
    title = f"{quantity.symbol} of the {of} at full slip, closed form"
    with output.panels(file, title) as (figure, (ax,)):
        from fingerpad.results import style

        y_axis, x_axis = found.axes
        y, x = (np.array(keys) * _unit(axis)[1] for axis, keys in zip(found.axes, found.keys, strict=True))
        values = np.ma.masked_invalid(found.values * quantity.scale)
        least, most = float(values.min()), float(values.max())
        shading: Literal["nearest", "gouraud"] = "nearest" if np.ma.is_masked(values) else "gouraud"
        norm = "log" if least > 0 and most > _RATIO * least else "linear"
        mesh = ax.pcolormesh(x, y, values, shading=shading, cmap=style.MAGNITUDE, norm=norm)
        if not found.known.all():
            unknown = ax.contourf(x, y, found.known, levels=[-1, 0.5], colors="none", hatches=["/"])
            unknown.set(edgecolor="white", linewidth=0)
        if line and found.crossed:
            reached = np.ma.masked_invalid(found.reached)
            ax.contour(x, y, reached, levels=[found.target.value], colors=style.VERMILION, linewidths=3)
            ax.plot([], [], color=style.VERMILION, lw=3, label=str(found.target))
            ax.legend(loc="upper left", frameon=True)
        elif line:
            ax.set_title(f"{found.target} is not reached here")
        for each, set_scale, ticks in ((x_axis, ax.set_xscale, ax.xaxis), (y_axis, ax.set_yscale, ax.yaxis)):
            set_scale("log" if each.logarithmic else "linear")
            if each.logarithmic:
                _plain_numbers(ticks)
        labels = [f"{each.key} ({_unit(each)[0]})" if each.unit else each.key for each in (x_axis, y_axis)]
        dots = "" if found.known.all() else "\n(hatched: error not known)"
        ax.set(xlabel=labels[0] + dots, ylabel=labels[1])
        bar = figure.colorbar(mesh, ax=ax, label=style.plain(f"{quantity.symbol} ({quantity.unit or '–'})"))
        if norm == "log":
            _plain_numbers(bar.ax.yaxis)


def _plain_numbers(axis: "MatplotlibAxis") -> None:
    """Give a logarithmic axis ticks at 1, 2 and 5, with plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
