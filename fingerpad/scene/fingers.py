"""Fingers by name: sets of keys that ``finger`` gives, each with its source.

::

    finger = "child"
    friction = 0.3         # a key that is given wins over that of the name

``"adult"`` is the default finger and gives no key. A value is from a source that is cited, or it is marked as an
*assumption*; of most sources the abstract alone was read, and the text says so. Relative values are relative to the
default finger, which stands for an adult between the moist and the dry one. ``docs/assumptions.md`` has the
friction of all fingers side by side.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal

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
