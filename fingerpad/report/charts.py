"""Charts of a report as inline SVG: drawn without a script, which shows the values below a pointer (``page.js``)."""

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from fingerpad.report.page import render

COLOURS = ("blue", "vermilion", "green", "purple", "orange", "ink")
DASHES = ("", "6 3", "2 3", "8 3 2 3", "10 4")
_WIDTH, _LEFT, _RIGHT, _TOP, _FOOT, _GAP = 560.0, 48.0, 16.0, 22.0, 42.0, 30.0  # px
_MARGIN = 0.05  # of the span of values
_TICK = 0.4  # half of the height of a spike
_ROW = 26.0  # px, of a bar
_BEND = 0.02  # px, between a point and the line of its neighbours that has it


@dataclass(frozen=True)
class Series:
    """Values over the scale along x; NaN breaks a line."""

    name: str
    x: Sequence[float] | np.ndarray
    y: Sequence[float] | np.ndarray
    kind: str = "line"
    """``line``, ``points``, ``both``, or ``ticks``, short upright lines."""
    colour: str = "ink"
    """A variable of ``page.css``."""
    dash: str = ""
    error: Sequence[float] = ()
    """Of each value, shown as a bar; NaN without one."""
    labels: Sequence[str] = ()
    """Of each value, shown below the pointer."""


@dataclass(frozen=True)
class Panel:
    """Series with one scale."""

    label: str
    series: Sequence[Series]
    height: float = 140.0
    """px, where the chart is 560 wide."""
    ends: tuple[float, float] | None = None
    """Of the scale; by default those of the values."""
    zero: bool = False
    """Whether zero is on the scale."""
    image: str = ""
    """Link of a picture that fills the panel."""


def chart(
    panels: Sequence[Panel],
    along: str,
    words: str,
    *,
    ends: tuple[float, float] | None = None,
    names: Sequence[str] = (),
    lines: Iterable[float] = (),
    spans: Sequence[tuple[float, float, str]] = (),
    legend: bool = True,
) -> Markup:
    """Return a chart of panels below each other.

    Args:
        panels: from the top.
        along: title of the scale along x, which they share.
        words: for those who do not see the chart.
        ends: of the scale along x; by default those of all values.
        names: at 0, 1, … along x, in place of numbers.
        lines: places along x of dotted lines through all panels.
        spans: parts of the scale along x, of which the script shows these words.
        legend: whether the series are named below the chart.
    """
    every = [float(x) for panel in panels for series in panel.series for x in series.x if not math.isnan(x)]
    left, right = ends or _ends(every, 0.0, 0.7 if names else 0.0)

    def across(x: float) -> float:
        return _LEFT + (x - left) / (right - left) * (_WIDTH - _LEFT - _RIGHT)

    drawn, top = [], _TOP
    for panel in panels:
        drawn.append(_panel(panel, top, across))
        top += panel.height + _GAP
    ticks = [(across(k), name) for k, name in enumerate(names)] or [(across(x), f"{x:g}") for x in _ticks(left, right)]
    shown = {series.name: series for panel in panels for series in panel.series if series.name}
    return render(
        "chart.svg", panels=drawn, ticks=ticks, foot=top - _GAP, along=along, words=words, width=_WIDTH, left=_LEFT,
        right=_WIDTH - _RIGHT, height=top - _GAP + _FOOT, scale=f"{left:.9g} {right:.9g}",
        lines=[across(x) for x in lines], legend=list(shown.values()) if legend and len(shown) > 1 else [],
        spans=json.dumps(spans, ensure_ascii=False) if spans else "",
    )  # fmt: skip


def _ends(values: Sequence[float], margin: float, more: float = 0.0) -> tuple[float, float]:
    """Return the ends of a scale of values, with a part of their span and a number more on either side."""
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    beyond = margin * (high - low) + more or (0.0 if high > low else abs(high) or 1.0)
    return low - beyond, high + beyond


def _ticks(low: float, high: float) -> list[float]:
    """Return at most seven multiples of 1, 2 or 5 times a power of ten within a scale."""
    power = 10.0 ** math.floor(math.log10((high - low) / 6))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor * 6 >= high - low)
    return [float(f"{k * step:.6g}") for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _panel(panel: Panel, top: float, across: Any) -> dict[str, Any]:
    values = [
        float(end)
        for series in panel.series
        for k, y in enumerate(series.y)
        if not math.isnan(y)
        for end in (y, *_error(series, k, y))
    ]
    low, high = panel.ends or _ends([*values, 0.0] if panel.zero else values, _MARGIN)
    low = 0.0 if panel.zero and values and min(values) >= 0 else low

    def up(y: float) -> float:
        return top + panel.height * (high - y) / (high - low)

    return {
        "top": top, "height": panel.height, "label": panel.label, "image": panel.image,
        "scale": f"{low:.9g} {high:.9g}",
        "zero": up(0.0) if low < 0 < high else None, "ticks": [(up(y), f"{y:g}") for y in _ticks(low, high)],
        "series": [_drawn(each, across, up) for each in panel.series],
    }  # fmt: skip


def _error(series: Series, k: int, y: float) -> tuple[float, ...]:
    error = float(series.error[k]) if len(series.error) else math.nan
    return () if math.isnan(error) else (y - error, y + error)


def _drawn(series: Series, across: Any, up: Any) -> dict[str, Any]:
    """Return a series as a path and marks, in px."""
    points = np.array([[across(x), up(y)] for x, y in zip(series.x, series.y, strict=True)]).reshape(-1, 2)
    known = [(k, float(x), float(y)) for k, (x, y) in enumerate(points) if not math.isnan(x + y)]
    points[(points[:, 0] < _LEFT - 1) | (points[:, 0] > _WIDTH - _RIGHT + 1)] = math.nan
    path = _line(points) if series.kind in ("line", "both") else ""
    if series.kind == "ticks":
        high = _TICK * (up(0) - up(1))
        path = "".join(f"M{x:.1f} {y - high:.1f}v{2 * high:.1f}" for _, x, y in known)
    errors = [
        f"M{x:.1f} {up(ends[0]):.1f}V{up(ends[1]):.1f}" for k, x, _ in known if (ends := _error(series, k, series.y[k]))
    ]
    marks = "" if series.kind == "line" else " ".join(f"{x:.1f},{y:.1f}" for _, x, y in known)
    return {
        "name": series.name, "kind": series.kind, "colour": series.colour, "dash": series.dash, "path": path,
        "errors": "".join(errors), "marks": marks, "dots": known if series.kind in ("points", "both") else [],
        "labels": json.dumps([series.labels[k] for k, *_ in known], ensure_ascii=False) if series.labels else "",
    }  # fmt: skip


def _line(points: Any) -> str:
    """Return a line through points (px), broken at NaN, without those that are on the way between their neighbours."""
    found, begins = list[str](), True
    for k, (x, y) in enumerate(points):
        if math.isnan(x + y):
            begins = True
            continue
        (x0, y0), (x1, y1) = points[max(k - 1, 0)], points[min(k + 1, len(points) - 1)]
        straight = abs((x - x0) * (y1 - y0) - (y - y0) * (x1 - x0)) <= _BEND * math.hypot(x1 - x0, y1 - y0)
        if begins or not straight or k == len(points) - 1:  # NaN beside a point is not straight
            found.append(f"{'M' if begins else 'L'}{x:.1f} {y:.1f}")
        begins = False
    return "".join(found)


def elasticities(rows: Sequence[Any], of: str) -> Markup:
    """Return elasticities as bars to both sides of zero.

    Args:
        rows: :class:`fingerpad.results.slopes.Row`, from the top.
        of: what they are of, in words.
    """
    most = max(abs(row.elasticity) for row in rows)
    middle, scale = _WIDTH * 0.65, _WIDTH * 0.22 / most
    drawn = [(row, _ROW * k + 6, middle + min(row.elasticity * scale, 0.0), abs(row.elasticity) * scale)
             for k, row in enumerate(rows)]  # fmt: skip
    return render("slopes.svg", rows=drawn, middle=middle, width=_WIDTH, foot=_ROW * len(rows) + 4, of=of)
