"""Bars below the headline of a report: how far friction is solved, and its likely range with the parts of it."""

import math
from typing import TYPE_CHECKING

from fingerpad.report.page import text
from fingerpad.results.headline import notes, span
from fingerpad.results.palette import BLUE, GREY, VERMILION
from fingerpad.results.quantities import KNOWN

if TYPE_CHECKING:
    from fingerpad.results.result import Result

_LEFT, _RIGHT, _WIDTH, _ROW = 112.0, 114.0, 480.0, 26.0  # px
_LEAST, _APART = 3.0, 34.0  # px, of the shortest bar, and between two ticks
_TICKS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1, 1.5, 2, 3, 5, 10, 20, 50, 100)
_SYMBOL = 'µ<tspan dy="4" font-size="12">app</tspan><tspan dy="-4">&#8203;</tspan>'  # typeset, as SVG has it
_TIP = 14.0  # px, of the arrow of an open end
_SAID = "Each grey bar has one assumption changed. The band takes these parts as independent."
_OPEN = "An arrow is an open end."


def bars(result: "Result") -> str:
    """Return the figure of a result's band, HTML; empty without one. Its axis is logarithmic."""
    kept, found = result.record.get(KNOWN, {}), result.headline
    if not found.known:
        return ""
    mu, error = kept["mu_app"], found.error
    solved = {"name": "solved to", "low": mu - error, "high": mu + error}
    bands = [(solved, BLUE)] if error < mu else []
    bands += [({"name": "likely range", **kept}, VERMILION), *((part, GREY) for part in kept["parts"])]
    every = [part[key] for part, _ in bands for key in ("low", "high", "at_least") if part.get(key) is not None]
    low, high = math.log(min(every)), math.log(max(every))
    margin = 0.05 * (high - low)

    def at(value: float) -> float:
        part = (math.log(value) - low + margin) / (high - low + 2 * margin)
        return _LEFT + (_WIDTH - _LEFT - _RIGHT) * part

    end = _ROW * len(bands) + 4
    shown = list[float]()
    for tick in (each for each in _TICKS if low - margin <= math.log(each) <= high + margin):
        if not shown or at(tick) - at(shown[-1]) >= _APART:
            shown.append(tick)
    lines = [_line(at(tick), end, "#d0d0d0") + _text(at(tick), end + 16, f"{tick:g}", "middle") for tick in shown]
    lines.append(_line(at(mu), end, "#000"))
    for k, (part, colour) in enumerate(bands):
        y, last = _ROW * k + 6, _WIDTH - _RIGHT if part["high"] is None else at(part["high"])
        lines.append(_text(_LEFT - 8, y + 13, text(part["name"]), "end"))
        lines.append(_bar(at(part["low"]), last, y, colour, part["high"] is None))
        lines.append(_text(_WIDTH - _RIGHT + 8, y + 13, span(part), "start"))
    lines.append(_text((_LEFT + _WIDTH - _RIGHT) / 2, end + 36, f"{_SYMBOL} of the {found.of} (–)", "middle"))
    said = [_SAID, *([_OPEN] if kept["high"] is None else [])]
    said += [note for part in kept["parts"] for note in notes(part)]
    return (
        f'<figure class="bars"><svg viewBox="0 0 {_WIDTH:g} {end + 42:g}" role="img" font-size="15" '
        f'aria-label="How far µ_app is solved, and its likely range">{"".join(lines)}</svg>'
        f"<figcaption>{text(' '.join(said))}</figcaption></figure>"
    )


def _line(x: float, end: float, colour: str) -> str:
    return f'<line x1="{x:.1f}" x2="{x:.1f}" y1="0" y2="{end:g}" stroke="{colour}"/>'


def _bar(x: float, end: float, y: float, colour: str, arrow: bool) -> str:
    """Return a bar from x to an end (px), whose end is an arrow where it is open."""
    width, height = max(end - x - _TIP, 0.0) if arrow else max(end - x, _LEAST), _ROW - 10
    bar = f'<rect x="{x:.1f}" y="{y:g}" width="{width:.1f}" height="{height:g}" fill="{colour}"/>'
    tip = f"M{end - _TIP:.1f} {y - 3:g}L{end:.1f} {y + height / 2:g}L{end - _TIP:.1f} {y + height + 3:g}Z"
    return bar + (f'<path d="{tip}" fill="{colour}"/>' if arrow else "")


def _text(x: float, y: float, words: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:g}" text-anchor="{anchor}">{words}</text>'
