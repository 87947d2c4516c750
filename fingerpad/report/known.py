"""Two bars below the headline of a report: how far friction is solved, and how far it is known, with its parts."""

import math
from typing import TYPE_CHECKING

from fingerpad.report.page import text
from fingerpad.results.closures import KNOWN
from fingerpad.results.palette import BLUE, GREY, VERMILION

if TYPE_CHECKING:
    from fingerpad.results.result import Result

_LEFT, _RIGHT, _WIDTH, _ROW = 92.0, 110.0, 480.0, 26.0  # px
_LEAST, _APART = 3.0, 34.0  # px, of the shortest bar, and between two ticks
_TICKS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1, 1.5, 2, 3, 5, 10, 20, 50, 100)
_SYMBOL = 'µ<tspan dy="4" font-size="12">app</tspan><tspan dy="-4">&#8203;</tspan>'  # typeset, as SVG has it
_SAID = "Each grey bar has one assumption changed. The band takes these parts as independent."


def bars(result: "Result") -> str:
    """Return the figure of a result's band, HTML; empty without one. Its axis is logarithmic."""
    kept, found = result.record.get(KNOWN, {}), result.headline
    if not found.known:
        return ""
    mu, error = kept["mu_app"], found.error
    rows = [("solved to", mu - error, mu + error, BLUE)] if error < mu else []
    rows += [("known to", kept["low"], kept["high"], VERMILION)]
    rows += [(part["name"], part["low"], part["high"], GREY) for part in kept["parts"]]
    low, high = math.log(min(row[1] for row in rows)), math.log(max(row[2] for row in rows))
    margin = 0.05 * (high - low)

    def at(value: float) -> float:
        part = (math.log(value) - low + margin) / (high - low + 2 * margin)
        return _LEFT + (_WIDTH - _LEFT - _RIGHT) * part

    end = _ROW * len(rows) + 4
    shown = list[float]()
    for tick in (each for each in _TICKS if low - margin <= math.log(each) <= high + margin):
        if not shown or at(tick) - at(shown[-1]) >= _APART:
            shown.append(tick)
    lines = [_line(at(tick), end, "#d0d0d0") + _text(at(tick), end + 16, f"{tick:g}", "middle") for tick in shown]
    lines.append(_line(at(mu), end, "#000"))
    for k, (name, least, most, colour) in enumerate(rows):
        x, y, width = at(least), _ROW * k + 6, max(at(most) - at(least), _LEAST)
        lines.append(_text(_LEFT - 8, y + 13, text(name), "end"))
        lines.append(f'<rect x="{x:.1f}" y="{y:g}" width="{width:.1f}" height="{_ROW - 10:g}" fill="{colour}"/>')
        lines.append(_text(_WIDTH - _RIGHT + 8, y + 13, f"{least:.2f} to {most:.2f}", "start"))
    lines.append(_text((_LEFT + _WIDTH - _RIGHT) / 2, end + 36, f"{_SYMBOL} of the {found.of} (–)", "middle"))
    return (
        f'<figure class="bars"><svg viewBox="0 0 {_WIDTH:g} {end + 42:g}" role="img" font-size="15" '
        f'aria-label="How far µ_app is solved, and how far it is known">{"".join(lines)}</svg>'
        f"<figcaption>{text(_SAID)}</figcaption></figure>"
    )


def _line(x: float, end: float, colour: str) -> str:
    return f'<line x1="{x:.1f}" x2="{x:.1f}" y1="0" y2="{end:g}" stroke="{colour}"/>'


def _text(x: float, y: float, words: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:g}" text-anchor="{anchor}">{words}</text>'
