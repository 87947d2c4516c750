"""The loads of a state as the words of a picture's title."""

from collections.abc import Mapping, Sequence
from typing import Any

_MM = 1e3
_NOTHING = 1e-9  # N/m, V or mm: what a title calls zero


def plain(words: str) -> str:
    """Return words that a user chose, as of a load or a file, so that a picture shows each character as it is."""
    return words.replace("$", r"\$")


def conditions(f_ext: float, voltage: float, mu_0: float | None, bone_x: float | None = None) -> str:
    """Return f_ext (N/m), U (V), where the bone is sideways (m) and, if known, mu_0 as the words of a title."""
    return loads([(f_ext, voltage, bone_x)]) + _friction(mu_0)


def conditions_of(rows: Sequence[Mapping[str, Any]], mu_0: float | None) -> str:
    """Return the range of f_ext (N/m) and U (V) over several states, and mu_0 if known, as the words of a title."""
    return loads([(row["f_ext"], row["voltage"], None) for row in rows]) + _friction(mu_0)


def loads(states: Sequence[tuple[float, float, float | None]]) -> str:
    """Return the ranges of f_ext (N/m), U (V) and, where it is known, the bone's place (m), over several states."""
    forces, voltages, places = zip(*states, strict=True)
    words = [f"$f_{{ext}}$ = {_range(forces)} N/m", f"$U$ = {_range(voltages)} V"]
    known = [_MM * x for x in places if x is not None]
    return ", ".join([*words, f"bone at $x$ = {_range(known)} mm"] if known else words)


def _friction(mu_0: float | None) -> str:
    return "" if mu_0 is None else f", $\\mu_0$ = {mu_0:.3g}"


def _range(values: Sequence[float]) -> str:
    """Return a value to four digits, or the least and the largest of several, roundoff about zero left out."""
    first, last = (f"{0.0 if abs(v) < _NOTHING else v:.4g}" for v in (min(values), max(values)))
    return first if first == last else f"{first} to {last}"
