"""Fingers by name: sets of keys that ``finger`` gives, each with its source.

::

    finger = "child"
    friction = 0.3         # a key that is given wins over that of the name

``"adult"`` is the default finger and gives no key. A value is from a source that is cited, or it is marked as an
*assumption*; of most sources the abstract alone was read, and the text says so. Relative values are relative to the
default finger, which stands for an adult between the moist and the dry one. ``docs/assumptions.md`` has the
friction of all fingers side by side.

A scene keeps which keys were given. What its finger's name and its accuracy give (the presets) is put under them each
time, so that another name or accuracy gives its own.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, is_dataclass
from functools import reduce
from types import MappingProxyType
from typing import Any, Literal

from fingerpad.scene.law_keys import keys_of
from geometry.parameters import Fingertip

ADULT = "adult"
FingerName = Literal["adult", "woman", "child", "elderly", "callused", "dry", "moist"]
_OF_RIDGES = (  # lengths that go with the ridges
    "sc_thickness",
    "ve_thickness",
    "dermis_thickness",
    "ridge_amplitude",
    "intermediate_ridge_height",
    "limiting_ridge_height",
    "merkel_offset",
    "meissner_offset",
)
_OF_SIZE = (  # lengths that go with the finger's
    "width",
    "height",
    "bone_width",
    "bone_height",
    "bone_centre",
    "nail_thickness",
    "nail_half_width",
    "nail_bed_half_width",
)
_PAD = 28e-3  # m, radius and length of the default pad along the finger
SOFT = {"subcutis": 25e3, "dermis": 2.55e3, "viable_epidermis": 61.75e3, "stratum_corneum": 86.76e3}
"""Shear moduli (Pa) of the default finger's soft layers (Table 2)."""
_RIDGES = (
    "Prints of Králík and Novotný 2003 (Variability and Evolution 11, 5 to 30), whose data were read in the repository "
    "andburch/bayesianfingerprintr"
)
_STIFFNESS = '"Age and gender effect on human tactile perception, in vivo", abstract, with doi 10.1098/rsos.170321'
_MOISTURE = "Yuan and Verma 2006, Colloids and Surfaces B 48, 6 to 12, abstract"
_FRICTION = "Buchholz, Frederick and Armstrong 1988, Ergonomics 31, 317 to 325, as tabled on a page of the authors"


_NOT_MEASURED = "This finger was not measured: its values are from several sources, or assumed (docs/assumptions.md)."
MOISTURE = (
    "No finger was measured for these values. Moisture raises the attraction of a constant voltage here, without "
    "losses; people with moist fingers needed a higher voltage to feel it (arXiv 2409.16936)."
)


@dataclass(frozen=True)
class Trait:
    """Some keys of a finger that have one source."""

    values: Mapping[str, Any]
    """Values by dotted key, in SI units."""
    source: str
    """Where they are from; begins with "Assumption" where no source gives them."""


@dataclass(frozen=True)
class NamedFinger:
    """A finger with a name."""

    words: str
    """Who it is."""
    traits: tuple[Trait, ...] = ()
    remark: str = _NOT_MEASURED
    """What a reader must know of its numbers, a sentence; empty for none."""

    @property
    def values(self) -> dict[str, Any]:
        """All of its values by dotted key."""
        return {key: value for trait in self.traits for key, value in trait.values.items()}


def _round(value: float) -> float:
    return float(f"{value:.3g}")


def _shape(ridges: float, size: float) -> dict[str, float]:
    """Return the default finger's lengths but the ridges' distance, in parts of the default ones."""
    default = Fingertip()
    lengths = {name: ridges * getattr(default, name) for name in _OF_RIDGES}
    lengths |= {name: size * getattr(default, name) for name in _OF_SIZE}
    pad = {f"slices.{name}": size * _PAD for name in ("radius", "length")}
    return {key: _round(value) for key, value in ({f"geometry.{k}": v for k, v in lengths.items()} | pad).items()}


def _stiffer(factor: float) -> dict[str, float]:
    """Return the shear moduli of the soft layers, in parts of the default ones."""
    return {f"materials.{layer}.shear_modulus": _round(factor * value) for layer, value in SOFT.items()}


_DRY = {"friction": 0.2, "roughness.young": 3.2e6, "electric.tissue": "dry", "electric.leak": "sliding dry"}
_MOIST = {"friction": 0.32, "roughness.young": 0.32e6, "electric.tissue": "moist", "electric.leak": "moist"}
_OF_MOISTURE = {
    "friction": "Moist skin has 1.6 times the friction of dry skin: palms on paper, suede and tape have 1.56, 1.69 and "
    f"1.61 ({_FRICTION}). Assumption: so on glass, with the default halfway between the two",
    "roughness.young": f"Dry stratum corneum is ten times as stiff as moist one ({_MOISTURE}). Assumption: the default "
    "is halfway between the two, and the layer as a whole is unchanged",
}
_DRY_CIRCUIT = Trait(
    {key: _DRY[key] for key in ("electric.tissue", "electric.leak")},
    "For drives: published constants of dry skin, and a leak that is an assumption (docs/drive.md)",
)
_MOIST_CIRCUIT = Trait(
    {key: _MOIST[key] for key in ("electric.tissue", "electric.leak")},
    "For drives: published constants of wetted skin, and a leak that is a guess (docs/drive.md)",
)


def _surface(values: Mapping[str, Any]) -> tuple[Trait, ...]:
    """Return friction and stiffness of the surface of a dry or a moist finger."""
    return tuple(Trait({key: values[key]}, source) for key, source in _OF_MOISTURE.items())


FINGERS = MappingProxyType(
    {
        ADULT: NamedFinger("the default finger, with the geometry and the materials of the paper", remark=""),
        "woman": NamedFinger(
            "a woman, 18 years or older",
            (
                Trait(
                    {"geometry.ridge_wavelength": 441e-6},
                    f"Mean of 33 women; 23 men have 492 µm. {_RIDGES}",
                ),
                Trait(
                    _shape(0.913, 0.913),
                    "Assumption: all lengths go with the distance of ridges, 0.913 of the default's",
                ),
                Trait(
                    _stiffer(1.17),
                    f"Young's modulus is 17 % higher for women ({_STIFFNESS}). Assumption: in all soft layers alike, "
                    "and the default is a man's",
                ),
            ),
        ),
        "child": NamedFinger(
            "a child of 3 to 10 years",
            (
                Trait(
                    {"geometry.ridge_wavelength": 354e-6},
                    f"Mean of 21 children of 4 to 10 years. {_RIDGES}",
                ),
                Trait(
                    _shape(0.733, 0.876) | {"geometry.ridge_count": 65},
                    "Index fingers of 160 children of 3 to 10 years have a mean diameter, by girth, of 15 mm (doi "
                    "10.1016/j.aanat.2010.03.002, abstract); the default has 17.1 mm. Assumption: outline, bone, nail "
                    "and pad have this scale, 0.876, and layers that of the ridges, 0.733; as many ridges as cover the "
                    "palmar half; stiffness, friction and roughness are the default's",
                ),
            ),
        ),
        "elderly": NamedFinger(
            "a person of some 60 years or older",
            (
                Trait(
                    _stiffer(1.27),
                    "Surface waves on a man's finger take 3.2 m/s at 26 years and 3.6 m/s at 58, so that the modulus "
                    f"grows by 27 % ({_STIFFNESS}). Assumption: in all soft layers alike",
                ),
                Trait(
                    {"friction": _DRY["friction"], "roughness.young": _DRY["roughness.young"]},
                    "Moisture and friction are lower (doi 10.1038/s41598-018-23688-6, abstract). Assumption: as those "
                    "of the dry finger",
                ),
                _DRY_CIRCUIT,
            ),
            MOISTURE,
        ),
        "callused": NamedFinger(
            "a finger with calluses, of manual work or strings",
            (
                Trait(
                    {"geometry.sc_thickness": 850e-6},
                    "Assumption: twice the default. No measured callus was read; 0.3 mm was read of one finger (doi "
                    "10.1098/rsif.2012.0467, a caption)",
                ),
            ),
        ),
        "dry": NamedFinger("a dry finger", (*_surface(_DRY), _DRY_CIRCUIT), MOISTURE),
        "moist": NamedFinger(
            "a moist finger, by sweat or after a while on glass", (*_surface(_MOIST), _MOIST_CIRCUIT), MOISTURE
        ),
    }
)
"""Fingers by name."""
assert tuple(FINGERS) == FingerName.__args__  # type: ignore[attr-defined]

# -- changes of a scene, and keys that they make meaningless ---------------------------------------------------
DEFAULT_HISTORY = ("f_ext", "voltage", "slide_length")
"""Keys of the default loads, which a history replaces."""
_RECORD = ("geometry", "materials", "roughness", "electric", "slices", "output", "numerics")  # tables of every record
_SHAPE = (*(name for name in Fingertip.model_fields if name != "sc_thickness"), "file_sha256")
_REPLACED = {
    "history": (*DEFAULT_HISTORY, "force"),
    "force": ("f_ext",),
    "f_ext": ("force",),
    "slices.height": ("slices.radius", "slices.length"),
    "geometry.file": tuple(f"geometry.{name}" for name in _SHAPE),
}
"""Keys that another one makes meaningless: those of a preset, and of a scene that is changed, give way to it."""
_START = {"contact": 20e-6, "receptor": 40e-6, "interface": 120e-6, "growth": 0.5}  # m, but for the growth
_START_AT_SITES = 10e-6  # m; coarser elements do not resolve the tips of 6 µm: halving them does not show the error


def start(tolerances: Mapping[str, Any]) -> dict[str, float]:
    """Return the element sizes (m) from which a scene with accuracies by quantity starts."""
    return _START | ({"receptor": _START_AT_SITES} if tolerances.get("sed") is not None else {})


def presets(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the finger and the accuracy of a scene give, by dotted key."""
    name, accuracy = data.get("finger"), data.get("accuracy")
    found = dict(FINGERS[name].values) if isinstance(name, str) and name in FINGERS else {}
    sizes = start(accuracy) if isinstance(accuracy, Mapping) and accuracy else {}
    return found | {f"mesh.{key}": size for key, size in sizes.items()}


def with_presets(data: Mapping[str, Any], laws: Mapping[str, type]) -> Mapping[str, Any]:
    """Return the data of a scene with the values of its presets.

    A key that is given wins, and so does one that makes it meaningless (:data:`_REPLACED`), or a law that is given as
    an object, of one's own, or without such a parameter; ``laws`` has those of the package by name.
    """
    found, gone = data, set(_replaced(data))
    for key, value in presets(data).items():
        if key not in gone and _takes(found, key.split("."), laws):
            found = _put(found, key.split("."), value)
    return found


def preset_keys(data: Mapping[str, Any], laws: Mapping[str, type], default: Callable[[], Any]) -> list[str]:
    """Return the dotted keys for which a preset may stand: those that are not given.

    In the record of a run, which gives every key, they are those that have the default value or that of a preset.

    Args:
        data: nested tables.
        laws: of the package, by name.
        default: gives the default scene.
    """
    values = presets(data)
    keys = dict.fromkeys(key for finger in FINGERS.values() for key in finger.values) | values
    if any(data.get(name) is None for name in _RECORD):
        return [key for key in keys if _takes(data, key.split("."), laws)]
    scene = default()
    return [key for key in keys if _value_at(data, key) in (values.get(key), reduce(getattr, key.split("."), scene))]


def without(data: Mapping[str, Any], keys: Sequence[str]) -> dict[str, Any]:
    """Return the data of a scene without some dotted keys."""
    found = dict(data)
    for key in keys:
        if _value_at(found, key) is not None:
            found = _put(found, key.split("."), None)
    return found


def changed(present: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a scene with changes, without the keys that the changes make meaningless.

    Args:
        present: the keys that are given so far.
        changes: values by key, as for :meth:`fingerpad.scene.Scene.replace`.
    """
    no_mesh = ["geometry.file_sha256"] if "file" in (changes.get("geometry") or {}) else []
    return _merged(without(present, [*_replaced(changes), *no_mesh]), changes)


def _replaced(data: Mapping[str, Any]) -> Iterator[str]:
    """Yield the keys that others of nested tables make meaningless."""
    for given, keys in _REPLACED.items():
        yield from keys if _value_at(data, given) is not None else ()


def _merged(present: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table with changes: tables are merged, all else is replaced."""
    found = dict(present)
    for key, value in changes.items():
        before = found.get(key)
        both = isinstance(value, Mapping) and isinstance(before, Mapping) and _same_law(before, value.get("law"))
        found[key] = _merged(before, value) if both else value  # type: ignore[arg-type]
    return found


def _same_law(present: Mapping[str, Any], name: Any) -> bool:
    """Return whether changes of a table are not of another law than the table's."""
    kind = present.get("law")
    names = (f"{kind.__module__}:{kind.__qualname__}", kind.__name__) if isinstance(kind, type) else ()
    return name in (None, kind, *names)


def _takes(table: Any, parts: Sequence[str], laws: Mapping[str, type]) -> bool:
    """Return whether a value may be put at a place: nothing else stands there or on the way."""
    if not isinstance(table, Mapping):
        return False
    if len(parts) > 1:
        return _takes(table.get(parts[0], {}), parts[1:], laws)
    law = table.get("law")
    law = laws.get(law) if isinstance(law, str) else law
    known = "law" not in table or (isinstance(law, type) and is_dataclass(law) and parts[0] in keys_of(law))
    return known and parts[0] not in table


def _put(table: Mapping[str, Any], parts: Sequence[str], value: Any) -> dict[str, Any]:
    """Return nested tables with a value at a place; without it where it is None."""
    inner = value if len(parts) == 1 else _put(table.get(parts[0], {}), parts[1:], value)
    rest = {key: each for key, each in table.items() if key != parts[0]}
    return rest if inner is None else {**rest, parts[0]: inner}


def _value_at(table: Any, key: str) -> Any:
    """Return the value at a dotted key of nested tables, None where there is none."""
    for part in key.split("."):
        table = table.get(part) if isinstance(table, Mapping) else None
    return table
