"""Presets of the calculator: values of fields that stand for a screen or a finger, each with its source.

A preset sets keys of a scene that the page has a field of. A finger that changes other keys, such as its shape, is not
one that the closed form answers for, and is left out.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from fingerpad.scene import Scene
from fingerpad.scene.fingers import FINGERS, NamedFinger
from fingerpad.scene.reading import flat


@dataclass(frozen=True)
class Preset:
    """Values of some fields."""

    group: str
    """Of the choice that it is in."""
    name: str
    values: Mapping[str, float]
    """By dotted key, in SI units."""
    source: str


_THICK = "Assumption: a common thickness; relative permittivity of handbooks."
SCREENS = (
    Preset("Screen", "default", {"electric.d_i": 1e-6, "electric.eps_i": 3.9}, "The screen of the paper."),
    Preset("Screen", "silicon dioxide, 0.2 µm", {"electric.d_i": 0.2e-6, "electric.eps_i": 3.9}, _THICK),
    Preset("Screen", "aluminium oxide, 1 µm", {"electric.d_i": 1e-6, "electric.eps_i": 9.0}, _THICK),
    Preset("Screen", "parylene C, 5 µm", {"electric.d_i": 5e-6, "electric.eps_i": 3.1}, _THICK),
    Preset("Screen", "polyester film, 12 µm", {"electric.d_i": 12e-6, "electric.eps_i": 3.2}, _THICK),
)
"""Coatings of screens."""


_CIRCUIT = ("electric.tissue", "electric.leak")  # act at an alternating voltage only


def presets(keys: Collection[str]) -> tuple[Preset, ...]:
    """Return all presets whose keys the page has.

    Args:
        keys: of the page's fields.
    """
    found = (_finger(name, each, keys) for name, each in FINGERS.items())
    return (*SCREENS, *(each for each in found if each is not None))


def _finger(name: str, finger: NamedFinger, keys: Collection[str]) -> Preset | None:
    """Return a finger as a preset, with the default of each key that another finger changes; None of another shape."""
    values = {key: value for key, value in finger.values.items() if key not in _CIRCUIT}
    if not set(values) <= set(keys):
        return None
    default = flat(Scene().parameters())
    same = {key: default[key] for each in FINGERS.values() for key in each.values if key in keys}
    source = ". ".join(dict.fromkeys(trait.source for trait in finger.traits)) or "The finger of the paper"
    words = f"{finger.words}. {source}. {finger.remark}".rstrip()
    return Preset("Finger", name, same | values, words)


def data(scales: Mapping[str, float]) -> Iterator[dict[str, Any]]:
    """Yield the presets ready for JSON, in the units of the fields.

    Args:
        scales: units in one SI unit, by the keys of the fields.
    """
    for each in presets(scales):
        values = {key: float(f"{value * scales[key]:.12g}") for key, value in each.values.items()}
        source = f"{each.name[0].upper()}{each.name[1:]}: {each.source}"
        yield {"group": each.group, "name": each.name, "values": values, "source": source}
