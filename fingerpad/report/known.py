"""Two bars below the headline of a report: how far friction is solved, and how far it is known, with its parts."""

import math
from typing import TYPE_CHECKING

from fingerpad.report.page import text
from fingerpad.results.closures import KNOWN
from fingerpad.results.style import BLUE, GREY, VERMILION

if TYPE_CHECKING:
    from fingerpad.results.result import Result

_LEFT, _RIGHT, _WIDTH, _ROW = 90.0, 120.0, 720.0, 26.0  # px
_LEAST = 3.0  # px, of the shortest bar
_TICKS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1, 1.5, 2, 3, 5, 10, 20, 50, 100)
_SAID = (
    "Solved: error of mesh and penalty. Known: with each assumption below it changed, by charged cylinders; the parts "
    "are independent."
)


def bars(result: "Result") -> str:
    """Return the figure of a result's band, HTML; empty without one. Its axis is logarithmic."""
    kept = result.record.get(KNOWN, {})
    if not kept or result.full_slip is None:
        return ""
    mu, error = kept["mu_app"], _error(result, kept["whole"])
    rows = [("solved", mu - error, mu + error, BLUE)] if error < mu else []
    rows += [("known", kept["low"], kept["high"], VERMILION)]
    rows += [(part["name"], part["low"], part["high"], GREY) for part in kept["parts"]]
    low, high = math.log(min(row[1] for row in rows)), math.log(max(row[2] for row in rows))
    margin = 0.05 * (high - low)

    def at(value: float) -> float:
        part = (math.log(value) - low + margin) / (high - low + 2 * margin)
        return _LEFT + (_WIDTH - _LEFT - _RIGHT) * part

    end = _ROW * len(rows) + 4
    shown = [tick for tick in _TICKS if low - margin <= math.log(tick) <= high + margin]
    lines = [_line(at(tick), end, "#d0d0d0") + _text(at(tick), end + 16, f"{tick:g}", "middle") for tick in shown]
    lines.append(_line(at(mu), end, "#000"))
    for k, (name, least, most, colour) in enumerate(rows):
        x, y, width = at(least), _ROW * k + 6, max(at(most) - at(least), _LEAST)
        lines.append(_text(_LEFT - 8, y + 13, name, "end"))
        lines.append(f'<rect x="{x:.1f}" y="{y:g}" width="{width:.1f}" height="{_ROW - 10:g}" fill="{colour}"/>')
        lines.append(_text(_WIDTH - _RIGHT + 8, y + 13, f"{least:.3g} to {most:.3g}", "start"))
    lines.append(_text((_LEFT + _WIDTH - _RIGHT) / 2, end + 36, "µ_app (–)", "middle"))
    return (
        f'<figure><svg viewBox="0 0 {_WIDTH:g} {end + 42:g}" role="img" font-size="14" aria-label="How far µ_app is '
        f'solved, and how far it is known">{"".join(lines)}</svg><figcaption>{text(_SAID)}</figcaption></figure>'
    )


def _error(result: "Result", whole: bool) -> float:
    """Return the error of µ_app; infinite where it is not estimated."""
    if whole and result.finger is not None:
        found = result.finger.error.get("full_slip", {}).get("mu_app", math.inf)
    else:
        found = math.nan if result.full_slip is None else result.full_slip.error.mu_app
    return math.inf if math.isnan(found) else found


def _line(x: float, end: float, colour: str) -> str:
    return f'<line x1="{x:.1f}" x2="{x:.1f}" y1="0" y2="{end:g}" stroke="{colour}"/>'


def _text(x: float, y: float, words: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:g}" text-anchor="{anchor}">{text(words)}</text>'
