"""Where the error of the model "cylinders" is known, and how large it is there: a table of regions of scenes.

A :class:`Region` has a range by key, and the relative errors of results inside. They are errors of the model beside
full runs, without those of a mesh. Regions are in order, the narrowest first, and the first one that a scene is in has
its errors. Outside of all regions the error is not known, and :func:`cautions` names the key and its range.

:func:`data` is the same table for the calculator, whose ``errors.js`` finds the same region.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any, NamedTuple

from fingerpad.results.quantities import QUANTITIES
from fingerpad.results.states import WORDS
from fingerpad.scene.keys import every
from fingerpad.scene.messages import show
from fingerpad.scene.reading import flat
from fingerpad.scene.scene import Scene

Bands = Mapping[str, Mapping[str, float]]
"""Relative errors by state and quantity."""


@dataclass(frozen=True)
class Region:
    """Scenes in which the error is known."""

    runs: int
    """Full runs beside which it was found."""
    ranges: Mapping[str, tuple[float, float]]
    """Range by dotted key, in SI units; both ends belong to it, and a voltage has no sign. Keys of :data:`_TABLES` that
    are not there have their defaults."""
    errors: Bands
    """Relative errors of a section by state and quantity."""


class Outside(NamedTuple):
    """A key of a scene for whose value the error is not known."""

    key: str
    value: str
    """In words, as the range."""
    known: str
    """The range in which it is."""

    def __str__(self) -> str:
        """Return the sentence."""
        return f"{self.key} is {self.value}, and it is known for {self.known}"


_TABLES = ("friction", "geometry", "materials", "contact", "electric", "roughness")
REGIONS = (
    Region(
        44,
        {"f_ext": (5.0, 150.0), "voltage": (0.0, 200.0)},
        {
            "full_slip": {"mu_app": 0.024, "contact_length": 0.063, "f_electrostatic": 0.05},
            "charged": {"contact_length": 0.1, "f_electrostatic": 0.14},
        },
    ),
)
"""Largest errors beside the runs of docs/models.json, rounded up to 0.1 %: tests/test_known_error.py derives them."""
_ROUNDOFF = 1e-12  # relative, of a value at an end


def where(region: Region) -> str:
    """Return the ranges of a region in words."""
    units = _units()
    return ", ".join(f"{key} {_span(ends, units[key])}" for key, ends in region.ranges.items())


def _span(ends: tuple[float, float], unit: str) -> str:
    words = f"{ends[0]:g}" if ends[0] == ends[1] else f"{ends[0]:g} to {ends[1]:g}"
    return f"{words} {unit}".strip()


def runs(region: Region) -> str:
    """Return the runs of a region in words."""
    return f"{region.runs} full runs at {where(region)}"


def within(value: float, ends: tuple[float, float]) -> bool:
    """Return whether a value is in a range, the ends and roundoff included; its sign does not count."""
    return ends[0] * (1 - _ROUNDOFF) <= abs(value) <= ends[1] * (1 + _ROUNDOFF)


def find(scene: Scene) -> Region | None:
    """Return the narrowest region of a scene; None where its error is not known."""
    return next((region for region in REGIONS if not [*_outside(scene, region)]), None)


def errors(scene: Scene) -> Bands:
    """Return the known relative errors for a scene by state and quantity; empty where none is known."""
    found = find(scene)
    return {} if found is None else found.errors


def outside(scene: Scene) -> list[Outside]:
    """Return the keys for which the error of a scene is not known; empty where it is known."""
    return [] if find(scene) else [*_outside(scene, REGIONS[-1])]


def cautions(scene: Scene) -> list[str]:
    """Return in one sentence why the error is not known for the result of a scene; empty where it is known."""
    keys = outside(scene)
    return [f"the error of this model is not known here: {'; '.join(map(str, keys))}"] if keys else []


def _outside(scene: Scene, region: Region) -> Iterator[Outside]:
    """Yield the keys in which a scene is outside of a region."""
    given, default, units = flat(scene.parameters()) | {"voltage": scene.volts}, _default(), _units()
    for key, ends in region.ranges.items():
        value = given.get(key)
        if not isinstance(value, int | float):
            yield Outside(key, "a law", _span(ends, units[key]))
        elif not within(value, ends):
            yield Outside(key, _span((value, value), units[key]), _span(ends, units[key]))
    for key in sorted(given.keys() | default.keys()):
        if key.partition(".")[0] in _TABLES and key not in region.ranges and given.get(key) != default.get(key):
            yield Outside(key, show(given.get(key)), show(default.get(key)))


@cache
def _default() -> dict[str, Any]:
    return flat(Scene().parameters())


@cache
def _units() -> dict[str, str]:
    return {key.name: key.unit for key in every(Scene)}


def in_words(bands: Bands) -> str:
    """Return what is known of the error of a result in words."""
    if not bands:
        return "the error of this model is not known here"
    states = (
        f"in {WORDS[state]} " + ", ".join(f"{QUANTITIES[key].words} {100 * e:.1f} %" for key, e in each.items())
        for state, each in bands.items()
    )
    return f"error of this model beside full runs: {'; '.join(states)}"


def data(keys: Iterable[str]) -> list[dict[str, Any]]:
    """Return the regions, ready for JSON.

    Args:
        keys: that are to be there, with their defaults where a region has no range of them.
    """
    default = _default()
    fixed = {key: (default[key],) * 2 for key in keys if default.get(key) is not None}
    return [asdict(each) | {"ranges": fixed | dict(each.ranges)} for each in REGIONS]
