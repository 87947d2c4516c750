r"""Where the error of the model "cylinders" is known, and how large it is there: a table of regions of scenes.

A :class:`Region` has a range by key, and the relative errors inside. They are errors of the model beside full runs,
without those of a mesh. Regions are in order, the narrowest first, and the first one that a scene is in has its errors.
Outside of all regions the error is not known, and :func:`cautions` names the key and its range.

Friction follows Coulomb's law there, :math:`f_T = \mu_0 (f_{ext} + f_{el})`. So its error is that of the attraction,
times the share of the attraction in the contact force:

.. math:: \frac{\Delta \mu_{app}}{\mu_{app}} = \frac{f_{el}}{f_{ext} + f_{el}} \, \frac{\Delta f_{el}}{f_{el}}.

It vanishes without voltage. Of another law of friction it is at least that of the length in contact. :func:`data` is
the same table for the calculator, whose ``errors.js`` reads it.
"""

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cache
from importlib.resources import files
from typing import Any, NamedTuple

from fingerpad.results.quantities import FINGER, QUANTITIES
from fingerpad.results.states import WORDS
from fingerpad.scene.fingers import PAPER
from fingerpad.scene.keys import every
from fingerpad.scene.messages import show
from fingerpad.scene.reading import flat
from fingerpad.scene.remarks import coefficient
from fingerpad.scene.scene import Scene
from variational.caution import Caution
from variational.state import ContactState

_Bands = Mapping[str, Mapping[str, float]]
"""Relative errors by state and quantity; those of a whole finger at full slip are under :data:`WHOLE`."""
WHOLE = "finger"
PULL = "attraction over force"
"""Key, in words, of a region's range of this ratio at full slip, which no scene gives."""
_ROUNDOFF = 1e-12  # relative, of a value at an end
_TINY = 1e-12  # in place of 0 in logarithms
_LOSSES = ("electric.tissue", "electric.leak", "electric.follows")  # without effect on a constant voltage
_TABLES = ("friction", "geometry", "materials", "contact", "electric", "roughness")


@dataclass(frozen=True)
class Region:
    """Scenes in which the error is known."""

    runs: int
    """States of the full model beside which it was found."""
    ranges: Mapping[str, tuple[float, float]]
    """Range by dotted key, in SI units; both ends belong to it, and a voltage has no sign. Keys of scenes' tables that
    are not there have their defaults. A scene has ``force`` or ``f_ext``, and the range of the other one is not read.
    The range :data:`PULL` is one of results."""
    errors: _Bands
    """Errors over the printed value, of the attraction and of lengths: of a section by its states, of a finger."""
    finger: str = PAPER
    """Name of the finger whose other keys it has."""


class Outside(NamedTuple):
    """A key of a scene for whose value the error is not known."""

    key: str
    value: str
    """In words, as the range."""
    known: str
    """The range in which it is."""
    far: float = 0.0
    """Logarithm of the ratio of the value and the nearest end of the range."""

    def __str__(self) -> str:
        """Return the sentence."""
        return f"{self.key} is {self.value}, and it is known for {self.known}"


_DEFAULT_SCREEN = Region(
    44,
    {"force": (0.05, 1.2), "f_ext": (5.0, 150.0), "voltage": (0.0, 200.0), PULL: (0.0, 5.0)},
    {
        "full_slip": {"f_electrostatic": 0.053, "contact_length": 0.078},
        "charged": {"f_electrostatic": 0.137, "contact_length": 0.117},
        WHOLE: {"f_electrostatic": 0.048, "contact_area": 0.076, "gross_area": 0.073},
    },
)


def _read(file: str) -> tuple[Region, ...]:
    """Return the regions of a file of this folder."""
    made = json.loads((files("fingerpad.reduced") / file).read_text(encoding="utf-8"))
    made = [each | {"ranges": {key: tuple(ends) for key, ends in each["ranges"].items()}} for each in made]
    return tuple(Region(**each) for each in made)


FINGERS = _read("finger_errors.json")
"""Errors of other fingers by name, of ``python3 -m benchmarks.presses``."""
REGIONS = (_DEFAULT_SCREEN, *_read("cylinder_errors.json"))
"""Regions of the default screen, and of ``python3 -m benchmarks.loads``. They cover the full model's states:
tests/test_known_error.py and tests/test_loads.py derive them from those of docs/models.json and docs/loads.json."""


# -- where ---------------------------------------------------------------------------------------------------
def where(region: Region) -> str:
    """Return the ranges of a region in words."""
    return ", ".join(f"{key} {_span(*ends, _units()[key])}" for key, ends in region.ranges.items())


def _span(low: float, high: float, unit: str) -> str:
    return f"{f'{low:g}' if low == high else f'{low:g} to {high:g}'} {unit}".strip()


def within(value: float, ends: tuple[float, float]) -> bool:
    """Return whether a value is in a range, the ends and roundoff included; its sign does not count."""
    return ends[0] * (1 - _ROUNDOFF) <= abs(value) <= ends[1] * (1 + _ROUNDOFF)


def find(scene: Scene, pull: float = 0.0) -> Region | None:
    """Return the narrowest region of a scene; None where its error is not known.

    Args:
        scene: with ``f_ext``, or ``force``.
        pull: attraction at full slip over that force.
    """
    given = _given(scene, pull)
    return next((region for region in (*REGIONS, *FINGERS) if not any(_outside(given, region))), None)


def outside(scene: Scene, pull: float = 0.0) -> list[Outside]:
    """Return the keys for which the error is not known, by the nearest region; empty where it is known.

    That is the one with the fewest such keys, then that whose ranges are the nearest by ratio, then the widest.
    Arguments are those of :func:`find`.
    """
    given = _given(scene, pull)
    found = ([*_outside(given, region)] for region in reversed((*FINGERS, *REGIONS)))
    return min(found, key=lambda keys: (len(keys), sum(each.far for each in keys)))


def cautions(scene: Scene, pull: float = 0.0) -> list[Caution]:
    """Return in one sentence why the error is not known, empty where it is known; arguments of :func:`find`.

    In place of more than two keys of one table, as of another finger, it names the table.
    """
    keys = outside(scene, pull)
    tables = Counter(each.key.partition(".")[0] for each in keys)
    many = {table: Outside(table, "another one", "that of a finger by name") for table in tables if tables[table] > 2}
    words = dict.fromkeys(str(many.get(each.key.partition(".")[0], each)) for each in keys)
    return [Caution("error_unknown", f"the error of this model is not known here: {'; '.join(words)}")] if words else []


def _given(scene: Scene, pull: float) -> dict[str, Any]:
    """Return the values of a scene by dotted key: of the two forces the given one, and without a drive no losses."""
    given = flat(scene.parameters()) | {"voltage": scene.volts, PULL: pull}
    given.pop("f_ext" if scene.force is not None else "force", None)
    if scene.drive is None:
        given = {key: value for key, value in given.items() if not key.startswith(_LOSSES)}
    return given


def _outside(given: Mapping[str, Any], region: Region) -> Iterator[Outside]:
    """Yield the keys in which values are outside of a region."""
    default, units, others = _default(region.finger), _units(), set[str]()
    if "force" in given and "force" not in region.ranges:
        yield Outside("force", _span(given["force"], given["force"], units["force"]), "sections alone")
    tables = (key for key in {**default, **given} if key.partition(".")[0] in _TABLES)
    tables = (key for key in tables if key in given or not key.startswith(_LOSSES))
    for key in dict.fromkeys([*region.ranges, *tables]):
        value, unit, table = given.get(key), units.get(key, ""), key.partition(".")[0]
        ends: tuple[Any, Any] = region.ranges.get(key, (default.get(key),) * 2)
        low, high = ends
        if value == low or (value is None and table not in _TABLES):  # the force that is not given
            continue
        if value is None or low is None:
            if table not in others:
                others.add(table)
                yield Outside(table, "of another law", "that of the default scene")
        elif not (_number(value) and _number(low)):
            yield Outside(key, show(value), show(low))
        elif not within(value, ends):
            end = min(max(abs(value), low), high)
            far = abs(math.log(max(abs(value), _TINY) / max(abs(end), _TINY)))
            yield Outside(key, _span(value, value, unit), _span(low, high, unit), far)


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


@cache
def _default(finger: str = PAPER) -> dict[str, Any]:
    return flat(Scene(finger=finger).parameters())  # type: ignore[arg-type]


@cache
def _units() -> dict[str, str]:
    return {key.name: key.unit for key in every(Scene)} | {PULL: ""}


# -- how large -----------------------------------------------------------------------------------------------
def errors(scene: Scene, states: Mapping[str, ContactState]) -> _Bands:
    """Return the known relative errors of a section by state and quantity; empty where none is known.

    Args:
        scene: with ``f_ext``.
        states: of its result by name, full slip too.
    """
    attraction = states["full_slip"].f_electrostatic
    region = find(scene, attraction / scene.f_ext)
    found = {name: known for name, known in ({} if region is None else region.errors).items() if name in states}
    return found | ({"full_slip": at_full_slip(scene, attraction)} if found else {})


def at_full_slip(scene: Scene, f_electrostatic: float) -> dict[str, float]:
    """Return the known relative errors at full slip by quantity, those of friction too; empty where none is known.

    Args:
        scene: with ``f_ext``, or with ``force`` for the whole finger.
        f_electrostatic: attraction on the section (N/m), or on the finger (N).
    """
    force, name = (scene.f_ext, "full_slip") if scene.force is None else (scene.force, WHOLE)
    pull = f_electrostatic / force
    region = find(scene, pull)
    if region is None:
        return {}
    known = region.errors[name]
    share = known["f_electrostatic"] * pull / (1 + pull)
    if coefficient(scene) is None:  # a shear stress on the length in contact
        share = max(share, known["contact_length"])
    return {**known, "mu_app": share, "f_t": share}


def in_words(bands: _Bands) -> str:
    """Return the known errors of a result in words."""
    if not bands:
        return "the error of this model is not known here"
    words = {state: f"in {WORDS[state]}" for state in WORDS} | {WHOLE: "of the whole finger at full slip"}
    names = {**QUANTITIES, **FINGER}
    states = (
        f"{words[state]} " + ", ".join(f"{names[key].words or key} {100 * e:.1f} %" for key, e in each.items())
        for state, each in bands.items()
    )
    return f"error of this model beside full runs: {'; '.join(states)}"


def data(keys: Iterable[str]) -> list[dict[str, Any]]:
    """Return the regions, ready for JSON.

    Args:
        keys: that are to be there, with their defaults where a region has no range of them.
    """
    default = _default()
    fixed = {key: (default[key],) * 2 for key in keys if key != "force" and default.get(key) is not None}
    return [asdict(each) | {"ranges": fixed | dict(each.ranges)} for each in REGIONS]
